//! An OPC UA server: the binary protocol on TCP, for SCADA systems and MES. Source: OPC 10000-4 and 10000-6.
//!
//! - [`code`]: the binary encoding; [`status`]: status codes.
//! - [`crypto`], [`certificate`], [`channel`]: secure channels.
//! - [`connection`]: one client; [`session`]: who it is; [`identity`]: endpoints and users.
//! - [`standard`], [`space`]: the nodes; [`values`], [`structures`]: PLC values as variants; [`range`]: parts of arrays; [`attributes`]: reading
//!   and writing; [`view`]: browsing.
//! - [`subscription`]: values as they change; [`events`]: the diagnostic buffer as events.
//!
//! A session belongs to its connection: what a client has is gone when the connection is. So nothing is shared between clients. When the program
//! is changed while it runs, a connection goes on with the new nodes, unless a structure that clients know has changed.

mod attributes;
mod certificate;
mod channel;
pub(crate) mod code;
mod connection;
pub(crate) mod crypto;
mod events;
mod identity;
mod range;
mod session;
mod space;
mod standard;
pub(crate) mod status;
mod structures;
mod subscription;
#[cfg(test)]
mod tests;
mod unit;
pub(crate) mod values;
mod view;

use std::net::SocketAddr;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use plcc_abi::ProgramImage;
use plcc_abi::services::{Protection, Right, ServicesConfig};
use tokio::sync::Semaphore;

use crate::certificate::plain_name;
use crate::link::Link;
use crate::web::Users;
use certificate::{Own, Trusted};
pub use connection::serve;
use space::Space;

/// The folder of certificates, unless plc.toml names another.
const FOLDER: &str = "opcua";

/// What a connection needs. Connections share all of it.
#[derive(Clone)]
pub struct Server {
    link: Link,
    /// The nodes of the program as it was when the connection began.
    space: Arc<Space>,
    newest: Arc<Mutex<Arc<Space>>>,
    users: Users,
    own: Arc<Own>,
    trusted: Option<Arc<Trusted>>,
    /// Name of this server in the world.
    uri: String,
    /// Of its name for people.
    name: String,
    address: SocketAddr,
    /// Channels without security may have sessions.
    is_open: bool,
    /// The most that a client may do without signing in; `None`: nothing.
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
        let name = plain_name(&image.name);
        let uri = format!("urn:plcc:{name}");
        let own = Own::load(folder, &uri, &name, address.ip())?;
        let trusted = Trusted::load(folder)?;
        let space = Arc::new(Space::new(image, 0));
        Ok(Server {
            link,
            newest: Arc::new(Mutex::new(space.clone())),
            space,
            users: Users::new(&config.users),
            own: Arc::new(own),
            trusted: trusted.map(Arc::new),
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

    /// With the nodes of the program that runs now. `None`: the CPU has ended.
    async fn renewed(&self) -> Option<Server> {
        let newest = || self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        let known = newest().clone();
        let generation = known.generation();
        let changed = self
            .link
            .ask(move |cpu| (cpu.generation() != generation).then(|| (Arc::clone(&cpu.image), cpu.generation())));
        let Some((image, generation)) = changed.await? else { return Some(Server { space: known, ..self.clone() }) };
        let made = tokio::task::spawn_blocking(move || Arc::new(Space::new(&image, generation)));
        let space = made.await.ok()?;
        *newest() = space.clone();
        Some(Server { space, ..self.clone() })
    }

    /// The words for the line that says what was opened.
    pub fn text(&self, clients: &str) -> String {
        match (self.users.is_open(), self.anonymous) {
            (true, None) => "no one can sign in: the protection is complete, and there are no users".to_string(),
            (true, Some(_)) => clients.to_string(),
            (false, _) => "users may sign in".to_string(),
        }
    }
}
