//! Statements and expressions as those of ST: the names of the file, the functions of the standard.

use std::collections::{BTreeSet, HashMap, HashSet};

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Area, CodeBlock, CodeKind, DataBlock, DataContent, OperandKind, Pragma, Section, SectionKind, TypeKind, TypeRef,
    Width,
};
use plcc_syntax::scl::ast::{
    Argument, Arm, AssignOp, BinaryOp, CaseValue, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind,
};
use plcc_syntax::symbols::{Symbol, SymbolTarget};

use super::identifier::identifier;
use super::program::{GLOBALS, Global, Learned, Program, local};
use super::system::{self, Function};
use crate::scl::expression;
use crate::to_stl::types::elementary;
use crate::writer::Writer;

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
}

/// What a call calls.
pub enum Called<'a> {
    Function(&'a CodeBlock, String),
    /// The instance, and the type of it in the file.
    Instance {
        instance: Expr,
        ty: String,
        block: Option<&'a CodeBlock>,
    },
    /// A function of the system.
    System(Name),
    Refused,
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
        let locals = variables.chain(constants).map(|name| identifier(name).to_lowercase()).collect();
        let key = program.key(&block.name);
        Body { program, block, key, writer, learned, used: BTreeSet::new(), retyped: HashMap::new(), locals }
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
            ExprKind::Absolute(OperandKind::Absolute { width, .. }) => of_width(*width),
            ExprKind::Slice { width, .. } => of_width(*width),
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
                None => match self.program.global(&self.program.key_of(&name.text))? {
                    Global::Tag(symbol) => tag_type(symbol),
                    Global::Constant(constant) => elementary(&constant.ty),
                    _ => None,
                },
            },
            ExprKind::Call { callee, .. } => match &callee.kind {
                ExprKind::Name(name) if self.program.callee_key(callee).is_none() => {
                    Elementary::from_word(name.text.to_ascii_uppercase().rsplit_once("_TO_")?.1)
                }
                _ => self.program.type_of(value, self.block).and_then(elementary_of),
            },
            ExprKind::Member { base, name } => {
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
                let title = format!("`{}` is a block or a data type, and no value", name.text);
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
                    self.refuse(name.span, title, "give the source or the table that declares it, too");
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
                    _ => self.refuse(span, "a block that no source declares", "give its source, too"),
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
                let base = Box::new(self.expr(base));
                let name = Name { text: identifier(&name.text), form: NameForm::Bare, span: name.span };
                ExprKind::Member { base, name }
            }
            ExprKind::MemberAbsolute { .. } => {
                self.refuse(span, "PLCopen XML has no addresses in data blocks", "name the component");
                ExprKind::Error
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
                ExprKind::Error
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
            let title = format!("`{}` is no component of the data block", name.text);
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

    // Calls.

    /// What an expression calls.
    pub fn called(&mut self, callee: &Expr) -> Called<'a> {
        // `t.TON(…)`: data of a timer or counter.
        if let ExprKind::Member { base, name } = &callee.kind
            && let Some(call) = system::call_on_data(&name.text)
            && let Some(ty) = self.program.type_of(base, self.block)
            && let TypeKind::Named(word) = &ty.kind
        {
            let known = match system::of_data_type(word, call) {
                Some(known) => match self.learned.instances.get(&ty.span) {
                    Some(other) if *other != call => None,
                    _ => {
                        self.learned.instances.insert(ty.span, call);
                        Some(known)
                    }
                },
                None => system::block(word).filter(|known| known.split('_').next() == Some(call)),
            };
            let Some(known) = known else {
                self.refuse(
                    callee.span,
                    format!("an instance of {word} is called as {call}"),
                    "declare it as one block",
                );
                return Called::Refused;
            };
            let instance = self.expr(base);
            return Called::Instance { instance, ty: known.to_string(), block: None };
        }
        if let Some(key) = self.program.callee_key(callee)
            && !matches!(&callee.kind, ExprKind::Name(name) if name.form == NameForm::Bare && self.is_local(&name.text))
        {
            match self.program.global(&key) {
                Some(Global::Code(block)) if super::program::is_function(block) => {
                    return Called::Function(block, self.global_name(&key));
                }
                Some(Global::Data(data)) => return self.instance(callee, data),
                Some(Global::Variable(_)) => {}
                _ => {
                    let title = "a call of a block without an instance";
                    self.refuse(callee.span, title, "call an instance data block, or an instance of the block");
                    return Called::Refused;
                }
            }
        }
        if let ExprKind::Name(name) = &callee.kind
            && (name.form == NameForm::Quoted || name.form == NameForm::Bare && !self.is_local(&name.text))
            && self.program.global(&self.program.key_of(&name.text)).is_none()
        {
            return Called::System(name.clone());
        }
        // A multi-instance, also of a structure or an array.
        let ty = self.program.type_of(callee, self.block);
        match ty.and_then(|ty| Some((ty, self.program.block_type(ty)?))) {
            Some((ty, name)) => {
                let key = self.program.type_key(ty);
                let block = match key.and_then(|key| self.program.global(&key)) {
                    Some(Global::Code(block)) => Some(block),
                    _ => None,
                };
                Called::Instance { instance: self.expr(callee), ty: name, block }
            }
            None => {
                let what = match ty.map(|ty| &ty.kind) {
                    Some(TypeKind::Named(word)) => format!("IEC 61131-3 has no function block `{word}`"),
                    _ => "a call of an instance whose function block is not in the sources".to_string(),
                };
                self.refuse(callee.span, what, "give the source of the function block, or program it in another way");
                Called::Refused
            }
        }
    }

    /// A call of an instance data block.
    fn instance(&mut self, callee: &Expr, data: &'a DataBlock) -> Called<'a> {
        let DataContent::OfType(ty) = &data.content else {
            self.refuse(callee.span, "a call of a data block that is no instance", "call an instance");
            return Called::Refused;
        };
        match self.program.block_type(ty) {
            Some(name) => {
                let block = match self.program.instance_of(data).and_then(|key| self.program.global(&key)) {
                    Some(Global::Code(block)) => Some(block),
                    _ => None,
                };
                Called::Instance { instance: self.expr(callee), ty: name, block }
            }
            None => {
                let word = match &ty.kind {
                    TypeKind::Named(word) => word.clone(),
                    TypeKind::Block(name) => self.program.shown(&self.program.key(name)),
                    _ => String::new(),
                };
                let title = format!("IEC 61131-3 has no function block `{word}`, and no source declares it");
                self.refuse(callee.span, title, "program it in another way");
                Called::Refused
            }
        }
    }

    fn call(&mut self, callee: &Expr, arguments: &[Argument], span: Span) -> Expr {
        let arguments_of = |body: &mut Self, name: &dyn Fn(&str) -> String| -> Vec<Argument> {
            let formal_name = |text: &str| match text.to_ascii_uppercase() {
                upper if matches!(upper.as_str(), "EN" | "ENO") => upper,
                _ => name(text),
            };
            let written = |argument: &Argument| Argument {
                name: argument.name.as_ref().map(|formal| Name { text: formal_name(&formal.text), ..formal.clone() }),
                output: argument.output,
                value: argument.value.as_ref().map(|value| body.expr(value)),
                span: argument.span,
            };
            arguments.iter().map(written).collect()
        };
        let named = |text: String, span| {
            Box::new(Expr { kind: ExprKind::Name(Name { text, form: NameForm::Bare, span }), span })
        };
        let kind = match self.called(callee) {
            Called::Function(_, name) => {
                let arguments = arguments_of(self, &identifier);
                ExprKind::Call { callee: named(name, callee.span), arguments }
            }
            Called::Instance { instance, block: Some(_), .. } => {
                let arguments = arguments_of(self, &identifier);
                ExprKind::Call { callee: Box::new(instance), arguments }
            }
            Called::Instance { instance, block: None, .. } => {
                let arguments = arguments_of(self, &|formal| formal.to_string());
                ExprKind::Call { callee: Box::new(instance), arguments }
            }
            Called::System(name) => return self.function(&name, arguments, span),
            Called::Refused => ExprKind::Error,
        };
        Expr { kind, span }
    }

    /// A function of SCL.
    fn function(&mut self, name: &Name, arguments: &[Argument], span: Span) -> Expr {
        let first = arguments.first().and_then(|argument| argument.value.as_ref());
        let values: Vec<Argument> = arguments
            .iter()
            .map(|argument| Argument {
                value: argument.value.as_ref().map(|value| self.expr(value)),
                ..argument.clone()
            })
            .collect();
        // A square of a variable: computing it twice changes nothing.
        if name.text.eq_ignore_ascii_case("SQR")
            && let [Argument { value: Some(value), .. }] = values.as_slice()
            && matches!(value.kind, ExprKind::Name(_) | ExprKind::Member { .. } | ExprKind::Absolute(_))
        {
            let (left, right) = (Box::new(value.clone()), Box::new(value.clone()));
            return Expr { kind: ExprKind::Binary { op: BinaryOp::Multiply, left, right, op_span: name.span }, span };
        }
        let ty = first.and_then(|value| self.elementary(value));
        let text = match system::function(&name.text, ty) {
            Function::Same => name.text.clone(),
            Function::Named(text) => text,
            Function::None(reason) => {
                let help = "write it with operators and functions of the standard, or as a function of your own";
                self.refuse(name.span, reason, help);
                name.text.clone()
            }
        };
        if text.eq_ignore_ascii_case("TRUNC") && self.locals.contains("trunc") {
            self.refuse(name.span, "a variable has the name of a function", "rename it");
        }
        let callee = Name { text, form: NameForm::Bare, span: name.span };
        let callee = Box::new(Expr { kind: ExprKind::Name(callee), span: name.span });
        Expr { kind: ExprKind::Call { callee, arguments: values }, span }
    }

    // Statements.

    pub fn statements(&mut self, list: &[Statement]) -> Vec<Statement> {
        list.iter().flat_map(|statement| self.statement(statement)).collect()
    }

    fn statement(&mut self, statement: &Statement) -> Vec<Statement> {
        let span = statement.span;
        let kind = match &statement.kind {
            StatementKind::Empty => StatementKind::Empty,
            StatementKind::Expression(value) => StatementKind::Expression(self.expr(value)),
            StatementKind::Assign { targets, value } => return self.assign(targets, value, span),
            StatementKind::If { branches, otherwise } => StatementKind::If {
                branches: branches
                    .iter()
                    .map(|(condition, body)| (self.expr(condition), self.statements(body)))
                    .collect(),
                otherwise: self.statements(otherwise),
            },
            StatementKind::Case { selector, arms, otherwise } => {
                let selector = self.expr(selector);
                let arms = arms
                    .iter()
                    .map(|arm| {
                        let value = |value: &CaseValue| CaseValue {
                            low: self.expr(&value.low),
                            high: value.high.as_ref().map(|high| self.expr(high)),
                        };
                        let values = arm.values.iter().map(value).collect();
                        Arm { values, body: self.statements(&arm.body), span: arm.span }
                    })
                    .collect();
                StatementKind::Case { selector, arms, otherwise: self.statements(otherwise) }
            }
            StatementKind::For { variable, start, end, step, body } => StatementKind::For {
                variable: self.expr(variable),
                start: self.expr(start),
                end: self.expr(end),
                step: step.as_ref().map(|step| self.expr(step)),
                body: self.statements(body),
            },
            StatementKind::While { condition, body } => {
                StatementKind::While { condition: self.expr(condition), body: self.statements(body) }
            }
            StatementKind::Repeat { body, until } => {
                StatementKind::Repeat { body: self.statements(body), until: self.expr(until) }
            }
            StatementKind::Exit => StatementKind::Exit,
            StatementKind::Continue => StatementKind::Continue,
            StatementKind::Return(None) => StatementKind::Return(None),
            StatementKind::Return(Some(_)) => {
                self.refuse(span, "ST has no RETURN with a value for ENO", "write RETURN alone");
                StatementKind::Error
            }
            StatementKind::Label(_) | StatementKind::Goto(_) => {
                self.refuse(span, "ST has no labels and jumps", "write it with IF, CASE and loops");
                StatementKind::Empty
            }
            StatementKind::Pragma(pragma) => StatementKind::Pragma(self.pragma(pragma)),
            StatementKind::Error => StatementKind::Error,
        };
        vec![Statement { kind, span }]
    }

    /// `a := b += e` is `b := b + e; a := b`.
    fn assign(&mut self, targets: &[(Expr, AssignOp)], value: &Expr, span: Span) -> Vec<Statement> {
        let mut value = self.expr(value);
        let mut list = Vec::new();
        for (target, op) in targets.iter().rev() {
            let target = self.expr(target);
            let op = match op {
                AssignOp::Set => None,
                AssignOp::Add => Some(BinaryOp::Add),
                AssignOp::Subtract => Some(BinaryOp::Subtract),
                AssignOp::Multiply => Some(BinaryOp::Multiply),
                AssignOp::Divide => Some(BinaryOp::Divide),
                AssignOp::Attempt => {
                    self.refuse(span, "ST has no `?=`", "assign with `:=`");
                    None
                }
            };
            if let Some(op) = op {
                let (left, right) = (Box::new(target.clone()), Box::new(value));
                value = Expr { kind: ExprKind::Binary { op, left, right, op_span: span }, span };
            }
            let next = target.clone();
            let kind = StatementKind::Assign { targets: vec![(target, AssignOp::Set)], value };
            list.push(Statement { kind, span });
            value = next;
        }
        list
    }

    /// An assertion, with the names of the file.
    fn pragma(&mut self, pragma: &Pragma) -> Pragma {
        let mut text = String::new();
        let mut rest = pragma.text.as_str();
        while let Some(at) = rest.find(['"', '#', '\'', '.']) {
            text.push_str(&rest[..at]);
            let sign = &rest[at..=at];
            rest = &rest[at + 1..];
            match sign {
                "'" => {
                    let end = rest.find('\'').map_or(rest.len(), |end| end + 1);
                    text.push_str(sign);
                    text.push_str(&rest[..end]);
                    rest = &rest[end..];
                }
                "." => {
                    text.push('.');
                    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                    let is_member = rest.starts_with(|c: char| c.is_alphabetic() || c == '_');
                    text.push_str(&if is_member { identifier(&rest[..end]) } else { rest[..end].to_string() });
                    rest = &rest[end..];
                }
                // A component in quotes.
                "\"" if text.ends_with('.') => {
                    let end = rest.find('"').unwrap_or(rest.len());
                    text.push_str(&identifier(&rest[..end]));
                    rest = rest.get(end + 1..).unwrap_or_default();
                }
                "\"" => {
                    let end = rest.find('"').unwrap_or(rest.len());
                    text.push_str(&self.asserted(&rest[..end]));
                    rest = rest.get(end + 1..).unwrap_or_default();
                }
                _ => {
                    // `16#FF` is a number.
                    let is_number = text.ends_with(|c: char| c.is_alphanumeric());
                    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                    if !is_number && self.is_start_information(&rest[..end]) {
                        let title = "an assertion of start information, which a program of PLCopen XML does not have";
                        self.refuse(pragma.span, title, "remove it");
                    }
                    text.push('#');
                    text.push_str(&if is_number { rest[..end].to_string() } else { identifier(&rest[..end]) });
                    rest = &rest[end..];
                }
            }
        }
        text.push_str(rest);
        Pragma { text, span: pragma.span, assert: None }
    }

    /// A global name in an assertion, where plcc finds it when it reads the file.
    fn asserted(&mut self, name: &str) -> String {
        let key = self.program.key_of(name);
        let written = self.program.name(&key);
        match self.program.global(&key) {
            Some(Global::Tag(symbol)) if super::globals::has_place(symbol) => format!("\"{written}\""),
            Some(Global::Data(_)) if self.program.tasks.contains_key(&key) => format!("\"{written}\""),
            // An instance is a data block of its own.
            Some(Global::Data(DataBlock { content: DataContent::OfType(ty), .. }))
                if self.program.block_type(ty).is_some() =>
            {
                format!("\"{written}\"")
            }
            Some(Global::Data(_) | Global::Tag(_) | Global::Variable(_)) => format!("\"{GLOBALS}\".{written}"),
            _ if name.eq_ignore_ascii_case(GLOBALS) => format!("\"{GLOBALS}\""),
            _ => format!("\"{name}\""),
        }
    }
}

/// `OB1_PREV_CYCLE`, the usual name of start information on an S7-300/400.
pub fn is_start_name(name: &str) -> bool {
    let upper = name.to_ascii_uppercase();
    upper
        .strip_prefix("OB")
        .and_then(|rest| rest.split_once('_'))
        .is_some_and(|(number, _)| number.parse::<u32>().is_ok())
}

fn of_width(width: Width) -> Option<Elementary> {
    Some(match width {
        Width::Bit => Elementary::Bool,
        Width::Byte => Elementary::Byte,
        Width::Word => Elementary::Word,
        Width::Dword => Elementary::Dword,
        Width::Lword => Elementary::Lword,
    })
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
        ("", SymbolTarget::Memory { width, .. }) => of_width(width),
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
