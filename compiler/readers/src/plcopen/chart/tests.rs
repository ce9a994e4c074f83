//! Charts of SFC bodies.

use plcc_diag::{Code, FileId};

use crate::plcopen::parse;
use plcc_syntax::ast::{Block, Code as BlockCode};
use plcc_syntax::chart::ast::{ActionBody, Body as Chart, Condition};
use plcc_syntax::network;
use plcc_syntax::network::ast::Content;
use plcc_syntax::scl::ast::{Name, Statement};
use plcc_syntax::scl::text;

const CHARTS: &str = include_str!("../../../../../tests/parse/plcopen/charts.xml");
const STAR_DELTA: &str = include_str!("../../../../../tests/parse/plcopen/star_delta.xml");
const TWO_DOSES: &str = include_str!("../../../../../tests/parse/plcopen/two_doses.xml");

/// The charts of a project, and its messages as codes and titles.
fn charts(project: &str) -> (Vec<Chart>, Vec<(Code, String)>) {
    let (unit, messages) = parse(FileId::default(), project);
    let chart = |block| match block {
        Block::Code(block) => match block.code {
            BlockCode::Chart(chart) => Some(chart),
            BlockCode::Stl(_) | BlockCode::Scl(_) | BlockCode::Graphic(_) => None,
        },
        Block::Data(_) | Block::Type(_) => None,
    };
    let messages = messages.into_iter().map(|message| (message.code, message.title)).collect();
    (unit.blocks.into_iter().filter_map(chart).collect(), messages)
}

/// A function block with a chart, and other parts of the POU before it.
fn pou(parts: &str, sfc: &str) -> String {
    format!(
        "<project><types><pous><pou name=\"P\" pouType=\"functionBlock\"><interface><localVars>\
         <variable name=\"a\"><type><BOOL/></type></variable><variable name=\"n\"><type><INT/></type></variable>\
         </localVars></interface>{parts}<body><SFC>{sfc}</SFC></body></pou></pous></types></project>"
    )
}

/// A step with actions in a circle of one transition.
fn with_actions(parts: &str, actions: &str) -> String {
    pou(
        parts,
        &format!(
            "<step localId=\"1\" name=\"S\" initialStep=\"true\"/>\
             <transition localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn>\
             <condition><reference name=\"a\"/></condition></transition>\
             <jumpStep localId=\"3\" targetName=\"S\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn></jumpStep>\
             <actionBlock localId=\"4\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn>{actions}</actionBlock>"
        ),
    )
}

/// A circle of one transition with this condition.
fn with_condition(parts: &str, condition: &str, networks: &str) -> String {
    pou(
        parts,
        &format!(
            "<step localId=\"1\" name=\"S\" initialStep=\"true\"/>\
             <transition localId=\"2\"><connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn>{condition}</transition>\
             <jumpStep localId=\"3\" targetName=\"S\"><connectionPointIn><connection refLocalId=\"2\"/></connectionPointIn></jumpStep>\
             {networks}"
        ),
    )
}

fn names(names: &[Name]) -> String {
    names.iter().map(|name| name.text.as_str()).collect::<Vec<_>>().join(" ")
}

fn statements(list: &[Statement]) -> String {
    let lines = text::statements(list).into_iter().map(|(_, line)| line);
    lines.collect::<Vec<_>>().join(" ")
}

fn network(network: &network::ast::Network) -> String {
    match &network.content {
        Content::Graphic(graph) => format!("{:?} {}", network.language, network::text::graph(graph).join("; ")),
        Content::Scl(_) | Content::Stl(_) => String::new(),
    }
}

fn condition(condition: Option<&Condition>) -> String {
    match condition {
        None => "none".to_string(),
        Some(Condition::Expression(value)) => text::expr(value),
        Some(Condition::Statements(list)) => statements(list),
        Some(Condition::Network(value)) => network(value),
    }
}

/// `1 Trans1: Init -> A B jump [0 1] if …`
fn transitions(chart: &Chart) -> Vec<String> {
    let line = |transition: &plcc_syntax::chart::ast::Transition| {
        let jump = if transition.jump { " jump" } else { "" };
        let (from, to) = (names(&transition.from), names(&transition.to));
        let condition = condition(transition.condition.as_ref());
        format!("{}: {from} -> {to}{jump} {:?} if {condition}", transition.name.text, transition.path)
    };
    chart.transitions.iter().map(line).collect()
}

