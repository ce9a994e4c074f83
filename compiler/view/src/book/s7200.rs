//! Pages of programs of the S7-200.

use plcc_syntax::s7200::ast as s7200;
use plcc_syntax::s7200::{Insn, libraries};
use plcc_syntax::stl::Mnemonics;

use super::{Declaration, Maker, Page, Section};
use crate::names::Scope;
use crate::sheet;
use crate::sheet::s7200::Subroutine;

impl Maker<'_> {
    pub(super) fn s7200(&self, block: &s7200::Block) -> Page {
        let prefix = match block.kind {
            s7200::BlockKind::Main => "OB",
            s7200::BlockKind::Subroutine => "SBR",
            s7200::BlockKind::Interrupt => "INT",
        };
        let number = block.number.map(|(number, _)| number).or((prefix == "OB").then_some(1));
        let name = block.name.as_ref().map_or(String::new(), |(name, _)| name.clone());
        let id =
            number.map_or(if name.is_empty() { prefix.to_string() } else { name.clone() }, |n| format!("{prefix} {n}"));
        let mut page = Page {
            id,
            name,
            language: "STL",
            title: block.title.clone(),
            comment: block.comment.clone(),
            ..Page::default()
        };
        for (row, address) in block.declarations.iter().zip(addresses(&block.declarations)) {
            page.declarations.push(Declaration {
                address,
                section: match row.section {
                    s7200::Section::Input => "Input",
                    s7200::Section::InOut => "InOut",
                    s7200::Section::Output => "Output",
                    s7200::Section::Temp => "Temp",
                },
                name: row.name.clone(),
                ty: row.ty.clone(),
                comment: row.comment.clone().unwrap_or_default(),
                ..Declaration::default()
            });
        }
        let scope = Scope { german: self.unit.mnemonics == Mnemonics::De, ..Scope::default() };
        page.scope = scope;
        // The bit of the sequence step that the networks are in.
        let mut step = String::new();
        for (at, network) in block.networks.iter().enumerate() {
            // Micro/WIN writes symbols without quotes.
            let label = |operand: &s7200::Operand| {
                let words = self.words(operand.span);
                let label = match (&operand.shown, words.rsplit_once(':')) {
                    (Some(_), Some((symbol, address))) => self.symbol_with_address(symbol, address, scope),
                    _ => self.names.label(&words, scope),
                };
                match label.text.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
                    Some(bare) if !label.key.is_empty() => sheet::Label { text: bare.to_string(), ..label },
                    _ => label,
                }
            };
            let drawn = sheet::s7200::sheet(&network.statements, &label, &|name, count| self.subroutine(name, count));
            let frame = frame(network);
            let drawn = drawn.map(|drawn| match frame {
                Frame::None => sheet::Sheet { rail: step.clone(), ..drawn },
                Frame::Begins(_) | Frame::Ends => drawn,
            });
            match frame {
                Frame::None => {}
                Frame::Begins(bit) => step = label(bit).key,
                Frame::Ends => step.clear(),
            }
            let spans = network.statements.iter().map(|statement| statement.span);
            page.sections.push(Section {
                number: network.number.map_or(at + 1, |number| number as usize),
                title: network.title.clone(),
                comment: network.comment.clone(),
                ..self.rungs(drawn, spans)
            });
        }
        page
    }

    /// `Start:I0.0`, `#Raw:LW0`, `Fill:SBR0`.
    fn symbol_with_address(&self, symbol: &str, address: &str, scope: Scope) -> sheet::Label {
        let (symbol, address) = (symbol.trim(), address.trim());
        let key = self.names.key(if symbol.starts_with('#') { symbol } else { address }, scope).unwrap_or_default();
        sheet::Label { text: symbol.to_string(), address: address.to_string(), key, ..sheet::Label::default() }
    }

    /// The subroutine with a name or number to which `count` arguments are passed.
    fn subroutine(&self, name: &str, count: usize) -> Option<Subroutine> {
        let name = name.trim_matches('"');
        let sources = self.units.iter().filter_map(|(_, unit)| unit.s7200.as_ref());
        let block = sources.flat_map(|source| &source.blocks).find(|block| {
            let number = block
                .number
                .is_some_and(|(number, _)| name.replace(' ', "").eq_ignore_ascii_case(&format!("SBR{number}")));
            let named = block.name.as_ref().is_some_and(|(own, _)| own.eq_ignore_ascii_case(name));
            block.kind == s7200::BlockKind::Subroutine && (number || named)
        });
        let Some(block) = block else {
            let formals = libraries::subroutine(name)?;
            let formals: Vec<(String, bool)> =
                formals.parameters().map(|(formal, output)| (formal.to_string(), output)).collect();
            return (formals.len() == count).then(|| Subroutine { name: name.to_string(), formals });
        };
        let formals = block.declarations.iter().filter(|row| row.section != s7200::Section::Temp);
        let mut formals: Vec<(String, bool)> =
            formals.map(|row| (row.name.clone(), row.section == s7200::Section::Output)).collect();
        // EN that a subroutine declares may be left out in calls.
        if formals.len() == count + 1 && formals[0].0.eq_ignore_ascii_case("EN") {
            formals.remove(0);
        }
        Some(Subroutine { name: block.name.as_ref().map_or(String::new(), |(name, _)| name.clone()), formals })
    }
}

/// Which end of a sequence step is in a network.
enum Frame<'n> {
    None,
    /// It has LSCR with this bit.
    Begins(&'n s7200::Operand),
    /// It has SCRE.
    Ends,
}

fn frame(network: &s7200::Network) -> Frame<'_> {
    let mut frames = network.statements.iter().filter_map(|statement| match &statement.kind {
        s7200::StatementKind::Instruction { insn: Insn::Lscr, operands, .. } => operands.first().map(Frame::Begins),
        s7200::StatementKind::Instruction { insn: Insn::Scre, .. } => Some(Frame::Ends),
        _ => None,
    });
    frames.next_back().unwrap_or(Frame::None)
}

/// The addresses of local variables, as Micro/WIN has them beside their names; empty for a type that the S7-200 does not have.
/// Up to eight BOOLs share a byte, other variables begin with the next whole byte.
fn addresses(rows: &[s7200::Declaration]) -> Vec<String> {
    let mut addresses = vec![String::new(); rows.len()];
    let (mut byte, mut bit) = (0, 0);
    for section in [s7200::Section::Input, s7200::Section::InOut, s7200::Section::Output, s7200::Section::Temp] {
        for (row, address) in rows.iter().zip(&mut addresses).filter(|(row, _)| row.section == section) {
            let (letter, bytes) = match row.ty.as_str() {
                "BOOL" => ("", 0),
                "BYTE" | "CHAR" => ("B", 1),
                "WORD" | "INT" => ("W", 2),
                "DWORD" | "DINT" | "REAL" | "STRING" => ("D", 4),
                _ => continue,
            };
            if bit == 8 || bit > 0 && bytes > 0 {
                (byte, bit) = (byte + 1, 0);
            }
            *address = match bytes {
                0 => format!("L{byte}.{bit}"),
                _ => format!("L{letter}{byte}"),
            };
            byte += bytes;
            bit += u32::from(bytes == 0);
        }
    }
    addresses
}
