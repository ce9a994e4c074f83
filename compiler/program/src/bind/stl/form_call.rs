//! `CALL T_ADD`, `CALL MOVE_BLK` and other instructions of the TIA Portal each of whose pins has the type of its actual parameter.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, Bound, OperandKind, Path, PathPart, PathRoot, Width};
use plcc_syntax::literal::Literal;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::path::type_of_width;
use crate::bind::globals::form::{Computation, Form, PinOfCall, PinType, index_name, relation};
use crate::bind::globals::sources::portal_cpu;
use crate::bind::stl::StlBinder;
use crate::bind::stl::move_call::called_name;
use crate::bind::stl::settle::Settled;
use plcc_binding::fold;
use plcc_model::layout;
use plcc_model::types::{DataType, Elementary};
use plcc_model::{Call, Direction};

/// What an actual parameter tells about the type of its pin. Types are as declarations write them.
enum Told {
    Type(String),
    /// An address.
    Width(Width),
    /// A constant whose notation has one type: `T#1S`.
    Constant(&'static str),
    /// A constant that fits several types, with the type that it has if nothing else tells one.
    Fitting(Option<&'static str>),
    Elements(Box<Elements>),
}

/// An element of an array, as the array and the index. Types are as declarations write them.
struct Elements {
    array: ast::Operand,
    array_type: String,
    element_type: String,
    index: ast::Operand,
    index_type: String,
}

impl StlBinder<'_, '_> {
    /// The instruction with types of its actual parameters that a call means; none: it means something else.
    pub fn called_form(&self, ctx: &CurrentBlock, call: &ast::Call) -> Option<&'static Form> {
        let name = called_name(call)?;
        let form = Form::find(name)?;
        // `CALL swap` with a variable of that name calls the instance.
        let is_own = matches!(&call.target.kind, OperandKind::Path(path) if matches!(path.root, PathRoot::Bare { .. }))
            && ctx.bound.locals.contains_key(&fold(name));
        // LEN and others are also blocks of the library of STEP 7 V5, which have no OUT. Part of a program may have its own.
        let globals = &self.program.globals;
        let has_out = call.parameters.iter().any(|given| is_named(given, "OUT"));
        let is_block = match has_out || form.computation == Computation::Block {
            true if portal_cpu(globals.input) && !globals.input.partial => {
                globals.names.symbols.contains_key(&fold(name))
            }
            _ => globals.global(name).is_some(),
        };
        (!is_own && !is_block).then_some(form)
    }

    /// Binds a call of an instruction as one of a function for the types of its actual parameters; `None` after a message.
    pub fn bind_form(&mut self, ctx: &mut CurrentBlock, call: &ast::Call, form: &'static Form) -> Option<Call> {
        let span = call.target.span;
        let (named, mut call) = without_types(form, call);
        if !self.has_instructions(form.name, span) || !self.supplies_pins(form, &call) {
            self.note_names(ctx, &call);
            return None;
        }
        let operator = match form.computation {
            Computation::Comparison => self.named_relation(form, &named, span),
            Computation::Value
            | Computation::Output
            | Computation::Conversion
            | Computation::Suffixed
            | Computation::Block => Some(""),
        };
        let pins = self.pins_of_call(ctx, &mut call, form, &named)?;
        let key = self.program.globals.write_function(form.name, form.function(&pins, operator?), span)?;
        let bound = self.program.interface(key, span)?;
        let mut arguments = self.call_arguments(ctx, &call, key, &bound)?;
        arguments.sort_by_key(|argument| argument.parameter);
        self.check_overlaps(&bound, &arguments);
        Some(Call { target: key, instance: None, arguments })
    }

    /// Whether a call supplies each pin, and nothing else; reports it otherwise.
    fn supplies_pins(&mut self, form: &Form, call: &ast::Call) -> bool {
        let all: Vec<&str> = form.pins.iter().map(|pin| pin.name).collect();
        for parameter in &call.parameters {
            if all.iter().any(|name| is_named(parameter, name)) {
                continue;
            }
            let (title, label) = match parameter.name.is_empty() {
                // It could not be read, which is reported.
                true if matches!(&parameter.actual, Some(ast::Operand { kind: OperandKind::Error, .. })) => {
                    return false;
                }
                true => (format!("`{}` is called without the name of a parameter", form.name), "`name :=` is missing"),
                false => (format!("`{}` has no parameter `{}`", form.name, parameter.name), "no such parameter"),
            };
            self.program.report(
                Diagnostic::new(Code::UnknownParameter, parameter.name_span, title)
                    .label(label)
                    .help(format!("its parameters are {}", all.join(", "))),
            );
            return false;
        }
        let is_given = |name: &str| call.parameters.iter().any(|given| is_named(given, name) && given.actual.is_some());
        let missing: Vec<&str> = all.into_iter().filter(|name| !is_given(name)).collect();
        if missing.is_empty() {
            return true;
        }
        let title = format!("the call of `{}` omits {}", form.name, missing.join(", "));
        self.program.report(
            Diagnostic::new(Code::MissingParameter, call.target.span, title)
                .label("a function needs all its parameters")
                .help(format!("add `{} := …`", missing.join(" := …, "))),
        );
        false
    }

    /// The operator of a comparison; `None` after a message.
    fn named_relation(&mut self, form: &Form, named: &[(String, String)], span: Span) -> Option<&'static str> {
        let operator = named.iter().find_map(|(_, word)| relation(word));
        if operator.is_none() {
            let title = format!("`{}` is called for no relation", form.name);
            self.program.report(
                Diagnostic::new(Code::MissingParameter, span, title)
                    .label("EQ, NE, GT, GE, LT or LE is missing")
                    .help("name it before the parameters, e.g. `relation := EQ`"),
            );
        }
        operator
    }

