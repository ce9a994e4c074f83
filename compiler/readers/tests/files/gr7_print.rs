//! A chart that is read, printed in one form and read again is the same chart.

use std::fmt::Write as _;

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse};
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, OperandKind, SourceUnit, Width};
use plcc_syntax::chart::ast::*;
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, Name, NameForm, UnaryOp};
use plcc_syntax::{Elementary, Language, ast_text};

const SOURCES: [&str; 3] = [
    include_str!("../../../../tests/parse/graph/forms.gr7"),
    include_str!("../../../../tests/parse/graph/door.gr7"),
    include_str!("../../../../tests/parse/graph/star_delta.gr7"),
];

fn read(text: &str) -> SourceUnit {
    let options = ReadOptions { language: Some(Language::Graph), ..ReadOptions::default() };
    let (unit, diagnostics) = parse(FileId(0), text, &options);
    let errors: Vec<_> = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).collect();
    assert!(errors.is_empty(), "{errors:?}\n{text}");
    unit
}

#[test]
fn printed_charts_read_the_same() {
    for source in SOURCES {
        let unit = read(source);
        let printed = print(source, &unit);
        let again = read(&printed);
        assert_eq!(ast_text(&unit), ast_text(&again), "{printed}");
        assert_eq!(printed, print(&printed, &again));
    }
}

#[test]
fn line_ends_do_not_matter() {
    let source = include_str!("../../../../tests/parse/graph/door.gr7");
    let wanted = ast_text(&read(source));
    for end in ["\r\n", "\r"] {
        assert_eq!(ast_text(&read(&source.replace('\n', end))), wanted, "{end:?}");
    }
    let ends = ["\r", "\r\n", "\n", "\r\r\n"];
    let mixed: String = source.lines().zip(ends.iter().cycle()).flat_map(|(line, end)| [line, end]).collect();
    assert_eq!(ast_text(&read(&mixed)), wanted);
}

#[test]
fn long_conditions_are_read() {
    for count in [100, 3000] {
        let terms: Vec<String> = (0..count).map(|n| format!("(NOT I{}.{} OR (M{n}.0 ))", n % 100, n % 8)).collect();
        let text = format!(
            "FUNCTION_BLOCK FB1\nTRANSITION T1 (*$_NUM 1*)\nFROM S1\nCONDITION := {}\nEND_TRANSITION\nEND_FUNCTION_BLOCK\n",
            terms.join("AND ")
        );
        let found = ast_text(&read(&text));
        assert_eq!(found.matches(" AND ").count(), count - 1);
    }
}

fn print(source: &str, unit: &SourceUnit) -> String {
    let mut out = String::new();
    for block in &unit.blocks {
        let Block::Code(block) = block else { panic!("a chart is not data") };
        block_text(&mut out, source, block);
    }
    out
}

fn block_text(out: &mut String, source: &str, block: &CodeBlock) {
    let Code::Chart(chart) = &block.code else { panic!("a block without a chart") };
    let block_name = match &block.name {
        BlockName::Numbered { number, .. } => format!("FB{number}"),
        BlockName::Symbol { name, .. } => format!("\"{name}\""),
    };
    writeln!(out, "FUNCTION_BLOCK {block_name}").unwrap();
    comment(out, &block.header.comment);
    settings(out, &chart.settings);
    let fields = [("AUTHOR", &block.header.author), ("VERSION", &block.header.version)];
    if let Some(title) = &block.header.title {
        writeln!(out, "TITLE = {title}").unwrap();
    }
    for (field, value) in fields {
        if let Some(value) = value {
            writeln!(out, "{field} : {value}").unwrap();
        }
    }
    for (name, value) in &block.header.attributes {
        writeln!(out, "{{ {name} := '{value}' }}").unwrap();
    }
    for section in &block.sections {
        writeln!(out, "{}", &source[section.span.range()]).unwrap();
    }
    permanents(out, "BEGIN", &chart.before);
    chart.steps.iter().for_each(|step| step_text(out, step));
    chart.transitions.iter().for_each(|transition| transition_text(out, transition));
    permanents(out, "END", &chart.after);
    out.push_str("END_FUNCTION_BLOCK\n\n");
}

