//! Connection descriptions, big-endian, each of another length: TCON_Param, TCON_IP_v4, TCON_IP_RFC, TCON_QDN, and the `_SEC` of two.
//!
//! Source: S7-1200 reference, TSEND_C and TRCV_C, parameters of the connection; S7-1500 information system, structure of the address data.

use std::net::Ipv4Addr;

/// Length of TCON_Param, which is also in its first word.
const PARAM_BYTES: usize = 64;
const IP_V4_BYTES: usize = 14;
const IP_RFC_BYTES: usize = 78;
const QDN_BYTES: usize = 266;
/// What TCON_IP_v4_SEC and TCON_QDN_SEC have after the description itself.
const SECURITY_BYTES: usize = 12;
const IP_V4_SEC_BYTES: usize = IP_V4_BYTES + SECURITY_BYTES;
const QDN_SEC_BYTES: usize = QDN_BYTES + SECURITY_BYTES;

/// Lengths of descriptions.
pub const LENGTHS: [usize; 6] = [PARAM_BYTES, IP_V4_BYTES, IP_RFC_BYTES, QDN_BYTES, IP_V4_SEC_BYTES, QDN_SEC_BYTES];

/// Connection types of TCON_Param.
const TYPE_TCP: u8 = 0x11;
const TYPE_ISO: u8 = 0x12;
/// Also in TCON_IP_v4.
const TYPE_UDP: u8 = 0x13;
/// Of an S7-300/400: TCP with the bytes of ports in the other order.
const TYPE_TCP_COMPATIBLE: u8 = 0x01;
/// Connection type of TCON_IP_v4.
const TYPE_TCP_IP_V4: u8 = 0x0B;
/// Connection type of TCON_IP_RFC.
const TYPE_ISO_IP_RFC: u8 = 0x0C;
/// Highest connection ID.
const ID_MAX: u16 = 4095;
/// Highest number of an interface of an S7-300/400. Source: System and standard functions, FB 65, local_device_id.
const CLASSIC_DEVICE_MAX: u8 = 6;
/// First character of a TSAP with rack and slot.
const TSAP_DEVICE: u8 = 0xE0;

/// STATUS of a description that cannot be used.
const ID_RANGE: u16 = 0x8086;
const LENGTH_WRONG: u16 = 0x809A;
const DEVICE_WRONG: u16 = 0x809B;
const INCONSISTENT: u16 = 0x80B3;
const TSAP_WRONG: u16 = 0x80B4;
/// There is no such certificate.
const CERTIFICATE: u16 = 0x80E2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    Tcp,
    /// RFC 1006 on TCP.
    Iso,
    Udp,
}

/// A checked connection description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    /// 1 to 4095.
    pub id: u16,
    pub protocol: Protocol,
    /// This side connects; else it waits for the partner.
    pub active: bool,
    /// TCP: own port; 0 only on an active side: any. UDP: own port.
    pub local_port: u16,
    /// `None` only on a passive side: anyone.
    pub remote: Option<Ipv4Addr>,
    /// Name of the partner if its address is not in the description; only on an active side.
    pub remote_name: String,
    /// TCP: port of the partner; 0 only on a passive side: any. UDP: where TSEND sends; 0: nowhere.
    pub remote_port: u16,
    /// ISO-on-TCP: 2 to 16 bytes.
    pub local_tsap: Vec<u8>,
    /// ISO-on-TCP: 2 to 16 bytes; empty only on a passive side: any.
    pub remote_tsap: Vec<u8>,
}

impl Description {
    /// Reads a description; its length shows its form. `classic`: as an S7-300/400 does. `Err`: STATUS.
    pub fn read(bytes: &[u8], classic: bool) -> Result<Description, u16> {
        match bytes.len() {
            PARAM_BYTES => param(bytes, classic),
            IP_V4_BYTES => ip_v4(bytes),
            IP_RFC_BYTES => ip_rfc(bytes),
            QDN_BYTES => qdn(bytes),
            IP_V4_SEC_BYTES => ip_v4(not_secured(bytes)?),
            QDN_SEC_BYTES => qdn(not_secured(bytes)?),
            _ => Err(LENGTH_WRONG),
        }
    }
}

fn word(bytes: &[u8], at: usize) -> u16 {
    u16::from_be_bytes([bytes[at], bytes[at + 1]])
}

fn check_id(id: u16) -> Result<u16, u16> {
    if (1..=ID_MAX).contains(&id) { Ok(id) } else { Err(ID_RANGE) }
}

fn address(bytes: &[u8]) -> Option<Ipv4Addr> {
    let address = Ipv4Addr::new(bytes[0], bytes[1], bytes[2], bytes[3]);
    (!address.is_unspecified()).then_some(address)
}

