//! Times and counts in BCD next to whole numbers in STL: `L C 1`, `L C#15`, `>=I`. The CPU takes the digits as hexadecimal ones, so the result
//! is wrong without an error. A warning is given only where the two statements directly before the calculation load both.

use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_model::{Operand, StlStatement, StlStatementKind};
use plcc_syntax::Elementary;
use plcc_syntax::ast::CellKind;
use plcc_syntax::stl::StlInsn;

use super::numbers::{calculation, operand_text, written};
use crate::bind::declarations::NumberTypes;

/// Up to this the digits of a number are the number itself.
const SAME_MAX: u32 = 9;

/// What a statement loads.
#[derive(Clone, Copy)]
enum Loaded {
    /// Digits in BCD, a constant with these bits: `L C#15`
    Digits(u32),
    /// Digits in BCD of a timer or counter: `LC C 1`
    Cell(CellKind),
    /// A whole number; of a constant its value: `L C 1`, `L 15`
    Whole(Option<u32>),
}

/// Reports whole numbers and BCD in one calculation.
pub fn review(statements: &[StlStatement], declared: &NumberTypes, sources: &SourceMap, found: &mut Vec<Diagnostic>) {
    for window in statements.windows(3) {
        if let [first, second, last] = window
            && let StlStatementKind::Instruction { insn, .. } = &last.kind
            && let Some((false, compares)) = calculation(*insn)
            && let Some(one) = loaded(first, declared, sources)
            && let Some(two) = loaded(second, declared, sources)
        {
            found.extend(match (one, two) {
                (Loaded::Whole(number), bcd) => mixed(second, bcd, first, number, (last.span, compares), sources),
                (bcd, Loaded::Whole(number)) => mixed(first, bcd, second, number, (last.span, compares), sources),
                (Loaded::Digits(_) | Loaded::Cell(_), Loaded::Digits(_) | Loaded::Cell(_)) => None,
            });
        }
    }
}

/// What a statement loads, if its constant, its operand or a declared type says so.
fn loaded(load: &StlStatement, declared: &NumberTypes, sources: &SourceMap) -> Option<Loaded> {
    let StlStatementKind::Instruction { insn, operand } = &load.kind else { return None };
    match (insn, operand) {
        (StlInsn::LoadBcd, Operand::Cell { kind, .. }) => Some(Loaded::Cell(*kind)),
        (StlInsn::Load, Operand::Cell { .. }) => Some(Loaded::Whole(None)),
        (StlInsn::Load, Operand::Const { value, .. }) => {
            let text = operand_text(load.span, sources).to_ascii_uppercase();
            let digits = text.strip_prefix("L#").unwrap_or(&text).trim_start_matches(['+', '-']);
            if ["C#", "S5T#", "S5TIME#"].iter().any(|prefix| text.starts_with(prefix)) {
                return Some(Loaded::Digits(*value));
            }
            let is_number = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'_');
            // 0 has the same digits in both.
            (is_number && *value != 0).then_some(Loaded::Whole(Some(*value)))
        }
        (StlInsn::Load, Operand::Memory { .. }) => {
            let ty = declared.get(&(load.span.file, load.span.end))?;
            matches!(ty, Elementary::Int | Elementary::Dint).then_some(Loaded::Whole(None))
        }
        _ => None,
    }
}

/// `load`: loads `bcd`. `other`: loads a whole number, and `number` if it is a constant. `calculation`: where it is, and whether it compares.
fn mixed(
    load: &StlStatement,
    bcd: Loaded,
    other: &StlStatement,
    number: Option<u32>,
    calculation: (Span, bool),
    sources: &SourceMap,
) -> Option<Diagnostic> {
    let (span, compares) = calculation;
    let (insn, operand) = (written(span, sources), operand_text(load.span, sources));
    let (title, label, help) = match bcd {
        Loaded::Digits(0..=SAME_MAX) | Loaded::Whole(_) => return None,
        Loaded::Digits(value) => (
            format!("`{insn}` takes whole numbers, but `{operand}` is BCD"),
            format!("takes {operand} as {value}"),
            format!("write `L {:X}`{}", value & 0xFFF, units(value, operand)),
        ),
        // The digits of a count compare with a small number as the count does.
        Loaded::Cell(CellKind::Counter) if compares && number.is_some_and(|number| number <= SAME_MAX) => return None,
        Loaded::Cell(_) => (
            format!("`{insn}` takes whole numbers, but `{}` loads BCD", written(load.span, sources)),
            "takes the digits as hexadecimal ones".to_string(),
            format!("write `L {operand}`"),
        ),
    };
    let message = Diagnostic::new(Code::MixedNumbers, span, title).label(label);
    Some(message.also(load.span, "BCD").also(other.span, "a whole number").help(help))
}

/// What a number of units is of, if the constant is a time.
fn units(value: u32, constant: &str) -> String {
    if constant.starts_with(['C', 'c']) {
        return String::new();
    }
    let base = ["10 ms", "100 ms", "1 s", "10 s"][(value >> 12 & 3) as usize];
    format!(", if the timer counts in units of {base}")
}
