//! Opens what the flags and plc.toml ask for: doors for clients, and the ways to a broker and to partners. A thread runs them.

use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::connections::S7Connection;
use plcc_abi::services::Protection;
use plcc_runtime::change::Loader;
use plcc_runtime::partners::Board;
use tokio::runtime::Builder;
use tokio_rustls::TlsAcceptor;

use super::{control_of_opcua, control_of_s7};
use crate::link::Link;
use crate::listen::{self, Door, Open, Visitor};
use crate::metrics::{self, CycleTimes, Pages};
use crate::modbus::{self, Map};
use crate::mqtt::Target;
use crate::mqtt::sparkplug::{self, Node, NodeName};
use crate::mqtt::values::{self, Publisher};
use crate::opcua;
use crate::password::Guard;
use crate::rights::Clients;
use crate::s7;
use crate::tls;
use crate::web::{self, Page, Tables, Users};

/// Services that are opened one after the other.
pub struct Opening<'a> {
    image: &'a ProgramImage,
    clients: Clients,
    link: Link,
    plan: Plan,
    /// What was opened, a line each.
    opened: Vec<String>,
}

impl<'a> Opening<'a> {
    pub fn new(image: &'a ProgramImage, clients: Clients, link: Link) -> Opening<'a> {
        Opening { image, clients, link, plan: Plan::default(), opened: Vec::new() }
    }

    /// Encrypts the page and the metrics, which are opened later. `address`: where.
    pub fn encrypt(&mut self, folder: &str, address: SocketAddr) -> Result<(), String> {
        self.plan.tls = Some(tls::server(Path::new(folder), &self.image.name, address.ip())?);
        Ok(())
    }

    /// The port of S7 clients, if there is to be one, and the connections to partners.
    pub fn s7(&mut self, address: Option<SocketAddr>, board: Option<Arc<Board>>) -> Result<(), String> {
        let image = self.image;
        let config = &image.config.services;
        let guard = Guard::new(config.password.as_deref());
        let protection = config.protection;
        let server = s7::Server { link: self.link.clone(), guard, protection, board: board.clone() };
        if let Some(address) = address {
            let door = listen::open("s7", address, self.clients.clone())?;
            let has_password = config.password.is_some();
            let control = control_of_s7(image.profile.family.is_portal(), protection, has_password);
            let is_locked = protection == Protection::Complete && has_password;
            let locked = if is_locked { ", all of it with the password" } else { "" };
            self.opened.push(line("S7 clients", &door, &format!("{}{locked}", self.clients.text(control))));
            self.plan.s7 = Some((door, server.clone()));
        }
        for (number, connection) in board.iter().flat_map(|board| board.connections().iter().enumerate()) {
            self.opened.push(partner(connection, address.is_some()));
            if connection.active {
                // A partner reaches nothing here unless clients do.
                let rights = address.map(|_| self.clients.clone());
                self.plan.partners.push((server.clone(), number, rights));
            }
        }
        Ok(())
    }

    /// The port of Modbus TCP clients.
    pub fn modbus(&mut self, address: SocketAddr) -> Result<(), String> {
        let map = Map::new(&self.image.config.services.registers, self.image)?;
        let door = listen::open("modbus", address, self.clients.clone())?;
        self.opened.push(line("Modbus TCP clients", &door, &self.clients.text("read and write")));
        self.plan.modbus = Some((door, self.link.clone(), map));
        Ok(())
    }

    /// The port of OPC UA clients.
    pub fn opcua(&mut self, address: SocketAddr) -> Result<(), String> {
        let config = &self.image.config.services;
        let server = opcua::Server::new(self.link.clone(), config, self.image, address)?;
        let door = listen::open("opcua", address, self.clients.clone())?;
        let control = control_of_opcua(config.protection);
        self.opened.push(line("OPC UA clients", &door, &server.text(&self.clients.text(control))));
        self.plan.opcua = Some((door, Arc::new(server)));
        Ok(())
    }

    /// The page. `allow_load`: clients may load programs, with `loader`.
    pub fn page(
        &mut self,
        address: SocketAddr,
        allow_load: bool,
        loader: Option<Loader>,
        tables: Option<Tables>,
    ) -> Result<(), String> {
        let users = Users::new(&self.image.config.services.users);
        if users.is_open() && !address.ip().is_loopback() {
            return Err(format!(
                "--web {address}: without `[[services.user]]` in plc.toml the page is for this computer only"
            ));
        }
        let door = listen::open("web", address, self.clients.clone())?;
        let services = self.services_with(&door);
        let who = match (users.is_open(), allow_load) {
            (true, false) => "everyone on this computer may look",
            (true, true) => "everyone on this computer may look and load programs",
            (false, _) => "users may sign in",
        };
        let is_secure = self.plan.tls.is_some();
        let scheme = if is_secure { "https" } else { "http" };
        self.opened.push(line("page", &door, who).replacen(" at ", &format!(" at {scheme}://"), 1));
        let loader = loader.filter(|_| allow_load);
        self.plan.web = Some((door, Page::new(self.link.clone(), users, services, loader, is_secure, tables)));
        Ok(())
    }

    /// The port of /metrics and /health.
    pub fn metrics(&mut self, address: SocketAddr, times: Arc<CycleTimes>) -> Result<(), String> {
        let door = listen::open("metrics", address, self.clients.clone())?;
        let who = if self.plan.tls.is_some() { "HTTPS clients" } else { "HTTP clients" };
        self.opened.push(line(who, &door, "/metrics and /health"));
        let services = self.services_with(&door);
        self.plan.metrics = Some((door, Pages { link: self.link.clone(), times, services }));
        Ok(())
    }

    /// Publishes values to a broker, those of a node of Sparkplug B if it has a name.
    pub fn broker(&mut self, target: Target, node: Option<NodeName>, values: &[String]) -> Result<(), String> {
        match node {
            Some(name) => {
                let node = Node::new(target, name, values, self.image, self.clients.clone())?;
                self.opened.push(node.text());
                self.plan.node = Some((node, self.link.clone()));
            }
            None => {
                let interval_ms = self.image.config.services.interval_ms;
                let publisher = Publisher::new(target, values, interval_ms, self.image)?;
                self.opened.push(publisher.text());
                self.plan.publisher = Some((publisher, self.link.clone()));
            }
        }
        Ok(())
    }

    /// Starts the services. Result: what was opened, a line each.
    pub fn start(mut self) -> Result<Vec<String>, String> {
        let config = &self.image.config.services;
        if config.protection == Protection::Complete && config.password.is_none() && self.plan.s7.is_some() {
            let nothing = "S7 clients cannot reach anything: complete protection, and no password";
            self.opened.push(nothing.to_string());
        }
        self.plan.start()?;
        Ok(self.opened)
    }

    /// The connections of each service that is open, and of another one.
    fn services_with(&self, door: &Door) -> Vec<(&'static str, Open)> {
        let doors = [
            self.plan.s7.as_ref().map(|(door, _)| door),
            self.plan.modbus.as_ref().map(|(door, ..)| door),
            self.plan.opcua.as_ref().map(|(door, _)| door),
            self.plan.web.as_ref().map(|(door, _)| door),
            Some(door),
        ];
        doors.into_iter().flatten().map(|door| (door.service, door.open.clone())).collect()
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
#[derive(Default)]
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