fn comment(out: &mut String, lines: &[String]) {
    if !lines.is_empty() {
        writeln!(out, "(*$_COM {}*)", lines.join("\n")).unwrap();
    }
}

fn settings(out: &mut String, settings: &Settings) {
    let truth = |value: Option<bool>| value.map(|value| if value { "T" } else { "F" }.to_owned());
    let keys = [
        ("FBInterface", settings.interface.map(|value| format!("{value:?}"))),
        ("SSBLevel", settings.data.map(|value| format!("{value:?}"))),
        ("AckReq", truth(settings.acknowledge)),
        ("SSkipOn", truth(settings.skip_steps)),
        ("PermILMan", truth(settings.manual_interlocks)),
        ("SaveSwitching", truth(settings.safe_activation)),
        ("SWMLocked", truth(settings.locked_mode)),
    ];
    out.push_str("(*$_CMPSET\n");
    for (key, value) in keys {
        if let Some(value) = value {
            writeln!(out, "   {key}: {value}").unwrap();
        }
    }
    out.push_str("*)\n");
}

fn permanents(out: &mut String, place: &str, rows: &[Permanent]) {
    if rows.is_empty() {
        return;
    }
    writeln!(out, "PERM_CONDITION_AT_{place}").unwrap();
    for row in rows {
        match &row.kind {
            PermanentKind::Coil { operand, coil, value } => {
                let sign = match coil {
                    Coil::Assign => "=",
                    Coil::Set => "S",
                    Coil::Reset => "R",
                };
                writeln!(out, "{} ({sign}) := {}", expr(operand), expr(value)).unwrap();
            }
            PermanentKind::Call(row) => writeln!(out, "{}", call(row)).unwrap(),
            PermanentKind::Network(_) => panic!("a network in a text"),
        }
    }
    out.push_str("END_PERM_CONDITION\n\n");
}

fn step_text(out: &mut String, step: &Step) {
    let word = if step.initial { "INITIAL_STEP" } else { "STEP" };
    writeln!(out, "{word} {} (*$_NUM {}*):", name(&step.name), step.number).unwrap();
    comment(out, &step.comment);
    for (word, part) in [("INTERLOCK", &step.interlock), ("SUPERVISION", &step.supervision)] {
        if let Some(part) = part {
            writeln!(out, "{word}\n CONDITION := {}\nEND_{word}", condition(part)).unwrap();
        }
    }
    for action in &step.actions {
        let body = match &action.body {
            ActionBody::Operand(operand) => expr(operand),
            ActionBody::Value { operand, value } => format!("{} := {}", expr(operand), expr(value)),
            ActionBody::All { .. } => "S_ALL".to_owned(),
            ActionBody::Call(row) => call(row),
            ActionBody::Statements(_) | ActionBody::Network(_) | ActionBody::Error => panic!("no action of a text"),
        };
        let event = action.event.map_or(String::new(), |event| format!("{}_", event.name()));
        let mark = if action.interlock { "C" } else { "" };
        let after = action.comment.as_ref().map_or(String::new(), |text| format!(" (* {text} *)"));
        writeln!(out, "{body}   ({event}{}{mark}){after}", action.qualifier.name()).unwrap();
    }
    out.push_str("END_STEP\n\n");
}

fn transition_text(out: &mut String, transition: &Transition) {
    writeln!(out, "TRANSITION {} (*$_NUM {}*)", name(&transition.name), transition.number).unwrap();
    for (word, steps) in [("FROM", &transition.from), ("TO", &transition.to)] {
        let names: Vec<String> = steps.iter().map(name).collect();
        let jump = if word == "TO" && transition.jump { " (*$_JUMP*)" } else { "" };
        match names.as_slice() {
            [] => {}
            [one] => writeln!(out, "  {word} {one}{jump}").unwrap(),
            several => writeln!(out, "  {word} ({}){jump}", several.join(", ")).unwrap(),
        }
    }
    comment(out, &transition.comment);
    let text = transition.condition.as_ref().map_or(String::new(), condition);
    writeln!(out, "CONDITION := {text}\nEND_TRANSITION\n").unwrap();
}

