//! Pictures of models, and what keys order. `UPDATE_EXPECT=1` renews the pictures.

use crate::messages::{Change, Entry, Forced, Hello, Listed, News, Order, Shown, State};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::crossterm::event::KeyCode;

use crate::connection::Incoming;
use crate::draw::draw;
use crate::model::{Model, Wanted};

mod block;

/// The model as text, a line for each line of the screen.
fn picture(model: &Model) -> String {
    picture_of_width(model, 96)
}

fn picture_of_width(model: &Model, width: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, 18)).expect("a screen in memory");
    terminal.draw(|frame| draw(model, frame)).expect("a screen in memory");
    let buffer = terminal.backend().buffer();
    let line = |y: u16| {
        let text: String = (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect();
        format!("{}\n", text.trim_end())
    };
    (0..buffer.area.height).map(line).collect()
}

fn check(name: &str, model: &Model) {
    let path =
        std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../compiler/monitor")).join("tests").join(name);
    let found = picture(model);
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        std::fs::write(&path, &found).expect("the folder can be written");
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(found == expected, "{}:\n{found}", path.display());
}

fn listed() -> Incoming {
    let one = |(name, ty): (&str, &'static str)| Listed { name: name.to_string(), ty: ty.into() };
    let all = [
        ("I0.0", "BOOL"),
        ("Line.a.count", "INT"),
        ("Line.a.delay", "TIME"),
        ("Line.b.count", "INT"),
        ("MW10", "WORD"),
    ];
    Incoming::Connected(all.map(one).to_vec(), Vec::new())
}

fn news(role: &str) -> News {
    serde_json::from_str(&format!(
        r#"{{"hello": {{"program": "line", "cpu": "s7-1500", "user": "", "role": "{role}", "watchable": true}},
            "state": {{"running": true, "reason": "", "cycle": 1204, "generation": 0, "clock": 86399999.0}},
            "buffer": [{{"clock": 3723004.0, "event": 17154, "text": "16#4302 RUN", "place": ""}}]}}"#
    ))
    .expect("it is what the page gets")
}

fn model(role: &str) -> Model {
    let mut model = Model::new("127.0.0.1:8080", vec!["MW10".to_string(), "I0.0".to_string(), "Nobody".to_string()]);
    model.take(listed());
    model.take(Incoming::News(Box::new(news(role))));
    let shown = |text: &str, ty: &'static str| Shown { text: text.to_string(), ty: ty.to_string(), bits: 16 };
    model.take(Incoming::News(Box::new(News {
        list: Some(1),
        values: vec![(0, shown("16#002A", "WORD")), (1, shown("1", "BOOL"))],
        wrong: vec![(2, "`Nobody` is not a name".to_string())],
        forced: Some(vec![Forced { name: "I0.0".to_string(), value: "1".to_string(), address: "I0.0".to_string() }]),
        ..News::default()
    })));
    model
}

fn keys(model: &mut Model, keys: &str) {
    for key in keys.chars() {
        model.key(match key {
            '\n' => KeyCode::Enter,
            '\t' => KeyCode::Tab,
            '↓' => KeyCode::Down,
            '↑' => KeyCode::Up,
            '←' => KeyCode::Backspace,
            letter => KeyCode::Char(letter),
        });
    }
}

fn change(name: &str, value: &str, format: Option<&str>) -> Change {
    Change { name: name.to_string(), value: value.to_string(), format: format.map(str::to_string) }
}

#[test]
fn a_cpu_in_run() {
    check("run.txt", &model("change"));
}

#[test]
fn a_narrow_screen_has_all_keys_and_the_whole_of_a_message() {
    let mut model = model("change");
    let end = |model: &Model, expected: &str| {
        let picture = picture_of_width(model, 60);
        assert!(picture.ends_with(expected), "{picture}");
    };
    end(&model, "\nTab ↑↓  m: modify  f: force  u: end forcing  d: remove\na: add  S: stop  R: run  q: leave\n");
    let why = "a value of MW10 that is as long as the messages of the process about wrong values";
    model.take(Incoming::News(Box::new(News { refused: Some(why.to_string()), ..News::default() })));
    end(&model, "\na value of MW10 that is as long as the messages of the\nprocess about wrong values\n");
}

#[test]
fn a_branch_is_opened_and_a_value_watched() {
    let mut model = model("look");
    let _ = model.orders().count();
    keys(&mut model, "\t\t↓\n↓\n↓\n");
    check("tree.txt", &model);
    let names = ["MW10", "I0.0", "Nobody", "Line.a.count"].map(str::to_string).to_vec();
    assert_eq!(model.orders().collect::<Vec<_>>(), [Order::Watch { names, formats: Vec::new(), number: 2 }]);
    keys(&mut model, "/delay\n");
    check("search.txt", &model);
}

