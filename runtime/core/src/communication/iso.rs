//! ISO transport protocol, class 0, on TCP: packets, and messages made of them.
//!
//! ```text
//! TPKT   03 00 length(2)                            length of the whole packet
//! CR     LI E0 0000 source(2) 00 parameters         parameters: code, length, value;
//! CC     LI D0 destination(2) source(2) 00 params   C0 size of a TPDU as power of 2, C1 calling TSAP, C2 called TSAP
//! DR     LI 80 destination(2) source(2) reason
//! DT     02 F0 80|00 data                           80: the last of the message
//! ```
//!
//! Source: RFC 1006; RFC 905, chapter 13.

use std::collections::VecDeque;

const CONNECT_REQUEST: u8 = 0xE0;
const CONNECT_CONFIRM: u8 = 0xD0;
const DISCONNECT_REQUEST: u8 = 0x80;
const DATA: u8 = 0xF0;
const SIZE: u8 = 0xC0;
const CALLING: u8 = 0xC1;
const CALLED: u8 = 0xC2;
const LAST: u8 = 0x80;
/// Size of a TPDU that this side requests: 1024 bytes, as S7 CPUs do.
const SIZE_CODE: u8 = 10;
const SIZE_CODES: std::ops::RangeInclusive<u8> = 7..=13;
/// Bytes of a DT TPDU before its data.
const DATA_HEAD: usize = 3;
/// Longest message; a partner that sends more has lost its way.
const MESSAGE_MAX: usize = 1 << 16;
/// Reason for a refusal: unknown TSAP.
const ADDRESS_UNKNOWN: u8 = 3;

/// The partner does not keep to the protocol, or ended the connection.
#[derive(Debug, PartialEq, Eq)]
pub struct Broken;

/// CR or CC of the partner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Offer {
    pub source: u16,
    size: Option<u8>,
    pub calling: Vec<u8>,
    pub called: Vec<u8>,
}

/// A connection that is open.
pub struct Transport {
    /// Bytes of a message in one DT.
    part: usize,
    partial: Vec<u8>,
    /// Complete messages that are not yet read.
    pub messages: VecDeque<Vec<u8>>,
}

fn packet(tpdu: &[u8]) -> Vec<u8> {
    let length = (tpdu.len() + 4) as u16;
    let [high, low] = length.to_be_bytes();
    [&[3, 0, high, low], tpdu].concat()
}

fn parameter(code: u8, value: &[u8]) -> Vec<u8> {
    [&[code, value.len() as u8], value].concat()
}

fn head(code: u8, destination: u16, source: u16, parameters: &[u8]) -> Vec<u8> {
    let ([a, b], [c, d]) = (destination.to_be_bytes(), source.to_be_bytes());
    let length = (6 + parameters.len()) as u8;
    packet(&[&[length, code, a, b, c, d, 0], parameters].concat())
}

/// The packet that requests a connection.
pub fn request(source: u16, calling: &[u8], called: &[u8]) -> Vec<u8> {
    let parameters = [parameter(SIZE, &[SIZE_CODE]), parameter(CALLING, calling), parameter(CALLED, called)].concat();
    head(CONNECT_REQUEST, 0, source, &parameters)
}

/// The packet that accepts `offer`, and what is agreed.
pub fn confirm(offer: &Offer, source: u16) -> (Vec<u8>, Transport) {
    // Without a size the partner takes any.
    let size = offer.size.map_or(SIZE_CODE, |size| size.min(SIZE_CODE));
    let mut parameters = if offer.size.is_some() { parameter(SIZE, &[size]) } else { Vec::new() };
    parameters.extend(parameter(CALLING, &offer.calling));
    parameters.extend(parameter(CALLED, &offer.called));
    (head(CONNECT_CONFIRM, offer.source, source, &parameters), Transport::new(size))
}

/// The packet that refuses `offer`.
pub fn refuse(offer: &Offer) -> Vec<u8> {
    let [a, b] = offer.source.to_be_bytes();
    packet(&[6, DISCONNECT_REQUEST, a, b, 0, 0, ADDRESS_UNKNOWN])
}

/// Takes the next TPDU from the received bytes. `None`: it is not complete.
fn take(input: &mut Vec<u8>) -> Result<Option<Vec<u8>>, Broken> {
    let Some(&[version, _, high, low]) = input.first_chunk::<4>() else { return Ok(None) };
    let length = usize::from(u16::from_be_bytes([high, low]));
    if version != 3 || length < 7 {
        return Err(Broken);
    }
    if input.len() < length {
        return Ok(None);
    }
    let tpdu = input.drain(..length).skip(4).collect();
    Ok(Some(tpdu))
}

/// The TPDU that opens a connection, if it has arrived.
fn opening(input: &mut Vec<u8>, code: u8) -> Result<Option<Offer>, Broken> {
    let Some(tpdu) = take(input)? else { return Ok(None) };
    let end = usize::from(tpdu[0]) + 1;
    // The high digit is the class. The credit that the low digit of the code holds has no meaning in class 0.
    if end < 7 || end > tpdu.len() || tpdu[1] & 0xF0 != code || tpdu[6] >> 4 != 0 {
        return Err(Broken);
    }
    let source = u16::from_be_bytes([tpdu[4], tpdu[5]]);
    let mut offer = Offer { source, size: None, calling: Vec::new(), called: Vec::new() };
    let mut rest = &tpdu[7..end];
    while let [code, length, after @ ..] = rest {
        let Some((value, next)) = after.split_at_checked(usize::from(*length)) else { return Err(Broken) };
        match (*code, value) {
            (SIZE, [size]) if SIZE_CODES.contains(size) => offer.size = Some(*size),
            (SIZE, _) => return Err(Broken),
            (CALLING, _) => offer.calling = value.to_vec(),
            (CALLED, _) => offer.called = value.to_vec(),
            // Unknown parameters have no effect.
            _ => {}
        }
        rest = next;
    }
    Ok(Some(offer))
}

