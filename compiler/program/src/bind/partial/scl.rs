//! Uses in statements and expressions of SCL.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, BlockPrefix, CellKind, OperandKind};
use plcc_syntax::scl::ast::{
    Argument, AssignOp, BinaryOp, CaseValue, Expr as Node, ExprKind as NodeKind, Literal, Name, NameForm, Statement,
    StatementKind, UnaryOp,
};

use super::evidence::{Hint, is_named, is_unnamed};
use super::look::{Look, Start, Step};
use crate::bind::scl::callee::Callee;
use crate::bind::scl::function::Named;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction};

/// A hint of an elementary type.
pub const fn typed(ty: Elementary) -> Hint {
    Hint::Type(DataType::Elementary(ty))
}

const INT: Hint = Hint::Literal(DataType::Elementary(Elementary::Int));

/// The most certain of some hints.
pub fn surest(hints: impl IntoIterator<Item = Option<Hint>>) -> Option<Hint> {
    let rank = |hint: &Hint| match hint {
        Hint::Type(_) | Hint::Cell(_) | Hint::DataBlock => 0,
        Hint::Width(_) => 1,
        Hint::Literal(_) => 2,
    };
    hints.into_iter().flatten().min_by_key(rank)
}

impl Look<'_, '_> {
    pub fn statements(&mut self, ctx: &mut SclBlock, list: &[Statement]) {
        for statement in list {
            self.statement(ctx, statement);
        }
    }

    fn statement(&mut self, ctx: &mut SclBlock, statement: &Statement) {
        match &statement.kind {
            StatementKind::Expression(node) => match &node.kind {
                NodeKind::Call { callee, arguments } => self.call(ctx, callee, arguments, None, true),
                _ => self.expect(ctx, node, None),
            },
            StatementKind::Assign { targets, value } => self.assignment(ctx, targets, value),
            StatementKind::If { branches, otherwise } => {
                for (condition, body) in branches {
                    self.expect(ctx, condition, Some(&typed(Elementary::Bool)));
                    self.statements(ctx, body);
                }
                self.statements(ctx, otherwise);
            }
            StatementKind::Case { selector, arms, otherwise } => {
                let hint = self.hint_of(ctx, selector);
                let is_text = |value: &CaseValue| matches!(value.low.kind, NodeKind::Literal(Literal::Text { .. }));
                let of_characters = arms.iter().flat_map(|arm| &arm.values).any(is_text);
                let wanted = if of_characters { typed(Elementary::Char) } else { INT };
                self.expect(ctx, selector, Some(&wanted));
                for arm in arms {
                    for value in &arm.values {
                        self.constant_of_arm(ctx, &value.low, hint.as_ref());
                        value.high.iter().for_each(|high| self.constant_of_arm(ctx, high, hint.as_ref()));
                    }
                    self.statements(ctx, &arm.body);
                }
                self.statements(ctx, otherwise);
            }
            StatementKind::For { variable, start, end, step, body } => {
                let hint = self.hint_of(ctx, variable).unwrap_or(INT);
                for node in [variable, start, end].into_iter().chain(step) {
                    self.expect(ctx, node, Some(&hint));
                }
                self.statements(ctx, body);
            }
            StatementKind::While { condition, body } => {
                self.expect(ctx, condition, Some(&typed(Elementary::Bool)));
                self.statements(ctx, body);
            }
            StatementKind::Repeat { body, until } => {
                self.statements(ctx, body);
                self.expect(ctx, until, Some(&typed(Elementary::Bool)));
            }
            StatementKind::Return(Some(value)) => self.expect(ctx, value, Some(&typed(Elementary::Bool))),
            StatementKind::Return(None)
            | StatementKind::Empty
            | StatementKind::Label(_)
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Goto(_)
            | StatementKind::Pragma(_)
            | StatementKind::Error => {}
        }
    }

