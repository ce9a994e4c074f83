//! TLS: to a broker with certificates of both sides, and of the page and the metrics.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use libtest_mimic::Failed;
use plcc_monitor::connection::{Connection, Incoming};
use plcc_services::client::Process;

use crate::hostile::{LONGEST_CYCLE, all_attack};
use crate::process::{Ended, Plc, Program, broker_with, free_port};
use crate::{here, runs, venv};

/// Why there is no openssl, if there is none.
pub fn missing() -> Option<String> {
    (!runs(Command::new("openssl").arg("version"))).then(|| "openssl is not installed".to_string())
}

fn openssl(folder: &Path, arguments: &str) -> Result<(), Failed> {
    let mut command = Command::new("openssl");
    let output = command.current_dir(folder).args(arguments.split_whitespace()).stdin(Stdio::null()).output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    if output.status.success() { Ok(()) } else { Err(format!("openssl {arguments}: {said}").into()) }
}

/// An authority `ca.pem`, and certificates that it has signed for a broker and a client.
fn authority(folder: &Path) -> Result<(), Failed> {
    const NEW: &str = "-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes";
    openssl(folder, &format!("req -x509 {NEW} -keyout ca.key -out ca.pem -days 2 -subj /CN=authority"))?;
    std::fs::write(folder.join("names"), "subjectAltName=IP:127.0.0.1\n")?;
    for name in ["broker", "client"] {
        openssl(folder, &format!("req {NEW} -keyout {name}.key -out {name}.csr -subj /CN={name}"))?;
        let sign = "x509 -req -CA ca.pem -CAkey ca.key -CAcreateserial -days 2 -extfile names";
        openssl(folder, &format!("{sign} -in {name}.csr -out {name}.pem"))?;
    }
    Ok(())
}

fn secure_broker(folder: &Path, port: u16) -> Result<Ended, Failed> {
    let file = |name: &str| folder.join(name).display().to_string();
    let text = format!(
        "user root\nlistener {port} 127.0.0.1\ncafile {}\ncertfile {}\nkeyfile {}\nrequire_certificate true\n\
         allow_anonymous true\n",
        file("ca.pem"),
        file("broker.pem"),
        file("broker.key")
    );
    std::fs::write(folder.join("mosquitto.conf"), text)?;
    broker_with(port, &["-c", &file("mosquitto.conf")])
}

fn client(arguments: &[&str]) -> Result<(), Failed> {
    let output =
        Command::new(venv()).arg(here().join("tls_client.py")).args(arguments).stdin(Stdio::null()).output()?;
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if output.status.success() && said.contains("done") { Ok(()) } else { Err(said.into()) }
}

/// Values reach a broker that shows its certificate and wants to see one; without the right files nothing does.
pub fn broker() -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port());
    authority(folder.path())?;
    let other = tempfile::tempdir()?;
    authority(other.path())?;
    let _broker = secure_broker(folder.path(), port)?;
    let url = format!("mqtts://127.0.0.1:{port}/plant");
    let file = |folder: &Path, name: &str| folder.join(name).display().to_string();
    let (ca, certificate, key) =
        (file(folder.path(), "ca.pem"), file(folder.path(), "client.pem"), file(folder.path(), "client.key"));
    let own = ["--mqtt-certificate", &certificate, "--mqtt-key", &key];
    let start = |flags: &[&str]| Plc::start(&[&["--mqtt", &url, "--publish", "MW10"], flags].concat());
    let plc = start(&[&["--mqtt-ca", &ca], &own[..]].concat())?;
    client(&["broker", &port.to_string(), &folder.path().display().to_string()])?;
    plc.end()?;
    for (flags, expected) in [
        // The broker is not the one that it should be; the broker does not know this side.
        ([&["--mqtt-ca", &file(other.path(), "ca.pem")], &own[..]].concat(), "invalid peer certificate"),
        (vec!["--mqtt-ca", &ca], "trying again"),
    ] {
        let plc = start(&flags)?;
        std::thread::sleep(Duration::from_millis(1500));
        let said = plc.end()?;
        if !said.contains("no connection to mqtts://") || !said.contains(expected) {
            return Err(format!("{flags:?}: {said}").into());
        }
    }
    for (flags, expected) in [
        (vec!["--mqtt-ca", &key], "it contains no certificate"),
        (vec!["--mqtt-ca", "/no/such/file"], "--mqtt-ca: /no/such/file: "),
        (vec!["--mqtt-ca", &ca, "--mqtt-certificate", &certificate], "add --mqtt-key"),
        (vec!["--mqtt", "mqtt://127.0.0.1", "--mqtt-ca", &ca], "mqtts://"),
    ] {
        let program = Program::Line.path()?;
        let mut command = Command::new(program);
        let with_url = if flags.contains(&"--mqtt") { vec![] } else { vec!["--mqtt", url.as_str()] };
        let output = command.args(with_url).args(&flags).args(["--publish", "MW10", "--cycles", "1"]).output()?;
        let said = String::from_utf8_lossy(&output.stderr);
        if output.status.success() || !said.contains(expected) {
            return Err(format!("{flags:?}: {said}").into());
        }
    }
    Ok(())
}

/// The certificate is made at the first start, and clients that know it come in.
pub fn pages() -> Result<(), Failed> {
    let (folder, web, metrics) = (tempfile::tempdir()?, free_port().to_string(), free_port().to_string());
    let flags = ["--web", &web, "--metrics", &metrics, "--tls", "secure"];
    let plc = Plc::run_in(folder.path(), Program::Plant.path()?, &flags)?;
    let certificates = folder.path().join("secure");
    let mode = std::os::unix::fs::PermissionsExt::mode(&std::fs::metadata(certificates.join("key.pem"))?.permissions());
    if mode & 0o077 != 0 {
        return Err(format!("others may read the private key: {mode:o}").into());
    }
    client(&["pages", &web, &metrics, &certificates.display().to_string()])?;
    plc.end().map(drop)
}

