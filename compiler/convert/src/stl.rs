//! Sources in STL, from trees of blocks whose statements are STL.

use plcc_diag::Diagnostic;
use plcc_syntax::ast::{Block, Call, Code, CodeBlock, Network, SourceUnit, Statement, StatementKind};
use plcc_syntax::stl::Mnemonics;

use crate::frames::{bare, is_implied};
use crate::operand;
use crate::trivia::Trivia;
use crate::writer::{Notation, Writer};

/// Where the mnemonic begins, after a label.
const LABEL_WIDTH: usize = 6;
/// Where the operand begins, after the mnemonic.
const MNEMONIC_WIDTH: usize = 6;

/// Writes a source in STL. `source`: the text that spans mean, if it is STL, too.
pub fn write(unit: &SourceUnit, set: Mnemonics, trivia: Trivia, source: Option<&str>) -> (String, Vec<Diagnostic>) {
    let mut writer = Writer::new(Notation::Stl, set, trivia, source);
    for block in &unit.blocks {
        if !is_implied(block) {
            writer.out.gap();
        }
        match block {
            Block::Code(code) => match &code.code {
                Code::Stl(networks) if is_implied(block) => writer.networks(networks, code.span.end),
                Code::Stl(networks) => writer.stl_block(code, networks),
                Code::Scl(_) | Code::Graphic(_) | Code::Chart(_) => {
                    let name = writer.block_name(&code.name);
                    writer.refuse(code.name.span(), format!("{name} is not in STL"), "convert its statements first");
                }
            },
            Block::Data(data) => writer.data_block(data),
            Block::Type(ty) => writer.type_block(ty),
        }
    }
    writer.remarks_before(u32::MAX);
    (writer.out.into_text(), writer.messages)
}

impl Writer<'_> {
    pub(crate) fn stl_block(&mut self, block: &CodeBlock, networks: &[Network]) {
        self.code_frame(block, |writer| writer.networks(networks, block.span.end));
    }

    fn networks(&mut self, networks: &[Network], end: u32) {
        for (at, network) in networks.iter().enumerate() {
            let start = network.statements.first().map(|statement| statement.span.start);
            let next = networks[at + 1..].iter().flat_map(|network| &network.statements).next();
            let remarks = match start {
                Some(start) => self.trivia.before(start),
                None => self.trivia.before(next.map_or(end, |next| next.span.start)),
            };
            // The comment of the network is the last part of what is before its first statement.
            let mut own = remarks.len();
            let mut comment = network.comment.iter().rev().peekable();
            while own > 0 && comment.peek().is_some() {
                own -= 1;
                if comment.peek().is_some_and(|line| **line == bare(&remarks[own].text)) {
                    comment.next();
                }
            }
            let found = comment.peek().is_none();
            let (before, own) = remarks.split_at(if found { own } else { remarks.len() });
            self.out.remarks(before);
            self.out.line("NETWORK");
            if let Some(title) = &network.title {
                self.out.line(format!("TITLE = {title}"));
            }
            if !found {
                network.comment.iter().for_each(|line| self.out.line(format!("// {line}")));
            }
            self.out.remarks(own);
            for statement in &network.statements {
                self.statement(statement);
            }
        }
    }

    /// A statement with the comments before and after it.
    pub(crate) fn statement(&mut self, statement: &Statement) {
        self.remarks_before(statement.span.start);
        let label = statement.label.as_ref().map_or(String::new(), |label| format!("{}:", label.name));
        match &statement.kind {
            // Nothing but `;`.
            StatementKind::Empty => self.instruction(&label, ";"),
            StatementKind::Instruction { insn, operand: given, .. } => {
                let mnemonic = insn.mnemonic(self.mnemonics);
                let operand = given.as_ref().map_or(String::new(), |given| operand::operand(given, self));
                self.instruction(&label, &with_operand(mnemonic, &operand));
            }
            StatementKind::Call(call) => self.call(&label, call),
            StatementKind::Pragma(pragma) => self.out.line(format!("//@ {}", pragma.text)),
            StatementKind::Error => {
                self.refuse(statement.span, "a statement that was not understood", "repair the source first");
            }
        }
        self.remarks_on_line(statement.span.end);
    }

    /// A line with `label`, or blanks in its place.
    pub(crate) fn instruction(&mut self, label: &str, text: &str) {
        let end = if text == ";" || text.ends_with(';') { "" } else { ";" };
        if label.len() >= LABEL_WIDTH {
            self.out.line(format!("{label} {text}{end}"));
        } else {
            self.out.line(format!("{label:LABEL_WIDTH$}{text}{end}"));
        }
    }

    fn call(&mut self, label: &str, call: &Call) {
        let target = operand::operand(&call.target, self);
        let instance = call.instance.as_ref().map_or(String::new(), |instance| {
            // An instance is a data block: `DB 5`, `"Motor_DB"`.
            format!(", {}", operand::operand(instance, self))
        });
        let types: Vec<String> = call.types.iter().map(|one| format!("{} := {}", one.name, one.ty)).collect();
        let types = if types.is_empty() { String::new() } else { format!(" {{{}}}", types.join("; ")) };
        let head = with_operand("CALL", &format!("{target}{instance}{types}"));
        if call.parameters.is_empty() {
            return self.instruction(label, &head);
        }
        let parameters: Vec<String> = call
            .parameters
            .iter()
            .map(|parameter| {
                let actual = parameter.actual.as_ref().map_or(String::new(), |actual| operand::operand(actual, self));
                format!("{} := {actual}", crate::names::declared(&parameter.name)).trim_end().to_string()
            })
            .collect();
        self.instruction(label, &format!("{head} ("));
        self.out.behind_nothing();
        let last = parameters.len() - 1;
        for (at, parameter) in parameters.iter().enumerate() {
            let end = if at == last { ");" } else { "," };
            self.remarks_between(&call.parameters[at]);
            self.out.line(format!("{:LABEL_WIDTH$}  {parameter}{end}", ""));
        }
    }

    fn remarks_between(&mut self, parameter: &plcc_syntax::ast::Parameter) {
        self.remarks_before(parameter.name_span.start);
    }
}

pub(crate) fn with_operand(mnemonic: &str, operand: &str) -> String {
    if operand.is_empty() { mnemonic.to_string() } else { format!("{mnemonic:MNEMONIC_WIDTH$}{operand}") }
}
