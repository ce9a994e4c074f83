//! Requests and answers of Modbus. Source: Modbus application protocol V1.1b3, chapter 6; over serial line V1.02, chapter 2.5.

use plcc_abi::remote::{RemoteChannel, RemoteTable};

/// In the function of an answer: it is an exception.
pub const EXCEPTION: u8 = 0x80;
/// Function and data of the longest frame.
pub const PDU_MAX: usize = 253;

/// A request that reads a channel.
pub fn read_request(channel: &RemoteChannel) -> Vec<u8> {
    let function = match channel.table {
        RemoteTable::Coils => 1,
        RemoteTable::DiscreteInputs => 2,
        RemoteTable::HoldingRegisters => 3,
        RemoteTable::InputRegisters => 4,
    };
    head(function, channel.first, channel.count)
}

/// A request that writes a channel: bits as bytes with the first one lowest, registers as words with the high byte first.
pub fn write_request(channel: &RemoteChannel, data: &[u8]) -> Vec<u8> {
    let function = if channel.table.has_bits() { 15 } else { 16 };
    let mut request = head(function, channel.first, channel.count);
    request.push(data.len() as u8);
    request.extend_from_slice(data);
    request
}

fn head(function: u8, first: u16, count: u16) -> Vec<u8> {
    let ([a, b], [c, d]) = (first.to_be_bytes(), count.to_be_bytes());
    vec![function, a, b, c, d]
}

/// What an answer means.
#[derive(Debug, PartialEq, Eq)]
pub enum Answer<'a> {
    /// The data of a read request.
    Data(&'a [u8]),
    Written,
    /// The device refuses, with this code.
    Refused(u8),
    /// Not an answer to this request.
    Wrong,
}

/// Reads the answer to `request`.
pub fn answer<'a>(request: &[u8], channel: &RemoteChannel, answer: &'a [u8]) -> Answer<'a> {
    let bytes = match channel.table.has_bits() {
        true => usize::from(channel.count).div_ceil(8),
        false => 2 * usize::from(channel.count),
    };
    match answer {
        [function, code] if *function == request[0] | EXCEPTION => Answer::Refused(*code),
        [function, length, data @ ..]
            if *function == request[0] && *function < 5 && usize::from(*length) == bytes && data.len() == bytes =>
        {
            Answer::Data(data)
        }
        [function, rest @ ..] if *function == request[0] && *function > 4 && rest == &request[1..5] => Answer::Written,
        _ => Answer::Wrong,
    }
}

/// The bytes of an answer on a serial line of which these are the first, with unit and checksum; `None`: more are needed to tell.
pub fn serial_length(bytes: &[u8]) -> Option<usize> {
    match bytes {
        [_, function, ..] if function & EXCEPTION != 0 => Some(5),
        [_, 1..=4, length, ..] => Some(5 + usize::from(*length)),
        [_, 1..=4] => None,
        [_, _, ..] => Some(8),
        _ => None,
    }
}

/// The checksum of a serial line; the low byte is sent first.
pub fn checksum(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |sum, byte| {
        (0..8).fold(sum ^ u16::from(*byte), |sum: u16, _| if sum & 1 == 0 { sum >> 1 } else { sum >> 1 ^ 0xA001 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(table: RemoteTable, count: u16) -> RemoteChannel {
        RemoteChannel {
            table,
            first: 0x6B,
            count,
            output: false,
            byte: 0,
            bit: 0,
            low_byte_first: false,
            low_word_first: false,
            scale: None,
            substitute: 0,
        }
    }

    /// The examples of the protocol, 6.1, 6.3 and 6.12.
    #[test]
    fn requests_and_answers_of_the_protocol() {
        let registers = channel(RemoteTable::HoldingRegisters, 3);
        let request = read_request(&registers);
        assert_eq!(request, [0x03, 0x00, 0x6B, 0x00, 0x03]);
        let data = [0x03, 0x06, 0x02, 0x2B, 0x00, 0x00, 0x00, 0x64];
        assert_eq!(answer(&request, &registers, &data), Answer::Data(&data[2..]));
        assert_eq!(answer(&request, &registers, &[0x83, 0x02]), Answer::Refused(2));
        for wrong in [&data[..7], &[0x04, 0x06, 2, 0x2B, 0, 0, 0, 0x64], &[0x03], &[], &[0x03, 0x02, 1, 2], &[0x84, 2]] {
            assert_eq!(answer(&request, &registers, wrong), Answer::Wrong, "{wrong:?}");
        }
        let two = RemoteChannel { first: 1, ..channel(RemoteTable::HoldingRegisters, 2) };
        let request = write_request(&two, &[0x00, 0x0A, 0x01, 0x02]);
        assert_eq!(request, [0x10, 0x00, 0x01, 0x00, 0x02, 0x04, 0x00, 0x0A, 0x01, 0x02]);
        assert_eq!(answer(&request, &two, &[0x10, 0x00, 0x01, 0x00, 0x02]), Answer::Written);
        assert_eq!(answer(&request, &two, &[0x10, 0x00, 0x01, 0x00, 0x03]), Answer::Wrong);
    }

    #[test]
    fn the_checksum_is_that_of_the_protocol() {
        // Over serial line, 6.2.2.
        assert_eq!(checksum(&[0x02, 0x07]), 0x1241);
        assert_eq!(checksum(b"123456789"), 0x4B37);
    }

    #[test]
    fn answers_on_a_line_have_an_end() {
        assert_eq!(serial_length(&[1]), None);
        assert_eq!(serial_length(&[1, 3]), None);
        assert_eq!(serial_length(&[1, 3, 4]), Some(9));
        assert_eq!(serial_length(&[1, 0x83]), Some(5));
        assert_eq!(serial_length(&[1, 16, 0]), Some(8));
    }
}
