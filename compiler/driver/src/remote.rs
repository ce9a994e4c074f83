//! `[io.NAME]` of plc.toml: devices on a field bus whose data are inputs and outputs.

use std::collections::BTreeMap;
use std::net::Ipv6Addr;

use plcc_abi::image::Module;
use plcc_abi::remote::{RemoteChannel, RemoteLine, RemoteParity, RemoteScale, RemoteStation, RemoteTable};
use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_runtime::address::{self, Place, Width};
use plcc_runtime::{analog, io};
use serde::Deserialize;
use toml::Spanned;

use crate::keys::one_of;
use crate::project::{duration_ms, number_within};

/// `[io.NAME]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IoKeys {
    modbus: Option<Spanned<String>>,
    serial: Option<Spanned<String>>,
    baud: Option<Spanned<i64>>,
    parity: Option<Spanned<String>>,
    unit: Option<Spanned<i64>>,
    poll: Option<Spanned<String>>,
    timeout: Option<Spanned<String>>,
    away: Option<Spanned<String>>,
    #[serde(default)]
    data: Vec<DataKeys>,
}

/// `[[io.NAME.data]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DataKeys {
    at: Spanned<String>,
    coils: Option<Spanned<i64>>,
    discrete: Option<Spanned<i64>>,
    holding: Option<Spanned<i64>>,
    input: Option<Spanned<i64>>,
    count: Option<Spanned<i64>>,
    bytes: Option<Spanned<String>>,
    words: Option<Spanned<String>>,
    raw: Option<Spanned<[i64; 2]>>,
    range: Option<Spanned<String>>,
    substitute: Option<Spanned<i64>>,
}

/// Port of Modbus TCP.
const PORT: u16 = 502;
/// Speeds of serial lines.
const BAUD: std::ops::RangeInclusive<i64> = 300..=4_000_000;
/// Times of exchanges and answers.
const TIME_MS: std::ops::RangeInclusive<u32> = 1..=3_600_000;
/// Devices of a program; each has a thread.
const STATIONS_MAX: usize = 125;

/// Reads the tables. Reports wrong keys and ignores them.
pub fn read(tables: &BTreeMap<Spanned<String>, IoKeys>, file: FileId) -> (Vec<RemoteStation>, Vec<Diagnostic>) {
    let mut reader = Reader { file, diagnostics: Vec::new(), taken: Vec::new() };
    // In the order of the file, which numbers them.
    let mut tables: Vec<_> = tables.iter().collect();
    tables.sort_by_key(|(name, _)| name.span().start);
    if let Some((name, _)) = tables.get(STATIONS_MAX) {
        reader.report(name, format!("more than {STATIONS_MAX} devices"), "leave some out");
    }
    let mut stations: Vec<RemoteStation> = Vec::new();
    for (name, keys) in tables.iter().take(STATIONS_MAX) {
        let Some(station) = reader.station(name, keys) else { continue };
        if let Some(other) = stations.iter().find(|other| differs(&other.line, &station.line)) {
            let title = format!("`{}` and `{}` are on one line with different settings", other.name, station.name);
            reader.report(name, title, "give them the same `baud` and `parity`");
        }
        stations.push(station);
    }
    (stations, reader.diagnostics)
}

/// One serial line with two settings.
fn differs(a: &RemoteLine, b: &RemoteLine) -> bool {
    matches!((a, b), (RemoteLine::Serial { path: one, .. }, RemoteLine::Serial { path: other, .. }) if one == other)
        && a != b
}

/// The addresses of devices, for a CPU whose modules are described.
pub fn modules(stations: &[RemoteStation]) -> impl Iterator<Item = Module> {
    stations.iter().flat_map(|station| {
        station.channels.iter().map(|channel| {
            let own = (channel.byte, channel.bytes());
            let (input, output) = if channel.output { ((0, 0), own) } else { (own, (0, 0)) };
            Module {
                name: format!("io {}", station.name),
                input_start: input.0,
                input_bytes: input.1,
                output_start: output.0,
                output_bytes: output.1,
                station: None,
            }
        })
    })
}

