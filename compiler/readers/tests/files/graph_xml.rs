//! Charts of exports in XML: the steps that transitions leave and enter, and the actions of steps.

use plcc_diag::{Diagnostic, FileId};
use plcc_readers::{ReadOptions, parse};
use plcc_syntax::ast::{Block, Code};
use plcc_syntax::chart::ast::{ActionBody, Body, Condition, Dialect, Interface, PermanentKind};
use plcc_syntax::network;
use plcc_syntax::network::ast::Content;
use plcc_syntax::scl::ast::Name;
use plcc_syntax::scl::text::expr;

const FORMS: &str = include_str!("../../../../tests/parse/simatic-ml/graph-forms.xml");
const STAR_DELTA: &str = include_str!("../../../../tests/parse/simatic-ml/star-delta/StarDelta.xml");
const TWO_DOSES: &str = include_str!("../../../../tests/parse/simatic-ml/two-doses/TwoDoses.xml");

fn read(text: &str) -> (Vec<Block>, Vec<Diagnostic>) {
    let (unit, messages) = parse(FileId(0), text, &ReadOptions::default());
    (unit.blocks, messages)
}

/// The chart of an export without mistakes.
fn chart(text: &str) -> Body {
    let (chart, messages) = chart_and_messages(text);
    assert!(messages.is_empty(), "{messages:#?}");
    chart
}

fn chart_and_messages(text: &str) -> (Body, Vec<Diagnostic>) {
    let (blocks, messages) = read(text);
    match blocks.into_iter().next() {
        Some(Block::Code(block)) => match block.code {
            Code::Chart(chart) => (chart, messages),
            other => panic!("no chart: {other:?}"),
        },
        other => panic!("no block with code: {other:?}"),
    }
}

/// `T1: Off -> StarCW @0`, the path after `@`.
fn transitions(chart: &Body) -> Vec<String> {
    let names = |list: &[Name]| list.iter().map(|name| name.text.as_str()).collect::<Vec<_>>().join(" ");
    let shown = chart.transitions.iter().map(|transition| {
        let arrow = if transition.jump { "=>" } else { "->" };
        let path: Vec<String> = transition.path.iter().map(u32::to_string).collect();
        let missing = if transition.missing { " missing" } else { "" };
        let (from, to) = (names(&transition.from), names(&transition.to));
        format!("{}: {from} {arrow} {to} @{}{missing}", transition.name.text, path.join("."))
    });
    shown.collect()
}

fn condition(condition: Option<&Condition>) -> Vec<String> {
    match condition {
        None => Vec::new(),
        Some(Condition::Network(network)) => match &network.content {
            Content::Graphic(graph) => network::text::graph(graph),
            Content::Scl(_) | Content::Stl(_) => vec!["text".to_string()],
        },
        Some(Condition::Expression(_) | Condition::Statements(_)) => vec!["text".to_string()],
    }
}

/// The rows of a step: `S1 N C "Lamp"`.
fn actions(chart: &Body, step: &str) -> Vec<String> {
    let step = chart.steps.iter().find(|known| known.name.text == step).expect("the step");
    let shown = step.actions.iter().map(|action| {
        let event = action.event.map_or(String::new(), |event| format!("{} ", event.name()));
        let interlock = if action.interlock { " C" } else { "" };
        let body = match &action.body {
            ActionBody::Operand(operand) => expr(operand),
            ActionBody::Value { operand, value } => format!("{} := {}", expr(operand), expr(value)),
            ActionBody::All { .. } => "all".to_string(),
            ActionBody::Call(call) => {
                let instance = call.instance.as_ref().map_or(String::new(), |instance| format!(", {}", expr(instance)));
                format!("call {}{instance} with {}", expr(&call.block), call.parameters.len())
            }
            ActionBody::Statements(_) | ActionBody::Network(_) | ActionBody::Error => "error".to_string(),
        };
        format!("{event}{}{interlock} {body}", action.qualifier.name())
    });
    shown.collect()
}

#[test]
fn alternative_branches_and_jumps() {
    let chart = chart(STAR_DELTA);
    let expected = [
        "T1: Off -> StarCW @0",
        "T2: StarCW => Off @0",
        "T3: StarCW -> DeltaCW @1",
        "T4: DeltaCW => Off @",
        "T5: Off -> StarCCW @1",
        "T6: StarCCW => Off @0",
        "T7: StarCCW -> DeltaCCW @1",
        "T8: DeltaCCW => Off @",
    ];
    assert_eq!(transitions(&chart), expected);
    assert_eq!(chart.dialect, Dialect::Tia);
    assert_eq!(chart.settings.interface, Some(Interface::UserDefined));
    assert_eq!(chart.settings.acknowledge, Some(true));
    assert!(chart.steps[0].initial && !chart.steps[1].initial);
    assert_eq!(actions(&chart, "DeltaCW"), ["N %Q0.1", "N %Q0.5", "D C %Q0.3 := TIME#16#64"]);
    assert_eq!(chart.steps[2].maximum.as_ref().map(expr), Some("TIME#16#2710".to_string()));
}

#[test]
fn simultaneous_branches() {
    let chart = chart(TWO_DOSES);
    let expected = ["T1: S1 -> S2 S3 @", "T2: S2 -> S4 @", "T3: S3 -> S5 @", "T4: S4 S5 -> S6 @", "T5: S6 => S1 @"];
    assert_eq!(transitions(&chart), expected);
    // The coil of T4 is wired to the rail.
    assert_eq!(chart.transitions[3].condition, None);
    assert!(!chart.transitions[3].missing);
}

