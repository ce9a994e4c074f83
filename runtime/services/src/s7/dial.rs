//! How this side sets a connection up: what it asks for, and what the partner grants.

use super::partner::job;
use super::session::{ACK_DATA, PROTOCOL, SETUP};
use crate::limits::PARALLEL_JOBS_MAX;
use crate::wire::{Bytes, put16};

/// Reference of this side of the transport connection.
pub const REFERENCE: u16 = 1;
/// The shortest PDU with which blocks can be sent: that of communication processors of old CPUs.
const PDU_MIN: u16 = 112;

/// The job that agrees on the length of PDUs.
pub fn set_up(pdu: u16) -> Vec<u8> {
    let mut parameter = vec![SETUP, 0];
    for number in [PARALLEL_JOBS_MAX, PARALLEL_JOBS_MAX, pdu] {
        put16(&mut parameter, number);
    }
    job([0, 0], &parameter, &[])
}

/// What the partner grants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Agreed {
    pub pdu: u16,
    /// Jobs that it answers at once.
    pub jobs: u16,
}

/// The answer to [`set_up`]; `None`: it is not one, or a refusal.
pub fn agreed(answer: &[u8], asked: u16) -> Option<Agreed> {
    let mut rest = Bytes(answer);
    let [PROTOCOL, ACK_DATA, _, _, 0, 0, 0, 8, 0, 0, 0, 0] = rest.array::<12>()? else { return None };
    let [SETUP, _] = rest.array::<2>()? else { return None };
    let (jobs, _, pdu) = (rest.u16()?, rest.u16()?, rest.u16()?);
    let fits = rest.is_empty() && (PDU_MIN..=asked).contains(&pdu);
    fits.then_some(Agreed { pdu, jobs: jobs.clamp(1, PARALLEL_JOBS_MAX) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_length_is_agreed_on() {
        let asked = [0x32, 1, 0, 0, 0, 0, 0, 8, 0, 0, 0xF0, 0, 0, 8, 0, 8, 1, 0xE0];
        assert_eq!(set_up(480), asked);
        let answer = |pdu: u16| {
            let [high, low] = pdu.to_be_bytes();
            [0x32, 3, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0xF0, 0, 0, 1, 0, 1, high, low]
        };
        assert_eq!(agreed(&answer(240), 480), Some(Agreed { pdu: 240, jobs: 1 }));
        for wrong in [0, 111, 481, 0xFFFF] {
            assert_eq!(agreed(&answer(wrong), 480), None, "{wrong}");
        }
        assert_eq!(agreed(&answer(240)[..19], 480), None);
    }
}
