//! The files of a conversion: their names, encodings and line ends.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use plcc_runtime::files::writable;
use plcc_syntax::Form;

use super::companions::Companion;
use super::{Beside, Converted};
use crate::cli::{ConvertArgs, ConvertTo};
use crate::command::exit;
use crate::report;

/// Writes the texts to standard output, to a file or into a folder, there with that extension, or the one of the source.
///
/// `companions`: what else belongs into a folder.
pub(super) fn store(
    args: &ConvertArgs,
    extension: Option<&str>,
    files: &[Converted],
    companions: &[Companion],
) -> Result<(), u8> {
    let Some(output) = &args.output else {
        if let Some(Beside { extension, what, .. }) = files.iter().flat_map(|file| &file.beside).next() {
            report::say(&format!("{what} in a file of their own (`.{extension}`): name the output with `-o`"));
            return Err(exit::USAGE);
        }
        return files.iter().try_for_each(|file| report::print(&file.text));
    };
    let is_folder = output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/");
    let mut texts: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    match files {
        [file] if !is_folder => texts.extend(named(args, file, output.clone())),
        _ => {
            if let Err(error) = std::fs::create_dir_all(output) {
                report::say(&format!("cannot make the folder `{}`: {error}", output.display()));
                return Err(exit::USAGE);
            }
            let mut used = BTreeSet::new();
            for file in files {
                let name = Path::new(&file.name);
                let name = extension.map_or_else(|| name.to_path_buf(), |extension| name.with_extension(extension));
                let path = output.join(name.file_name().unwrap_or_default());
                let own = unused(&path, &used);
                if own != path {
                    let (source, own) = (&file.name, own.display());
                    report::say(&format!("`{source}` becomes `{own}`: another source has its name"));
                }
                used.insert(folded(&own));
                texts.extend(named(args, file, own));
            }
            for Companion { name, bytes, yields } in companions {
                let path = output.join(name);
                if !yields || !path.exists() {
                    texts.push((path, bytes.clone()));
                }
            }
        }
    }
    let mut paths = BTreeSet::new();
    for (path, _) in &texts {
        if !paths.insert(folded(path)) {
            report::say(&format!("two sources would be written to `{}`", path.display()));
            return Err(exit::USAGE);
        }
    }
    texts.iter().try_for_each(|(path, text)| write(path, text))
}

/// The path, with a number at its name if another file has it: `Main.xml`, `Main-2.xml`.
///
/// `used`: paths as [`folded`] gives them.
fn unused(path: &Path, used: &BTreeSet<String>) -> PathBuf {
    let part = |part: Option<&OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let stem = part(path.file_stem());
    let end = path.extension().map_or_else(String::new, |extension| format!(".{}", part(Some(extension))));
    let mut own = path.to_path_buf();
    let mut number = 2;
    while used.contains(&folded(&own)) {
        own.set_file_name(format!("{stem}-{number}{end}"));
        number += 1;
    }
    own
}

/// A path in small letters: on Windows, `Main.xml` and `main.xml` are one file.
fn folded(path: &Path) -> String {
    path.to_string_lossy().to_lowercase()
}

/// The text of a file at its path, and what is beside it.
fn named(args: &ConvertArgs, file: &Converted, path: PathBuf) -> Vec<(PathBuf, Vec<u8>)> {
    let beside =
        file.beside.iter().map(|beside| (path.with_extension(beside.extension), beside.text.clone().into_bytes()));
    let mut found: Vec<(PathBuf, Vec<u8>)> = beside.collect();
    let text = encoded(args, file).unwrap_or_else(|| file.text.clone().into_bytes());
    found.insert(0, (path, text));
    found
}

/// The text in the encoding and with the line ends of its source, if both are text sources: STEP 7 V5 and Micro/WIN read them in the
/// code page of the system only. None: it stays UTF-8.
fn encoded(args: &ConvertArgs, file: &Converted) -> Option<Vec<u8>> {
    let source = Path::new(&file.name);
    let extension = source.extension().unwrap_or_default();
    let of_portal = ["xml", "s7dcl"].iter().any(|own| extension.eq_ignore_ascii_case(own));
    let is_text = match args.to {
        None => true,
        Some(ConvertTo::Stl | ConvertTo::Scl | ConvertTo::Gr7 | ConvertTo::Awl) => !of_portal,
        Some(ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd | ConvertTo::Xml | ConvertTo::Plcopen) => false,
    };
    let bytes = is_text.then(|| std::fs::read(source).ok()).flatten()?;
    Form::of(&bytes, args.code_page)?.write(&file.text.replace("\r\n", "\n"))
}

/// Writes a file; an exit code after a message.
pub(super) fn write(path: &Path, text: impl AsRef<[u8]>) -> Result<(), u8> {
    writable(path).and_then(|()| std::fs::write(path, text)).map_err(|error| {
        report::say(&format!("cannot write `{}`: {error}", path.display()));
        exit::USAGE
    })
}
