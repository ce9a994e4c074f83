//! The parts of grammar actions that do more than build a plain node: blocks and declarations. Expressions and statements are in `expression`.

mod expression;

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

pub use expression::*;

use super::ast::{Body, Dialect, Expr, ExprKind, Literal, Name, NameForm, Statement};
use super::messages::State;
use super::token::{CodeKeyword, Tok};
use crate::ast::{
    Block, BlockName, BlockPrefix, Bound, Code as BlockCode, CodeBlock, CodeKind, Constant, DataBlock, DataContent,
    Header, InitialKind, InitialValue, Path, PathPart, PathRoot, Section, SectionKind, TypeBlock, TypeKind, TypeRef,
    ValueAssignment, Variable,
};
use crate::front::ParseState;
use crate::front::frame::{self, HeaderPart};

/// A part of a block before BEGIN. Numbers: the byte where it begins.
pub enum Part {
    Header(HeaderPart),
    Section(Section),
    Constants(Vec<Constant>, usize),
    Labels(Vec<Name>, usize),
    /// The contents of a data block or a type, with their initial value.
    Content(TypeRef, Option<InitialValue>, usize),
    /// Was reported.
    Nothing,
}

/// `name {attributes}` in a declaration.
pub struct DeclaredName {
    pub name: Name,
    pub attributes: Vec<(String, String)>,
}

/// A dimension of an array.
pub enum Dimension {
    /// `*`
    Open,
    Bounds(Bound, Bound),
}

impl ParseState<'_, Tok<'_>, Dialect> {
    pub fn name(&self, text: &str, form: NameForm, range: Range<usize>) -> Name {
        // Of `"tag":P` the letter stays.
        let text = if form == NameForm::Quoted { text.replace('"', "") } else { text.to_owned() };
        Name { text, form, span: self.span(range) }
    }
}

/// The parts of a block by kind.
#[derive(Default)]
struct Parts {
    header: Vec<HeaderPart>,
    sections: Vec<Section>,
    constants: Vec<Constant>,
    labels: Vec<Name>,
    contents: Vec<(TypeRef, Option<InitialValue>)>,
    /// Where the header ends at the latest.
    header_end: usize,
}

fn sort(parts: Vec<Part>, end: usize) -> Parts {
    let mut sorted = Parts { header_end: end, ..Parts::default() };
    for part in parts {
        let start = match part {
            Part::Header(part) => {
                sorted.header.push(part);
                continue;
            }
            Part::Section(section) => {
                let start = section.span.start as usize;
                sorted.sections.push(section);
                start
            }
            Part::Constants(constants, start) => {
                sorted.constants.extend(constants);
                start
            }
            Part::Labels(labels, start) => {
                sorted.labels.extend(labels);
                start
            }
            Part::Content(ty, value, start) => {
                sorted.contents.push((ty, value));
                start
            }
            Part::Nothing => continue,
        };
        sorted.header_end = sorted.header_end.min(start);
    }
    sorted
}

#[allow(clippy::too_many_arguments)] // One for each part of the frame.
pub fn code_block(
    state: &mut State,
    keyword: CodeKeyword,
    name: BlockName,
    return_type: Option<TypeRef>,
    parts: Vec<Part>,
    statements: Vec<Statement>,
    range: Range<usize>,
    begin: usize,
) -> Block {
    let (kind, wrong_letters) = frame::code_kind(keyword, &name, state.text);
    wrong_letters.into_iter().for_each(|message| state.report(message));
    let mut parts = sort(parts, begin);
    if kind != CodeKind::Fb && kind != CodeKind::Sfb {
        without_static(state, &mut parts.sections);
    }
    let header = header(state, parts.header, range.start..parts.header_end);
    let return_type = return_type.filter(|ty| ty.kind != TypeKind::Named("VOID".to_owned()));
    Block::Code(CodeBlock {
        kind,
        name,
        return_type,
        header,
        sections: parts.sections,
        constants: parts.constants,
        code: BlockCode::Scl(Body { dialect: state.rules, labels: parts.labels, statements }),
        span: state.span(range),
    })
}

