//! `plcc new`.

use std::fs;
use std::io::Write;
use std::path::Path;

use plcc_abi::image::{Family, Profile};
use plcc_model::profile;

use crate::cli::NewArgs;
use crate::command::exit;
use crate::inputs::reason;
use crate::{project, report};

/// Makes a project with a small program and its test.
pub fn new(args: &NewArgs) -> u8 {
    let Some(cpu) = profile::lookup(&args.cpu) else {
        report::say(&format!("plcc does not know the CPU `{}`; {}", args.cpu, profile::help(&args.cpu)));
        return exit::USAGE;
    };
    let Some(name) = args.folder.file_name().map(|name| name.to_string_lossy().into_owned()) else {
        report::say(&format!("`{}` is not the name of a folder", args.folder.display()));
        return exit::USAGE;
    };
    match write(&args.folder, &name, &args.cpu, &cpu) {
        Ok(()) => {
            let folder = args.folder.display();
            let quote = if folder.to_string().contains(' ') { "'" } else { "" };
            let made = format!("made {folder}; run its test with `plcc test {quote}{folder}{quote}`\n");
            report::print(&made).err().unwrap_or(exit::OK)
        }
        Err(error) => {
            report::say(&format!("cannot make `{}`: {error}", args.folder.display()));
            exit::USAGE
        }
    }
}

/// Writes the files; none that is there already is replaced.
fn write(folder: &Path, name: &str, cpu_name: &str, cpu: &Profile) -> Result<(), String> {
    let (source, text) = match cpu.family {
        Family::S7200 => ("main.awl", include_str!("../../templates/main.awl")),
        Family::S7300 | Family::S7400 => ("main.stl", include_str!("../../templates/main.stl")),
        Family::S71200 | Family::S71500 => ("main.scl", include_str!("../../templates/main.scl")),
    };
    if folder.is_file() {
        return Err("a file has this name; name another folder".to_owned());
    }
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let settings = format!("name = {}\ncpu = {}\nsources = [\"{source}\"]\n", quoted(name), quoted(cpu_name));
    fs::create_dir_all(folder.join("tests")).map_err(|error| reason(&error))?;
    let scenario = include_str!("../../templates/motor.scenario.toml");
    let ignored = format!("/{name}\n/plc-data/\n");
    for (path, text) in [
        (project::FILE_NAME, settings.as_str()),
        (source, text),
        ("tests/motor.scenario.toml", scenario),
        (".gitignore", &ignored),
    ] {
        let path = folder.join(path);
        fs::File::create_new(&path)
            .and_then(|mut file| file.write_all(text.as_bytes()))
            .map_err(|error| format!("{}: {}", path.display(), reason(&error)))?;
    }
    Ok(())
}
