//! Calls in SCL: what their arguments show about parameters that are missing, and the other way round.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, BlockPrefix, CellKind, OperandKind};
use plcc_syntax::scl::ast::{Argument, Expr as Node, ExprKind as NodeKind, Name, NameForm};

use super::{INT, parameter_hint, surest, typed};
use crate::bind::globals::names::code_kind;
use crate::bind::partial::evidence::Hint;
use crate::bind::partial::look::{Look, Start, Step};
use crate::bind::scl::callee::Callee;
use crate::bind::scl::function::Named;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction};

impl Look<'_, '_> {
    /// Examines a call. `hint`: the type that its value should have; `statement`: it is a statement.
    pub fn call(
        &mut self,
        ctx: &mut SclBlock,
        callee: &Node,
        arguments: &[Argument],
        hint: Option<&Hint>,
        statement: bool,
    ) {
        if self.missing_callee(ctx, callee, arguments, hint, statement) {
            return;
        }
        let target = self.quietly(|program| SclBinder::new(program).callee(ctx, callee));
        match target {
            Some(Callee::Block { key, .. }) => self.known_block(ctx, key, arguments, callee.span),
            Some(Callee::Function(named)) => self.function(ctx, &named, arguments, hint),
            None => {
                for value in arguments.iter().filter_map(|argument| argument.value.as_ref()) {
                    self.expect(ctx, value, None);
                }
            }
        }
    }

    /// A call of something that is missing; false if it is not.
    fn missing_callee(
        &mut self,
        ctx: &mut SclBlock,
        callee: &Node,
        arguments: &[Argument],
        hint: Option<&Hint>,
        statement: bool,
    ) -> bool {
        // A block that is known, with an instance that may be missing.
        if let NodeKind::Member { base, name } = &callee.kind
            && let Some((prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number)) =
                SclBinder::new(self.program).quiet_block(ctx, base)
            && let Some(numbered) = Missing::block(prefix, u32::from(number))
            && !self.found.things.contains_key(&numbered)
            && let Some(of) = block_named(base).or(Some(numbered))
            && !self.found.things.contains_key(&of)
            && self.is_block(prefix, u32::from(number))
        {
            let instance = instance_start(name);
            self.with_shape(ctx, &instance, &[], name.span, &mut |shape| {
                shape.is_db = true;
                shape.of = Some(of.clone());
            });
            if let Some(kind) = code_kind(prefix) {
                self.known_block(ctx, BlockKey { kind, number }, arguments, base.span);
            }
            return true;
        }
        // `"data block".TON(…)`: the instruction says what its data is.
        if let NodeKind::Member { base, name } = &callee.kind
            && name.form == NameForm::Bare
            && let Some((key, of)) = self.block_of_instance(&name.text)
            && let Some((start, steps, span)) = self.steps(ctx, base)
            && self.lies_in_missing(ctx, &start, &steps, span)
        {
            self.with_shape(ctx, &start, &steps, span, &mut |shape| shape.of = Some(of.clone()));
            self.known_block(ctx, key, arguments, base.span);
            return true;
        }
        // `"block"."data block"(…)`, `FB10.DB20(…)`.
        if let NodeKind::Member { base, name } = &callee.kind
            && let Some((start, steps, span)) = self.steps(ctx, base)
            && steps.is_empty()
            && let Some(block) = self.missing_block(ctx, &start)
            && (name.form == NameForm::Quoted || matches!(start, Start::Block(..)))
        {
            let instance = instance_start(name);
            self.formals(ctx, &start, &[], span, arguments, None, true, true);
            self.with_shape(ctx, &instance, &[], name.span, &mut |shape| {
                shape.is_db = true;
                shape.of = Some(block.clone());
            });
            return true;
        }
        if let NodeKind::Name(name) = &callee.kind
            && name.form == NameForm::Bare
            && Named::find(&name.text).is_some()
        {
            return false;
        }
        let Some((start, steps, span)) = self.steps(ctx, callee) else { return false };
        if !self.lies_in_missing(ctx, &start, &steps, span) {
            return false;
        }
        let instance = !steps.is_empty() || matches!(start, Start::Local(_));
        self.formals(ctx, &start, &steps, span, arguments, hint, statement, instance);
        true
    }