/// In blocks without an instance, VAR declares temporary variables: S7-SCL for S7-300/400, VAR in functions. The TIA Portal does not accept it.
fn without_static(state: &mut State, sections: &mut [Section]) {
    for section in sections.iter_mut().filter(|section| section.kind == SectionKind::Static) {
        section.kind = SectionKind::Temp;
        if state.rules == Dialect::Tia {
            let span = Span { end: section.span.start + "VAR".len() as u32, ..section.span };
            state.report(
                Diagnostic::new(Code::Tolerated, span, "this block has no static variables")
                    .label("read as VAR_TEMP")
                    .help("write `VAR_TEMP`; only a function block keeps values between calls"),
            );
        }
    }
}

pub fn implied_ob(state: &mut State, statements: Vec<Statement>, range: Range<usize>) -> Block {
    let body = Body { dialect: state.rules, labels: Vec::new(), statements };
    frame::implied_ob(BlockCode::Scl(body), state.span(range))
}

pub fn data_block(
    state: &mut State,
    name: BlockName,
    parts: Vec<Part>,
    values: Option<Vec<Option<ValueAssignment>>>,
    range: Range<usize>,
) -> Block {
    check_letters(state, &name, "DATA_BLOCK", BlockPrefix::Db);
    let parts = sort(parts, range.end);
    let header = header(state, parts.header, range.start..parts.header_end);
    let retained = Section::retained(&parts.sections);
    let members: Vec<Variable> = parts.sections.into_iter().flat_map(|section| section.variables).collect();
    let mut content = if members.is_empty() { DataContent::Empty } else { DataContent::Struct(members) };
    for (ty, value) in parts.contents {
        content = match ty.kind {
            TypeKind::Struct(mut members) => {
                spread(state, &mut members, value);
                DataContent::Struct(members)
            }
            TypeKind::Array { .. } | TypeKind::OpenArray { .. } => DataContent::Array(ty, value),
            _ => DataContent::OfType(ty),
        };
    }
    let values = values.into_iter().flatten().flatten().collect();
    Block::Data(DataBlock { name, header, content, values, retained, span: state.span(range) })
}

pub fn type_block(state: &mut State, name: BlockName, parts: Vec<Part>, range: Range<usize>) -> Block {
    check_letters(state, &name, "TYPE", BlockPrefix::Udt);
    let span = state.span(range.clone());
    let mut parts = sort(parts, range.end);
    let header = header(state, parts.header, range.start..parts.header_end);
    let (members, alias) = match parts.contents.pop() {
        Some((TypeRef { kind: TypeKind::Struct(mut members), .. }, value)) => {
            spread(state, &mut members, value);
            (members, None)
        }
        Some((ty, value)) => {
            if let Some(value) = value {
                state.report(
                    Diagnostic::new(
                        Code::InitialValue,
                        value.span,
                        "a type that is not a structure has no initial value",
                    )
                    .label("the type cannot keep this value")
                    .help("write the value at each variable of this type"),
                );
            }
            (Vec::new(), Some(ty))
        }
        None => {
            if !state
                .diagnostics
                .iter()
                .any(|diagnostic| span.range().contains(&(diagnostic.primary.span.start as usize)))
            {
                state.report(
                    Diagnostic::new(Code::DeclarationSyntax, name.span(), "the data type has no structure")
                        .label("it declares nothing")
                        .help("write `STRUCT … END_STRUCT;` between the header and `END_TYPE`"),
                );
            }
            (Vec::new(), None)
        }
    };
    Block::Type(TypeBlock { name, header, members, alias, span })
}

fn check_letters(state: &mut State, name: &BlockName, keyword: &str, wanted: BlockPrefix) {
    if let BlockName::Numbered { prefix, number, span } = name
        && *prefix != wanted
    {
        state.report(frame::wrong_letters(*span, keyword, wanted.letters(), *number, state.text));
    }
}