/// `S1_N #a`
fn rows(chart: &Chart, step: usize) -> Vec<String> {
    let line = |row: &plcc_syntax::chart::ast::Action| {
        let event = row.event.map_or(String::new(), |event| format!("{}_", event.name()));
        let body = match &row.body {
            ActionBody::Operand(operand) => text::expr(operand),
            ActionBody::Value { operand, value } => format!("{}, {}", text::expr(operand), text::expr(value)),
            ActionBody::Statements(list) => statements(list),
            ActionBody::Network(value) => network(value),
            ActionBody::Error => "error".to_string(),
            ActionBody::All { .. } | ActionBody::Call(_) => "other".to_string(),
        };
        format!("{event}{} {body}", row.qualifier.name())
    };
    chart.steps[step].actions.iter().map(line).collect()
}

#[test]
fn alternative_paths_go_by_priority_and_column() {
    let (charts, messages) = charts(CHARTS);
    // The end of a sequence in the other chart.
    assert_eq!(messages, [(Code::Tolerated, "nothing follows this transition".to_string())]);
    let steps: Vec<_> =
        charts[0].steps.iter().map(|step| (step.name.text.as_str(), step.number, step.initial)).collect();
    assert_eq!(steps, [("Second", 2, false), ("Init", 1, true)]);
    assert_eq!(
        transitions(&charts[0]),
        [
            "Trans1: Init -> Second [3] if (NOT #go)",
            "Trans2: Init -> Second [1] if ((#kind = 1) AND #go)",
            "Trans3: Init -> Second [0] if #count := (#count + 1) do (#count > 3)",
            "Trans4: Init -> Init jump [2, 1] if Lad P_Contact (pre := n0, operand := #go, bit := #edge_1, out => n1); \
             Contact (in := n0, operand := #left, out => n1); ConditionCoil (in := NOT n1); n0 = rail; n1 = 0.out OR 1.out",
            "Trans5: Init -> Second [2, 0] if Lad Contact (in := n0, operand := NOT #go, out => n1); \
             ConditionCoil (in := n1); n0 = rail; n1 = 0.out",
            "Trans6: Second -> Init jump [0] if (Second.T >= TIME#16#7D0)",
            "Trans7: Second -> Second jump [1] if BOOL#16#0",
        ]
    );
}

#[test]
fn actions_have_the_rows_of_their_qualifiers() {
    let (charts, _) = charts(CHARTS);
    assert_eq!(
        rows(&charts[0], 0),
        [
            "N #left",
            "N #count := (#count + 1)",
            "S0_N #count := (#count + 1)",
            "N Fbd Move (in := #go, out1 => #right)",
            "S0_N Fbd Move (in := #go, out1 => #right)",
            "S #left",
            "R #right",
            "D #left, TIME#16#3E8",
            "L #right, TIME#16#1F4",
            "S1_N #left",
            "S1_N #count := 0",
            "S0_N #count := (#count + 1)",
        ]
    );
    assert_eq!(charts[0].steps[0].actions[5].comment.as_deref(), Some("stays"));
    assert_eq!(charts[0].steps[1].comment, ["waits for go"]);
}

#[test]
fn simultaneous_paths_begin_and_end() {
    let (charts, _) = charts(CHARTS);
    assert_eq!(
        transitions(&charts[1]),
        [
            "Trans1: S0 -> S1 S2 [] if \"Parallel.a\"",
            "Trans2: S2 -> S3 [0] if \"Parallel.a\"",
            "Trans3: S2 -> S3 [1] if \"Parallel.b\"",
            "Trans4: S1 S3 ->  [1] if \"Parallel.b\"",
            "Trans5: S1 S3 -> S0 jump [0] if Fbd A (in1 := \"Parallel.a\", in2 := NOT \"Parallel.b\", out => n0); \
             ConditionCoil (in := n0); n0 = 0.out",
        ]
    );
}

