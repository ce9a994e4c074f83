//! One element of a rung: what it is, and its pins.

use plcc_diag::{Code, Diagnostic, Span};

use super::pins::Pins;
use super::settings::{self, Settings};
use super::{Builder, Carried, Flow};
use crate::sd::pragma::Attribute;
use crate::sd::tree::{Argument, Node, Pin as Given};
use plcc_syntax::Elementary;
use plcc_syntax::network::absent;
use plcc_syntax::network::ast::{Comparison, Element, Eno, Language, Pin, Storage, Target};
use plcc_syntax::network::elements::{self, Gate, Kind, Row};

/// The meaning of the text before the parentheses.
enum Meaning {
    Row {
        row: &'static Row,
        /// The name says that the operand is negated.
        negated: bool,
        /// `#t1` of `#t1.TON`.
        before: Option<Span>,
    },
    Block,
    Unknown,
}

/// Names of elements in other editors, and what SIMATIC SD calls them.
const FOREIGN: [(&str, &str); 52] = [
    ("Jump", "JumpCoil"),
    ("JMP", "JumpCoil"),
    ("JumpNot", "I_JumpCoil"),
    ("JMPN", "I_JumpCoil"),
    ("Ret", "Return"),
    ("S", "S_Coil"),
    ("R", "R_Coil"),
    ("Calc", "Calculate"),
    ("PContact", "P_Contact"),
    ("XIC", "Contact"),
    ("XIO", "I_Contact"),
    ("NO", "Contact"),
    ("NC", "I_Contact"),
    ("NormallyOpen", "Contact"),
    ("NormallyClosed", "I_Contact"),
    ("OTE", "Coil"),
    ("OTL", "S_Coil"),
    ("OTU", "R_Coil"),
    ("EQU", "Eq"),
    ("NEQ", "Ne"),
    ("GRT", "Gt"),
    ("LES", "Lt"),
    ("GEQ", "Ge"),
    ("LEQ", "Le"),
    ("CmpEQ", "EQ_Contact` in LAD, in FBD `Eq"),
    ("CmpNE", "NE_Contact` in LAD, in FBD `Ne"),
    ("CmpGT", "GT_Contact` in LAD, in FBD `Gt"),
    ("CmpLT", "LT_Contact` in LAD, in FBD `Lt"),
    ("CmpGE", "GE_Contact` in LAD, in FBD `Ge"),
    ("CmpLE", "LE_Contact` in LAD, in FBD `Le"),
    ("ONS", "P_Contact"),
    ("Output", "Coil"),
    ("Set", "S_Coil"),
    ("Reset", "R_Coil"),
    ("SetCoil", "S_Coil"),
    ("ResetCoil", "R_Coil"),
    ("Latch", "S_Coil"),
    ("Unlatch", "R_Coil"),
    ("Assign", "Coil"),
    ("NOContact", "Contact"),
    ("NO_Contact", "Contact"),
    ("NCContact", "I_Contact"),
    ("ContactNO", "Contact"),
    ("ContactNC", "I_Contact"),
    ("NC_Contact", "I_Contact"),
    ("NegContact", "I_Contact"),
    ("NotContact", "I_Contact"),
    // N is an edge here, and a negation elsewhere.
    ("NContact", "I_Contact` for a negated contact, for a falling edge `N_Contact"),
    ("NCoil", "I_Coil` for a negated coil, for a falling edge `N_Coil"),
    ("NegCoil", "I_Coil"),
    ("NotCoil", "I_Coil"),
    ("Subtract", "Sub"),
];

