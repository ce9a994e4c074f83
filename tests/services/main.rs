//! Programs with services, and their clients: those that plants use, and some that break the rules.
//!
//! Clients come from PyPI and npm, into `target/clients`. A test whose client cannot be had is ignored.

mod busy;
mod change;
mod fleet;
mod hostile;
mod partners;
mod process;
mod record;
mod rust7;
mod s7200;
mod sparkplug;
mod tank;
mod terminal;
mod tls;
mod ua;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use libtest_mimic::{Arguments, Failed, Trial};
use process::{Plc, Program, free_port, get};

fn main() {
    plcc_tests::provide_runtimes();
    let trial = |name: &str, missing: Option<String>, run: fn() -> Result<(), Failed>| {
        if let Some(reason) = &missing {
            eprintln!("{name} is ignored: {reason}");
        }
        Trial::test(name, run).with_ignored_flag(missing.is_some())
    };
    let (snap7, modbus) = (python("python-snap7==3.3.0", "snap7"), python("pymodbus==3.16.1", "pymodbus"));
    let asyncua = python("asyncua==2.1.0", "asyncua").err();
    let sparkplug = mosquitto().or_else(|| python("pysparkplug==0.6.1", "pysparkplug").err());
    let broker_and_openssl = sparkplug.clone().or_else(tls::missing);
    let python_alone = venv_missing();
    let openssl = tls::missing();
    let trials = vec![
        trial("put_and_get_of_python_snap7", snap7.clone().err(), partners::snap7_server),
        trial("programs_talk_over_s7", None, partners::programs),
        trial("hostile_partners_do_no_harm", None, partners::hostile_partner),
        trial("s7_of_python_snap7", snap7.err(), || client(&["--s7", "--access=control"], "snap7_client.py")),
        trial("s7_of_nodes7", node("nodes7@0.3.18").err(), || client(&["--s7"], "nodes7_client.js")),
        trial("modbus_of_pymodbus", modbus.err(), || client(&["--modbus"], "modbus_client.py")),
        trial("opcua_of_asyncua", asyncua.clone(), || opcua(Program::Plant, "open")),
        trial("opcua_goes_on_when_the_program_changes", asyncua.clone(), change::sessions_go_on),
        trial("opcua_of_an_s7_200_of_asyncua", asyncua.clone(), s7200::browsing),
        trial("opcua_with_security_of_asyncua", asyncua, || opcua(Program::Line, "secure")),
        trial("page_of_chromium", chromium().err(), || client(&["--web", "--access=control"], "page_client.js")),
        trial("status_in_chromium", chromium().err(), status),
        trial("watch_table_and_forcing_in_chromium", chromium().err(), watch_table),
        trial("status_in_a_terminal", None, terminal::status),
        trial("s7_of_rust7", None, rust7::talk),
        trial("s7_areas_of_an_s7_200", None, s7200::areas),
        trial("s7_limits_of_an_s7_200", None, s7200::limits),
        trial("modbus_registers_of_an_s7_200", None, s7200::registers),
        trial("values_reach_a_broker", mosquitto(), process::values_reach_a_broker),
        trial("values_reach_a_broker_with_tls", broker_and_openssl, tls::broker),
        trial("sparkplug_of_pysparkplug", sparkplug.clone(), sparkplug::host),
        trial("sparkplug_when_the_broker_comes_back", sparkplug.clone(), sparkplug::broker_comes_back),
        trial("sparkplug_commands_need_a_right", sparkplug.clone(), sparkplug::may_not_write),
        trial("pages_with_tls", python_alone.clone(), tls::pages),
        trial("load_and_monitor_with_tls", openssl, tls::own_clients),
        trial("fleet_manifests_name_what_is_there", None, fleet::manifests),
        trial("controller_and_plant_play_together", None, tank::plays_together),
        trial("metrics_tell_the_state", None, metrics),
        trial("the_page_lists_clients_of_opc_ua", None, listed_clients),
        trial("the_page_says_which_cycles_it_counts", None, counted_cycles),
        trial("services_are_only_where_they_are_asked_for", None, only_where_asked_for),
        trial("recorded_timers_and_interrupts_are_repeated", None, record::timers_and_interrupts),
        trial("recorded_writes_of_clients_are_repeated", None, record::client_writes),
        trial("hostile_s7_clients_do_no_harm", None, hostile::s7),
        trial("hostile_modbus_clients_do_no_harm", None, hostile::modbus),
        trial("hostile_opcua_clients_do_no_harm", None, hostile::opcua),
        trial("hostile_pages_do_no_harm", None, hostile::web),
        trial("hostile_clients_of_metrics_do_no_harm", None, hostile::metrics),
        trial("clients_that_take_no_answer_do_no_harm", None, hostile::slow),
        trial("half_a_frame_ends_the_connection", None, hostile::half),
        trial("hostile_sparkplug_commands_do_no_harm", sparkplug, sparkplug::hostile),
        trial("hostile_tls_clients_do_no_harm", python_alone, tls::hostile),
        trial("busy_clients", without_load(), busy::measure),
        trial("busy_watchers", without_load(), busy::watching),
        trial("idle_clients_leave_room_for_others", None, hostile::idle),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

/// Why nothing is measured, unless something is.
fn without_load() -> Option<String> {
    busy::seconds().is_none().then(|| "PLCC_LOAD=SECONDS is not set".to_string())
}

/// Where clients are installed.
fn clients() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/clients")
}

fn here() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("services")
}

