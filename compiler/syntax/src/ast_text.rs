//! The syntax tree as text for `--emit ast` and golden files: one node per line, indented, without spans.
//!
//! Instructions are printed with the names of their table rows, and addresses with international letters, so both mnemonic sets give
//! the same text.

use std::fmt::{Display, Write};

use crate::ast::*;
use crate::literal::Literal;
use crate::network;
use crate::network::ast::Content;
use crate::scl;
use crate::stl::Mnemonics;

/// Text of a source's tree.
pub fn ast_text(unit: &SourceUnit) -> String {
    let mut out = Out { text: String::new(), depth: 0 };
    out.line(match unit.mnemonics {
        Mnemonics::En => "source en",
        Mnemonics::De => "source de",
    });
    out.depth = 1;
    for pragma in &unit.pragmas {
        out.pragma(pragma);
    }
    for block in &unit.blocks {
        match block {
            Block::Code(block) => out.code_block(block),
            Block::Data(block) => out.data_block(block),
            Block::Type(block) => out.type_block(block),
        }
    }
    if let Some(source) = &unit.s7200 {
        for (depth, line) in crate::s7200::text::lines(source) {
            out.line(format_args!("{}{line}", "  ".repeat(depth)));
        }
    }
    out.text
}

struct Out {
    text: String,
    depth: usize,
}

impl Out {
    fn line(&mut self, text: impl Display) {
        writeln!(self.text, "{:1$}{text}", "", self.depth * 2).expect("a String takes all text");
    }

    fn inside(&mut self, print: impl FnOnce(&mut Out)) {
        self.depth += 1;
        print(self);
        self.depth -= 1;
    }

    fn code_block(&mut self, block: &CodeBlock) {
        let kind = match block.kind {
            CodeKind::Ob => "organization_block",
            CodeKind::Fc => "function",
            CodeKind::Fb => "function_block",
            CodeKind::Sfc => "system_function",
            CodeKind::Sfb => "system_function_block",
        };
        let returns = block.return_type.as_ref().map_or(String::new(), |ty| format!(" : {}", type_text(ty)));
        self.line(format_args!("{kind} {}{returns}", block_name(&block.name)));
        self.inside(|out| {
            out.header(&block.header);
            for section in &block.sections {
                out.line(match section.kind {
                    SectionKind::Input => "input",
                    SectionKind::Output => "output",
                    SectionKind::InOut => "in_out",
                    SectionKind::Static => "static",
                    SectionKind::Temp => "temp",
                });
                match section.retain {
                    Retain::Unsaid => {}
                    Retain::Retain => out.line("retain"),
                    Retain::NonRetain => out.line("non_retain"),
                    Retain::DbSpecific => out.line("db_specific"),
                }
                out.inside(|out| out.variables(&section.variables));
            }
            for constant in &block.constants {
                let ty = constant.ty.as_ref().map_or(String::new(), |ty| format!(" : {}", type_text(ty)));
                let value =
                    constant.value.as_ref().map_or(String::new(), |value| format!(" := {}", scl::text::expr(value)));
                let list = constant.initial.as_ref().map_or(String::new(), |value| format!(" := {}", initial(value)));
                out.line(format_args!("constant {}{ty}{value}{list}", constant.name));
            }
            match &block.code {
                Code::Stl(networks) => networks.iter().for_each(|network| out.network(network)),
                Code::Scl(body) => {
                    for (depth, line) in scl::text::body(body) {
                        out.line(format_args!("{}{line}", "  ".repeat(depth)));
                    }
                }
                Code::Graphic(body) => out.graphic(body),
                Code::Chart(body) => out.chart(body),
            }
        });
    }

    fn chart(&mut self, body: &crate::chart::ast::Body) {
        crate::chart::text::lines(body)
            .into_iter()
            .for_each(|(depth, line)| self.line(format_args!("{}{line}", "  ".repeat(depth))));
    }

