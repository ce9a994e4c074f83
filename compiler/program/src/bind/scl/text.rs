//! Texts and dates: CONCAT of many, and conversions to and from types that are not single values. Each is a call of a block of the
//! standard library; `overload` selects it where several have one name. Source: SCL reference, strings, conversions.

mod overload;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::scl::ast::{Argument as Given, Expr as Node, ExprKind as NodeKind, Literal, NameForm};
use plcc_syntax::{Class, Elementary};

use super::callee::library_block;
use super::compare::number_type;
use super::numeric::Shape;
use super::pins::Pins;
use super::reference::{argument, bare};
use super::value::Value;
use super::{Intent, Rules, convert};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::scl::{Actual, Argument, Call, Complex, Expr};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction};

pub use overload::{for_long_texts, is_long_text, is_wide_text};

/// Types of several bytes in names of conversions.
const WORDS: [&str; 5] = ["STRING", "WSTRING", "DT", "DATE_AND_TIME", "DTL"];

/// Blocks of STEP 7 V5 that convert under names of their own.
const CLASSIC: &[(&str, &str)] = &[
    ("INT_TO_STRING", "I_STRNG"),
    ("DINT_TO_STRING", "DI_STRNG"),
    ("REAL_TO_STRING", "R_STRNG"),
    ("STRING_TO_INT", "STRNG_I"),
    ("STRING_TO_DINT", "STRNG_DI"),
    ("STRING_TO_REAL", "STRNG_R"),
    ("DT_TO_DATE", "DT_DATE"),
    ("DT_TO_TOD", "DT_TOD"),
    ("STRING_TO_CHAR", "STRING_TO_CHAR_V5"),
];

/// True of `X_TO_Y` (upper case) where one of the types is not a single value.
pub fn is_conversion(name: &str) -> bool {
    if let Some(to) = name.strip_prefix("*_TO_") {
        return WORDS.contains(&to);
    }
    let known = |word: &str| WORDS.contains(&word) || Elementary::from_word(word).is_some();
    name.split_once("_TO_")
        .is_some_and(|(from, to)| known(from) && known(to) && (WORDS.contains(&from) || WORDS.contains(&to)))
}

/// The names of conversions of texts and of dates of several bytes, with the type of what they convert. Texts of bit strings are not
/// proposed, and of STEP 7 V5 only the conversions that it has a block for.
pub fn conversions(rules: Rules) -> Vec<(String, &'static str)> {
    if rules == Rules::Classic {
        let classic = CLASSIC.iter().chain(&[("CHAR_TO_STRING", "")]);
        return classic.map(|(name, _)| ((*name).to_string(), name.split("_TO_").next().unwrap_or_default())).collect();
    }
    let is_known = |ty: &Elementary| !rules.is_300() || convert::on_300(*ty);
    let elementary = Elementary::ALL.into_iter().filter(|ty| ty.class() != Class::Bits && is_known(ty));
    let several = WORDS.into_iter().filter(|word| *word != "DATE_AND_TIME");
    let several = several.filter(|word| !rules.is_300() || matches!(*word, "STRING" | "DT"));
    let words: Vec<&'static str> = elementary.map(|ty| short(ty.name())).chain(several).collect();
    let pairs = words.iter().flat_map(|from| words.iter().map(move |to| (*from, *to)));
    let own = pairs.filter(|(from, to)| from != to && (WORDS.contains(from) || WORDS.contains(to)));
    let is_letter = |from: &str, to: &str| matches!((from, to), ("CHAR", "STRING") | ("WCHAR", "WSTRING"));
    own.filter(|(from, to)| is_letter(from, to) || has_conversion(rules, from, to))
        .map(|(from, to)| (format!("{from}_TO_{to}"), from))
        .collect()
}

/// Whether [`SclBinder::converted_text`] finds blocks for a conversion.
fn has_conversion(rules: Rules, from: &str, to: &str) -> bool {
    let find = |name: &str| library_block(rules, name);
    let is_block = |from: &str, to: &str| block_of_conversion(rules, from, to, find).is_some();
    let through = |word: &str, is_block: &dyn Fn(&str) -> bool| {
        let widths = std::iter::successors(Elementary::from_word(word), |ty| wider(*ty));
        widths.skip(1).any(|ty| is_block(ty.name()))
    };
    match (from, to) {
        _ if is_block(from, to) => true,
        _ if through(from, &|from: &str| is_block(from, to)) || through(to, &|to: &str| is_block(from, to)) => true,
        (from, "WSTRING") if from != "STRING" => has_conversion(rules, from, "STRING"),
        ("WSTRING", to) if to != "STRING" => has_conversion(rules, "STRING", to),
        _ => false,
    }
}

