//! OPC UA sessions when the program changes.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use libtest_mimic::Failed;

use crate::process::{Plc, free_port, plcc};

/// The program with these members of its data block and its structure.
fn program(folder: &Path, members: &str, motor: &str) -> Result<(), Failed> {
    let text = format!(
        "TYPE \"Motor\"\nSTRUCT\n  {motor}\nEND_STRUCT;\nEND_TYPE\n\
         DATA_BLOCK \"Line\"\n{{ S7_Optimized_Access := 'FALSE' }}\nSTRUCT\n  {members}\n  motor : \"Motor\";\nEND_STRUCT;\n\
         BEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK OB1\nBEGIN\n  ;\nEND_ORGANIZATION_BLOCK\n"
    );
    std::fs::write(folder.join("line.scl"), text)?;
    Ok(std::fs::write(
        folder.join("plc.toml"),
        "name = \"line\"\ncpu = \"1513\"\nsources = [\"line.scl\"]\n[services]\n",
    )?)
}

fn load(folder: &Path, web: &str) -> Result<(), Failed> {
    let flags = ["plcc", "load", "--lose=allow", "--to", web].map(std::ffi::OsString::from);
    match plcc_driver::main_with(flags.into_iter().chain([folder.into()])) {
        0 => Ok(()),
        code => Err(format!("plcc load ended with {code}").into()),
    }
}

/// Sessions and subscriptions go on with the nodes of the new program, unless a structure is another one.
pub fn sessions_go_on() -> Result<(), Failed> {
    let (folder, opcua, web) = (tempfile::tempdir()?, free_port().to_string(), free_port().to_string());
    let (project, out) = (folder.path().join("project"), folder.path().join("line"));
    std::fs::create_dir(&project)?;
    let motor = "speed : REAL := 3.5;";
    program(&project, "old : INT := 5;\n  count : INT;\n  level : INT := 1;", motor)?;
    plcc(&["build", "--quiet"], &[&project], &out)?;
    let plc = Plc::run_in(folder.path(), &out, &["--opcua", &opcua, "--web", &web, "--allow-load"])?;
    let script = crate::here().join("change_client.py");
    let mut client = Command::new(crate::venv())
        .arg(script)
        .arg(&opcua)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let pipes = client.stdin.take().zip(client.stdout.take());
    let (mut input, output) = pipes.ok_or("the client has pipes")?;
    let mut output = BufReader::new(output);
    let mut talk = || -> Result<(), Failed> {
        let mut says = |wanted: &str| {
            let mut line = String::new();
            match output.read_line(&mut line) {
                Ok(_) if line.trim() == wanted => Ok(()),
                _ => Err(Failed::from(format!("`{}` instead of `{wanted}`", line.trim()))),
            }
        };
        says("watching")?;
        program(&project, "extra : INT := 7;\n  count : INT;\n  level : REAL := 2.5;", motor)?;
        load(&project, &web)?;
        writeln!(input)?;
        says("went on")?;
        program(&project, "count : INT;", "on : BOOL;\n  speed : REAL := 3.5;")?;
        load(&project, &web)?;
        writeln!(input)?;
        says("done")
    };
    let talked = talk();
    drop(input);
    let ended = client.wait_with_output()?;
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    talked.map_err(|failed| Failed::from(format!("{}\n{said}", failed.message().unwrap_or_default())))?;
    plc.end().map(drop)
}
