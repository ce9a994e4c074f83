//! Uses in statement lists.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    self, Area, BlockName, BlockPrefix, Bound, CellKind, Operand, OperandKind, PathPart, PathRoot, Statement,
};
use plcc_syntax::literal::Literal;
use plcc_syntax::stl::{OperandClass, StlInsn};

use super::evidence::Hint;
use super::look::{Look, Start, Step, of_constant, of_width, step_of_part};
use super::scl::{parameter_hint, typed};
use crate::bind::globals::names;
use crate::bind::scl::SclBlock;
use crate::bind::stl::StlBinder;
use crate::bind::stl::instance::instance_key;
use crate::bind::stl::settle::Settled;
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::BlockKey;
use plcc_model::Number;
use plcc_model::types::{DataType, ParameterType};

/// The data blocks that statements have opened so far.
#[derive(Default)]
struct Open {
    db: Option<Start>,
    di: Option<Start>,
}

impl Look<'_, '_> {
    pub fn list<'s>(&mut self, ctx: &mut SclBlock, statements: impl Iterator<Item = &'s Statement>) {
        let statements: Vec<&Statement> = statements.collect();
        let mut open = Open::default();
        for (at, statement) in statements.iter().enumerate() {
            match &statement.kind {
                ast::StatementKind::Instruction { insn, operand: Some(operand), .. } => {
                    self.instruction(ctx, &statements, at, *insn, operand, &mut open);
                }
                ast::StatementKind::Call(call) => self.stl_call(ctx, call, &mut open),
                ast::StatementKind::Instruction { operand: None, .. }
                | ast::StatementKind::Empty
                | ast::StatementKind::Pragma(_)
                | ast::StatementKind::Error => {}
            }
        }
    }

    fn instruction(
        &mut self,
        ctx: &mut SclBlock,
        statements: &[&Statement],
        at: usize,
        insn: StlInsn,
        operand: &Operand,
        open: &mut Open,
    ) {
        use OperandClass as Class;
        let bool = typed(Elementary::Bool);
        match insn.operand() {
            Class::DataBlock => {
                if let OperandKind::Block(name) = &operand.kind {
                    let start = start_of_block(name);
                    let di = matches!(name, BlockName::Numbered { prefix: BlockPrefix::Di, .. });
                    let place = if di { &mut open.di } else { &mut open.db };
                    *place = Some(start);
                } else if let OperandKind::Path(path) = &operand.kind
                    && let PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } = &path.root
                {
                    open.db = Some(Start::Global(name.clone()));
                } else {
                    open.db = None;
                }
                self.operand(ctx, operand, Some(&Hint::DataBlock));
            }
            Class::Block => {
                if let Some((start, _, span)) = start_of_operand(ctx, operand) {
                    self.with_shape(ctx, &start, &[], span, &mut |shape| {
                        shape.call.get_or_insert_default();
                    });
                } else {
                    // `UC FC ["Number"]`
                    self.operand(ctx, operand, None);
                }
            }
            Class::Timer => self.operand(ctx, operand, Some(&Hint::Cell(CellKind::Timer))),
            Class::Counter => self.operand(ctx, operand, Some(&Hint::Cell(CellKind::Counter))),
            // A timer or a counter: other uses show which.
            Class::Cell => self.operand(ctx, operand, None),
            Class::Bit | Class::BitOrNone | Class::BitWrite | Class::BitWriteOrCounter | Class::BitWriteOrCell => {
                self.extent(ctx, operand, open);
                self.operand(ctx, operand, Some(&bool));
            }
            Class::LoadSource | Class::TransferTarget => {
                self.extent(ctx, operand, open);
                let hint = self.around(ctx, statements, at);
                self.operand(ctx, operand, hint.as_ref());
            }
            Class::LoadAr1 | Class::LoadAr2 | Class::TransferAr1 | Class::TransferAr2 => {
                self.extent(ctx, operand, open);
                self.operand(ctx, operand, Some(&typed(Elementary::Dword)));
            }
            Class::None
            | Class::PointerOrNone
            | Class::Byte
            | Class::AddConstant
            | Class::WordConstOrNone
            | Class::DwordConstOrNone
            | Class::ShiftCount16
            | Class::ShiftCount32
            | Class::Label => {}
        }
    }

    /// `DBW 10` reaches into the data block that was opened.
    fn extent(&mut self, ctx: &SclBlock, operand: &Operand, open: &Open) {
        if let OperandKind::Absolute { area: area @ (Area::Db | Area::Di), width, byte, .. } = &operand.kind
            && let Some(start) = if *area == Area::Db { open.db.clone() } else { open.di.clone() }
        {
            let end = byte.saturating_add(width.bytes());
            self.with_shape(ctx, &start, &[Step::Absolute(end)], operand.span, &mut |_| {});
        }
    }

    /// What the statements around `L` and `T` show about the value in ACCU1.
    fn around(&mut self, ctx: &mut SclBlock, statements: &[&Statement], at: usize) -> Option<Hint> {
        const FAR: usize = 4;
        let insn_at = |at: usize| match statements.get(at).map(|statement| &statement.kind) {
            Some(ast::StatementKind::Instruction { insn, operand, .. }) => Some((*insn, operand.as_ref())),
            _ => None,
        };
        let loads = matches!(insn_at(at), Some((StlInsn::Load, _)));
        let of_letter = |mnemonic: &str| match mnemonic.chars().last() {
            Some('I') => Some(typed(Elementary::Int)),
            Some('D') => Some(typed(Elementary::Dint)),
            Some('R') => Some(typed(Elementary::Real)),
            _ => None,
        };
        // After a load: the first operation or transfer; before a transfer: the operation or load.
        let range: Vec<usize> =
            if loads { (at + 1..at + 1 + FAR).collect() } else { (at.saturating_sub(FAR)..at).rev().collect() };
        for other in range {
            let Some((insn, operand)) = insn_at(other) else { continue };
            let mnemonic = insn.mnemonic(plcc_syntax::stl::Mnemonics::En);
            match insn {
                StlInsn::Load | StlInsn::Transfer => {
                    let Some(operand) = operand else { continue };
                    match self.operand_hint(ctx, operand) {
                        // `L` loads the time or count of a timer or counter.
                        Some(Hint::Cell(_)) => return Some(Hint::Width(Elementary::Word)),
                        // `L 'AB'` loads characters.
                        Some(Hint::Literal(DataType::String(_))) => return characters(operand),
                        Some(hint) => return Some(hint),
                        None => {}
                    }
                }
                StlInsn::LoadBcd if !loads => return Some(Hint::Width(Elementary::Word)),
                _ if operand.is_none() && mnemonic.chars().next().is_some_and(|first| "+-*/<>=".contains(first)) => {
                    if let Some(hint) = of_letter(mnemonic) {
                        return Some(hint);
                    }
                }
                _ => match mnemonic {
                    "ITD" | "BTI" | "NEGI" | "INVI" if loads => return Some(typed(Elementary::Int)),
                    "DTR" | "DTB" | "NEGD" | "INVD" if loads => return Some(typed(Elementary::Dint)),
                    "RND" | "TRUNC" | "RND+" | "RND-" | "ABS" | "NEGR" | "SQRT" | "SQR" if loads => {
                        return Some(typed(Elementary::Real));
                    }
                    "ITD" | "RND" | "TRUNC" | "RND+" | "RND-" | "BTD" => return Some(typed(Elementary::Dint)),
                    "DTR" | "ABS" | "SQRT" | "SQR" | "NEGR" => return Some(typed(Elementary::Real)),
                    "ITB" | "BTI" => return Some(typed(Elementary::Int)),
                    "AW" | "OW" | "XOW" | "SLW" | "SRW" => return Some(typed(Elementary::Word)),
                    "AD" | "OD" | "XOD" | "SLD" | "SRD" | "RLD" | "RRD" | "LAR1" | "LAR2" => {
                        return Some(typed(Elementary::Dword));
                    }
                    "SP" | "SE" | "SD" | "SS" | "SF" if loads => return Some(typed(Elementary::S5Time)),
                    _ => {}
                },
            }
        }
        None
    }

    /// The type of an operand of STL, if known.
    fn operand_hint(&mut self, ctx: &mut SclBlock, operand: &Operand) -> Option<Hint> {
        let constant = StlBinder::new(self.program).constant_operand(ctx.block, operand);
        let operand = constant.as_ref().unwrap_or(operand);
        let settled = self.quietly(|program| StlBinder::new(program).settle(ctx.block, operand))?;
        Some(match settled {
            Settled::Memory { ty: Some(ty), .. } => typed(ty),
            Settled::Memory { width: ast::Width::Bit, ty: None, .. } => typed(Elementary::Bool),
            Settled::Memory { width, ty: None, .. } => Hint::Width(of_width(width)),
            Settled::Complex { ty, .. } => Hint::Type(ty),
            Settled::Cell { kind, .. } => Hint::Cell(kind),
            Settled::Block { prefix: BlockPrefix::Db | BlockPrefix::Di, .. } => Hint::DataBlock,
            Settled::Block { prefix, .. } => Hint::Type(DataType::Parameter(match prefix {
                BlockPrefix::Fb => ParameterType::BlockFb,
                BlockPrefix::Fc => ParameterType::BlockFc,
                _ => return None,
            })),
            Settled::Literal(literal) => match Constant::of_stl(literal) {
                Some(constant) => of_constant(&constant),
                None => Hint::Type(DataType::Parameter(match literal {
                    plcc_syntax::literal::Literal::Any(_) => ParameterType::Any,
                    _ => ParameterType::Pointer,
                })),
            },
            Settled::Pointer(_) | Settled::ParameterPointer(_) => typed(Elementary::Dword),
            Settled::Status(_) => typed(Elementary::Bool),
            Settled::Special(_) => Hint::Width(Elementary::Word),
            Settled::Register(_) => typed(Elementary::Dword),
            Settled::Label => return None,
        })
    }

    /// Notes the name of an operand, if it is missing.
    pub fn operand(&mut self, ctx: &mut SclBlock, operand: &Operand, hint: Option<&Hint>) {
        match &operand.kind {
            OperandKind::Cell { kind, number } => {
                self.found.cells.insert((*kind, *number));
            }
            OperandKind::MemoryIndirect { pointer, .. } => self.operand(ctx, pointer, Some(&typed(Elementary::Dword))),
            OperandKind::CellIndirect { pointer, .. } | OperandKind::BlockIndirect { pointer, .. } => {
                self.operand(ctx, pointer, Some(&typed(Elementary::Word)));
            }
            _ => {
                for index in indices(operand) {
                    self.operand(ctx, &index, Some(&typed(Elementary::Int)));
                }
                let Some((start, steps, span)) = start_of_operand(ctx, operand) else { return };
                let known = match &start {
                    // Only another use may show whether a missing name is a cell or a bit.
                    Start::Global(name) if self.is_missing(name) => false,
                    // `L "Limit"` loads a tag, not a function of the library.
                    Start::Global(name) if steps.is_empty() && self.program.globals.is_only_in_library(name) => {
                        matches!(hint, Some(Hint::Type(DataType::Parameter(_))))
                    }
                    _ if steps.is_empty() && !self.is_known_block(&start) => false,
                    Start::Block(prefix, number) => {
                        Missing::block(*prefix, *number).is_none_or(|missing| !self.found.things.contains_key(&missing))
                            && self.is_known_start(ctx, &start)
                            && self.operand_hint(ctx, operand).is_some()
                    }
                    _ => self.operand_hint(ctx, operand).is_some(),
                };
                if !known {
                    self.note(ctx, &start, &steps, span, hint);
                }
            }
        }
    }

    /// False for a code block that nothing defines, such as `FB 3` at a parameter of type BLOCK_FB.
    fn is_known_block(&mut self, start: &Start) -> bool {
        let Some((prefix, number)) = self.meant(start).and_then(|meant| meant.numbered()) else { return true };
        names::code_kind(prefix).is_none() || self.is_block(prefix, u32::from(number))
    }

    fn is_known_start(&mut self, _ctx: &SclBlock, start: &Start) -> bool {
        match start {
            Start::Block(BlockPrefix::Db | BlockPrefix::Di, number) => {
                u16::try_from(*number).is_ok_and(|number| number == 0 || self.program.data.blocks.contains_key(&number))
            }
            _ => true,
        }
    }

    fn stl_call(&mut self, ctx: &mut SclBlock, call: &ast::Call, open: &mut Open) {
        // The callee may change the data block register.
        *open = Open::default();
        let Some((start, steps, span)) = start_of_operand(ctx, &call.target) else { return };
        let known = self.quietly(|program| match StlBinder::new(program).settle(ctx.block, &call.target)? {
            Settled::Block { prefix, number: Number::Known(number) } => {
                Some(BlockKey { kind: names::code_kind(prefix)?, number })
            }
            Settled::Complex { ty, .. } => instance_key(&ty),
            _ => None,
        });
        let mut is_missing = false;
        let missing = self.meant(&start);
        self.with_shape(ctx, &start, &steps, span, &mut |shape| {
            is_missing = true;
            let interface = shape.call.get_or_insert_default();
            interface.instance |= call.instance.is_some();
        });
        if let Some(operand) = &call.instance
            && let Some((instance, steps, span)) = start_of_operand(ctx, operand)
        {
            let known = known.and_then(|key| self.named_block(&start, key));
            self.instance(ctx, &instance, &steps, span, missing.filter(|_| is_missing), known);
        }
        if is_missing {
            for parameter in &call.parameters {
                let stated = match parameter.name.eq_ignore_ascii_case("RET_VAL") {
                    _ if !steps.is_empty() => None,
                    true => self.stated_value(ctx, &start),
                    false => self.stated(ctx, &start, &parameter.name),
                };
                let known = parameter.actual.as_ref().and_then(|actual| self.operand_hint(ctx, actual)).or(stated);
                let mut wanted = None;
                self.with_shape(ctx, &start, &steps, span, &mut |shape| {
                    let formal = shape.formal(&parameter.name, false);
                    formal.learn(known.as_ref());
                    wanted.clone_from(&formal.ty);
                });
                if let Some(actual) = &parameter.actual {
                    self.operand(ctx, actual, wanted.map(Hint::Type).as_ref());
                }
            }
            return;
        }
        let bound = known.and_then(|key| self.quietly(|program| program.interface(key, span)));
        for parameter in &call.parameters {
            let Some(actual) = &parameter.actual else { continue };
            let formal = bound.as_ref().and_then(|bound| {
                bound.interface.parameters.iter().find(|formal| fold(&formal.name) == fold(&parameter.name))
            });
            let hint = formal.and_then(|formal| parameter_hint(&formal.ty));
            self.operand(ctx, actual, hint.as_ref());
        }
    }

    /// How a declaration names a block that is known, and whether it is one of the library.
    fn named_block(&self, called: &Start, key: BlockKey) -> Option<(Missing, bool)> {
        let library = self.program.globals.library_block(key);
        let name = match (library, called) {
            // No source can name an instruction of the TIA Portal by a number.
            (Some(block), _) if block.is_tia() => Missing::name(block.name),
            // Its number may change, as long as no source fixes it.
            (None, Start::Global(name)) => Missing::name(name),
            _ => Missing::block(names::kind_prefix(key.kind), u32::from(key.number))?,
        };
        Some((name, library.is_some()))
    }

    /// The instance of a call: of a block that is missing, or of one that is known.
    fn instance(
        &mut self,
        ctx: &SclBlock,
        start: &Start,
        steps: &[Step],
        span: Span,
        missing: Option<Missing>,
        known: Option<(Missing, bool)>,
    ) {
        let in_library = known.as_ref().is_some_and(|(_, in_library)| *in_library);
        // The binder creates the instance of a known block. A component can only be one of a block of the library.
        let is_new = match steps {
            [] => {
                missing.is_some() || matches!(start, Start::Global(name) if self.program.globals.global(name).is_none())
            }
            _ => missing.is_none() && in_library,
        };
        if !is_new {
            return;
        }
        let of = missing.or(known.map(|(name, _)| name));
        let is_whole = steps.is_empty();
        self.with_shape(ctx, start, steps, span, &mut |shape| {
            shape.is_db |= is_whole;
            shape.of = shape.of.take().or(of.clone());
        });
    }
}