    fn assignment(&mut self, ctx: &mut SclBlock, targets: &[(Node, AssignOp)], value: &Node) {
        let of_value = self.hint_of(ctx, value);
        let of_targets: Vec<Option<Hint>> = targets.iter().map(|(target, _)| self.hint_of(ctx, target)).collect();
        let wanted = surest(of_targets.iter().cloned());
        if of_value.is_none() {
            self.expect(ctx, value, wanted.as_ref());
        }
        self.structure(ctx, value, wanted.as_ref());
        let condition = is_condition(value).then(|| typed(Elementary::Bool));
        let given = surest([of_value, wanted]).or(condition);
        for ((target, _), known) in targets.iter().zip(of_targets) {
            if known.is_none() {
                self.expect(ctx, target, given.as_ref());
            }
            self.structure(ctx, target, given.as_ref());
        }
    }

    /// Teaches a place its type as a whole, if that is a structure: components that are used show only what they are themselves. One
    /// without a name counts only where no components are used.
    fn structure(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        if let Some(Hint::Type(ty)) = hint
            && (is_named(ty) || is_unnamed(ty))
            && let Some((start, steps, span)) = self.steps(ctx, node)
        {
            self.with_shape(ctx, &start, &steps, span, &mut |shape| {
                if is_named(ty) || shape.members.is_empty() && shape.elements.is_none() {
                    shape.learn(hint);
                }
            });
        }
    }

    /// A value of an arm, which must be a constant.
    fn constant_of_arm(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        let known = self.quietly(|program| program.globals.constant(&ctx.block.bound.constants, node).is_some());
        if !known {
            let own =
                matches!(&node.kind, NodeKind::Name(name) if ctx.block.bound.locals.contains_key(&fold(&name.text)));
            if !own {
                self.constant_names(node, hint);
            }
        }
    }

    /// Examines an expression that should have the type `hint`.
    pub fn expect(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        if ctx.scope.depth >= crate::bind::scl::message::DEPTH_MAX {
            return;
        }
        ctx.scope.depth += 1;
        self.expect_inner(ctx, node, hint);
        ctx.scope.depth -= 1;
    }

    fn expect_inner(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        match &node.kind {
            NodeKind::Literal(_) | NodeKind::Error => {}
            NodeKind::Name(_)
            | NodeKind::Absolute(_)
            | NodeKind::Member { .. }
            | NodeKind::MemberAbsolute { .. }
            | NodeKind::Slice { .. }
            | NodeKind::Index { .. } => {
                // Steps also examine indices.
                let place = self.steps(ctx, node);
                let known = self.hint_of(ctx, node);
                if let Some((start, steps, span)) = place
                    && (known.is_none() || steps.is_empty() && self.is_of_type(&start, hint))
                {
                    self.note(ctx, &start, &steps, span, hint);
                }
            }
            NodeKind::Call { callee, arguments } => self.call(ctx, callee, arguments, hint, false),
            NodeKind::Dereference(base) | NodeKind::Reference(base) => self.expect(ctx, base, None),
            NodeKind::Unary { op, operand } => {
                let bool = typed(Elementary::Bool);
                let hint = match op {
                    UnaryOp::Not => Some(hint.unwrap_or(&bool)),
                    UnaryOp::Plus | UnaryOp::Minus => hint,
                };
                self.expect(ctx, operand, hint);
            }
            NodeKind::Binary { .. } => self.chain(ctx, node, hint),
        }
    }

    /// Whether a missing data block is used where a structure with a name is expected: then it is of that type.
    fn is_of_type(&self, start: &Start, hint: Option<&Hint>) -> bool {
        let is_missing = |(prefix, number): (BlockPrefix, u16)| {
            prefix == BlockPrefix::Db && !self.program.globals.sources.data.contains_key(&number)
        };
        matches!(hint, Some(Hint::Type(ty)) if is_named(ty))
            && self.meant(start).and_then(|meant| meant.numbered()).is_some_and(is_missing)
    }