/// TCON_Param, all of its 64 bytes.
fn param(bytes: &[u8], classic: bool) -> Result<Description, u16> {
    if usize::from(word(bytes, 0)) != PARAM_BYTES {
        return Err(LENGTH_WRONG);
    }
    let id = check_id(word(bytes, 2))?;
    let active = bytes[5] & 1 != 0;
    // Interfaces of an S7-300/400 have numbers of their own.
    if bytes[6] != 1 && !(classic && bytes[6] <= CLASSIC_DEVICE_MAX) {
        return Err(DEVICE_WRONG);
    }
    if bytes[4] == TYPE_UDP {
        let port = word(bytes, 12);
        return if bytes[7] == 2 { udp(id, port, None, 0) } else { Err(INCONSISTENT) };
    }
    let (local_length, remote_length) = (usize::from(bytes[7]), usize::from(bytes[10]));
    let remote = match (bytes[9], active) {
        (4, _) => address(&bytes[34..38]),
        (0, false) => None,
        _ => return Err(INCONSISTENT),
    };
    if (active && remote.is_none()) || bytes[8] != 0 || bytes[11] != 0 {
        return Err(INCONSISTENT);
    }
    let (local, far) = (&bytes[12..28], &bytes[40..56]);
    match bytes[4] {
        TYPE_TCP | TYPE_TCP_COMPATIBLE if bytes[4] == TYPE_TCP || classic => {
            let compatible = bytes[4] == TYPE_TCP_COMPATIBLE;
            let port = |length: usize, tsap: &[u8], open: bool| match length {
                2 if compatible => Ok(word(tsap, 0).swap_bytes()),
                2 => Ok(word(tsap, 0)),
                0 if open => Ok(0),
                _ => Err(INCONSISTENT),
            };
            let local_port = port(local_length, local, active)?;
            let remote_port = port(remote_length, far, !active)?;
            tcp(id, active, local_port, remote, remote_port)
        }
        TYPE_ISO => {
            if !active && (local_length < 2 || local[0] != TSAP_DEVICE) {
                return Err(TSAP_WRONG);
            }
            let fits = |length: usize, open: bool| (2..=16).contains(&length) || (length == 0 && open);
            if !fits(local_length, false) || !fits(remote_length, !active) {
                return Err(INCONSISTENT);
            }
            Ok(iso(id, active, remote, &local[..local_length], &far[..remote_length]))
        }
        _ => Err(INCONSISTENT),
    }
}

/// TCON_IP_v4, all of its 14 bytes.
fn ip_v4(bytes: &[u8]) -> Result<Description, u16> {
    check_interface(bytes)?;
    let id = check_id(word(bytes, 2))?;
    match bytes[4] {
        TYPE_TCP_IP_V4 => tcp(id, bytes[5] & 1 != 0, word(bytes, 12), address(&bytes[6..10]), word(bytes, 10)),
        TYPE_UDP => udp(id, word(bytes, 12), address(&bytes[6..10]), word(bytes, 10)),
        _ => Err(INCONSISTENT),
    }
}

/// The description in front of the parameters for TLS, which must be off: the program has no certificates.
fn not_secured(bytes: &[u8]) -> Result<&[u8], u16> {
    let (description, security) = bytes.split_at(bytes.len() - SECURITY_BYTES);
    if security[0] & 1 == 0 { Ok(description) } else { Err(CERTIFICATE) }
}

/// TCON_QDN, all of its 266 bytes. A name may be an address in numbers.
fn qdn(bytes: &[u8]) -> Result<Description, u16> {
    check_interface(bytes)?;
    let id = check_id(word(bytes, 2))?;
    let active = bytes[5] & 1 != 0;
    let length = usize::from(bytes[7].min(bytes[6]));
    let name = std::str::from_utf8(&bytes[8..8 + length]).map_err(|_| INCONSISTENT)?.trim();
    let remote = address_of_name(name);
    let (remote_port, local_port) = (word(bytes, 262), word(bytes, 264));
    let complete = if active { !name.is_empty() && remote_port != 0 } else { local_port != 0 };
    let known = remote.is_some() || name.is_empty();
    if bytes[4] != TYPE_TCP_IP_V4 || !complete || !active && !known {
        return Err(INCONSISTENT);
    }
    let remote_name = if known { String::new() } else { name.to_owned() };
    let (local_tsap, remote_tsap) = (Vec::new(), Vec::new());
    let protocol = Protocol::Tcp;
    Ok(Description { id, protocol, active, local_port, remote, remote_name, remote_port, local_tsap, remote_tsap })
}

