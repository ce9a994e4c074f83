//! Expressions of SCL as text, with as few parentheses as they need.

use plcc_diag::Span;
use plcc_syntax::ast::{BlockName, OperandKind, Width};
use plcc_syntax::scl::ast::{Argument, Expr, ExprKind, Literal, Name, NameForm, UNARY, UnaryOp};
use plcc_syntax::stl::Mnemonics;

use crate::writer::{Notation, Writer};
use crate::{literal, names, operand};

/// An expression.
pub(crate) fn text(value: &Expr, writer: &mut Writer) -> String {
    written(value, 0, writer)
}

/// Of NOT in charts.
const GRAPH_NOT: u8 = 4;

/// An expression where something binds with `around`: in parentheses if it binds less.
fn written(value: &Expr, around: u8, writer: &mut Writer) -> String {
    match &value.kind {
        ExprKind::Literal(constant) => constant_text(constant, value.span, writer),
        ExprKind::Name(name) if writer.notation == Notation::Gr7 && name.form == NameForm::Bare => name.text.clone(),
        // `#"END"`, as the author wrote it; exports have no quotes.
        ExprKind::Name(name)
            if name.form == NameForm::Local
                && (writer.is_quoted(&name.text, name.span) || needs_quotes(&name.text, writer)) =>
        {
            format!("#{}", names::symbol(&name.text))
        }
        ExprKind::Name(name) => name_text(name),
        ExprKind::Absolute(kind) => absolute(kind, value.span, writer),
        ExprKind::Member { base, name } => format!("{}.{}", written(base, u8::MAX, writer), member(name, writer)),
        ExprKind::MemberAbsolute { base, width, byte, bit } => {
            // `.DW4` of classic sources, `.%DBW4`: as the author wrote it.
            let own = base.span.end as usize..value.span.end as usize;
            let own = writer.source.and_then(|source| source.get(own)).filter(|text| !text.is_empty());
            let base = written(base, u8::MAX, writer);
            if let Some(own) = own.filter(|own| writer.notation != Notation::Gr7 || !own.contains('%')) {
                return format!("{base}{}", own.split_whitespace().collect::<String>());
            }
            let bit = if *width == Width::Bit { format!(".{bit}") } else { String::new() };
            let sign = if writer.notation == Notation::Gr7 { "" } else { "%" };
            format!("{base}.{sign}DB{}{byte}{bit}", width.letter())
        }
        ExprKind::Slice { .. } | ExprKind::Dereference(_) | ExprKind::Reference(_)
            if writer.notation == Notation::Gr7 =>
        {
            let help = "read the value in a block of another language";
            writer.refuse(value.span, "GRAPH sources have no slices and no references", help);
            String::new()
        }
        ExprKind::Slice { base, width, index } => {
            format!("{}.%{}{index}", written(base, u8::MAX, writer), width.letter())
        }
        ExprKind::Index { base, indices } => {
            let base = written(base, u8::MAX, writer);
            let indices: Vec<String> = indices.iter().map(|index| text(index, writer)).collect();
            format!("{base}[{}]", indices.join(", "))
        }
        ExprKind::Call { callee, arguments } => {
            let callee = written(callee, u8::MAX, writer);
            let arguments: Vec<String> = arguments.iter().map(|one| argument(one, writer)).collect();
            format!("{callee}({})", arguments.join(", "))
        }
        ExprKind::Dereference(base) => format!("{}^", written(base, u8::MAX, writer)),
        ExprKind::Reference(target) => format!("REF({})", text(target, writer)),
        ExprKind::Unary { op, operand } => {
            let inner = written(operand, UNARY, writer);
            let inner = if inner.starts_with(['+', '-']) { format!("({inner})") } else { inner };
            let text = match op {
                UnaryOp::Plus => format!("+{inner}"),
                UnaryOp::Minus => format!("-{inner}"),
                UnaryOp::Not => format!("NOT {inner}"),
            };
            // Of GRAPH, it inverts the comparison after it.
            if *op == UnaryOp::Not && writer.notation == Notation::Gr7 {
                return if around > GRAPH_NOT { format!("({text})") } else { text };
            }
            // A sign stands directly after an operator only where its author put it there.
            let is_closed = around >= UNARY || *op != UnaryOp::Not;
            let is_bare = *op != UnaryOp::Not && around <= UNARY && has_bare_sign(value.span, writer);
            if around > 0 && is_closed && !is_bare { format!("({text})") } else { text }
        }
        ExprKind::Binary { op, left, right, .. } => {
            let own = op.precedence();
            let left = written(left, own, writer);
            let right = written(right, own + 1, writer);
            let text = format!("{left} {} {right}", op.sign());
            if own < around { format!("({text})") } else { text }
        }
        ExprKind::Error => {
            writer.refuse(value.span, "an expression that was not understood", "repair the source first");
            String::new()
        }
    }
}