    fn data_block(&mut self, block: &DataBlock) {
        self.line(format_args!("data_block {}", block_name(&block.name)));
        self.inside(|out| {
            out.header(&block.header);
            match &block.content {
                DataContent::Struct(members) => {
                    out.line("struct");
                    out.inside(|out| out.variables(members));
                }
                DataContent::OfType(ty) => out.line(format_args!("of {}", type_text(ty))),
                DataContent::Array(ty, value) => {
                    let value = value.as_ref().map_or(String::new(), |value| format!(" := {}", initial(value)));
                    out.line(format_args!("array {}{value}", type_text(ty)));
                    out.members_of(ty);
                }
                DataContent::Empty => {}
            }
            for value in &block.values {
                out.line(format_args!("value {} := {}", path(&value.target), initial(&value.value)));
            }
        });
    }

    fn type_block(&mut self, block: &TypeBlock) {
        self.line(format_args!("type {}", block_name(&block.name)));
        self.inside(|out| {
            out.header(&block.header);
            out.variables(&block.members);
            if let Some(alias) = &block.alias {
                out.line(format_args!("alias {}", type_text(alias)));
            }
        });
    }

    fn header(&mut self, header: &Header) {
        let texts = [
            ("title", &header.title),
            ("author", &header.author),
            ("family", &header.family),
            ("name", &header.name),
            ("version", &header.version),
        ];
        for (name, text) in texts {
            if let Some(text) = text {
                self.line(format_args!("{name} {text:?}"));
            }
        }
        if let Some(number) = header.number {
            let automatic = if header.auto_number { " by the tool" } else { "" };
            self.line(format_args!("number {number}{automatic}"));
        }
        for comment in &header.comment {
            self.line(format_args!("comment {comment:?}"));
        }
        for (name, value) in &header.attributes {
            self.line(format_args!("attribute {name} {value:?}"));
        }
        let flags = [
            ("know_how_protect", header.know_how_protect),
            ("standard", header.standard),
            ("code_version1", header.code_version1),
            ("unlinked", header.unlinked),
            ("read_only", header.read_only),
            ("non_retain", header.non_retain),
            ("retain", header.retain),
        ];
        for (name, set) in flags {
            if set {
                self.line(name);
            }
        }
    }

    fn variables(&mut self, variables: &[Variable]) {
        for variable in variables {
            let mut text = variable.name.clone();
            for (name, value) in &variable.attributes {
                let _ = write!(text, " {{{name} {value:?}}}");
            }
            if let Some((at, _)) = &variable.at {
                let _ = write!(text, " at {at}");
            }
            let _ = write!(text, " : {}", type_text(&variable.ty));
            if let Some(value) = &variable.initial {
                let _ = write!(text, " := {}", initial(value));
            }
            if let Some(comment) = &variable.comment {
                let _ = write!(text, " // {comment}");
            }
            self.line(text);
            self.inside(|out| out.members_of(&variable.ty));
        }
    }

