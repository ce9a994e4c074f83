//! The flags of the services, the same for an executable and for `plcc run`, and what they open.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::Path;
use std::sync::Arc;

use clap::{Args, ValueEnum};
use plcc_abi::ProgramImage;
use plcc_abi::connections::S7Connection;
use plcc_abi::services::{Protection, Right};
use plcc_runtime::change::Loader;
use plcc_runtime::online::Service;
use plcc_runtime::options::split_list;
use plcc_runtime::partners::Board;
use plcc_runtime::s7200::socket_address;
use plcc_runtime::signal;
use tokio::runtime::Builder;
use tokio_rustls::TlsAcceptor;

use crate::link::{Link, link};
use crate::listen::{self, Door, Visitor};
use crate::metrics::{self, CycleTimes, Pages};
use crate::modbus::{self, Map};
use crate::mqtt::sparkplug::{self, Node, NodeName};
use crate::mqtt::values::{self, Publisher};
use crate::mqtt::{Broker, Target};
use crate::opcua;
use crate::password::Guard;
use crate::rights::Clients;
use crate::s7;
use crate::tls::{self, BrokerFiles};
use crate::web::{self, Page, Tables, Users};

/// Flags of the services. They have precedence over plc.toml.
#[derive(Args, Clone, Debug, Default)]
pub struct ServiceOptions {
    /// Answer S7 clients, such as panels and libraries; a port without an address is only for clients on this computer
    #[arg(long, value_name = "ADDR:PORT", value_parser = address)]
    pub s7: Option<SocketAddr>,
    /// Answer Modbus TCP clients
    #[arg(long, value_name = "ADDR:PORT", value_parser = address)]
    pub modbus: Option<SocketAddr>,
    /// Answer OPC UA clients
    #[arg(long, value_name = "ADDR:PORT", value_parser = address)]
    pub opcua: Option<SocketAddr>,
    /// Answer HTTP requests for /metrics (Prometheus) and /health
    #[arg(long, value_name = "ADDR:PORT", value_parser = address)]
    pub metrics: Option<SocketAddr>,
    /// Serve a page that shows the CPU in a browser
    #[arg(long, value_name = "ADDR:PORT", value_parser = address)]
    pub web: Option<SocketAddr>,
    /// Folder of watch tables that the page and `plcc monitor` show, a TOML file for each
    #[arg(long, value_name = "FOLDER")]
    pub tables: Option<String>,
    /// Encrypt the page and the metrics, with the certificate in this folder; it is made if there is none
    #[arg(long, value_name = "FOLDER")]
    pub tls: Option<String>,
    /// Publish values to an MQTT broker: mqtt://HOST[:PORT]/PREFIX, or mqtts:// with TLS
    #[arg(long, value_name = "URL", value_parser = Broker::parse)]
    pub mqtt: Option<Broker>,
    /// Certificates of the authority of an mqtts broker [default: those that this computer knows]
    #[arg(long, value_name = "FILE")]
    pub mqtt_ca: Option<String>,
    /// Certificate for an mqtts broker that requires one
    #[arg(long, value_name = "FILE")]
    pub mqtt_certificate: Option<String>,
    /// Private key of this certificate
    #[arg(long, value_name = "FILE")]
    pub mqtt_key: Option<String>,
    /// Publish the values as a node of Sparkplug B, whose values hosts may write
    #[arg(long, value_name = "GROUP/NODE[/DEVICE]", value_parser = NodeName::parse)]
    pub sparkplug: Option<NodeName>,
    /// Values to publish [default: `values` in `[services]` of plc.toml]
    #[arg(long, value_name = "ADDR,...")]
    pub publish: Vec<String>,
    /// What clients may do at most [default: what plc.toml says, else write]
    #[arg(long, value_name = "RIGHT", value_enum)]
    pub access: Option<Access>,
    /// Let users with the role `change` load another program with `plcc load`; without users, everyone on this computer
    #[arg(long)]
    pub allow_load: bool,
}

