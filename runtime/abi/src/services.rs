//! `[services]` of plc.toml: which parts of a program clients can reach, and who may connect.
//!
//! Addresses are texts, `ADDR:PORT` or a port alone; plcc has checked them.

use serde::{Deserialize, Serialize};

use crate::monitor::Probes;

/// See the module comment.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ServicesConfig {
    /// plc.toml has the table: executables have the services.
    pub linked: bool,
    pub s7: Option<String>,
    pub modbus: Option<String>,
    pub opcua: Option<String>,
    /// Where the certificate and the key of the OPC UA server are, seen from where the program runs.
    pub opcua_folder: Option<String>,
    /// OPC UA clients of other computers may come in without security.
    pub opcua_unsecured: bool,
    pub metrics: Option<String>,
    /// Of the page.
    pub web: Option<String>,
    /// Who may sign in on the page; without users everyone may look.
    pub users: Vec<User>,
    /// The program as an HTML document, compressed by gzip, for the page.
    pub drawings: Vec<u8>,
    /// What the second code of the program tells, which has probes; `None`: there is no such code.
    pub probes: Option<Probes>,
    /// Folder of the certificate of the page and the metrics, seen from where the program runs.
    pub tls: Option<String>,
    /// Folder of the watch tables of the page, seen from where the program runs.
    pub tables: Option<String>,
    /// URL of a broker.
    pub mqtt: Option<String>,
    /// Files for a broker with TLS, seen from where the program runs: certificates of its authority, own certificate and its key.
    pub mqtt_ca: Option<String>,
    pub mqtt_certificate: Option<String>,
    pub mqtt_key: Option<String>,
    /// Node of Sparkplug B: `GROUP/NODE` or `GROUP/NODE/DEVICE`.
    pub sparkplug: Option<String>,
    /// What clients may do that no entry of `clients` names.
    pub access: Option<Right>,
    /// If there are any, no one else is a client.
    pub clients: Vec<Client>,
    pub protection: Protection,
    /// The hash of the password that lifts the protection: argon2, as a PHC string.
    pub password: Option<String>,
    /// Percent of the cycle time that clients may take.
    pub communication_load: Option<u8>,
    pub registers: Registers,
    /// What is published: names or addresses, as `--print` takes them.
    pub values: Vec<String>,
    /// Everything is published again after this time.
    pub interval_ms: Option<u32>,
}

/// What a client may do; each one includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Right {
    Read,
    Write,
    /// Stop and start the CPU, set its clock.
    Control,
}

/// A person who may sign in on the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct User {
    pub name: String,
    pub role: Role,
    /// The hash of the password: argon2, as a PHC string.
    pub password: String,
}

/// What a user may do; each one includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    Look,
    /// Change values.
    Operate,
    /// Stop and start the CPU.
    Change,
}

/// Computers and what they may do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Client {
    /// `192.168.0.7`, or a part of a network: `192.168.0.0/24`.
    pub address: String,
    pub right: Right,
}

/// Protection levels of a CPU. Source: CPU manuals, protection; S7comm reference, access rules.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Protection {
    #[default]
    None,
    /// Programs are not written: clients of variables notice nothing.
    Write,
    /// Without the password the CPU is not stopped or started, and its clock is not set.
    ReadWrite,
    /// S7-1200/1500: without the password nothing is read or written either.
    Complete,
}

/// Where the registers and bits of Modbus begin: addresses, as `--print` takes them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Registers {
    pub coils: String,
    pub discrete_inputs: String,
    pub input_registers: String,
    pub holding_registers: String,
}

impl Default for Registers {
    /// As MB_SERVER of an S7-1200 has them; holding registers, which it has in a data block, are in M.
    fn default() -> Registers {
        let text = str::to_string;
        Registers {
            coils: text("Q0.0"),
            discrete_inputs: text("I0.0"),
            input_registers: text("IW0"),
            holding_registers: text("MW0"),
        }
    }
}
