//! Waiting until a source changes, for `plcc test --watch` and `plcc run --watch`.

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use crate::inputs;

/// Time between two looks at the files.
const STEP: Duration = Duration::from_millis(200);

/// What the files were: their names, times and sizes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen(Vec<(PathBuf, Option<SystemTime>, u64)>);

/// The files of the arguments as they are.
pub fn look(paths: &[PathBuf]) -> Seen {
    let files = paths.iter().flat_map(|path| match path.is_dir() {
        true => inputs::files_below(path),
        false => [Some(path.clone()), inputs::file_scenario(path)].into_iter().flatten().collect(),
    });
    let state = |file: PathBuf| {
        let data = file.metadata().ok();
        (file, data.as_ref().and_then(|data| data.modified().ok()), data.map_or(0, |data| data.len()))
    };
    Seen(files.map(state).collect())
}

/// Waits until the files are not as they were, and then until they stop changing.
pub fn wait(paths: &[PathBuf], mut seen: Seen) {
    let mut changed = false;
    loop {
        std::thread::sleep(STEP);
        let now = look(paths);
        if now == seen && changed {
            return;
        }
        changed |= now.is_other_program(&seen);
        seen = now;
    }
}

impl Seen {
    /// A file that can be part of a program is new, gone or another one. What a run writes into the folder is not.
    fn is_other_program(&self, before: &Seen) -> bool {
        let gone = before.0.iter().filter(|(file, ..)| self.0.iter().all(|(now, ..)| now != file));
        let other = self.0.iter().filter(|state| !before.0.contains(state));
        gone.chain(other).any(|(file, ..)| inputs::may_be_input(file))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_file_and_a_changed_one_are_seen() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let paths = [folder.path().to_path_buf()];
        let empty = look(&paths);
        std::fs::write(folder.path().join("a.stl"), "A I 0.0\n").expect("the folder can be written");
        let one = look(&paths);
        assert_ne!(empty, one);
        assert_eq!(one, look(&paths));
        std::fs::write(folder.path().join("a.stl"), "A I 0.0\n= Q 0.0\n").expect("the folder can be written");
        assert_ne!(one, look(&paths));
        wait(&paths, empty);
    }

    #[test]
    fn what_a_run_writes_is_not_a_change() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let paths = [folder.path().to_path_buf()];
        let write =
            |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("the folder can be written");
        let before = look(&paths);
        write("run.log", "plcc: changed\n");
        write("trace.csv", "cycle,time_ms,Q0.0\n1,10,0\n");
        let after = look(&paths);
        assert_ne!(before, after);
        assert!(!after.is_other_program(&before));
        write("plc.toml", "cpu = \"s7-300\"\n");
        assert!(look(&paths).is_other_program(&after));
        let with_settings = look(&paths);
        std::fs::remove_file(folder.path().join("plc.toml")).expect("the file is there");
        assert!(look(&paths).is_other_program(&with_settings));
    }
}