    /// Operators in a row, all of one kind.
    fn chain(&mut self, ctx: &mut SclBlock, node: &Node, hint: Option<&Hint>) {
        let NodeKind::Binary { op, .. } = &node.kind else { return };
        let group = group(*op);
        let mut operands = Vec::new();
        let mut at = node;
        while let NodeKind::Binary { op, left, right, .. } = &at.kind
            && self::group(*op) == group
        {
            operands.push((Some(*op), &**right));
            at = left;
        }
        operands.push((None, at));
        operands.reverse();
        let hints: Vec<Option<Hint>> = operands.iter().map(|(_, operand)| self.hint_of(ctx, operand)).collect();
        if hints.iter().all(Option::is_some) {
            return;
        }
        let known = surest(hints.iter().cloned());
        let wanted = match group {
            Group::Compare => known,
            Group::Logic => surest([known, hint.cloned()]).or(Some(typed(Elementary::Bool))),
            Group::Number => surest([hint.cloned(), known]),
        };
        for ((op, operand), known) in operands.into_iter().zip(hints) {
            if known.is_some() {
                continue;
            }
            let is_time = matches!(
                &wanted,
                Some(Hint::Type(DataType::Elementary(Elementary::Time | Elementary::Ltime | Elementary::S5Time)))
            );
            // A time is multiplied with numbers.
            match op {
                Some(BinaryOp::Multiply | BinaryOp::Divide) if is_time => self.expect(ctx, operand, Some(&INT)),
                _ => self.expect(ctx, operand, wanted.as_ref()),
            }
        }
    }

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
            let kind = crate::bind::globals::names::code_kind(prefix);
            if let Some(kind) = kind {
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

/// The hint for a parameter's type; a type that accepts anything has none.
pub fn parameter_hint(ty: &DataType) -> Option<Hint> {
    use plcc_model::types::ParameterType;
    match ty {
        DataType::Parameter(ParameterType::Timer) => Some(Hint::Cell(CellKind::Timer)),
        DataType::Parameter(ParameterType::Counter) => Some(Hint::Cell(CellKind::Counter)),
        DataType::Parameter(ParameterType::BlockDb) => Some(Hint::DataBlock),
        DataType::Parameter(_) | DataType::Void => None,
        DataType::OpenArray(array) => {
            let bounds = vec![(0, 9); usize::from(array.dimensions)];
            let bytes = u32::try_from(plcc_model::layout::array_bytes(&bounds, &array.element)).ok()?;
            let array = plcc_model::types::ArrayType { bounds, element: array.element.clone(), bytes };
            Some(Hint::Type(DataType::Array(std::rc::Rc::new(array))))
        }
        ty => Some(Hint::Type(ty.clone())),
    }
}

/// Whether an expression is a BOOL whatever the types of its operands are: there is a comparison in it.
fn is_condition(node: &Node) -> bool {
    match &node.kind {
        NodeKind::Unary { op: UnaryOp::Not, operand } => is_condition(operand),
        NodeKind::Binary { op, left, right, .. } => match group(*op) {
            Group::Compare => true,
            Group::Logic => is_condition(left) || is_condition(right),
            Group::Number => false,
        },
        _ => false,
    }
}

/// Operators that need the same type on both sides.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Group {
    Compare,
    Logic,
    Number,
}

const fn group(op: BinaryOp) -> Group {
    match op {
        BinaryOp::Less
        | BinaryOp::Greater
        | BinaryOp::LessEqual
        | BinaryOp::GreaterEqual
        | BinaryOp::Equal
        | BinaryOp::NotEqual => Group::Compare,
        BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => Group::Logic,
        BinaryOp::Power
        | BinaryOp::Multiply
        | BinaryOp::Divide
        | BinaryOp::DivideInteger
        | BinaryOp::Modulo
        | BinaryOp::Add
        | BinaryOp::Subtract => Group::Number,
    }
}