fn runs(command: &mut Command) -> bool {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|it| it.success())
}

fn venv() -> PathBuf {
    clients().join("venv/bin/python")
}

/// Installs a package of Python, unless it is there. `Err`: it cannot be had.
fn python(package: &str, module: &str) -> Result<(), String> {
    let import = || runs(Command::new(venv()).args(["-c", &format!("import {module}")]));
    if import() {
        return Ok(());
    }
    let made = venv().exists() || runs(Command::new("python3").args(["-m", "venv"]).arg(clients().join("venv")));
    let installed = made && runs(Command::new(venv()).args(["-m", "pip", "install", "--quiet", package]));
    if installed && import() { Ok(()) } else { Err(format!("{package} cannot be installed with Python")) }
}

/// Why there is no Python of its own, if there is none.
fn venv_missing() -> Option<String> {
    python("pysparkplug==0.6.1", "ssl").err()
}

/// Installs a package of npm, unless it is there. `Err`: it cannot be had.
fn node(package: &str) -> Result<(), String> {
    let folder = clients().join("node");
    let name = package.split('@').next().unwrap_or(package);
    let is_there = || folder.join("node_modules").join(name).exists() && runs(Command::new("node").arg("--version"));
    if is_there() {
        return Ok(());
    }
    let made = std::fs::create_dir_all(&folder).is_ok();
    let installed = made && runs(Command::new("npm").args(["install", "--prefix"]).arg(&folder).arg(package));
    if installed && is_there() { Ok(()) } else { Err(format!("{package} cannot be installed with npm")) }
}

/// The browser, and what lets a test steer it. `Err`: it cannot be had.
fn chromium() -> Result<(), String> {
    if !runs(Command::new("chromium").arg("--version")) {
        return Err("chromium is not installed".to_string());
    }
    node("ws@8.18.0")
}

/// Why there is no broker, if there is none.
fn mosquitto() -> Option<String> {
    let there = runs(Command::new("mosquitto").arg("-h")) || Command::new("mosquitto").arg("-h").output().is_ok();
    (!there).then(|| "mosquitto is not installed".to_string())
}

/// Runs a client against the program of this folder. The first flag of the program is the service.
fn client(flags: &[&str], script: &str) -> Result<(), Failed> {
    let port = free_port().to_string();
    let plc = Plc::start(&[&[flags[0], &port], &flags[1..]].concat())?;
    talk(plc, script, &[&port])
}

