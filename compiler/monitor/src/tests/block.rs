//! Blocks with their status.

use serde_json::{Value, json};

use super::{check, keys, model, picture};
use crate::connection::Incoming;
use crate::document::pages_of;
use crate::messages::{Entry, Forced, News, Order, State, StatusNews};
use crate::model::{Model, Part, Wanted};
use crate::row::{Row, Tone};
use crate::status::Place;

/// A network of two contacts and a coil, as the page draws it.
const LADDER: &str = r#"<svg width="192" height="66" viewBox="0 0 192 66"><path class="r" d="M10 27V51"/>
<path class="w" data-n="3" d="M10 39h10"/>
<path class="g" data-p="0" d="M40 30V48M50 30V48"/>
<text class="o" data-k="M0.0" data-o="334" x="45" y="22" font-size="12" text-anchor="middle">M0.0</text>
<path class="w" data-n="0" d="M20 39h20"/>
<path class="w" data-n="1" d="M50 39h20"/>
<path class="g" data-p="1" d="M90 30V48M100 30V48M92 48L98 30"/>
<text class="o" data-k="I0.1" data-o="354" x="95" y="22" font-size="12" text-anchor="middle">I0.1</text>
<path class="w" data-n="1" d="M70 39h20"/>
<path class="w" data-n="2" d="M100 39h20"/>
<path class="g" data-p="2" d="M145 30q-10 9 0 18M157 30q10 9 0 18"/>
<text class="o" data-k="Q0.0" data-o="369" x="151" y="22" font-size="12" text-anchor="middle">Q0.0</text>
<path class="w" data-n="2" d="M120 39h20"/>
</svg>"#;

/// A box, with values at its pins.
const BOX: &str = r##"<svg width="232" height="132" viewBox="0 0 232 132"><path class="r" d="M10 44V68"/>
<path class="w" data-n="1" d="M10 56h10"/>
<rect class="b" x="91" y="16" width="60" height="99"/>
<text class="t" x="121" y="29" font-size="12" text-anchor="middle">ADD</text>
<text class="y" x="121" y="43" font-size="10" text-anchor="middle">Int</text>
<path class="w" data-n="0" d="M20 56h71"/>
<text class="p" x="95" y="59" font-size="10">EN</text>
<path class="w" data-o="1216" d="M77 78h14"/>
<text class="o" data-k="#step" data-o="1216" x="74" y="74" font-size="12" text-anchor="end">#step</text>
<text class="v" data-k="#step" data-o="1216" x="74" y="88" font-size="10" text-anchor="end">        </text>
<text class="p" x="95" y="81" font-size="10">IN1</text>
<path class="w" data-o="1240" d="M151 78h14"/>
<text class="o" data-k="#sum" data-o="1240" x="168" y="74" font-size="12">#sum</text>
<text class="v" data-k="#sum" data-o="1240" x="168" y="88" font-size="10">        </text>
<text class="p" x="147" y="81" font-size="10" text-anchor="end">OUT</text>
<path class="w" data-o="1230" d="M77 103h14"/>
<text class="o" data-o="1230" x="74" y="106" font-size="12" text-anchor="end">5</text>
<text class="p" x="95" y="106" font-size="10">IN2</text>
</svg>"##;

/// Two steps, and a transition whose condition is a text.
const CHART: &str = r#"<svg width="272" height="438" viewBox="0 0 272 438"><rect class="b k" data-s="DB3.DBX35.0" x="10" y="10" width="80" height="38"/><rect class="s" x="13" y="13" width="74" height="32"/>
<text class="t" x="50" y="27" font-size="12" text-anchor="middle">S1</text>
<text class="t" x="50" y="41" font-size="12" text-anchor="middle">Waiting</text>
<path class="s" d="M50 48L50 62"/>
<text class="t" x="70" y="66" font-size="12">T1 Begin</text>
<path class="s" d="M36 62L64 62"/>
<path class="s" d="M36 63L64 63"/>
<path class="s" d="M50 60L50 100"/>
<rect class="b k" data-s="DB3.DBX67.0" x="10" y="100" width="80" height="38"/>
<text class="t" x="50" y="117" font-size="12" text-anchor="middle">S2</text>
<text class="t" x="50" y="131" font-size="12" text-anchor="middle">Filling</text>
<path class="s" d="M50 138L50 158"/>
<path class="s" d="M46 151L50 158L54 151"/>
<text class="m" x="58" y="158" font-size="12">S1 Waiting</text>
</svg>"#;

