//! The parts of grammar actions that do more than build a plain node.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use crate::ast::*;
use crate::front::frame::{self, HeaderPart};
use crate::literal::Literal;
use crate::scl;
use crate::scl::ast::{Expr, ExprKind, Name, NameForm, UnaryOp};
use crate::stl::messages::State;
use crate::stl::token::{CodeKeyword, Tok};
use crate::stl::{StlInsn, check};

/// A part of a block before BEGIN.
pub enum Part {
    Header(HeaderPart),
    Section(Section),
    Constants(Vec<Constant>),
    /// `STRUCT … END_STRUCT`, with the byte where it begins.
    Struct(Vec<Variable>, usize),
    OfType(BlockName),
}

/// `BEGIN` and what follows.
pub struct Body {
    pub start: usize,
    pub networks: Vec<Network>,
}

/// `name {attributes}` in a declaration.
pub struct DeclaredName {
    pub name: String,
    pub span: Span,
    pub attributes: Vec<(String, String)>,
}

/// Number after area letters.
pub struct Address {
    pub byte: u32,
    pub bit: Option<u8>,
}

pub fn code_block(
    state: &mut State,
    keyword: CodeKeyword,
    name: BlockName,
    return_type: Option<TypeRef>,
    parts: Vec<Part>,
    body: Option<Body>,
    range: Range<usize>,
) -> Option<Block> {
    let (kind, wrong_letters) = frame::code_kind(keyword, &name, state.text);
    wrong_letters.into_iter().for_each(|message| state.report(message));
    let body_start = body.as_ref().map_or(range.end, |body| body.start);
    let mut sections = Vec::new();
    let mut constants = Vec::new();
    let mut header_parts = Vec::new();
    for part in parts {
        match part {
            Part::Header(part) => header_parts.push(part),
            Part::Section(section) => sections.push(section),
            Part::Constants(list) => constants.extend(list),
            Part::Struct(..) | Part::OfType(_) => {}
        }
    }
    if kind == CodeKind::Fc && return_type.is_none() {
        let named = name.span();
        let text = state.text.get(named.range()).unwrap_or_default();
        let help = format!("write `FUNCTION {text} : VOID`, or the type of its value after the `:`");
        state.report(
            Diagnostic::new(Code::Tolerated, named, "the function states no type")
                .label("read as VOID: without a value")
                .help(help),
        );
    }
    let header_end = sections.first().map_or(body_start, |section: &Section| section.span.start as usize);
    let header = header(state, header_parts, range.start..header_end);
    let return_type = return_type.filter(|ty| ty.kind != TypeKind::Named("VOID".to_owned()));
    let span = state.span(range);
    let networks = body.map_or_else(Vec::new, |body| body.networks);
    Some(Block::Code(CodeBlock {
        kind,
        name,
        return_type,
        header,
        sections,
        constants,
        code: crate::ast::Code::Stl(networks),
        span,
    }))
}

/// A section; the word after its keyword may say whether it is retentive.
pub fn section(state: &State, kind: SectionKind, variables: Vec<Variable>, range: Range<usize>) -> Section {
    let word = state.text.get(range.clone()).and_then(|text| text.split_whitespace().nth(1)).unwrap_or_default();
    let retain = match word.to_ascii_uppercase().as_str() {
        // Not a variable of this name.
        _ if variables.first().is_some_and(|first| first.name.eq_ignore_ascii_case(word)) => Retain::Unsaid,
        "RETAIN" => Retain::Retain,
        "NON_RETAIN" => Retain::NonRetain,
        "DB_SPECIFIC" => Retain::DbSpecific,
        _ => Retain::Unsaid,
    };
    Section { kind, retain, variables, span: state.span(range) }
}

/// `VAR CONSTANT` of newer tools.
pub fn constants(variables: Vec<Variable>) -> Vec<Constant> {
    let constant = |variable: Variable| Constant {
        name: variable.name,
        name_span: variable.name_span,
        ty: Some(variable.ty),
        value: None,
        initial: variable.initial,
    };
    variables.into_iter().map(constant).collect()
}

pub fn implied_ob(state: &mut State, networks: Vec<Network>, range: Range<usize>) -> Block {
    frame::implied_ob(crate::ast::Code::Stl(networks), state.span(range))
}

pub fn data_block(
    state: &mut State,
    name: BlockName,
    parts: Vec<Part>,
    values: Option<Vec<Option<ValueAssignment>>>,
    range: Range<usize>,
) -> Block {
    if let BlockName::Numbered { prefix, number, span } = &name
        && *prefix != BlockPrefix::Db
    {
        state.report(frame::wrong_letters(*span, "DATA_BLOCK", "DB", *number, state.text));
    }
    let sections: Vec<&Section> =
        parts.iter().filter_map(|part| if let Part::Section(one) = part { Some(one) } else { None }).collect();
    let retained = sections.into_iter().flat_map(|section| Section::retained(std::slice::from_ref(section))).collect();
    let (header, content) = data_parts(state, parts, range.clone());
    let values = values.into_iter().flatten().flatten().collect();
    Block::Data(DataBlock { name, header, content, values, retained, span: state.span(range) })
}