/// What `find` has for the name of the block that converts. The TIA Portal has other rules for the form of a text.
fn block_of_conversion<T>(rules: Rules, from: &str, to: &str, find: impl Fn(&str) -> Option<T>) -> Option<T> {
    let name = format!("{from}_TO_{to}");
    let classic = CLASSIC.iter().find(|(known, _)| *known == name).map(|(_, block)| *block);
    let own = || find(&name);
    let old = || find(classic?);
    if rules == Rules::Classic { old().or_else(own) } else { own().or_else(old) }
}

/// A type's name in names of conversions, shortened.
pub fn short(word: &str) -> &str {
    match word {
        "DATE_AND_TIME" => "DT",
        "TIME_OF_DAY" => "TOD",
        "LTIME_OF_DAY" => "LTOD",
        "DATE_AND_LTIME" | "LDATE_AND_TIME" => "LDT",
        other => other,
    }
}

/// True of a STRING and of a text constant for one.
pub fn is_narrow_text(value: &Value) -> bool {
    let is_string = matches!(value, Value::Complex { ty: DataType::String(_), .. });
    is_string || matches!(value, Value::Constant(Constant::Text { .. }, _))
}

/// How a number that is written as `text` becomes a text: `'5'`, `INT_TO_STRING(#i)`. `None`: it is not a number.
pub fn number_as_text(value: &Value, text: &str) -> Option<String> {
    let ty = number_type(value)?;
    let is_literal = matches!(value, Value::Constant(..)) && text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    Some(match is_literal {
        true => format!("'{text}'"),
        false => format!("{}_TO_STRING({text})", ty.name()),
    })
}

/// The type of the value in the name of a conversion: `TO_STRING`.
pub const ANY_TYPE: &str = "*";

/// The type of a value, as in names of conversions.
pub fn type_word(value: &Value) -> Option<String> {
    let word = match value {
        Value::Elementary(expr) => short(expr.ty.name()),
        Value::Constant(Constant::Typed { ty, .. }, _) => short(ty.name()),
        Value::Constant(Constant::Integer { .. }, _) => "DINT",
        Value::Constant(Constant::Real(_), _) => "REAL",
        Value::Constant(Constant::DateAndTime(_), _) => "DT",
        Value::Constant(Constant::Dtl(_), _) => "DTL",
        Value::Complex { ty, .. } => return type_word_of(ty),
        value if is_wide_text(value) => "WSTRING",
        Value::Constant(Constant::Text { .. }, _) => "STRING",
        _ => return None,
    };
    Some(word.to_string())
}

/// The type of a text or a date that is not a single value, as in names of conversions.
pub fn several_bytes(value: &Value) -> Option<String> {
    let is_single = matches!(Shape::of(value), Shape::Letter | Shape::Of(_));
    type_word(value).filter(|word| !is_single && WORDS.contains(&word.as_str()))
}

/// Like [`type_word`], for a type.
pub fn type_word_of(ty: &DataType) -> Option<String> {
    let word = match ty {
        DataType::Elementary(ty) => short(ty.name()),
        DataType::DateAndTime => "DT",
        DataType::String(_) => "STRING",
        DataType::WideString(_) => "WSTRING",
        DataType::Struct(structure) if super::complex::is_dtl(structure) => "DTL",
        _ => return None,
    };
    Some(word.to_string())
}

/// The integer type whose texts can hold those of `ty`.
const fn wider(ty: Elementary) -> Option<Elementary> {
    match ty {
        Elementary::Sint | Elementary::Usint | Elementary::Byte => Some(Elementary::Int),
        Elementary::Int | Elementary::Uint | Elementary::Word => Some(Elementary::Dint),
        Elementary::Dint | Elementary::Udint | Elementary::Dword => Some(Elementary::Lint),
        Elementary::Lword => Some(Elementary::Ulint),
        _ => None,
    }
}

