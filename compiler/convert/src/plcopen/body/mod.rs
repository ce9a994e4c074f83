//! Statements and expressions as those of ST: the names of the file, the functions of the standard.
//!
//! `calls`: what a call calls; `statements`: also assertions.

mod calls;
mod statements;

use std::collections::{BTreeSet, HashMap, HashSet};

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Area, CodeBlock, CodeKind, DataBlock, DataContent, OperandKind, Section, SectionKind, TypeKind, TypeRef,
};
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, Name, NameForm};
use plcc_syntax::symbols::{Symbol, SymbolTarget};

use super::chart::{self, Names};
use super::identifier::identifier;
use super::program::{GLOBALS, Global, Learned, Program, local};
use super::system;
use crate::scl::expression;
use crate::to_stl::types::elementary;
use crate::to_stl::values::of_width;
use crate::writer::Writer;
pub use calls::Called;

/// The code of a POU that is being written.
pub struct Body<'p, 'a, 'w, 't> {
    pub program: &'p Program<'a>,
    pub block: &'a CodeBlock,
    /// The key of the block.
    pub key: String,
    pub writer: &'w mut Writer<'t>,
    pub learned: &'w mut Learned,
    /// Keys of the global variables that the code uses.
    pub used: BTreeSet<String>,
    /// Edge bits that the file does not need, by their names in lower case: none, or the block that takes the name.
    pub retyped: HashMap<String, Option<&'static str>>,
    /// Names of local variables in the file, in lower case.
    locals: HashSet<String>,
    /// Steps and transitions of a chart.
    pub names: Names,
}

const MEMORY: &str = "name it in a symbol table, and write the name";

impl<'p, 'a, 'w, 't> Body<'p, 'a, 'w, 't> {
    pub fn new(
        program: &'p Program<'a>,
        block: &'a CodeBlock,
        writer: &'w mut Writer<'t>,
        learned: &'w mut Learned,
    ) -> Body<'p, 'a, 'w, 't> {
        let constants = block.constants.iter().map(|constant| &constant.name);
        let variables = block.sections.iter().flat_map(|section| &section.variables).map(|one| &one.name);
        let steps = chart::of_block(block).into_iter().flat_map(|chart| &chart.steps).map(|step| &step.name.text);
        let locals = variables.chain(constants).chain(steps).map(|name| identifier(name).to_lowercase()).collect();
        let (key, names) = (program.key(&block.name), Names::new(block));
        Body { program, block, key, writer, learned, used: BTreeSet::new(), retyped: HashMap::new(), locals, names }
    }

    pub fn refuse(&mut self, span: Span, title: impl Into<String>, help: &str) {
        self.writer.refuse(span, title, help);
    }

    /// An expression as text.
    pub fn text(&mut self, value: &Expr) -> String {
        let value = self.expr(value);
        expression::text(&value, self.writer)
    }

    /// The elementary type of an expression, as far as the sources say it.
    pub fn elementary(&self, value: &Expr) -> Option<Elementary> {
        match &value.kind {
            ExprKind::Literal(Literal::Typed { ty, .. }) => Some(*ty),
            ExprKind::Unary { operand, .. } => self.elementary(operand),
            ExprKind::Absolute(OperandKind::Absolute { width, .. }) => Some(of_width(*width)),
            ExprKind::Slice { width, .. } => Some(of_width(*width)),
            ExprKind::Binary { op, left, right, .. } => match op {
                BinaryOp::Less
                | BinaryOp::Greater
                | BinaryOp::LessEqual
                | BinaryOp::GreaterEqual
                | BinaryOp::Equal
                | BinaryOp::NotEqual => Some(Elementary::Bool),
                _ => {
                    let (left, right) = (self.elementary(left), self.elementary(right));
                    if left == right { left } else { None }
                }
            },
            ExprKind::Name(name) => match self.program.type_of(value, self.block) {
                Some(ty) => elementary_of(ty),
                None => match self.program.global(&self.program.key_of(&name.text)) {
                    Some(Global::Tag(symbol)) => tag_type(symbol),
                    Some(Global::Constant(constant)) => elementary(&constant.ty),
                    Some(_) => None,
                    // `MW2` of a chart or classic source.
                    None => match plcc_syntax::scl::absolute(&name.text).filter(|_| name.form == NameForm::Bare)? {
                        OperandKind::Absolute { width, .. } => Some(of_width(width)),
                        _ => None,
                    },
                },
            },
            ExprKind::Call { callee, .. } => match &callee.kind {
                ExprKind::Name(name) if self.program.callee_key(callee).is_none() => {
                    Elementary::from_word(name.text.to_ascii_uppercase().rsplit_once("_TO_")?.1)
                }
                _ => self.program.type_of(value, self.block).and_then(elementary_of),
            },
            ExprKind::Member { base, name } => {
                if let ExprKind::Name(owner) = &base.kind
                    && let Some(ty) = self.names.flag_type(&owner.text, &name.text)
                    && local(self.block, &owner.text).is_none()
                {
                    return Some(ty);
                }
                let declared = self.program.type_of(value, self.block);
                declared.and_then(elementary_of).or_else(|| {
                    let of = self.program.type_of(base, self.block)?;
                    let TypeKind::Named(word) = &of.kind else { return None };
                    member_of_system(word, &name.text)
                })
            }
            _ => self.program.type_of(value, self.block).and_then(elementary_of),
        }
    }

