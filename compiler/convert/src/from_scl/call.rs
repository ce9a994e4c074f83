//! Calls of blocks. Source: SCL reference, calls; STL reference, CALL.

use plcc_abi::image::{BlockKind, Family};
use plcc_diag::Span;
use plcc_model::scl::{
    Access, Actual, Argument, Base, Call, Complex, Conversion, Expr, ExprKind, IndexedArea, Instance,
};
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{BlockKey, Body, CodeBlock, Direction, Number, Parameter, Place, PlaceArea, layout};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, CellKind, Operand, OperandKind, Path, PathRoot, StatusOperand};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::address::Target;
use super::alias;
use super::number_text;
use super::text::{TEXT_MAX, TextInstruction, is_passed};
use crate::to_stl::library::is_block;

/// Blocks of the library with higher numbers have them from plcc.
const SYSTEM_NUMBER_MAX: u16 = 999;
/// SFB 0 to SFB 2 are counters, SFB 3 to SFB 5 timers.
const COUNTER_OR_TIMER_MAX: u16 = 5;

/// What an output of the call is copied to after it.
struct Back<'m> {
    /// Place of the formal parameter.
    parameter: usize,
    access: &'m Access,
    /// Its address, as its indices are before the call: the callee may change them.
    target: Target,
    /// The formal parameter has a value when the callee begins.
    has_value: bool,
    from: Operand,
    formal: Elementary,
    conversion: Option<Conversion>,
}

