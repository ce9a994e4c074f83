//! TPKT (RFC 1006) and COTP (ISO 8073, class 0): how PDUs of S7 travel on TCP.
//!
//! A stream is cut into frames; a frame is a request for a connection, or a piece of a PDU. Whatever breaks the rules ends the
//! connection: a client that counts wrongly cannot be understood later either.

use crate::limits::{EMPTY_PIECES_MAX, PIECES_MAX};
use crate::wire::{Bytes, put16};

/// Port of ISO-on-TCP.
pub const PORT: u16 = 102;
/// Bytes before a PDU: TPKT and the head of a DT.
pub const HEAD_BYTES: usize = 7;
/// The longest frame with a request for a connection.
const CONNECT_BYTES_MAX: usize = 258;

/// Types of COTP frames; the low half of the byte is a credit, which class 0 does not use.
const CONNECT_REQUEST: u8 = 0xE0;
const CONNECT_CONFIRM: u8 = 0xD0;
const DATA: u8 = 0xF0;
const DISCONNECT_REQUEST: u8 = 0x80;

/// The last piece of a PDU.
const END: u8 = 0x80;

/// Parameters of a request for a connection.
const TPDU_SIZE: u8 = 0xC0;
const CALLING: u8 = 0xC1;
const CALLED: u8 = 0xC2;

const TSAP_BYTES_MAX: usize = 16;

/// The largest TPDU, 1024 bytes, as a power of two.
const TPDU_EXPONENT: u8 = 10;

/// What a client sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Received {
    Connect(ConnectRequest),
    /// The answer to [`connect`]: bytes of a PDU in one frame.
    Confirm(usize),
    /// A whole PDU.
    Pdu(Vec<u8>),
}

/// A request for a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConnectRequest {
    /// The reference of the client.
    pub reference: [u8; 2],
    /// TSAPs of 16 bytes at most: connection type, then rack and slot.
    pub calling: Vec<u8>,
    pub called: Vec<u8>,
    tpdu: u8,
}

/// The connection has to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Broken;

/// Cuts a stream into frames.
#[derive(Default)]
pub struct Reader {
    buffer: Vec<u8>,
    /// Pieces of a PDU that is not complete.
    pdu: Vec<u8>,
    pieces: usize,
    empty_pieces: usize,
}

impl Reader {
    /// Adds what came from the stream.
    pub fn feed(&mut self, bytes: &[u8]) {
        self.buffer.extend(bytes);
    }

    /// A frame or a PDU has begun and is not complete.
    pub fn is_waiting(&self) -> bool {
        !self.buffer.is_empty() || self.pieces > 0
    }

    /// The next thing that is complete. `pdu_max`: the longest PDU that is allowed.
    pub fn next(&mut self, pdu_max: usize) -> Result<Option<Received>, Broken> {
        loop {
            let Some(&[version, _, high, low]) = self.buffer.first_chunk::<4>() else {
                return if matches!(self.buffer.first(), None | Some(3)) { Ok(None) } else { Err(Broken) };
            };
            let length = usize::from(u16::from_be_bytes([high, low]));
            if version != 3 || !(HEAD_BYTES..=CONNECT_BYTES_MAX.max(HEAD_BYTES + pdu_max)).contains(&length) {
                return Err(Broken);
            }
            if self.buffer.len() < length {
                return Ok(None);
            }
            let frame: Vec<u8> = self.buffer.drain(..length).skip(4).collect();
            if let Some(received) = self.frame(&frame, pdu_max)? {
                return Ok(Some(received));
            }
        }
    }

    fn frame(&mut self, frame: &[u8], pdu_max: usize) -> Result<Option<Received>, Broken> {
        let mut rest = Bytes(frame);
        let (indicator, kind) = (rest.u8().ok_or(Broken)?, rest.u8().ok_or(Broken)? & 0xF0);
        match kind {
            CONNECT_REQUEST if usize::from(indicator) + 1 == frame.len() => {
                (self.pieces, self.empty_pieces) = (0, 0);
                self.pdu.clear();
                connect_request(rest).map(|request| Some(Received::Connect(request))).ok_or(Broken)
            }
            CONNECT_CONFIRM if usize::from(indicator) + 1 == frame.len() => {
                let confirm = connect_request(rest).ok_or(Broken)?;
                Ok(Some(Received::Confirm(confirm.piece_bytes())))
            }
            DATA if indicator == 2 => {
                let end = rest.u8().ok_or(Broken)? & END != 0;
                self.pieces += 1;
                self.empty_pieces += usize::from(rest.is_empty());
                if self.pieces > PIECES_MAX
                    || self.empty_pieces > EMPTY_PIECES_MAX
                    || self.pdu.len() + rest.len() > pdu_max
                {
                    return Err(Broken);
                }
                self.pdu.extend(rest.0);
                if !end {
                    return Ok(None);
                }
                (self.pieces, self.empty_pieces) = (0, 0);
                Ok(Some(Received::Pdu(std::mem::take(&mut self.pdu))))
            }
            _ => Err(Broken),
        }
    }
}