#[test]
fn values_are_modified_and_forced() {
    let mut model = model("change");
    let _ = model.orders().count();
    let text = str::to_string;
    keys(&mut model, "m12←7\n↓f0\nuS\nSy\nRy\n");
    let orders = [
        Order::Modify(change("MW10", "17", Some("hex"))),
        Order::Force(change("I0.0", "0", None)),
        Order::Unforce { name: Some(text("I0.0")) },
        Order::Stop,
        Order::Run { restart: text("warm") },
    ];
    assert_eq!(model.orders().collect::<Vec<_>>(), orders);
    keys(&mut model, "f1");
    check("question.txt", &model);
    keys(&mut model, "\nd");
    assert_eq!(model.watched, ["MW10", "Nobody"]);
    keys(&mut model, "q");
    assert!(model.is_over());
}

#[test]
fn the_reason_of_a_wrong_row_is_shown_as_a_whole() {
    let mut model = model("look");
    let why = "`Nobody` is neither an address (such as Q4.0, MW20) nor a symbol of the program";
    model.take(Incoming::News(Box::new(News { list: Some(1), wrong: vec![(2, why.to_string())], ..News::default() })));
    assert!(!picture(&model).contains(why));
    keys(&mut model, "↓↓");
    assert!(picture(&model).contains(why));
}

#[test]
fn a_value_that_is_too_long_says_so() {
    let mut model = model("look");
    let text = "DTL#2026-02-28-12:13:14.567890123".to_string();
    let value = (0, Shown { text, ty: "DTL".to_string(), bits: 96 });
    model.take(Incoming::News(Box::new(News { list: Some(1), values: vec![value], ..News::default() })));
    let picture = picture(&model);
    assert!(picture.contains(" DTL#2026-02-28-12:13:… DTL "), "{picture}");
}

#[test]
fn keys_that_need_a_role_say_so_before_they_ask() {
    let mut model = model("look");
    let _ = model.orders().count();
    for (key, role) in
        [("m", "`operate` or `change`"), ("M", "`operate`"), ("f", "role `change`"), ("S", "role `change`")]
    {
        keys(&mut model, key);
        assert!(model.refused.contains(role) && model.refused.contains("--user"), "{key}: {}", model.refused);
        assert_eq!(model.asks, None, "{key}");
    }
    keys(&mut model, "u");
    assert_eq!(model.orders().count(), 0);
}