impl SclBinder<'_, '_> {
    /// `INT_TO_STRING`, `STRING_TO_REAL`, `DTL_TO_DATE`.
    pub fn text_conversion(
        &mut self,
        ctx: &mut SclBlock,
        function: &str,
        given: &[Given],
        name: Span,
        span: Span,
    ) -> Option<Value> {
        let node = self.only_argument(ctx, given, span)?;
        let (from, to) = function.split_once("_TO_")?;
        let (from, to) = (short(from), short(to));
        match (from, to) {
            ("CHAR", "STRING") | ("WCHAR", "WSTRING") => {
                let wide = from == "WCHAR";
                let value = self.of_type(ctx, node, if wide { Elementary::Wchar } else { Elementary::Char })?;
                let ty = if wide { DataType::WideString(1) } else { DataType::String(1) };
                return Some(Value::Complex { value: Complex::Character(Box::new(value)), ty, span });
            }
            _ => {}
        }
        self.check_digits(ctx, node, to);
        let value = self.value(ctx, node)?;
        let own = type_word(&value);
        let from = if from == ANY_TYPE { own.as_deref().unwrap_or_default() } else { from };
        match self.converted_text(ctx, from, to, value, name, span) {
            Ok(value) => value,
            Err(_) => {
                let function = function.trim_start_matches(ANY_TYPE).trim_start_matches('_');
                self.program.globals.report.missing_function(function, name, None, true);
                None
            }
        }
    }

    /// A value of type `from` as `to`, both as in names of conversions; `Err`: there is no such conversion.
    #[allow(clippy::result_large_err, reason = "the caller gets the value back")]
    pub(super) fn converted_text(
        &mut self,
        ctx: &mut SclBlock,
        from: &str,
        to: &str,
        value: Value,
        name: Span,
        span: Span,
    ) -> Result<Option<Value>, Value> {
        if let Some(key) = self.conversion_block(ctx, from, to) {
            return Ok(self.library_call(ctx, key, vec![value], name, span));
        }
        // Through a type that can hold all values.
        if let Some(own) = Elementary::from_word(from)
            && let Some((through, key)) = self.wider_block(ctx, own, |word| (word.to_string(), to.to_string()))
        {
            let Some(value) = self.convert(ctx, value, own) else { return Ok(None) };
            let Some(value) = convert::explicit_expr(ctx.scope.rules, value, through) else { return Ok(None) };
            return Ok(self.library_call(ctx, key, vec![Value::Elementary(value)], name, span));
        }
        if let Some(own) = Elementary::from_word(to)
            && let Some((_, key)) = self.wider_block(ctx, own, |word| (from.to_string(), word.to_string()))
        {
            let Some(Value::Elementary(value)) = self.library_call(ctx, key, vec![value], name, span) else {
                return Ok(None);
            };
            let value = convert::explicit_expr(ctx.scope.rules, value, own);
            return Ok(value.map(|value| Value::Elementary(Expr { span, ..value })));
        }
        // Texts of wide characters, through those of narrow ones.
        if to == "WSTRING" && from != "STRING" {
            let text = self.converted_text(ctx, from, "STRING", value, name, span)?;
            return Ok(text.and_then(|text| self.instruction_value(ctx, "STRING_TO_WSTRING", vec![text], span)));
        }
        if from == "WSTRING" && to != "STRING" {
            let Some(text) = self.instruction_value(ctx, "WSTRING_TO_STRING", vec![value], span) else {
                return Ok(None);
            };
            return self.converted_text(ctx, "STRING", to, text, name, span);
        }
        Err(value)
    }

    fn conversion_block(&self, ctx: &SclBlock, from: &str, to: &str) -> Option<BlockKey> {
        let rules = ctx.scope.rules;
        block_of_conversion(rules, from, to, |name| self.library_function(rules, name))
    }

    fn wider_block(
        &self,
        ctx: &SclBlock,
        ty: Elementary,
        names: impl Fn(&str) -> (String, String),
    ) -> Option<(Elementary, BlockKey)> {
        let mut ty = ty;
        while let Some(next) = wider(ty) {
            let (from, to) = names(next.name());
            if let Some(key) = self.conversion_block(ctx, &from, &to) {
                return Some((next, key));
            }
            ty = next;
        }
        None
    }

