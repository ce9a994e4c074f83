//! Waiting until a source changes, for `plcc test --watch`.

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

/// Waits until the files are not as they were, and then until they do not change any more.
pub fn wait(paths: &[PathBuf], mut seen: Seen) {
    let mut changed = false;
    loop {
        std::thread::sleep(STEP);
        let now = look(paths);
        match (now == seen, changed) {
            (true, true) => return,
            (true, false) => {}
            (false, _) => changed = true,
        }
        seen = now;
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
}
