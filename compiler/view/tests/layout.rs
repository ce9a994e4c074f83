//! What holds for every drawing: nothing overlaps, no wire crosses a box or a text, wires of different nets are never
//! on top of each other, and the wires of a net are connected. Checked on random networks, also on some that no
//! editor allows.

use proptest::prelude::*;

use plcc_view::faults::faults;
use plcc_view::scene::{Item, Scene};
use plcc_view::sheet::{Label, Link, Look, Meaning, Net, Part, Pin, Place, Sheet, Source};
use plcc_view::{diagram, ladder};

fn pin(name: &str, place: Place, output: bool, link: Link) -> Pin {
    Pin { name: name.to_string(), place, output, link, negated: false }
}

fn operand(number: usize) -> Link {
    let text = ["#Start", "\"Tank\".Valves[3].IsOpen", "I0.0", "a", "\"PumpRunningFeedback\""][number % 5].to_string();
    let address = if number.is_multiple_of(3) { "DB10.DBX2.0".to_string() } else { String::new() };
    Link::Operand(Label { key: text.clone(), text, address, value: None, place: None })
}

/// A contact, a coil (without `to`) or a box between nets.
fn part(kind: usize, from: usize, to: Option<usize>, reset: Option<usize>, further: Option<usize>) -> Part {
    let mut pins = vec![pin("IN", Place::Side, false, Link::Net(from))];
    let mut flow_out = None;
    if let Some(to) = to {
        flow_out = Some(pins.len());
        pins.push(pin("Q", Place::Side, true, Link::Net(to)));
    }
    let look = match kind % 5 {
        0 | 1 if to.is_some() => {
            pins.push(pin("", Place::Above, false, operand(kind)));
            Look::Contact { sign: if kind.is_multiple_of(2) { String::new() } else { "/".to_string() } }
        }
        2 if to.is_some() => {
            pins.push(pin("", Place::Above, false, operand(kind)));
            pins.push(pin("", Place::Below, false, operand(kind + 1)));
            Look::Compare { sign: ">=".to_string(), ty: "Real".to_string() }
        }
        0..=2 => {
            pins.push(pin("", Place::Above, true, operand(kind)));
            Look::Coil { sign: ["", "S", "SET_BF"][kind % 3].to_string() }
        }
        _ => {
            pins.push(pin("PT", Place::Side, false, operand(kind)));
            pins.push(pin("ET", Place::Side, true, operand(kind + 1)));
            if let Some(reset) = reset {
                pins.push(pin("R", Place::Side, false, Link::Net(reset)));
            }
            if let Some(further) = further {
                pins.push(pin("QD", Place::Side, true, Link::Net(further)));
            }
            let instance = Some(Label::plain("#Instance"));
            Look::Box { title: "CTUD".to_string(), detail: "Int".to_string(), instance }
        }
    };
    let meaning = if matches!(look, Look::Coil { .. }) { Meaning::Through } else { Meaning::Other };
    Part { look, meaning, pins, flow_in: Some(0), flow_out, place: None, statement: None }
}

/// Fills in the sources of nets.
fn finished(parts: Vec<Part>, nets: usize) -> Sheet {
    let nets = (0..nets).map(|n| Net { name: format!("w{n}"), ..Net::default() }).collect();
    let mut sheet = Sheet { parts, nets, ..Sheet::default() };
    sheet.nets[0].sources.push(Source::Rail);
    for at in 0..sheet.parts.len() {
        for index in 0..sheet.parts[at].pins.len() {
            let pin = &sheet.parts[at].pins[index];
            if let (Link::Net(net), true) = (&pin.link, pin.output) {
                let net = *net;
                sheet.nets[net].sources.push(Source::Pin { part: at, pin: index });
            }
        }
    }
    sheet
}

/// Any graph: net 0 is the rail.
fn any_sheet(forward: bool) -> impl Strategy<Value = Sheet> {
    let element = (
        0usize..20,
        0usize..9,
        0usize..10,
        proptest::option::weighted(0.3, 0usize..9),
        proptest::option::weighted(0.2, 1usize..9),
    );
    proptest::collection::vec(element, 1..14).prop_map(move |elements| {
        let parts = elements.into_iter().map(|(kind, from, to, reset, further)| {
            let to = match forward {
                true => Some(from + 1 + to).filter(|to| *to < 9),
                false => Some(to).filter(|to| (1..9).contains(to)),
            };
            part(kind, from, to, reset, further)
        });
        finished(parts.collect(), 9)
    })
}