/// What clients may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Access {
    Read,
    Write,
    /// Write, stop and start the CPU, and set its clock.
    Control,
}

impl From<Access> for Right {
    fn from(access: Access) -> Right {
        match access {
            Access::Read => Right::Read,
            Access::Write => Right::Write,
            Access::Control => Right::Control,
        }
    }
}

/// `0.0.0.0:102`, `[::]:102`, `localhost:102`, or a port alone, which is one of this computer. `Err`: the error.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = text.parse::<u16>() {
        return Ok(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
    }
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
    socket_address(text).ok_or_else(|| match text.rsplit_once(':') {
        None if is_number(text) => format!("`{text}` is not a port: ports are 1 to 65535"),
        Some((_, port)) if is_number(port) && port.parse::<u16>().is_err() => {
            format!("`{port}` is not a port: ports are 1 to 65535")
        }
        Some(("", port)) if is_number(port) => {
            format!("`{text}` has no address: write {port} for clients on this computer, 0.0.0.0:{port} for all")
        }
        _ => format!("`{text}` is not an address with a port, as in 127.0.0.1:10102"),
    })
}

/// Whether a text is the URL of a broker. `Err`: the error.
pub fn check_broker(text: &str) -> Result<(), String> {
    Broker::parse(text).map(|_| ())
}

/// Whether a text names a node of Sparkplug B. `Err`: the error.
pub fn check_node(text: &str) -> Result<(), String> {
    NodeName::parse(text).map(|_| ())
}

/// Whether the program has the values that an entry of `values` names. `Err`: the error.
pub fn check_values(text: &str, image: &ProgramImage) -> Result<(), String> {
    let names = split_list(&[text.to_string()]);
    names.iter().try_for_each(|name| signal::all(name, image, None).map(|_| ()))
}

/// Whether a table of Modbus can begin there: one of bits, or of registers. `Err`: the error.
pub fn check_registers(text: &str, has_bits: bool, image: &ProgramImage) -> Result<(), String> {
    modbus::check(text, has_bits, image)
}

/// What clients with the right `control` may do, if the protocol has it and nothing is protected.
const CONTROL: &str = "read, write, stop and start the CPU";

/// What S7 clients with the right `control` may do. `is_portal`: such a CPU refuses STOP and restarts.
fn control_of_s7(is_portal: bool, protection: Protection, has_password: bool) -> &'static str {
    match (protection, has_password, is_portal) {
        (Protection::ReadWrite, true, true) => "read and write, and with the password set the clock",
        (Protection::ReadWrite, true, false) => "read and write, and with the password stop and start the CPU",
        (Protection::ReadWrite, false, _) => "read and write",
        (Protection::None | Protection::Write | Protection::Complete, _, true) => "read, write and set the clock",
        (Protection::None | Protection::Write | Protection::Complete, _, false) => CONTROL,
    }
}

/// What OPC UA clients with the right `control` may do if there are no users. Under complete protection nobody can sign in.
fn control_of_opcua(protection: Protection) -> &'static str {
    match protection {
        Protection::None | Protection::Write => CONTROL,
        Protection::ReadWrite | Protection::Complete => "read and write",
    }
}

/// What answers on the side of the CPU, and what was opened, a line each.
pub type Opened = (Option<Box<dyn Service>>, Vec<String>);

