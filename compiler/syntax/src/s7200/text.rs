//! The tree as text: one node per line, with its depth. Instructions go by their rows, addresses by international letters.

use super::address;
use super::ast::*;
use super::{Insn, ast};
use crate::ast::Width;
use crate::stl::Mnemonics;

/// Lines of a source's tree, each with its depth.
pub fn lines(source: &Source) -> Vec<(usize, String)> {
    let mut out = Vec::new();
    for block in &source.blocks {
        self::block(block, &mut out);
    }
    if !source.data.is_empty() {
        out.push((0, "data".to_owned()));
    }
    for line in &source.data {
        let address = line.address.as_ref().map_or_else(|| "next".to_owned(), operand);
        out.push((1, format!("{address} := {}", operands(&line.values))));
    }
    out
}

fn block(block: &Block, out: &mut Vec<(usize, String)>) {
    let kind = match block.kind {
        BlockKind::Main => "main",
        BlockKind::Subroutine => "subroutine",
        BlockKind::Interrupt => "interrupt",
    };
    let mut head = kind.to_owned();
    if let Some((name, _)) = &block.name {
        head += &format!(" {name:?}");
    }
    if let Some((number, _)) = block.number {
        head += &format!(" {number}");
    }
    if block.is_bare {
        head += " bare";
    }
    out.push((0, head));
    if !block.title.is_empty() {
        out.push((1, format!("title {:?}", block.title)));
    }
    out.extend(block.comment.iter().map(|line| (1, format!("comment {line:?}"))));
    for declaration in &block.declarations {
        let section = match declaration.section {
            Section::Input => "input",
            Section::InOut => "in_out",
            Section::Output => "output",
            Section::Temp => "temp",
        };
        let initial = declaration.initial.as_ref().map_or(String::new(), |value| format!(" := {}", operand(value)));
        let comment = declaration.comment.as_ref().map_or(String::new(), |text| format!(" // {text}"));
        out.push((1, format!("{section} {} : {}{initial}{comment}", declaration.name, declaration.ty)));
    }
    for network in &block.networks {
        let number = network.number.map_or(String::new(), |number| format!(" {number}"));
        let title = if network.title.is_empty() { String::new() } else { format!(" {:?}", network.title) };
        out.push((1, format!("network{number}{title}")));
        out.extend(network.comment.iter().map(|line| (2, format!("comment {line:?}"))));
        out.extend(network.statements.iter().map(|it| (2, statement(it))));
    }
}

fn statement(statement: &Statement) -> String {
    let text = match &statement.kind {
        StatementKind::Instruction { insn, operands, .. } => {
            let name = match insn {
                Insn::Compare(compare) => compare.mnemonic(Mnemonics::En),
                _ => insn.row().to_owned(),
            };
            match self::operands(operands) {
                list if list.is_empty() => name,
                list => format!("{name} {list}"),
            }
        }
        StatementKind::Pragma { pragma, assert } => match assert {
            Some(assert) => format!("assert {}", crate::ast_text::assertion_text(assert, &side)),
            None => format!("pragma {:?}", pragma.text),
        },
        StatementKind::Error => "error".to_owned(),
    };
    match &statement.comment {
        Some(comment) => format!("{text} // {}", comment.replace('\n', " | ")),
        None => text,
    }
}

fn side(side: &ast::AssertSide) -> String {
    match side {
        ast::AssertSide::Operand(operand) => self::operand(operand),
        ast::AssertSide::Stack(level) => format!("stack {level}"),
        ast::AssertSide::Eno => "eno".to_owned(),
    }
}

fn operands(operands: &[Operand]) -> String {
    operands.iter().map(operand).collect::<Vec<_>>().join(", ")
}

fn operand(operand: &Operand) -> String {
    match &operand.shown {
        Some(Shown { name, form }) => format!("{} at {}", symbol(name, *form), kind(&operand.kind)),
        None => kind(&operand.kind),
    }
}

fn symbol(name: &str, form: SymbolForm) -> String {
    match form {
        SymbolForm::Local => format!("#{name}"),
        SymbolForm::Quoted => format!("{name:?}"),
        SymbolForm::Bare => format!("symbol {name}"),
    }
}

fn kind(kind: &OperandKind) -> String {
    match kind {
        OperandKind::Direct(direct) => address::text(direct),
        OperandKind::Indirect(pointer) => format!("*{}", self::operand(pointer)),
        OperandKind::AddressOf(target) => format!("&{}", self::operand(target)),
        OperandKind::Constant(constant) => self::constant(constant),
        OperandKind::Symbol { name, form } => symbol(name, *form),
        OperandKind::Block { kind, number } => match kind {
            BlockKind::Main => format!("block OB{number}"),
            BlockKind::Subroutine => format!("block SBR{number}"),
            BlockKind::Interrupt => format!("block INT{number}"),
        },
        OperandKind::Error => "error".to_owned(),
    }
}

fn constant(constant: &Constant) -> String {
    match constant {
        Constant::Integer(value) => format!("int {value}"),
        Constant::Bits { value, width } => {
            let width = match width {
                Some(Width::Byte) => "byte ",
                Some(Width::Word) => "word ",
                Some(Width::Dword) => "dword ",
                Some(Width::Bit | Width::Lword) | None => "",
            };
            format!("{width}16#{value:X}")
        }
        Constant::Real(value) => format!("real {value:?}"),
        Constant::Bool(value) => format!("bool {value}"),
        Constant::Characters(bytes) => format!("chars '{}'", bytes.escape_ascii()),
        Constant::Text(bytes) => format!("text \"{}\"", bytes.escape_ascii()),
    }
}
