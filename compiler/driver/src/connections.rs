//! `[connection.ID]` of plc.toml: configured S7 connections of the program.

use std::collections::BTreeMap;

use plcc_abi::connections::S7Connection;
use plcc_diag::{Diagnostic, FileId};
use serde::Deserialize;
use toml::Spanned;

use crate::keys::Reader;
use crate::project::number_within;

/// `[connection.ID]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConnectionKeys {
    partner: Option<Spanned<String>>,
    #[serde(default)]
    passive: bool,
    rack: Option<Spanned<i64>>,
    slot: Option<Spanned<i64>>,
    local_tsap: Option<Spanned<String>>,
    remote_tsap: Option<Spanned<String>>,
}

/// Port of S7 communication.
const PORT: u16 = 102;
/// First byte of the TSAP of a CPU for connections that the partner has not configured.
const OTHER: u8 = 3;
/// Connections of a program.
const CONNECTIONS_MAX: usize = 32;
const TSAP_BYTES: std::ops::RangeInclusive<usize> = 2..=16;

/// Reads the tables. Reports wrong keys and ignores them.
pub fn read(tables: &BTreeMap<Spanned<String>, ConnectionKeys>, file: FileId) -> (Vec<S7Connection>, Vec<Diagnostic>) {
    let mut reader = Reader::new(file);
    let mut tables: Vec<_> = tables.iter().collect();
    tables.sort_by_key(|(name, _)| name.span().start);
    if let Some((name, _)) = tables.get(CONNECTIONS_MAX) {
        reader.report(name, format!("more than {CONNECTIONS_MAX} connections"), "leave some out");
    }
    // Messages name them as they are written.
    let mut found: Vec<(&str, S7Connection)> = Vec::new();
    for (name, keys) in tables.into_iter().take(CONNECTIONS_MAX) {
        let Some(connection) = reader.connection(name, keys) else { continue };
        let own = name.get_ref().as_str();
        if let Some((first, _)) = found.iter().find(|(_, other)| other.id == connection.id) {
            reader.report(name, format!("`{first}` and `{own}` are one connection"), "give each its own ID");
        }
        let same = |(_, other): &&(&str, S7Connection)| {
            !other.active
                && !connection.active
                && other.local_tsap == connection.local_tsap
                && (other.remote_tsap == connection.remote_tsap
                    || other.remote_tsap.is_empty()
                    || connection.remote_tsap.is_empty())
        };
        if let Some((other, _)) = found.iter().find(same) {
            let title = format!("connections {other} and {own} have the same TSAPs");
            reader.report(name, title, "partners that connect are told apart by their TSAPs");
        }
        found.push((own, connection));
    }
    (found.into_iter().map(|(_, connection)| connection).collect(), reader.diagnostics)
}

/// `1`, `256` or `16#100`, as the parameter ID of the blocks.
fn id(text: &str) -> Option<u16> {
    let upper = text.trim().to_ascii_uppercase();
    let digits = upper.strip_prefix("W#").unwrap_or(&upper);
    let number = match digits.strip_prefix("16#") {
        Some(digits) => u16::from_str_radix(digits, 16).ok()?,
        None => digits.parse().ok()?,
    };
    (number != 0).then_some(number)
}

/// `10.02`: bytes in hexadecimal.
fn tsap(text: &str) -> Option<Vec<u8>> {
    let byte = |part: &str| match part.len() {
        2 => u8::from_str_radix(part, 16).ok(),
        _ => None,
    };
    text.split('.').map(byte).collect::<Option<Vec<u8>>>().filter(|bytes| TSAP_BYTES.contains(&bytes.len()))
}

/// `192.168.0.7` or `192.168.0.7:10102`, with the port. A name is looked up when the program connects.
fn address(text: &str) -> Option<String> {
    let text = text.trim();
    let port = |port: &str| port.parse::<u16>().is_ok_and(|port| port != 0);
    match text.rsplit_once(':') {
        _ if text.is_empty() || text.contains(char::is_whitespace) => None,
        Some((host, number)) if !host.is_empty() && (!host.contains(':') || host.ends_with(']')) => {
            port(number).then(|| text.to_string())
        }
        Some(_) => Some(format!("[{text}]:{PORT}")).filter(|_| text.parse::<std::net::Ipv6Addr>().is_ok()),
        None => Some(format!("{text}:{PORT}")),
    }
}

impl Reader {
    fn connection(&mut self, name: &Spanned<String>, keys: &ConnectionKeys) -> Option<S7Connection> {
        let own = id(name.get_ref());
        if own.is_none() {
            let title = format!("`{}` is not the ID of a connection", name.get_ref());
            self.report(name, title, "write `[connection.1]` or `[connection.\"16#100\"]`, as ID of the blocks");
        }
        let partner = keys.partner.as_ref().and_then(|key| {
            let found = address(key.get_ref());
            if found.is_none() {
                self.report(key, format!("`{}` is not an address", key.get_ref()), "write `192.168.0.7:102`");
            }
            found
        });
        let local = self.tsap(&keys.local_tsap);
        let remote = self.tsap(&keys.remote_tsap);
        let rack = self.place(&keys.rack, 0..=7, "a rack", 0);
        let slot = self.place(&keys.slot, 0..=31, "a slot", 2);
        for key in [&keys.rack, &keys.slot].into_iter().flatten().filter(|_| keys.passive || remote.is_some()) {
            let title = "rack and slot are of a partner to which this side connects, without `remote_tsap`";
            self.report(key, title.to_string(), "leave it out");
        }
        if keys.partner.is_none() && !keys.passive {
            self.report(name, "a connection needs `partner`".to_string(), "write `partner = \"192.168.0.7\"`");
            return None;
        }
        if let Some(key) = keys.partner.as_ref().filter(|_| keys.passive) {
            let ip = partner.as_ref().is_none_or(|text| text.parse::<std::net::SocketAddr>().is_ok());
            if !ip {
                let title = "a partner that connects is compared by its address".to_string();
                self.report(key, title, "write `partner = \"192.168.0.7\"`, or leave it out");
            }
        }
        if keys.passive && keys.local_tsap.is_none() {
            let help = "write `local_tsap = \"10.01\"`, which the partner has as its remote TSAP";
            self.report(name, "a partner that connects is found by `local_tsap`".to_string(), help);
            return None;
        }
        let usual = vec![OTHER, rack? << 5 | slot?];
        Some(S7Connection {
            id: own?,
            partner: if keys.partner.is_some() { Some(partner?) } else { None },
            active: !keys.passive,
            local_tsap: local.unwrap_or_else(|| vec![OTHER, 0]),
            remote_tsap: remote.unwrap_or(if keys.passive { Vec::new() } else { usual }),
        })
    }