    /// The missing name at the start of a place, if it is missing.
    fn missing_block(&mut self, ctx: &SclBlock, start: &Start) -> Option<Missing> {
        let missing = self.meant(start)?;
        self.lies_in_missing(ctx, start, &[], Span::default()).then_some(missing)
    }

    /// True if the place is missing, or is part of a missing one.
    fn lies_in_missing(&mut self, ctx: &SclBlock, start: &Start, steps: &[Step], span: Span) -> bool {
        let mut hit = false;
        self.with_shape(ctx, start, steps, span, &mut |_| hit = true);
        hit
    }

    /// What the arguments of a call show about the parameters of a missing block.
    #[allow(clippy::too_many_arguments)] // A call, and its position.
    fn formals(
        &mut self,
        ctx: &mut SclBlock,
        start: &Start,
        steps: &[Step],
        span: Span,
        arguments: &[Argument],
        hint: Option<&Hint>,
        statement: bool,
        instance: bool,
    ) {
        let mut formals = Vec::new();
        for (at, argument) in arguments.iter().enumerate() {
            let name = argument.name.as_ref().map_or_else(|| format!("IN{}", at + 1), |name| name.text.clone());
            if name.eq_ignore_ascii_case("EN") || name.eq_ignore_ascii_case("ENO") {
                if let Some(value) = &argument.value {
                    self.expect(ctx, value, Some(&typed(Elementary::Bool)));
                }
                continue;
            }
            let stated = if steps.is_empty() { self.stated(ctx, start, &name) } else { None };
            // The type of a data type that is missing, too, is known later than what stands in for the argument.
            if let (Some(hint), Some(value)) = (&stated, &argument.value)
                && let Some((start, steps, span)) = self.steps(ctx, value)
            {
                self.with_shape(ctx, &start, &steps, span, &mut |shape| shape.learn(Some(hint)));
            }
            let known = argument.value.as_ref().and_then(|value| self.hint_of(ctx, value));
            formals.push((name, argument.output, known.or(stated)));
        }
        let mut wanted = Vec::new();
        self.with_shape(ctx, start, steps, span, &mut |shape| {
            wanted.clear();
            for (name, output, known) in &formals {
                let formal = shape.formal(name, *output);
                formal.learn(known.as_ref());
                wanted.push((name.clone(), formal.ty.clone()));
            }
            let call = shape.call.get_or_insert_default();
            call.instance |= instance;
            if !statement && !instance {
                call.result = true;
                call.value.learn(hint);
            }
        });
        for (at, argument) in arguments.iter().enumerate() {
            let name = argument.name.as_ref().map_or_else(|| format!("IN{}", at + 1), |name| name.text.clone());
            if let Some(value) = &argument.value
                && self.hint_of(ctx, value).is_none()
            {
                let ty = wanted.iter().find(|(known, _)| *known == name).and_then(|(_, ty)| ty.clone());
                self.expect(ctx, value, ty.map(Hint::Type).as_ref());
            }
        }
    }

    /// Arguments of a block that is known.
    pub fn known_block(&mut self, ctx: &mut SclBlock, key: BlockKey, arguments: &[Argument], span: Span) {
        let Some(bound) = self.quietly(|program| program.interface(key, span)) else { return };
        let parameters = || bound.interface.parameters.iter();
        let mut inputs: Vec<_> = parameters().filter(|one| one.direction != Direction::Output).collect();
        // `RD_SYS_T(#now)` has only an output.
        if inputs.is_empty() {
            inputs = parameters().filter(|one| one.name != "RET_VAL").collect();
        }
        for (at, argument) in arguments.iter().enumerate() {
            let Some(value) = &argument.value else { continue };
            let formal = match &argument.name {
                Some(name) => bound.interface.parameters.iter().find(|formal| fold(&formal.name) == fold(&name.text)),
                None => inputs.get(at).copied(),
            };
            let enable = argument
                .name
                .as_ref()
                .is_some_and(|name| name.text.eq_ignore_ascii_case("EN") || name.text.eq_ignore_ascii_case("ENO"));
            let hint = match formal.map(|formal| &formal.ty) {
                _ if enable => Some(typed(Elementary::Bool)),
                Some(ty) => parameter_hint(ty),
                None => None,
            };
            if matches!(self.hint_of(ctx, value), None | Some(Hint::DataBlock)) {
                self.expect(ctx, value, hint.as_ref());
            }
        }
    }