    /// The pins with their types, after which the call passes arrays with indices instead of elements; `None` after a message.
    fn pins_of_call(
        &mut self,
        ctx: &mut CurrentBlock,
        call: &mut ast::Call,
        form: &'static Form,
        named: &[(String, String)],
    ) -> Option<Vec<PinOfCall>> {
        let mut told = Vec::with_capacity(form.pins.len());
        let mut directions = Vec::with_capacity(form.pins.len());
        for pin in form.pins {
            let actual = call.parameters.iter().find(|given| is_named(given, pin.name));
            let actual = actual.and_then(|given| given.actual.as_ref()).expect("the call supplies each pin");
            let is_constant =
                matches!(actual.kind, OperandKind::Literal(_)) || self.constant_operand(ctx, actual).is_some();
            directions.push(match (pin.ty, pin.direction) {
                (PinType::Fixed(_), Direction::InOut) if is_constant => Direction::Input,
                (_, direction) => direction,
            });
            told.push(match pin.ty {
                PinType::Fixed(ty) => Some(Told::Type(ty.name().to_owned())),
                PinType::Actual(_) | PinType::Number(_) => self.told_by(ctx, form, actual),
                PinType::Elements(_) => self.elements(ctx, actual).map(|elements| Told::Elements(Box::new(elements))),
            });
        }
        let told: Vec<Told> = told.into_iter().collect::<Option<_>>()?;
        let words: Vec<Option<&str>> = form.pins.iter().map(|pin| pin.ty.word()).collect();
        let mut pins = Vec::with_capacity(told.len());
        for ((pin, direction), (one, word)) in form.pins.iter().zip(directions).zip(told.iter().zip(&words)) {
            let of_call = || named_type(named, &words, (*word)?);
            let of_others = || {
                let mut others = told.iter().zip(&words).filter(|(_, other)| *other == word);
                others.find_map(|(other, _)| match other {
                    Told::Type(ty) => Some(ty.clone()),
                    Told::Constant(ty) => Some((*ty).to_owned()),
                    Told::Elements(elements) => Some(elements.element_type.clone()),
                    Told::Width(_) | Told::Fitting(_) => None,
                })
            };
            let usual = match pin.ty {
                PinType::Number(ty) => Some(ty),
                PinType::Fixed(_) | PinType::Actual(_) | PinType::Elements(_) => None,
            };
            let ty = match one {
                Told::Type(ty) => Some(ty.clone()),
                Told::Constant(ty) => Some((*ty).to_owned()),
                Told::Width(width) => of_call().or_else(of_others).or_else(|| {
                    let ty = usual.filter(|ty| layout::width(*ty) == *width).unwrap_or(type_of_width(*width));
                    Some(ty.name().to_owned())
                }),
                Told::Fitting(ty) => {
                    let fitting = usual.map(Elementary::name).or(*ty);
                    of_call().or_else(of_others).or_else(|| fitting.map(str::to_owned))
                }
                Told::Elements(elements) => Some(elements.array_type.clone()),
            };
            let Some(ty) = ty else {
                let word = word.map_or_else(String::new, |word| format!("{word}_type"));
                return self.no_type(form.name, &word, call.target.span);
            };
            let index = match one {
                Told::Elements(elements) => Some(elements.index_type.clone()),
                Told::Type(_) | Told::Constant(_) | Told::Width(_) | Told::Fitting(_) => None,
            };
            pins.push(PinOfCall { pin, direction, ty, index });
        }
        for (pin, one) in form.pins.iter().zip(told) {
            let Told::Elements(elements) = one else { continue };
            let mut span = None;
            for given in call.parameters.iter_mut().filter(|given| is_named(given, pin.name)) {
                given.actual = Some(elements.array.clone());
                span = Some(given.name_span);
            }
            let (name, actual) = (index_name(pin), Some(elements.index));
            call.parameters.extend(span.map(|name_span| ast::Parameter { name, name_span, actual }));
        }
        Some(pins)
    }