/// `192.168.0.1` or `192.168.0.1.`
fn address_of_name(name: &str) -> Option<Ipv4Addr> {
    name.strip_suffix('.').unwrap_or(name).parse().ok().filter(|address: &Ipv4Addr| !address.is_unspecified())
}

/// TCON_IP_RFC, all of its 78 bytes.
fn ip_rfc(bytes: &[u8]) -> Result<Description, u16> {
    check_interface(bytes)?;
    let id = check_id(word(bytes, 2))?;
    let active = bytes[5] & 1 != 0;
    let remote = address(&bytes[6..10]);
    if bytes[4] != TYPE_ISO_IP_RFC || (active && remote.is_none()) {
        return Err(INCONSISTENT);
    }
    // A length, and room for 32 bytes.
    let selector = |at: usize, open: bool| match usize::from(word(bytes, at)) {
        length @ 2..=16 => Ok(bytes[at + 2..at + 2 + length].to_vec()),
        0 if open => Ok(Vec::new()),
        _ => Err(INCONSISTENT),
    };
    let (remote_tsap, local_tsap) = (selector(10, !active)?, selector(44, false)?);
    Ok(iso(id, active, remote, &local_tsap, &remote_tsap))
}

/// A connection on ISO-on-TCP, which has selectors in place of ports.
fn iso(id: u16, active: bool, remote: Option<Ipv4Addr>, local_tsap: &[u8], remote_tsap: &[u8]) -> Description {
    Description {
        id,
        protocol: Protocol::Iso,
        active,
        local_port: 0,
        remote,
        remote_name: String::new(),
        remote_port: 0,
        local_tsap: local_tsap.to_vec(),
        remote_tsap: remote_tsap.to_vec(),
    }
}

/// 64 is the hardware identifier of the CPU's own interface; 0 lets the CPU choose.
fn check_interface(bytes: &[u8]) -> Result<(), u16> {
    if matches!(word(bytes, 0), 0 | 1 | 64) { Ok(()) } else { Err(DEVICE_WRONG) }
}

/// UDP: what the partner is may come with each job.
fn udp(id: u16, local_port: u16, remote: Option<Ipv4Addr>, remote_port: u16) -> Result<Description, u16> {
    if local_port == 0 {
        return Err(INCONSISTENT);
    }
    let (local_tsap, remote_tsap) = (Vec::new(), Vec::new());
    let (protocol, active) = (Protocol::Udp, false);
    let remote_name = String::new();
    Ok(Description { id, protocol, active, local_port, remote, remote_name, remote_port, local_tsap, remote_tsap })
}

