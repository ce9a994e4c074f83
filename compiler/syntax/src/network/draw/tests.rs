use plcc_diag::{FileId, Span};

use super::draw;
use crate::network::ast::{
    Content, Element, Eno, Graph, Language, Net, NetId, Network, Pin, PinValue, Source, Storage, Target,
};
use crate::network::elements::{PinDirection, find_sd};
use crate::scl::ast::Expr;
use crate::scl::fragment;

/// Networks from a short notation: `w1 < Contact #a > w2`, `w1 < #t.TON pt=#x q1=>w3 > w2`; the rail is the net `rail`.
fn network(language: Language, lines: &[&str]) -> Network {
    let mut graph = Graph::default();
    for line in lines {
        element(&mut graph, line);
    }
    let content = Content::Graphic(graph);
    Network { language, title: None, comment: Vec::new(), labels: Vec::new(), content, span: Span::default() }
}

fn net(graph: &mut Graph, name: &str) -> NetId {
    if let Some(at) = graph.nets.iter().position(|net| net.name == name) {
        return NetId(at as u32);
    }
    let sources = match name {
        "rail" => vec![Source::Rail],
        _ if name.starts_with(['#', '"']) => vec![Source::Operand { value: expr(name), negated: false }],
        _ => Vec::new(),
    };
    graph.nets.push(Net { name: name.to_string(), sources, span: Span::default() });
    NetId(graph.nets.len() as u32 - 1)
}

fn expr(text: &str) -> Expr {
    fragment::expression(FileId(0), text, 0..text.len()).0
}

fn element(graph: &mut Graph, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (from, words) = match words.as_slice() {
        [from, "<", rest @ ..] => (Some(*from), rest),
        rest => (None, rest),
    };
    let (words, to) = match words {
        [rest @ .., ">", to] => (rest, Some(*to)),
        rest => (rest, None),
    };
    let Some((&name, pins)) = words.split_first() else {
        let (from, to) = (net(graph, from.unwrap_or("rail")), net(graph, to.unwrap_or("rail")));
        return graph.nets[to.0 as usize].sources.push(Source::Net(from));
    };
    let (instance, name) = match name.rsplit_once('.') {
        Some((instance, name)) => (Some(expr(instance)), name),
        None => (None, name),
    };
    let (row, negated) = find_sd(name).expect("an element");
    let mut element = Element {
        target: Target::Element { row, instance },
        templates: Vec::new(),
        eno: Eno::Default,
        pins: Vec::new(),
        equation: None,
        cases: Vec::new(),
        span: Span::default(),
    };
    let mut add = |name: &str, value: PinValue, negated: bool, output: bool| {
        let pin = Pin { name: name.to_string(), value, negated, output, storage: Storage::None, span: Span::default() };
        element.pins.push(pin);
    };
    if let Some(from) = from {
        add(row.flow.0, PinValue::Net(net(graph, from)), false, false);
    }
    for pin in pins {
        let (name, text) = pin.split_once('=').unwrap_or(("operand", pin));
        let (invert, text) = text.strip_prefix('!').map_or((false, text), |text| (true, text));
        let value = match text {
            "" => PinValue::Open,
            _ if text.starts_with('w') => PinValue::Net(net(graph, text)),
            _ => PinValue::Operand(expr(text)),
        };
        let output = row.pin(name).is_some_and(|(pin, _)| pin.direction == PinDirection::Output);
        add(name, value, invert || name == "operand" && negated, output);
    }
    if let Some(to) = to {
        let to = net(graph, to);
        add(row.flow.1, PinValue::Net(to), false, true);
        let source = Source::Pin { element: graph.elements.len(), pin: element.pins.len() - 1 };
        graph.nets[to.0 as usize].sources.push(source);
    }
    graph.elements.push(element);
}

fn check(language: Language, lines: &[&str], mark: Option<usize>, drawing: &str) {
    let drawn = draw(&network(language, lines), mark);
    assert_eq!(drawn.trim_end(), drawing.trim_matches('\n').trim_end(), "\n{drawn}");
}

#[test]
fn seal_in() {
    check(
        Language::Lad,
        &["rail < Contact #Start > w1", "rail < Contact #Motor > w1", "w1 < I_Contact #Stop > w2", "w2 < Coil #Motor"],
        Some(2),
        r#"
|   #Start       #Stop       #Motor
|----| |-----+----|/|---------( )
|            |   ^^^^^
|   #Motor   |
|----| |-----+
"#,
    );
}