/// The address of a device with its port. `Err`: what to write.
fn tcp_address(text: &str) -> Result<String, String> {
    let usual = || "write `192.168.0.20:502`".to_string();
    if text.is_empty() || text.contains(char::is_whitespace) || text.contains('/') {
        return Err(usual());
    }
    if text.parse::<Ipv6Addr>().is_ok() {
        return Ok(format!("[{text}]:{PORT}"));
    }
    // Colons within brackets are those of an address of version 6.
    let after_host = if text.starts_with('[') { text.find(']').map(|at| at + 1) } else { text.find(':') };
    let is_v6 = |host: &str| host.strip_suffix(']').is_some_and(|host| host.parse::<Ipv6Addr>().is_ok());
    match after_host.map_or((text, ""), |at| text.split_at(at)) {
        ("", _) => Err(usual()),
        (host, _) if host.strip_prefix('[').is_some_and(|host| !is_v6(host)) => Err(usual()),
        (host, "") => Ok(format!("{host}:{PORT}")),
        (host, rest) => match rest.strip_prefix(':').map(|port| (port, port.parse::<u16>())) {
            Some((_, Ok(port))) if port != 0 => Ok(text.to_string()),
            Some(("", _)) => Err(format!("write `{host}:{PORT}`")),
            Some((port, _)) => Err(format!("`{port}` is not a port, a number from 1 to 65535: write `{host}:{PORT}`")),
            None => Err(usual()),
        },
    }
}

/// The key and the address that are meant by a reference number: 40001 and 400001 are the first holding register. `None`: it is not one.
/// Those of coils have no digit of their own, so they cannot be told from addresses.
///
/// Source: MODBUS Application Protocol Specification V1.1b3, 4.4: element n of a table has the address n - 1.
fn address_of_reference(table: RemoteTable, number: i64) -> Option<(&'static str, i64)> {
    let (word, digit) = match table {
        RemoteTable::Coils => return None,
        RemoteTable::DiscreteInputs => ("discrete", 1),
        RemoteTable::InputRegisters => ("input", 3),
        RemoteTable::HoldingRegisters => ("holding", 4),
    };
    let forms = [(10_000, 9_999), (100_000, 65_536)];
    forms.into_iter().find_map(|(place, last)| {
        let element = number.checked_sub(digit * place).filter(|element| (1..=last).contains(element))?;
        Some((word, element - 1))
    })
}

struct Reader {
    file: FileId,
    diagnostics: Vec<Diagnostic>,
    /// Bits that channels have: output, first, end, name of the device.
    taken: Vec<(bool, u32, u32, String)>,
}

impl Reader {
    fn report<T>(&mut self, key: &Spanned<T>, title: String, help: &str) {
        self.diagnostics.push(Diagnostic::new(Code::Project, Span::new(self.file, key.span()), title).help(help));
    }

    fn number<T: TryFrom<i64>>(
        &mut self,
        key: &Option<Spanned<i64>>,
        range: std::ops::RangeInclusive<i64>,
        what: &str,
        usual: T,
    ) -> Option<T> {
        let Some(key) = key else { return Some(usual) };
        let help = format!("write a number from {} to {}", range.start(), range.end());
        number_within(key, range, what).map_err(|title| self.report(key, title, &help)).ok()
    }

    fn time(&mut self, key: &Option<Spanned<String>>, usual: u32) -> Option<u32> {
        let Some(key) = key else { return Some(usual) };
        let ms = duration_ms(key.get_ref()).filter(|ms| TIME_MS.contains(ms));
        if ms.is_none() {
            self.report(key, format!("`{}` is not a time from 1 ms to 1 h", key.get_ref()), "write `100ms` or `2s`");
        }
        ms
    }

    /// One of two words; true: the second.
    fn word(&mut self, key: &Option<Spanned<String>>, words: [&str; 2]) -> Option<bool> {
        let Some(key) = key else { return Some(false) };
        let found = words.iter().position(|word| word == key.get_ref());
        if found.is_none() {
            let [first, second] = words;
            let title = format!("`{}` is neither `{first}` nor `{second}`", key.get_ref());
            self.report(key, title, &one_of(key.get_ref(), &words));
        }
        found.map(|index| index == 1)
    }

