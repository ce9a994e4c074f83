//! An OPC UA server: the binary protocol on TCP, for SCADA systems and MES. Source: OPC 10000-4 and 10000-6.
//!
//! - [`code`]: the binary encoding; [`status`]: status codes.
//! - [`crypto`], [`certificate`], [`channel`]: secure channels.
//! - [`connection`]: one client; [`session`]: who it is; [`identity`]: endpoints and users.
//! - [`standard`], [`space`]: the nodes; [`values`]: PLC values as variants; [`attributes`]: reading and writing; [`view`]: browsing.
//! - [`subscription`]: values as they change.
//!
//! A session belongs to its connection: what a client has is gone when the connection is. So nothing is shared between clients.

mod attributes;
mod certificate;
mod channel;
mod code;
mod connection;
mod crypto;
mod identity;
mod session;
mod space;
mod standard;
mod status;
mod subscription;
#[cfg(test)]
mod tests;
mod values;
mod view;

use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::services::{Protection, Right, ServicesConfig};
use tokio::sync::Semaphore;

use crate::link::Link;
use crate::web::Users;
use certificate::{Own, Trusted};
pub use connection::serve;
use space::Space;

/// The folder of certificates, unless plc.toml names another.
const FOLDER: &str = "opcua";

/// What all connections share.
pub struct Server {
    link: Link,
    space: Space,
    users: Users,
    own: Own,
    trusted: Option<Trusted>,
    /// Name of this server in the world.
    uri: String,
    /// Of its name for people.
    name: String,
    address: SocketAddr,
    /// Channels without security may have sessions.
    is_open: bool,
    /// What somebody may do at most who does not sign in; `None`: nothing.
    anonymous: Option<Right>,
    /// Since when, 100 ns since 1601.
    started: i64,
    /// Private keys and passwords are used by one client after the other: that takes time.
    one: Arc<Semaphore>,
}

impl Server {
    /// Reads or makes the certificate. `Err`: why there is none.
    pub fn new(
        link: Link,
        config: &ServicesConfig,
        image: &ProgramImage,
        address: SocketAddr,
    ) -> Result<Server, String> {
        let folder = Path::new(config.opcua_folder.as_deref().unwrap_or(FOLDER));
        let name: String =
            image.name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '-' }).take(64).collect();
        let uri = format!("urn:plcc:{name}");
        let own = Own::load(folder, &uri, &name, address.ip())?;
        let trusted = Trusted::load(folder)?;
        Ok(Server {
            link,
            space: Space::new(image),
            users: Users::new(&config.users),
            own,
            trusted,
            uri,
            name: image.name.clone(),
            address,
            is_open: address.ip().is_loopback() || config.opcua_unsecured,
            anonymous: match config.protection {
                Protection::None | Protection::Write => Some(Right::Control),
                Protection::ReadWrite => Some(Right::Write),
                Protection::Complete => None,
            },
            started: code::now(),
            one: Arc::new(Semaphore::new(1)),
        })
    }

    /// As a line about what was opened tells it.
    pub fn text(&self, clients: &str) -> String {
        match (self.users.is_open(), self.anonymous) {
            (true, None) => "nobody can sign in: complete protection, and no users".to_string(),
            (true, Some(_)) => clients.to_string(),
            (false, _) => "users may sign in".to_string(),
        }
    }
}
