//! Calls as other languages write them: `timer(IN = start)`, `printf("x")`.

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::scl::ast::{Argument as Given, BinaryOp, Expr as Node, ExprKind as NodeKind, Name, NameForm};

use super::callee::Callee;
use super::function::Named;
use super::pins::has_pin;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::fold;

/// Functions of other languages, and what a program of a PLC does instead.
const FUNCTIONS: [(&[&str], &str); 23] = [
    (
        &["printf", "print", "println", "puts", "echo", "writeln", "write", "cout"],
        "a PLC has no console: assign the value to a variable, and watch it in a watch table or in the trace",
    ),
    (
        &["sleep", "delay", "usleep", "pause"],
        "a program must not wait: start an instance of TON in each cycle, and go on when its output `Q` is TRUE",
    ),
    (
        &["malloc", "alloc", "free", "new", "append", "push"],
        "memory of a PLC is fixed: declare an ARRAY with the most elements that you need",
    ),
    (
        &["now", "time", "millis", "gettime", "gettickcount"],
        "date and time are read by `RD_SYS_T`, in STEP 7 V5 by `READ_CLK`, milliseconds since the start by `TIME_TCK()`",
    ),
    (&["pow", "power", "expt"], "write the operator `**`, as in `a ** b`"),
    (
        &["sizeof"],
        "SCL has no sizes in bytes: count elements with `CountOfElements`, or write the number as a constant",
    ),
    (
        &["adr", "bitadr"],
        "SCL has no addresses of variables: hand the variable itself to a parameter VAR_IN_OUT or VARIANT, or use `REF(…)`",
    ),
    (&["str", "itoa", "to_str", "tostring"], "write the conversion, as in `INT_TO_STRING(…)` or `REAL_TO_STRING(…)`"),
    (&["atoi", "parseint", "atof", "val"], "write the conversion, as in `STRING_TO_INT(…)` or `STRING_TO_REAL(…)`"),
    (&["convert", "cast"], "write the conversion with both types, as in `REAL_TO_INT(…)`"),
    (&["strlen", "length"], "the number of characters is `LEN(…)`"),
    (&["substr", "substring"], "a part of a text is `MID(IN := …, L := …, P := …)`, from character P on"),
    (
        &["instr", "indexof", "strpos"],
        "the place of a text in another one is `FIND(IN1 := …, IN2 := …)`, 0 if it is not there",
    ),
    (
        &["upper", "lower", "toupper", "tolower", "ucase", "lcase"],
        "SCL changes no letters: go through the characters, and add 32 to a capital letter or subtract it from a small one",
    ),
    (&["strcat"], "texts are joined by `CONCAT(IN1 := …, IN2 := …)`"),
    (
        &["strcpy", "memcpy", "memset", "cop", "cps", "fll"],
        "assign the variable as a whole with `:=`, or copy elements with MOVE_BLK, fill them with FILL_BLK",
    ),
    (&["fabs", "labs"], "write `ABS(…)`, for all numbers"),
    (&["ons", "osr", "osri"], "a rising edge is the output `Q` of an instance of R_TRIG, after its call in this cycle"),
    (&["osf", "osfi"], "a falling edge is the output `Q` of an instance of F_TRIG, after its call in this cycle"),
    (&["rto"], "a timer that keeps its time is an instance of TONR, which its input `R` resets"),
    (&["mov", "clr"], "write an assignment, as in `target := value;`"),
    (
        &["s", "r", "reset"],
        "a bit is set and reset by assignments, as in `IF on THEN lamp := TRUE; END_IF; IF off THEN lamp := FALSE; END_IF;`",
    ),
    (&["rand", "random"], "calculate numbers of your own, as in `seed := seed * 25173 + 13849;` with a UINT"),
];

/// Functions of other languages that set or reset a bit, and its value then. SET and RSET are also names of system functions with two
/// parameters.
const BITS: [(&str, &str); 7] = [
    ("set", "TRUE"),
    ("setbit", "TRUE"),
    ("s", "TRUE"),
    ("rset", "FALSE"),
    ("reset", "FALSE"),
    ("resetbit", "FALSE"),
    ("r", "FALSE"),
];

impl SclBinder<'_, '_> {
    /// The arguments with `=` for `:=`, which were meant as names of parameters; none: no argument looks like it.
    pub(super) fn named_with_equals(
        &mut self,
        ctx: &SclBlock,
        target: &Callee,
        given: &[Given],
        callee: &Node,
    ) -> Option<Vec<Given>> {
        let looks = |argument: &Given| match (&argument.name, &argument.value) {
            (None, Some(Node { kind: NodeKind::Binary { op: BinaryOp::Equal, left, .. }, .. })) => {
                matches!(&left.kind, NodeKind::Name(name) if name.form == NameForm::Bare)
            }
            _ => false,
        };
        if !given.iter().any(looks) {
            return None;
        }
        let formals = match target {
            Callee::Block { key, .. } => Some(self.program.interface(*key, callee.span)?),
            Callee::Function(_) => None,
        };
        let is_formal = |name: &str| match (&formals, target) {
            (Some(bound), _) => {
                let folded = fold(name);
                bound.interface.parameters.iter().any(|formal| fold(&formal.name) == folded)
            }
            (None, Callee::Function(Named::Row { row, .. })) => has_pin(row, name),
            (None, _) => false,
        };
        let mut first = None;
        let repaired = given
            .iter()
            .map(|argument| {
                let Some(Node { kind: NodeKind::Binary { left, right, .. }, .. }) =
                    argument.value.as_ref().filter(|_| looks(argument))
                else {
                    return argument.clone();
                };
                match &left.kind {
                    NodeKind::Name(name)
                        if is_formal(&name.text) && !ctx.block.bound.locals.contains_key(&fold(&name.text)) =>
                    {
                        first.get_or_insert((name.clone(), right.span));
                        Given { name: Some(name.clone()), value: Some((**right).clone()), ..argument.clone() }
                    }
                    _ => argument.clone(),
                }
            })
            .collect();
        let (name, value) = first?;
        let (formal, value) = (&name.text, self.program.globals.text(value));
        self.program.report(
            Diagnostic::new(Code::AssignSign, name.span, format!("the parameter `{formal}` gets its value with `:=`"))
                .label("`=` compares")
                .help(format!("write `{formal} := {value}`")),
        );
        Some(repaired)
    }