pub fn type_block(state: &mut State, name: BlockName, parts: Vec<Part>, range: Range<usize>) -> Block {
    if let BlockName::Numbered { prefix, number, span } = &name
        && *prefix != BlockPrefix::Udt
    {
        state.report(frame::wrong_letters(*span, "TYPE", "UDT", *number, state.text));
    }
    let span = state.span(range.clone());
    let (header, content) = data_parts(state, parts, range);
    let members = match content {
        DataContent::Struct(members) => members,
        DataContent::OfType(_) | DataContent::Array(..) | DataContent::Empty => {
            state.report(
                Diagnostic::new(Code::DeclarationSyntax, name.span(), "the data type has no structure")
                    .label("it declares nothing")
                    .help("write `STRUCT … END_STRUCT;` between the header and `END_TYPE`"),
            );
            Vec::new()
        }
    };
    Block::Type(TypeBlock { name, header, members, alias: None, span })
}

fn data_parts(state: &mut State, parts: Vec<Part>, range: Range<usize>) -> (Header, DataContent) {
    let mut header_parts = Vec::new();
    let mut content = DataContent::Empty;
    let mut header_end = range.end;
    for part in parts {
        match part {
            Part::Header(part) => header_parts.push(part),
            Part::Section(section) => {
                header_end = header_end.min(section.span.start as usize);
                match &mut content {
                    DataContent::Struct(members) => members.extend(section.variables),
                    DataContent::OfType(_) | DataContent::Array(..) | DataContent::Empty => {
                        content = DataContent::Struct(section.variables)
                    }
                }
            }
            Part::Constants(constants) => {
                if let Some(first) = constants.first() {
                    state.report(
                        Diagnostic::new(Code::DeclarationSyntax, first.name_span, "data declares no constants")
                            .label("only blocks with statements have them")
                            .help("declare it as data with an initial value"),
                    );
                }
            }
            Part::Struct(members, start) => {
                header_end = header_end.min(start);
                content = DataContent::Struct(members);
            }
            Part::OfType(name) => {
                let span = name.span();
                header_end = header_end.min(span.start as usize);
                content = DataContent::OfType(TypeRef { kind: TypeKind::Block(name), span });
            }
        }
    }
    (header(state, header_parts, range.start..header_end), content)
}

fn header(state: &State, parts: Vec<HeaderPart>, range: Range<usize>) -> Header {
    frame::header(state.comment_lines(range), parts)
}

/// The variables of one declaration; the comment after it belongs to each variable.
pub fn variables(
    state: &State,
    names: Vec<DeclaredName>,
    at: Option<(String, Span)>,
    ty: TypeRef,
    initial: Option<Option<InitialValue>>,
    end: usize,
) -> Vec<Variable> {
    let comment = state.comment_after(end);
    let initial = initial.flatten();
    names
        .into_iter()
        .map(|name| Variable {
            name: name.name,
            name_span: name.span,
            attributes: name.attributes,
            at: at.clone(),
            ty: ty.clone(),
            initial: initial.clone(),
            comment: comment.clone(),
        })
        .collect()
}

/// The names of a declaration that does not parse, so that their uses are not reported as well.
pub fn broken_declaration(state: &State, range: Range<usize>) -> Vec<Variable> {
    let first = state.index_of(range.start);
    let mut names: Vec<DeclaredName> = Vec::new();
    for (start, token, end) in &state.tokens[first..] {
        let name = match token {
            Tok::Name(name) | Tok::Quoted(name) => *name,
            Tok::Comma => continue,
            _ => break,
        };
        let follows = names.last().is_some_and(|last| !state.text[last.span.end as usize..*start].contains(','));
        if *end > range.end || follows {
            break;
        }
        names.push(DeclaredName { name: name.to_owned(), span: state.span(*start..*end), attributes: Vec::new() });
    }
    let ty = TypeRef { kind: TypeKind::Error, span: state.span(range.clone()) };
    variables(state, names, None, ty, None, range.end)
}

