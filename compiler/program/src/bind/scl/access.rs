//! Variables: expressions of names, components, indices and slices, and whether they can be read or written.
//!
//! `operand` has what a name alone means, `component` what follows a point, `peripheral` what `:P` changes.
//! Source: SCL reference, case and names; addressing.

use plcc_binding::fold;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, Complex, Expr, ExprKind, IndexedArea};
use plcc_model::types::DataType;
use plcc_model::{Direction, Number, Passing};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Area, BlockPrefix, OperandKind, Width};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind};

use super::Intent;
use super::peripheral::without_peripheral;
use super::place::{Db, Root, Spot, Thing};
use super::value::Value;
use crate::bind::declarations::path;
use crate::bind::globals::names::kind_prefix;
use crate::bind::scl::message::{DEPTH_MAX, start_of_cell};
use crate::bind::scl::{SclBinder, SclBlock};

impl SclBinder<'_, '_> {
    /// Binds a variable.
    pub(in crate::bind) fn access(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Access> {
        let spot = self.spot(ctx, node, intent)?;
        Some(spot.access(node.span))
    }

    /// Binds a variable, as its parts.
    pub(super) fn spot(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Spot> {
        match self.thing(ctx, node, intent)? {
            Thing::Spot(spot) => {
                self.check_intent(ctx, &spot, intent, node.span)?;
                Some(spot)
            }
            Thing::Db { db: Db::Known(number), .. } => Some(Spot::fixed(self.whole_db(number, node.span)?)),
            Thing::Constant(_) => {
                let text = self.program.globals.text(node.span);
                self.refuse(
                    Code::Protected,
                    node.span,
                    &format!("`{text}` cannot be written"),
                    "a constant",
                    "name a variable",
                );
                None
            }
            thing @ (Thing::Cell { .. } | Thing::Block { .. } | Thing::Db { .. } | Thing::Flag | Thing::LastEno) => {
                let text = self.program.globals.text(node.span);
                // The value of another function is assigned: that of this one is meant.
                let function = matches!(thing, Thing::Block { prefix: BlockPrefix::Fc, .. });
                let own = if function && intent == Intent::Write { self.own_value(ctx) } else { None };
                ctx.scope.value_set |= own.is_some();
                let key = ctx.block.key;
                let is_this = matches!(thing, Thing::Block { prefix, number: Number::Known(number) }
                    if (prefix, number) == (kind_prefix(key.kind), key.number) && intent == Intent::Write);
                let help = match own {
                    Some(own) => format!("the value of this function is `{own}`: write `{own} := …`"),
                    None if is_this && function => {
                        format!("this function has no value: give it a type, as in `FUNCTION {text} : Int`")
                    }
                    None if is_this => "a block of this kind has no value: assign to one of its outputs".to_string(),
                    None if let Thing::Cell { kind, .. } = thing => start_of_cell(kind, &text),
                    None => "name a variable or an address such as `MW10`".to_string(),
                };
                let title = format!("`{text}` is not a variable");
                self.refuse(Code::OperandKind, node.span, &title, "a variable is expected here", &help);
                None
            }
            Thing::Area(..) => {
                self.no_address(node.span);
                None
            }
            Thing::DbArea(db, _) => {
                self.no_address_in(&db, node.span);
                None
            }
        }
    }

    /// The meaning of an expression of names.
    pub(in crate::bind) fn thing(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Thing> {
        if ctx.scope.depth >= DEPTH_MAX {
            self.too_deep(node.span);
            return None;
        }
        ctx.scope.depth += 1;
        let thing = self.thing_inner(ctx, node, intent);
        ctx.scope.depth -= 1;
        thing
    }

    fn thing_inner(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Thing> {
        let span = node.span;
        match &node.kind {
            NodeKind::Name(name) if self.is_unknown_symbol(ctx, name, span) => {
                self.program.globals.unknown_name(&name.text, span, std::iter::empty());
                None
            }
            NodeKind::Name(name) => self.name_thing(ctx, name, intent),
            NodeKind::Absolute(operand) => {
                if let (OperandKind::Absolute { .. } | OperandKind::DbAbsolute { .. }, Some(untyped)) =
                    (operand, &mut ctx.scope.untyped)
                {
                    untyped.insert(span);
                }
                self.operand_thing(ctx, operand, span)
            }
            NodeKind::Member { base, name } if self.output_of_call(ctx, base, name) => None,
            NodeKind::Member { base, name } => {
                let base = match &base.kind {
                    NodeKind::Name(base) => self.name_thing(ctx, base, intent)?,
                    _ => self.thing(ctx, base, intent)?,
                };
                match without_peripheral(&base, name) {
                    Some(own) => {
                        let thing = self.member_thing(ctx, base, &own, span)?;
                        self.past_image(thing, span).map(Thing::Spot)
                    }
                    None => self.member_thing(ctx, base, name, span),
                }
            }
            NodeKind::MemberAbsolute { base, width, byte, bit } => {
                let base_span = base.span;
                let db = match self.thing(ctx, base, Intent::Read)? {
                    Thing::Db { db, .. } => db,
                    // `#db.%DBW4`: a DB_ANY, whose value is the number of the data block.
                    Thing::Spot(spot) if spot.ty == DataType::Elementary(Elementary::Uint) && spot.part.is_none() => {
                        let load = ExprKind::Load(Box::new(spot.access(base_span)));
                        Db::Dynamic(Expr { kind: load, ty: Elementary::Word, span: base_span })
                    }
                    _ => {
                        self.no_db(span);
                        return None;
                    }
                };
                if let Some(untyped) = &mut ctx.scope.untyped {
                    untyped.insert(span);
                }
                self.db_place(ctx, db, *width, *byte, *bit, span)
            }
            NodeKind::Slice { base, width, index } => {
                let base = self.thing(ctx, base, intent)?;
                self.slice(base, *width, *index, span)
            }
            NodeKind::Index { base, indices } => {
                let base_span = base.span;
                match self.thing(ctx, base, intent)? {
                    Thing::Spot(spot) => self.element(ctx, spot, indices, span).map(Thing::Spot),
                    Thing::Area(area, width) => self.indexed(ctx, IndexedArea::Memory(area), width, indices, span),
                    Thing::DbArea(db, width) => {
                        let area = self.indexed_db(db, base_span);
                        self.indexed(ctx, area, width, indices, span)
                    }
                    other => {
                        let help = self.before_index(&other, base_span, span);
                        let label = "there is an index after it";
                        self.refuse(Code::UnknownMember, span, "this is not an array", label, &help);
                        None
                    }
                }
            }
            NodeKind::Call { callee, arguments } => match self.indexed_call(ctx, callee, arguments, span) {
                Some(thing) => thing,
                None => {
                    let text = self.program.globals.text(span);
                    let (title, label, help) = match (text.split_once('('), &callee.kind) {
                        (Some((name, index)), NodeKind::Name(_)) if Self::names_array(ctx, callee) => (
                            "the index of an array is written in brackets",
                            "a form of other languages",
                            format!("write `{name}[{}]`", index.trim_end_matches(')')),
                        ),
                        _ => (
                            "the result of a call is not a variable",
                            "a call",
                            "assign the result to a variable first".to_string(),
                        ),
                    };
                    self.refuse(Code::OperandKind, span, title, label, &help);
                    None
                }
            },
            NodeKind::Dereference(base) => self.dereferenced(ctx, base, span).map(Thing::Spot),
            NodeKind::Reference(_) => {
                self.misplaced_reference(span, "REF(…) is a value, not a variable");
                None
            }
            NodeKind::Literal(_) | NodeKind::Unary { .. } | NodeKind::Binary { .. } => {
                let text = self.program.globals.text(span);
                self.refuse(
                    Code::OperandKind,
                    span,
                    &format!("`{text}` is not a variable"),
                    "a variable is expected here",
                    "name a variable or an address such as `MW10`",
                );
                None
            }
            NodeKind::Error => None,
        }
    }

    /// The value of an expression of names.
    pub(super) fn thing_value(&mut self, ctx: &mut SclBlock, thing: Thing, span: Span) -> Option<Value> {
        Some(match thing {
            Thing::Spot(spot) => {
                self.check_intent(ctx, &spot, Intent::Read, span)?;
                let access = spot.access(span);
                match (access.elementary(), access.ty.clone()) {
                    (Some(ty), _) => Value::Elementary(Expr { kind: ExprKind::Load(Box::new(access)), ty, span }),
                    (None, DataType::Parameter(_) | DataType::OpenArray(_)) => Value::Parameter { access, span },
                    (None, DataType::Void) => return None,
                    (None, ty) => Value::Complex { value: Complex::Variable(access), ty, span },
                }
            }
            Thing::Constant(constant) => Value::Constant(constant, span),
            Thing::Cell { kind, number } => Value::Cell { kind, number, span },
            Thing::Block { prefix, number } => Value::Block { prefix, number, span },
            Thing::Db { number: Some(number), .. } => Value::Block { prefix: BlockPrefix::Db, number, span },
            // This code reads it, so it must be set somewhere.
            Thing::Flag => {
                ctx.scope.sets_flag = true;
                Value::Elementary(Expr { kind: ExprKind::Flag, ty: Elementary::Bool, span })
            }
            Thing::LastEno => Value::Elementary(Expr { kind: ExprKind::LastEno, ty: Elementary::Bool, span }),
            Thing::DbArea(db, _) => {
                self.no_address_in(&db, span);
                return None;
            }
            Thing::Area(..) | Thing::Db { number: None, .. } => {
                self.no_address(span);
                return None;
            }
        })
    }

    /// What to write for an index at the end of `span`, after something without elements at `base`.
    fn before_index(&self, thing: &Thing, base: Span, span: Span) -> String {
        let text = self.program.globals.text(base);
        let Thing::Db { db: Db::Known(number), .. } = thing else { return format!("remove the index after `{text}`") };
        let index = self.program.globals.text(Span { start: base.end.min(span.end), ..span });
        let index = index.trim();
        let structure = self.program.data.db_type(*number);
        let mut members = structure.iter().flat_map(|structure| &structure.members);
        match members.find(|member| matches!(member.ty, DataType::Array(_))) {
            Some(list) => format!("write the component before its index, as in `{text}.{}{index}`", list.name),
            None => format!("remove `{index}`: no component of `{text}` is an array"),
        }
    }

    /// Whether the name is that of an array of the block.
    fn names_array(ctx: &SclBlock, node: &Node) -> bool {
        let NodeKind::Name(name) = &node.kind else { return false };
        let local = ctx.block.bound.locals.get(&fold(&name.text));
        local.is_some_and(|local| matches!(local.ty, DataType::Array(_)))
    }

    /// `"Data".d`: the letter of an area of the data block without its index; rather a component that the block does not have.
    fn no_address_in(&mut self, db: &Db, span: Span) {
        let text = self.program.globals.text(span);
        let component = text.rsplit_once('.').map(|(_, component)| component).filter(|component| component.len() == 1);
        if let (Db::Known(number), Some(component)) = (db, component)
            && let Some(ty) = self.program.data.db_type(*number)
        {
            let end = span.end as usize;
            let at = Span::new(span.file, end.saturating_sub(component.len()).max(span.start as usize)..end);
            self.program.unknown_member(&ty, component, at);
            return;
        }
        self.no_address(span);
    }

    fn no_address(&mut self, span: Span) {
        let text = self.program.globals.text(span);
        if text.len() == 1 {
            // A counting variable that nothing declares, rather than an area.
            self.program.globals.report.missing_letter(&text, span);
            return;
        }
        self.refuse(
            Code::OperandKind,
            span,
            &format!("`{text}` alone is not an address"),
            "the number is missing",
            "write for example `MW10`, `MW[i]` or `DB10.DW[i]`",
        );
    }

    /// Whether a variable can be read or written as the access requires.
    pub(in crate::bind) fn check_intent(
        &mut self,
        ctx: &SclBlock,
        spot: &Spot,
        intent: Intent,
        span: Span,
    ) -> Option<()> {
        let text = self.program.globals.text(span);
        let area = match &spot.root {
            Root::Fixed(path::Base::Pi) | Root::Indexed { area: IndexedArea::Memory(Area::Pi), .. } => Some(Area::Pi),
            Root::Fixed(path::Base::Pq) | Root::Indexed { area: IndexedArea::Memory(Area::Pq), .. } => Some(Area::Pq),
            _ => None,
        };
        // A bit is written alone; other parts need what is there.
        let is_bit = spot.part.is_some_and(|part| part.width == Width::Bit)
            && spot.ty == DataType::Elementary(Elementary::Byte)
            && matches!(spot.root, Root::Fixed(_));
        let reads = intent != Intent::Write || (spot.part.is_some() && !is_bit);
        if area == Some(Area::Pq) && reads {
            let title = format!("`{text}` cannot be read");
            let help = format!("read the process image: `{}`", in_image(&text));
            self.refuse(Code::OperandKind, span, &title, "this is a peripheral output", &help);
            return None;
        }
        match intent {
            Intent::Read => return Some(()),
            Intent::Write => self.warn_of_input(ctx, spot, span),
            Intent::Both => {}
        }
        if ctx.block.bound.constant_db.is_some_and(|number| spot.lies_in_db(number)) {
            let title = format!("`{text}` cannot be written");
            self.refuse(Code::Protected, span, &title, "a constant", "name a variable");
            return None;
        }
        if area == Some(Area::Pi) {
            let title = format!("`{text}` cannot be written");
            self.refuse(
                Code::Protected,
                span,
                &title,
                "this is a peripheral input",
                "peripheral outputs are written: `PQW`",
            );
            return None;
        }
        if let DataType::Struct(structure) = &spot.ty
            && structure.instance_of.is_some()
            && intent == Intent::Write
        {
            let title = format!("`{text}` cannot be assigned");
            self.refuse(Code::Protected, span, &title, "this is an instance", "assign its inputs one by one");
            return None;
        }
        if let Some((_, head)) = ctx.scope.loop_variables.iter().rev().find(|(variable, _)| variable.is_same(spot)) {
            let error = !ctx.scope.rules.is_300();
            let mut message =
                Diagnostic::new(Code::LoopVariable, span, format!("`{text}` counts this loop and is changed in it"))
                    .label("changed here")
                    .also(*head, "the loop")
                    .help("use another variable, or a WHILE loop");
            if !error {
                message.severity = plcc_diag::Severity::Warning;
            }
            self.program.report(message);
            if error {
                return None;
            }
        }
        Some(())
    }

    /// Warns once of an input that is written although it is a reference: the variable of the caller changes.
    fn warn_of_input(&mut self, ctx: &SclBlock, spot: &Spot, span: Span) {
        let Root::Fixed(path::Base::Parameter(number)) = spot.root else { return };
        let Some(parameter) = ctx.block.bound.interface.parameters.get(number) else { return };
        let is_reference = matches!(parameter.passing, Passing::Complex { .. } | Passing::OpenArray { .. });
        if parameter.direction != Direction::Input || !is_reference {
            return;
        }
        let (name, block) = (&parameter.name, self.program.globals.shown(ctx.block.key));
        let title = format!("`{name}` is an input of {block}: writing it changes the variable of the caller");
        if self.program.globals.report.diagnostics.iter().any(|known| known.title == title) {
            return;
        }
        let mut message = Diagnostic::new(Code::Protected, span, title)
            .label("texts, structures and arrays are passed by reference")
            .help(format!("declare `{name}` in VAR_IN_OUT, or write a copy of it in VAR_TEMP"));
        message.severity = plcc_diag::Severity::Warning;
        self.program.report(message);
    }
}

/// The address in the process image of a peripheral one: `%QW2` for `%QW2:P`, `QW2` for `PQW2`.
fn in_image(text: &str) -> String {
    if let Some(address) = text.strip_suffix(":P").or_else(|| text.strip_suffix(":p")) {
        return address.to_owned();
    }
    let (percent, letters) = text.strip_prefix('%').map_or(("", text), |rest| ("%", rest));
    match letters.strip_prefix(['P', 'p']) {
        Some(address) if letters.len() > 1 => format!("{percent}{address}"),
        _ => "QW4".to_owned(),
    }
}