    /// `TABLE[i]` of a constant text, which is not in memory, as the call that gives this character; `None`: something else.
    pub(super) fn constant_character(&self, ctx: &SclBlock, node: &Node) -> Option<Node> {
        let NodeKind::Index { base, indices } = &node.kind else { return None };
        let (NodeKind::Name(name), [index]) = (&base.kind, indices.as_slice()) else { return None };
        if name.form == NameForm::Quoted || self.program.local(ctx.block, &name.text).is_some() {
            return None;
        }
        let conversion = match ctx.block.bound.constants.get(&fold(&name.text))? {
            Constant::Text { .. } => "STRING_TO_CHAR",
            Constant::WideText(_) => "WSTRING_TO_WCHAR",
            _ => return None,
        };
        let span = node.span;
        let call = |name: &str, arguments: Vec<Given>| {
            let callee = Box::new(Node { kind: NodeKind::Name(bare(name, span)), span });
            Node { kind: NodeKind::Call { callee, arguments }, span }
        };
        let one = Node { kind: NodeKind::Literal(Literal::Typed { ty: Elementary::Int, bits: 1 }), span };
        let text = (**base).clone();
        let part = call("MID", vec![argument("IN", text), argument("L", one), argument("P", index.clone())]);
        Some(call(conversion, vec![argument("IN", part)]))
    }

    pub(super) fn quiet_value(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Value> {
        self.quietly(ctx, |binder, ctx| binder.value(ctx, node))
    }

    /// The answer of `look`, which binds something that is bound again where its mistakes are reported.
    pub fn quietly<T>(&mut self, ctx: &mut SclBlock, look: impl FnOnce(&mut Self, &mut SclBlock) -> T) -> T {
        let (told, reads) = (self.program.globals.report.diagnostics.len(), ctx.scope.temp_reads.len());
        // Each unknown name is reported once: those that are found now are not reported yet.
        let unknown = std::mem::take(&mut ctx.block.unknown_locals);
        let found = look(self, ctx);
        ctx.block.unknown_locals = unknown;
        self.program.globals.report.diagnostics.truncate(told);
        ctx.scope.temp_reads.truncate(reads);
        found
    }

    /// CONCAT of two or more texts.
    pub fn concat(&mut self, ctx: &mut SclBlock, pins: &Pins, name: Span, span: Span) -> Option<Value> {
        let nodes = pins.numbered("IN1");
        if nodes.len() < 2 {
            self.program.report(
                Diagnostic::new(Code::MissingParameter, name, "CONCAT joins two texts or more")
                    .label("one is given")
                    .help("add `IN2 := ...`"),
            );
            return None;
        }
        let part = |node: &Node| match self.is_text_in_name_quotes(ctx, node) {
            true => None,
            false => self.value(ctx, node),
        };
        let values: Vec<Option<Value>> = nodes.into_iter().map(part).collect();
        let values: Vec<Value> = values.into_iter().collect::<Option<_>>()?;
        let is_wide = values.iter().any(|value| match value {
            Value::Elementary(expr) => expr.ty == Elementary::Wchar,
            other => is_wide_text(other),
        });
        let block = match is_wide {
            true if ctx.scope.long_texts || values.iter().any(is_long_text) => "CONCAT_LONG_WSTRING",
            true => "CONCAT_WSTRING",
            false => "CONCAT",
        };
        let Some(key) = self.library_function(ctx.scope.rules, block) else {
            self.program.globals.report.missing_function(block, name, None, true);
            return None;
        };
        let mut values = values.into_iter();
        let mut joined = values.next()?;
        for value in values {
            joined = self.library_call(ctx, key, vec![joined, value], name, span)?;
            if let Value::Complex { value: Complex::Call(call), .. } = &mut joined {
                call.is_operation = false;
            }
        }
        if let (Some(eno), Value::Complex { value: Complex::Call(call), .. }) = (pins.eno, &mut joined) {
            call.eno = Some(self.variable_of_type(ctx, eno, Elementary::Bool, Intent::Write)?);
        }
        Some(joined)
    }

    /// A call of a library function with bound arguments in its order.
    pub fn library_call(
        &mut self,
        ctx: &mut SclBlock,
        key: BlockKey,
        values: Vec<Value>,
        name: Span,
        span: Span,
    ) -> Option<Value> {
        let bound = self.program.interface(key, name)?;
        let inputs = bound.interface.parameters.iter().enumerate();
        let inputs = inputs.filter(|(_, formal)| formal.direction == Direction::Input);
        let mut arguments = Vec::with_capacity(values.len());
        for ((parameter, formal), value) in inputs.zip(values) {
            let span = value.span();
            let actual = match &formal.ty {
                DataType::Elementary(ty) => Actual::Value(self.convert(ctx, value, *ty)?),
                ty => Actual::Complex(self.complex_value(ctx, value, ty)?),
            };
            arguments.push(Argument { parameter, actual, span });
        }
        let call = Call { target: key, instance: None, arguments, enable: None, eno: None, is_operation: true, span };
        self.call_value(call, false, name)
    }
}