#[test]
fn nested_branches() {
    check(
        Language::Lad,
        &[
            "rail < Contact #a > w1",
            "w1 < Contact #b > w2",
            "w1 < I_Contact #c > w2",
            "rail < Contact #d > w2",
            "w2 < Coil #q1",
            "w1 < Contact #e > w3",
            "w3 < S_Coil #q2",
        ],
        Some(5),
        r#"
|   #a        #b        #q1
|---| |---+---| |---+---( )
|         |   #c    |
|         +---|/|---+
|   #d    |         |
|---| |-------------+
          |   #e        #q2
          +---| |-------(S)
              ^^^
"#,
    );
}

#[test]
fn boxes_with_pins() {
    check(
        Language::Lad,
        &[
            "rail < Contact #Cause > w3",
            "w3 < #Delay.TON pt=T#2s et= > w1",
            "rail < Contact #Ack > w4",
            "w4 < I_Contact #Cause > w5",
            "w5 < S_RS operand=#Alarm s1=w1 > w6",
            "w6 < Coil #Lamp",
        ],
        None,
        r#"
                       #Delay
|   #Cause             +-TON-+
|----| |---------------|in  q|-----+ w1
|                T#2s--|pt et|--
|                      +-----+
|
|   #Ack       #Cause               +--S_RS---+         #Lamp
|---| |---------|/|-----------------|r       q|----------( )
                            #Alarm--|operand  |
                                w1--|s1       |
                                    +---------+
"#,
    );
    check(
        Language::Lad,
        &[
            "rail < Contact #On > w1",
            "w1 < Normalize min=0 value=#raw max=27648 out=#n > w2",
            "w2 < GT_Contact in1=#n in2=0.9 > w3",
            "w3 < Coil \"High\"",
        ],
        Some(1),
        r#"
|   #On              +Normalize+           #n        "High"
|---| |--------------|en    eno|-----------|>|--------( )
                  0--|min   out|--#n       0.9
               #raw--|value    |
              27648--|max      |
                     +---------+
              ^^^^^^^^^^^^^^^^^^^^^^
"#,
    );
}

#[test]
fn gates() {
    check(
        Language::Fbd,
        &["#c < O in2=#d > w1", "#a < A in2=!#b in3=w1 > w2", "w2 < Coil #q"],
        Some(1),
        r#"
           +-->=1--+
 #c--------|in1 out|-----+ w1
       #d--|in2    |
           +-------+

           +---&---+         #q
 #a--------|in1 out|---------[=]
       #b-o|in2    |
       w1--|in3    |
           +-------+
       ^^^^^^^^^^^^^^^
"#,
    );
}

#[test]
fn what_makes_no_sense_is_drawn_too() {
    check(
        Language::Lad,
        &["rail < Contact #a > w1", "rail < > w1", "w1 < Coil #q"],
        Some(0),
        r#"
|   #a        #q
|---| |---+---( )
|   ^^^   |
|         |
|---------+
"#,
    );
    check(
        Language::Lad,
        &["w2 < Contact #a > w1", "w1 < Contact #b > w2", "w1 < Coil"],
        Some(2),
        r#"
                        #a
                    +---| |---> w1
              #b    |
          +---| |---+
          |   <??.?>
          +----( )
              ^^^^^^
"#,
    );
    check(
        Language::Lad,
        &["w9 < Contact #a > w1"],
        None,
        r#"
          #a
<??.?>----| |----
"#,
    );
    check(
        Language::Lad,
        &[],
        None,
        r#"
"#,
    );
}

#[test]
fn long_networks_are_cut_around_the_mark() {
    let lines: Vec<String> = (0..500).map(|at| format!("w{at} < Contact #x{at} > w{}", at + 1)).collect();
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let drawn = draw(&network(Language::Lad, &lines), Some(250));
    assert!(drawn.contains("#x250") && !drawn.contains("#x300"), "{drawn}");
    assert!(drawn.len() < 1000 && drawn.contains("^^^^^"), "{drawn}");
    let lines: Vec<String> = (0..500).map(|at| format!("w1 < Contact #x{at} > w2")).collect();
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    assert!(draw(&network(Language::Lad, &lines), Some(499)).contains("#x499"));
}