fn connect_request(mut rest: Bytes) -> Option<ConnectRequest> {
    rest.take(2)?;
    let reference = rest.array::<2>()?;
    // Class 0 is what the answer says, whatever was asked for.
    rest.take(1)?;
    let mut request = ConnectRequest { reference, calling: Vec::new(), called: Vec::new(), tpdu: TPDU_EXPONENT };
    while !rest.is_empty() {
        let (code, length) = (rest.u8()?, rest.u8()?);
        let value = rest.take(length.into())?;
        match code {
            TPDU_SIZE => {
                let asked = value.first().copied().filter(|size| (7..=13).contains(size));
                request.tpdu = asked.unwrap_or(TPDU_EXPONENT).min(TPDU_EXPONENT);
            }
            CALLING | CALLED if value.len() > TSAP_BYTES_MAX => return None,
            CALLING => request.calling = value.to_vec(),
            CALLED => request.called = value.to_vec(),
            _ => {}
        }
    }
    Some(request)
}

/// The frame that asks for a connection.
pub fn connect(reference: u16, calling: &[u8], called: &[u8]) -> Vec<u8> {
    let mut cotp = vec![0, CONNECT_REQUEST, 0, 0];
    put16(&mut cotp, reference);
    cotp.push(0);
    cotp.extend([TPDU_SIZE, 1, TPDU_EXPONENT]);
    for (code, tsap) in [(CALLING, calling), (CALLED, called)] {
        cotp.extend([code, tsap.len() as u8]);
        cotp.extend(tsap);
    }
    cotp[0] = (cotp.len() - 1) as u8;
    tpkt(&cotp)
}

fn tpkt(cotp: &[u8]) -> Vec<u8> {
    let mut frame = vec![3, 0];
    put16(&mut frame, (cotp.len() + 4) as u16);
    frame.extend(cotp);
    frame
}

impl ConnectRequest {
    /// The answer that opens the connection.
    pub fn confirm(&self, own_reference: u16) -> Vec<u8> {
        let mut cotp = vec![0, CONNECT_CONFIRM];
        cotp.extend(self.reference);
        put16(&mut cotp, own_reference);
        cotp.push(0);
        cotp.extend([TPDU_SIZE, 1, self.tpdu]);
        for (code, tsap) in [(CALLING, &self.calling), (CALLED, &self.called)] {
            cotp.extend([code, tsap.len() as u8]);
            cotp.extend(tsap);
        }
        cotp[0] = (cotp.len() - 1) as u8;
        tpkt(&cotp)
    }

    /// The answer that refuses it, with a reason of ISO 8073.
    pub fn refuse(&self, reason: u8) -> Vec<u8> {
        let [high, low] = self.reference;
        tpkt(&[6, DISCONNECT_REQUEST, high, low, 0, 0, reason])
    }

    /// Bytes of a PDU in one frame.
    pub fn piece_bytes(&self) -> usize {
        (1 << self.tpdu) - 3
    }

    /// Whether a CPU listens under the called TSAP: rack and slot are not compared, since a program has neither.
    pub fn is_for_cpu(&self) -> bool {
        match self.called.as_slice() {
            // Micro/WIN.
            b"MW" => true,
            [kind, _] => matches!(kind, 1..=3 | 0x10..),
            _ => false,
        }
    }
}