impl ServiceOptions {
    /// A flag that is given and means nothing without a broker.
    fn flag_of_broker(&self) -> Option<&'static str> {
        let flags = [
            (self.sparkplug.is_some(), "--sparkplug"),
            (!self.publish.is_empty(), "--publish"),
            (self.mqtt_ca.is_some(), "--mqtt-ca"),
            (self.mqtt_certificate.is_some(), "--mqtt-certificate"),
            (self.mqtt_key.is_some(), "--mqtt-key"),
        ];
        flags.into_iter().find_map(|(is_given, flag)| is_given.then_some(flag))
    }

    /// Opens what the flags and, unless `flags_only`, plc.toml ask for. `Err`: why not.
    ///
    /// `loader` changes the program, if clients may do that.
    pub fn open(&self, image: &ProgramImage, flags_only: bool, loader: Option<Loader>) -> Result<Opened, String> {
        let config = &image.config.services;
        let port = |flag: Option<SocketAddr>, key: &Option<String>| match (flag, key) {
            (None, Some(text)) if !flags_only => address(text).map(Some),
            (flag, _) => Ok(flag),
        };
        let text = |flag: &Option<String>, key: &Option<String>| match (flag, key) {
            (None, Some(text)) if !flags_only => Some(text.clone()),
            (flag, _) => flag.clone(),
        };
        let broker = match (&self.mqtt, &config.mqtt) {
            (None, Some(text)) if !flags_only => Some(Broker::parse(text)?),
            (flag, _) => flag.clone(),
        };
        let node = match (&self.sparkplug, &config.sparkplug) {
            (None, Some(text)) if !flags_only => Some(NodeName::parse(text)?),
            (flag, _) => flag.clone(),
        };
        if let (None, None, Some(flag)) = (&self.mqtt, &config.mqtt, self.flag_of_broker()) {
            return Err(format!("{flag}: there is no broker: add --mqtt mqtt://HOST:PORT"));
        }
        let [authority, certificate, key] = [
            text(&self.mqtt_ca, &config.mqtt_ca),
            text(&self.mqtt_certificate, &config.mqtt_certificate),
            text(&self.mqtt_key, &config.mqtt_key),
        ];
        let target = broker.map(|broker| {
            let (authority, certificate, key) = (authority.as_deref(), certificate.as_deref(), key.as_deref());
            target(broker, &BrokerFiles { authority, certificate, key })
        });
        let target = target.transpose()?;
        let (s7, modbus) = (port(self.s7, &config.s7)?, port(self.modbus, &config.modbus)?);
        let (metrics, web) = (port(self.metrics, &config.metrics)?, port(self.web, &config.web)?);
        let opcua = port(self.opcua, &config.opcua)?;
        if self.allow_load && web.is_none() {
            return Err("--allow-load: programs are loaded through the page: add --web ADDR:PORT".to_string());
        }
        if self.tables.is_some() && web.is_none() {
            return Err("--tables: watch tables are shown by the page: add --web ADDR:PORT".to_string());
        }
        // Several CPUs of one program cannot be the same partner.
        let connections = if flags_only { Vec::new() } else { image.config.connections.clone() };
        let board = (!connections.is_empty()).then(|| Arc::new(Board::new(connections)));
        let is_open = s7.or(modbus).or(opcua).or(metrics).or(web).is_some();
        let folder = text(&self.tls, &config.tls);
        if self.tls.is_some() && web.or(metrics).is_none() {
            return Err("--tls: it is for the page and the metrics: add --web or --metrics".to_string());
        }
        if !is_open && target.is_none() && board.is_none() {
            return match self.access {
                Some(_) if !flags_only => {
                    Err("--access: no client can connect: add --s7, --modbus, --opcua, --web or --mqtt".to_string())
                }
                _ => Ok((None, Vec::new())),
            };
        }
        let clients = Clients::new(config, self.access.map(Right::from));
        let times = metrics.is_some().then(Arc::<CycleTimes>::default);
        let (link, desk) = link(times.clone(), board.clone());
        let mut plan = Plan {
            s7: None,
            partners: Vec::new(),
            modbus: None,
            opcua: None,
            metrics: None,
            web: None,
            tls: None,
            publisher: None,
            node: None,
        };
        if let (Some(folder), Some(address)) = (folder, web.or(metrics)) {
            plan.tls = Some(tls::server(Path::new(&folder), &image.name, address.ip())?);
        }
        let mut opened = Vec::new();
        let guard = Guard::new(config.password.as_deref());
        let server = s7::Server { link: link.clone(), guard, protection: config.protection, board: board.clone() };
        if let Some(address) = s7 {
            let door = listen::open("s7", address, clients.clone())?;
            let (protection, has_password) = (config.protection, config.password.is_some());
            let control = control_of_s7(image.profile.family.is_portal(), protection, has_password);
            let is_locked = protection == Protection::Complete && has_password;
            let locked = if is_locked { ", all of it with the password" } else { "" };
            opened.push(line("S7 clients", &door, &format!("{}{locked}", clients.text(control))));
            plan.s7 = Some((door, server.clone()));
        }
        for (number, connection) in board.iter().flat_map(|board| board.connections().iter().enumerate()) {
            opened.push(partner(connection, s7.is_some()));
            if connection.active {
                // A partner reaches nothing here unless clients do.
                let rights = s7.map(|_| clients.clone());
                plan.partners.push((server.clone(), number, rights));
            }
        }
        if let Some(address) = modbus {
            let map = Map::new(&config.registers, image)?;
            let door = listen::open("modbus", address, clients.clone())?;
            opened.push(line("Modbus TCP clients", &door, &clients.text("read and write")));
            plan.modbus = Some((door, link.clone(), map));
        }
        if let Some(address) = opcua {
            let server = opcua::Server::new(link.clone(), config, image, address)?;
            let door = listen::open("opcua", address, clients.clone())?;
            let control = control_of_opcua(config.protection);
            opened.push(line("OPC UA clients", &door, &server.text(&clients.text(control))));
            plan.opcua = Some((door, Arc::new(server)));
        }
        if let Some(address) = web {
            let users = Users::new(&config.users);
            if users.is_open() && !address.ip().is_loopback() {
                return Err(format!(
                    "--web {address}: without `[[services.user]]` in plc.toml the page is for this computer only"
                ));
            }
            let door = listen::open("web", address, clients.clone())?;
            let services = [
                plan.s7.as_ref().map(|(door, _)| door),
                plan.modbus.as_ref().map(|(door, ..)| door),
                plan.opcua.as_ref().map(|(door, _)| door),
                Some(&door),
            ];
            let services = services.into_iter().flatten().map(|door| (door.service, door.open.clone())).collect();
            let who = match (users.is_open(), self.allow_load) {
                (true, false) => "everyone on this computer may look",
                (true, true) => "everyone on this computer may look and load programs",
                (false, _) => "users may sign in",
            };
            let scheme = if plan.tls.is_some() { "https" } else { "http" };
            opened.push(line("page", &door, who).replacen(" at ", &format!(" at {scheme}://"), 1));
            let loader = loader.filter(|_| self.allow_load);
            let tables = text(&self.tables, &config.tables).map(|folder| Tables::new(&folder));
            plan.web = Some((door, Page::new(link.clone(), users, services, loader, plan.tls.is_some(), tables)));
        }
        if let (Some(address), Some(times)) = (metrics, times) {
            let door = listen::open("metrics", address, clients.clone())?;
            let who = if plan.tls.is_some() { "HTTPS clients" } else { "HTTP clients" };
            opened.push(line(who, &door, "/metrics and /health"));
            let services = [
                plan.s7.as_ref().map(|(door, _)| door),
                plan.modbus.as_ref().map(|(door, ..)| door),
                plan.opcua.as_ref().map(|(door, _)| door),
                plan.web.as_ref().map(|(door, _)| door),
            ];
            let services = services.into_iter().flatten().chain([&door]);
            let services = services.map(|door| (door.service, door.open.clone())).collect();
            plan.metrics = Some((door, Pages { link: link.clone(), times, services }));
        }
        if let Some(target) = target {
            let values = if self.publish.is_empty() { &config.values } else { &self.publish };
            match node {
                Some(name) => {
                    let node = Node::new(target, name, values, image, clients)?;
                    opened.push(node.text());
                    plan.node = Some((node, link));
                }
                None => {
                    let publisher = Publisher::new(target, values, config.interval_ms, image)?;
                    opened.push(publisher.text());
                    plan.publisher = Some((publisher, link));
                }
            }
        }
        if config.protection == Protection::Complete && config.password.is_none() && plan.s7.is_some() {
            opened.push("S7 clients cannot reach anything: complete protection, and no password".to_string());
        }
        plan.start()?;
        Ok((Some(Box::new(desk)), opened))
    }
}

