//! Elementary inputs of functions of the TIA Portal: networks have copies, statements have the actual parameters themselves.

use std::collections::HashSet;

use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    Bound, CodeKind, Network, Operand, OperandKind, Path, PathPart, PathRoot, SectionKind, Statement, StatementKind,
    TypeKind,
};
use plcc_syntax::stl::{OperandClass, StlInsn};

use super::Maker;
use super::types::elementary;

impl Maker<'_> {
    /// Lets the function copy the inputs that it reads after it has written something else: the caller may have passed that for the input,
    /// too.
    pub(super) fn copy_inputs(&mut self, networks: &mut Vec<Network>) {
        if self.block.kind != CodeKind::Fc || !self.types.is_portal {
            return;
        }
        let inputs = self.inputs_read_late(networks);
        if inputs.is_empty() {
            return;
        }
        self.span = self.block.name.span();
        for (input, ty) in inputs {
            let copy = self.name_of_copy(&input);
            let mut rename = |root: &mut PathRoot| {
                if let PathRoot::Local { name, .. } | PathRoot::Bare { name, .. } = root
                    && name.eq_ignore_ascii_case(&input)
                {
                    name.clone_from(&copy);
                }
            };
            for statement in networks.iter_mut().flat_map(|network| &mut network.statements) {
                roots(statement, &mut rename);
            }
            let (load, store) = match ty == Elementary::Bool {
                true => (StlInsn::And, StlInsn::Assign),
                false => (StlInsn::Load, StlInsn::Transfer),
            };
            let (from, to) = (self.local(&input), self.local(&copy));
            self.push(load, Some(from));
            self.push(store, Some(to));
            self.temporaries.push((copy, ty));
        }
        let statements = std::mem::take(&mut self.statements);
        networks.insert(0, Network { title: None, comment: Vec::new(), statements });
    }

    /// Inputs with their types that a statement reads, or writes, after one that writes outside of the local data.
    fn inputs_read_late(&self, networks: &mut [Network]) -> Vec<(String, Elementary)> {
        let sections = self.block.sections.iter().filter(|section| section.kind == SectionKind::Input);
        let mut inputs: Vec<(String, Elementary, bool)> = sections
            .flat_map(|section| &section.variables)
            .filter_map(|variable| {
                let TypeKind::Named(name) = &variable.ty.kind else { return None };
                // The accumulators have 32 bits.
                let ty = elementary(name).filter(|ty| ty.bits() <= 32)?;
                Some((variable.name.clone(), ty, false))
            })
            .collect();
        // In a loop each statement is after each other one.
        let mut is_late = jumps_back(networks);
        for statement in networks.iter_mut().flat_map(|network| &mut network.statements) {
            let writes = self.writes_outside(statement);
            let is_target = writes && !matches!(statement.kind, StatementKind::Call(_));
            roots(statement, &mut |root: &mut PathRoot| {
                let (PathRoot::Local { name, .. } | PathRoot::Bare { name, .. }) = root else { return };
                for (_, _, found) in inputs.iter_mut().filter(|(input, ..)| input.eq_ignore_ascii_case(name)) {
                    *found |= is_late || is_target;
                }
            });
            is_late |= writes;
        }
        inputs.into_iter().filter(|(.., found)| *found).map(|(name, ty, _)| (name, ty)).collect()
    }

    fn writes_outside(&self, statement: &Statement) -> bool {
        match &statement.kind {
            StatementKind::Call(_) => true,
            StatementKind::Instruction { insn, operand: Some(operand), .. } => {
                let is_write = matches!(
                    insn.operand(),
                    OperandClass::BitWrite
                        | OperandClass::BitWriteOrCounter
                        | OperandClass::BitWriteOrCell
                        | OperandClass::TransferTarget
                        | OperandClass::Block
                );
                is_write && !self.is_local_data(operand)
            }
            StatementKind::Instruction { .. }
            | StatementKind::Empty
            | StatementKind::Pragma(_)
            | StatementKind::Error => false,
        }
    }

    fn is_local_data(&self, operand: &Operand) -> bool {
        let OperandKind::Path(path) = &operand.kind else { return false };
        let (PathRoot::Local { name, .. } | PathRoot::Bare { name, .. }) = &path.root else { return false };
        let sections = self.block.sections.iter().filter(|section| section.kind == SectionKind::Temp);
        let declared = sections.flat_map(|section| &section.variables).map(|variable| variable.name.as_str());
        declared.chain(self.temporaries.iter().map(|(own, _)| own.as_str())).any(|own| own.eq_ignore_ascii_case(name))
    }

    /// A name that the block does not have.
    fn name_of_copy(&self, input: &str) -> String {
        let sections = self.block.sections.iter().flat_map(|section| &section.variables);
        let constants = self.block.constants.iter().map(|constant| constant.name.as_str());
        let declared = sections.map(|variable| variable.name.as_str()).chain(constants);
        let known: Vec<&str> = declared.chain(self.temporaries.iter().map(|(own, _)| own.as_str())).collect();
        let is_free = |name: &String| known.iter().all(|own| !own.eq_ignore_ascii_case(name));
        (1..).map(|number| format!("{input}_{number}")).find(is_free).expect("numbers do not end")
    }

    fn local(&self, name: &str) -> Operand {
        let span = self.span;
        let root = PathRoot::Local { name: name.to_string(), span };
        Operand { kind: OperandKind::Path(Path { root, parts: Vec::new(), span }), span }
    }
}