impl Builder<'_, '_> {
    /// Adds the element of `node` to the graph; the flow goes through it.
    pub(super) fn element(&mut self, carried: &mut Carried, node: Node, attributes: Vec<Attribute>) {
        let inline = node.inline.as_deref().unwrap_or_default();
        let before = std::mem::replace(carried, Carried { flow: Flow::Lost, inverted: false });
        match self.meaning(node.target) {
            Meaning::Row { row, .. } if passes_through(row, &node) => *carried = before,
            Meaning::Row { row, negated, before: operand } => {
                self.check_language(row, node.target);
                let settings = self.settings(&attributes, inline);
                let eno = settings::eno(row, settings.eno, node.inline.is_some());
                let mut pins = Pins::of_row(row, negated);
                pins.is_led = !matches!(before.flow, Flow::Nothing);
                let mut instance = None;
                if let Some(span) = operand {
                    let value = self.operand(span);
                    match row.kind {
                        Kind::Instance(_) => instance = Some(value),
                        _ => pins.operand(span, value),
                    }
                }
                self.pins(&mut pins, node.arguments);
                self.flow_in(&mut pins, row.pin(row.flow.0).map(|(_, name)| name), before, node.target);
                let ended = row.flow.1.is_empty();
                let cases = self.cases(&settings, &pins);
                let element = self.add(Target::Element { row, instance }, settings, eno, pins, cases, node.target);
                carried.flow = if ended { Flow::Ended(node.target) } else { Flow::Element(element) };
            }
            Meaning::Block if let Some(own) = self.foreign(&node) => {
                let title = format!("`{}` is not an element of LAD or FBD", self.slice(node.target));
                let message = Diagnostic::new(Code::UnknownElement, node.target, title);
                self.report(message.label("not in the table of elements").help(format!("write `{own}`")));
                *carried = before;
            }
            Meaning::Block => {
                let settings = self.settings(&attributes, inline);
                let callee = self.operand(node.target);
                let mut pins = Pins::of_block();
                self.pins(&mut pins, node.arguments);
                self.flow_in(&mut pins, Some("en".to_string()), before, node.target);
                let eno = settings.eno.unwrap_or_default();
                let target = Target::Block { callee, instance: None };
                let element = self.add(target, settings, eno, pins, Vec::new(), node.target);
                carried.flow = Flow::Element(element);
            }
            Meaning::Unknown => {
                self.report_unknown(node.target);
                // The text after it is not the cause.
                *carried = before;
            }
        }
    }

    fn add(
        &mut self,
        target: Target,
        settings: Settings,
        eno: Eno,
        pins: Pins,
        cases: Vec<Comparison>,
        span: Span,
    ) -> usize {
        self.graph.elements.push(Element {
            target,
            templates: settings.templates,
            eno,
            pins: pins.finish(),
            equation: settings.equation,
            cases,
            span,
        });
        // The source of a net at a pin that is written `out => wire#w1`.
        self.feed_from_pins(self.graph.elements.len() - 1);
        self.graph.elements.len() - 1
    }

    /// `Contact`, `#t1.TON`, `"DB".ctu.CTU`; anything else is a call of a block of the program, or of the library.
    fn meaning(&self, target: Span) -> Meaning {
        let text = self.slice(target);
        if let Some((row, negated)) = elements::find_sd(text) {
            return Meaning::Row { row, negated, before: None };
        }
        if let Some((operand, name)) = text.rsplit_once('.')
            && let Some((row, negated)) = elements::find_sd(name.trim())
            && matches!(row.kind, Kind::Instance(_) | Kind::FlipFlop { .. } | Kind::S5Timer(_) | Kind::S5Counter(_))
        {
            let span = Span { end: target.start + operand.trim_end().len() as u32, ..target };
            return Meaning::Row { row, negated, before: Some(span) };
        }
        let library = || plcc_stdlib::find_tia(text).or_else(|| plcc_stdlib::find_name(text)).is_some();
        if text.starts_with(['"', '#', '%', '_']) || text.contains(['.', '[']) || library() {
            Meaning::Block
        } else {
            Meaning::Unknown
        }
    }

