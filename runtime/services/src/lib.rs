//! What speaks to the outside: servers for clients of the CPU.
//!
//! A thread of its own runs all servers. They reach the CPU through a [`link`] only, which it looks at between two cycles. Nothing is open unless
//! a flag asks for it, and then only for this computer unless an address is written down.

mod access;
pub mod link;
pub mod s7;
pub mod web;

use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};

use clap::{Args, ValueEnum};
use plcc_runtime::online::Service;

/// Flags of the services.
#[derive(Args, Clone, Debug, Default)]
pub struct ServiceOptions {
    /// Answer S7 clients, as panels and libraries are: address and port, or a port of this computer alone
    #[arg(long, value_name = "ADDR:PORT", value_parser = address)]
    pub s7: Option<SocketAddr>,
    /// What S7 clients may do
    #[arg(long, value_name = "RIGHT", value_enum, default_value_t)]
    pub s7_access: Access,
    /// Serve a page that shows the CPU in a browser: address and port, or a port of this computer alone
    #[arg(long, value_name = "ADDR:PORT", value_parser = address)]
    pub web: Option<SocketAddr>,
}

/// What clients may do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Access {
    Read,
    #[default]
    Write,
    /// Write, stop the CPU, and set its clock.
    Control,
}

/// `0.0.0.0:102`, `[::]:102`, or a port alone, which is one of this computer.
fn address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = text.parse::<u16>() {
        return Ok(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
    }
    text.parse()
        .map_err(|_| format!("`{text}` is not an address with a port; write 127.0.0.1:{} or 0.0.0.0:{0}", s7::PORT))
}

impl ServiceOptions {
    /// Opens what the flags ask for. Result: what answers on the side of the CPU, and what was opened, a line each. `Err`: why not.
    pub fn open(&self) -> Result<(Option<Box<dyn Service>>, Vec<String>), String> {
        if self.s7.is_none() && self.web.is_none() {
            return Ok((None, Vec::new()));
        }
        let failed = |error: std::io::Error| format!("services: {error}");
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build().map_err(failed)?;
        let inside = runtime.enter();
        let (link, desk) = link::link();
        let mut lines = Vec::new();
        let mut servers = tokio::task::JoinSet::new();
        if let Some(address) = self.s7 {
            let (listener, opened) = listen("--s7", address)?;
            let may = match self.s7_access {
                Access::Read => "read",
                Access::Write => "read and write",
                Access::Control => "read, write and stop the CPU",
            };
            let rights =
                s7::Rights { write: self.s7_access != Access::Read, control: self.s7_access == Access::Control };
            lines.push(format!("S7 clients at {opened} may {may}"));
            servers.spawn_on(s7::serve(listener, link.clone(), rights), runtime.handle());
        }
        if let Some(address) = self.web {
            let users = web::Users::default();
            if users.is_open() && !address.ip().is_loopback() {
                return Err(format!("--web {address}: without users the page is for this computer only"));
            }
            let (listener, opened) = listen("--web", address)?;
            lines.push(format!("page at http://{opened}"));
            servers.spawn_on(web::serve(listener, link.clone(), users), runtime.handle());
        }
        drop(inside);
        let serve = move || runtime.block_on(async { while servers.join_next().await.is_some() {} });
        std::thread::Builder::new().name("services".to_string()).spawn(serve).map_err(failed)?;
        Ok((Some(Box::new(desk)), lines))
    }
}

/// Opens a port. Result: also the address, whose port may have been 0.
fn listen(flag: &str, address: SocketAddr) -> Result<(tokio::net::TcpListener, SocketAddr), String> {
    let failed = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::PermissionDenied => {
            format!("{flag}: port {} needs a right of the system; ports from 1024 on do not", address.port())
        }
        _ => format!("{flag}: cannot listen on {address}: {error}"),
    };
    let listener = TcpListener::bind(address).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    let opened = listener.local_addr().map_err(failed)?;
    Ok((tokio::net::TcpListener::from_std(listener).map_err(failed)?, opened))
}
