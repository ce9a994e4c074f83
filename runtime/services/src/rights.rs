//! Who may do what.

use std::net::IpAddr;

use plcc_abi::services::{Client, Right, ServicesConfig};

/// The connection list.
#[derive(Clone, Debug)]
pub struct Clients {
    list: Vec<(Network, Right)>,
    /// Of everyone else.
    others: Option<Right>,
    /// No one may do more.
    most: Right,
}

/// Computers whose addresses begin alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Network {
    address: IpAddr,
    /// Bits that count.
    bits: u8,
}

impl Network {
    /// `192.168.0.7`, `192.168.0.0/24`. An address of IPv4 in the form of IPv6 is the same computer: `::ffff:192.168.0.7`.
    fn parse(text: &str) -> Option<Network> {
        /// Bits before the address of IPv4.
        const MAPPED_BITS: u8 = 96;
        let (address, bits) = match text.split_once('/') {
            Some((address, bits)) => (address, Some(bits.parse().ok()?)),
            None => (text, None),
        };
        let address: IpAddr = address.parse().ok()?;
        let most = if address.is_ipv4() { 32 } else { 128 };
        let bits: u8 = bits.unwrap_or(most);
        if bits > most {
            return None;
        }
        match address.to_canonical() {
            short if short != address => Some(Network { address: short, bits: bits.checked_sub(MAPPED_BITS)? }),
            _ => Some(Network { address, bits }),
        }
    }

    fn contains(&self, other: IpAddr) -> bool {
        let same = |own: u128, other: u128, all: u32| {
            // All bits of an address may count, or none.
            let shift = all - u32::from(self.bits);
            own.checked_shr(shift).unwrap_or(0) == other.checked_shr(shift).unwrap_or(0)
        };
        match (self.address, other) {
            (IpAddr::V4(own), IpAddr::V4(other)) => same(own.to_bits().into(), other.to_bits().into(), 32),
            (IpAddr::V6(own), IpAddr::V6(other)) => same(own.to_bits(), other.to_bits(), 128),
            (IpAddr::V4(_), IpAddr::V6(_)) | (IpAddr::V6(_), IpAddr::V4(_)) => false,
        }
    }
}

/// Whether a text names a computer or a network, for plc.toml.
pub fn is_network(text: &str) -> bool {
    Network::parse(text).is_some()
}

/// Whether two texts name the same computers.
pub fn is_same_network(one: &str, other: &str) -> bool {
    match (Network::parse(one), Network::parse(other)) {
        (Some(one), Some(other)) => one.bits == other.bits && one.contains(other.address),
        (Some(_) | None, _) => false,
    }
}

impl Clients {
    /// `most`: what the flags allow; they allow no one who is not in a list.
    pub fn new(config: &ServicesConfig, most: Option<Right>) -> Clients {
        let entry = |client: &Client| Some((Network::parse(&client.address)?, client.right));
        let list: Vec<_> = config.clients.iter().filter_map(entry).collect();
        let default = config.access.unwrap_or(Right::Write);
        match config.clients.is_empty() {
            true => Clients { list, others: Some(most.unwrap_or(default)), most: Right::Control },
            false => Clients { list, others: config.access, most: most.unwrap_or(Right::Control) },
        }
    }

    /// What a computer may do; `None`: it may not connect. The entry that names it most exactly counts.
    pub fn of(&self, address: IpAddr) -> Option<Right> {
        let address = address.to_canonical();
        let named = self.list.iter().filter(|(network, _)| network.contains(address));
        let found = named.max_by_key(|(network, _)| network.bits).map(|(_, right)| *right);
        found.or(self.others).map(|right| right.min(self.most))
    }

