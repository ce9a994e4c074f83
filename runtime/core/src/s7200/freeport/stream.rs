//! The connection of a port: a serial device, a pseudo-terminal, or a TCP partner. No call waits.

use std::fs::{File, OpenOptions};
use std::net::TcpListener;
use std::os::fd::{AsRawFd, OwnedFd};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use plcc_abi::s7200::image::Link as Target;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{ControlModes, InputModes, OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr};

use super::registers::{Control, Parity};
use crate::communication::link::Link;
use crate::s7200::sockets::{self, Dialer};

/// Maximum bytes that wait for a partner. More are lost, as on a line without a receiver.
const BACKLOG_MAX: usize = 1 << 16;

/// Received characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrived {
    /// `faulty`: wrong parity or no stop bit.
    Character {
        byte: u8,
        faulty: bool,
    },
    Break,
}

/// The other end of a port.
pub struct Stream {
    end: End,
}

enum End {
    Serial { link: Link<File>, marks: Marks },
    PseudoTerminal { link: Link<File>, _name: Name, _slave: OwnedFd },
    Listening { listener: TcpListener, partner: Option<Link> },
    Dialing { dialer: Dialer, partner: Option<Link> },
}

impl Stream {
    /// `Err`: why it cannot be opened.
    pub fn open(target: &Target) -> Result<Stream, String> {
        let end = match target {
            Target::Device(path) => serial(path)?,
            Target::PseudoTerminal(path) => pseudo_terminal(Path::new(path))?,
            Target::Listen(address) => End::Listening { listener: sockets::listen(address)?, partner: None },
            Target::Connect(address) => End::Dialing { dialer: Dialer::new(address)?, partner: None },
        };
        Ok(Stream { end })
    }

    /// A serial device times the characters itself, so it gets them at once.
    pub fn keeps_time(&self) -> bool {
        matches!(self.end, End::Serial { .. })
    }

    /// Applies the settings of SMB30 to a serial device, and forgets what it received before.
    pub fn configure(&mut self, control: &Control) {
        if let End::Serial { link, marks } = &mut self.end {
            // A device that rejects the settings keeps its own.
            let _ = set_line(link.stream(), control);
            let _ = tcflush(link.stream(), QueueSelector::IFlush);
            link.input.clear();
            *marks = Marks::default();
        }
    }

    /// Sends and receives as much as possible, without waiting.
    pub fn work(&mut self) {
        match &mut self.end {
            End::Serial { link, .. } | End::PseudoTerminal { link, .. } => work(link),
            End::Listening { listener, partner } => {
                if partner.is_none() {
                    *partner = sockets::accept(listener);
                }
                work_with(partner);
            }
            End::Dialing { dialer, partner } => {
                if partner.is_none() {
                    *partner = dialer.work();
                }
                work_with(partner);
            }
        }
    }

    /// Takes at most `room` received bytes.
    pub fn take(&mut self, room: usize) -> Vec<Arrived> {
        let take = |input: &mut Vec<u8>| -> Vec<u8> { input.drain(..input.len().min(room)).collect() };
        let plain = |bytes: Vec<u8>| bytes.into_iter().map(|byte| Arrived::Character { byte, faulty: false }).collect();
        match &mut self.end {
            End::Serial { link, marks } => {
                take(&mut link.input).into_iter().filter_map(|byte| marks.read(byte)).collect()
            }
            End::PseudoTerminal { link, .. } => plain(take(&mut link.input)),
            End::Listening { partner, .. } | End::Dialing { partner, .. } => {
                plain(partner.as_mut().map(|link| take(&mut link.input)).unwrap_or_default())
            }
        }
    }

    /// Sends bytes; without a partner they are lost.
    pub fn send(&mut self, bytes: &[u8]) {
        match &mut self.end {
            End::Serial { link, .. } | End::PseudoTerminal { link, .. } => {
                if link.backlog() > BACKLOG_MAX {
                    link.discard_backlog();
                }
                link.send(bytes);
            }
            End::Listening { partner, .. } | End::Dialing { partner, .. } => {
                if let Some(link) = partner {
                    link.send(bytes);
                }
            }
        }
    }

    /// Begins or ends a break. Only a serial device can show it.
    pub fn set_break(&mut self, on: bool) {
        if let End::Serial { link, .. } = &self.end {
            let request = if on { libc::TIOCSBRK } else { libc::TIOCCBRK };
            // SAFETY: the descriptor is open, and these requests take no argument. Devices without breaks refuse.
            let _ = unsafe { libc::ioctl(link.stream().as_raw_fd(), request) };
        }
    }
}

fn work(link: &mut Link<File>) {
    // A terminal comes to life again: neither its end nor an error is for ever.
    link.ended = false;
    link.broken = false;
    link.work();
}

/// A partner that is gone makes room for the next when all that it sent is taken.
fn work_with(partner: &mut Option<Link>) {
    let Some(link) = partner else { return };
    link.work();
    if (link.ended || link.broken || link.backlog() > BACKLOG_MAX) && link.input.is_empty() {
        *partner = None;
    }
}

