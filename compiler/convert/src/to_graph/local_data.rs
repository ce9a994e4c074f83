//! Bits of the local data without a name, in which STEP 7 keeps branches (`= L 20.0`). Networks have no such addresses: the bits become
//! variables.

use std::collections::BTreeMap;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    self, Area, Bound, CodeBlock, CodeKind, Operand, OperandKind, Path, PathRoot, Retain, Section, SectionKind,
    Statement, StatementKind, TypeKind, TypeRef, Variable, Width,
};

/// Bytes of the start information of an OB.
const START_INFORMATION: u32 = 20;

/// A block with a variable in VAR_TEMP for each such bit; `None`: it has none. `Err`: addresses that are more than a bit, or part of a variable.
pub fn named(block: &CodeBlock) -> Result<Option<CodeBlock>, Vec<Diagnostic>> {
    let mut made = block.clone();
    let ast::Code::Stl(networks) = &mut made.code else { return Ok(None) };
    let declared = block.sections.iter().filter(|section| section.kind == SectionKind::Temp);
    let mut declared = declared.flat_map(|section| &section.variables);
    let least = if block.kind == CodeKind::Ob { START_INFORMATION } else { 0 };
    let free = declared.try_fold(0, |at, variable| after(variable, at)).map(|bits| bits.div_ceil(8).max(least));
    let mut names: BTreeMap<(u32, u8), String> = BTreeMap::new();
    let mut messages = Vec::new();
    for operand in networks.iter_mut().flat_map(|network| &mut network.statements).flat_map(operands) {
        let OperandKind::Absolute { area: Area::L, width, byte, bit } = operand.kind else { continue };
        if width != Width::Bit || free.is_none_or(|free| byte < free) {
            messages.push(
                Diagnostic::new(Code::NotConverted, operand.span, "networks have no addresses in the local data")
                    .label("cannot be drawn")
                    .help("declare a variable in VAR_TEMP, and write its name"),
            );
            continue;
        }
        let name = names.entry((byte, bit)).or_insert_with(|| free_name(block, byte, bit)).clone();
        let span = operand.span;
        operand.kind = OperandKind::Path(Path { root: PathRoot::Local { name, span }, parts: Vec::new(), span });
    }
    if !messages.is_empty() {
        return Err(messages);
    }
    if names.is_empty() {
        return Ok(None);
    }
    let at = block.sections.iter().map(|section| section.span.end).max().unwrap_or(block.name.span().end);
    let span = Span { start: at, end: at, ..block.span };
    let bool = TypeRef { kind: TypeKind::Named("BOOL".to_string()), span };
    let variables = names.into_values().map(|name| Variable::new(name, bool.clone(), span));
    match made.sections.iter_mut().find(|section| section.kind == SectionKind::Temp) {
        Some(section) => section.variables.extend(variables),
        None => {
            let variables = variables.collect();
            made.sections.push(Section { kind: SectionKind::Temp, retain: Retain::Unsaid, variables, span });
        }
    }
    Ok(Some(made))
}

fn operands(statement: &mut Statement) -> Vec<&mut Operand> {
    match &mut statement.kind {
        StatementKind::Instruction { operand, .. } => operand.iter_mut().collect(),
        StatementKind::Call(call) => {
            let ast::Call { target, types: _, instance, parameters } = &mut **call;
            let actuals = parameters.iter_mut().filter_map(|parameter| parameter.actual.as_mut());
            std::iter::once(target).chain(instance).chain(actuals).collect()
        }
        StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => Vec::new(),
    }
}

/// A name that no variable of the block has.
fn free_name(block: &CodeBlock, byte: u32, bit: u8) -> String {
    let is_taken = |name: &str| {
        let mut variables = block.sections.iter().flat_map(|section| &section.variables);
        variables.any(|variable| variable.name.eq_ignore_ascii_case(name))
    };
    let mut name = format!("branch_{byte}_{bit}");
    while is_taken(&name) {
        name.push('_');
    }
    name
}

/// The bit after a variable that begins at bit `at` or after it; `None`: its size is not known here.
fn after(variable: &Variable, at: u32) -> Option<u32> {
    if variable.at.is_some() { Some(at) } else { after_type(&variable.ty, at) }
}

fn after_type(ty: &TypeRef, at: u32) -> Option<u32> {
    let even = at.checked_next_multiple_of(16)?;
    let bits_of = |ty: &TypeRef| match &ty.kind {
        TypeKind::Named(name) => {
            Elementary::ALL.iter().find(|known| known.name().eq_ignore_ascii_case(name)).map(|known| known.bits())
        }
        _ => None,
    };
    match &ty.kind {
        TypeKind::Named(_) => match bits_of(ty)? {
            1 => at.checked_add(1),
            8 => at.checked_next_multiple_of(8)?.checked_add(8),
            bits => even.checked_add(bits),
        },
        TypeKind::Array { bounds, element } => {
            let count = bounds.iter().try_fold(1u32, |count, bounds| match bounds {
                (Bound::Number(low, _), Bound::Number(high, _)) => {
                    count.checked_mul(u32::try_from(high.checked_sub(*low)?.checked_add(1)?).ok()?)
                }
                _ => None,
            })?;
            even.checked_add(count.checked_mul(bits_of(element)?)?)?.checked_next_multiple_of(16)
        }
        TypeKind::Struct(members) => {
            members.iter().try_fold(even, |at, member| after(member, at))?.checked_next_multiple_of(16)
        }
        _ => None,
    }
}