/// Where values are published. `Err`: the files for TLS are wrong, or not for this broker.
fn target(broker: Broker, files: &BrokerFiles) -> Result<Target, String> {
    match (broker.is_secure(), files.flag()) {
        (true, _) => Ok(Target { tls: Some(files.config()?), broker }),
        (false, None) => Ok(Target { broker, tls: None }),
        (false, Some(flag)) => {
            Err(format!("{flag}: the URL of the broker begins with mqtt://; with TLS it is mqtts://"))
        }
    }
}

/// `S7 clients at 127.0.0.1:10102: clients may read`
fn line(who: &str, door: &Door, text: &str) -> String {
    let address = door.listener.local_addr().map_or_else(|_| "?".to_string(), |address| address.to_string());
    format!("{who} at {address}: {text}")
}

/// `connection 1: to 192.168.0.7:102`, `connection 256 (W#16#100): to 192.168.0.7:102`
fn partner(connection: &S7Connection, has_port: bool) -> String {
    let id = match connection.id {
        id @ 0..10 => id.to_string(),
        id => format!("{id} (W#16#{id:X})"),
    };
    match (connection.active, &connection.partner) {
        (true, partner) => format!("connection {id}: to {}", partner.as_deref().unwrap_or("its partner")),
        (false, _) if !has_port => format!("connection {id}: its partner cannot connect without an S7 port; add --s7"),
        (false, _) => format!("connection {id}: waits for its partner"),
    }
}

