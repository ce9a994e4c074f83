//! Configured S7 connections of the program: `[connection.ID]` of plc.toml.

use serde::{Deserialize, Serialize};

/// A connection that blocks name by its ID. Source: Communication with SIMATIC, connection table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct S7Connection {
    /// The local ID: never 0.
    pub id: u16,
    /// The partner: `192.168.0.7:102`. `None` only where any partner may connect.
    pub partner: Option<String>,
    /// This side connects; else the S7 server of this program waits for the partner.
    pub active: bool,
    /// 2 to 16 bytes.
    pub local_tsap: Vec<u8>,
    /// 2 to 16 bytes; empty only where the partner connects: any.
    pub remote_tsap: Vec<u8>,
}