/// `END_STRUCT := (a := 1)` of a whole block: the values go to the components.
fn spread(state: &mut State, members: &mut [Variable], value: Option<InitialValue>) {
    let Some(value) = value else { return };
    let InitialKind::Fields(fields) = value.kind else {
        state.report(
            Diagnostic::new(Code::InitialValue, value.span, "a structure cannot have a single value")
                .label("not a list of components")
                .help("write `(name := value, …)`"),
        );
        return;
    };
    for (index, (name, value)) in fields.into_iter().enumerate() {
        let member = match &name {
            Some(name) => members.iter_mut().find(|member| member.name.eq_ignore_ascii_case(&name.text)),
            None => members.get_mut(index),
        };
        match member {
            Some(member) => member.initial = Some(value),
            None => state.report(
                Diagnostic::new(
                    Code::UnknownMember,
                    name.map_or(value.span, |name| name.span),
                    "the structure does not have this component",
                )
                .label("not declared above")
                .help("name a component of the structure, or omit the value"),
            ),
        }
    }
}

fn header(state: &State, parts: Vec<HeaderPart>, range: Range<usize>) -> Header {
    frame::header(state.comment_lines(range), parts)
}

/// The variables of one declaration; the comment after it belongs to each variable.
pub fn variables(
    state: &State,
    names: Vec<DeclaredName>,
    at: Option<Name>,
    ty: TypeRef,
    initial: Option<InitialValue>,
    end: usize,
) -> Vec<Variable> {
    let comment = state.comment_after(end);
    let at = at.map(|name| (name.text, name.span));
    names
        .into_iter()
        .map(|declared| Variable {
            name: declared.name.text,
            name_span: declared.name.span,
            attributes: declared.attributes,
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
    let mut found = Vec::new();
    for (start, token, end) in &state.tokens[first..] {
        let name = match token {
            Tok::Name(name) | Tok::Local(name) | Tok::Quoted(name) => name,
            Tok::Comma => continue,
            _ => break,
        };
        if *end > range.end || found.last().is_some_and(|(_, after)| !state.text[*after..*start].contains(',')) {
            break;
        }
        found.push((
            DeclaredName { name: state.name(name, NameForm::Bare, *start..*end), attributes: Vec::new() },
            *end,
        ));
    }
    let names = found.into_iter().map(|(name, _)| name).collect();
    let ty = TypeRef { kind: TypeKind::Error, span: state.span(range.clone()) };
    variables(state, names, None, ty, None, range.end)
}

/// `INT`, `"Motor"`, `_.TankUdt`, `Unit.Motor`.
pub fn named_type(state: &State, names: Vec<Name>, range: Range<usize>) -> TypeKind {
    let span = state.span(range);
    match names.as_slice() {
        [Name { text, form: NameForm::Bare, .. }] => TypeKind::Named(text.to_uppercase()),
        names => {
            // `_` is the namespace of the project.
            let own = names.iter().skip_while(|name| name.text == "_");
            let name = own.map(|name| name.text.as_str()).collect::<Vec<_>>().join(".");
            TypeKind::Block(BlockName::Symbol { name, span })
        }
    }
}

pub fn array(state: &mut State, dimensions: Vec<Dimension>, element: TypeRef, range: Range<usize>) -> TypeKind {
    let element = Box::new(element);
    let count = dimensions.len();
    let bounds: Vec<(Bound, Bound)> = dimensions
        .into_iter()
        .filter_map(|dimension| match dimension {
            Dimension::Open => None,
            Dimension::Bounds(low, high) => Some((low, high)),
        })
        .collect();
    if bounds.is_empty() {
        return TypeKind::OpenArray { dimensions: count.min(255) as u8, element };
    }
    if bounds.len() < count {
        let span = state.span(range.clone());
        state.report(
            Diagnostic::new(Code::DeclarationSyntax, span, "an array has bounds in all of its dimensions, or in none")
                .label("some dimensions are `*`")
                .help("write `*` for each dimension, or bounds for each"),
        );
    }
    TypeKind::Array { bounds, element }
}

/// A bound or length: a number is kept as it is, anything else is an expression.
pub fn bound(value: Expr) -> Bound {
    let span = value.span;
    match value.kind {
        ExprKind::Literal(Literal::Integer { value, .. }) if value <= i64::MAX as u64 => {
            Bound::Number(value as i64, span)
        }
        ExprKind::Unary { op: super::ast::UnaryOp::Minus, operand } => match operand.kind {
            ExprKind::Literal(Literal::Integer { value, .. }) if value <= i64::MAX as u64 => {
                Bound::Number(-(value as i64), span)
            }
            _ => {
                let kind = ExprKind::Unary { op: super::ast::UnaryOp::Minus, operand };
                Bound::Expr(Box::new(Expr { kind, span }))
            }
        },
        ExprKind::Name(name) if name.form != NameForm::Local => Bound::Name(name.text, span),
        kind => Bound::Expr(Box::new(Expr { kind, span })),
    }
}

/// One value is kept as it is, several become a list.
pub fn initial_list(state: &mut State, mut values: Vec<InitialValue>, range: Range<usize>) -> InitialValue {
    if matches!(values.as_slice(), [InitialValue { kind: InitialKind::Default, .. }]) {
        let span = state.span(range.clone());
        state.report(
            Diagnostic::new(Code::DeclarationSyntax, span, "the value is missing after `:=`")
                .label("a constant is expected here")
                .help("write a constant, or omit `:=`"),
        );
    }
    match values.pop() {
        Some(value) if values.is_empty() => value,
        last => {
            values.extend(last);
            InitialValue { kind: InitialKind::List(values), span: state.span(range) }
        }
    }
}

/// `6 (0)`, `3 (1, 2)`.
pub fn repeated(state: &mut State, count: Literal, values: Vec<InitialValue>, range: Range<usize>) -> InitialKind {
    let span = state.span(range);
    let count = match count {
        Literal::Integer { value: count @ 1..=65_536, .. } => count as i64,
        Literal::Typed { ty, bits: bits @ 1..=65_536 } if ty.is_integer() => bits as i64,
        _ => {
            state.report(
                Diagnostic::new(Code::DeclarationSyntax, span, "the repetition factor is not a number of elements")
                    .label("the number before `(` is how often the values are repeated")
                    .help("write e.g. `6 (0)`: a whole number from 1 to 65536 before the parenthesis"),
            );
            1
        }
    };
    InitialKind::Repeat { count: Bound::Number(count, span), values }
}

/// `a.b[3] := 5` after BEGIN of a data block.
pub fn value_assignment(
    state: &mut State,
    target: Expr,
    value: InitialValue,
    range: Range<usize>,
) -> Option<ValueAssignment> {
    let span = target.span;
    let mut parts = Vec::new();
    let mut node = target;
    let root = loop {
        match node.kind {
            ExprKind::Name(name) => break PathRoot::Local { name: name.text, span: name.span },
            ExprKind::Member { base, name } => {
                parts.push(PathPart::Member { name: name.text, span: name.span });
                node = *base;
            }
            ExprKind::Index { base, indices } => {
                let span = node.span;
                parts.push(PathPart::Index { values: indices.into_iter().map(bound).collect(), span });
                node = *base;
            }
            ExprKind::Error => return None,
            _ => {
                state.report(
                    Diagnostic::new(
                        Code::Syntax,
                        node.span,
                        "only a component of the data block can have a value here",
                    )
                    .label("not a component")
                    .help("write e.g. `a.b[3] := 5;`"),
                );
                return None;
            }
        }
    };
    parts.reverse();
    Some(ValueAssignment { target: Path { root, parts, span }, value, span: state.span(range) })
}
