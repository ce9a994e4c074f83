//! `plcc fmt`.

use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::{fs, io};

use plcc_diag::{FileId, SourceFile, SourceMap};
use plcc_format::Left;
use plcc_runtime::files::regular;
use plcc_syntax::{CodePage, Form, decode_as};

use crate::cli::FmtArgs;
use crate::command::exit;
use crate::report;
use crate::{inputs, pipeline};

/// Lays out all sources. Returns 3 if one has errors, 2 if one cannot be read or written, 1 if one would change and only a check
/// was asked for.
pub fn fmt(args: &FmtArgs) -> u8 {
    let paths = match inputs::or_here(&args.inputs) {
        Ok(paths) => paths,
        Err(code) => return code,
    };
    let (mut code, mut changed) = (exit::OK, String::new());
    for (path, named) in paths.iter().flat_map(|path| files(path)) {
        match file(&path, named, args) {
            Ok(false) => {}
            Ok(true) => changed.push_str(&format!("{}\n", path.display())),
            Err(own) => code = code.max(own),
        }
    }
    if args.check {
        if let Err(code) = report::print(&changed) {
            return code;
        }
        if !changed.is_empty() {
            code = code.max(exit::FAILED);
        }
    }
    code
}

/// The files of an argument, and whether the user named them.
fn files(path: &Path) -> Vec<(PathBuf, bool)> {
    match path.is_dir() {
        true => inputs::files_below(path).into_iter().map(|file| (file, false)).collect(),
        false => vec![(path.to_path_buf(), true)],
    }
}

/// Lays out a file. `Ok(true)`: it has or would have changed.
fn file(path: &Path, named: bool, args: &FmtArgs) -> Result<bool, u8> {
    let fail = |what: &str| {
        report::say(&format!("{}: {what}", path.display()));
        Err(exit::USAGE)
    };
    let bytes = match regular(path).and_then(|()| fs::read(path)) {
        Ok(bytes) => bytes,
        Err(_) if !named => return Ok(false),
        Err(error) => return fail(&inputs::reason(&error)),
    };
    let text = decode_as(&bytes, args.code_page);
    if !named && !inputs::is_source(path, &text) {
        return Ok(false);
    }
    let name = path.display().to_string();
    let made = match plcc_format::format(FileId::default(), &text, pipeline::language_of(&name)) {
        Ok(made) => made,
        Err(Left::NotText) if named => return fail("this notation has no layout; only text sources have one"),
        Err(Left::NotText) => return Ok(false),
        Err(Left::Fault(what)) => return fail(&format!("left as it is, please report it: {what}")),
        Err(Left::Errors(mut messages)) => {
            let mut sources = SourceMap::default();
            let file = sources.add(SourceFile::new(name, text));
            debug_assert_eq!(file, FileId::default(), "the messages are about the first file");
            report::messages(&mut messages, &sources);
            return Err(exit::COMPILE);
        }
    };
    let Some(new) = written(&bytes, &made, args.code_page) else {
        return fail(
            "its bytes are not text in one code page, so it is left as it is; name the page with `--code-page`",
        );
    };
    if new == bytes {
        return Ok(false);
    }
    if !args.check
        && let Err(error) = overwrite(path, &bytes, &new)
    {
        return fail(&inputs::reason(&error));
    }
    Ok(true)
}

/// Puts `new` in the place of `old`, which a file has. If there is no room for it, the file has what it had. It stays the same file, with its
/// owner and its links.
fn overwrite(path: &Path, old: &[u8], new: &[u8]) -> io::Result<()> {
    // It is not emptied: its old text has room in any case.
    let file = fs::OpenOptions::new().write(true).open(path)?;
    let write = |bytes: &[u8]| file.write_all_at(bytes, 0).and_then(|()| file.set_len(bytes.len() as u64));
    let written = write(new);
    if written.is_err() {
        // The first error says more.
        let _ = write(old);
    }
    written
}

/// A text in the encoding and with the line ends of the file that it replaces.
fn written(bytes: &[u8], text: &str, page: Option<CodePage>) -> Option<Vec<u8>> {
    Form::of(bytes, page)?.write(text)
}