    /// Components of a STRUCT, also as an element of an ARRAY.
    fn members_of(&mut self, ty: &TypeRef) {
        match &ty.kind {
            TypeKind::Struct(members) => self.variables(members),
            TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } => self.members_of(element),
            TypeKind::Named(_)
            | TypeKind::String(_)
            | TypeKind::WideString(_)
            | TypeKind::Reference(_)
            | TypeKind::Error
            | TypeKind::Block(_) => {}
        }
    }

    fn graphic(&mut self, body: &network::ast::Body) {
        for network in &body.networks {
            let title = network.title.as_ref().map_or(String::new(), |title| format!(" {title:?}"));
            self.line(format_args!("{:?} network{title}", network.language));
            self.inside(|out| {
                for comment in &network.comment {
                    out.line(format_args!("comment {comment:?}"));
                }
                for label in &network.labels {
                    out.line(format_args!("label {}", label.text));
                }
                match &network.content {
                    Content::Graphic(graph) => network::text::graph(graph).iter().for_each(|line| out.line(line)),
                    Content::Scl(statements) => {
                        for (depth, line) in scl::text::statements(statements) {
                            out.line(format_args!("{}{line}", "  ".repeat(depth)));
                        }
                    }
                    Content::Stl(statements) => statements.iter().for_each(|statement| out.statement(statement)),
                }
            });
        }
    }

    fn network(&mut self, network: &Network) {
        match &network.title {
            Some(title) => self.line(format_args!("network {title:?}")),
            None => self.line("network"),
        }
        self.inside(|out| {
            for comment in &network.comment {
                out.line(format_args!("comment {comment:?}"));
            }
            for statement in &network.statements {
                out.statement(statement);
            }
        });
    }

    fn statement(&mut self, statement: &Statement) {
        let label = statement.label.as_ref().map_or(String::new(), |label| format!("{}: ", label.name));
        match &statement.kind {
            StatementKind::Empty => self.line(format_args!("{label}empty")),
            StatementKind::Instruction { insn, operand: None, .. } => self.line(format_args!("{label}{}", insn.row())),
            StatementKind::Instruction { insn, operand: Some(actual), .. } => {
                self.line(format_args!("{label}{} {}", insn.row(), operand(actual)));
            }
            StatementKind::Call(call) => {
                let instance =
                    call.instance.as_ref().map_or(String::new(), |instance| format!(", {}", operand(instance)));
                let types = call.types.iter().map(|one| format!(" {{{} {}}}", one.name, one.ty));
                let types: String = types.collect();
                self.line(format_args!("{label}call {}{instance}{types}", operand(&call.target)));
                self.inside(|out| {
                    for parameter in &call.parameters {
                        let actual = parameter.actual.as_ref().map_or(String::new(), operand);
                        out.line(format_args!("{} := {actual}", parameter.name).to_string().trim_end());
                    }
                });
            }
            StatementKind::Pragma(pragma) => self.pragma(pragma),
            StatementKind::Error => self.line(format_args!("{label}error")),
        }
    }

    fn pragma(&mut self, pragma: &Pragma) {
        self.line(pragma_text(pragma));
    }
}

pub(crate) fn pragma_text(pragma: &Pragma) -> String {
    match &pragma.assert {
        Some(assertion) => format!("assert {}", assertion_text(assertion, &assert_side)),
        None => format!("pragma {:?}", pragma.text),
    }
}

/// An assertion with sides as `side` writes them.
pub(crate) fn assertion_text<S>(assertion: &Assertion<S>, side: &dyn Fn(&S) -> String) -> String {
    condition_text(&assertion.condition, assertion, side, false)
}

fn condition_text<S>(
    condition: &Condition,
    assertion: &Assertion<S>,
    side: &dyn Fn(&S) -> String,
    inner: bool,
) -> String {
    let join = |conditions: &[Condition], word: &str| {
        let list: Vec<String> = conditions.iter().map(|one| condition_text(one, assertion, side, true)).collect();
        let list = list.join(word);
        if inner { format!("({list})") } else { list }
    };
    match condition {
        Condition::Compare(index) => {
            let Some(comparison) = assertion.comparisons.get(*index as usize) else { return String::new() };
            let side = |written: &Side<S>| match &written.ty {
                Some((ty, _)) => format!("{} as {ty}", side(&written.value)),
                None => side(&written.value),
            };
            format!("{} {} {}", side(&comparison.left), comparison.op.sign(), side(&comparison.right))
        }
        Condition::Not(one) => format!("NOT ({})", condition_text(one, assertion, side, false)),
        Condition::All(conditions) => join(conditions, " AND "),
        Condition::Any(conditions) => join(conditions, " OR "),
    }
}

fn block_name(name: &BlockName) -> String {
    match name {
        BlockName::Numbered { prefix, number, .. } => format!("{} {number}", prefix.letters()),
        BlockName::Symbol { name, .. } => format!("{name:?}"),
    }
}

fn type_text(ty: &TypeRef) -> String {
    match &ty.kind {
        TypeKind::Named(name) => name.clone(),
        TypeKind::String(None) => "STRING".to_owned(),
        TypeKind::String(Some(length)) => format!("STRING[{}]", bound(length)),
        TypeKind::WideString(None) => "WSTRING".to_owned(),
        TypeKind::WideString(Some(length)) => format!("WSTRING[{}]", bound(length)),
        TypeKind::OpenArray { dimensions, element } => {
            format!("ARRAY[{}] OF {}", vec!["*"; usize::from(*dimensions)].join(", "), type_text(element))
        }
        TypeKind::Error => "?".to_owned(),
        TypeKind::Reference(target) => format!("REF_TO {}", type_text(target)),
        TypeKind::Array { bounds, element } => {
            let bounds: Vec<String> =
                bounds.iter().map(|(low, high)| format!("{}..{}", bound(low), bound(high))).collect();
            format!("ARRAY[{}] OF {}", bounds.join(", "), type_text(element))
        }
        TypeKind::Struct(_) => "STRUCT".to_owned(),
        TypeKind::Block(name) => block_name(name),
    }
}

