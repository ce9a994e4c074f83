//! Texts, structures, arrays and dates in the required type, as assignments and calls copy them.

use plcc_binding::constant::Constant;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::Complex;
use plcc_model::types::{DataType, ParameterType, StructType};
use plcc_model::{Number, layout};
use plcc_syntax::ast::BlockPrefix;
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, NameForm};
use plcc_syntax::{Class, Elementary};

use super::place::Spot;
use super::text::{is_narrow_text, number_as_text};
use super::value::Value;
use super::{Rules, constant, message};
use crate::bind::scl::{SclBinder, SclBlock};

/// The type of a VARIANT as the result of a function of the library.
const VARIANT_DATA: &str = "VARIANT_DATA";

/// Longest STRING.
const STRING_MAX: usize = 254;

impl SclBinder<'_, '_> {
    /// Binds an expression whose value must have the complex type `ty` (a text may have another length).
    pub(super) fn complex(&mut self, ctx: &mut SclBlock, node: &Node, ty: &DataType) -> Option<Complex> {
        if matches!(ty, DataType::String(_)) && self.is_text_in_name_quotes(ctx, node) {
            return None;
        }
        let value = self.value(ctx, node)?;
        self.complex_value(ctx, value, ty)
    }

    /// Reports `"hello"` where a text is expected, if nothing has that name.
    pub(super) fn is_text_in_name_quotes(&mut self, ctx: &SclBlock, node: &Node) -> bool {
        let NodeKind::Name(name) = &node.kind else { return false };
        if !self.is_undefined_in_quotes(ctx, node) {
            return false;
        }
        let title = format!("`\"{}\"` is an undefined name, not a text", name.text);
        let help = format!("a text is written in single quotes: `'{}'`", name.text);
        self.refuse(Code::UnknownSymbol, name.span, &title, "neither a symbol nor a variable", &help);
        true
    }

    /// Whether the node is a name in quotes that nothing has.
    pub(super) fn is_undefined_in_quotes(&self, ctx: &SclBlock, node: &Node) -> bool {
        let NodeKind::Name(name) = &node.kind else { return false };
        let folded = plcc_binding::fold(&name.text);
        let names = &self.program.globals.names;
        let mut parameters = ctx.block.bound.interface.parameters.iter();
        name.form == NameForm::Quoted
            && !self.program.globals.input.partial
            && !ctx.block.bound.locals.contains_key(&folded)
            && !names.symbols.contains_key(&folded)
            && !names.constants.contains_key(&folded)
            && !parameters.any(|parameter| plcc_binding::fold(&parameter.name) == folded)
    }

    /// Whether the node is a text, or names a STRING; mistakes in it are not reported.
    pub(super) fn is_text_operand(&mut self, ctx: &mut SclBlock, node: &Node) -> bool {
        // Nothing that has operators itself is bound for this, so that a chain of them is not bound repeatedly.
        is_simple(node) && self.quiet_value(ctx, node).as_ref().is_some_and(is_narrow_text)
    }

