//! Characters that a scenario sends to the serial ports of an S7-200 and expects from them.

use std::collections::BTreeMap;

use plcc_abi::ProgramImage;
use toml::Spanned;

use crate::cpu::Cpu;
use crate::testing::AssertFailure;

/// Characters that arrive at a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    pub port: u8,
    pub bytes: Vec<u8>,
    pub parity_error: bool,
    /// A break comes before them.
    pub line_break: bool,
}

/// Characters that a port has sent since the last entry that compared them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sent {
    pub port: u8,
    pub bytes: Vec<u8>,
    pub line: u32,
}

/// An error with the offset of its place.
type Wrong = (usize, String);
/// A table of ports as it is in the file.
pub(super) type PortsText = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

pub(super) fn received(table: &PortsText, image: &ProgramImage) -> Result<Vec<Received>, Wrong> {
    let one = |(name, value): (&Spanned<String>, &Spanned<toml::Value>)| {
        let port = port(name, image)?;
        let wrong = |message: String| (value.span().start, message);
        let mut received = Received { port, bytes: Vec::new(), parity_error: false, line_break: false };
        let toml::Value::Table(keys) = value.get_ref() else {
            received.bytes = bytes(value.get_ref()).map_err(wrong)?;
            return Ok(received);
        };
        for (key, value) in keys {
            match (key.as_str(), value) {
                ("bytes", value) => received.bytes = bytes(value).map_err(wrong)?,
                ("parity-error" | "parity_error", toml::Value::Boolean(on)) => received.parity_error = *on,
                ("break", toml::Value::Boolean(on)) => received.line_break = *on,
                _ => return Err(wrong(format!("`{key}`: write `bytes`, `parity-error = true` or `break = true`"))),
            }
        }
        Ok(received)
    };
    table.iter().map(one).collect()
}

pub(super) fn sent(table: &PortsText, image: &ProgramImage, line: &dyn Fn(usize) -> u32) -> Result<Vec<Sent>, Wrong> {
    let one = |(name, value): (&Spanned<String>, &Spanned<toml::Value>)| {
        let offset = value.span().start;
        let bytes = bytes(value.get_ref()).map_err(|message| (offset, message))?;
        Ok(Sent { port: port(name, image)?, bytes, line: line(offset) })
    };
    table.iter().map(one).collect()
}

/// `port0`, `port1`.
fn port(name: &Spanned<String>, image: &ProgramImage) -> Result<u8, Wrong> {
    let wrong = |message: String| Err((name.span().start, message));
    if image.s7200.is_none() {
        return wrong("only an S7-200 has serial ports".to_string());
    }
    match name.get_ref().to_ascii_lowercase().as_str() {
        "port0" => Ok(0),
        "port1" => Ok(1),
        _ => wrong(format!("`{}` is not a port; the ports are `port0` and `port1`", name.get_ref())),
    }
}

/// A text, of characters that are a byte, or a list of bytes.
fn bytes(value: &toml::Value) -> Result<Vec<u8>, String> {
    match value {
        toml::Value::String(text) => {
            let byte = |c: char| u8::try_from(c).map_err(|_| format!("`{c}` is not a byte"));
            text.chars().map(byte).collect()
        }
        toml::Value::Array(list) => {
            let byte = |item: &toml::Value| {
                let byte = item.as_integer().and_then(|number| u8::try_from(number).ok());
                byte.ok_or_else(|| format!("`{item}` is not a byte from 0 to 255"))
            };
            list.iter().map(byte).collect()
        }
        _ => Err("write the characters as a text or a list of bytes".to_string()),
    }
}

impl Received {
    pub fn feed(&self, cpu: &Cpu) {
        if self.line_break {
            cpu.s7200_feed_break(self.port);
        }
        cpu.s7200_feed(self.port, &self.bytes, self.parity_error);
    }
}

impl Sent {
    /// `None`: the port has sent this and nothing else.
    pub fn compare(&self, cpu: &Cpu, file: &str) -> Option<AssertFailure> {
        let sent = cpu.s7200_take_sent(self.port);
        (sent != self.bytes).then(|| self.failure(file, quoted(&sent)))
    }

    pub fn failure(&self, file: &str, left: String) -> AssertFailure {
        let right = quoted(&self.bytes);
        AssertFailure {
            text: format!("port{} sent {right}", self.port),
            left,
            right,
            ..AssertFailure::at(file, self.line)
        }
    }
}