/// The partner's request, if it has arrived.
pub fn requested(input: &mut Vec<u8>) -> Result<Option<Offer>, Broken> {
    opening(input, CONNECT_REQUEST)
}

/// The partner's answer to [`request`], if it has arrived.
pub fn confirmed(input: &mut Vec<u8>) -> Result<Option<Transport>, Broken> {
    let offer = opening(input, CONNECT_CONFIRM)?;
    Ok(offer.map(|offer| Transport::new(offer.size.map_or(SIZE_CODE, |size| size.min(SIZE_CODE)))))
}

impl Transport {
    fn new(size: u8) -> Transport {
        Transport { part: (1 << size) - DATA_HEAD, partial: Vec::new(), messages: VecDeque::new() }
    }

    /// The packets of a message.
    pub fn message(&self, bytes: &[u8]) -> Vec<u8> {
        let count = bytes.len().div_ceil(self.part);
        let parts = bytes.chunks(self.part).enumerate();
        parts
            .flat_map(|(at, part)| packet(&[&[2, DATA, if at + 1 == count { LAST } else { 0 }], part].concat()))
            .collect()
    }

    /// Assembles received bytes into messages, while fewer than `wanted` wait.
    pub fn work(&mut self, input: &mut Vec<u8>, wanted: usize) -> Result<(), Broken> {
        while self.messages.len() < wanted {
            let Some(tpdu) = take(input)? else { return Ok(()) };
            if tpdu[0] != 2 || tpdu[1] & 0xF0 != DATA {
                return Err(Broken);
            }
            self.partial.extend_from_slice(&tpdu[DATA_HEAD..]);
            if self.partial.len() > MESSAGE_MAX {
                return Err(Broken);
            }
            // Some CPUs keep a connection alive with packets that have no data: they are not messages.
            if tpdu[2] & LAST != 0 && !self.partial.is_empty() {
                self.messages.push_back(std::mem::take(&mut self.partial));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_as_bytes() {
        let bytes = request(1, &[0xE0, 2], &[0xE0, 3]);
        let expected = [3, 0, 0, 22, 17, 0xE0, 0, 0, 0, 1, 0, 0xC0, 1, 10, 0xC1, 2, 0xE0, 2, 0xC2, 2, 0xE0, 3];
        assert_eq!(bytes, expected);
        let mut input = bytes[..10].to_vec();
        assert_eq!(requested(&mut input), Ok(None));
        input.extend_from_slice(&bytes[10..]);
        let offer = requested(&mut input).unwrap().unwrap();
        assert_eq!(
            (offer.source, offer.size, offer.calling, offer.called),
            (1, Some(10), vec![0xE0, 2], vec![0xE0, 3])
        );
        assert!(input.is_empty());
    }

    #[test]
    fn a_small_size_is_agreed_and_messages_are_cut() {
        let offer = Offer { source: 9, size: Some(7), calling: vec![1, 2], called: vec![3, 4] };
        let (answer, transport) = confirm(&offer, 5);
        assert_eq!(&answer[..14], [3, 0, 0, 22, 17, 0xD0, 0, 9, 0, 5, 0, 0xC0, 1, 7]);
        let message: Vec<u8> = (0..200).collect();
        let packets = transport.message(&message);
        assert_eq!(packets.len(), 200 + 2 * 7);
        assert_eq!(&packets[..7], [3, 0, 0, 132, 2, 0xF0, 0]);
        assert_eq!(&packets[132..139], [3, 0, 0, 82, 2, 0xF0, 0x80]);
        let mut other = confirmed(&mut answer.clone()).unwrap().unwrap();
        let mut input = Vec::new();
        for byte in packets {
            input.push(byte);
            assert_eq!(other.work(&mut input, 1), Ok(()));
        }
        assert_eq!(other.messages, [message]);
    }

    #[test]
    fn packets_without_data_are_not_messages() {
        let mut transport = Transport::new(10);
        let empty = packet(&[2, DATA, LAST]);
        let packets = [&empty[..], &packet(&[2, DATA, 0, 1, 2]), &packet(&[2, DATA, 0]), &empty, &empty];
        assert_eq!(transport.work(&mut packets.concat(), 5), Ok(()));
        assert_eq!(transport.messages, [vec![1u8, 2]]);
    }

    #[test]
    fn nonsense_breaks() {
        for bad in [&[4, 0, 0, 7, 2, 0xF0, 0x80][..], &[3, 0, 0, 4], &[3, 0, 0, 11, 6, 0x80, 0, 1, 0, 1, 0]] {
            assert_eq!(confirm(&Offer { source: 1, size: None, calling: vec![], called: vec![] }, 1).1.part, 1021);
            let mut transport = Transport::new(10);
            assert_eq!(transport.work(&mut bad.to_vec(), 1), Err(Broken), "{bad:?}");
        }
        assert_eq!(
            requested(&mut vec![3, 0, 0, 12, 7, 0xE0, 0, 0, 0, 1, 0, 0xC0]),
            Ok(Some(Offer { source: 1, size: None, calling: vec![], called: vec![] }))
        );
        assert_eq!(requested(&mut vec![3, 0, 0, 13, 8, 0xE0, 0, 0, 0, 1, 0, 0xC1, 5]), Err(Broken));
        assert_eq!(requested(&mut vec![3, 0, 0, 11, 6, 0xE0, 0, 0, 0, 1, 0x20]), Err(Broken), "class 2");
    }
}