fn bound(bound: &Bound) -> String {
    match bound {
        Bound::Number(number, _) => number.to_string(),
        Bound::Name(name, _) => name.clone(),
        Bound::Expr(value) => scl::text::expr(value),
        Bound::Path(name) => path(name),
    }
}

fn initial(value: &InitialValue) -> String {
    let list = |values: &[InitialValue]| values.iter().map(initial).collect::<Vec<_>>().join(", ");
    match &value.kind {
        InitialKind::Literal(value) => literal(value),
        InitialKind::List(values) => format!("[{}]", list(values)),
        InitialKind::Elements(elements) => {
            let index = |path: &[i64]| path.iter().map(i64::to_string).collect::<Vec<_>>().join(", ");
            let one = |(path, value): &(Vec<i64>, InitialValue)| format!("[{}]: {}", index(path), initial(value));
            format!("[{}]", elements.iter().map(one).collect::<Vec<_>>().join(", "))
        }
        InitialKind::Repeat { count, values } => format!("{} ({})", bound(count), list(values)),
        InitialKind::Expr(value) => scl::text::expr(value),
        InitialKind::Fields(fields) => {
            let fields: Vec<String> = fields
                .iter()
                .map(|(name, value)| match name {
                    Some(name) => format!("{} := {}", name.text, initial(value)),
                    None => initial(value),
                })
                .collect();
            format!("({})", fields.join(", "))
        }
        InitialKind::Operand(kind) => operand_text(kind),
        InitialKind::Default => "default".to_owned(),
    }
}

/// The form of the literal and its value; bits in hexadecimal digits.
fn literal(value: &Literal) -> String {
    match value {
        Literal::Bool(value) => format!("bool {value}"),
        Literal::Int(value) => format!("int {value}"),
        Literal::Dint(value) => format!("dint {value}"),
        Literal::Byte(value) => format!("byte {value:02X}"),
        Literal::Word(value) => format!("word {value:04X}"),
        Literal::Dword(value) => format!("dword {value:08X}"),
        Literal::Bits { value, digits } => format!("bits {value:X} of {digits}"),
        Literal::Bytes2(bytes) => format!("bytes {}", hex(bytes)),
        Literal::Bytes4(bytes) => format!("bytes {}", hex(bytes)),
        Literal::Real(value) => format!("real {value:?}"),
        Literal::S5Time(value) => format!("s5time {value:04X}"),
        Literal::Time(ms) => format!("time {ms} ms"),
        Literal::Date(days) => format!("date {days} days"),
        Literal::TimeOfDay(ms) => format!("time_of_day {ms} ms"),
        Literal::DateAndTime(bytes) => format!("date_and_time {}", hex(bytes)),
        Literal::Counter(value) => format!("counter {value:04X}"),
        Literal::Text(bytes) => format!("text {:?}", bytes.iter().map(|byte| char::from(*byte)).collect::<String>()),
        Literal::Pointer(bits) => format!("pointer {bits:08X}"),
        Literal::AreaPointer { db, pointer } => format!("area_pointer db {db} {pointer:08X}"),
        Literal::Any(bytes) => format!("any {}", hex(bytes)),
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

fn path(path: &Path) -> String {
    let mut text = match &path.root {
        PathRoot::Local { name, .. } => format!("#{name}"),
        PathRoot::Quoted { name, .. } => format!("{name:?}"),
        PathRoot::Bare { name, .. } => name.clone(),
        PathRoot::Block(name) => block_name(name),
    };
    for part in &path.parts {
        let _ = match part {
            PathPart::Member { name, .. } => write!(text, ".{name}"),
            PathPart::Index { values, .. } => {
                write!(text, "[{}]", values.iter().map(bound).collect::<Vec<_>>().join(", "))
            }
        };
    }
    text
}

fn letters(area: Area, width: Width) -> String {
    let name = area.letters();
    let has_no_letter = width == Width::Bit && !matches!(area, Area::Db | Area::Di);
    format!("{name}{}", if has_no_letter { "" } else { width.letter() })
}

fn address(width: Width, byte: u32, bit: u8) -> String {
    if width == Width::Bit { format!("{byte}.{bit}") } else { byte.to_string() }
}

fn cell(kind: CellKind) -> &'static str {
    match kind {
        CellKind::Timer => "T",
        CellKind::Counter => "C",
    }
}

fn register(register: AddressRegister) -> &'static str {
    match register {
        AddressRegister::Ar1 => "AR1",
        AddressRegister::Ar2 => "AR2",
    }
}