fn quoted(bytes: &[u8]) -> String {
    format!("\"{}\"", bytes.escape_ascii())
}

#[cfg(test)]
mod tests {
    use plcc_abi::s7200::{Operation, S7200Image, V_DB};

    use crate::scenario::{Player, Scenario};
    use crate::tests::image;

    fn image_of_s7200() -> plcc_abi::ProgramImage {
        let mut image = image(&[]);
        image.s7200 = Some(S7200Image::default());
        image
    }

    fn parse(text: &str) -> Result<Scenario, String> {
        Scenario::parse("s.toml", text, &image_of_s7200())
    }

    #[test]
    fn all_forms() {
        let scenario = parse(
            "[[at]]\ncycle = 2\n\
             receive = { port0 = \"a\\r\\u00ff\", port1 = { bytes = [1, 2], parity-error = true } }\n\
             [[at]]\ncycle = 3\nreceive = { port1 = { break = true, bytes = \"x\" } }\n\
             expect-sent = { port0 = [104, 105] }\n",
        )
        .unwrap();
        let at = &scenario.entries;
        assert_eq!((at[0].receive[0].port, &at[0].receive[0].bytes[..]), (0, &b"a\r\xFF"[..]));
        assert_eq!((at[0].receive[1].port, &at[0].receive[1].bytes[..]), (1, &[1, 2][..]));
        assert!(at[0].receive[1].parity_error && !at[0].receive[0].parity_error);
        assert!(at[1].receive[0].line_break && at[1].receive[0].bytes == b"x");
        assert_eq!((at[1].sent[0].port, &at[1].sent[0].bytes[..], at[1].sent[0].line), (0, &b"hi"[..], 7));
    }

    #[test]
    fn errors_name_the_line() {
        let message = |text: &str| parse(&format!("[[at]]\ncycle = 1\n{text}\n")).unwrap_err();
        assert_eq!(
            message("receive = { port2 = \"a\" }"),
            "s.toml:3: `port2` is not a port; the ports are `port0` and `port1`"
        );
        assert_eq!(message("receive = { port0 = [256] }"), "s.toml:3: `256` is not a byte from 0 to 255");
        assert_eq!(message("receive = { port0 = \"\u{20AC}\" }"), "s.toml:3: `\u{20AC}` is not a byte");
        assert!(message("receive = { port0 = { text = \"a\" } }").starts_with("s.toml:3: `text`: write `bytes`"));
        assert!(message("expect-sent = { port0 = true }").ends_with("a text or a list of bytes"));
        let other = Scenario::parse("s.toml", "[[at]]\ncycle = 1\nreceive = { port0 = \"a\" }", &image(&[]));
        assert_eq!(other.unwrap_err(), "s.toml:3: only an S7-200 has serial ports");
    }

    #[test]
    fn what_was_sent_is_compared() {
        use crate::cycle::Observer;
        use crate::s7200::Operands;
        let scenario = parse(
            "[[at]]\ncycle = 1\nexpect-sent = { port0 = \"hi\" }\n[[at]]\ncycle = 2\nexpect-sent = { port0 = \"hi\" }\n\
             [[at]]\ncycle = 9\nexpect-sent = { port0 = \"\" }\n",
        );
        let cpu = crate::s7200::cpu_for_tests();
        let (v, _) = cpu.memory.db(V_DB);
        cpu.memory.load(v, b"\x02hi");
        let operands = Operands { a: v, ..Operands::default() };
        cpu.s7200_operation(Operation::Transmit as u32, &operands);
        cpu.clock.move_to(10_000_000);
        cpu.s7200_poll_ports();
        let mut player = Player::new(scenario.unwrap(), &cpu).unwrap();
        for cycle in 1..3 {
            player.before(&cpu, cycle, 0);
            player.after(&cpu, cycle, 0);
        }
        let failures: Vec<_> = player.failures().into_iter().map(|f| (f.line, f.text, f.left)).collect();
        assert_eq!(player.expectations_met(), 1);
        assert_eq!(
            failures,
            [
                (6, "port0 sent \"hi\"".to_string(), "\"\"".to_string()),
                (9, "port0 sent \"\"".to_string(), "(not reached)".to_string()),
            ]
        );
    }
}
