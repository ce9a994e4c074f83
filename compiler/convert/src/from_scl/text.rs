//! Texts: assignments, results of functions, and the functions and comparisons that STL of an S7-1500 has as instructions.
//!
//! Source: S7-1500 information system, basic and extended instructions of STL; System and standard functions, IEC functions.

use plcc_abi::image::{BlockKind, Family};
use plcc_model::scl::{Access, Actual, Call, Complex, Statement};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, CodeBlock, Direction, Parameter};
use plcc_syntax::ast::{self, AddressRegister, BlockName, BlockPrefix, CallType, Operand, OperandKind, Width};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::code::number;

/// Characters of a STRING without a length.
pub const TEXT_MAX: u8 = 254;

/// The functions of texts that are instructions.
const FUNCTIONS: [&str; 10] =
    ["LEN", "MAX_LEN", "CONCAT", "LEFT", "RIGHT", "MID", "DELETE", "INSERT", "REPLACE", "FIND"];

/// The functions of the IEC library that compare two texts, and the relations of S_COMP.
const RELATIONS: [(u16, &str); 6] = [(10, "EQ"), (13, "GE"), (15, "GT"), (19, "LE"), (24, "LT"), (29, "NE")];

/// LEFT of the IEC library: with as many characters as a text can have, it copies.
const LEFT: u16 = 20;

/// An instruction that does the same as a function of the library.
#[derive(Clone, Copy)]
pub struct TextInstruction {
    name: &'static str,
    /// What a comparison looks for.
    relation: Option<&'static str>,
    /// The types of IN and OUT of a conversion.
    conversion: Option<(&'static str, &'static str)>,
}

impl TextInstruction {
    const fn plain(name: &'static str) -> TextInstruction {
        TextInstruction { name, relation: None, conversion: None }
    }

    /// Of a number and a text.
    pub const fn converting(name: &'static str, source: &'static str, result: &'static str) -> TextInstruction {
        TextInstruction { name, relation: None, conversion: Some((source, result)) }
    }

    /// The name that an instruction has for a parameter of its function.
    pub fn parameter(own: &str) -> &str {
        match own {
            "RET_VAL" => "OUT",
            "S1" => "IN1",
            "S2" => "IN2",
            _ => own,
        }
    }

    /// What the call names before its parameters.
    pub fn types(self) -> Vec<CallType> {
        let of_relation = self.relation.map(|relation| [("string_type", "String"), ("relation", relation)]);
        let of_conversion = self.conversion.map(|(source, result)| [("src_type", source), ("dest_type", result)]);
        let types = of_relation.or(of_conversion).into_iter().flatten();
        types.map(|(name, ty)| CallType { name: name.to_string(), ty: ty.to_string() }).collect()
    }
}

