//! The parts of grammar actions that do more than build a plain node: blocks and declarations. Expressions and statements are in `expression`.

mod expression;

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

pub use expression::*;

use super::ast::{Body, Dialect, Expr, ExprKind, Literal, Name, NameForm, Statement};
use super::context::Context;
use super::token::CodeKeyword;
use crate::ast::{
    Block, BlockName, BlockPrefix, Bound, Code as BlockCode, CodeBlock, CodeKind, Constant, DataBlock, DataContent,
    Header, InitialKind, InitialValue, Path, PathPart, PathRoot, Section, SectionKind, TypeBlock, TypeKind, TypeRef,
    ValueAssignment, Variable,
};
use crate::frame::{self, HeaderPart};

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
    context: &mut Context,
    keyword: CodeKeyword,
    name: BlockName,
    return_type: Option<TypeRef>,
    parts: Vec<Part>,
    statements: Vec<Statement>,
    range: Range<usize>,
    begin: usize,
) -> Block {
    let (kind, wrong_letters) = frame::code_kind(keyword, &name, context.text);
    wrong_letters.into_iter().for_each(|message| context.report(message));
    let mut parts = sort(parts, begin);
    if kind != CodeKind::Fb && kind != CodeKind::Sfb {
        without_static(context, &mut parts.sections);
    }
    let header = header(context, parts.header, range.start..parts.header_end);
    let return_type = return_type.filter(|ty| ty.kind != TypeKind::Named("VOID".to_owned()));
    Block::Code(CodeBlock {
        kind,
        name,
        return_type,
        header,
        sections: parts.sections,
        constants: parts.constants,
        code: BlockCode::Scl(Body { dialect: context.dialect, labels: parts.labels, statements }),
        span: context.span(range.start, range.end),
    })
}

/// In blocks without an instance, VAR declares temporary variables: S7-SCL for S7-300/400, VAR in functions. The TIA Portal does not accept it.
fn without_static(context: &mut Context, sections: &mut [Section]) {
    for section in sections.iter_mut().filter(|section| section.kind == SectionKind::Static) {
        section.kind = SectionKind::Temp;
        if context.dialect == Dialect::Tia {
            let span = Span { end: section.span.start + "VAR".len() as u32, ..section.span };
            context.report(
                Diagnostic::new(Code::Tolerated, span, "this block has no static variables")
                    .label("read as VAR_TEMP")
                    .help("write `VAR_TEMP`; only a function block keeps values between calls"),
            );
        }
    }
}

pub fn implied_ob(context: &mut Context, statements: Vec<Statement>, range: Range<usize>) -> Block {
    let start = context.span(range.start, range.start);
    Block::Code(CodeBlock {
        kind: CodeKind::Ob,
        name: BlockName::Numbered { prefix: BlockPrefix::Ob, number: 1, span: start },
        return_type: None,
        header: Header::default(),
        sections: Vec::new(),
        constants: Vec::new(),
        code: BlockCode::Scl(Body { dialect: context.dialect, labels: Vec::new(), statements }),
        span: context.span(range.start, range.end),
    })
}

pub fn data_block(
    context: &mut Context,
    name: BlockName,
    parts: Vec<Part>,
    values: Option<Vec<Option<ValueAssignment>>>,
    range: Range<usize>,
) -> Block {
    check_letters(context, &name, "DATA_BLOCK", BlockPrefix::Db);
    let parts = sort(parts, range.end);
    let header = header(context, parts.header, range.start..parts.header_end);
    let members: Vec<Variable> = parts.sections.into_iter().flat_map(|section| section.variables).collect();
    let mut content = if members.is_empty() { DataContent::Empty } else { DataContent::Struct(members) };
    for (ty, value) in parts.contents {
        content = match ty.kind {
            TypeKind::Struct(mut members) => {
                spread(context, &mut members, value);
                DataContent::Struct(members)
            }
            TypeKind::Array { .. } | TypeKind::OpenArray { .. } => DataContent::Array(ty, value),
            _ => DataContent::OfType(ty),
        };
    }
    let values = values.into_iter().flatten().flatten().collect();
    Block::Data(DataBlock { name, header, content, values, span: context.span(range.start, range.end) })
}