fn program() -> Incoming {
    let section = |number: u32, svg: &str, logic: Value| json!({"n": number, "title": "", "labels": [], "svg": svg, "logic": logic});
    let ladder = json!({
        "nets": [[["r"]], [["&", [0, false], ["M0.0", false, 334]]], [["&", [1, false], ["I0.1", true, 354]]], [["r"]]],
        "places": [[null], [334], [354]], "contacts": [[0, 334, false], [1, 354, true]], "coils": [[2, "Q0.0"]],
    });
    let sum = json!({"nets": [[["r"]], [["r"]]], "places": [[null]], "contacts": [], "coils": []});
    let statements = "      L     W#16#1234;\n      A     I 0.0;   // switch\n\tSD    T 5;";
    let stl =
        json!({"n": 1, "title": "words", "labels": [], "text": statements, "starts": [52, 75, 106], "kind": "stl"});
    let scl = json!({"n": 0, "text": "IF #level > 5 THEN\n  #level := #level * 2;", "starts": [80, 99], "kind": "scl"});
    let page = |id: &str, name: &str, language: &str, sections: Vec<Value>| json!({"id": id, "name": name, "lang": language, "title": "", "secs": sections, "rows": []});
    let data = json!({"title": "line", "pages": [
        page("OB 1", "Main", "LAD", vec![section(1, LADDER, ladder), section(2, BOX, sum)]),
        page("FC 1", "Limits", "SCL", vec![scl]),
        page("DB 1", "First", "", Vec::new()),
        page("FB 2", "Sequence", "GRAPH", vec![section(0, CHART, Value::Null)]),
        page("FC 2", "", "STL", vec![stl]),
    ]});
    let html = format!("<body><script id=\"data\" type=\"application/json\">{data}</script><script>x</script></body>");
    Incoming::Program(pages_of(&html))
}

/// The model with an open block, whose places have come. `down`: its row below that of all blocks.
fn opened(down: usize, key: &str, places: Value) -> Model {
    let mut model = model("look");
    model.take(program());
    keys(&mut model, &format!("\t\t\n{}\n", "↓".repeat(down)));
    assert_eq!(model.wanted().collect::<Vec<_>>(), [Wanted::Places(key.to_string())]);
    let _ = model.orders().count();
    model.take(Incoming::Places(key.to_string(), places_of(places)));
    let order = Order::Status { block: Some(key.to_string()), call: None, turn: 1 };
    assert_eq!(model.orders().collect::<Vec<_>>(), [order]);
    model
}

fn places_of(places: Value) -> Result<Vec<Place>, String> {
    serde_json::from_value(places).map_err(|error| error.to_string())
}

fn see(model: &mut Model, status: Value) {
    let status: StatusNews = serde_json::from_value(status).expect("it is what the page gets");
    model.take(Incoming::News(Box::new(News { status: Some(status), ..News::default() })));
}

fn text(row: &Row) -> String {
    row.iter().map(|piece| piece.text.as_str()).collect()
}

/// The parts of the open block that have a tone.
fn parts(model: &Model, tone: Tone) -> Vec<String> {
    let rows = model.block.iter().flat_map(|block| &block.rows);
    rows.flatten().filter(|piece| piece.tone == tone).map(|piece| piece.text.trim().to_string()).collect()
}

/// The lines of the open block.
fn lines(model: &Model) -> Vec<String> {
    model.block.iter().flat_map(|block| &block.rows).map(text).collect()
}

fn ladder_places() -> Value {
    json!([
        [122, 126, "block"],
        [334, 339, "variable"],
        [334, 339, "written"],
        [354, 359, "variable"],
        [343, 352, "written"],
        [369, 374, "written"],
        [1216, 1221, "variable"],
        [1240, 1244, "written"]
    ])
}

#[test]
fn blocks_are_a_branch_of_the_tree() {
    let mut model = model("look");
    model.take(program());
    keys(&mut model, "\t\t\n↓↓");
    check("blocks.txt", &model);
    keys(&mut model, "/fc2\n");
    assert_eq!(model.tree.iter().map(|node| node.label.as_str()).collect::<Vec<_>>(), ["Blocks", "FC 2"]);
}