#[test]
fn star_delta() {
    let (charts, messages) = charts(STAR_DELTA);
    assert_eq!(messages, []);
    let stop = "((NOT \"StarDelta.S0\") OR (NOT \"StarDelta.S5\"))";
    let start = |on: &str, other: &str, contactor: &str| {
        format!(
            "((((\"StarDelta.{on}\" AND (NOT \"StarDelta.{other}\")) AND \"StarDelta.S0\") AND \"StarDelta.S5\") \
             AND (NOT \"StarDelta.{contactor}\"))"
        )
    };
    assert_eq!(
        transitions(&charts[0]),
        [
            format!("Trans1: Off -> StarCW [0] if {}", start("S1", "S2", "K2")),
            format!("Trans2: StarCW -> Off jump [0] if {stop}"),
            "Trans3: StarCW -> DeltaCW [1] if \"StarDelta.StarOver\"".to_string(),
            format!("Trans4: DeltaCW -> Off jump [] if {stop}"),
            format!("Trans5: Off -> StarCCW [1] if {}", start("S2", "S1", "K1")),
            format!("Trans6: StarCCW -> Off jump [0] if {stop}"),
            "Trans7: StarCCW -> DeltaCCW [1] if \"StarDelta.StarOver\"".to_string(),
            format!("Trans8: DeltaCCW -> Off jump [] if {stop}"),
        ]
    );
    let star =
        ["N \"StarDelta.K1\"", "N \"StarDelta.K4\"", "N \"StarDelta.H1\"", "D \"StarDelta.StarOver\", TIME#16#1388"];
    assert_eq!(rows(&charts[0], 1), star);
    let close = "\"StarDelta.K3\" := ((DeltaCW.X AND (DeltaCW.T >= TIME#16#64)) AND (NOT \"StarDelta.K4\"))";
    assert_eq!(
        rows(&charts[0], 2),
        [
            "N \"StarDelta.K1\"".to_string(),
            "N \"StarDelta.H1\"".to_string(),
            format!("N {close}"),
            format!("S0_N {close}")
        ]
    );
}

#[test]
fn two_doses() {
    let (charts, messages) = charts(TWO_DOSES);
    assert_eq!(messages, []);
    assert_eq!(
        transitions(&charts[0]),
        [
            "Trans1: Idle -> DoseA DoseB [] if Lad Contact (in := n0, operand := \"TwoDoses.Start\", out => n1); \
             ConditionCoil (in := n1); n0 = rail; n1 = 0.out",
            "Trans2: DoseA -> DoneA [] if \"TwoDoses.FullA\"",
            "Trans3: DoseB -> DoneB [] if \"TwoDoses.FullB\"",
            "Trans4: DoneA DoneB -> Mix [] if BOOL#16#1",
            "Trans5: Mix -> Idle jump [] if (Mix.T >= TIME#16#7D0)",
        ]
    );
    let steps: Vec<&str> = charts[0].steps.iter().map(|step| step.name.text.as_str()).collect();
    assert_eq!(steps, ["Idle", "DoseA", "DoneA", "DoseB", "DoneB", "Mix"]);
    assert_eq!(rows(&charts[0], 3).len(), 2);
    assert_eq!(rows(&charts[0], 5), ["N \"TwoDoses.Mixer\""]);
}

/// The codes and titles of a project.
fn told(project: &str) -> Vec<(Code, String)> {
    charts(project).1
}

fn one(code: Code, title: &str) -> Vec<(Code, String)> {
    vec![(code, title.to_string())]
}

const CODE: &str = "<actions><action name=\"Go\"><body><ST><p>n := n + 1;</p></ST></body></action></actions>";

#[test]
fn qualifiers_of_iec_have_rows() {
    let action = "<action qualifier=\"X\" duration=\"T#1s\"><reference name=\"a\"/></action>";
    assert_eq!(told(&with_actions("", action)), one(Code::Qualifier, "an action has no qualifier `X`"));
    for qualifier in ["S", "R", "D", "L", "SD", "DS", "SL"] {
        for name in ["a", "go"] {
            let action =
                format!("<action qualifier=\"{qualifier}\" duration=\"T#1s\"><reference name=\"{name}\"/></action>");
            assert_eq!(told(&with_actions(CODE, &action)), [], "{qualifier} {name}");
        }
    }
    let network = CODE.replace("<ST><p>n := n + 1;</p></ST>", "<LD><leftPowerRail localId=\"1\"/></LD>");
    let action = "<action qualifier=\"S\"><reference name=\"Go\"/></action>";
    let (charts, _) = charts(&with_actions(&network, action));
    assert_eq!(charts[0].after.len(), 1, "a POU without networks is stored all the same");
}