    /// The words for the line that says what was opened. `control`: what a client with this right may do, which the
    /// protocol decides.
    pub fn text(&self, control: &str) -> String {
        let may = |right: Right| match right.min(self.most) {
            Right::Read => "read".to_string(),
            Right::Write => "read and write".to_string(),
            Right::Control => control.to_string(),
        };
        match (self.list.len(), self.others) {
            (0, others) => format!("clients may {}", may(others.unwrap_or(Right::Read))),
            (_, None) => "clients of the connection list".to_string(),
            (_, Some(others)) => format!("clients of the connection list; others may {}", may(others)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn client(address: &str, right: Right) -> Client {
        Client { address: address.to_string(), right }
    }

    fn of(clients: &Clients, address: &str) -> Option<Right> {
        clients.of(address.parse().unwrap())
    }

    #[test]
    fn without_a_list_everyone_is_a_client() {
        let clients = Clients::new(&ServicesConfig::default(), None);
        assert_eq!(of(&clients, "10.0.0.1"), Some(Right::Write));
        let clients = Clients::new(&ServicesConfig::default(), Some(Right::Read));
        assert_eq!(of(&clients, "::1"), Some(Right::Read));
    }

    #[test]
    fn the_protocol_decides_what_control_means() {
        let clients = Clients::new(&ServicesConfig::default(), Some(Right::Control));
        assert_eq!(clients.text("read and write"), "clients may read and write");
        assert_eq!(clients.text("read, write and set the clock"), "clients may read, write and set the clock");
        let clients = Clients::new(&ServicesConfig::default(), Some(Right::Read));
        assert_eq!(clients.text("read and write"), "clients may read");
    }

    #[test]
    fn the_most_exact_entry_counts() {
        let list = vec![
            client("192.168.0.0/16", Right::Read),
            client("192.168.7.9", Right::Control),
            client("fd00::/8", Right::Write),
        ];
        let config = ServicesConfig { clients: list, ..ServicesConfig::default() };
        let clients = Clients::new(&config, None);
        assert_eq!(of(&clients, "192.168.7.8"), Some(Right::Read));
        assert_eq!(of(&clients, "192.168.7.9"), Some(Right::Control));
        // As a server of IPv6 sees a client of IPv4.
        assert_eq!(of(&clients, "::ffff:192.168.7.9"), Some(Right::Control));
        assert_eq!(of(&clients, "fdff::1"), Some(Right::Write));
        assert_eq!(of(&clients, "10.0.0.1"), None);
        assert_eq!(of(&Clients::new(&config, Some(Right::Write)), "192.168.7.9"), Some(Right::Write));
        let list = vec![client("::ffff:10.0.0.5", Right::Write), client("::ffff:10.0.0.0/104", Right::Read)];
        let mapped = Clients::new(&ServicesConfig { clients: list, ..ServicesConfig::default() }, None);
        assert_eq!(of(&mapped, "10.0.0.5"), Some(Right::Write));
        assert_eq!(of(&mapped, "::ffff:10.0.0.5"), Some(Right::Write));
        assert_eq!(of(&mapped, "10.9.9.9"), Some(Right::Read));
        assert_eq!(of(&mapped, "11.0.0.5"), None);
        let all = ServicesConfig { clients: vec![client("0.0.0.0/0", Right::Read)], ..ServicesConfig::default() };
        assert_eq!(of(&Clients::new(&all, None), "10.0.0.1"), Some(Right::Read));
    }

    #[test]
    fn networks_are_compared_by_the_bits_that_count() {
        for (one, other, same) in [
            ("192.168.0.7", "192.168.0.7/32", true),
            ("10.0.0.0/8", "10.1.2.3/8", true),
            ("10.0.0.0/8", "10.0.0.0/16", false),
            ("10.0.0.0/8", "11.0.0.0/8", false),
            ("fd00::/8", "fdff::1/8", true),
            ("0.0.0.0/0", "::/0", false),
            ("10.0.0.5", "::ffff:10.0.0.5", true),
            ("10.0.0.0/24", "::ffff:10.0.0.0/120", true),
            ("localhost", "localhost", false),
        ] {
            assert_eq!(is_same_network(one, other), same, "{one} {other}");
        }
    }

    #[test]
    fn wrong_networks_are_none() {
        let short = "::ffff:10.0.0.0/24";
        for text in ["", "192.168.0", "192.168.0.0/33", "::/129", "localhost", "10.0.0.0/", "10.0.0.0/-1", short] {
            assert!(!is_network(text), "{text}");
        }
    }
}
