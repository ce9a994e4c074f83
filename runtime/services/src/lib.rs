//! What speaks to the outside: servers for clients of the CPU.
//!
//! A thread of its own runs all servers. They reach the CPU through a [`link`] only, which it looks at between two cycles. Nothing is open unless
//! a flag asks for it, and then only for this computer unless an address is written down.

mod access;
pub mod link;
pub mod s7;

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
        let Some(address) = self.s7 else { return Ok((None, Vec::new())) };
        let failed = |error: std::io::Error| match error.kind() {
            std::io::ErrorKind::PermissionDenied => {
                format!("--s7: port {} needs a right of the system; ports from 1024 on do not", address.port())
            }
            _ => format!("--s7: cannot listen on {address}: {error}"),
        };
        let listener = TcpListener::bind(address).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let opened = listener.local_addr().map_err(failed)?;
        let (link, desk) = link::link();
        let rights = s7::Rights { write: self.s7_access != Access::Read, control: self.s7_access == Access::Control };
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build().map_err(failed)?;
        let serve = move || {
            runtime.block_on(async {
                match tokio::net::TcpListener::from_std(listener) {
                    Ok(listener) => s7::serve(listener, link, rights).await,
                    // The descriptor was one a moment ago.
                    Err(error) => eprintln!("runtime: --s7: {error}"),
                }
            });
        };
        std::thread::Builder::new().name("services".to_string()).spawn(serve).map_err(failed)?;
        let may = match self.s7_access {
            Access::Read => "read",
            Access::Write => "read and write",
            Access::Control => "read, write and stop the CPU",
        };
        Ok((Some(Box::new(desk)), vec![format!("S7 clients at {opened} may {may}")]))
    }
}