/// The frames of a PDU: one, unless the client takes only short ones.
pub fn data(pdu: &[u8], piece_bytes: usize) -> Vec<u8> {
    let mut frames = Vec::new();
    let mut rest = pdu;
    loop {
        let (piece, after) = rest.split_at(rest.len().min(piece_bytes));
        rest = after;
        let mut cotp = vec![2, DATA, if rest.is_empty() { END } else { 0 }];
        cotp.extend(piece);
        frames.extend(tpkt(&cotp));
        if rest.is_empty() {
            return frames;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONNECT: [u8; 22] = [3, 0, 0, 22, 17, 0xE0, 0, 0, 0, 1, 0, 0xC1, 2, 1, 0, 0xC2, 2, 1, 2, 0xC0, 1, 10];

    fn all(reader: &mut Reader, bytes: &[u8]) -> Result<Vec<Received>, Broken> {
        reader.feed(bytes);
        let mut found = Vec::new();
        while let Some(received) = reader.next(240)? {
            found.push(received);
        }
        Ok(found)
    }

    #[test]
    fn a_connection_is_confirmed() {
        let found = all(&mut Reader::default(), &CONNECT).unwrap();
        let [Received::Connect(request)] = found.as_slice() else { panic!("{found:?}") };
        assert!(request.is_for_cpu());
        let expected = [3, 0, 0, 22, 17, 0xD0, 0, 1, 0, 2, 0, 0xC0, 1, 10, 0xC1, 2, 1, 0, 0xC2, 2, 1, 2];
        assert_eq!(request.confirm(2), expected);
        assert_eq!(request.refuse(3), [3, 0, 0, 11, 6, 0x80, 0, 1, 0, 0, 3]);
    }

    #[test]
    fn a_partner_is_asked_and_confirms() {
        assert_eq!(
            connect(1, &[0x10, 1], &[3, 2]),
            [3, 0, 0, 22, 17, 0xE0, 0, 0, 0, 1, 0, 0xC0, 1, 10, 0xC1, 2, 0x10, 1, 0xC2, 2, 3, 2]
        );
        let confirm = [3, 0, 0, 14, 9, 0xD0, 0, 1, 0, 2, 0, 0xC0, 1, 9];
        assert_eq!(all(&mut Reader::default(), &confirm), Ok(vec![Received::Confirm(509)]));
    }

    #[test]
    fn a_stream_may_be_cut_anywhere() {
        let mut bytes = CONNECT.to_vec();
        bytes.extend(data(&[1, 2, 3], 1021));
        bytes.extend([3, 0, 0, 8, 2, 0xF0, 0, 4, 3, 0, 0, 9, 2, 0xF0, 0x80, 5, 6]);
        let mut reader = Reader::default();
        let found: Vec<Received> = bytes.iter().flat_map(|byte| all(&mut reader, &[*byte]).unwrap()).collect();
        assert_eq!(found[1..], [Received::Pdu(vec![1, 2, 3]), Received::Pdu(vec![4, 5, 6])]);
        assert!(!reader.is_waiting());
    }

    #[test]
    fn a_long_pdu_goes_in_pieces() {
        let pdu: Vec<u8> = (0..=239).collect();
        let frames = data(&pdu, 125);
        assert_eq!((&frames[..7], frames.len()), (&[3, 0, 0, 132, 2, 0xF0, 0][..], 240 + 2 * 7));
        assert_eq!(all(&mut Reader::default(), &frames), Ok(vec![Received::Pdu(pdu)]));
        assert_eq!(data(&[], 125), [3, 0, 0, 7, 2, 0xF0, 0x80]);
    }

    #[test]
    fn broken_frames_end_the_connection() {
        let piece = [3, 0, 0, 7, 2, 0xF0, 0];
        for bytes in [
            &[3, 0, 0, 0][..],
            &[3, 0, 0, 6],
            &[3, 0, 0xFF, 0xFF],
            &[4, 0, 0, 22],
            b"GET / HTTP/1.1",
            &[3, 0, 0, 7, 3, 0xF0, 0x80],
            &[3, 0, 0, 7, 0, 0xF0, 0x80],
            &[3, 0, 0, 11, 5, 0xE0, 0, 0, 0, 1, 0],
            &[3, 0, 0, 12, 7, 0xE0, 0, 0, 0, 1, 0, 0xC1],
            &[3, 0, 0, 13, 8, 0xE0, 0, 0, 0, 1, 0, 0xC1, 9],
            &piece.repeat(20),
        ] {
            assert_eq!(all(&mut Reader::default(), bytes), Err(Broken), "{bytes:?}");
        }
    }
}