    /// Arguments of a function of the language.
    fn function(&mut self, ctx: &mut SclBlock, named: &Named, arguments: &[Argument], hint: Option<&Hint>) {
        let hints: Vec<Option<Hint>> = arguments
            .iter()
            .map(|argument| argument.value.as_ref().and_then(|value| self.hint_of(ctx, value)))
            .collect();
        // What selects a value says nothing about its type.
        let selects = |(at, (argument, _)): &(usize, (&Argument, &Option<Hint>))| {
            let Named::Row { row, .. } = named else { return false };
            let own = match row.name {
                "SEL" => "G",
                "MUX" => "K",
                _ => return false,
            };
            argument.name.as_ref().map_or(*at == 0, |name| name.text.eq_ignore_ascii_case(own))
        };
        let values = arguments.iter().zip(&hints).enumerate().filter(|value| !selects(value));
        let common = surest(values.map(|(_, (_, hint))| hint.clone())).or_else(|| hint.cloned());
        for (argument, known) in arguments.iter().zip(hints) {
            let Some(value) = argument.value.as_ref().filter(|_| known.is_none()) else { continue };
            let name = argument.name.as_ref().map_or(String::new(), |name| name.text.to_ascii_uppercase());
            let wanted = match named {
                Named::Convert { from: Some(from), .. } => Some(typed(*from)),
                Named::Convert { from: None, .. } => None,
                Named::Bcd(word) => {
                    let from = word.split("_TO_").next().unwrap_or("");
                    Elementary::from_word(from).map(typed).or(Some(typed(Elementary::Word)))
                }
                Named::Text(word) => {
                    let from = word.split("_TO_").next().unwrap_or("");
                    match from {
                        "STRING" => Some(Hint::Type(DataType::String(254))),
                        "WSTRING" => Some(Hint::Type(DataType::WideString(254))),
                        from => Elementary::from_word(from).map(typed),
                    }
                }
                Named::Row { row, suffix } => match (row.name, name.as_str()) {
                    (_, "T_NO" | "TIMER") => Some(Hint::Cell(CellKind::Timer)),
                    (_, "C_NO") => Some(Hint::Cell(CellKind::Counter)),
                    (_, "TV") => Some(typed(Elementary::S5Time)),
                    (_, "PV" | "BI" | "CV") => Some(typed(Elementary::Word)),
                    (_, "S" | "R" | "Q" | "CU" | "CD" | "G") => Some(typed(Elementary::Bool)),
                    (_, "K" | "N" | "COUNT" | "COUNT_IN" | "COUNT_OUT" | "DIM") => Some(INT),
                    // The count does not say what type is shifted, but `SHR_DINT` does.
                    ("SHL" | "SHR" | "ROL" | "ROR", _) => match (suffix.map(typed), hint) {
                        (Some(own), _) => Some(own),
                        (None, Some(Hint::Type(_) | Hint::Width(_))) => hint.cloned(),
                        (None, _) => Some(Hint::Width(Elementary::Word)),
                    },
                    ("NORM_X", _) => common.clone(),
                    ("SCALE_X", "VALUE") => Some(typed(Elementary::Real)),
                    ("ROUND" | "TRUNC" | "CEIL" | "FLOOR" | "SQRT" | "EXP" | "LN" | "SIN" | "COS" | "TAN", _) => {
                        Some(typed(Elementary::Real))
                    }
                    _ => suffix.map(typed).or_else(|| common.clone()),
                },
            };
            self.expect(ctx, value, wanted.as_ref());
        }
    }
}

/// A block that is called by its name. Its number may change, as long as no source fixes it.
fn block_named(node: &Node) -> Option<Missing> {
    let NodeKind::Name(name) = &node.kind else { return None };
    plcc_syntax::scl::absolute(&name.text).is_none().then(|| Missing::name(&name.text))
}

/// The data block after a function block.
fn instance_start(name: &Name) -> Start {
    match plcc_syntax::scl::absolute(&name.text) {
        Some(OperandKind::Block(BlockName::Numbered { prefix, number, .. })) => Start::Block(prefix, number),
        _ => Start::Global(name.text.clone()),
    }
}