    // Names.

    fn is_local(&self, text: &str) -> bool {
        let folded = text.to_lowercase();
        local(self.block, text).is_some() || self.block.constants.iter().any(|one| one.name.to_lowercase() == folded)
    }

    /// Whether an edge bit belongs to its function block, and nothing else uses it.
    pub fn is_private(&self, bit: &Expr) -> bool {
        let ExprKind::Name(name) = &bit.kind else { return false };
        let is_own = |section: &Section| {
            section.kind == SectionKind::Static
                && section
                    .variables
                    .iter()
                    .any(|one| one.initial.is_none() && one.name.eq_ignore_ascii_case(&name.text))
        };
        self.block.kind == CodeKind::Fb
            && name.form != NameForm::Quoted
            && self.block.sections.iter().any(is_own)
            // Its declaration and this use.
            && self.program.uses(&name.text) <= 2
    }

    /// What the CPU hands to an OB.
    fn is_start_information(&self, text: &str) -> bool {
        let is_own = |section: &Section| {
            section.variables.iter().any(|variable| variable.name.eq_ignore_ascii_case(text))
                && (section.kind == SectionKind::Input || is_start_name(text))
        };
        self.block.kind == CodeKind::Ob && self.block.sections.iter().any(is_own)
    }

    /// The result of a function has the name of the function.
    fn is_result(&self, text: &str) -> bool {
        let own = self.program.key_of(text) == self.key;
        self.block.return_type.is_some() && (own || text.eq_ignore_ascii_case("RET_VAL"))
    }

    /// The name of a global in the file; it must not be one of a local variable.
    pub fn global_name(&mut self, key: &str) -> String {
        let name = self.program.name(key);
        if self.locals.contains(&name.to_lowercase()) {
            self.learned.hidden.insert(key.to_string());
        }
        name
    }

    fn name(&mut self, name: &Name) -> Expr {
        let bare = |text: String| Expr {
            kind: ExprKind::Name(Name { text, form: NameForm::Bare, span: name.span }),
            span: name.span,
        };
        if name.form != NameForm::Quoted && self.is_local(&name.text) {
            if self.is_start_information(&name.text) {
                let title = format!("a program of PLCopen XML has no start information, such as `{}`", name.text);
                self.refuse(name.span, title, "use a variable of your own");
            }
            self.check_operating(name);
            return bare(identifier(&name.text));
        }
        if self.is_result(&name.text) {
            return bare(self.program.name(&self.key));
        }
        if name.form == NameForm::Bare && name.text.eq_ignore_ascii_case("ENO") {
            self.refuse(name.span, "ST has no ENO that statements read or write", "use a variable of your own");
            return bare(String::new());
        }
        let key = self.program.key_of(&name.text);
        match self.program.global(&key) {
            Some(Global::Tag(symbol)) => {
                if let Err(reason) = super::globals::tag_form(symbol) {
                    self.refuse(name.span, reason, "use a variable of another type");
                }
                self.variable(&key, bare)
            }
            Some(Global::Data(data)) => {
                if self.program.tasks.contains_key(&key) {
                    let program = self.program.tasks[&key].clone();
                    return bare(self.global_name(&program));
                }
                if matches!(data.content, DataContent::Empty) {
                    self.refuse(name.span, "a data block without components", "declare its components");
                }
                self.variable(&key, bare)
            }
            Some(Global::Variable(_) | Global::Constant(_)) => self.variable(&key, bare),
            Some(Global::Code(_) | Global::Type(_)) => {
                let title = format!("`{}` is a block or a data type, not a value", name.text);
                self.refuse(name.span, title, "use a variable");
                bare(String::new())
            }
            None => match plcc_syntax::scl::absolute(&name.text).filter(|_| name.form == NameForm::Bare) {
                Some(operand) => self.absolute(&operand, name.span),
                None if name.text.ends_with(":P") => {
                    let title = "PLCopen XML has no addresses of the periphery";
                    self.refuse(name.span, title, "read and write the process image");
                    bare(String::new())
                }
                None => {
                    let title = format!("no source declares `{}`", name.text);
                    self.refuse(name.span, title, "add the source or the table that declares it");
                    bare(String::new())
                }
            },
        }
    }