/// A bound, length or index: a whole number.
pub fn bound(state: &mut State, value: Literal, range: Range<usize>) -> Bound {
    let span = state.span(range);
    let number = match value {
        Literal::Int(number) => number,
        Literal::Dint(number) => number.into(),
        Literal::Bits { value, .. } => value.into(),
        _ => {
            state.report(
                Diagnostic::new(Code::DeclarationSyntax, span, "a whole number is expected here")
                    .label("not a whole number")
                    .help("bounds, lengths and indices are decimal numbers, e.g. `[1..10]`"),
            );
            0
        }
    };
    Bound::Number(number, span)
}

/// The name of an index: a constant or a variable.
pub fn index(path: Path) -> Bound {
    match path {
        Path { root: PathRoot::Bare { name, span }, parts, .. } if parts.is_empty() => Bound::Name(name, span),
        path => Bound::Path(Box::new(path)),
    }
}

/// One value is kept as it is, several become a list; `None`: all were reported.
pub fn initial_list(state: &State, values: Vec<Option<InitialValue>>, range: Range<usize>) -> Option<InitialValue> {
    let bad = values.iter().any(Option::is_none);
    let mut values: Vec<InitialValue> = values.into_iter().flatten().collect();
    if bad {
        return None;
    }
    if values.len() == 1 {
        return values.pop();
    }
    Some(InitialValue { kind: InitialKind::List(values), span: state.span(range) })
}

pub fn initial_literal(state: &State, value: Literal, range: Range<usize>) -> InitialValue {
    InitialValue { kind: InitialKind::Literal(value), span: state.span(range) }
}

/// A constant that only declarations have, with its sign: the expression that it is in SCL.
pub fn long_literal(state: &State, (value, negative): (scl::ast::Literal, bool), range: Range<usize>) -> InitialValue {
    let text = &state.text[range.clone()];
    let unsigned = if negative { text[1..].trim_start() } else { text };
    let (start, span) = (range.end - unsigned.len(), state.span(range.clone()));
    let mut constant = Expr { kind: ExprKind::Literal(value), span: state.span(start..range.end) };
    if negative {
        constant = Expr { kind: ExprKind::Unary { op: UnaryOp::Minus, operand: Box::new(constant) }, span };
    }
    InitialValue { kind: InitialKind::Expr(Box::new(constant)), span }
}

/// `#MAX`: a constant of the block.
pub fn local_constant(state: &State, name: &str, range: Range<usize>) -> InitialValue {
    let span = state.span(range);
    let name = Name { text: name.to_owned(), form: NameForm::Local, span };
    InitialValue { kind: InitialKind::Expr(Box::new(Expr { kind: ExprKind::Name(name), span })), span }
}

/// `(5, TRUE)`, `()`: the components of a structure in their order; `None`: one was reported.
pub fn values_of_structure(
    state: &State,
    values: Option<Vec<Option<InitialValue>>>,
    range: Range<usize>,
) -> Option<InitialValue> {
    let fields: Option<Vec<_>> = values.unwrap_or_default().into_iter().map(|value| Some((None, value?))).collect();
    Some(InitialValue { kind: InitialKind::Fields(fields?), span: state.span(range) })
}

/// `6 (0)`.
pub fn repeated(
    state: &mut State,
    count: Literal,
    values: Vec<Option<InitialValue>>,
    range: Range<usize>,
) -> Option<InitialValue> {
    let span = state.span(range);
    let count = match count {
        Literal::Int(count @ 1..=65_536) => count,
        _ => {
            state.report(
                Diagnostic::new(Code::DeclarationSyntax, span, "the repetition factor is not a number of elements")
                    .label("the number before `(` is how often the values are repeated")
                    .help("write e.g. `6 (0)`: a whole number from 1 to 65536 before the parenthesis"),
            );
            return None;
        }
    };
    let bad = values.iter().any(Option::is_none);
    let values: Vec<InitialValue> = values.into_iter().flatten().collect();
    if bad {
        None
    } else {
        Some(InitialValue { kind: InitialKind::Repeat { count: Bound::Number(count, span), values }, span })
    }
}

/// The networks of a block: statements before the first NETWORK form a separate network.
pub fn networks(
    state: &State,
    title: Option<&str>,
    statements: Vec<Statement>,
    mut networks: Vec<Network>,
    head: Range<usize>,
) -> Vec<Network> {
    if title.is_some() || !statements.is_empty() {
        networks.insert(0, network(state, title, statements, head));
    }
    networks
}

pub fn network(state: &State, title: Option<&str>, statements: Vec<Statement>, head: Range<usize>) -> Network {
    Network { title: title.map(str::to_owned), comment: state.comment_lines(head), statements }
}