    /// Reports a call of a function that only other languages have; false: it is not such a call.
    pub(super) fn foreign_function(&mut self, ctx: &SclBlock, callee: &Node, given: &[Given]) -> bool {
        let NodeKind::Name(name) = &callee.kind else { return false };
        if self.bit_function(ctx, name, given) || self.element_of_networks(ctx, name, given) {
            return true;
        }
        let known = |(names, _): &&(&[&str], &str)| names.iter().any(|own| own.eq_ignore_ascii_case(&name.text));
        let Some((_, help)) = FUNCTIONS.iter().find(known).filter(|_| name.form == NameForm::Bare) else {
            return false;
        };
        if self.may_be_of_program(ctx, name)
            || plcc_stdlib::find_tia(&name.text).or_else(|| plcc_stdlib::find_name(&name.text)).is_some()
        {
            return false;
        }
        let title = format!("`{}` is a function of other languages", name.text);
        self.refuse(Code::ForeignForm, name.span, &title, "neither a block of the program nor a function of SCL", help);
        true
    }

    /// Reports `SET(lamp)` and `RESET(lamp)`; false: it is not such a call.
    fn bit_function(&mut self, ctx: &SclBlock, name: &Name, given: &[Given]) -> bool {
        let known = BITS.iter().find(|(own, _)| own.eq_ignore_ascii_case(&name.text));
        let (Some((_, value)), [Given { name: None, value: Some(bit), .. }]) = (known, given) else { return false };
        if name.form != NameForm::Bare || self.may_be_of_program(ctx, name) {
            return false;
        }
        let bit = self.program.globals.text(bit.span);
        let title = if *value == "TRUE" { "a bit is set by an assignment" } else { "a bit is reset by an assignment" };
        self.refuse(
            Code::ForeignForm,
            name.span,
            title,
            "a form of other languages",
            &format!("write `{bit} := {value};`"),
        );
        true
    }

    /// Reports `MOVE(IN := #a, OUT => #b)` and other elements of LAD and FBD whose pins say what SCL has in their place; false: another call.
    fn element_of_networks(&mut self, ctx: &SclBlock, name: &Name, given: &[Given]) -> bool {
        let pin = |wanted: &str| {
            let is_pin =
                |given: &&Given| given.name.as_ref().is_some_and(|name| name.text.eq_ignore_ascii_case(wanted));
            let value = given.iter().find(is_pin)?.value.as_ref()?;
            Some(self.program.globals.text(value.span))
        };
        let range = || Some((pin("MIN")?, pin("VAL")?, pin("MAX")?));
        let moved = || {
            // `OUT`, `OUT1`, `OUT2`
            let is_output =
                |name: &Name| name.text.trim_end_matches(|c: char| c.is_ascii_digit()).eq_ignore_ascii_case("OUT");
            let outputs = given.iter().filter(|given| given.name.as_ref().is_some_and(is_output));
            let value = pin("IN")?;
            let assignment = |target: &Node| format!("{} := {value};", self.program.globals.text(target.span));
            let written: Vec<String> = outputs.filter_map(|given| given.value.as_ref()).map(assignment).collect();
            (!written.is_empty()).then(|| written.join(" "))
        };
        let enabled = |statement: String| match pin("EN") {
            Some(enable) => format!("IF {enable} THEN {statement} END_IF;"),
            None => statement,
        };
        let written = match name.text.to_ascii_uppercase().as_str() {
            "MOVE" => moved().map(enabled),
            "IN_RANGE" => range().map(|(low, value, high)| format!("({low} <= {value} AND {value} <= {high})")),
            "OUT_RANGE" => range().map(|(low, value, high)| format!("({value} < {low} OR {value} > {high})")),
            "INC" => pin("IN_OUT").map(|count| enabled(format!("{count} := {count} + 1;"))),
            "DEC" => pin("IN_OUT").map(|count| enabled(format!("{count} := {count} - 1;"))),
            _ => None,
        };
        let Some(written) = written.filter(|_| name.form == NameForm::Bare && !self.may_be_of_program(ctx, name))
        else {
            return false;
        };
        let title = format!("`{}` is an instruction of LAD and FBD, not of text languages", name.text);
        self.refuse(Code::NotShipped, name.span, &title, "an element of networks", &format!("write `{written}`"));
        true
    }

    /// Whether a called name is that of a variable or a block of the program, or may be that of a block that is not there.
    fn may_be_of_program(&self, ctx: &SclBlock, name: &Name) -> bool {
        let folded = fold(&name.text);
        ctx.block.bound.locals.contains_key(&folded)
            || self.program.globals.names.symbols.contains_key(&folded)
            || self.program.globals.input.partial
    }
}
