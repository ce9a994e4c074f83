//! Connections of Modbus TCP.

use plcc_abi::services::Right;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::time::timeout;

use super::Map;
use super::functions::{answer, frame, refuse};
use crate::access::Access;
use crate::limits::{ANSWER_TIME, FRAME_TIME};
use crate::link::Link;
use crate::listen::Visitor;

/// Transaction, protocol, length.
const HEAD_BYTES: usize = 6;
/// Unit and function; unit, and 253 bytes from the function on.
const BODY_BYTES: std::ops::RangeInclusive<usize> = 2..=254;

/// Answers one client until it breaks the rules, goes, or the CPU ends.
pub async fn serve(visitor: Visitor, link: Link, map: Map) {
    let _ = connection(visitor, link, map).await;
}

async fn connection(mut visitor: Visitor, link: Link, map: Map) -> Option<()> {
    let stream = &mut visitor.stream;
    let may_write = visitor.right >= Right::Write;
    loop {
        let mut head = [0; HEAD_BYTES];
        // A client may be silent between frames, not within one.
        let begun = stream.read(&mut head).await.ok().filter(|count| *count > 0)?;
        timeout(FRAME_TIME, stream.read_exact(&mut head[begun..])).await.ok()?.ok()?;
        let [t0, t1, p0, p1, l0, l1] = head;
        let length = usize::from(u16::from_be_bytes([l0, l1]));
        if (p0, p1) != (0, 0) || !BODY_BYTES.contains(&length) {
            return None;
        }
        let mut body = vec![0; length];
        timeout(FRAME_TIME, stream.read_exact(&mut body)).await.ok()?.ok()?;
        let unit = body[0];
        let answered = link
            .ask(move |cpu| {
                // In a changed program names mean other places; what it does not have is not there.
                let now = match cpu.generation() {
                    0 => Some(map),
                    _ => Map::new(&cpu.image.config.services.registers, &cpu.image).ok(),
                };
                match now {
                    Some(map) => answer(&body[1..], &map, may_write, &Access(cpu)),
                    None => refuse(&body[1..]),
                }
            })
            .await?;
        timeout(ANSWER_TIME, stream.write_all(&frame([t0, t1], unit, &answered))).await.ok()?.ok()?;
    }
}