    /// `S_Coil` for `Set( "Motor" )`: an element of another editor with the name of a library block, whose pins would have names.
    fn foreign(&self, node: &Node) -> Option<&'static str> {
        let name = self.slice(node.target);
        let is_unnamed = |argument: &Argument| argument.pin == Given::Unnamed && argument.value.is_some();
        let (_, own) = FOREIGN.iter().find(|(other, _)| other.eq_ignore_ascii_case(name))?;
        (!node.arguments.is_empty() && node.arguments.iter().all(is_unnamed)).then_some(*own)
    }

    fn report_unknown(&mut self, target: Span) {
        let name = self.slice(target);
        if name.eq_ignore_ascii_case("LABEL") {
            let rest = self.text.text.get(target.end as usize..).unwrap_or_default();
            let inner = rest.trim_start().strip_prefix('(').and_then(|rest| rest.split_once(')'));
            let label = inner.map_or("…", |(label, _)| label.trim());
            let help = format!("write `Label( {label} )` on the line after `NETWORK`");
            self.report(
                Diagnostic::new(Code::ElementPlace, target, "a label stands before the rungs of its network")
                    .label("inside a rung")
                    .help(help),
            );
            return;
        }
        if let Some((why, help)) = absent::reason(name) {
            let title = match plcc_stdlib::catalogued(name) {
                Some((group, own)) => format!("`{own}` is an instruction of {} that plcc does not have", group.tool),
                None => format!("plcc does not have the element `{name}`"),
            };
            self.report(Diagnostic::new(Code::UnknownElement, target, title).label(why).help(help));
            return;
        }
        if let Some((group, written)) = plcc_stdlib::catalogued(name) {
            let title = format!("`{written}` is an instruction of {} that plcc does not have", group.tool);
            let help =
                format!("write a block `{written}` that does the same, and call it with quotes: `\"{written}\"( … )`");
            let label = format!("group: {}", group.name);
            self.report(Diagnostic::new(Code::UnknownElement, target, title).label(label).help(help));
            return;
        }
        let foreign = FOREIGN.iter().find(|(other, _)| other.eq_ignore_ascii_case(name));
        let help = match foreign.map(|(_, own)| *own).or_else(|| elements::nearest_sd(name)) {
            _ if let Some(own) = without_type(name, self.language) => {
                format!("write `{own}`: the operands say of which type it is")
            }
            Some(known) if foreign.is_some() => format!("write `{known}`"),
            Some(known) => {
                format!("did you mean `{known}`? FCs and instance DBs are called with quotes, `\"{name}\"( … )`")
            }
            None => format!(
                "FCs and instance DBs are called with quotes, `\"{name}\"( … )`; `docs/reference/lad-fbd.md` lists the elements"
            ),
        };
        let diagnostic =
            Diagnostic::new(Code::UnknownElement, target, format!("`{name}` is not an element of LAD or FBD"))
                .label("not in the table of elements")
                .help(help);
        self.report(diagnostic);
    }

    /// Contacts belong to LAD, gates to FBD.
    fn check_language(&mut self, row: &Row, target: Span) {
        let (language, help) = match (row.kind, self.language) {
            (Kind::Contact, Language::Fbd) => {
                ("LAD", "begin the rung with the operand, or write it at a pin of `A( in2 := … )`")
            }
            (Kind::Not, Language::Fbd) => ("LAD", "write `NOT` without parentheses between the elements"),
            (Kind::Gate(_), Language::Lad) => {
                ("FBD", "write elements in series for AND, and rungs that end in one wire for OR")
            }
            _ => return,
        };
        let name = self.slice(target);
        let diagnostic = Diagnostic::new(Code::ElementPlace, target, format!("`{name}` is an element of {language}"))
            .label("the network is in the other language")
            .help(help);
        self.report(diagnostic);
    }

    /// Connects the flow to the pin `name`, unless an argument has connected it.
    fn flow_in(&mut self, pins: &mut Pins, name: Option<String>, carried: Carried, target: Span) {
        let Some(name) = name else { return };
        let given = pins.given(&name);
        let rail = match carried.flow {
            Flow::Net(net) => self.graph.net(net).name.eq_ignore_ascii_case("powerrail"),
            _ => false,
        };
        if let Some(span) = given {
            if !rail && !matches!(carried.flow, Flow::Nothing | Flow::Lost) {
                self.report(
                    Diagnostic::new(Code::DuplicateParameter, span, format!("the pin `{name}` is connected twice"))
                        .label("a second time")
                        .also(target, "the rung leads to this pin")
                        .help("remove it here, or begin a separate rung for the element"),
                );
            }
            return;
        }
        if let Some((value, negated)) = self.taken(carried) {
            let pin = Pin { name, value, negated, output: false, storage: Storage::None, span: target };
            pins.first(pin);
        }
    }

    /// The comparisons of SWITCH, one for each branch: from its attributes, or from the form `GE #x => label`.
    fn cases(&mut self, settings: &Settings, pins: &Pins) -> Vec<Comparison> {
        let mut cases = settings.cases.clone();
        cases.extend(pins.cases());
        cases.sort_by_key(|(number, _)| *number);
        cases.dedup_by_key(|(number, _)| *number);
        cases.into_iter().map(|(_, comparison)| comparison).collect()
    }
}

/// `A()` without pins: the flow goes through unchanged.
fn passes_through(row: &Row, node: &Node) -> bool {
    matches!(row.kind, Kind::Gate(Gate::And))
        && node
            .arguments
            .iter()
            .all(|argument| argument.value.is_none() && argument.pin == crate::sd::tree::Pin::Unnamed)
}

/// `EQ_Contact` for `Eq_Int`, `Add` for `Add_Int`: names of elements in other tools end with the type.
fn without_type(name: &str, language: Language) -> Option<String> {
    let (stem, ty) = name.rsplit_once('_')?;
    Elementary::from_word(&ty.to_ascii_uppercase())?;
    let (row, _) = elements::find_sd(stem)?;
    Some(match row.kind {
        Kind::Compare(_) if language == Language::Lad => format!("{}_Contact", row.name),
        _ => stem.to_string(),
    })
}