#[test]
fn outputs_are_enabled_and_the_memory_is_reset_in_stop() {
    let mut model = model("change");
    let _ = model.orders().count();
    let state = |outputs| State { reason: "STOP by a client".to_string(), outputs, ..State::default() };
    let stop = |outputs| Incoming::News(Box::new(News { state: Some(state(outputs)), ..News::default() }));
    model.take(stop(false));
    keys(&mut model, "\t");
    check("stop.txt", &model);
    keys(&mut model, "On\nOy\nC\nCY\n");
    assert_eq!(model.orders().collect::<Vec<_>>(), [Order::Outputs { enable: true }, Order::Reset]);
    model.take(stop(true));
    check("outputs.txt", &model);
    keys(&mut model, "O");
    let orders: Vec<_> = model.orders().collect();
    assert_eq!(orders, [Order::Outputs { enable: false }], "at once");
    let texts: Vec<_> =
        orders.iter().chain([&Order::Reset]).filter_map(|one| serde_json::to_string(one).ok()).collect();
    assert_eq!(texts, [r#"{"do":"outputs","enable":false}"#, r#"{"do":"reset"}"#]);
    let read = |text: &str| serde_json::from_str::<State>(text).expect("it is what the page gets").outputs;
    assert!(read(r#"{"running": false, "reason": "", "outputs": true, "cycle": 1}"#));
}

#[test]
fn a_cpu_that_has_a_cold_restart_is_started_so() {
    let mut model = model("change");
    let _ = model.orders().count();
    keys(&mut model, "Rc\n");
    assert_eq!(model.orders().count(), 0, "an S7-1500 has none");
    let mut hello = model.hello.clone().expect("it has come");
    hello.has_cold = true;
    model.take(Incoming::News(Box::new(News { hello: Some(hello), ..News::default() })));
    keys(&mut model, "R");
    assert!(picture(&model).contains("c for a cold restart"));
    keys(&mut model, "c\nRy\nRx\n");
    let run = |restart: &str| Order::Run { restart: restart.to_string() };
    assert_eq!(model.orders().collect::<Vec<_>>(), [run("cold"), run("warm")]);
}

#[test]
fn watch_tables_of_the_project_are_shown_one_after_the_other() {
    let mut model = model("operate");
    keys(&mut model, "t");
    assert_eq!(model.wanted().next(), None, "there are none");
    let Incoming::Connected(names, _) = listed() else { unreachable!("it is the list") };
    model.take(Incoming::Connected(names, ["level", "speed"].map(str::to_string).to_vec()));
    let _ = model.orders().count();
    keys(&mut model, "t");
    let table = |name: &str| vec![Wanted::Table(name.to_string())];
    assert_eq!(model.wanted().collect::<Vec<_>>(), table("level"));
    assert_eq!(model.wanted().next(), None);
    let sheet = r#"{"row": [{"address": "MW10", "format": "dec", "comment": "x", "modify": "120", "trigger": "end"},
        {"address": "MW10"}, {"address": "I0.0"}]}"#;
    let all = || ["level", "speed"].map(str::to_string).to_vec();
    model.take(Incoming::Table("level".to_string(), all(), Ok(serde_json::from_str(sheet).expect("it is a table"))));
    let names = ["MW10", "I0.0"].map(str::to_string).to_vec();
    let formats = vec![Some("dec".to_string()), None];
    assert_eq!(model.orders().collect::<Vec<_>>(), [Order::Watch { names, formats, number: 3 }]);
    check("table.txt", &model);
    keys(&mut model, "M↓m1\nMm←\nM");
    let (speed, input) = (change("MW10", "120", Some("dec")), change("I0.0", "1", None));
    let orders = [
        Order::All { rows: vec![speed.clone()] },
        Order::Modify(input.clone()),
        Order::All { rows: vec![speed.clone(), input] },
        Order::All { rows: vec![speed] },
    ];
    assert_eq!(model.orders().collect::<Vec<_>>(), orders);
    let text = serde_json::to_string(&orders[0]).expect("it is JSON");
    assert_eq!(text, r#"{"do":"all","rows":[{"name":"MW10","value":"120","format":"dec"}]}"#);
    keys(&mut model, "↑dM");
    assert!(model.refused.contains("no row has a modify value"));
    keys(&mut model, "aMW10\n");
    let _ = model.orders().count();
    keys(&mut model, "t");
    assert_eq!(model.wanted().collect::<Vec<_>>(), table("speed"));
    model.take(Incoming::Table("speed".to_string(), all(), Err("tables/speed.toml: line 2: wrong".to_string())));
    assert_eq!((model.table.as_deref(), model.watched.len()), (Some("level"), 2), "the one before stays");
    assert!(model.refused.contains("line 2"));
    keys(&mut model, "t");
    assert_eq!(model.wanted().collect::<Vec<_>>(), table("level"), "the one that cannot be shown is passed");
}

#[test]
fn values_of_an_earlier_list_are_not_shown() {
    let mut model = model("look");
    keys(&mut model, "d");
    let _ = model.orders().count();
    let shown = |text: &str| Shown { text: text.to_string(), ty: "BOOL".to_string(), bits: 1 };
    let values = |list, text| News { list, values: vec![(0, shown(text))], ..News::default() };
    let wrong = News { list: Some(1), wrong: vec![(1, "no such name".to_string())], ..News::default() };
    for news in [values(Some(1), "16#002A"), values(None, "16#002A"), wrong] {
        model.take(Incoming::News(Box::new(news)));
    }
    assert!(model.values.is_empty(), "they are those of other rows");
    model.take(Incoming::News(Box::new(values(Some(2), "1"))));
    assert_eq!(model.values.keys().collect::<Vec<_>>(), ["I0.0"]);
}

#[test]
fn a_lost_connection_is_told_and_begins_anew() {
    let mut model = model("operate");
    model.take(Incoming::Lost("Connection refused".to_string()));
    check("lost.txt", &model);
    let _ = model.orders().count();
    model.take(listed());
    assert_eq!(model.orders().count(), 1, "the watch table is asked for again");
    assert_eq!(model.lost.as_deref(), Some("waiting for the CPU"), "nobody knows yet whether it runs");
    model.take(Incoming::News(Box::new(News {
        refused: Some("DB 1 is write-protected".to_string()),
        ..News::default()
    })));
    let stop = State { reason: "STOP by a client".to_string(), ..State::default() };
    model.take(Incoming::News(Box::new(News { state: Some(stop), ..News::default() })));
    assert_eq!(model.lost, None);
    check("refused.txt", &model);
}

#[test]
fn no_key_and_no_news_do_harm() {
    let mut model = Model::new("", Vec::new());
    let entry = Entry { clock: f64::NAN, text: String::new(), place: String::new() };
    let hello = Hello {
        program: String::new(),
        cpu: String::new(),
        role: plcc_abi::services::Role::Look,
        watchable: true,
        has_cold: false,
        force_modules: true,
    };
    for round in 0..3 {
        keys(&mut model, "t\n↓↑\tmfud\n↑↓\t\n/x\n\ta\n");
        let _ = picture(&model);
        let mut news = News { buffer: Some(vec![entry.clone(); round]), hello: Some(hello.clone()), ..News::default() };
        news.wrong = vec![(usize::MAX, String::new())];
        let number = |order: Order| if let Order::Watch { number, .. } = order { Some(number) } else { None };
        news.list = model.orders().filter_map(number).last();
        model.take(Incoming::News(Box::new(news)));
        model.take(Incoming::Connected(vec![Listed { name: "..".to_string(), ty: "".into() }], vec![String::new()]));
    }
}