    fn station(&mut self, name: &Spanned<String>, keys: &IoKeys) -> Option<RemoteStation> {
        let line = self.line(name, keys);
        let unit = self.number(&keys.unit, 0..=255, "an address of a device", 1u8);
        if let Some(key) = keys.unit.as_ref().filter(|key| *key.get_ref() == 0 && keys.serial.is_some()) {
            let title = "on a serial line 0 is all devices, and none of them answers".to_string();
            self.report(key, title, "write the address of the device, from 1 to 247");
        }
        let poll_ms = self.time(&keys.poll, 100);
        let timeout_ms = self.time(&keys.timeout, 1000);
        let substitute = self.word(&keys.away, ["keep", "substitute"]);
        if keys.data.is_empty() {
            let own = name.get_ref();
            let is_plain =
                !own.is_empty() && own.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-".contains(&byte));
            let quote = if is_plain { "" } else { "\"" };
            let help = format!("add `[[io.{quote}{own}{quote}.data]]` with a table and `at`");
            self.report(name, format!("`{own}` has no data"), &help);
        }
        let channels: Vec<Option<RemoteChannel>> =
            keys.data.iter().map(|data| self.channel(name.get_ref(), data)).collect();
        Some(RemoteStation {
            name: name.get_ref().clone(),
            line: line?,
            unit: unit?,
            poll_ms: poll_ms?,
            timeout_ms: timeout_ms?,
            keep: !substitute?,
            channels: channels.into_iter().collect::<Option<_>>()?,
        })
    }

    fn line(&mut self, name: &Spanned<String>, keys: &IoKeys) -> Option<RemoteLine> {
        let baud = self.number(&keys.baud, BAUD, "a speed", 19_200u32);
        let parity = match keys.parity.as_ref().map(|key| (key, key.get_ref().as_str())) {
            None | Some((_, "even")) => Some(RemoteParity::Even),
            Some((_, "odd")) => Some(RemoteParity::Odd),
            Some((_, "none")) => Some(RemoteParity::None),
            Some((key, other)) => {
                let title = format!("`{other}` is not `even`, `odd` or `none`");
                self.report(key, title, &one_of(other, &["even", "odd", "none"]));
                None
            }
        };
        match (&keys.modbus, &keys.serial) {
            (Some(address), None) => {
                let of_serial = [
                    ("baud", keys.baud.as_ref().map(Spanned::span)),
                    ("parity", keys.parity.as_ref().map(Spanned::span)),
                ];
                for (key, span) in of_serial.into_iter().filter_map(|(key, span)| Some((key, span?))) {
                    let title = format!("`{key}` is a setting of serial lines");
                    let help = "leave it out, or write `serial` in place of `modbus`";
                    self.diagnostics.push(Diagnostic::new(Code::Project, Span::new(self.file, span), title).help(help));
                }
                match tcp_address(address.get_ref().trim()) {
                    Ok(text) => Some(RemoteLine::Tcp(text)),
                    Err(help) => {
                        let title = format!("`{}` is not an address", address.get_ref());
                        self.report(address, title, &help);
                        None
                    }
                }
            }
            (None, Some(path)) => {
                if path.get_ref().is_empty() || path.get_ref().contains('\0') {
                    self.report(path, "no name of a serial device".to_string(), "write `/dev/ttyUSB0`");
                    return None;
                }
                Some(RemoteLine::Serial { path: path.get_ref().clone(), baud: baud?, parity: parity? })
            }
            _ => {
                let title = format!("`{}` needs either `modbus` or `serial`", name.get_ref());
                self.report(name, title, "write `modbus = \"192.168.0.20:502\"` or `serial = \"/dev/ttyUSB0\"`");
                None
            }
        }
    }

