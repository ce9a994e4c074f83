//! Watch tables that are files of the project: `speed.toml` in a folder is the table `speed`.

use std::path::{Path, PathBuf};

use plcc_runtime::files;
use plcc_runtime::watch::sheet::Sheet;

use crate::limits::{PAGE_MESSAGE_MAX, TABLE_NAME_MAX, TABLES_MAX};

/// Why there is no table, or none was written.
#[derive(Debug, PartialEq, Eq)]
pub enum Wrong {
    Missing(String),
    /// Something else, as a sentence.
    Other(String),
}

/// The folder of the tables. It need not be there until a table is written.
#[derive(Debug)]
pub struct Tables(PathBuf);

impl Tables {
    pub fn new(folder: &str) -> Tables {
        Tables(PathBuf::from(folder))
    }

    /// The names of all tables, in the order of the alphabet.
    pub fn names(&self) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(&self.0) else { return Vec::new() };
        let name = |path: &Path| match path.extension()?.to_str()? == "toml" && path.is_file() {
            true => path.file_stem()?.to_str().filter(|name| check(name).is_ok()).map(str::to_string),
            false => None,
        };
        let mut names: Vec<String> = entries.flatten().filter_map(|entry| name(&entry.path())).collect();
        names.sort_unstable();
        names.truncate(TABLES_MAX);
        names
    }

    /// The rows of a table.
    pub fn read(&self, name: &str) -> Result<Sheet, Wrong> {
        let path = self.path(name)?;
        let failed = |error: std::io::Error| match error.kind() {
            std::io::ErrorKind::NotFound => Wrong::Missing(format!("there is no watch table `{name}`")),
            _ => Wrong::Other(format!("{}: {error}", path.display())),
        };
        let bytes = std::fs::metadata(&path).map_err(failed)?.len();
        if bytes > PAGE_MESSAGE_MAX as u64 {
            let most = PAGE_MESSAGE_MAX / 1024;
            return Err(Wrong::Other(format!("{}: a watch table has at most {most} KiB", path.display())));
        }
        let text = files::regular(&path).and_then(|()| std::fs::read_to_string(&path)).map_err(failed)?;
        Sheet::read(&text).map_err(|error| Wrong::Other(format!("{}: {error}", path.display())))
    }

    /// Writes the file of a table in one step: a reader gets either the old table or the new one.
    pub fn write(&self, name: &str, sheet: &Sheet) -> Result<(), Wrong> {
        let path = self.path(name)?;
        let text = sheet.write().map_err(Wrong::Other)?;
        if !path.exists() && self.names().len() >= TABLES_MAX {
            return Err(Wrong::Other(format!("{}: {TABLES_MAX} watch tables are there already", self.0.display())));
        }
        let fresh = self.0.join(format!(".{name}.new"));
        std::fs::create_dir_all(&self.0)
            .and_then(|()| std::fs::write(&fresh, text))
            .and_then(|()| std::fs::rename(&fresh, &path))
            .map_err(|error| Wrong::Other(format!("{}: {error}", path.display())))
    }

    fn path(&self, name: &str) -> Result<PathBuf, Wrong> {
        check(name).map_err(Wrong::Other)?;
        Ok(self.0.join(format!("{name}.toml")))
    }
}

/// Whether a text names a table. A name is part of a path, so nothing in it may lead elsewhere. `Err`: the error.
fn check(name: &str) -> Result<(), String> {
    let is_letter = |letter: char| letter.is_alphanumeric() || " _-.()".contains(letter);
    let fits = !name.is_empty() && name.chars().count() <= TABLE_NAME_MAX && !name.starts_with('.');
    match fits && name.chars().all(is_letter) && name.trim() == name {
        true => Ok(()),
        false => Err(format!(
            "`{}` cannot be the name of a watch table: write up to {TABLE_NAME_MAX} letters, digits, blanks, or _ - . ( )",
            name.chars().take(TABLE_NAME_MAX).collect::<String>()
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(address: &str) -> Sheet {
        Sheet::read(&format!("[[row]]\naddress = \"{address}\"\nformat = \"dec\"\n")).unwrap()
    }

    #[test]
    fn what_was_written_is_listed_and_read() {
        let folder = std::env::temp_dir().join(format!("plcc-tables-{}", std::process::id()));
        let tables = Tables::new(folder.to_str().unwrap());
        assert!(tables.names().is_empty(), "the folder is not there yet");
        tables.write("speed", &sheet("MW10")).unwrap();
        tables.write("Füllen 2", &sheet("MW12")).unwrap();
        tables.write("speed", &sheet("MW14")).unwrap();
        std::fs::write(folder.join("notes.txt"), "").unwrap();
        std::fs::write(folder.join(".hidden.toml"), "").unwrap();
        std::fs::write(folder.join("bad.toml"), "[[row]]\nadress = \"MW10\"\n").unwrap();
        std::fs::create_dir(folder.join("sub.toml")).unwrap();
        assert_eq!(tables.names(), ["Füllen 2", "bad", "speed"]);
        assert_eq!(tables.read("speed").unwrap().row[0].address, "MW14");
        assert!(matches!(tables.read("bad"), Err(Wrong::Other(why)) if why.contains("bad.toml: line 2: ")));
        assert!(matches!(tables.read("none"), Err(Wrong::Missing(_))));
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn no_name_leads_out_of_the_folder() {
        let tables = Tables::new("tables");
        for name in ["", ".", "..", "../plc", "/etc/plc", "a/b", "a\\b", "a\0", "a\nb", " a", "C:x", &"a".repeat(65)] {
            assert!(matches!(tables.read(name), Err(Wrong::Other(_))), "{name:?}");
            assert!(matches!(tables.write(name, &sheet("MW10")), Err(Wrong::Other(_))), "{name:?}");
        }
    }
}