    /// An actual parameter that is an element of an array; `None` after a message.
    fn elements(&mut self, ctx: &mut CurrentBlock, actual: &ast::Operand) -> Option<Elements> {
        // Reports an index that is not possible, too.
        self.settle(ctx, actual)?;
        match array_and_index(actual) {
            Some((array, index)) => match (self.array_type(ctx, &array), self.index_type(ctx, &index)) {
                (Some((array_type, element_type)), Some(index_type)) => {
                    Some(Elements { array, array_type, element_type, index, index_type })
                }
                _ => self.no_element(actual.span),
            },
            None => self.no_element(actual.span),
        }
    }

    /// The type of an array of one dimension, and that of its elements.
    fn array_type(&mut self, ctx: &mut CurrentBlock, array: &ast::Operand) -> Option<(String, String)> {
        let Settled::Complex { ty, .. } = self.settle(ctx, array)? else { return None };
        let DataType::Array(array) = &ty else { return None };
        match array.bounds.len() {
            1 => Some((declared(&ty)?, declared(&array.element)?)),
            _ => None,
        }
    }

    fn index_type(&mut self, ctx: &mut CurrentBlock, index: &ast::Operand) -> Option<String> {
        let constant = self.constant_operand(ctx, index);
        match self.settle(ctx, constant.as_ref().unwrap_or(index))? {
            Settled::Literal(_) => Some(Elementary::Dint.name().to_owned()),
            Settled::Memory { ty, width, .. } => Some(ty.unwrap_or(type_of_width(width)).name().to_owned()),
            Settled::Complex { .. }
            | Settled::Cell { .. }
            | Settled::Block { .. }
            | Settled::Pointer(_)
            | Settled::ParameterPointer(_)
            | Settled::Status(_)
            | Settled::Special(_)
            | Settled::Register(_)
            | Settled::Label => None,
        }
    }