#[test]
fn a_network_is_drawn_with_its_power_flow() {
    let mut model = opened(1, "OB1", ladder_places());
    see(
        &mut model,
        json!({"turn": 1, "calls": ["OB 1"], "call": [0, 1204],
            "seen": [[1, true], [2, true], [3, true], [5, false], [6, "16#0005"], [7, "12"]]}),
    );
    check("network.txt", &model);
    assert_eq!(
        parts(&model, Tone::On),
        ["M0.0", "I0.1", "└────┤ ├─────", "└─────────────┤"],
        "up to the contact that is open"
    );
    assert_eq!(parts(&model, Tone::Off), ["Q0.0", "───────"]);
    assert_eq!(parts(&model, Tone::Value), ["16#0005", "12"]);
    // Only what has changed is told.
    see(&mut model, json!({"turn": 1, "call": [0, 1300], "seen": [[1, null], [2, null]]}));
    assert_eq!(parts(&model, Tone::Unknown), ["─────"], "after a contact that was not reached");
}

#[test]
fn forced_operands_are_marked() {
    let mut model = opened(1, "OB1", ladder_places());
    for (address, expected) in [("I0.1", &["I0.1"][..]), ("IB0", &["I0.1"]), ("IB1", &[]), ("QW0", &["Q0.0"])] {
        let forced = Forced { name: "switch".to_string(), value: "1".to_string(), address: address.to_string() };
        model.take(Incoming::News(Box::new(News { forced: Some(vec![forced]), ..News::default() })));
        assert_eq!(parts(&model, Tone::Forced), expected, "{address}");
    }
    // I0.0 is forced from the beginning.
    let model = opened(4, "FC2", json!([[81, 92, "registers"]]));
    assert_eq!(parts(&model, Tone::Forced), ["I 0.0"]);
}

#[test]
fn statements_have_their_registers_beside_them() {
    let places = json!([[9, 16, "block"], [58, 73, "registers"], [81, 92, "registers"], [107, 117, "registers"]]);
    let mut model = opened(4, "FC2", places);
    see(
        &mut model,
        json!({"turn": 1, "calls": ["OB 1 › FC 2", "OB 35 › FC 2"], "call": [0, 1204], "seen": [
            [1, [0, 4660, 0, 0, 0, 0, 0, null]],
            [2, [7, 4660, 7, 2214592596_u32, 0, 1, 3, null]],
            [3, [3, 4660, 7, 0, 0, 0, 0, "S5T#1s300ms"]]]}),
    );
    check("statements.txt", &model);
    assert_eq!(parts(&model, Tone::On).len(), 2, "lines whose RLO is 1");
    keys(&mut model, "c");
    let call = Some("OB 1 › FC 2".to_string());
    assert_eq!(model.orders().collect::<Vec<_>>(), [Order::Status { block: Some("FC2".to_string()), call, turn: 2 }]);
    assert_eq!(parts(&model, Tone::On), Vec::<String>::new(), "nothing is known of this call");
    // What was on its way.
    see(&mut model, json!({"turn": 1, "call": [1, 1205], "seen": [[2, [7, 0, 0, 0, 0, 0, 0, null]]]}));
    assert_eq!(parts(&model, Tone::On), Vec::<String>::new());
    keys(&mut model, "cc");
    assert!(matches!(model.orders().last(), Some(Order::Status { call: None, turn: 4, .. })), "the first one again");
}

#[test]
fn statements_that_are_rungs_are_shown_as_networks() {
    let logic = json!({
        "nets": [[["r"]], [["&", [0, false], ["M0.0", false, 334]]], [["&", [1, false], ["I0.1", true, 354]]], [["r"]]],
        "places": [[null], [334], [354]], "contacts": [[0, 334, false], [1, 354, true]], "coils": [[2, "Q0.0"]],
    });
    let statements = "      A     M 0.0;\n      AN    I 0.1;\n      =     Q 0.0;";
    let section = json!({"n": 1, "title": "", "labels": [], "svg": LADDER, "logic": logic,
        "code": {"text": statements, "starts": [328, 348, 363]}});
    let page = json!({"id": "FC 3", "name": "", "lang": "STL", "title": "", "secs": [section], "rows": []});
    let data = json!({"title": "line", "pages": [page]});
    let mut model = model("look");
    model.take(Incoming::Program(pages_of(&format!("<script id=\"data\" type=\"application/json\">{data}</script>"))));
    keys(&mut model, "\t\t\n↓\n");
    let places = json!([[334, 345, "registers"], [354, 365, "registers"], [369, 380, "registers"]]);
    model.take(Incoming::Places("FC3".to_string(), places_of(places)));
    let registers = |status_word: u32| json!([status_word, 0, 0, 0, 0, 0, 0, null]);
    // M0.0 and I0.1 are 1, Q0.0 becomes 0.
    let seen = json!([[0, registers(7)], [1, registers(5)], [2, registers(0)]]);
    see(&mut model, json!({"turn": 1, "calls": ["OB 1 › FC 3"], "call": [0, 1204], "seen": seen}));
    assert!(lines(&model).iter().any(|line| line.starts_with("      A     M 0.0;")));
    assert!(picture(&model).contains("v: networks"));
    keys(&mut model, "v");
    assert!(!lines(&model).iter().any(|line| line.contains("M 0.0;")));
    assert_eq!(parts(&model, Tone::On), ["M0.0", "I0.1", "└────┤ ├─────"]);
    assert_eq!(parts(&model, Tone::Off), ["Q0.0", "───────"]);
    assert!(picture(&model).contains("v: statements"));
    // What comes now is shown there, too.
    see(&mut model, json!({"turn": 1, "call": [0, 1205], "seen": [[1, registers(3)], [2, registers(6)]]}));
    assert_eq!(parts(&model, Tone::Off), ["I0.1"]);
    keys(&mut model, "v");
    assert!(lines(&model).iter().any(|line| line.starts_with("      A     M 0.0;")));
}

