//! A network as it is drawn: parts with pins, and nets between them. All notations of networks become sheets; the
//! layouts of LAD and FBD know only these.

pub mod expression;
pub mod network;
pub mod rungs;
pub mod s7200;
mod s7200_boxes;
pub mod stl;

use crate::names::is_cell;

/// A network for drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// In the order of evaluation.
    pub parts: Vec<Part>,
    pub nets: Vec<Net>,
    /// The key of the bit that gives the rail its power, in a sequence step of an S7-200; empty: there is always power.
    pub rail: String,
}

/// A wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Net {
    /// Shown where no line leads to it.
    pub name: String,
    pub sources: Vec<Source>,
    /// Of wires that lead to where branches join: the net that they join. They have some of its sources.
    pub joins: Option<usize>,
}

/// What feeds a net.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    Rail,
    Pin { part: usize, pin: usize },
    Operand { label: Label, negated: bool },
    Net(usize),
}

/// An element.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    pub look: Look,
    pub meaning: Meaning,
    pub pins: Vec<Pin>,
    /// The pins that the flow enters and leaves: indices into `pins`.
    pub flow_in: Option<usize>,
    pub flow_out: Option<usize>,
    /// The first byte of its place in the source, if that is known.
    pub place: Option<u32>,
    /// The first byte of its statement, if the network is a statement list.
    pub statement: Option<u32>,
}

/// What an element looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum Look {
    /// `-| |-` with a sign in the middle.
    Contact { sign: String },
    /// `-( )-`.
    Coil { sign: String },
    /// A comparison: sign and type between the bars.
    Compare { sign: String, ty: String },
    /// A rectangle with its title, further lines below the title, and the instance above.
    Box { title: String, detail: String, instance: Option<Label> },
    /// Nothing: its effect is drawn elsewhere.
    Nothing,
}

/// What an element does with the flow, as far as drawings of a state need it.
#[derive(Clone, Debug, PartialEq)]
pub enum Meaning {
    /// The flow goes on if the operand is 1, or 0 if it is negated.
    Contact {
        negated: bool,
    },
    Not,
    And,
    Or,
    Xor,
    /// The flow goes on as it came.
    Through,
    /// Compares its first two inputs. `inverse`: the source has the opposite sign, after a NOT.
    Compare {
        sign: String,
        inverse: bool,
    },
    /// The flow that leaves is not computed here; it is the member `Q` of the instance, if there is one.
    Other,
}

/// A pin.
#[derive(Clone, Debug, PartialEq)]
pub struct Pin {
    /// In the form in which boxes show it.
    pub name: String,
    pub place: Place,
    pub output: bool,
    pub link: Link,
    pub negated: bool,
}

/// Where the operand of a pin is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// At the left or the right of a box.
    Side,
    Above,
    Below,
}

/// What is connected to a pin.
#[derive(Clone, Debug, PartialEq)]
pub enum Link {
    Net(usize),
    Operand(Label),
    Open,
}

/// An operand: its name and its address.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label {
    /// The symbol, or the address of an operand without one.
    pub text: String,
    /// The address, if `text` is a symbol.
    pub address: String,
    /// By which values and uses of it are found: the address, or the name of a local variable; empty for constants.
    pub key: String,
    /// Its value, if a state is shown.
    pub value: Option<String>,
    /// The first byte of its place in the source, if that is known.
    pub place: Option<u32>,
}

impl Label {
    /// Whether it is not a constant. Elements of arrays and parts of words have no key; their values are shown at their places.
    fn has_value(&self) -> bool {
        !self.key.is_empty() || self.place.is_some() && self.text.starts_with(['"', '#', '%'])
    }

    /// The label of an operand that is a word: of a timer or counter its current value, not its bit.
    fn into_word(self) -> Label {
        if is_cell(&self.key) { Label { key: format!("{}.VALUE", self.key), ..self } } else { self }
    }

    /// A text that is not an operand.
    pub fn plain(text: impl Into<String>) -> Label {
        Label { text: text.into(), ..Label::default() }
    }
}

impl Sheet {
    /// Adds another sheet, and a net for its rail; returns the number of its first net.
    pub fn append(&mut self, other: Sheet) -> usize {
        let (nets, parts) = (self.nets.len(), self.parts.len());
        for mut net in other.nets {
            net.joins = net.joins.map(|whole| whole + nets);
            for source in &mut net.sources {
                match source {
                    Source::Pin { part, .. } => *part += parts,
                    Source::Net(net) => *net += nets,
                    Source::Rail | Source::Operand { .. } => {}
                }
            }
            self.nets.push(net);
        }
        self.nets.push(Net { sources: vec![Source::Rail], ..Net::default() });
        for mut part in other.parts {
            for pin in &mut part.pins {
                if let Link::Net(net) = &mut pin.link {
                    *net += nets;
                }
            }
            self.parts.push(part);
        }
        nets
    }

    /// Shows values: `value` finds that of a key.
    pub fn show(&mut self, value: &dyn Fn(&str) -> Option<String>) {
        let operands = self.parts.iter_mut().flat_map(|part| &mut part.pins).filter_map(|pin| match &mut pin.link {
            Link::Operand(label) => Some(label),
            Link::Net(_) | Link::Open => None,
        });
        for label in operands.filter(|label| !label.key.is_empty()) {
            label.value = value(&label.key);
        }
    }
}

impl Sheet {
    /// Leaves room for values at the pins of boxes and comparisons.
    pub fn leave_room(&mut self) {
        for part in &mut self.parts {
            let ty = match &part.look {
                Look::Box { detail, .. } => detail,
                Look::Compare { ty, .. } => ty,
                Look::Contact { .. } | Look::Coil { .. } | Look::Nothing => continue,
            };
            let room = " ".repeat(characters(ty));
            for pin in &mut part.pins {
                if let Link::Operand(label) = &mut pin.link
                    && label.has_value()
                {
                    label.value = Some(room.clone());
                }
            }
        }
    }
}

/// How many characters most values of the data types in the detail of a box need; 0: none of the types has long values.
fn characters(types: &str) -> usize {
    let of = |ty: &str| match ty.to_ascii_uppercase().as_str() {
        "LREAL" | "LINT" | "ULINT" | "LWORD" | "LTIME" | "LTOD" | "LDT" | "DTL" => 20,
        "D" | "R" | "DINT" | "UDINT" | "DWORD" | "REAL" | "TIME" => 12,
        _ => 0,
    };
    types.split(|c: char| !c.is_ascii_alphanumeric()).map(of).max().unwrap_or(0)
}

impl Part {
    /// The net at a pin.
    pub fn net(&self, pin: Option<usize>) -> Option<usize> {
        match self.pins.get(pin?)?.link {
            Link::Net(net) => Some(net),
            Link::Operand(_) | Link::Open => None,
        }
    }

    /// Pins beside a box, except those of the flow.
    pub fn side(&self, output: bool) -> impl Iterator<Item = usize> {
        let flow = [self.flow_in, self.flow_out];
        let wanted =
            move |at: &usize, pin: &Pin| pin.place == Place::Side && pin.output == output && !flow.contains(&Some(*at));
        self.pins.iter().enumerate().filter(move |(at, pin)| wanted(at, pin)).map(|(at, _)| at)
    }
}