    fn channel(&mut self, station: &str, keys: &DataKeys) -> Option<RemoteChannel> {
        let tables = [
            (RemoteTable::Coils, &keys.coils),
            (RemoteTable::DiscreteInputs, &keys.discrete),
            (RemoteTable::HoldingRegisters, &keys.holding),
            (RemoteTable::InputRegisters, &keys.input),
        ];
        let given: Vec<_> = tables.iter().filter(|(_, key)| key.is_some()).collect();
        let [(table, first)] = given[..] else {
            let title = "data need one table: `coils`, `discrete`, `holding` or `input`".to_string();
            self.report(&keys.at, title, "write the number of the first element, from 0: `holding = 0`");
            return None;
        };
        let table = *table;
        let first: &Option<Spanned<i64>> = first;
        if let Some(key) = first
            && self.is_reference(table, key)
        {
            return None;
        }
        let first: u16 = self.number(first, 0..=0xFFFF, "a number of an element", 0)?;
        let (output, byte, bit, width) = self.place(&keys.at, table)?;
        let usual: u16 = match width {
            Width::Byte => 8,
            Width::Dword => 2,
            Width::Bit(_) | Width::Word | Width::Lword => 1,
        };
        let most = table.count_max(output);
        let count = self.number(&keys.count, 1..=most.into(), "a number of elements of one request", usual)?;
        if u32::from(first) + u32::from(count) > 0x1_0000 {
            let last = u32::from(first) + u32::from(count) - 1;
            let help = format!("the last one here is {last}: begin earlier, or read fewer");
            self.report(&keys.at, "the table has elements up to 65535".to_string(), &help);
            return None;
        }
        let low_byte_first = self.word(&keys.bytes, ["high first", "low first"])?;
        let low_word_first = self.word(&keys.words, ["high first", "low first"])?;
        if let Some(key) = keys.words.as_ref().filter(|_| low_word_first && !count.is_multiple_of(2)) {
            self.report(key, "the order of words needs pairs of registers".to_string(), "make `count` even");
            return None;
        }
        let registers_only = [keys.bytes.as_ref().map(|key| key.span()), keys.words.as_ref().map(|key| key.span())];
        if let Some(span) = registers_only.into_iter().flatten().next().filter(|_| table.has_bits()) {
            let title = "bits have no order of bytes and words".to_string();
            self.diagnostics
                .push(Diagnostic::new(Code::Project, Span::new(self.file, span), title).help("leave it out"));
            return None;
        }
        let scale = self.scale(keys, table)?;
        let limits = if table.has_bits() { 0..=1 } else { -32768..=65535 };
        let substitute: i64 = self.number(&keys.substitute, limits, "a substitute value", 0)?;
        let channel = RemoteChannel {
            table,
            first,
            count,
            output,
            byte,
            bit,
            low_byte_first,
            low_word_first,
            scale,
            substitute: substitute as u16,
        };
        self.take(station, keys, &channel).then_some(channel)
    }

    /// Tells reference numbers from addresses. True: the number can only be a reference number, which is an error.
    fn is_reference(&mut self, table: RemoteTable, key: &Spanned<i64>) -> bool {
        let number = *key.get_ref();
        let Some((word, address)) = address_of_reference(table, number) else { return false };
        let can_be_address = number <= 0xFFFF;
        // Manuals have reference numbers in decimal digits: `0x9C41` is an address. The registers of SunSpec are from 40000 on.
        if can_be_address && key.span().len() != number.to_string().len() {
            return false;
        }
        let title = format!("{number} looks like a reference number, as manuals of devices have it");
        let help = format!("write `{word} = {address}`, the address of that element: addresses begin at 0");
        let mut message = Diagnostic::new(Code::Project, Span::new(self.file, key.span()), title);
        if can_be_address {
            message.severity = Severity::Warning;
        }
        self.diagnostics.push(message.help(match can_be_address {
            true => format!("{help}; if {number} is the address itself, write `{word} = 0x{number:X}`"),
            false => help,
        }));
        !can_be_address
    }

