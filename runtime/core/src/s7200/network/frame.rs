//! Frames of the link between stations, on TCP; see docs/decisions/0060-ppi-on-tcp.md.
//!
//! ```text
//! 68 LE LE 68 | DA SA FC TAG ... | FCS 16
//! ```
//!
//! LE is the number of bytes from DA to FCS, FCS not counted; FCS their sum modulo 256. DA and SA are the addresses of the receiving and the
//! sending station; the answer to a request has its TAG.

/// Data of one request, in bytes. Source: S7-200 system manual, Network Read and Network Write.
pub const DATA_MAX: usize = 16;

const START: u8 = 0x68;
const END: u8 = 0x16;
const READ: u8 = 0x01;
const WRITE: u8 = 0x02;
const ANSWER: u8 = 0x81;
/// 68 LE LE 68 before, FCS 16 after.
const HEAD: usize = 4;
const TAIL: usize = 2;

/// The content of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Body {
    /// FC 01: pointer (4 bytes), number of bytes.
    Read { pointer: u32, count: u8 },
    /// FC 02: pointer (4 bytes), bytes.
    Write { pointer: u32, data: Vec<u8> },
    /// FC 81: error code of NETR and NETW, bytes that were read.
    Answer { code: u8, data: Vec<u8> },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    pub to: u8,
    pub from: u8,
    pub tag: u8,
    pub body: Body,
}

/// The received bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Malformed;

impl Frame {
    pub fn encode(&self) -> Vec<u8> {
        let (function, data) = match &self.body {
            Body::Read { pointer, count } => (READ, [&pointer.to_be_bytes()[..], &[*count]].concat()),
            Body::Write { pointer, data } => (WRITE, [&pointer.to_be_bytes()[..], data].concat()),
            Body::Answer { code, data } => (ANSWER, [&[*code][..], data].concat()),
        };
        let unit = [&[self.to, self.from, function, self.tag][..], &data].concat();
        // At most 4 + 4 + DATA_MAX.
        let length = unit.len() as u8;
        [&[START, length, length, START][..], &unit, &[sum(&unit), END]].concat()
    }

    /// Takes the next frame from the received bytes. `None`: it is not complete.
    pub fn take(input: &mut Vec<u8>) -> Result<Option<Frame>, Malformed> {
        let head_is_right = match input.as_slice() {
            [] => true,
            [start] | [start, _] => *start == START,
            [start, length, again] => *start == START && length == again,
            [start, length, again, end, ..] => *start == START && length == again && *end == START,
        };
        if !head_is_right {
            return Err(Malformed);
        }
        let [_, length, _, _, ..] = input.as_slice() else { return Ok(None) };
        let length = usize::from(*length);
        if length > 8 + DATA_MAX {
            return Err(Malformed);
        }
        let total = HEAD + length + TAIL;
        if input.len() < total {
            return Ok(None);
        }
        let frame: Vec<u8> = input.drain(..total).collect();
        let (unit, tail) = frame.get(HEAD..).and_then(|rest| rest.split_at_checked(length)).ok_or(Malformed)?;
        if tail != [sum(unit), END] {
            return Err(Malformed);
        }
        decode(unit).map(Some).ok_or(Malformed)
    }
}

fn decode(unit: &[u8]) -> Option<Frame> {
    let [to, from, function, tag, data @ ..] = unit else { return None };
    let with_pointer = || data.split_first_chunk::<4>().map(|(pointer, rest)| (u32::from_be_bytes(*pointer), rest));
    let body = match *function {
        READ => match with_pointer()? {
            (pointer, &[count]) => Body::Read { pointer, count },
            _ => return None,
        },
        WRITE => {
            let (pointer, data) = with_pointer()?;
            Body::Write { pointer, data: data.to_vec() }
        }
        ANSWER => {
            let (code, data) = data.split_first()?;
            Body::Answer { code: *code, data: data.to_vec() }
        }
        _ => return None,
    };
    Some(Frame { to: *to, from: *from, tag: *tag, body })
}

fn sum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum.wrapping_add(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read() -> Frame {
        Frame { to: 3, from: 2, tag: 7, body: Body::Read { pointer: 0x0800_0064, count: 2 } }
    }

    #[test]
    fn bytes_of_a_frame() {
        let bytes = read().encode();
        // 3 + 2 + 1 + 7 + 8 + 0x64 + 2 = 0x7B
        assert_eq!(bytes, [0x68, 9, 9, 0x68, 3, 2, 1, 7, 8, 0, 0, 0x64, 2, 0x7B, 0x16]);
    }

    #[test]
    fn frames_come_back() {
        let data: Vec<u8> = (0..16).collect();
        for body in [
            read().body,
            Body::Write { pointer: 0x0300_0001, data: data.clone() },
            Body::Answer { code: 0, data },
            Body::Answer { code: 9, data: Vec::new() },
        ] {
            let frame = Frame { body, ..read() };
            let mut input = [frame.encode(), read().encode()].concat();
            assert_eq!(Frame::take(&mut input), Ok(Some(frame)));
            assert_eq!(Frame::take(&mut input), Ok(Some(read())));
            assert_eq!(Frame::take(&mut input), Ok(None));
        }
    }

    #[test]
    fn parts_are_waited_for() {
        let bytes = read().encode();
        for count in 0..bytes.len() {
            let mut input = bytes[..count].to_vec();
            assert_eq!(Frame::take(&mut input), Ok(None), "{count} bytes");
            assert_eq!(input.len(), count);
        }
    }

    #[test]
    fn nonsense_is_told() {
        let good = read().encode();
        for (at, value) in [(0, 0x10), (1, 8), (2, 8), (3, 0), (4, 4), (6, 9), (13, 0), (14, 0)] {
            let mut bytes = good.clone();
            bytes[at] = value;
            assert_eq!(Frame::take(&mut bytes), Err(Malformed), "byte {at}");
        }
        assert_eq!(Frame::take(&mut vec![0x68, 0, 0, 0x68, 0, 0x16]), Err(Malformed), "empty");
        assert_eq!(Frame::take(&mut vec![0x68, 200, 200, 0x68]), Err(Malformed), "too long");
        assert_eq!(Frame::take(&mut b"GET / HTTP/1.0".to_vec()), Err(Malformed));
    }

    #[test]
    fn every_change_is_seen() {
        let good = read().encode();
        for at in 0..good.len() {
            for value in 0..=255 {
                let mut bytes = good.clone();
                bytes[at] = value;
                let changed = bytes != good;
                // The checksum sees every single change.
                assert!(!changed || !matches!(Frame::take(&mut bytes), Ok(Some(_))), "byte {at} is {value}");
            }
        }
    }
}