    fn variable(&mut self, key: &str, bare: impl Fn(String) -> Expr) -> Expr {
        self.used.insert(key.to_string());
        let name = self.global_name(key);
        bare(name)
    }

    fn absolute(&mut self, operand: &OperandKind, span: Span) -> Expr {
        match operand {
            OperandKind::Absolute { area: area @ (Area::I | Area::Q | Area::M), width, byte, bit } => {
                if *area == Area::M {
                    self.learned.memory.insert(super::globals::memory(*width, *byte));
                }
                if system::address(' ', *width, *byte, *bit).is_none() {
                    let bytes = width.bytes();
                    let title = format!(
                        "PLCopen XML has no address for the {bytes} bytes from {}B {byte}: its addresses count units of {bytes} bytes",
                        area.letters()
                    );
                    self.refuse(span, title, MEMORY);
                }
            }
            OperandKind::Block(name) => {
                let key = self.program.key(name);
                let bare =
                    |text: String| Expr { kind: ExprKind::Name(Name { text, form: NameForm::Bare, span }), span };
                match self.program.global(&key) {
                    Some(Global::Data(_)) => return self.variable(&key, bare),
                    _ => self.refuse(span, "a block that no source declares", "add its source"),
                }
            }
            OperandKind::Absolute { .. } => {
                self.refuse(span, "PLCopen XML has no addresses of the periphery", "read and write the process image");
            }
            OperandKind::Cell { .. } => {
                self.refuse(
                    span,
                    "PLCopen XML has no timers and counters of the CPU",
                    "use TON, CTU and similar blocks",
                );
            }
            _ => self.refuse(span, "PLCopen XML has no form for this operand", MEMORY),
        }
        Expr { kind: ExprKind::Absolute(operand.clone()), span }
    }

    // Expressions.

    pub fn expr(&mut self, value: &Expr) -> Expr {
        let span = value.span;
        let kind = match &value.kind {
            ExprKind::Name(name) => return self.name(name),
            ExprKind::Absolute(operand) => return self.absolute(operand, span),
            ExprKind::Literal(literal) => {
                self.literal(literal, span);
                ExprKind::Literal(match literal {
                    Literal::Text { bytes, .. } => Literal::Text { bytes: bytes.clone(), typed: false },
                    literal => literal.clone(),
                })
            }
            ExprKind::Member { base, name } => {
                if let Some(flag) = self.step_flag(base, name) {
                    return flag;
                }
                if let ExprKind::Name(of) = &base.kind
                    && of.form != NameForm::Local
                    && of.text.eq_ignore_ascii_case(GLOBALS)
                    && matches!(self.program.global(&name.text.to_lowercase()), Some(Global::Variable(_)))
                {
                    return self.name(&Name { form: NameForm::Quoted, ..name.clone() });
                }
                // `"Values".THIS[1]`: a data block that is an array.
                if name.text.eq_ignore_ascii_case("THIS")
                    && let Some(key) = self.program.callee_key(base)
                    && let Some(Global::Data(DataBlock { content: DataContent::Array(..), .. })) =
                        self.program.global(&key)
                {
                    return self.expr(base);
                }
                self.check_member(base, name);
                self.check_chart(base, name);
                let base = Box::new(self.expr(base));
                let name = Name { text: identifier(&name.text), form: NameForm::Bare, span: name.span };
                ExprKind::Member { base, name }
            }
            ExprKind::MemberAbsolute { .. } => {
                self.refuse(span, "PLCopen XML has no addresses in data blocks", "name the component");
                nothing(span)
            }
            ExprKind::Slice { base, width, index } => {
                ExprKind::Slice { base: Box::new(self.expr(base)), width: *width, index: *index }
            }
            ExprKind::Index { base, indices } => {
                let base = Box::new(self.expr(base));
                ExprKind::Index { base, indices: indices.iter().map(|index| self.expr(index)).collect() }
            }
            ExprKind::Call { callee, arguments } => return self.call(callee, arguments, span),
            ExprKind::Dereference(_) | ExprKind::Reference(_) => {
                self.refuse(span, "PLCopen XML has no references", "use an in-out parameter");
                nothing(span)
            }
            ExprKind::Unary { op, operand } => ExprKind::Unary { op: *op, operand: Box::new(self.expr(operand)) },
            ExprKind::Binary { op, left, right, op_span } => {
                let (left, right) = (Box::new(self.expr(left)), Box::new(self.expr(right)));
                let op = if *op == BinaryOp::DivideInteger { BinaryOp::Divide } else { *op };
                ExprKind::Binary { op, left, right, op_span: *op_span }
            }
            ExprKind::Error => ExprKind::Error,
        };
        Expr { kind, span }
    }

