//! Two stations of the S7-200, the samples `station-2` and `station-3`, read and write each other's memory.

use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A separate project with the program of a sample, connected by `network`.
fn project(sample: &str, station: u8, network: &str) -> PathBuf {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/s7-200");
    let source = samples.join(sample).join("main.awl").canonicalize().expect("the sample is there");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(sample);
    std::fs::create_dir_all(&folder).expect("the folder can be made");
    let settings = format!(
        "cpu = \"s7-200\"\nsources = [\"{}\"]\n[s7200]\nstation = {station}\n[s7200.network]\n{network}\n",
        source.display()
    );
    std::fs::write(folder.join("plc.toml"), settings).expect("the settings can be written");
    folder
}

/// Starts a project; each of its scans takes a millisecond.
fn start(project: &Path, arguments: &[&str]) -> Child {
    Command::new(crate::PLCC)
        .arg("run")
        .arg(project)
        .args(["--clock", "virtual", "--print", "QB0"])
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("plcc starts")
}

/// The partner, running, and its port. A port that was free may be taken by another test until the partner listens there: then it ends.
fn listening_partner() -> (Child, u16) {
    for _ in 0..5 {
        let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).and_then(|listener| listener.local_addr());
        let port = free.expect("a port is free").port();
        let partner = project("station-3", 3, &format!("listen = \"127.0.0.1:{port}\""));
        let mut partner = start(&partner, &["--set", "IB0=85", "--cycles", "5000"]);
        for _ in 0..500 {
            std::thread::sleep(Duration::from_millis(20));
            if TcpStream::connect((Ipv4Addr::LOCALHOST, port)).is_ok() {
                break;
            }
        }
        std::thread::sleep(Duration::from_millis(200));
        if partner.try_wait().is_ok_and(|ended| ended.is_none()) {
            return (partner, port);
        }
    }
    panic!("the partner listens nowhere");
}

#[test]
fn a_master_reads_and_writes_its_partner() {
    let (partner, port) = listening_partner();
    let master = project("station-2", 2, &format!("stations = {{ \"3\" = \"127.0.0.1:{port}\" }}"));
    let master = start(&master, &["--cycles", "1500"]);
    for program in [master, partner] {
        let output = program.wait_with_output().expect("it ends");
        let (text, messages) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_eq!(text.trim(), "QB0 = 16#55", "{messages}");
        assert_eq!(output.status.code(), Some(0), "{messages}");
    }
}
