//! The way to a device: a TCP connection, or a serial line.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::unix::fs::OpenOptionsExt;
use std::time::{Duration, Instant};

use plcc_abi::remote::{RemoteLine, RemoteParity};
use rustix::termios::{ControlModes, InputModes, OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};

use super::frame;

/// From one look at a serial line to the next.
const LOOK: Duration = Duration::from_micros(500);
/// Bits of a character on a serial line.
const CHARACTER_BITS: u32 = 11;

/// An open way.
pub enum Line {
    Tcp { stream: TcpStream, transaction: u16 },
    Serial { file: File, silence: Duration },
}

impl Line {
    /// Opens the way. `Err`: the error.
    pub fn open(line: &RemoteLine, timeout: Duration) -> Result<Line, String> {
        match line {
            RemoteLine::Tcp(address) => {
                let wrong = |error: std::io::Error| format!("{address}: {error}");
                let mut last = format!("{address}: no such name");
                for place in address.to_socket_addrs().map_err(wrong)? {
                    match TcpStream::connect_timeout(&place, timeout) {
                        Ok(stream) => {
                            // Without it small frames wait.
                            let _ = stream.set_nodelay(true);
                            stream.set_write_timeout(Some(timeout)).map_err(wrong)?;
                            return Ok(Line::Tcp { stream, transaction: 0 });
                        }
                        Err(error) => last = wrong(error),
                    }
                }
                Err(last)
            }
            RemoteLine::Serial { path, baud, parity } => {
                let flags = libc::O_NOCTTY | libc::O_NONBLOCK;
                let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path);
                let file = file.map_err(|error| format!("{path}: {error}"))?;
                set_line(&file, *baud, *parity).map_err(|error| format!("{path}: {error}"))?;
                // Three and a half characters end a frame; above 19,200 baud the time is fixed.
                let silence = match baud {
                    0..=19_200 => Duration::from_micros(u64::from(35 * CHARACTER_BITS * 100_000 / (*baud).max(1))),
                    _ => Duration::from_micros(1750),
                };
                Ok(Line::Serial { file, silence })
            }
        }
    }

    /// Sends a request and waits for its answer. `Err`: the device is away, or the way is broken.
    pub fn exchange(&mut self, unit: u8, request: &[u8], timeout: Duration) -> Result<Vec<u8>, String> {
        let deadline = Instant::now() + timeout;
        match self {
            Line::Tcp { stream, transaction } => {
                *transaction = transaction.wrapping_add(1);
                over_tcp(stream, *transaction, unit, request, deadline)
            }
            Line::Serial { file, silence } => over_serial(file, *silence, unit, request, deadline),
        }
        .map_err(|error| match error.kind() {
            ErrorKind::WouldBlock | ErrorKind::TimedOut => "no answer in time".to_string(),
            ErrorKind::UnexpectedEof => "the device has closed the connection".to_string(),
            _ => error.to_string(),
        })
    }
}

fn over_tcp(
    stream: &mut TcpStream,
    transaction: u16,
    unit: u8,
    request: &[u8],
    deadline: Instant,
) -> std::io::Result<Vec<u8>> {
    let mut frame = transaction.to_be_bytes().to_vec();
    frame.extend([0, 0]);
    frame.extend((request.len() as u16 + 1).to_be_bytes());
    frame.push(unit);
    frame.extend_from_slice(request);
    stream.write_all(&frame)?;
    loop {
        let mut head = [0; 7];
        read_exact(stream, &mut head, deadline)?;
        let length = usize::from(u16::from_be_bytes([head[4], head[5]]));
        if head[2..4] != [0, 0] || !(2..=frame::PDU_MAX + 1).contains(&length) {
            return Err(std::io::Error::other("what came is not Modbus"));
        }
        let mut body = vec![0; length - 1];
        read_exact(stream, &mut body, deadline)?;
        // An answer that came too late belongs to another request.
        if head[..2] == transaction.to_be_bytes() {
            return Ok(body);
        }
    }
}

/// Fills `out` until the deadline.
fn read_exact(stream: &mut TcpStream, out: &mut [u8], deadline: Instant) -> std::io::Result<()> {
    let mut filled = 0;
    while filled < out.len() {
        let left = deadline.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut out[filled..]) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => filled += count,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

fn over_serial(
    file: &mut File,
    silence: Duration,
    unit: u8,
    request: &[u8],
    deadline: Instant,
) -> std::io::Result<Vec<u8>> {
    // What is left of an earlier answer.
    tcflush(&*file, QueueSelector::IFlush)?;
    std::thread::sleep(silence);
    let mut frame = vec![unit];
    frame.extend_from_slice(request);
    frame.extend(frame::checksum(&frame).to_le_bytes());
    let mut sent = 0;
    while sent < frame.len() {
        match file.write(&frame[sent..]) {
            Ok(count) => sent += count,
            Err(error) if is_early(&error) => wait(deadline)?,
            Err(error) => return Err(error),
        }
    }
    let (mut answer, mut buffer) = (Vec::new(), [0; 256]);
    loop {
        if let Some(length) = frame::serial_length(&answer).filter(|length| answer.len() >= *length) {
            answer.truncate(length);
            let is_whole = answer[0] == unit && frame::checksum(&answer[..length - 2]).to_le_bytes() == answer[length - 2..];
            if !is_whole {
                return Err(std::io::Error::other("a damaged answer"));
            }
            return Ok(answer[1..length - 2].to_vec());
        }
        match file.read(&mut buffer) {
            Ok(0) => wait(deadline)?,
            Ok(count) => answer.extend_from_slice(&buffer[..count]),
            Err(error) if is_early(&error) => wait(deadline)?,
            Err(error) => return Err(error),
        }
    }
}

fn is_early(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

fn wait(deadline: Instant) -> std::io::Result<()> {
    if Instant::now() >= deadline {
        return Err(ErrorKind::TimedOut.into());
    }
    std::thread::sleep(LOOK);
    Ok(())
}

/// Eight bits without any handling of characters.
fn set_line(file: &File, baud: u32, parity: RemoteParity) -> rustix::io::Result<()> {
    let mut line = tcgetattr(file)?;
    line.make_raw();
    line.input_modes.remove(InputModes::IGNBRK | InputModes::BRKINT | InputModes::PARMRK);
    // A character with a wrong parity is left out, and the checksum finds out.
    line.input_modes.insert(InputModes::INPCK | InputModes::IGNPAR);
    let modes = &mut line.control_modes;
    modes.remove(ControlModes::CSIZE | ControlModes::PARENB | ControlModes::PARODD | ControlModes::CSTOPB);
    modes.remove(ControlModes::CRTSCTS);
    modes.insert(ControlModes::CREAD | ControlModes::CLOCAL | ControlModes::CS8);
    match parity {
        RemoteParity::None => modes.insert(ControlModes::CSTOPB),
        RemoteParity::Even => modes.insert(ControlModes::PARENB),
        RemoteParity::Odd => modes.insert(ControlModes::PARENB | ControlModes::PARODD),
    }
    line.set_speed(baud)?;
    tcsetattr(file, OptionalActions::Now, &line)
}