#[test]
fn every_form() {
    let chart = chart(FORMS);
    let expected = [
        "T_a: Idle -> Left @0",
        "T_b: Idle -> Middle @1.0",
        "T_c: Idle -> Right @1.1",
        "T_d: Left -> Rinse Heat @",
        "T_e: Middle -> Rinse Heat @",
        "T_f: Rinse Heat -> Done @",
        "T_g: Done => Idle @0 missing",
        "T_h: Done ->  @1",
        "T_i: Right => Sub1 @",
        "T_s0: Sub0 -> Sub1 @",
        "T_s1: Sub1 => Sub0 @",
    ];
    assert_eq!(transitions(&chart), expected);
    assert_eq!(actions(&chart, "Idle"), ["S \"Lamp\"", "N #lamp", "S1 R #fault"]);
    assert_eq!(chart.steps[0].actions[2].comment.as_deref(), Some("from the last run"));
    let left = [
        "L #valve.open := TIME#16#7D0",
        "D C \"Valve, left\" := #delay",
        "S1 CS %C5 := WORD#16#20",
        "S1 CU %C5",
        "S1 TL %T3 := S5TIME#16#500",
    ];
    assert_eq!(actions(&chart, "Left"), left);
    let middle = ["N #sum := (#a + #b)", "N #count := 0", "S0 N #sum := \"start\".level"];
    assert_eq!(actions(&chart, "Middle"), middle);
    let right =
        ["N call \"Mix\" with 2", "N #done", "S1 N call \"Ramp\", \"Ramp_DB\" with 2", "S1 ON Sub1", "V1 OFF all"];
    assert_eq!(actions(&chart, "Right"), right);
    assert_eq!(chart.steps[0].comment, ["Waits for an order"]);
    assert_eq!((chart.before.len(), chart.after.len()), (1, 1));
    assert!(matches!(chart.before[0].kind, PermanentKind::Network(_)));
}

#[test]
fn conditions_are_networks() {
    let chart = chart(FORMS);
    let left = &chart.steps[1];
    assert_eq!(
        condition(left.supervision.as_ref()),
        [
            "GT (pre := n0, in1 := #Left.T, in2 := TIME#16#1F40, out => n1)",
            "Contact (in := n1, operand := NOT #T_b.TT, out => n2)",
            "ConditionCoil (in := n2)",
            "n0 = rail",
            "n1 = 0.out",
            "n2 = 1.out"
        ]
    );
    let middle = condition(chart.steps[2].supervision.as_ref());
    assert_eq!(middle[0], "GT (pre := n0, in1 := #Middle.T, in2 := #Middle.T_MAX, out => n1)");
    assert!(condition(chart.transitions[2].condition.as_ref())[1].starts_with("GT (pre := n1, in1 := #Idle.U"));
    // Coils at the rail: no supervision, no interlock.
    assert_eq!((&chart.steps[0].supervision, &chart.steps[0].interlock), (&None, &None));
}

#[test]
fn the_interface_is_that_of_the_user() {
    let (blocks, _) = read(FORMS);
    let [Block::Code(block)] = blocks.as_slice() else { panic!("one block") };
    let names: Vec<&str> =
        block.sections.iter().flat_map(|section| &section.variables).map(|variable| variable.name.as_str()).collect();
    let expected = [
        "OFF_SQ", "INIT_SQ", "ACK_EF", "go", "enable", "S_NO", "lamp", "fault", "done", "a", "b", "sum", "count",
        "delay", "valve",
    ];
    assert_eq!(names, expected);
}

#[test]
fn instances_have_no_values_of_steps() {
    let (blocks, messages) = read(include_str!("../../../../tests/parse/simatic-ml/star-delta/StarDelta_DB.xml"));
    assert!(messages.is_empty(), "{messages:#?}");
    let [Block::Data(block)] = blocks.as_slice() else { panic!("one data block") };
    assert_eq!(block.values.len(), 1, "{:?}", block.values);
}

/// The codes of the messages when `new` replaces `old` in the export of all forms.
fn codes(old: &str, new: &str) -> Vec<&'static str> {
    let changed = FORMS.replacen(old, new, 1);
    assert_ne!(changed, FORMS, "{old}");
    let (chart, messages) = chart_and_messages(&changed);
    assert!(chart.broken);
    messages.into_iter().map(|message| message.code.name()).collect()
}

#[test]
fn mistakes_are_told_at_their_places() {
    assert_eq!(codes("Qualifier=\"S\"", "Qualifier=\"SD\""), ["P0574"]);
    assert_eq!(codes("Event=\"S1\"", "Event=\"S7\""), ["P0571"]);
    assert_eq!(codes("Type=\"AltEnd\" Cardinality=\"2\"", "Type=\"AltEnd\" Cardinality=\"3\""), ["P0566"]);
    assert_eq!(codes("<StepRef Number=\"7\" />", "<StepRef Number=\"70\" />"), ["P0552"]);
    assert_eq!(codes("Text=\"Sub1\"", "Text=\"IF #a THEN\""), ["P0572"]);
    assert_eq!(codes("Name=\"TrCoil\"", "Name=\"Hologram\""), ["P0530"]);
    assert_eq!(codes("<EndConnection />", "<Elsewhere />"), ["P0541"]);
    assert_eq!(codes("CALL &quot;Mix&quot; (", "CALL &quot;Mix&quot;"), ["P0201"]);
}