/// Runs a client until it is done, and ends the program.
fn talk(plc: Plc, script: &str, arguments: &[&str]) -> Result<(), Failed> {
    let mut command = match script.ends_with(".js") {
        true => Command::new("node"),
        false => Command::new(venv()),
    };
    command.env("NODE_PATH", clients().join("node/node_modules")).arg(here().join(script)).args(arguments);
    let output = command.stdin(Stdio::null()).output()?;
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let ended = plc.end()?;
    if !output.status.success() || !said.contains("done") {
        return Err(format!("{script}: {said}\nthe program said: {ended}").into());
    }
    Ok(())
}

/// The certificate is made in a folder of its own.
fn opcua(program: Program, what: &str) -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port().to_string());
    let plc = Plc::run_in(folder.path(), program.path()?, &["--opcua", &port])?;
    let certificates = folder.path().join("opcua");
    let mode = std::os::unix::fs::PermissionsExt::mode(&std::fs::metadata(certificates.join("own.pem"))?.permissions());
    if mode & 0o077 != 0 {
        return Err(format!("others may read the private key: {mode:o}").into());
    }
    talk(plc, "asyncua_client.py", &[what, &port, &certificates.display().to_string()])
}

/// What the page shows of a program that is watched, until that ends.
fn status() -> Result<(), Failed> {
    let port = free_port().to_string();
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("watched");
    process::plcc(&["build", "--quiet"], &[&here().join("status")], &out)?;
    let forces = folder.path().join("forces.toml");
    std::fs::write(&forces, "[[force]]\naddress = \"I0.7\"\nvalue = \"0\"\n")?;
    let forces = forces.to_string_lossy();
    let mut plc = Plc::run(&out, &["--web", &port, "--set", "I0.0=1", "--force", &forces])?;
    let mut command = Command::new("node");
    command.env("NODE_PATH", clients().join("node/node_modules")).arg(here().join("status_client.js")).arg(&port);
    let output = command.arg(plc.id().to_string()).arg(&out).stdin(Stdio::null()).output()?;
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    match output.status.success() && said.contains("done") && !plc.is_running() {
        true => Ok(()),
        false => Err(said.into()),
    }
}

/// Watch tables, forcing and the memory reset by people with roles.
fn watch_table() -> Result<(), Failed> {
    let port = free_port().to_string();
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("table");
    process::plcc(&["build", "--quiet"], &[&here().join("watch")], &out)?;
    let tables = folder.path().join("tables");
    std::fs::create_dir(&tables)?;
    std::fs::write(tables.join("levels.toml"), "[[row]]\naddress = \"MW10\"\nformat = \"dec\"\ncomment = \"upper\"\n")?;
    std::fs::write(tables.join("broken.toml"), "[[row]]\naddress = \"MW10\"\nformat = \"octal\"\n")?;
    let folder = tables.to_string_lossy();
    talk(Plc::run(&out, &["--web", &port, "--tables", &folder])?, "watch_client.js", &[&port, &folder])?;
    // What people have kept.
    let kept = std::fs::read_to_string(tables.join("levels.toml"))?;
    match kept.contains("comment = \"upper\"")
        && kept.contains("address = \"I0.0\"")
        && tables.join("pumps.toml").exists()
    {
        true => Ok(()),
        false => Err(kept.into()),
    }
}

