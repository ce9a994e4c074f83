//! Messages for components that a variable does not have.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::article::with_article;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::predefined::AXIS;
use plcc_binding::similar;
use plcc_model::layout;
use plcc_model::types::{DataType, StructType};

impl Declarations<'_> {
    /// Reports a component that a structure does not have.
    pub fn unknown_member(&mut self, structure: &StructType, name: &str, span: Span) {
        let title = match structure.name.as_str() {
            "" => format!("the structure has no component `{name}`"),
            // Whatever kind of axis it is declared as.
            AXIS => format!("an axis has no component `{name}`"),
            of => format!("`{of}` has no component `{name}`"),
        };
        let message = Diagnostic::new(Code::UnknownMember, span, title).label("no such component");
        let names = structure.members.iter().map(|member| member.name.as_str());
        let has = |other: &&str| structure.members.iter().any(|member| member.name.eq_ignore_ascii_case(other));
        let habit =
            TIMER_WORDS.iter().filter(|(own, _)| own.eq_ignore_ascii_case(name)).map(|(_, other)| *other).find(has);
        let address = word_of_step5(name).filter(|_| !structure.members.is_empty());
        let address = address.or_else(|| bit_of_block(name)).or_else(|| without_number(name));
        self.report(match (address, habit.or_else(|| similar(name, names))) {
            (Some(help), _) => message.help(help),
            (None, Some(other)) => message.help(format!("is `{other}` meant?")),
            (None, None) => {
                const NAMES_MAX: usize = 12;
                let names = || structure.members.iter().map(|member| member.name.as_str());
                // Of a step of GRAPH the members that programs read.
                let of_step = ["X", "T", "U"];
                let first = if of_step.iter().all(has) { of_step.as_slice() } else { &[] };
                let others = names().filter(|name| !first.contains(name));
                let mut all: Vec<&str> = Vec::new();
                for name in first.iter().copied().chain(others) {
                    // A name that is declared twice has its message.
                    if all.len() < NAMES_MAX && !all.iter().any(|known| known.eq_ignore_ascii_case(name)) {
                        all.push(name);
                    }
                }
                let more = if structure.members.len() > NAMES_MAX { " and more" } else { "" };
                match all.is_empty() {
                    true => message.help("it has no components"),
                    false => message.help(format!("its components are {}{more}", all.join(", "))),
                }
            }
        });
    }
}

/// What is missing after `DB10.DBW`.
fn without_number(name: &str) -> Option<String> {
    let upper = name.to_ascii_uppercase();
    match upper.as_str() {
        "DBX" => Some("write the numbers of its byte and its bit: `DBX0.0`".to_owned()),
        "DBB" | "DBW" | "DBD" => Some(format!("write the number of its first byte: `{upper}0`")),
        _ => None,
    }
}

/// What `DW 2` may mean: STEP 5 counts the words of a data block.
fn word_of_step5(name: &str) -> Option<String> {
    let letters = name.get(..2).map(str::to_ascii_uppercase)?;
    let width = letters.strip_prefix('D').filter(|width| matches!(*width, "W" | "D"))?;
    let number: u32 = name[2..].trim_start().parse().ok()?;
    let address = format!("DB{width}{number}");
    Some(match number.checked_mul(2).filter(|byte| *byte > 0) {
        Some(byte) => {
            format!("write `{address}` for byte {number}, `DB{width}{byte}` if words are counted as in STEP 5")
        }
        None => format!("write `{address}`"),
    })
}

/// What `DBX 2` may mean: an address in the block.
fn bit_of_block(name: &str) -> Option<String> {
    let after = |letters: &str| {
        let head = name.get(..letters.len()).filter(|head| head.eq_ignore_ascii_case(letters));
        head.map(|_| name[letters.len()..].trim_start())
    };
    let byte: u32 = after("DBX").or_else(|| after("DX"))?.parse().ok()?;
    Some(format!("if you mean the address: a bit is `DBX{byte}.0` to `DBX{byte}.7`, the byte `DBB{byte}`"))
}

/// Components of timers and counters in other controllers, and what they are called here.
const TIMER_WORDS: [(&str, &str); 8] = [
    ("DN", "Q"),
    ("DONE", "Q"),
    ("ACC", "ET"),
    ("ACC", "CV"),
    ("PRE", "PT"),
    ("PRE", "PV"),
    ("RES", "R"),
    ("RESET", "R"),
];

/// The message for a component of something that has none; of an array, its elements may have it. `before`: what is written before the
/// point, if it is known.
pub(crate) fn no_component(name: &str, ty: &DataType, before: &str, span: Span) -> Diagnostic {
    let told = Diagnostic::new(Code::UnknownMember, span, format!("there is no component `{name}` here"))
        .label(format!("the name before it is of type {}", layout::type_name(ty)));
    match ty {
        DataType::Array(array) if matches!(array.element, DataType::Struct(_)) => {
            let first: Vec<String> = array.bounds.iter().map(|(low, _)| low.to_string()).collect();
            told.help(format!("name one element, as in `{before}[{}].{name}`", first.join(", ")))
        }
        // `list.#i`
        DataType::Array(array) if array.bounds.len() == 1 && name.len() <= 2 => {
            let sign =
                if before.starts_with('#') && !name.starts_with(|c: char| c.is_ascii_digit()) { "#" } else { "" };
            told.help(format!("the index of an array is written in brackets: `{before}[{sign}{name}]`"))
        }
        DataType::Elementary(ty)
            if name
                .strip_prefix(['X', 'x', 'B', 'b', 'W', 'w'])
                .is_some_and(|number| number.parse::<u32>().is_ok_and(|number| number < ty.bits())) =>
        {
            told.help(format!("a part of a variable has `%` before it: write `.%{}`", name.to_ascii_uppercase()))
        }
        DataType::String(_) | DataType::WideString(_) if is_length(name) => {
            told.help("the number of characters is `LEN(…)`, with the name of the text in the brackets")
        }
        DataType::Array(_) if is_length(name) => told
            .help("the number of elements is `UPPER_BOUND(ARR := …, DIM := 1) - LOWER_BOUND(ARR := …, DIM := 1) + 1`"),
        DataType::Elementary(ty) => {
            told.help(format!("remove `.{name}`: {} is a single value", with_article(ty.name())))
        }
        _ => told,
    }
}

/// What other languages call the length of a text or an array.
fn is_length(name: &str) -> bool {
    ["length", "len", "size", "count"].iter().any(|known| known.eq_ignore_ascii_case(name))
}