/// The type of the characters that `L` loads.
fn characters(operand: &Operand) -> Option<Hint> {
    let OperandKind::Literal(Literal::Text(text)) = &operand.kind else { return None };
    Some(Hint::Literal(DataType::Elementary(match text.len() {
        0 | 1 => Elementary::Char,
        2 => Elementary::Word,
        _ => Elementary::Dword,
    })))
}

fn start_of_block(name: &BlockName) -> Start {
    match name {
        BlockName::Numbered { prefix, number, .. } => Start::Block(*prefix, *number),
        BlockName::Symbol { name, .. } => Start::Global(name.clone()),
    }
}

/// The names of its indices, as operands.
fn indices(operand: &Operand) -> Vec<Operand> {
    let OperandKind::Path(path) = &operand.kind else { return Vec::new() };
    let values = path.parts.iter().flat_map(|part| match part {
        PathPart::Index { values, .. } => values.as_slice(),
        PathPart::Member { .. } => &[],
    });
    let named = |value: &Bound| match value {
        Bound::Path(path) => Some(Operand { kind: OperandKind::Path((**path).clone()), span: path.span }),
        Bound::Number(..) | Bound::Name(..) | Bound::Expr(_) => None,
    };
    values.filter_map(named).collect()
}

/// The start of an operand, and its steps; none for operands without a name.
fn start_of_operand(ctx: &SclBlock, operand: &Operand) -> Option<(Start, Vec<Step>, Span)> {
    match &operand.kind {
        OperandKind::Block(name) => Some((start_of_block(name), Vec::new(), operand.span)),
        OperandKind::DbAbsolute { db, width, byte, .. } => {
            Some((start_of_block(db), vec![Step::Absolute(byte.saturating_add(width.bytes()))], operand.span))
        }
        OperandKind::Path(path) | OperandKind::AddressOf(path) | OperandKind::Peripheral(path) => {
            let steps: Vec<Step> = path.parts.iter().map(step_of_part).collect();
            let (start, span) = match &path.root {
                PathRoot::Local { name, span } => (Start::Local(name.clone()), *span),
                PathRoot::Bare { name, span } if ctx.block.bound.locals.contains_key(&fold(name)) => {
                    (Start::Local(name.clone()), *span)
                }
                PathRoot::Bare { name, span } | PathRoot::Quoted { name, span } => (Start::Global(name.clone()), *span),
                PathRoot::Block(name) => (start_of_block(name), name.span()),
            };
            Some((start, steps, span))
        }
        _ => None,
    }
}