fn metrics() -> Result<(), Failed> {
    let port = free_port();
    let plc = Plc::start(&["--metrics", &port.to_string()])?;
    std::thread::sleep(Duration::from_millis(200));
    let page = get(port, "/metrics")?;
    for line in ["plc_up 1", "plc_running 1", "plc_info{program=\"line\",cpu=\"s7-300\"} 1", "plc_faults_total 0"] {
        if !page.lines().any(|found| found == line) {
            return Err(format!("no {line} in\n{page}").into());
        }
    }
    let count = |name: &str| {
        let found = page.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u64>().ok());
        found.ok_or_else(|| Failed::from(format!("no {name} in\n{page}")))
    };
    let cycles = count("plc_cycle_work_seconds_count")?;
    if cycles < 10 || cycles != count("plc_cycle_work_seconds_bucket{le=\"+Inf\"}")? {
        return Err(format!("{cycles} cycles\n{page}").into());
    }
    if !get(port, "/health")?.starts_with("HTTP/1.1 200 OK") || !get(port, "/other")?.starts_with("HTTP/1.1 404") {
        return Err("wrong answers".into());
    }
    let asked = |method: &str| hostile::asks(port, &[format!("{method} /health HTTP/1.0\r\n\r\n").as_bytes()]);
    let (head, posted) = (asked("HEAD")?, asked("POST")?);
    if !head.starts_with(b"HTTP/1.1 200 OK") || !head.ends_with(b"\r\n\r\n") || !posted.starts_with(b"HTTP/1.1 405") {
        return Err(format!("{}{}", String::from_utf8_lossy(&head), String::from_utf8_lossy(&posted)).into());
    }
    plc.end()?;
    Ok(())
}

/// What the view CPU of the page lists.
fn listed_clients() -> Result<(), Failed> {
    let (folder, opcua, web) = (tempfile::tempdir()?, free_port(), free_port());
    let plc = Plc::run_in(
        folder.path(),
        Program::Plant.path()?,
        &["--opcua", &opcua.to_string(), "--web", &web.to_string()],
    )?;
    let answer = get(web, "/info")?;
    for service in ["opcua", "web"] {
        if !answer.contains(&format!("\"service\":\"{service}\"")) {
            return Err(format!("no {service} in {answer}").into());
        }
    }
    plc.end()?;
    Ok(())
}

/// The page says from which cycle on it knows how long cycles take.
fn counted_cycles() -> Result<(), Failed> {
    let (metrics, web) = (free_port().to_string(), free_port());
    for (flags, is_all) in [(&[][..], false), (&["--metrics", metrics.as_str()][..], true)] {
        let plc = Plc::run(Program::Plant.path()?, &[&["--web", &web.to_string()], flags].concat())?;
        let answer = get(web, "/info")?;
        let first = answer.split_once("\"from\":").and_then(|(_, rest)| rest.split_once(',')?.0.parse::<u64>().ok());
        if first.map(|first| first == 0) != Some(is_all) {
            return Err(format!("cycles are counted from {first:?} on: {answer}").into());
        }
        plc.end()?;
    }
    Ok(())
}

/// A program without `[services]` has no flags of services, unless `--services` asks for them.
fn only_where_asked_for() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let source = here().join("line/line.stl");
    let symbols = here().join("line/symbols.sdf");
    let built = |name: &str, flags: &[&str]| -> Result<PathBuf, Failed> {
        let out = folder.path().join(name);
        process::plcc(&[&["build", "--quiet", "--cpu=s7-300"], flags].concat(), &[&source, &symbols], &out)?;
        Ok(out)
    };
    let (plain, with) = (built("plain", &[])?, built("with", &["--services"])?);
    let accepts = |program: &Path| runs(Command::new(program).args(["--s7", "0", "--cycles", "3", "--quiet"]));
    let bytes = |program: &Path| std::fs::metadata(program).map(|found| found.len());
    if accepts(&plain) || !accepts(&with) || bytes(&plain)? + 200_000 > bytes(&with)? {
        return Err("services in the wrong program".into());
    }
    let said = Command::new(&with).args(["--publish", "MW10", "--cycles", "3"]).output()?;
    if said.status.code() != Some(2) || !String::from_utf8_lossy(&said.stderr).contains("--publish: there is no broker")
    {
        return Err(format!("values for nobody: {said:?}").into());
    }
    let without = built("without", &["--services", "--no-monitor"])?;
    for (program, status) in [(&with, "200"), (&without, "404")] {
        let port = process::free_port();
        let running = process::Plc::run(program, &["--web", &format!("127.0.0.1:{port}")])?;
        let answer = process::get(port, "/places/OB1")?;
        if !answer.starts_with(&format!("HTTP/1.1 {status}")) {
            return Err(format!("places of statements: {answer}, not {status}").into());
        }
        running.end()?;
    }
    Ok(())
}