    fn place(
        &mut self,
        key: &Option<Spanned<i64>>,
        range: std::ops::RangeInclusive<i64>,
        what: &str,
        usual: u8,
    ) -> Option<u8> {
        match key {
            None => Some(usual),
            Some(key) => {
                let help = "leave it out for rack 0 and slot 2; an S7-1200/1500 is in rack 0 and slot 1";
                number_within(key, range, what).map_err(|title| self.report(key, title, help)).ok()
            }
        }
    }

    fn tsap(&mut self, key: &Option<Spanned<String>>) -> Option<Vec<u8>> {
        let key = key.as_ref()?;
        let found = tsap(key.get_ref());
        if found.is_none() {
            let title = format!("`{}` is not a TSAP", key.get_ref());
            self.report(key, title, "write 2 to 16 bytes in hexadecimal: `10.02`");
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_diag::SourceFile;

    fn config(text: &str) -> (Vec<S7Connection>, bool, Vec<String>) {
        let source = SourceFile::new("plc.toml", text);
        let (project, messages) = crate::project::parse(FileId(0), &source);
        let titles = messages.into_iter().map(|message| message.title).collect();
        (project.config.connections, project.config.services.linked, titles)
    }

    #[test]
    fn connections_are_read() {
        let (found, linked, messages) = config(
            "[connection.1]\npartner = \"192.168.0.7\"\nrack = 1\nslot = 3\n\
             [connection.\"16#100\"]\npartner = \"plant:10102\"\nlocal_tsap = \"10.01\"\nremote_tsap = \"10.0A\"\n\
             [connection.3]\npassive = true\nlocal_tsap = \"10.01\"\n",
        );
        assert_eq!(messages, Vec::<String>::new());
        assert!(linked, "the program needs the services");
        let connection = |id, partner: Option<&str>, active, local_tsap: [u8; 2], remote_tsap: &[u8]| S7Connection {
            id,
            partner: partner.map(str::to_string),
            active,
            local_tsap: local_tsap.to_vec(),
            remote_tsap: remote_tsap.to_vec(),
        };
        assert_eq!(
            found,
            [
                connection(1, Some("192.168.0.7:102"), true, [3, 0], &[3, 0x23]),
                connection(256, Some("plant:10102"), true, [0x10, 1], &[0x10, 0x0A]),
                connection(3, None, false, [0x10, 1], &[]),
            ]
        );
    }

    #[test]
    fn wrong_connections_are_reported() {
        for (text, expected) in [
            ("[connection.0]\npartner = \"a\"\n", "`0` is not the ID of a connection"),
            ("[connection.1]\n", "a connection needs `partner`"),
            ("[connection.1]\npartner = \"a:b\"\n", "`a:b` is not an address"),
            ("[connection.1]\npartner = \"a\"\nlocal_tsap = \"1\"\n", "`1` is not a TSAP"),
            ("[connection.1]\npassive = true\n", "a partner that connects is found by `local_tsap`"),
            ("[connection.1]\npartner = \"a\"\nslot = 32\n", "32 is not a slot from 0 to 31"),
            (
                "[connection.1]\npartner = \"a\"\n[connection.\"16#1\"]\npartner = \"b\"\n",
                "`1` and `16#1` are one connection",
            ),
            (
                "[connection.\"16#100\"]\npartner = \"a\"\n[connection.256]\npartner = \"b\"\n",
                "`16#100` and `256` are one connection",
            ),
            (
                "[connection.\"16#100\"]\npassive = true\nlocal_tsap = \"10.01\"\n\
                 [connection.2]\npassive = true\nlocal_tsap = \"10.01\"\n",
                "connections 16#100 and 2 have the same TSAPs",
            ),
            (
                "[connection.1]\npassive = true\nlocal_tsap = \"10.01\"\n\
                 [connection.2]\npassive = true\nlocal_tsap = \"10.01\"\nremote_tsap = \"10.02\"\n",
                "connections 1 and 2 have the same TSAPs",
            ),
        ] {
            let (_, _, messages) = config(text);
            assert!(messages.len() == 1 && messages[0] == expected, "{text}: {messages:?}");
        }
    }

    #[test]
    fn racks_and_slots_out_of_range_get_a_help() {
        for text in ["rack = 8", "slot = 32"] {
            let source = SourceFile::new("plc.toml", format!("[connection.1]\npartner = \"a\"\n{text}\n"));
            let (_, messages) = crate::project::parse(FileId(0), &source);
            let help = messages.first().and_then(|message| message.help.as_deref()).unwrap_or_default();
            assert!(help.contains("rack 0 and slot 1"), "{text}: {messages:?}");
        }
    }
}