    /// Converts a bound value to the complex type `ty`; reports a value that cannot have it.
    pub(super) fn complex_value(&mut self, ctx: &mut SclBlock, value: Value, ty: &DataType) -> Option<Complex> {
        let span = value.span();
        let value = match self.date_as(ctx, value, ty) {
            Ok(value) => value?,
            Err(value) => value,
        };
        match (value, ty) {
            (_, DataType::Void) => None,
            // What DB_ANY_TO_VARIANT returns.
            (
                Value::Complex { value, ty: DataType::Struct(image), .. },
                DataType::Parameter(ParameterType::Variant),
            ) if image.name == VARIANT_DATA && image.bytes == layout::parameter_bytes(ParameterType::Variant) => {
                Some(value)
            }
            (Value::Complex { value, ty: from, .. }, _) => {
                if !assignable(ctx.scope.rules, ty, &from) {
                    let difference = first_difference(&from, ty);
                    let copied = copied(ctx.scope.rules, &self.program.globals.text(span), &from, ty);
                    let (from, wanted) = (layout::type_name(&from), layout::type_name(ty));
                    let help = match from == wanted {
                        true => difference.unwrap_or_else(|| "their components or bounds differ".to_string()),
                        false => copied.unwrap_or_else(|| match (from.as_str(), wanted.as_str()) {
                            ("DTL", "DATE_AND_TIME") => {
                                "STEP 7 V5 has no DTL: `D_TOD_DT(IN1 := …, IN2 := …)` joins a date and a time of day"
                                    .to_string()
                            }
                            _ => "name a variable of the same type, or assign the parts one by one".to_string(),
                        }),
                    };
                    self.wrong_type(span, &format!("of type {from}"), &wanted, Some(help));
                    return None;
                }
                Some(value)
            }
            (Value::Parameter { access, .. }, DataType::Parameter(_)) if access.ty == *ty => {
                Some(Complex::Variable(access))
            }
            (Value::Constant(constant, _), _) => self.complex_constant(constant, span, ty),
            // A data block as one variable with all its data.
            (Value::Block { prefix: BlockPrefix::Db, number: Number::Known(number), .. }, wanted)
                if matches!(wanted, DataType::Struct(_) | DataType::Array(_)) =>
            {
                let mut variable = self.whole_db(number, span)?;
                if let (DataType::Struct(structure), DataType::Array(_)) = (&variable.ty, wanted)
                    && let [only] = structure.members.as_slice()
                {
                    variable.ty = only.ty.clone();
                }
                let ty = variable.ty.clone();
                let value = Complex::Variable(Spot::fixed(variable).access(span));
                self.complex_value(ctx, Value::Complex { value, ty, span }, wanted)
            }
            (Value::Elementary(expr), DataType::String(_)) if expr.ty == Elementary::Char => {
                Some(Complex::Character(Box::new(expr)))
            }
            (Value::Elementary(expr), DataType::WideString(_)) if expr.ty == Elementary::Wchar => {
                Some(Complex::Character(Box::new(expr)))
            }
            (other, _) => {
                let help = match (&other, ty) {
                    (Value::Elementary(expr), DataType::String(_) | DataType::WideString(_))
                        if !matches!(expr.ty.class(), Class::Bits | Class::Character) =>
                    {
                        let wide = if matches!(ty, DataType::WideString(_)) { "W" } else { "" };
                        let text = self.program.globals.text(span);
                        let is_number = matches!(expr.ty.class(), Class::Signed | Class::Unsigned | Class::Float);
                        match ctx.scope.is_network() {
                            true => is_number.then(|| message::text_element(&text)),
                            false => Some(format!("convert it: `{}_TO_{wide}STRING({text})`", expr.ty.name())),
                        }
                    }
                    (Value::Elementary(_), DataType::Struct(structure)) => as_components(structure),
                    _ => None,
                };
                self.wrong_type(span, &message::described(&other), &layout::type_name(ty), help);
                None
            }
        }
    }

    /// DATE_AND_TIME, DTL and LDT convert to each other implicitly; `Err`: the value is another one, or already of that type.
    ///
    /// Source: S7-1500 information system, implicit conversion of dates.
    #[allow(clippy::result_large_err, reason = "the caller gets the value back")]
    fn date_as(&mut self, ctx: &mut SclBlock, value: Value, ty: &DataType) -> Result<Option<Value>, Value> {
        let to = match ty {
            DataType::DateAndTime => "DT",
            DataType::Struct(structure) if is_dtl(structure) => "DTL",
            _ => return Err(value),
        };
        let from = match super::text::type_word(&value) {
            Some(from) if matches!(from.as_str(), "DT" | "DTL" | "LDT") && from != to => from,
            _ => return Err(value),
        };
        if !converts_dates(ctx.scope.rules) {
            return Err(value);
        }
        let span = value.span();
        self.converted_text(ctx, &from, to, value, span, span)
    }