/// What is to run.
struct Plan {
    s7: Option<(Door, s7::Server)>,
    /// Connections to partners, by number, and who of them may do what here.
    partners: Vec<(s7::Server, usize, Option<Clients>)>,
    modbus: Option<(Door, Link, Map)>,
    opcua: Option<(Door, Arc<opcua::Server>)>,
    metrics: Option<(Door, Pages)>,
    web: Option<(Door, Page)>,
    /// Of the page and the metrics.
    tls: Option<TlsAcceptor>,
    publisher: Option<(Publisher, Link)>,
    node: Option<(Node, Link)>,
}

impl Plan {
    /// Starts the thread of the services. `Err`: the system has none.
    fn start(self) -> Result<(), String> {
        let failed = |error: std::io::Error| format!("services cannot be started: {error}");
        // In an executable this signal has its default: a client that goes while it is written to would end the process. With a handler it
        // is an error of the write.
        let broken_pipe = Arc::new(std::sync::atomic::AtomicBool::new(false));
        signal_hook::flag::register(signal_hook::consts::SIGPIPE, broken_pipe).map_err(failed)?;
        let runtime = Builder::new_current_thread().enable_io().enable_time().build().map_err(failed)?;
        let thread = std::thread::Builder::new().name("services".to_string());
        thread.spawn(move || runtime.block_on(self.run())).map_err(failed)?;
        Ok(())
    }