    fn no_element<T>(&mut self, span: Span) -> Option<T> {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::OperandKind, span, format!("`{text}` is not an element of an array"))
                .label("the first element is expected here")
                .help("name an element of an array of one dimension whose type has a name, for example `#data[0]`"),
        );
        None
    }

    /// What an actual parameter tells about its type; `None` after a message.
    fn told_by(&mut self, ctx: &mut CurrentBlock, form: &Form, actual: &ast::Operand) -> Option<Told> {
        let constant = self.constant_operand(ctx, actual);
        let label = match self.settle(ctx, constant.as_ref().unwrap_or(actual))? {
            Settled::Literal(literal) => match notation(literal) {
                Some(told) => return Some(told),
                None => "a pointer".to_owned(),
            },
            Settled::Memory { ty: Some(ty), .. } => return Some(Told::Type(ty.name().to_owned())),
            Settled::Memory { width, ty: None, .. } => return Some(Told::Width(width)),
            Settled::Complex { ty, .. } => match declared(&ty) {
                Some(ty) => return Some(Told::Type(ty)),
                None => layout::type_name(&ty),
            },
            Settled::Cell { .. }
            | Settled::Block { .. }
            | Settled::Pointer(_)
            | Settled::ParameterPointer(_)
            | Settled::Status(_)
            | Settled::Special(_)
            | Settled::Register(_)
            | Settled::Label => "neither a variable nor a constant".to_owned(),
        };
        let text = self.program.globals.text(actual.span);
        let title = format!("`{}` cannot take `{text}`", form.name);
        self.program.report(Diagnostic::new(Code::TypeMismatch, actual.span, title).label(label));
        None
    }
}

/// The types and the relation that a call names, `src` with `Int` for `src_type := Int`, and the call without them.
fn without_types(form: &Form, call: &ast::Call) -> (Vec<(String, String)>, ast::Call) {
    let mut named: Vec<_> = call.types.iter().map(|one| (type_word(&one.name), one.ty.clone())).collect();
    let mut rest = Vec::with_capacity(call.parameters.len());
    for parameter in &call.parameters {
        let is_pin = form.pins.iter().any(|pin| is_named(parameter, pin.name));
        let names_type = |word: &&str| fold(&parameter.name).ends_with("type") || relation(word).is_some();
        match word_of(parameter).filter(names_type) {
            Some(word) if !is_pin => named.push((type_word(&parameter.name), word.to_owned())),
            Some(_) | None => rest.push(parameter.clone()),
        }
    }
    (named, ast::Call { types: Vec::new(), parameters: rest, ..call.clone() })
}

fn is_named(parameter: &ast::Parameter, name: &str) -> bool {
    parameter.name.trim().eq_ignore_ascii_case(name)
}

/// The word of `src_type := Int`.
fn word_of(parameter: &ast::Parameter) -> Option<&str> {
    let OperandKind::Path(path) = &parameter.actual.as_ref()?.kind else { return None };
    match &path.root {
        PathRoot::Bare { name, .. } | PathRoot::Quoted { name, .. } if path.parts.is_empty() => Some(name.as_str()),
        PathRoot::Bare { .. } | PathRoot::Local { .. } | PathRoot::Quoted { .. } | PathRoot::Block(_) => None,
    }
}

/// `src` of `src_type` and of `SrcType`.
fn type_word(name: &str) -> String {
    let folded = fold(name).replace('_', "");
    folded.strip_suffix("type").unwrap_or(&folded).to_owned()
}

/// The type that a call names for pins with a word: under that word, or as the only one for pins that have no word of their own.
fn named_type(named: &[(String, String)], words: &[Option<&str>], word: &str) -> Option<String> {
    let types: Vec<(&str, String)> =
        named.iter().filter_map(|(name, ty)| Some((name.as_str(), type_by_name(ty)?))).collect();
    if let Some((_, ty)) = types.iter().find(|(name, _)| *name == word) {
        return Some(ty.clone());
    }
    match &types[..] {
        [(name, ty)] if !words.contains(&Some(*name)) => Some(ty.clone()),
        _ => None,
    }
}