fn tcp(id: u16, active: bool, local_port: u16, remote: Option<Ipv4Addr>, remote_port: u16) -> Result<Description, u16> {
    let complete = if active { remote.is_some() && remote_port != 0 } else { local_port != 0 };
    if !complete {
        return Err(INCONSISTENT);
    }
    let protocol = Protocol::Tcp;
    let (local_tsap, remote_tsap) = (Vec::new(), Vec::new());
    let remote_name = String::new();
    Ok(Description { id, protocol, active, local_port, remote, remote_name, remote_port, local_tsap, remote_tsap })
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A TCON_Param. TCP: `local` and `far` are ports.
    pub fn param_bytes(id: u16, kind: u8, active: bool, local: &[u8], remote: &[u8], far: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0; PARAM_BYTES];
        bytes[1] = 64;
        bytes[2..4].copy_from_slice(&id.to_be_bytes());
        bytes[4..8].copy_from_slice(&[kind, u8::from(active), 1, local.len() as u8]);
        bytes[9] = remote.len() as u8;
        bytes[10] = far.len() as u8;
        bytes[12..12 + local.len()].copy_from_slice(local);
        bytes[34..34 + remote.len()].copy_from_slice(remote);
        bytes[40..40 + far.len()].copy_from_slice(far);
        bytes
    }

    const HOME: [u8; 4] = [127, 0, 0, 1];

    #[test]
    fn tcp_of_both_forms() {
        let long = Description::read(&param_bytes(7, TYPE_TCP, true, &[], &HOME, &[0x07, 0xD0]), false);
        let mut short = [0; IP_V4_BYTES];
        short[1] = 64;
        short[3] = 7;
        short[4..6].copy_from_slice(&[TYPE_TCP_IP_V4, 1]);
        short[6..10].copy_from_slice(&HOME);
        short[10..12].copy_from_slice(&2000u16.to_be_bytes());
        assert_eq!(long, Description::read(&short, false));
        assert_eq!(long.map(|found| (found.remote_port, found.local_port)), Ok((2000, 0)));
    }

    #[test]
    fn iso_of_both_forms() {
        let long = Description::read(&param_bytes(7, TYPE_ISO, true, b"ABC", &HOME, b"DEFG"), false);
        let mut short = [0; IP_RFC_BYTES];
        short[1] = 64;
        short[3] = 7;
        short[4..6].copy_from_slice(&[TYPE_ISO_IP_RFC, 1]);
        short[6..10].copy_from_slice(&HOME);
        short[11] = 4;
        short[12..16].copy_from_slice(b"DEFG");
        short[45] = 3;
        short[46..49].copy_from_slice(b"ABC");
        assert_eq!(long, Description::read(&short, false));
        short[45] = 1;
        assert_eq!(Description::read(&short, false), Err(INCONSISTENT));
    }

    fn qdn_bytes(active: bool, name: &str) -> Vec<u8> {
        let mut bytes = vec![0; QDN_BYTES];
        bytes[1] = 64;
        bytes[3] = 7;
        bytes[4..8].copy_from_slice(&[TYPE_TCP_IP_V4, u8::from(active), 254, name.len() as u8]);
        bytes[8..8 + name.len()].copy_from_slice(name.as_bytes());
        bytes[262..264].copy_from_slice(&2000u16.to_be_bytes());
        bytes
    }

    #[test]
    fn partners_by_name() {
        let read = |bytes: &[u8]| Description::read(bytes, false).map(|found| (found.remote, found.remote_name));
        assert_eq!(read(&qdn_bytes(true, "plc.example.")), Ok((None, "plc.example.".to_owned())));
        assert_eq!(read(&qdn_bytes(true, "127.0.0.1.")), Ok((Some(Ipv4Addr::from(HOME)), String::new())));
        assert_eq!(read(&qdn_bytes(true, "")), Err(INCONSISTENT));
        assert_eq!(read(&qdn_bytes(false, "")), Err(INCONSISTENT), "no local port");
    }

    #[test]
    fn security_must_be_off() {
        let mut bytes = qdn_bytes(true, "127.0.0.1");
        let plain = Description::read(&bytes, false);
        bytes.extend([0; SECURITY_BYTES]);
        assert_eq!(Description::read(&bytes, false), plain);
        bytes[QDN_BYTES] = 1;
        assert_eq!(Description::read(&bytes, false), Err(CERTIFICATE));
    }

    #[test]
    fn wrong_descriptions() {
        let code = |bytes: &[u8]| Description::read(bytes, false).err();
        let with = |at: usize, value: u8| {
            let mut bytes = param_bytes(7, TYPE_TCP, true, &[], &HOME, &[0x07, 0xD0]);
            bytes[at] = value;
            code(&bytes)
        };
        assert_eq!(code(&[0; 20]), Some(0x809A));
        assert_eq!(with(1, 63), Some(0x809A));
        assert_eq!(with(3, 0), Some(0x8086));
        assert_eq!(with(2, 0x10), Some(0x8086));
        assert_eq!(with(6, 2), Some(0x809B));
        assert_eq!(with(4, 0x13), Some(0x80B3), "UDP without a port");
        assert_eq!(with(4, 0x01), Some(0x80B3));
        assert_eq!(with(7, 1), Some(0x80B3));
        assert_eq!(with(9, 0), Some(0x80B3));
        assert_eq!(with(10, 0), Some(0x80B3));
        assert_eq!(with(34, 0), None);
        let passive = |local: &[u8]| code(&param_bytes(7, TYPE_ISO, false, local, &[], &[]));
        assert_eq!(passive(&[0xE0, 1]), None);
        assert_eq!(passive(&[0xE0]), Some(0x80B4));
        assert_eq!(passive(b"ABC"), Some(0x80B4));
        assert_eq!(code(&param_bytes(7, TYPE_ISO, true, b"ABC", &HOME, b"DEF")), None);
        assert_eq!(code(&param_bytes(7, TYPE_ISO, true, b"ABC", &HOME, b"D")), Some(0x80B3));
    }

    #[test]
    fn forms_of_an_s7_300() {
        let mut bytes = param_bytes(7, TYPE_TCP_COMPATIBLE, true, &[], &HOME, &[0xD0, 0x07]);
        bytes[6] = 2;
        assert_eq!(Description::read(&bytes, true).map(|found| found.remote_port), Ok(2000));
        assert_eq!(Description::read(&bytes, false), Err(DEVICE_WRONG));
        let udp = Description::read(&param_bytes(7, TYPE_UDP, false, &[0x07, 0xD0], &[], &[]), true);
        assert_eq!(udp.map(|found| (found.protocol, found.local_port)), Ok((Protocol::Udp, 2000)));
    }
}