/// Whether a jump leads to itself or to a statement before it.
fn jumps_back(networks: &[Network]) -> bool {
    let mut passed = HashSet::new();
    for statement in networks.iter().flat_map(|network| &network.statements) {
        if let Some(label) = &statement.label {
            passed.insert(label.name.to_lowercase());
        }
        if let StatementKind::Instruction { operand: Some(operand), .. } = &statement.kind
            && let OperandKind::Label(to) = &operand.kind
            && passed.contains(&to.to_lowercase())
        {
            return true;
        }
    }
    false
}

/// Calls `each` with what the paths of a statement begin with, those of indices too.
fn roots(statement: &mut Statement, each: &mut dyn FnMut(&mut PathRoot)) {
    match &mut statement.kind {
        StatementKind::Instruction { operand, .. } => operand.iter_mut().for_each(|operand| of_operand(operand, each)),
        StatementKind::Call(call) => {
            let actuals = call.parameters.iter_mut().filter_map(|parameter| parameter.actual.as_mut());
            actuals.for_each(|actual| of_operand(actual, each));
        }
        StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => {}
    }
}

fn of_operand(operand: &mut Operand, each: &mut dyn FnMut(&mut PathRoot)) {
    match &mut operand.kind {
        OperandKind::Path(path) | OperandKind::Peripheral(path) | OperandKind::AddressOf(path) => of_path(path, each),
        OperandKind::MemoryIndirect { pointer, .. }
        | OperandKind::CellIndirect { pointer, .. }
        | OperandKind::BlockIndirect { pointer, .. } => of_operand(pointer, each),
        OperandKind::Absolute { .. }
        | OperandKind::Cell { .. }
        | OperandKind::DbAbsolute { .. }
        | OperandKind::RegisterIndirect { .. }
        | OperandKind::Block(_)
        | OperandKind::Literal(_)
        | OperandKind::Status(_)
        | OperandKind::Special(_)
        | OperandKind::Register(_)
        | OperandKind::Label(_)
        | OperandKind::Error => {}
    }
}

fn of_path(path: &mut Path, each: &mut dyn FnMut(&mut PathRoot)) {
    each(&mut path.root);
    for part in &mut path.parts {
        let PathPart::Index { values, .. } = part else { continue };
        for value in values {
            if let Bound::Path(index) = value {
                of_path(index, each);
            }
        }
    }
}