    fn complex_constant(&mut self, constant: Constant, span: Span, ty: &DataType) -> Option<Complex> {
        let bytes = match (&constant, ty) {
            (Constant::Text { bytes, .. }, DataType::String(_)) => text_bytes(bytes),
            (Constant::Typed { ty: Elementary::Char, bits }, DataType::String(_)) => text_bytes(&[*bits as u8]),
            (Constant::Text { bytes, .. }, DataType::WideString(_)) => Some(wide_bytes(&constant::wide(bytes))),
            (Constant::WideText(text), DataType::WideString(_)) => Some(wide_bytes(text)),
            (Constant::Typed { ty: Elementary::Wchar, bits }, DataType::WideString(_)) => {
                Some(wide_bytes(&[*bits as u16]))
            }
            (Constant::DateAndTime(bytes), DataType::DateAndTime) => Some(bytes.to_vec()),
            (Constant::Dtl(bytes), DataType::Struct(structure)) if is_dtl(structure) => Some(bytes.to_vec()),
            _ => {
                let text = self.program.globals.text(span);
                let value = Value::Constant(constant, span);
                let help = match ty {
                    DataType::String(_) => number_as_text(&value, &text).map(|text| format!("write `{text}`")),
                    DataType::Struct(structure) => as_components(structure),
                    _ => None,
                };
                self.wrong_type(span, &message::described(&value), &layout::type_name(ty), help);
                return None;
            }
        };
        if bytes.is_none() {
            self.refuse(
                Code::LiteralRange,
                span,
                "this text is too long",
                "a STRING can have up to 254 characters",
                "split it into two texts",
            );
        }
        if bytes.is_some() {
            self.cut_text(&constant, span, ty);
        }
        bytes.map(Complex::Const)
    }

    /// Warns of a text that its variable cuts off.
    fn cut_text(&mut self, constant: &Constant, span: Span, ty: &DataType) {
        let (name, room, wide) = match ty {
            DataType::String(room) => ("STRING", usize::from(*room), false),
            DataType::WideString(room) => ("WSTRING", usize::from(*room), true),
            _ => return,
        };
        let characters: Vec<u16> = match constant {
            Constant::Text { bytes, .. } if wide => constant::wide(bytes),
            Constant::Text { bytes, .. } => bytes.iter().map(|byte| u16::from(*byte)).collect(),
            Constant::WideText(text) => text.clone(),
            _ => return,
        };
        let count = characters.len();
        if count <= room {
            return;
        }
        let left = String::from_utf16_lossy(&characters[..room]);
        self.program.report(
            Diagnostic::new(Code::Narrowing, span, format!("a text of {count} characters does not fit {name}[{room}]"))
                .label(format!("the variable gets `'{left}'`"))
                .help(format!("declare it as {name}[{count}], or shorten the text")),
        );
    }
}

/// True where dates of different types become each other.
pub(super) fn converts_dates(rules: Rules) -> bool {
    rules != Rules::Classic
}

/// The predefined structure of date and time.
pub fn is_dtl(structure: &StructType) -> bool {
    structure.name.eq_ignore_ascii_case("DTL")
}

/// A text in memory, with its own length; an empty one has room for a character, because no STRING has the maximum 0. `None`: too
/// long.
fn text_bytes(text: &[u8]) -> Option<Vec<u8>> {
    match text {
        [] => Some(vec![1, 0, 0]),
        _ if text.len() > STRING_MAX => None,
        _ => Some([&[text.len() as u8, text.len() as u8], text].concat()),
    }
}

fn wide_bytes(text: &[u16]) -> Vec<u8> {
    let length = u16::try_from(text.len()).unwrap_or(u16::MAX);
    let room = text.is_empty().then_some(0);
    let words = [length.max(1), length].into_iter().chain(text.iter().copied().take(usize::from(length))).chain(room);
    words.flat_map(u16::to_be_bytes).collect()
}

/// A constant text, cut to the length that its parameter declares: a function refers to what it is given.
pub fn cut_constant(value: Complex, ty: &DataType) -> Complex {
    let Complex::Const(bytes) = value else { return value };
    let (head, end) = match ty {
        DataType::String(most) => (vec![*most, *most], 2 + usize::from(*most)),
        DataType::WideString(most) => ([*most, *most].map(u16::to_be_bytes).concat(), 4 + 2 * usize::from(*most)),
        _ => return Complex::Const(bytes),
    };
    // An empty text has room for a character.
    let is_longer = bytes.len() > end && bytes.len() > head.len() + head.len() / 2;
    if !is_longer {
        return Complex::Const(bytes);
    }
    let characters = &bytes[head.len()..end];
    Complex::Const([head.as_slice(), characters].concat())
}

