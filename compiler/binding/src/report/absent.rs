//! Blocks and instructions of STEP 7 and the TIA Portal that plcc does not have, or that SCL writes in another way.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::BlockPrefix;

/// The message for a block of S7-300/400 CPUs that plcc does not have. `shown`: its number with its letters.
pub(super) fn absent_system_block(prefix: BlockPrefix, number: u16, shown: &str, span: Span) -> Option<Diagnostic> {
    use plcc_stdlib::BlockClass;
    let class = match prefix {
        BlockPrefix::Sfc => BlockClass::Sfc,
        BlockPrefix::Sfb => BlockClass::Sfb,
        _ => return None,
    };
    let name = plcc_stdlib::absent_system_block(class, number)?;
    let help = match plcc_stdlib::find_name(name).filter(|block| block.class == BlockClass::Fb) {
        Some(block) => format!("call FB {} `{name}` of the library, which does the same", block.number),
        None => "avoid it, or call another block that does the same".to_string(),
    };
    let message = Diagnostic::new(Code::NotShipped, span, format!("{shown} `{name}` is not included yet"));
    Some(message.label("plcc knows this block but does not include it").help(help))
}

/// The message for the name of an instruction that plcc does not have; none: no instruction has the name.
pub(super) fn absent_instruction(name: &str, span: Span) -> Option<Diagnostic> {
    if let Some((_, help)) = INSTEAD.iter().find(|(own, _)| own.eq_ignore_ascii_case(name.trim())) {
        let title = format!("`{name}` is an instruction of LAD and FBD, not of text languages");
        return Some(Diagnostic::new(Code::NotShipped, span, title).label("an element of networks").help(*help));
    }
    catalogued_instruction(name, span)
}

/// The message for a name that a catalogue of STEP 7 or the TIA Portal has; none: no catalogue has it.
pub(super) fn catalogued_instruction(name: &str, span: Span) -> Option<Diagnostic> {
    let known = plcc_stdlib::catalogued(name);
    let title = match known {
        Some((group, written)) => format!("`{written}` is an instruction of {} that plcc does not have", group.tool),
        None => format!("plcc does not have `{name}`"),
    };
    if let Some((why, help)) = plcc_syntax::network::absent::reason(name) {
        return Some(Diagnostic::new(Code::NotShipped, span, title).label(why).help(help));
    }
    let (group, written) = known?;
    Some(Diagnostic::new(Code::NotShipped, span, title).label(format!("group: {}", group.name)).help(format!(
        "if `{written}` is a block of your own, add the source that defines it; otherwise write a block with this name that does the same"
    )))
}

/// Elements of LAD and FBD that people look for in SCL, and what is written there.
const INSTEAD: &[(&str, &str)] = &[
    ("P_TRIG", "declare a static variable of type R_TRIG, call it with `CLK := …`, and read its output Q"),
    ("N_TRIG", "declare a static variable of type F_TRIG, call it with `CLK := …`, and read its output Q"),
    ("IN_RANGE", "write `low <= value AND value <= high`"),
    ("OUT_RANGE", "write `value < low OR value > high`"),
    ("EQ_Type", "write `TypeOf(a) = TypeOf(b)`"),
    ("NE_Type", "write `TypeOf(a) <> TypeOf(b)`"),
    ("EQ_ElemType", "write `TypeOfElements(a) = TypeOf(b)`"),
    ("NE_ElemType", "write `TypeOfElements(a) <> TypeOf(b)`"),
    ("EQ_TypeOfDB", "write `TypeOfDB(db) = \"type\"`"),
    ("NE_TypeOfDB", "write `TypeOfDB(db) <> \"type\"`"),
    ("IS_NULL", "write `variable = NULL`"),
    ("NOT_NULL", "write `variable <> NULL`"),
    ("S_COMP", "compare texts with `=`, `<>`, `<`, `<=`, `>`, `>=`"),
    ("T_COMP", "compare times and dates with `=`, `<>`, `<`, `<=`, `>`, `>=`"),
    ("CALCULATE", "write the formula itself: `result := a * b + c;`"),
    ("SR", "write `IF reset THEN q := FALSE; ELSIF set THEN q := TRUE; END_IF;` with the order that you need"),
    ("RS", "write `IF set THEN q := TRUE; ELSIF reset THEN q := FALSE; END_IF;` with the order that you need"),
    ("SET_BF", "write a loop that assigns TRUE to each element"),
    ("RESET_BF", "write a loop that assigns FALSE to each element"),
    ("INC", "write `n := n + 1;`"),
    ("DEC", "write `n := n - 1;`"),
    ("NEG", "write `-n`"),
    ("INV", "write `NOT n`"),
    ("MOVE", "write `target := value;`"),
];