impl Maker<'_> {
    /// The instruction that a call of a block of the library becomes.
    pub fn text_instruction(&self, callee: &CodeBlock, call: &Call) -> Option<TextInstruction> {
        if !callee.library {
            return None;
        }
        let found = match callee.kind {
            BlockKind::Sfc => {
                let narrow = callee.name.strip_suffix("_WSTRING");
                let own = narrow.map_or(callee.name.as_str(), |name| name.strip_suffix("_LONG").unwrap_or(name));
                let same = FUNCTIONS.into_iter().find(|name| *name == own);
                match same.or_else(|| super::moment::instruction_of(own)) {
                    Some(name) => TextInstruction::plain(name),
                    None => super::number_text::conversion(callee, call)?,
                }
            }
            BlockKind::Fc => {
                let (_, relation) = RELATIONS.into_iter().find(|(number, _)| *number == callee.number)?;
                TextInstruction { relation: Some(relation), ..TextInstruction::plain("S_COMP") }
            }
            BlockKind::Ob | BlockKind::Fb | BlockKind::Sfb | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => {
                return None;
            }
        };
        self.has_instruction(found.name).then_some(found)
    }

    /// An instruction as the target of a call.
    pub fn called(&self, instruction: TextInstruction) -> Operand {
        self.named_block(instruction.name)
    }

    /// A constant text as an actual parameter; none: STL cannot pass it.
    pub fn text_actual(
        &mut self,
        call: &Call,
        callee: &CodeBlock,
        formal: &Parameter,
        bytes: &[u8],
    ) -> Option<Operand> {
        let DataType::String(maximum) = formal.ty else { return None };
        let is_instruction = self.text_instruction(callee, call).is_some();
        match callee.kind {
            // It gets a copy, which would end with the length of the constant.
            BlockKind::Fb | BlockKind::Sfb => Some(self.text_variable(maximum, characters(bytes)?)),
            // It gets the text itself.
            BlockKind::Fc if maximum == TEXT_MAX && !callee.library => self.constant_text(bytes, Some(TEXT_MAX)),
            BlockKind::Fc if maximum == TEXT_MAX && self.program.profile.family != Family::S71500 => {
                self.constant_text(bytes, None)
            }
            BlockKind::Fc | BlockKind::Sfc if maximum == TEXT_MAX && is_instruction => self.constant_text(bytes, None),
            BlockKind::Fc | BlockKind::Sfc | BlockKind::Ob | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => None,
        }
    }

    /// A constant text. Only STL of an S7-1500 has these as actual parameters; others get a variable of its length, or of `maximum`.
    fn constant_text(&mut self, bytes: &[u8], maximum: Option<u8>) -> Option<Operand> {
        let text = characters(bytes)?;
        if self.program.profile.family == Family::S71500 {
            return Some(Operand { kind: OperandKind::Literal(Literal::Text(text.to_vec())), span: self.span });
        }
        let maximum = maximum.unwrap_or(text.len().clamp(1, usize::from(TEXT_MAX)) as u8);
        Some(self.text_variable(maximum, text))
    }

    /// An empty text for the current statement. What was in temporary data before is not a text.
    pub fn empty_text(&mut self) -> Operand {
        self.text_variable(TEXT_MAX, &[])
    }

    /// A variable with these characters, which has room for `maximum`.
    fn text_variable(&mut self, maximum: u8, characters: &[u8]) -> Operand {
        let text = self.variable(&DataType::String(maximum), "text");
        let OperandKind::Path(path) = &text.kind else { return text };
        let length = characters.len().min(usize::from(maximum));
        let here = self.span;
        let operand = |kind| Some(Operand { kind, span: here });
        self.push(StlInsn::Load, operand(OperandKind::AddressOf(path.clone())));
        self.push(StlInsn::LoadAr1, None);
        let there = |width: Width, byte: u32| {
            let register = AddressRegister::Ar1;
            operand(OperandKind::RegisterIndirect { area: None, width, register, offset: byte * 8 })
        };
        let head = OperandKind::Literal(Literal::Word(u16::from(maximum) << 8 | length as u16));
        self.push(StlInsn::Load, operand(head));
        self.push(StlInsn::Transfer, there(Width::Word, 0));
        let (mut rest, mut byte) = (&characters[..length], 2);
        while !rest.is_empty() {
            let (size, width) = match rest.len() {
                4.. => (4, Width::Dword),
                2 | 3 => (2, Width::Word),
                _ => (1, Width::Byte),
            };
            let (part, more) = rest.split_at(size);
            self.push(StlInsn::Load, operand(OperandKind::Literal(Literal::Text(part.to_vec()))));
            self.push(StlInsn::Transfer, there(width, byte));
            (rest, byte) = (more, byte + size as u32);
        }
        text
    }

    /// The arguments of a call change no variable, and neither do the calls in them.
    pub fn changes_nothing(&self, call: &Call) -> bool {
        call.arguments.iter().all(|argument| match &argument.actual {
            Actual::Value(value) => super::value::is_plain(value),
            Actual::Complex(Complex::Call(inner)) => {
                let block = self.program.block(inner.target);
                let is_instruction = block.is_some_and(|callee| self.text_instruction(callee, inner).is_some());
                is_instruction && inner.enable.is_none() && inner.eno.is_none() && self.changes_nothing(inner)
            }
            _ => true,
        })
    }

    /// S_MOVE, which only an S7-1500 has in STL, or LEFT.
    pub fn assign_text(&mut self, target: &Access, value: &Complex, statement: &Statement) {
        const HELP: &str = "call a function of the library that copies it";
        if !self.is_direct(target) {
            return self.refuse(statement.span, "an assignment of texts", HELP);
        }
        let is_narrow = matches!(target.ty, DataType::String(_));
        let from = match value {
            Complex::Variable(source) if same_kind(&source.ty, &target.ty) && self.is_direct(source) => {
                self.operand(source)
            }
            Complex::Const(bytes) if is_narrow => self.constant_text(bytes, None),
            Complex::Call(call) if is_narrow => self.call(call),
            _ => None,
        };
        let Some(from) = from.filter(|_| !self.refused) else {
            return self.refuse(statement.span, "an assignment of texts", HELP);
        };
        let Some(to) = self.operand(target) else { return };
        let (target, parameters) = match self.program.profile.family {
            Family::S71500 if !self.has_instruction("S_MOVE") => {
                let help = "that is the instruction which copies texts: rename the block or symbol";
                return self.refuse(statement.span, "an assignment of texts beside another `S_MOVE`", help);
            }
            Family::S71500 => (self.called(TextInstruction::plain("S_MOVE")), vec![("IN", from), ("OUT", to)]),
            Family::S7300 | Family::S7400 | Family::S7200 | Family::S71200 => {
                let key = BlockKey { kind: BlockKind::Fc, number: LEFT };
                if !is_narrow || self.program.block(key).is_some_and(|block| !block.library) {
                    return self.refuse(statement.span, "an assignment of texts", HELP);
                }
                let left = BlockName::Numbered { prefix: BlockPrefix::Fc, number: u32::from(LEFT), span: self.span };
                let all = number(i64::from(TEXT_MAX), self.span);
                (
                    Operand { kind: OperandKind::Block(left), span: self.span },
                    vec![("IN", from), ("L", all), ("RET_VAL", to)],
                )
            }
        };
        let parameters = parameters.into_iter().map(|(name, actual)| ast::Parameter {
            name: name.to_string(),
            name_span: self.span,
            actual: Some(actual),
        });
        let call = ast::Call { target, types: Vec::new(), instance: None, parameters: parameters.collect() };
        self.push_kind(ast::StatementKind::Call(Box::new(call)));
    }
}

/// Those of a constant, after its head.
fn characters(bytes: &[u8]) -> Option<&[u8]> {
    let [_, length, characters @ ..] = bytes else { return None };
    characters.get(..usize::from(*length))
}

/// Whether STL passes a variable of a type: what a function block gets or returns as a copy has just the length of its parameter.
pub fn is_passed(callee: &CodeBlock, formal: &Parameter, actual: &DataType) -> bool {
    let is_copied = matches!(callee.kind, BlockKind::Fb | BlockKind::Sfb) && formal.direction != Direction::InOut;
    !is_copied || !same_kind(&formal.ty, actual) || formal.ty == *actual
}

/// Two texts with characters of one size.
fn same_kind(one: &DataType, other: &DataType) -> bool {
    matches!(
        (one, other),
        (DataType::String(_), DataType::String(_)) | (DataType::WideString(_), DataType::WideString(_))
    )
}
