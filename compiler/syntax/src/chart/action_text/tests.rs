//! Rows and how they are read.

use plcc_diag::{Code, FileId};

use super::rows;
use crate::chart::ast::{ActionBody, Call};
use crate::scl::text::expr;

/// One line for each row; the codes of the messages.
fn read(text: &str) -> (Vec<String>, Vec<Code>) {
    let mut messages = Vec::new();
    let found = rows(FileId::default(), text, 0..text.len(), &mut messages);
    let shown = found.iter().map(|row| match &row.comment {
        Some(comment) => format!("{} // {comment}", shown(&row.body)),
        None => shown(&row.body),
    });
    (shown.collect(), messages.into_iter().map(|message| message.code).collect())
}

fn shown(body: &ActionBody) -> String {
    match body {
        ActionBody::Operand(operand) => expr(operand),
        ActionBody::Value { operand, value } => format!("{} := {}", expr(operand), expr(value)),
        ActionBody::All { .. } => "all".to_string(),
        ActionBody::Call(Call { block, instance, parameters, .. }) => {
            let instance = instance.as_ref().map_or(String::new(), |instance| format!(", {}", expr(instance)));
            let parameters: Vec<String> = parameters
                .iter()
                .map(|own| format!("{} := {}", own.name.text, own.value.as_ref().map_or(String::new(), expr)))
                .collect();
            format!("call {}{instance} ({})", expr(block), parameters.join("; "))
        }
        ActionBody::Statements(_) => "statements".to_string(),
        ActionBody::Network(_) => "network".to_string(),
        ActionBody::Error => "error".to_string(),
    }
}

fn rows_of(text: &str, expected: &[&str]) {
    let (found, messages) = read(text);
    assert_eq!(found, expected, "{text}");
    assert_eq!(messages, [], "{text}");
}

#[test]
fn operands_and_values() {
    rows_of("\"Motor on\"", &["\"Motor on\""]);
    rows_of("  #lamp ;\n\n %Q0.1\n", &["#lamp", "%Q0.1"]);
    rows_of("\"Valve, left\", T#2S", &["\"Valve, left\" := TIME#16#7D0"]);
    rows_of("#a[1, 2] := MAX(IN1 := #b, IN2 := 3)", &["#a[1, 2] := MAX(IN1 := #b, IN2 := 3)"]);
    rows_of("s_all", &["all"]);
    rows_of("S_ALLEY", &["S_ALLEY"]);
    rows_of("Q4.0 // lamp, green", &["%Q4.0 // lamp, green"]);
    rows_of("(* first *)\n#x (* \" *)", &["#x // \""]);
}

#[test]
fn calls_go_on_until_they_are_closed() {
    rows_of("CALL \"Mix\"", &["call \"Mix\" ()"]);
    rows_of("CALL FC 10 ()\ncall SFC20", &["call FC10 ()", "call SFC20 ()"]);
    rows_of(
        "CALL \"Ramp\", \"Ramp DB\" (\n  IN1 := 1\n  IN2 := (#a + 2)\n  OUT1 :=\n)\n#b",
        &["call \"Ramp\", \"Ramp DB\" (IN1 := 1; IN2 := (#a + 2); OUT1 := )", "#b"],
    );
    rows_of("CALL FB 1, DB 1 (A := TRUE, \"B c\" := #x)", &["call FB1, DB1 (A := BOOL#16#1; B c := #x)"]);
    rows_of("\"Mix\"(a := 1, b => #c)", &["call \"Mix\" (a := 1; b := #c)"]);
}

#[test]
fn mistakes_are_told_row_by_row() {
    let wrong = [
        "IF #a THEN #b := 1; END_IF",
        "#a := ",
        ", T#2S",
        "#a := #b := #c",
        "CALL",
        "CALL \"F\" (a := 1",
        "CALL \"F\" (a := 1) b",
        "CALL \"F\" (1)",
        "CALL \"F\" ( := 1)",
        "CALL \"F\", \"D\", \"E\"",
        "\"F\"(1)",
    ];
    for text in wrong {
        assert_eq!(read(text), (vec!["error".to_string()], vec![Code::ActionText]), "{text}");
    }
    let (found, messages) = read("#a +\n#b\nIF\n#c");
    assert_eq!(found, ["error", "#b", "error", "#c"]);
    assert_eq!(messages.len(), 2);
}