/// Whether a variable of type `to` accepts one of type `from`. Source: SCL reference, ARRAY, STRUCT.
pub fn assignable(rules: Rules, to: &DataType, from: &DataType) -> bool {
    match (to, from) {
        (DataType::String(_), DataType::String(_)) | (DataType::WideString(_), DataType::WideString(_)) => true,
        (DataType::Array(to), DataType::Array(from)) if rules != Rules::Classic => {
            let counts = |bounds: &[(i32, i32)]| -> Vec<i64> {
                bounds.iter().map(|&(low, high)| i64::from(high) - i64::from(low)).collect()
            };
            counts(&to.bounds) == counts(&from.bounds) && layout::same_type(&to.element, &from.element)
        }
        // A named type fits one without a name, or itself.
        (DataType::Struct(a), DataType::Struct(b)) if rules != Rules::Classic => {
            let names = a.name.is_empty() || b.name.is_empty() || a.name == b.name;
            names && a.refers_to == b.refers_to && layout::same_type(to, from)
        }
        _ => layout::same_type(to, from),
    }
}

/// Bytes that a copy of a whole variable moves; a row of an array does not include its padding byte.
pub fn copied_bytes(ty: &DataType) -> u32 {
    match ty {
        DataType::Array(array) => {
            let count = layout::element_count(&array.bounds);
            match &array.element {
                DataType::Elementary(element) if element.bits() == 8 => count as u32,
                DataType::Elementary(Elementary::Bool) => match layout::element_place(array, count.saturating_sub(1)) {
                    (byte, _) if count > 0 => byte + 1,
                    _ => 0,
                },
                _ => array.bytes,
            }
        }
        other => layout::bytes(other),
    }
}

/// A literal, or a variable whose indices are literals and names.
fn is_simple(node: &Node) -> bool {
    let is_word = |node: &Node| matches!(node.kind, NodeKind::Literal(_) | NodeKind::Name(_));
    let mut inner = node;
    loop {
        match &inner.kind {
            NodeKind::Member { base, .. } => inner = base,
            NodeKind::Index { base, indices } if indices.iter().all(is_word) => inner = base,
            _ => return is_word(inner),
        }
    }
}

/// How a value of type `from`, which is written as `text`, comes into a variable of type `to` without an assignment.
fn copied(rules: Rules, text: &str, from: &DataType, to: &DataType) -> Option<String> {
    match (from, to) {
        (DataType::String(_), DataType::WideString(_)) => Some(format!("convert it: `STRING_TO_WSTRING({text})`")),
        (DataType::WideString(_), DataType::String(_)) => Some(format!("convert it: `WSTRING_TO_STRING({text})`")),
        (DataType::Array(from), DataType::Array(to)) if from.element == to.element && !rules.is_300() => {
            let ([(first, last)], [(low, high)]) = (from.bounds.as_slice(), to.bounds.as_slice()) else { return None };
            let length = |low: i32, high: i32| i64::from(high) - i64::from(low) + 1;
            let count = length(*first, *last).min(length(*low, *high));
            Some(format!("copy elements: `MOVE_BLK(IN := {text}[{first}], COUNT := {count}, OUT => …[{low}])`"))
        }
        _ => None,
    }
}

/// What to assign to a structure in place of a single value.
fn as_components(structure: &StructType) -> Option<String> {
    let is_plain = structure.instance_of.is_none() && structure.refers_to.is_none();
    is_plain.then(|| "assign its components one by one, or name a structure of the same type".to_string())
}

/// In which component two structures differ first, for a message.
fn first_difference(from: &DataType, wanted: &DataType) -> Option<String> {
    let (DataType::Struct(from), DataType::Struct(wanted)) = (from, wanted) else { return None };
    let pairs = from.members.iter().zip(&wanted.members);
    for (own, other) in pairs {
        if plcc_binding::fold(&own.name) != plcc_binding::fold(&other.name) {
            return Some(format!("the component `{}` is where `{}` is expected", own.name, other.name));
        }
        let (is, needed) = (layout::type_name(&own.ty), layout::type_name(&other.ty));
        if is != needed {
            return Some(format!("the component `{}` is of type {is}, but {needed} is expected", own.name));
        }
    }
    match (from.members.len(), wanted.members.len()) {
        (has, needs) if has < needs => Some(format!("it has no component `{}`", wanted.members[has].name)),
        (has, needs) if has > needs => Some(format!("its component `{}` has no place there", from.members[needs].name)),
        _ => None,
    }
}
