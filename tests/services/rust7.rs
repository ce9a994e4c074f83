//! rust7, a client of S7 in Rust, against the line.

use libtest_mimic::Failed;
use rust7::client::{S7_AREA_DB, S7_AREA_MK, S7_WL_BYTE, S7Client, S7Error};

use crate::process::{Plc, free_port};

fn failed(what: &'static str) -> impl Fn(S7Error) -> Failed {
    move |error| format!("{what}: {error}").into()
}

/// Reads and writes of all sizes, bits, and what does not exist.
pub fn talk() -> Result<(), Failed> {
    let port = free_port();
    let plc = Plc::start(&["--s7", &port.to_string()])?;
    let mut client = S7Client::new();
    client.set_timeout(5000, 5000, 5000).map_err(failed("time-outs"))?;
    client.set_connection_port(port).map_err(failed("port"))?;
    client.connect_s7300("127.0.0.1").map_err(failed("connection"))?;
    if client.pdu_length != 240 {
        return Err(format!("PDUs of {} bytes; an S7-300 has 240", client.pdu_length).into());
    }
    for size in [1, 2, 200, 222, 223, 1000, 4000] {
        let sent: Vec<u8> = (0..size).map(|index| (index * 7 + size) as u8).collect();
        client.write_db(1, 10, &sent).map_err(failed("write"))?;
        let mut back = vec![0; size];
        client.read_db(1, 10, &mut back).map_err(failed("read"))?;
        if back != sent {
            return Err(format!("{size} bytes came back changed").into());
        }
    }
    client.write_bit(S7_AREA_DB, 1, 100, 3, true).map_err(failed("write of a bit"))?;
    if !client.read_bit(S7_AREA_DB, 1, 100, 3).map_err(failed("read of a bit"))? {
        return Err("the bit is not set".into());
    }
    client.write_area(S7_AREA_MK, 0, 10, S7_WL_BYTE, &[0x12, 0x34]).map_err(failed("write of MW10"))?;
    let mut word = [0; 2];
    client.read_area(S7_AREA_MK, 0, 10, S7_WL_BYTE, &mut word).map_err(failed("read of MW10"))?;
    if word != [0x12, 0x34] {
        return Err(format!("MW10 is {word:02X?}").into());
    }
    // A block that does not exist, one that is read only, an address after the end.
    let mut byte = [0; 1];
    for (what, done) in [
        ("DB 99", client.read_db(99, 0, &mut byte)),
        ("DB 3", client.write_db(3, 0, &[1])),
        ("DB1.DBB4096", client.read_db(1, 4096, &mut byte)),
    ] {
        if done.is_ok() {
            return Err(format!("{what} was accessed").into());
        }
    }
    client.read_db(1, 0, &mut byte).map_err(failed("read after errors"))?;
    client.disconnect();
    plc.end().map(drop)
}