    /// Direction, byte, bit and width of `at`.
    fn place(&mut self, at: &Spanned<String>, table: RemoteTable) -> Option<(bool, u32, u8, Width)> {
        let text = at.get_ref();
        let found = address::parse(text).and_then(|address| match address.place {
            Place::Input(byte) => Some((false, byte, address.width, "I")),
            Place::PeripheralInput(byte) => Some((false, byte, address.width, "PI")),
            Place::Output(byte) => Some((true, byte, address.width, "Q")),
            Place::PeripheralOutput(byte) => Some((true, byte, address.width, "PQ")),
            _ => None,
        });
        let Some((output, byte, width, area)) = found else {
            self.report(at, format!("`{text}` is not an input or output"), "write `I4.0`, `QB4`, `IW256` or `PQW256`");
            return None;
        };
        let bit = match (table.has_bits(), width) {
            (true, Width::Bit(bit)) => bit,
            (true, Width::Byte) => 0,
            (false, Width::Word | Width::Dword) => 0,
            (true, _) => {
                let first = if area.starts_with('P') { String::new() } else { format!("`{area}{byte}.0` or ") };
                let help = format!("write {first}`{area}B{byte}`");
                self.report(at, format!("`{text}`: elements of this table are bits"), &help);
                return None;
            }
            (false, _) => {
                let help = format!("write `{area}W{byte}`, or `{area}D{byte}` for two of them");
                self.report(at, format!("`{text}`: elements of this table are words"), &help);
                return None;
            }
        };
        if output && !table.is_writable() {
            self.report(at, format!("`{text}`: this table can only be read"), "use `coils` or `holding` for outputs");
            return None;
        }
        Some((output, byte, bit, width))
    }

    fn scale(&mut self, keys: &DataKeys, table: RemoteTable) -> Option<Option<RemoteScale>> {
        let Some(raw) = &keys.raw else {
            if let Some(range) = &keys.range {
                let title = "a range needs the numbers of the device at its ends".to_string();
                self.report(range, title, "add `raw = [0, 10000]`");
                return None;
            }
            return Some(None);
        };
        let [low, high] = *raw.get_ref();
        let fits = |value: i64| if low.min(high) < 0 { (-32768..=32767).contains(&value) } else { value <= 65535 };
        if table.has_bits() || low == high || !fits(low) || !fits(high) {
            let title = "`raw` is not the two numbers of a register at the ends of its range".to_string();
            self.report(raw, title, "write `raw = [0, 10000]`, for registers only");
            return None;
        }
        let (word_low, word_high) = match &keys.range {
            None if low.min(high) < 0 => (-27_648, 27_648),
            None => (0, 27_648),
            Some(name) => match analog::range(name.get_ref()) {
                Some(range) => range.words(),
                None => {
                    let names: Vec<&str> = analog::RANGES.iter().map(|range| range.name).collect();
                    let title = format!("`{}` is not a range of analog modules", name.get_ref());
                    self.report(name, title, &one_of(name.get_ref(), &names));
                    return None;
                }
            },
        };
        Some(Some(RemoteScale { raw_low: low as i32, raw_high: high as i32, word_low, word_high }))
    }

    /// Notes the bits of a channel. False: they do not exist, or another one has them.
    fn take(&mut self, station: &str, keys: &DataKeys, channel: &RemoteChannel) -> bool {
        let first = 8 * channel.byte + u32::from(channel.bit);
        let bits = if channel.table.has_bits() { channel.count.into() } else { 16 * u32::from(channel.count) };
        let end = first + bits;
        if end > 8 * io::PERIPHERAL_BYTES {
            let title = format!("`{}` with {} elements ends after the last address", keys.at.get_ref(), channel.count);
            self.report(&keys.at, title, "use a lower address");
            return false;
        }
        let mut others = self.taken.iter();
        let other = others.find(|(output, start, stop, _)| *output == channel.output && first < *stop && *start < end);
        if let Some((.., name)) = other {
            let title = format!("`{}` has addresses in common with other data of `{name}`", keys.at.get_ref());
            self.report(&keys.at, title, "give all data their own addresses");
            return false;
        }
        self.taken.push((channel.output, first, end, station.to_string()));
        true
    }
}

#[cfg(test)]
mod tests;