/// An instruction with a suitable operand; otherwise it is reported and becomes an error node.
pub fn instruction(
    state: &mut State,
    insn: StlInsn,
    mnemonic: Range<usize>,
    operand: Option<Operand>,
) -> StatementKind {
    let mnemonic_span = state.span(mnemonic.start..mnemonic.end);
    let operand_is_bad = operand.as_ref().is_some_and(|operand| operand.kind == OperandKind::Error);
    match check::operand(state.text, state.rules, insn, mnemonic_span, operand.as_ref()) {
        Some(diagnostic) => {
            state.report(diagnostic);
            StatementKind::Error
        }
        None if operand_is_bad => StatementKind::Error,
        None => StatementKind::Instruction { insn, mnemonic_span, operand },
    }
}

pub fn call(
    state: &mut State,
    keyword: Range<usize>,
    (target, mut types): (Operand, Vec<CallType>),
    instance: Option<(Operand, Vec<CallType>)>,
    parameters: Vec<Parameter>,
) -> StatementKind {
    let (instance, more) = instance.unzip();
    types.extend(more.into_iter().flatten());
    let keyword = state.span(keyword.start..keyword.end);
    match check::call(state.text, keyword, &target, instance.as_ref()) {
        Some(diagnostic) => {
            state.report(diagnostic);
            StatementKind::Error
        }
        None => StatementKind::Call(Box::new(Call { target, types, instance, parameters })),
    }
}

/// A parameter that cannot be read, or whose operand cannot: the call passes it, so it is not missing too. Its name may be empty.
pub fn bad_parameter(state: &State, range: Range<usize>) -> Option<Parameter> {
    let tokens = state.tokens.get(state.index_of(range.start)..)?;
    let named = tokens.iter().take(2).find_map(|(start, token, end)| match token {
        Tok::Name(name) if *start == range.start => Some(((*name).to_owned(), state.span(*start..*end))),
        _ => None,
    });
    let (name, name_span) = named.unwrap_or_else(|| (String::new(), state.span(range.clone())));
    let actual = Some(Operand { kind: OperandKind::Error, span: state.span(range) });
    Some(Parameter { name, name_span, actual })
}

/// An operand; an address that does not fit its area letters is reported.
pub fn operand(state: &mut State, kind: OperandKind, range: Range<usize>) -> Operand {
    let span = state.span(range);
    let bad = match &kind {
        OperandKind::Absolute { width, byte, bit, .. } | OperandKind::DbAbsolute { width, byte, bit, .. } => {
            check::address(state.text, span, *width, *byte, *bit)
        }
        _ => None,
    };
    match bad {
        Some(diagnostic) => {
            state.report(diagnostic);
            Operand { kind: OperandKind::Error, span }
        }
        None => Operand { kind: without_no_bit(kind), span },
    }
}

/// For bytes and words the bit is 0.
fn without_no_bit(mut kind: OperandKind) -> OperandKind {
    if let OperandKind::Absolute { bit, .. } | OperandKind::DbAbsolute { bit, .. } = &mut kind
        && *bit == NO_BIT
    {
        *bit = 0;
    }
    kind
}

/// Bit number of an address that was written without one.
pub const NO_BIT: u8 = u8::MAX;

pub fn absolute(area: Area, width: Width, address: Address) -> OperandKind {
    OperandKind::Absolute { area, width, byte: address.byte, bit: address.bit.unwrap_or(NO_BIT) }
}

pub fn db_absolute(db: BlockName, width: Width, address: Address) -> OperandKind {
    OperandKind::DbAbsolute { db, width, byte: address.byte, bit: address.bit.unwrap_or(NO_BIT) }
}

pub fn register_indirect(area: Option<Area>, width: Width, offset: Option<(AddressRegister, u32)>) -> OperandKind {
    match offset {
        Some((register, offset)) => OperandKind::RegisterIndirect { area, width, register, offset },
        None => OperandKind::Error,
    }
}

/// `AR1,P#4.3`.
pub fn register_offset(
    state: &mut State,
    register: AddressRegister,
    offset: Literal,
    range: Range<usize>,
) -> Option<(AddressRegister, u32)> {
    match offset {
        Literal::Pointer(bits) if bits < 4096 * 8 => Some((register, bits)),
        _ => {
            let text = state.text.get(range.clone()).unwrap_or_default();
            let (byte, bit) = text.split_once('.').unwrap_or((text, "0"));
            let is_number = !byte.is_empty() && byte.bytes().all(|digit| digit.is_ascii_digit());
            let help = match bit.as_bytes() {
                [b'0'..=b'7'] if is_number && byte.len() <= 4 => format!("write `P#{byte}.{bit}`"),
                _ => "write e.g. `[AR1,P#0.0]`".to_owned(),
            };
            let span = state.span(range);
            state.report(
                Diagnostic::new(Code::OperandKind, span, "an offset to an address register is written as `P#byte.bit`")
                    .label("not an offset from P#0.0 to P#4095.7")
                    .help(help),
            );
            None
        }
    }
}