/// Rungs as editors make them: series, parallel branches and coils, boxes with rungs of their own at further inputs.
#[derive(Clone, Debug)]
enum Rung {
    Element(usize),
    Box(Option<Box<Rung>>),
    Series(Vec<Rung>),
    Parallel(Vec<Rung>),
}

fn rung() -> impl Strategy<Value = Rung> {
    let leaf = (0usize..20).prop_map(Rung::Element);
    leaf.prop_recursive(4, 24, 4, |inner| {
        prop_oneof![
            proptest::option::of(inner.clone()).prop_map(|feed| Rung::Box(feed.map(Box::new))),
            proptest::collection::vec(inner.clone(), 1..5).prop_map(Rung::Series),
            proptest::collection::vec(inner, 2..4).prop_map(Rung::Parallel),
        ]
    })
}

struct Builder {
    parts: Vec<Part>,
    nets: usize,
}

impl Builder {
    fn net(&mut self) -> usize {
        self.nets += 1;
        self.nets - 1
    }

    fn add(&mut self, rung: &Rung, from: usize, to: usize) {
        match rung {
            Rung::Element(kind) => self.parts.push(part(kind % 5 % 3, from, Some(to), None, None)),
            Rung::Box(feed) => {
                let reset = feed.as_ref().map(|feed| {
                    let net = self.net();
                    self.add(feed, 0, net);
                    net
                });
                self.parts.push(part(3, from, Some(to), reset, None));
            }
            Rung::Series(list) => {
                let mut at = from;
                for (index, rung) in list.iter().enumerate() {
                    let next = if index + 1 == list.len() { to } else { self.net() };
                    self.add(rung, at, next);
                    at = next;
                }
            }
            Rung::Parallel(list) => list.iter().for_each(|rung| self.add(rung, from, to)),
        }
    }
}

fn editor_sheet() -> impl Strategy<Value = Sheet> {
    proptest::collection::vec((rung(), 1usize..4), 1..4).prop_map(|rungs| {
        let mut builder = Builder { parts: Vec::new(), nets: 1 };
        for (rung, coils) in rungs {
            let end = builder.net();
            builder.add(&rung, 0, end);
            (0..coils).for_each(|kind| builder.parts.push(part(kind % 3, end, None, None, None)));
        }
        finished(builder.parts, builder.nets)
    })
}

fn check(name: &str, scene: &Scene, sheet: &Sheet) {
    let faults = faults(scene, sheet);
    if let (false, Ok(path)) = (faults.is_empty(), std::env::var("PLCC_VIEW_FAULT")) {
        std::fs::write(path, plcc_view::svg::file(scene, None)).expect("a file can be written");
    }
    assert!(faults.is_empty(), "{name}: {faults:#?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn rungs_of_editors(mut sheet in editor_sheet(), width in 300i32..1400) {
        let scene = ladder::draw(&mut sheet, width);
        check("LAD", &scene, &sheet);
    }

    #[test]
    fn rungs_of_any_graph(mut sheet in any_sheet(true), width in 300i32..1400) {
        let scene = ladder::draw(&mut sheet, width);
        check("LAD", &scene, &sheet);
    }

    #[test]
    fn rungs_with_loops(mut sheet in any_sheet(false), width in 300i32..1400) {
        let scene = ladder::draw(&mut sheet, width);
        check("LAD", &scene, &sheet);
    }

    #[test]
    fn diagrams_of_editors(sheet in editor_sheet(), width in 300i32..1400) {
        check("FBD", &diagram::draw(&sheet, width), &sheet);
    }

    #[test]
    fn diagrams_of_any_graph(sheet in any_sheet(true), width in 300i32..1400) {
        check("FBD", &diagram::draw(&sheet, width), &sheet);
    }

    #[test]
    fn diagrams_with_loops(sheet in any_sheet(false), width in 300i32..1400) {
        check("FBD", &diagram::draw(&sheet, width), &sheet);
    }
}

/// A page that watches a program paints the wire at an operand with the value of the operand, which it finds by its place.
#[test]
fn wires_at_operands_have_their_places() {
    let label = |text: &str, place: u32| Link::Operand(Label { place: Some(place), ..Label::plain(text) });
    let pins = vec![
        pin("IN1", Place::Side, false, label("%I0.0", 70)),
        pin("IN2", Place::Side, false, label("%I0.1", 81)),
        pin("OUT", Place::Side, true, label("%Q0.0", 92)),
    ];
    let look = Look::Box { title: "&".to_string(), detail: String::new(), instance: None };
    let part = Part { look, meaning: Meaning::And, pins, flow_in: None, flow_out: None, place: None, statement: None };
    let scene = diagram::draw(&finished(vec![part], 1), 900);
    let wires = |places: bool, place: u32| {
        let wire = format!("<path class=\"w\" data-o=\"{place}\"");
        plcc_view::svg::inline(&scene, places).matches(&wire).count()
    };
    for place in [70, 81, 92] {
        assert_eq!((wires(true, place), wires(false, place)), (1, 0), "{place}");
    }
}