fn operand(operand: &Operand) -> String {
    operand_text(&operand.kind)
}

pub(crate) fn operand_text(kind: &OperandKind) -> String {
    match kind {
        OperandKind::Absolute { area, width, byte, bit } => {
            format!("{} {}", letters(*area, *width), address(*width, *byte, *bit))
        }
        OperandKind::Cell { kind, number } => format!("{} {number}", cell(*kind)),
        OperandKind::DbAbsolute { db, width, byte, bit } => {
            format!("{}.{} {}", block_name(db), letters(Area::Db, *width), address(*width, *byte, *bit))
        }
        OperandKind::MemoryIndirect { area, width, pointer } => {
            format!("{} [{}]", letters(*area, *width), operand(pointer))
        }
        OperandKind::CellIndirect { kind, pointer } => format!("{} [{}]", cell(*kind), operand(pointer)),
        OperandKind::BlockIndirect { prefix: letters, pointer } => {
            format!("{} [{}]", letters.letters(), operand(pointer))
        }
        OperandKind::RegisterIndirect { area, width, register: base, offset } => {
            let letters = area.map_or_else(|| width.letter().to_owned(), |area| letters(area, *width));
            format!("{letters} [{},{}.{}]", register(*base), offset >> 3, offset & 7)
        }
        OperandKind::Block(name) => block_name(name),
        OperandKind::Path(name) => path(name),
        OperandKind::Peripheral(name) => format!("{}:P", path(name)),
        OperandKind::AddressOf(name) => format!("address_of {}", path(name)),
        OperandKind::Literal(value) => literal(value),
        OperandKind::Status(status) => status.name(Mnemonics::En).to_owned(),
        OperandKind::Special(special) => special.name().to_owned(),
        OperandKind::Register(name) => register(*name).to_owned(),
        OperandKind::Label(name) => format!("label {name}"),
        OperandKind::Error => "error".to_owned(),
    }
}

fn assert_side(side: &AssertSide) -> String {
    let register = match side {
        AssertSide::Operand(side) => return operand(side),
        AssertSide::CellValue(cell) => return format!("value of {}", operand(cell)),
        AssertSide::Literal(AssertLiteral { loaded: Some(value), .. }) => return literal(value),
        AssertSide::Literal(AssertLiteral { exact: Some(value), negative, .. }) => {
            return format!("{}{}", if *negative { "-" } else { "" }, scl::text::literal(value));
        }
        AssertSide::Literal(AssertLiteral { loaded: None, exact: None, .. }) => return "error".to_owned(),
        AssertSide::Register(register) => register,
    };
    match register {
        AssertRegister::Accu(number) => return format!("ACCU{number}"),
        AssertRegister::Ar1 => "AR1",
        AssertRegister::Ar2 => "AR2",
        AssertRegister::Stw => "STW",
        AssertRegister::Br => "STW.BR",
        AssertRegister::Cc1 => "STW.CC1",
        AssertRegister::Cc0 => "STW.CC0",
        AssertRegister::Ov => "STW.OV",
        AssertRegister::Os => "STW.OS",
        AssertRegister::Or => "STW.OR",
        AssertRegister::Sta => "STW.STA",
        AssertRegister::Rlo => "STW.RLO",
        AssertRegister::Fc => "STW.FC",
        AssertRegister::DbNumber => "DBNO",
        AssertRegister::DiNumber => "DINO",
    }
    .to_owned()
}
