//! The elements of LAD and FBD: one row each, for all file formats.
//!
//! `table` has the rows, `kind` what their elements do, `pins` what the words for pins mean; `names` finds the row of a name.

mod kind;
mod names;
mod pins;
mod table;

pub use kind::{CounterCoil, Flag, Gate, Kind, Mcr, ReturnValue, VariantQuestion};
pub use names::{find_open, find_sd, find_xml, nearest_sd};
pub use pins::{PinDirection, PinRow};
pub use table::CHAPTERS;

/// A group of elements.
#[derive(Debug)]
pub struct Chapter {
    pub title: &'static str,
    /// Chapters of the LAD/FBD reference that say what the elements do.
    pub source: &'static str,
    pub rows: &'static [Row],
}

/// An element.
#[derive(Debug, PartialEq)]
pub struct Row {
    /// Its name in messages, and its first name in SIMATIC SD.
    pub name: &'static str,
    /// Other names in SIMATIC SD.
    pub sd: &'static [&'static str],
    /// Names in SimaticML.
    pub xml: &'static [&'static str],
    /// Names in PLCopen XML.
    pub open: &'static [&'static str],
    /// A word for each pin; `table` says what they mean.
    pub pins: &'static str,
    /// Pins that the flow enters and leaves; empty: none.
    pub flow: (&'static str, &'static str),
    pub kind: Kind,
    pub typing: Typing,
    /// Errors that ENO reports; `None`: those of all elements of the kind.
    pub eno: Option<EnoRule>,
}

/// How the inputs and the result of a function get their types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Typing {
    /// No input is converted to the type of the element.
    pub own_types: bool,
    /// Inputs that are not converted to it, while the others are.
    pub own_pins: &'static [&'static str],
    /// Inputs that have the type of the output.
    pub output_pins: &'static [&'static str],
    /// With constants at all inputs, and no type set, the output decides.
    pub follows_output: bool,
    /// The function is called with the type of its output: `NORM_X_REAL`.
    pub named_by_output: bool,
}

impl Default for Typing {
    fn default() -> Typing {
        Typing::NONE
    }
}

impl Typing {
    /// All inputs are converted.
    const NONE: Typing =
        Typing { own_types: false, own_pins: &[], output_pins: &[], follows_output: false, named_by_output: false };

    /// True of an input that is converted to the type of the element.
    pub fn converts(&self, pin: &str) -> bool {
        !self.own_types && !self.own_pins.contains(&pin)
    }
}

/// When ENO is 0 though EN is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnoRule {
    Never,
    /// The result is too large for its type.
    Overflow,
    /// Division by 0, and as for [`EnoRule::Overflow`].
    Division,
    /// The result is infinite or not a number.
    Infinite,
}

/// All elements.
pub fn elements() -> impl Iterator<Item = &'static Row> {
    CHAPTERS.iter().flat_map(|chapter| chapter.rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_in_every_carrier() {
        let contact = find_sd("i_contact").map(|(row, negated)| (row.name, negated));
        assert_eq!(contact, Some(("Contact", true)));
        assert_eq!(find_sd("gt").map(|(row, _)| row.name), Some("GT"));
        assert_eq!(find_xml("PBox").map(|row| row.name), Some("P_Trig"));
        // IEC SR is set-dominant, which Siemens calls RS.
        assert_eq!(find_open("SR").map(|row| row.name), Some("S_RS"));
    }

    #[test]
    fn numbered_pins_have_canonical_names() {
        let add = find_xml("Add").expect("a row");
        assert_eq!(add.pin("IN12").map(|(_, name)| name), Some("in12".to_string()));
        assert_eq!(add.pin("in0"), None);
        assert_eq!(add.pin("out").map(|(pin, _)| pin.direction), Some(PinDirection::Output));
        let moved = find_xml("Move").expect("a row");
        assert_eq!(moved.pin("OUT").map(|(_, name)| name), Some("out1".to_string()));
    }

    #[test]
    fn every_flow_pin_is_a_pin() {
        for row in elements() {
            for flow in [row.flow.0, row.flow.1] {
                assert!(flow.is_empty() || row.pin(flow).is_some(), "{}: {flow}", row.name);
            }
        }
    }

    #[test]
    fn no_name_means_two_elements() {
        for (at, row) in elements().enumerate() {
            for other in elements().skip(at + 1) {
                let clash = |a: &[&str], b: &[&str]| a.iter().any(|a| b.iter().any(|b| a.eq_ignore_ascii_case(b)));
                assert!(!clash(row.xml, other.xml), "{} and {} in SimaticML", row.name, other.name);
                assert!(!clash(row.open, other.open), "{} and {} in PLCopen", row.name, other.name);
                let names = |row: &Row| [&[row.name], row.sd].concat();
                assert!(!clash(&names(row), &names(other)), "{} and {} in SD", row.name, other.name);
            }
        }
    }
}
