//! SFC 0 SET_CLK, SFC 1 READ_CLK, SFC 64 TIME_TCK.

use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::datetime::{self, DateTimeError};

/// Sets the wall clock; the weekday is ignored. 8080 date, 8081 time wrong.
pub(super) fn set_clk(call: &Call) -> Outcome {
    match datetime::decode(call.date_and_time(0)) {
        Ok(moment) => {
            call.cpu.clock.set_wall(moment);
            call.cpu.wall_clock_was_set();
            OK
        }
        Err(DateTimeError::Date) => error(0x8080),
        Err(DateTimeError::Time) => error(0x8081),
    }
}

pub(super) fn read_clk(call: &Call) -> Outcome {
    call.set_date_and_time(1, datetime::encode(call.cpu.clock.wall()));
    OK
}

pub(super) fn time_tck(call: &Call) -> Outcome {
    call.set_dword(0, call.cpu.clock.ticks());
    Outcome::Plain
}
