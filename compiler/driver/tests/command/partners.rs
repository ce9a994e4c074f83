//! Two compiled programs talk to each other over ISO-on-TCP.

use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Starts a program of `tests/command/partners`; it ends on its own, or after a minute.
fn start(source: &str, port: u16) -> Child {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/partners").join(source);
    Command::new(crate::PLCC)
        .arg("run")
        .arg(file)
        .args(["--cpu", "s7-1200", "--cycle-time", "2ms", "--cycles", "30000", "--print", "MW0"])
        .args(["--iso-port", &port.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("plcc starts")
}

#[test]
fn programs_exchange_messages() {
    let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).and_then(|listener| listener.local_addr()).unwrap().port();
    let client = start("client.scl", port);
    let server = start("server.scl", port);
    for (program, expected) in [(client, "MW0 = 16#2222"), (server, "MW0 = 16#1111")] {
        let output = program.wait_with_output().expect("it ends");
        let (text, messages) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_eq!(text.trim(), expected, "{messages}");
        assert_eq!(output.status.code(), Some(0), "{messages}");
    }
}