#[test]
fn incomplete_actions_are_told() {
    let without_time = "<action qualifier=\"D\"><reference name=\"a\"/></action>";
    assert_eq!(told(&with_actions("", without_time)), one(Code::ActionText, "`D` without a time"));
    assert_eq!(told(&with_actions("", "<action/>")), one(Code::ActionText, "an action without an operand"));
    let leaves = "<action><inline><ST><p>IF a THEN RETURN; END_IF;</p></ST></inline></action>";
    let title = "plcc does not read jumps and returns in actions and transitions";
    assert_eq!(told(&with_actions("", leaves)), one(Code::ForeignContent, title));
    let list = "<action><inline><IL><p>LD a\n ST a</p></IL></inline></action>";
    assert_eq!(told(&with_actions("", list)), []);
    let lost = "</actionBlock><actionBlock><action><reference name=\"a\"/></action>";
    assert_eq!(told(&with_actions("", lost)), one(Code::NoSource, "an action block that belongs to no step"));
}

#[test]
fn an_action_of_two_steps_is_told() {
    let more = "<action><reference name=\"Go\"/></action></actionBlock><step localId=\"9\" name=\"Other\"/>\
                <actionBlock><connectionPointIn><connection refLocalId=\"9\"/></connectionPointIn>\
                <action><reference name=\"go\"/></action>";
    assert_eq!(told(&with_actions(CODE, more)), one(Code::Tolerated, "the action `go` belongs to several steps"));
}

#[test]
fn conditions_that_are_none_are_told() {
    let title = "a transition without a condition";
    assert_eq!(told(&with_condition("", "", "")), one(Code::MissingCondition, title));
    let empty = "<condition><inline><ST><p> </p></ST></inline></condition>";
    assert_eq!(told(&with_condition("", empty, "")), one(Code::MissingCondition, title));
    let writes = "<condition><inline><ST><p>n := 1;</p></ST></inline></condition>";
    let title = "the statements of the transition do not end in a condition";
    assert_eq!(told(&with_condition("", writes, "")), one(Code::ConditionType, title));
    let named = "<transitions><transition name=\"T\"><body><LD><leftPowerRail localId=\"1\"/><coil localId=\"2\">\
                 <connectionPointIn><connection refLocalId=\"1\"/></connectionPointIn><variable>a</variable></coil></LD>\
                 </body></transition></transitions>";
    let reference = "<condition><reference name=\"T\"/></condition>";
    let title = "the network does not write `T`";
    assert_eq!(told(&with_condition(named, reference, "")), one(Code::ConditionType, title));
}

#[test]
fn networks_belong_to_transitions() {
    let connected = "<condition><connection refLocalId=\"8\"/></condition>";
    let contact = "<leftPowerRail localId=\"7\"/><contact localId=\"8\"><connectionPointIn><connection refLocalId=\"7\"/>\
                   </connectionPointIn><variable>a</variable></contact>";
    assert_eq!(told(&with_condition("", connected, contact)), []);
    let coil = format!(
        "{contact}<coil localId=\"9\"><connectionPointIn><connection refLocalId=\"8\"/></connectionPointIn>\
         <variable>a</variable></coil>"
    );
    let title = "a network in the chart that no transition reads";
    assert_eq!(told(&with_condition("", connected, &coil)), one(Code::ForeignContent, title));
}

#[test]
fn lines_that_lead_nowhere_are_told() {
    let condition = "<condition><reference name=\"a\"/></condition>";
    let jump = with_condition("", condition, "").replace("targetName=\"S\"", "targetName=\"S1\"");
    let (charts, messages) = charts(&jump);
    assert_eq!(messages, one(Code::UnknownStep, "no step of the chart is called `S1`"));
    assert!(charts[0].broken && charts[0].transitions[0].to.is_empty());
    let lost = with_condition("", condition, "").replace("refLocalId=\"1\"", "refLocalId=\"77\"");
    let title = "a line comes from object 77, which is not a step, transition or branch";
    assert!(told(&lost).contains(&(Code::Tolerated, title.to_string())));
    let folded = with_condition("", condition, "").replace("<step ", "<macroStep ");
    assert_eq!(told(&folded), one(Code::ForeignContent, "plcc does not read macro steps, such as `S`"));
}