pub fn type_block(context: &mut Context, name: BlockName, parts: Vec<Part>, range: Range<usize>) -> Block {
    check_letters(context, &name, "TYPE", BlockPrefix::Udt);
    let span = context.span(range.start, range.end);
    let mut parts = sort(parts, range.end);
    let header = header(context, parts.header, range.start..parts.header_end);
    let (members, alias) = match parts.contents.pop() {
        Some((TypeRef { kind: TypeKind::Struct(mut members), .. }, value)) => {
            spread(context, &mut members, value);
            (members, None)
        }
        Some((ty, value)) => {
            if let Some(value) = value {
                context.report(
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
            if !context
                .diagnostics
                .iter()
                .any(|diagnostic| span.range().contains(&(diagnostic.primary.span.start as usize)))
            {
                context.report(
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

fn check_letters(context: &mut Context, name: &BlockName, keyword: &str, wanted: BlockPrefix) {
    if let BlockName::Numbered { prefix, number, span } = name
        && *prefix != wanted
    {
        context.report(frame::wrong_letters(*span, keyword, wanted.letters(), *number, context.text));
    }
}

/// `END_STRUCT := (a := 1)` of a whole block: the values go to the components.
fn spread(context: &mut Context, members: &mut [Variable], value: Option<InitialValue>) {
    let Some(value) = value else { return };
    let InitialKind::Fields(fields) = value.kind else {
        context.report(
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
            None => context.report(
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

fn header(context: &Context, parts: Vec<HeaderPart>, range: Range<usize>) -> Header {
    frame::header(context.comment_lines(range), parts)
}

/// The variables of one declaration; the comment after it belongs to each variable.
pub fn variables(
    context: &Context,
    names: Vec<DeclaredName>,
    at: Option<Name>,
    ty: TypeRef,
    initial: Option<InitialValue>,
    end: usize,
) -> Vec<Variable> {
    let comment = context.comment_after(end);
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

/// `INT`, `"Motor"`, `_.TankUdt`, `Unit.Motor`.
pub fn named_type(context: &Context, names: Vec<Name>, range: Range<usize>) -> TypeKind {
    let span = context.span(range.start, range.end);
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

pub fn array(context: &mut Context, dimensions: Vec<Dimension>, element: TypeRef, range: Range<usize>) -> TypeKind {
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
        let span = context.span(range.start, range.end);
        context.report(
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
pub fn initial_list(context: &mut Context, mut values: Vec<InitialValue>, range: Range<usize>) -> InitialValue {
    if matches!(values.as_slice(), [InitialValue { kind: InitialKind::Default, .. }]) {
        let span = context.span(range.start, range.end);
        context.report(
            Diagnostic::new(Code::DeclarationSyntax, span, "the value is missing after `:=`")
                .label("a constant is expected here")
                .help("write a constant, or omit `:=`"),
        );
    }
    match values.pop() {
        Some(value) if values.is_empty() => value,
        last => {
            values.extend(last);
            InitialValue { kind: InitialKind::List(values), span: context.span(range.start, range.end) }
        }
    }
}

/// `6 (0)`, `3 (1, 2)`.
pub fn repeated(context: &mut Context, count: Literal, values: Vec<InitialValue>, range: Range<usize>) -> InitialKind {
    let span = context.span(range.start, range.end);
    let count = match count {
        Literal::Integer { value: count @ 1..=65_536, .. } => count as i64,
        Literal::Typed { ty, bits: bits @ 1..=65_536 } if ty.is_integer() => bits as i64,
        _ => {
            context.report(
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
    context: &mut Context,
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
                context.report(
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
    Some(ValueAssignment { target: Path { root, parts, span }, value, span: context.span(range.start, range.end) })
}