    /// Reports `DB10.DW4` and components that the sources do not declare.
    fn check_member(&mut self, base: &Expr, name: &Name) {
        let Some(key) = self.program.callee_key(base) else { return };
        if let Some(Global::Data(DataBlock { content: DataContent::Struct(members), .. })) = self.program.global(&key)
            && !members.iter().any(|member| member.name.to_lowercase() == name.text.to_lowercase())
        {
            let title = format!("`{}` is not a component of the data block", name.text);
            self.refuse(name.span, title, "name the component: PLCopen XML has no addresses in data blocks");
        }
    }

    fn literal(&mut self, literal: &Literal, span: Span) {
        let what = match literal {
            Literal::Integer { .. } | Literal::Real(_) => return,
            Literal::Typed { ty, .. } if system::type_element(*ty).is_some() => return,
            Literal::Text { bytes, .. } if bytes.iter().all(|byte| (0x20..0x7F).contains(byte)) => return,
            Literal::Text { .. } => "texts of PLCopen XML with letters that are not ASCII or not printable".to_string(),
            Literal::Typed { ty, .. } => format!("constants of type {} in PLCopen XML", ty.name()),
            Literal::WideText(_) => "constants of type WSTRING in PLCopen XML".to_string(),
            Literal::DateAndTime(_) => "constants of type DATE_AND_TIME in PLCopen XML".to_string(),
            Literal::Dtl(_) => "constants of type DTL in PLCopen XML".to_string(),
            Literal::Pointer { .. } | Literal::Any(_) | Literal::Nil | Literal::Null => {
                "pointers in PLCopen XML".into()
            }
        };
        self.refuse(span, format!("plcc writes no {what}"), "use a value of another type");
    }
}

/// Stands for something that was refused; nothing more is reported about it.
fn nothing(span: Span) -> ExprKind {
    ExprKind::Name(Name { text: String::new(), form: NameForm::Bare, span })
}

/// `OB1_PREV_CYCLE`, the usual name of start information on an S7-300/400.
pub fn is_start_name(name: &str) -> bool {
    let upper = name.to_ascii_uppercase();
    upper
        .strip_prefix("OB")
        .and_then(|rest| rest.split_once('_'))
        .is_some_and(|(number, _)| number.parse::<u32>().is_ok())
}

pub fn elementary_of(ty: &TypeRef) -> Option<Elementary> {
    match &ty.kind {
        TypeKind::Named(name) => elementary(name),
        _ => None,
    }
}

/// The type of a tag: its own, otherwise that of its width.
pub fn tag_type(symbol: &Symbol) -> Option<Elementary> {
    match (symbol.ty.trim(), symbol.target) {
        ("", SymbolTarget::Memory { width, .. }) => Some(of_width(width)),
        (ty, _) => elementary(ty),
    }
}

/// The type of a parameter of a standard block.
fn member_of_system(word: &str, name: &str) -> Option<Elementary> {
    let is_timer = matches!(system::block(word), Some("TON" | "TOF" | "TP")) || word.eq_ignore_ascii_case("IEC_TIMER");
    match name.to_ascii_uppercase().as_str() {
        "Q" | "QU" | "QD" | "IN" | "CU" | "CD" | "CLK" => Some(Elementary::Bool),
        "ET" | "PT" if is_timer => Some(Elementary::Time),
        "CV" | "PV" => {
            let word = word.to_ascii_uppercase();
            Some(match () {
                () if word.ends_with("_UDINT") || word == "IEC_UDCOUNTER" => Elementary::Udint,
                () if word.ends_with("_DINT") || word == "IEC_DCOUNTER" => Elementary::Dint,
                () => Elementary::Int,
            })
        }
        _ => None,
    }
}