    async fn run(self) {
        let s7 = async {
            if let Some((door, server)) = self.s7 {
                let reference = std::sync::atomic::AtomicU16::new(0);
                let serve = |visitor| {
                    let number = reference.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                    s7::serve(visitor, server.clone(), number % 0x7FFF + 1)
                };
                listen::accept(door, serve).await;
            }
        };
        let modbus = async {
            if let Some((door, link, map)) = self.modbus {
                listen::accept(door, |visitor| modbus::serve(visitor, link.clone(), map)).await;
            }
        };
        let opcua = async {
            if let Some((door, server)) = self.opcua {
                listen::accept(door, |visitor| opcua::serve(visitor, server.clone())).await;
            }
        };
        let metrics = async {
            if let Some((door, pages)) = self.metrics {
                let serve = |visitor: Visitor| {
                    let (tls, pages) = (self.tls.clone(), pages.clone());
                    async move {
                        if let Some(stream) = tls::open(tls.as_ref(), visitor.stream).await {
                            metrics::serve(stream, pages).await;
                        }
                    }
                };
                listen::accept(door, serve).await;
            }
        };
        let web = async {
            if let Some((door, page)) = self.web {
                let serve = |visitor: Visitor| {
                    let (tls, page) = (self.tls.clone(), page.clone());
                    async move {
                        if let Some(stream) = tls::open(tls.as_ref(), visitor.stream).await {
                            web::serve(stream, visitor.right, page).await;
                        }
                    }
                };
                listen::accept(door, serve).await;
            }
        };
        let publisher = async {
            if let Some((publisher, link)) = self.publisher {
                values::run(publisher, link).await;
            }
        };
        let node = async {
            if let Some((node, link)) = self.node {
                sparkplug::run(node, link).await;
            }
        };
        for (server, number, rights) in self.partners {
            tokio::spawn(s7::call(server, number, rights));
        }
        tokio::join!(s7, modbus, opcua, metrics, web, publisher, node);
        // Partners of the program do not end.
        std::future::pending().await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn executables_without_services_know_the_flags() {
        let command = ServiceOptions::augment_args(clap::Command::new("program"));
        let flags: Vec<String> =
            command.get_arguments().filter_map(|flag| Some(format!("--{}", flag.get_long()?))).collect();
        assert_eq!(flags, plcc_runtime::options::SERVICE_FLAGS);
    }

    #[test]
    fn protection_is_told_with_what_clients_may_do() {
        let s7 = |protection, has_password| control_of_s7(false, protection, has_password);
        assert_eq!(s7(Protection::None, false), "read, write, stop and start the CPU");
        assert_eq!(s7(Protection::Write, true), "read, write, stop and start the CPU");
        assert_eq!(s7(Protection::ReadWrite, true), "read and write, and with the password stop and start the CPU");
        assert_eq!(s7(Protection::ReadWrite, false), "read and write");
        assert_eq!(control_of_s7(true, Protection::None, false), "read, write and set the clock");
        assert_eq!(control_of_s7(true, Protection::ReadWrite, false), "read and write");
        assert_eq!(control_of_opcua(Protection::Write), "read, write, stop and start the CPU");
        assert_eq!(control_of_opcua(Protection::ReadWrite), "read and write");
    }

    #[test]
    fn flags_that_need_a_broker() {
        let flag = |options: ServiceOptions| options.flag_of_broker();
        assert_eq!(flag(ServiceOptions { s7: address("1").ok(), ..ServiceOptions::default() }), None);
        let publish = vec!["MW10".to_string()];
        assert_eq!(flag(ServiceOptions { publish, ..ServiceOptions::default() }), Some("--publish"));
        let mqtt_key = Some("line.key".to_string());
        assert_eq!(flag(ServiceOptions { mqtt_key, ..ServiceOptions::default() }), Some("--mqtt-key"));
    }

    #[test]
    fn a_port_alone_is_of_this_computer() {
        assert_eq!(address("10102"), Ok("127.0.0.1:10102".parse().unwrap()));
        assert_eq!(address("0.0.0.0:102"), Ok("0.0.0.0:102".parse().unwrap()));
        assert_eq!(address("[::1]:102"), Ok("[::1]:102".parse().unwrap()));
        assert_eq!(address("localhost:102"), address("102"));
        let no_port = "`99999` is not a port: ports are 1 to 65535".to_string();
        assert_eq!((address("99999"), address("0.0.0.0:99999")), (Err(no_port.clone()), Err(no_port)));
        assert!(address(":102").is_err_and(|told| told.contains("write 102 for clients on this computer")));
        for text in ["", "65536", "localhost", "127.0.0.1", ":102"] {
            assert!(address(text).is_err(), "{text}");
        }
    }
}