/// `plcc load` and `plcc monitor` reach a process with TLS whose certificate they know, and no other.
pub fn own_clients() -> Result<(), Failed> {
    let (folder, other, web) = (tempfile::tempdir()?, tempfile::tempdir()?, free_port().to_string());
    let flags = ["--web", &web, "--tls", "secure", "--allow-load"];
    let plc = Plc::run_in(folder.path(), Program::Plant.path()?, &flags)?;
    let certificate = folder.path().join("secure/certificate.pem");
    authority(other.path())?;
    let load = |trusted: Option<&Path>| {
        let flags = ["plcc", "load", "--lose=refuse", "--to", &web].map(std::ffi::OsString::from);
        let trusted = trusted.into_iter().flat_map(|path| ["--tls".into(), path.into()]);
        plcc_driver::main_with(flags.into_iter().chain(trusted).chain([crate::here().join("plant").into()]))
    };
    let unknown = other.path().join("ca.pem");
    let exits = [
        load(Some(&certificate)),
        load(certificate.parent()),
        load(Some(&unknown)),
        load(Some(&folder.path().join("none.pem"))),
        load(None),
    ];
    if exits != [0, 0, 2, 2, 2] {
        return Err(format!("plcc load ended with {exits:?}").into());
    }
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, web.parse()?));
    let first = |trusted: &Path| -> Result<Incoming, Failed> {
        let connection = Connection::open(Process::new(address, Some(trusted))?, None);
        for _ in 0..100 {
            if let Some(incoming) = connection.take().next() {
                return Ok(incoming);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        Err("plcc monitor says nothing".into())
    };
    match first(&certificate)? {
        Incoming::Connected(names, _) if !names.is_empty() => {}
        Incoming::Connected(..)
        | Incoming::Table(..)
        | Incoming::Names(_)
        | Incoming::Program(_)
        | Incoming::Places(..)
        | Incoming::News(_) => {
            return Err("the names were not listed".into());
        }
        Incoming::Lost(why) => return Err(why.into()),
    }
    match first(&unknown)? {
        Incoming::Lost(why) if why.contains("neither that of --tls") => {}
        Incoming::Lost(why) => return Err(why.into()),
        Incoming::Connected(..)
        | Incoming::Table(..)
        | Incoming::Names(_)
        | Incoming::Program(_)
        | Incoming::Places(..)
        | Incoming::News(_) => {
            return Err("a process that is not known was believed".into());
        }
    }
    plc.end().map(drop)
}

/// The first message of a client. Source: RFC 8446, section 4.1.2; RFC 5246, section 6.2.1 for the record.
fn hello() -> Vec<u8> {
    fn counted<const N: usize>(body: &[u8]) -> Vec<u8> {
        [&body.len().to_be_bytes()[8 - N..], body].concat()
    }
    let extension = |number: u8, body: &[u8]| [&[0, number][..], &counted::<2>(body)].concat();
    let share = [&[0, 0x1D][..], &counted::<2>(&[9; 32])].concat();
    let extensions = [
        extension(43, &counted::<1>(&[3, 4, 3, 3])),
        extension(10, &counted::<2>(&[0, 0x1D, 0, 0x17])),
        extension(13, &counted::<2>(&[8, 4, 4, 1, 4, 3])),
        extension(51, &counted::<2>(&share)),
    ]
    .concat();
    let body = [
        &[3, 3][..],
        &[7; 32],
        &counted::<1>(&[]),
        &counted::<2>(&[0x13, 1, 0xC0, 0x2F]),
        &counted::<1>(&[0]),
        &counted::<2>(&extensions),
    ]
    .concat();
    let message = [&[1][..], &counted::<3>(&body)].concat();
    [&[22, 3, 1][..], &counted::<2>(&message)].concat()
}

/// Random and changed first messages. Then others are served.
pub fn hostile() -> Result<(), Failed> {
    let (folder, web, metrics) = (tempfile::tempdir()?, free_port(), free_port());
    let (web_text, metrics_text) = (web.to_string(), metrics.to_string());
    let flags = ["--web", &web_text, "--metrics", &metrics_text, "--tls", "secure"];
    let plc = Plc::run_in(folder.path(), Program::Plant.path()?, &flags)?;
    let hello = hello();
    // The right one gets an answer: ServerHello.
    let answer = crate::hostile::asks(web, &[&hello])?;
    if !answer.starts_with(&[22, 3, 3]) {
        return Err(format!("{answer:02X?}").into());
    }
    all_attack(web, &[], &[&hello]);
    client(&["pages", &web_text, &metrics_text, &folder.path().join("secure").display().to_string()])?;
    let page = client_metrics(metrics, &folder.path().join("secure/certificate.pem"))?;
    crate::process::page_has_short_cycles(&page, LONGEST_CYCLE)?;
    plc.end().map(drop)
}

fn client_metrics(port: u16, certificate: &Path) -> Result<String, Failed> {
    let script = "import ssl, sys, urllib.request\n\
                  context = ssl.create_default_context(cafile=sys.argv[2])\n\
                  print(urllib.request.urlopen(f'https://127.0.0.1:{sys.argv[1]}/metrics', context=context).read().decode())";
    let output = Command::new(venv()).args(["-c", script, &port.to_string()]).arg(certificate).output()?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}