pub(crate) fn argument(argument: &Argument, writer: &mut Writer) -> String {
    let value = argument.value.as_ref().map_or(String::new(), |value| text(value, writer));
    match &argument.name {
        Some(name) => {
            let sign = if argument.output { "=>" } else { ":=" };
            format!("{} {sign} {value}", member(name, writer)).trim_end().to_string()
        }
        None => value,
    }
}

pub(crate) fn name_text(name: &Name) -> String {
    match name.form {
        NameForm::Bare => names::bare(&name.text),
        NameForm::Local => names::local(&name.text),
        NameForm::Quoted => with_periphery(&name.text, names::symbol),
    }
}

/// A name of an input or output itself: `"tag":P`, `"tag".component:P`.
fn with_periphery(name: &str, written: fn(&str) -> String) -> String {
    match names::without_periphery(name) {
        Some(name) => format!("{}:P", written(name)),
        None => written(name),
    }
}

fn member(name: &Name, writer: &Writer) -> String {
    match name.form {
        NameForm::Quoted => with_periphery(&name.text, names::symbol),
        NameForm::Bare | NameForm::Local if needs_quotes(&name.text, writer) => names::symbol(&name.text),
        NameForm::Bare | NameForm::Local => with_periphery(&name.text, names::declared),
    }
}

/// Whether a name of an export is a word of the language.
fn needs_quotes(name: &str, writer: &Writer) -> bool {
    writer.quotes_words && names::is_word(name)
}

/// Whether a sign stands in a source in SCL, or in a network in SCL, without a parenthesis before it: `a - -5`.
fn has_bare_sign(span: Span, writer: &Writer) -> bool {
    let source = writer.source.filter(|_| matches!(writer.notation, Notation::Scl | Notation::Sd));
    let parts = source.and_then(|source| source.get(..span.start as usize).zip(source.get(span.range())));
    parts.is_some_and(|(before, own)| own.starts_with(['+', '-']) && !before.trim_end().ends_with('('))
}

/// `%MW10`, as the author wrote it where the notation is the same.
fn absolute(kind: &OperandKind, span: Span, writer: &mut Writer) -> String {
    if let (Notation::St, OperandKind::Absolute { area, width, byte, bit }) = (writer.notation, kind) {
        return crate::plcopen::address(*area, *width, *byte, *bit);
    }
    // S7-GRAPH writes addresses without `%`.
    let is_foreign = |text: &&str| writer.notation == Notation::Gr7 && text.starts_with('%');
    let own = writer.source.and_then(|source| source.get(span.range())).filter(|text| !text.is_empty());
    if let Some(text) = own.filter(|text| !is_foreign(text)) {
        return text.split_whitespace().collect();
    }
    let set = writer.mnemonics;
    writer.mnemonics = Mnemonics::En;
    let text = match kind {
        OperandKind::Block(BlockName::Numbered { prefix, number, .. }) => {
            format!("{}{number}", operand::prefix_letters(*prefix))
        }
        kind => operand::text(kind, span, writer).replace(' ', ""),
    };
    writer.mnemonics = set;
    if writer.notation == Notation::Gr7 { text } else { format!("%{text}") }
}

fn constant_text(value: &Literal, span: Span, writer: &mut Writer) -> String {
    if let Some(text) = writer.source.and_then(|source| source.get(span.range())).filter(|text| !text.is_empty()) {
        return text.trim().to_string();
    }
    match value {
        Literal::Integer { value, based: false } => value.to_string(),
        Literal::Integer { value, based: true } => format!("16#{value:X}"),
        Literal::Real(value) => literal::real(*value, &format!("{value:?}")),
        Literal::Typed { ty, bits } => literal::typed(*ty, *bits),
        Literal::Text { bytes, typed } => format!("{}{}", if *typed { "STRING#" } else { "" }, literal::text(bytes)),
        Literal::WideText(units) => format!("WSTRING#{}", literal::wide_text(units)),
        Literal::DateAndTime(bytes) => literal::date_and_time(bytes),
        Literal::Dtl(bytes) => literal::dtl(bytes),
        Literal::Pointer { db, pointer } => format!("P#{}", literal::area_address(*db, *pointer, Mnemonics::En)),
        Literal::Any(bytes) => literal::any(bytes, Mnemonics::En),
        Literal::Nil => "NIL".to_string(),
        Literal::Null => "NULL".to_string(),
    }
}