/// The value of a box that another box of its own rung reads: a name at the output and one at the input, and no line besides.
#[test]
fn values_between_rungs_have_their_name_at_the_pins() {
    let of_box = |value: Pin| {
        let look = Look::Box { title: "ADD".to_string(), detail: "DInt".to_string(), instance: None };
        let pins = vec![pin("EN", Place::Side, false, Link::Net(0)), value, pin("IN2", Place::Side, false, operand(2))];
        Part { look, meaning: Meaning::Other, pins, flow_in: Some(0), flow_out: None, place: None, statement: None }
    };
    let reads = || of_box(pin("IN1", Place::Side, false, Link::Net(1)));
    for readers in 1..3 {
        let mut parts = vec![of_box(pin("OUT", Place::Side, true, Link::Net(1)))];
        parts.extend((0..readers).map(|_| reads()));
        let mut sheet = finished(parts, 2);
        let scene = ladder::draw(&mut sheet, 900);
        check("LAD", &scene, &sheet);
        let drawn = plcc_view::svg::file(&scene, None);
        let count = |text: &str| drawn.matches(text).count();
        assert_eq!((count("»w1"), count("w1»"), count("??")), (1, readers, 0), "{drawn}");
    }
}

/// Branches that come together and others that part after them have a column each, as in the editors.
#[test]
fn branches_after_branches_have_columns_of_their_own() {
    let both = || Rung::Parallel(vec![Rung::Element(0), Rung::Element(1)]);
    let mut builder = Builder { parts: Vec::new(), nets: 1 };
    let end = builder.net();
    builder.add(&Rung::Series(vec![both(), both()]), 0, end);
    builder.parts.push(part(0, end, None, None, None));
    let mut sheet = finished(builder.parts, builder.nets);
    let scene = ladder::draw(&mut sheet, 900);
    check("LAD", &scene, &sheet);
    // Net 2 is between the branches.
    let columns: std::collections::BTreeSet<i32> = scene
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Wire { from, to, net: Some(2), .. } if from.0 == to.0 && from.1 != to.1 => Some(from.0),
            _ => None,
        })
        .collect();
    assert_eq!(columns.len(), 2, "{columns:?}");
}

/// As PLCopen XML has them; a line would go into the box where it has no input.
#[test]
fn no_line_leads_from_the_rail_to_a_box_without_en() {
    let counter = Part { flow_in: None, ..part(3, 1, None, None, None) };
    let mut sheet = finished(vec![part(0, 0, Some(1), None, None), counter], 2);
    let scene = ladder::draw(&mut sheet, 900);
    check("LAD", &scene, &sheet);
    let rail =
        scene.items.iter().find_map(|item| if let Item::Rail { from, to } = item { Some((*from, *to)) } else { None });
    let (top, bottom) = rail.expect("the contact is at the rail");
    let is_lead = |item: &&Item| matches!(item, Item::Wire { from, .. } if from.0 == top.0);
    assert_eq!(scene.items.iter().filter(is_lead).count(), 1, "only that of the contact");
    assert_eq!(bottom.1 - top.1, 24, "the rail is not longer than its lines need");
}

/// In the last column its wire would have to pass those of the boxes between.
#[test]
fn a_coil_at_a_wire_that_leads_on_stands_right_after_what_feeds_it() {
    let boxed = |from: usize, to: usize| part(3, from, Some(to), None, None);
    let coil = |from: usize| part(0, from, None, None, None);
    let sheet = finished(vec![boxed(0, 1), coil(1), boxed(1, 2), boxed(2, 3), coil(3)], 4);
    let scene = diagram::draw(&sheet, 4000);
    check("FBD", &scene, &sheet);
    let coil_at = |wanted: usize| {
        let found = scene.items.iter().find_map(|item| match item {
            Item::Glyph { area, part, .. } if *part == wanted => Some(area.x),
            _ => None,
        });
        found.expect("the coil is drawn")
    };
    let frames =
        scene.items.iter().filter_map(|item| if let Item::Frame { area, .. } = item { Some(area.x) } else { None });
    let last = frames.max().expect("the boxes are drawn");
    assert!(coil_at(1) < last && last < coil_at(4), "{} {last} {}", coil_at(1), coil_at(4));
}