fn condition(value: &Condition) -> String {
    match value {
        Condition::Expression(value) => expr(value),
        Condition::Network(_) | Condition::Statements(_) => panic!("no condition of a text"),
    }
}

fn call(call: &Call) -> String {
    let instance = call.instance.as_ref().map_or(String::new(), |instance| format!(", {}", expr(instance)));
    let parameters: Vec<String> = call
        .parameters
        .iter()
        .map(|parameter| {
            format!("{} := {}", name(&parameter.name), parameter.value.as_ref().map_or(String::new(), expr))
        })
        .collect();
    format!("CALL {}{instance} ({})", expr(&call.block), parameters.join(", "))
}

fn name(name: &Name) -> String {
    match name.form {
        NameForm::Bare => name.text.clone(),
        NameForm::Local => format!("#{}", name.text),
        NameForm::Quoted => format!("\"{}\"", name.text),
    }
}

fn list(values: &[Expr]) -> String {
    values.iter().map(expr).collect::<Vec<_>>().join(", ")
}

fn expr(value: &Expr) -> String {
    match &value.kind {
        ExprKind::Literal(value) => literal(value),
        ExprKind::Name(value) => name(value),
        ExprKind::Absolute(OperandKind::Absolute { area, width: Width::Bit, byte, bit }) => {
            format!("{}{byte}.{bit}", area.letters())
        }
        ExprKind::Member { base, name: member } => format!("{}.{}", expr(base), name(member)),
        ExprKind::MemberAbsolute { base, width: Width::Bit, byte, bit } => format!("{}.DBX{byte}.{bit}", expr(base)),
        ExprKind::Index { base, indices } => format!("{}[{}]", expr(base), list(indices)),
        ExprKind::Call { callee, arguments } => {
            let arguments: Vec<String> = arguments
                .iter()
                .map(|argument| {
                    let formal = argument.name.as_ref().map_or(String::new(), |formal| format!("{} := ", name(formal)));
                    formal + &argument.value.as_ref().map_or(String::new(), expr)
                })
                .collect();
            format!("{}({})", expr(callee), arguments.join(", "))
        }
        ExprKind::Unary { op, operand } => {
            let sign = match op {
                UnaryOp::Not => "NOT ",
                UnaryOp::Plus => "+",
                UnaryOp::Minus => "-",
            };
            format!("({sign}{})", expr(operand))
        }
        ExprKind::Binary { op, left, right, .. } => {
            // GRAPH has a sign of its own for it.
            let sign = if *op == BinaryOp::Equal { "==" } else { op.sign() };
            format!("({} {sign} {})", expr(left), expr(right))
        }
        kind => panic!("not printed: {kind:?}"),
    }
}

fn literal(value: &Literal) -> String {
    match value {
        Literal::Integer { value, based: false } => value.to_string(),
        Literal::Integer { value, based: true } => format!("16#{value:X}"),
        Literal::Real(value) => format!("{value:?}"),
        Literal::Typed { ty: Elementary::Bool, bits } => if *bits == 0 { "FALSE" } else { "TRUE" }.to_owned(),
        Literal::Typed { ty: Elementary::Time, bits } => format!("T#{bits}MS"),
        Literal::Typed { ty: Elementary::S5Time, bits } => {
            let number: u32 = format!("{:X}", bits & 0xFFF).parse().unwrap();
            format!("S5T#{}MS", number * 10u32.pow(((bits >> 12) & 3) as u32 + 1))
        }
        Literal::Typed { ty, bits } => format!("{}#16#{bits:X}", ty.name()),
        value => panic!("not printed: {value:?}"),
    }
}