impl Maker<'_> {
    /// The statements of a call; returns the variable with its result, if it has one.
    pub fn call(&mut self, call: &Call) -> Option<Operand> {
        let program = self.program;
        let callee = program.block(call.target)?;
        let instruction = self.text_instruction(callee, call);
        let result_of = callee
            .interface
            .parameters
            .iter()
            .position(|formal| formal.direction == Direction::Output && formal.name == "RET_VAL");
        let supplied = |index: usize| call.arguments.iter().any(|argument| argument.parameter == index);
        let result_index = result_of.filter(|index| !supplied(*index));
        let result = match result_index.map(|index| &callee.interface.parameters[index].ty) {
            None => None,
            Some(DataType::Elementary(ty)) => Some((self.temporary(*ty), Some(*ty))),
            Some(DataType::String(TEXT_MAX)) => Some((self.empty_text(), None)),
            Some(_) => {
                self.refuse(call.span, "a function whose result is not elementary", "give it an output instead");
                return None;
            }
        };
        let skip = call.enable.as_ref().map(|enable| self.enable(enable, &result, call));
        let mut backs = Vec::new();
        let mut parameters = Vec::new();
        for argument in &call.arguments {
            let formal = &callee.interface.parameters[argument.parameter];
            let number = number_text::number(callee, call).filter(|_| instruction.is_some() && formal.name == "IN");
            let actual = match number {
                Some((_, value)) => Some(self.passed(value, self.changes_nothing(call))),
                None => self.actual(call, callee, formal, argument, &mut backs),
            };
            if self.refused {
                return result.map(|(operand, _)| operand);
            }
            parameters.push((argument.parameter, formal.name.clone(), actual));
        }
        // After all arguments, which may contain calls that change the value.
        backs.iter().filter(|back| back.has_value).for_each(|back| self.preload(back));
        backs.sort_by_key(|back| back.parameter);
        if let (Some(index), Some((operand, _))) = (result_index, &result) {
            parameters.push((index, "RET_VAL".to_string(), Some(operand.clone())));
        }
        parameters.sort_by_key(|(index, _, _)| *index);
        let parameters = parameters
            .into_iter()
            .map(|(_, own, actual)| {
                let name = match instruction {
                    Some(_) => TextInstruction::parameter(&own).to_string(),
                    None => own,
                };
                ast::Parameter { name, name_span: self.span, actual }
            })
            .collect();
        // As its indices are before the call.
        let eno = call.eno.as_ref().and_then(|access| self.target(access, false));
        let (target, instance) = match instruction {
            Some(instruction) => (self.called(instruction), None),
            None => self.callee(call, callee)?,
        };
        let types = instruction.map(TextInstruction::types).unwrap_or_default();
        let made = ast::Call { target, types, instance, parameters };
        // A block that is made from networks does not change the BR if nothing failed.
        let reads_eno = eno.is_some() || (self.last_eno.is_some() && !call.is_operation);
        if reads_eno && !callee.library && matches!(callee.body, Body::Scl(_)) && !self.is_classic_cpu() {
            self.push(StlInsn::SetRlo, None);
            self.push(StlInsn::Save, None);
        }
        self.push_kind(ast::StatementKind::Call(Box::new(made)));
        self.note_eno(call, eno);
        for back in backs {
            self.take_back(&back);
        }
        if let Some(skip) = skip {
            self.label(&skip, self.span.start);
            self.close_labels();
        }
        result.map(|(operand, _)| operand)
    }

    /// EN: without it the call is skipped, its result and ENO are 0; a text is empty already. Returns the label after the call.
    fn enable(&mut self, enable: &Expr, result: &Option<(Operand, Option<Elementary>)>, call: &Call) -> String {
        let (label, run) = (self.new_label(), self.new_label());
        self.condition(enable);
        self.jump(StlInsn::JumpIf, &run);
        if let Some((operand, Some(ty))) = result {
            let zero = self.constant(*ty, 0);
            match ty {
                Elementary::Bool => {
                    self.push(StlInsn::ClearRlo, None);
                    self.push(StlInsn::Assign, Some(operand.clone()));
                }
                _ => {
                    self.push(StlInsn::Load, Some(zero));
                    self.push(StlInsn::Transfer, Some(operand.clone()));
                }
            }
        }
        let eno = call.eno.as_ref().and_then(|access| self.target(access, true));
        let eno = eno.map(|target| self.reach(&target, Elementary::Bool));
        for target in eno.into_iter().chain(self.last_eno.clone()) {
            self.push(StlInsn::ClearRlo, None);
            self.push(StlInsn::Assign, Some(target));
        }
        self.jump(StlInsn::Jump, &label);
        self.label(&run, self.span.start);
        label
    }

    /// ENO of the callee is the BR. That of an operation is not what ENO of S7-SCL is about.
    fn note_eno(&mut self, call: &Call, eno: Option<Target>) {
        let br = Operand { kind: OperandKind::Status(StatusOperand::Br), span: self.span };
        if let Some(target) = eno {
            self.push(StlInsn::And, Some(br.clone()));
            let operand = self.reach(&target, Elementary::Bool);
            self.push(StlInsn::Assign, Some(operand));
        }
        if let Some(last) = self.last_eno.clone().filter(|_| !call.is_operation) {
            self.push(StlInsn::And, Some(br));
            self.push(StlInsn::Assign, Some(last));
        }
    }

    fn take_back(&mut self, back: &Back) {
        let to = back.access.elementary().unwrap_or(back.formal);
        let is_bool = [back.formal, to].contains(&Elementary::Bool);
        let Some(conversion) = back.conversion else {
            let operand = self.reach(&back.target, to);
            return self.load_and_store(to, back.from.clone(), operand);
        };
        if is_bool {
            return self.refuse(back.access.span, "this conversion of an output", "use a variable of its type");
        }
        self.push(StlInsn::Load, Some(back.from.clone()));
        self.convert_loaded(conversion, back.formal, to, back.access.span);
        let operand = self.reach(&back.target, to);
        self.push(StlInsn::Transfer, Some(operand));
    }

    /// `FC 1`, `"Motor"`; `FB 1, DB 5`; `#motor`.
    fn callee(&mut self, call: &Call, callee: &CodeBlock) -> Option<(Operand, Option<Operand>)> {
        let here = self.span;
        if !self.has_name_in_stl(call, callee) {
            let what = format!("a call of `{}`, whose name may mean another block there", callee.name);
            self.refuse(call.span, what, "call it in a block of SCL");
            return None;
        }
        if let Some(Instance::Variable(access)) = &call.instance {
            let is_own = matches!(access.base, Base::Place(Place::Instance { .. }));
            // STL of an S7-1500 calls an instance in a data block by the name of its block, too.
            let is_shared = matches!(access.base, Base::Place(Place::Db { .. }))
                && self.program.profile.family == Family::S71500
                && !callee.name.is_empty();
            if !self.is_direct(access) || !is_own && !is_shared {
                let help = "declare the instance as static data of the block";
                self.refuse(access.span, "a call of this instance", help);
                return None;
            }
            let operand = self.operand(access)?;
            if is_own && !self.has_common_type(&operand) {
                return Some((operand, None));
            }
            return Some((self.named_block(&callee.name), Some(operand)));
        }
        let prefix = match callee.kind {
            BlockKind::Fc => BlockPrefix::Fc,
            BlockKind::Fb => BlockPrefix::Fb,
            BlockKind::Sfc => BlockPrefix::Sfc,
            BlockKind::Sfb => BlockPrefix::Sfb,
            BlockKind::Ob | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => {
                self.refuse(call.span, "a call of this block", "call an FC or FB");
                return None;
            }
        };
        let is_system = matches!(prefix, BlockPrefix::Sfc | BlockPrefix::Sfb) && !self.is_called_by_name(call, callee);
        let kind = match is_system || callee.name.is_empty() {
            true => {
                let number = u32::from(callee.number);
                OperandKind::Block(BlockName::Numbered { prefix, number, span: here })
            }
            false => {
                let root = PathRoot::Quoted { name: callee.name.clone(), span: here };
                OperandKind::Path(Path { root, parts: Vec::new(), span: here })
            }
        };
        let instance = match &call.instance {
            Some(Instance::Db(number)) => {
                let kind = OperandKind::Block(self.db_name(*number, call.span));
                Some(Operand { kind, span: here })
            }
            Some(Instance::Variable(_)) | None => None,
        };
        Some((Operand { kind, span: here }, instance))
    }

    /// A statement list that names the block or the instance calls the same: the type of the instance is that of the block, and names of
    /// the library mean the same in both languages.
    fn has_name_in_stl(&self, call: &Call, callee: &CodeBlock) -> bool {
        let key = callee.key();
        let wanted = Some((key.kind == BlockKind::Sfb, key.number));
        let is_own = match &call.instance {
            None => true,
            Some(Instance::Db(number)) => self.program.db(*number).is_some_and(|db| {
                let of = db.instance_of.map(|key| (key.kind == BlockKind::Sfb, key.number));
                of == wanted || self.shares_data(of, callee)
            }),
            Some(Instance::Variable(access)) => {
                let DataType::Struct(structure) = &access.ty else { return false };
                structure.instance_of == wanted || self.shares_data(structure.instance_of, callee)
            }
        };
        let is_classic = matches!(self.program.profile.family, Family::S7300 | Family::S7400) && !self.is_portal;
        let has_number = callee.number <= SYSTEM_NUMBER_MAX && (is_classic || call.instance.is_none());
        is_own && (!callee.library || has_number || self.is_called_by_name(call, callee))
    }

    /// The data of a block is that of all timers or counters with one type: an IEC_TIMER is declared as TONR.
    fn shares_data(&self, of: Option<(bool, u16)>, callee: &CodeBlock) -> bool {
        let Some((is_sfb, number)) = of.filter(|_| callee.library) else { return false };
        let kind = if is_sfb { BlockKind::Sfb } else { BlockKind::Fb };
        let Some(common) = self.program.block(BlockKey { kind, number }).filter(|block| block.library) else {
            return false;
        };
        let (own, other) = (split_type(&common.name), split_type(&callee.name));
        let words: &[&str] = match own.0 {
            "TONR" => &["TP", "TON", "TOF"],
            "CTUD" => &["CTU", "CTD"],
            _ => return false,
        };
        words.contains(&other.0) && own.1 == other.1
    }

    /// A variable of the block that is declared as IEC_TIMER or the like: the call names the block, too.
    fn has_common_type(&self, operand: &Operand) -> bool {
        let OperandKind::Path(Path { root: PathRoot::Local { name, .. }, parts, .. }) = &operand.kind else {
            return false;
        };
        let mut variables = self.tree.sections.iter().flat_map(|section| &section.variables);
        let variable = variables.find(|variable| variable.name.eq_ignore_ascii_case(name));
        let ty = match variable.map(|variable| &variable.ty.kind) {
            Some(ast::TypeKind::Named(name) | ast::TypeKind::Block(BlockName::Symbol { name, .. })) => name,
            _ => return false,
        };
        parts.is_empty() && ty.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("IEC_"))
    }

    /// A block of the library that STL of an S7-1500 calls by the name that it has in SCL: one with an instance, or one of the clock and of
    /// interrupts.
    fn is_called_by_name(&self, call: &Call, callee: &CodeBlock) -> bool {
        let has_type = |ty: &DataType| match ty {
            DataType::Elementary(ty) => ty.bits() <= 32,
            DataType::Struct(structure) => structure.name.eq_ignore_ascii_case("DTL"),
            _ => false,
        };
        let is_function =
            || is_block(&callee.name) && callee.interface.parameters.iter().all(|formal| has_type(&formal.ty));
        // `TON` is SFB 4 in SCL of STEP 7 V5, and another timer in STL of an S7-1500.
        let is_classic = callee.kind == BlockKind::Sfb && callee.number <= COUNTER_OR_TIMER_MAX;
        callee.library
            && !is_classic
            && !callee.name.is_empty()
            && self.program.profile.family == Family::S71500
            && (call.instance.is_some() || (callee.number > SYSTEM_NUMBER_MAX && is_function()))
    }

    // Actual parameters.

    fn actual<'m>(
        &mut self,
        call: &Call,
        callee: &CodeBlock,
        formal: &Parameter,
        argument: &'m Argument,
        backs: &mut Vec<Back<'m>>,
    ) -> Option<Operand> {
        match &argument.actual {
            Actual::Value(value) => Some(self.input_value(call, callee, value)),
            Actual::Variable { access, back } => {
                let DataType::Elementary(ty) = formal.ty else { return self.no_actual(argument.span) };
                if back.is_none() && self.is_direct(access) {
                    let named = self.named(access)?;
                    if named.exact && access.elementary() == Some(ty) {
                        return Some(named.operand);
                    }
                }
                let is_instance = matches!(callee.kind, BlockKind::Fb | BlockKind::Sfb);
                let is_copy = !is_instance && back.is_none() && !access.indices.is_empty();
                if is_copy && alias::uses_array(self.program, callee, access) {
                    let what = "an element of an array that the function uses by its name, too";
                    self.refuse(argument.span, what, "STL passes a copy: pass a variable, or the index instead");
                    return None;
                }
                let from = self.temporary(ty);
                let target = self.target(access, false)?;
                let has_same_bits = matches!(back, None | Some(Conversion::Bits { .. }));
                backs.push(Back {
                    parameter: argument.parameter,
                    access,
                    target,
                    has_value: formal.direction == Direction::InOut || (!is_instance && has_same_bits),
                    from: from.clone(),
                    formal: ty,
                    conversion: *back,
                });
                Some(from)
            }
            Actual::Complex(Complex::Const(bytes)) => {
                self.text_actual(call, callee, formal, bytes).or_else(|| self.no_actual(argument.span))
            }
            Actual::Complex(Complex::Call(inner)) if formal.ty == DataType::String(TEXT_MAX) => self.call(inner),
            Actual::Complex(Complex::Variable(access)) | Actual::Reference(access) => {
                if !self.is_direct(access) || matches!(formal.ty, DataType::OpenArray(_)) {
                    return self.no_actual(argument.span);
                }
                if self.may_change_later(call, callee, formal, argument) {
                    let what =
                        "an array, structure or text before an argument that calls a function which changes data";
                    self.refuse(argument.span, what, "call the function in a statement before this one");
                    return None;
                }
                if !is_passed(callee, formal, &access.ty) {
                    let help = format!("pass a variable of type {}", layout::type_name(&formal.ty));
                    self.refuse(argument.span, "a text of another length than its parameter", &help);
                    return None;
                }
                self.operand(access)
            }
            Actual::Number(number) => self.number_actual(formal, number, argument.span),
            Actual::PointerBytes(bytes) => match bytes[..] {
                [a, b, c, d, e, f, g, h, i, j] => {
                    let kind = OperandKind::Literal(Literal::Any([a, b, c, d, e, f, g, h, i, j]));
                    Some(Operand { kind, span: self.span })
                }
                [db_high, db_low, a, b, c, d] => {
                    let (db, pointer) = (u16::from_be_bytes([db_high, db_low]), u32::from_be_bytes([a, b, c, d]));
                    let kind = OperandKind::Literal(Literal::AreaPointer { db, pointer });
                    Some(Operand { kind, span: self.span })
                }
                _ => self.no_actual(argument.span),
            },
            Actual::PointerTo { access, .. } | Actual::PointerCopy(access) if self.is_direct(access) => {
                self.operand(access)
            }
            Actual::PointerToValue { value, .. } => {
                match value.ty {
                    Elementary::Bool => self.condition(value),
                    _ => self.number(value),
                }
                Some(self.keep(value.ty))
            }
            Actual::Dropped => match (&formal.ty, callee.kind) {
                (DataType::Elementary(ty), BlockKind::Fc | BlockKind::Sfc) => Some(self.temporary(*ty)),
                _ => None,
            },
            Actual::Complex(_)
            | Actual::PointerTo { .. }
            | Actual::PointerCopy(_)
            | Actual::PointerToComplex { .. }
            | Actual::Variant(..) => self.no_actual(argument.span),
        }
    }

    fn no_actual(&mut self, span: Span) -> Option<Operand> {
        self.refuse(span, "this actual parameter", "store the value in a variable and pass that");
        None
    }

    /// An input: a variable or constant itself, if the callee gets the value that it has at the call.
    fn input_value(&mut self, call: &Call, callee: &CodeBlock, value: &Expr) -> Operand {
        if !self.has_type(value) {
            return self.constant(value.ty, 0);
        }
        match &value.kind {
            // No constant of STL has the type.
            ExprKind::Const(_) if value.ty == Elementary::Wchar => {}
            ExprKind::Const(bits) if !value.ty.is_of_s7300() => return self.whole_number(value.ty, *bits),
            ExprKind::Const(bits) if value.ty != Elementary::Real || f32::from_bits(*bits as u32).is_finite() => {
                return self.constant(value.ty, *bits);
            }
            ExprKind::Load(access) if self.is_direct(access) && self.stays(call, callee, access) => {
                if let Some(named) = self.named(access)
                    && named.exact
                {
                    return named.operand;
                }
            }
            _ => {}
        }
        match value.ty {
            Elementary::Bool => self.condition(value),
            _ => self.number(value),
        }
        self.keep(value.ty)
    }

    /// An integer that has the type of the formal parameter.
    pub fn whole_number(&self, ty: Elementary, bits: u64) -> Operand {
        let above = 64 - ty.bits();
        let number = match ty.is_signed() {
            true => (bits << above).cast_signed() >> above,
            false => bits.cast_signed(),
        };
        super::code::number(number, self.span)
    }

    /// Neither the callee nor another argument changes the variable before the callee reads it.
    fn stays(&self, call: &Call, callee: &CodeBlock, access: &Access) -> bool {
        if !self.changes_nothing(call) {
            return false;
        }
        match (callee.kind, &callee.body) {
            // They get copies.
            (BlockKind::Fb | BlockKind::Sfb | BlockKind::Sfc, _) | (_, Body::Runtime) => true,
            (_, Body::Scl(body)) if !body.inputs_in_place => true,
            // An FC gets a reference, and may write to the same variable by another one.
            (
                BlockKind::Ob | BlockKind::Db | BlockKind::Fc | BlockKind::Sbr | BlockKind::Int,
                Body::Stl(_) | Body::Scl(_) | Body::S7200(_),
            ) => {
                let writes = |argument: &Argument| match &argument.actual {
                    Actual::Variable { access: other, .. } | Actual::Reference(other) => may_overlap(other, access),
                    _ => false,
                };
                matches!(access.base, Base::Place(Place::L { .. })) && !call.arguments.iter().any(writes)
            }
        }
    }

    /// The value that a variable has before the call, if it is of the same size: a function may leave an output as it is.
    fn preload(&mut self, back: &Back) {
        let is_write_only = matches!(
            back.access.base,
            Base::Place(Place::Pq { .. }) | Base::Indexed { area: IndexedArea::Memory(PlaceArea::Pq), .. }
        );
        if !is_write_only && back.access.elementary().is_some_and(|ty| ty.bits() == back.formal.bits()) {
            let operand = self.reach(&back.target, back.formal);
            self.load_and_store(back.formal, operand, back.from.clone());
        }
    }

    fn number_actual(&mut self, formal: &Parameter, number: &Number, span: Span) -> Option<Operand> {
        let DataType::Parameter(kind) = formal.ty else { return self.no_actual(span) };
        let prefix = match kind {
            ParameterType::Timer => return self.cell(CellKind::Timer, number, span),
            ParameterType::Counter => return self.cell(CellKind::Counter, number, span),
            ParameterType::BlockFb => BlockPrefix::Fb,
            ParameterType::BlockFc => BlockPrefix::Fc,
            ParameterType::BlockDb => BlockPrefix::Db,
            ParameterType::BlockSdb | ParameterType::Pointer | ParameterType::Any | ParameterType::Variant => {
                return self.no_actual(span);
            }
        };
        let kind = match number {
            Number::Known(number) if prefix == BlockPrefix::Db => OperandKind::Block(self.db_name(*number, span)),
            Number::Known(number) => {
                OperandKind::Block(BlockName::Numbered { prefix, number: u32::from(*number), span: self.span })
            }
            Number::Parameter(parameter) => return Some(self.parameter(*parameter)),
            Number::Word(_) => return self.no_actual(span),
        };
        Some(Operand { kind, span: self.span })
    }
}

/// `CTU` and `INT` of `CTU_INT`; the timers of TIME have no type in their name.
fn split_type(name: &str) -> (&str, &str) {
    name.split_once('_').unwrap_or((name, "TIME"))
}

/// Two variables may share memory.
fn may_overlap(a: &Access, b: &Access) -> bool {
    match (&a.base, &b.base) {
        (Base::Place(Place::L { byte: first, .. }), Base::Place(Place::L { byte: second, .. })) => {
            !a.indices.is_empty() || !b.indices.is_empty() || first.abs_diff(*second) < 4
        }
        _ => true,
    }
}