#[test]
fn values_of_a_line_are_beside_it() {
    let places = json!([
        [83, 89, "variable"],
        [83, 93, "value"],
        [111, 117, "variable"],
        [111, 121, "value"],
        [101, 107, "written"]
    ]);
    let mut model = opened(2, "FC1", places);
    see(&mut model, json!({"turn": 1, "seen": [[0, "7"], [1, true], [2, "7"], [3, "14"], [4, "14"]]}));
    let expected =
        ["IF #level > 5 THEN       #level = 7   result TRUE", "  #level := #level * 2;  #level = 7   #level := 14"];
    assert_eq!(lines(&model), expected);
}

#[test]
fn the_active_step_of_a_chart_is_lit() {
    let mut model = opened(3, "FB2", json!([]));
    see(
        &mut model,
        json!({"turn": 1, "calls": ["OB 1 › FB 2, DB 3"], "call": [0, 1204], "steps": [
            {"step": "Waiting", "active": false, "t_ms": 2300, "u_ms": 2300},
            {"step": "Filling", "active": true, "t_ms": 12340, "u_ms": 12000, "interlocked": true}]}),
    );
    check("chart.txt", &model);
    assert!(parts(&model, Tone::Active).iter().any(|part| part.contains("Filling")));
    assert!(!parts(&model, Tone::Active).iter().any(|part| part.contains("Waiting")));
}

#[test]
fn the_last_steps_of_a_chart_are_listed() {
    let mut model = opened(3, "FB2", json!([]));
    let activation = |step: &str, cycle: u64, active_ms: Value| json!({"step": step, "cycle": cycle, "clock_ms": 1000 * cycle, "active_ms": active_ms});
    let mut history = vec![activation("Filling", 60, Value::Null)];
    history.extend((50..60).rev().map(|cycle| activation("Waiting", cycle, json!(cycle * 100))));
    see(&mut model, json!({"turn": 1, "call": [0, 1204], "history": history}));
    let expected = [
        "History  Active from            For",
        "Filling  00:01:00.000        active",
        "Waiting  00:00:59.000       5.900 s",
    ];
    assert_eq!(lines(&model)[..3], expected);
    assert_eq!(lines(&model)[5..7], ["Waiting  00:00:56.000       5.600 s", ""], "the newest five");
}