/// A type that a call names, as declarations write it.
fn type_by_name(name: &str) -> Option<String> {
    let upper = name.trim().to_ascii_uppercase();
    match upper.as_str() {
        "STRING" => Some(upper),
        "DT" | "DATE_AND_TIME" => Some("DATE_AND_TIME".to_owned()),
        "DTL" => Some("\"DTL\"".to_owned()),
        _ => Some(Elementary::from_word(&upper)?.name().to_owned()),
    }
}

/// A type as the declaration of a parameter writes it; none: it has no name there.
fn declared(ty: &DataType) -> Option<String> {
    match ty {
        // A function takes texts of any length.
        DataType::String(_) => Some("STRING".to_owned()),
        DataType::Elementary(_) | DataType::DateAndTime | DataType::WideString(_) => Some(layout::type_name(ty)),
        DataType::Struct(structure) => {
            let is_value = structure.instance_of.is_none() && structure.refers_to.is_none();
            (is_value && !structure.name.is_empty()).then(|| format!("\"{}\"", structure.name))
        }
        DataType::Array(array) => {
            let bounds: Vec<String> = array.bounds.iter().map(|(low, high)| format!("{low}..{high}")).collect();
            let element = match &array.element {
                // The length of a text is part of the type of an array.
                text @ DataType::String(_) => layout::type_name(text),
                element => declared(element)?,
            };
            Some(format!("ARRAY[{}] OF {element}", bounds.join(",")))
        }
        DataType::OpenArray(_) | DataType::Parameter(_) | DataType::Void => None,
    }
}

/// The array and the index of `#data[3]`; none: the operand is something else.
fn array_and_index(operand: &ast::Operand) -> Option<(ast::Operand, ast::Operand)> {
    let OperandKind::Path(path) = &operand.kind else { return None };
    let (PathPart::Index { values, .. }, before) = path.parts.split_last()? else { return None };
    let [value] = values.as_slice() else { return None };
    let (kind, span) = match value {
        Bound::Number(number, span) => (OperandKind::Literal(Literal::Int(*number)), *span),
        Bound::Name(name, span) => {
            let root = PathRoot::Bare { name: name.clone(), span: *span };
            (OperandKind::Path(Path { root, parts: Vec::new(), span: *span }), *span)
        }
        Bound::Path(path) => (OperandKind::Path((**path).clone()), path.span),
        Bound::Expr(_) => return None,
    };
    let array = Path { root: path.root.clone(), parts: before.to_vec(), span: path.span };
    let array = ast::Operand { kind: OperandKind::Path(array), span: operand.span };
    Some((array, ast::Operand { kind, span }))
}

/// What the notation of a constant tells about its type; none: it is a pointer.
fn notation(literal: &Literal) -> Option<Told> {
    Some(match literal {
        Literal::Bool(_) => Told::Constant("BOOL"),
        Literal::Dint(_) => Told::Constant("DINT"),
        Literal::Byte(_) => Told::Constant("BYTE"),
        Literal::Word(_) => Told::Constant("WORD"),
        Literal::Dword(_) => Told::Constant("DWORD"),
        Literal::S5Time(_) => Told::Constant("S5TIME"),
        Literal::Time(_) => Told::Constant("TIME"),
        Literal::Date(_) => Told::Constant("DATE"),
        Literal::TimeOfDay(_) => Told::Constant("TIME_OF_DAY"),
        Literal::DateAndTime(_) => Told::Constant("DATE_AND_TIME"),
        Literal::Real(_) => Told::Fitting(Some("REAL")),
        Literal::Text(_) => Told::Fitting(Some("STRING")),
        Literal::Int(_) | Literal::Bits { .. } | Literal::Bytes2(_) | Literal::Bytes4(_) | Literal::Counter(_) => {
            Told::Fitting(None)
        }
        Literal::Pointer(_) | Literal::AreaPointer { .. } | Literal::Any(_) => return None,
    })
}