fn serial(path: &str) -> Result<End, String> {
    let flags = libc::O_NOCTTY | libc::O_NONBLOCK;
    let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path);
    let file = file.map_err(|error| format!("cannot open {path}: {error}"))?;
    tcgetattr(&file).map_err(|error| format!("{path} is not a serial device: {error}"))?;
    Ok(End::Serial { link: Link::of(file), marks: Marks::default() })
}

/// 8N1 and the like, raw; faulty characters and breaks come marked, see [`Marks`].
fn set_line(file: &File, control: &Control) -> rustix::io::Result<()> {
    let mut line = tcgetattr(file)?;
    line.make_raw();
    line.input_modes.remove(InputModes::IGNBRK | InputModes::BRKINT | InputModes::IGNPAR | InputModes::ISTRIP);
    line.input_modes.insert(InputModes::PARMRK | InputModes::INPCK);
    let modes = &mut line.control_modes;
    modes.remove(ControlModes::CSIZE | ControlModes::PARENB | ControlModes::PARODD | ControlModes::CSTOPB);
    modes.remove(ControlModes::CRTSCTS);
    modes.insert(ControlModes::CREAD | ControlModes::CLOCAL);
    modes.insert(if control.seven_bits { ControlModes::CS7 } else { ControlModes::CS8 });
    match control.parity {
        Parity::None => {}
        Parity::Even => modes.insert(ControlModes::PARENB),
        Parity::Odd => modes.insert(ControlModes::PARENB | ControlModes::PARODD),
    }
    line.set_speed(control.baud)?;
    tcsetattr(file, OptionalActions::Now, &line)
}

/// Marks of a terminal with PARMRK: `FF FF` is the character FF, `FF 00 00` a break, `FF 00 x` the faulty character x.
#[derive(Clone, Copy, Debug, Default)]
enum Marks {
    #[default]
    None,
    First,
    Second,
}

impl Marks {
    fn read(&mut self, byte: u8) -> Option<Arrived> {
        let (next, arrived) = match (*self, byte) {
            (Marks::None, 0xFF) => (Marks::First, None),
            (Marks::First, 0) => (Marks::Second, None),
            (Marks::None | Marks::First, _) => (Marks::None, Some(Arrived::Character { byte, faulty: false })),
            (Marks::Second, 0) => (Marks::None, Some(Arrived::Break)),
            (Marks::Second, _) => (Marks::None, Some(Arrived::Character { byte, faulty: true })),
        };
        *self = next;
        arrived
    }
}

fn pseudo_terminal(path: &Path) -> Result<End, String> {
    let wrong =
        |error: &dyn std::fmt::Display| format!("cannot make a pseudo-terminal for {}: {error}", path.display());
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).map_err(|error| wrong(&error))?;
    grantpt(&master).and_then(|()| unlockpt(&master)).map_err(|error| wrong(&error))?;
    let name = ptsname(&master, Vec::new()).map_err(|error| wrong(&error))?;
    let terminal = Path::new(std::ffi::OsStr::from_bytes(name.as_bytes()));
    // Held open: without a slave the master reports errors instead of waiting for one.
    let flags = libc::O_NOCTTY;
    let slave = OpenOptions::new().read(true).write(true).custom_flags(flags).open(terminal);
    let slave = OwnedFd::from(slave.map_err(|error| wrong(&error))?);
    let mut line = tcgetattr(&slave).map_err(|error| wrong(&error))?;
    line.make_raw();
    tcsetattr(&slave, OptionalActions::Now, &line).map_err(|error| wrong(&error))?;
    let master = File::from(master);
    set_nonblocking(&master).map_err(|error| wrong(&error))?;
    let name = Name::link(terminal, path).map_err(|error| wrong(&error))?;
    Ok(End::PseudoTerminal { link: Link::of(master), _name: name, _slave: slave })
}

fn set_nonblocking(file: &File) -> std::io::Result<()> {
    let flags = rustix::fs::fcntl_getfl(file)?;
    Ok(rustix::fs::fcntl_setfl(file, flags | rustix::fs::OFlags::NONBLOCK)?)
}

/// A symbolic link that goes with the program.
struct Name(PathBuf);

impl Name {
    fn link(terminal: &Path, path: &Path) -> std::io::Result<Name> {
        // A link from an earlier run is replaced, anything else is not.
        if path.symlink_metadata().is_ok_and(|old| old.file_type().is_symlink()) {
            std::fs::remove_file(path)?;
        }
        std::os::unix::fs::symlink(terminal, path)?;
        Ok(Name(path.to_path_buf()))
    }
}

impl Drop for Name {
    fn drop(&mut self) {
        // Somebody may have removed it before.
        let _ = std::fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_terminals() {
        let mut marks = Marks::default();
        let bytes = [0x41, 0xFF, 0xFF, 0xFF, 0, 0, 0xFF, 0, 0x42, 0];
        let arrived: Vec<_> = bytes.into_iter().filter_map(|byte| marks.read(byte)).collect();
        let character = |byte, faulty| Arrived::Character { byte, faulty };
        assert_eq!(
            arrived,
            [
                character(0x41, false),
                character(0xFF, false),
                Arrived::Break,
                character(0x42, true),
                character(0, false)
            ]
        );
    }
}
