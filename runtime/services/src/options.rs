//! The flags of the services, the same for an executable and for `plcc run`. `opening` opens what they ask for.

mod opening;

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;

use clap::{Args, ValueEnum};
use plcc_abi::ProgramImage;
use plcc_abi::services::{Protection, Right, ServicesConfig};
use plcc_runtime::change::Loader;
use plcc_runtime::online::Service;
use plcc_runtime::options::split_list;
use plcc_runtime::partners::Board;
use plcc_runtime::s7200::socket_address;
use plcc_runtime::signal;

use crate::link::link;
use crate::metrics::CycleTimes;
use crate::modbus;
use crate::mqtt::sparkplug::NodeName;
use crate::mqtt::{Broker, Target};
use crate::rights::Clients;
use crate::tls::BrokerFiles;
use crate::web::Tables;
use opening::Opening;

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

    /// What the flags and, unless `flags_only`, plc.toml ask for. `Err`: what is wrong with it.
    fn wanted(&self, config: &ServicesConfig, flags_only: bool) -> Result<Wanted, String> {
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
        if self.tls.is_some() && web.or(metrics).is_none() {
            return Err("--tls: it is for the page and the metrics: add --web or --metrics".to_string());
        }
        let (tls, tables) = (text(&self.tls, &config.tls), text(&self.tables, &config.tables));
        Ok(Wanted { s7, modbus, opcua, metrics, web, tls, tables, target, node })
    }

    /// Opens what the flags and, unless `flags_only`, plc.toml ask for. `Err`: why not.
    ///
    /// `loader` changes the program, if clients may do that.
    pub fn open(&self, image: &ProgramImage, flags_only: bool, loader: Option<Loader>) -> Result<Opened, String> {
        let config = &image.config.services;
        let wanted = self.wanted(config, flags_only)?;
        // Several CPUs of one program cannot be the same partner.
        let connections = if flags_only { Vec::new() } else { image.config.connections.clone() };
        let board = (!connections.is_empty()).then(|| Arc::new(Board::new(connections)));
        if !wanted.has_port() && wanted.target.is_none() && board.is_none() {
            return match self.access {
                Some(_) if !flags_only => {
                    Err("--access: no client can connect: add --s7, --modbus, --opcua, --web or --mqtt".to_string())
                }
                _ => Ok((None, Vec::new())),
            };
        }
        let clients = Clients::new(config, self.access.map(Right::from));
        let times = wanted.metrics.is_some().then(Arc::<CycleTimes>::default);
        let (link, desk) = link(times.clone(), board.clone());
        let mut opening = Opening::new(image, clients, link);
        if let (Some(folder), Some(address)) = (wanted.tls, wanted.web.or(wanted.metrics)) {
            opening.encrypt(&folder, address)?;
        }
        opening.s7(wanted.s7, board)?;
        if let Some(address) = wanted.modbus {
            opening.modbus(address)?;
        }
        if let Some(address) = wanted.opcua {
            opening.opcua(address)?;
        }
        if let Some(address) = wanted.web {
            let tables = wanted.tables.map(|folder| Tables::new(&folder));
            opening.page(address, self.allow_load, loader, tables)?;
        }
        if let (Some(address), Some(times)) = (wanted.metrics, times) {
            opening.metrics(address, times)?;
        }
        if let Some(target) = wanted.target {
            let values = if self.publish.is_empty() { &config.values } else { &self.publish };
            opening.broker(target, wanted.node, values)?;
        }
        Ok((Some(Box::new(desk)), opening.start()?))
    }
}

/// What is to be opened.
struct Wanted {
    s7: Option<SocketAddr>,
    modbus: Option<SocketAddr>,
    opcua: Option<SocketAddr>,
    metrics: Option<SocketAddr>,
    web: Option<SocketAddr>,
    /// Folder of the certificate of the page and the metrics.
    tls: Option<String>,
    /// Folder of watch tables that the page shows.
    tables: Option<String>,
    /// The broker that values are published to.
    target: Option<Target>,
    /// The node of Sparkplug B that publishes them.
    node: Option<NodeName>,
}

impl Wanted {
    /// Whether any client can connect.
    fn has_port(&self) -> bool {
        self.s7.or(self.modbus).or(self.opcua).or(self.metrics).or(self.web).is_some()
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