#[test]
fn a_block_is_left_and_opened_again_when_the_program_changes() {
    let mut model = opened(1, "OB1", ladder_places());
    see(&mut model, json!({"turn": 1, "call": [0, 1], "seen": [[1, true]]}));
    let state = State { generation: 1, running: true, ..State::default() };
    model.take(Incoming::News(Box::new(News { state: Some(state), ..News::default() })));
    assert_eq!(model.wanted().collect::<Vec<_>>(), [Wanted::Program]);
    // Numbers of places are those of the new program already.
    see(&mut model, json!({"turn": 1, "call": [0, 2], "seen": [[3, true]]}));
    assert_eq!(parts(&model, Tone::On), ["M0.0", "└────┤ ├─────", "└─────────────┤"]);
    model.take(program());
    assert_eq!(model.wanted().collect::<Vec<_>>(), [Wanted::Places("OB1".to_string())]);
    model.take(Incoming::Program(Ok(Vec::new())));
    assert_eq!((model.part, model.block.is_none()), (Part::Program, true));
    assert!(model.refused.contains("no block OB1 now"));
    let mut model = opened(1, "OB1", ladder_places());
    keys(&mut model, "\t");
    let left = Order::Status { block: None, call: None, turn: 0 };
    let text = serde_json::to_string(&left).expect("it is JSON");
    assert_eq!(text, r#"{"do":"status","block":null,"turn":0}"#);
    assert_eq!(model.orders().collect::<Vec<_>>(), [left]);
    assert!(picture(&model).contains("watch table"));
}

#[test]
fn an_event_leads_to_its_network() {
    let mut model = model("look");
    model.take(program());
    let event = |place: &str| Entry { clock: 0.0, text: "16#2522".to_string(), place: place.to_string() };
    let buffer = ["OB 1, network 2, main.s7dcl:9", "OB 35, main.stl:7", "DB 1", ""].map(event).to_vec();
    model.take(Incoming::News(Box::new(News { buffer: Some(buffer), ..News::default() })));
    keys(&mut model, "\t↓");
    assert!(!picture(&model).contains("open its block"), "the program has no such block");
    keys(&mut model, "\n↓\n↓\n");
    assert_eq!(model.part, Part::Diagnostics);
    keys(&mut model, "↑↑↑");
    assert!(picture(&model).contains("Enter: open its block"));
    keys(&mut model, "\n");
    assert_eq!(lines(&model)[model.row(Part::Block)], "Network 2");
    model.take(Incoming::Places("OB1".to_string(), places_of(ladder_places())));
    assert_eq!(lines(&model)[model.row(Part::Block)], "Network 2");
}

#[test]
fn the_place_of_an_event_names_its_block() {
    let mut model = model("look");
    model.take(program());
    for (place, expected) in [
        ("Main (OB 1), network 2, main.s7dcl:9", Some(("OB 1", Some(2)))),
        ("Limits, upper (FC 1), main.scl:3", Some(("FC 1", None))),
        ("FC 2, network 1, words.stl:23", Some(("FC 2", Some(1)))),
        ("OB 1", Some(("OB 1", None))),
        ("FC 23, words.stl:23", None),
        ("Program_Alarm, first used in main.scl:17", None),
    ] {
        let event = Entry { clock: 0.0, text: "16#2522".to_string(), place: place.to_string() };
        model.take(Incoming::News(Box::new(News { buffer: Some(vec![event]), ..News::default() })));
        assert_eq!(model.event().map(|(page, network)| (page.id.as_str(), network)), expected, "{place}");
    }
}

#[test]
fn no_document_and_no_status_does_harm() {
    for html in [
        "",
        "<script id=\"data\" type=\"application/json\">{",
        "<script id=\"data\" type=\"application/json\">{}</script>",
    ] {
        assert!(pages_of(html).is_err(), "{html}");
    }
    assert!(crate::document::pages(b"no archive").is_err());
    let svg = r#"<svg><path class="w" d=""/><path class="g" d="M1"/><path class="g" d="q"/><text x="-9999999999" y="z">&<rect x="1"
        <path class="w" d="M-5 -5h99999999"/><text class="v" data-o="7" x="99999999" y="99999999">4</text><circle class="n" cx="0" cy="0"/>"#;
    let logic =
        json!({"nets": [[["&", 7, null, "x"]], [["?", 0]], [[]], [[4]]], "places": [], "contacts": [[0, 7, true]]});
    let section = json!({"n": 1, "svg": svg, "logic": logic});
    let text = json!({"n": 2, "text": "L 1\nü\u{1}", "starts": [90, 7, 8, 9], "kind": "stl"});
    let page =
        serde_json::from_value(json!({"id": "FC 1", "lang": "STL", "secs": [section, text]})).expect("it is a page");
    let mut model = model("look");
    model.take(Incoming::Program(Ok(vec![page])));
    keys(&mut model, "\t\t\n↓\nc");
    let places = json!([
        [7, 9, "variable"],
        [-5, i64::MAX, "value"],
        [91, i64::MIN, "registers"],
        [8, 8, "stack"],
        [0, 0, "ran"]
    ]);
    model.take(Incoming::Places("FC1".to_string(), places_of(places)));
    see(
        &mut model,
        json!({"turn": 1, "calls": [], "call": [7, 1], "seen": [[0, true], [1, {}], [2, "x"], [3, [1, [1, []]]], [4, []], [99, 1]]}),
    );
    let _ = picture(&model);
    for key in "c←\t".chars() {
        keys(&mut model, &key.to_string());
    }
    model.take(Incoming::Places("FC1".to_string(), Err("no".to_string())));
    let _ = picture(&model);
}
