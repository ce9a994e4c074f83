//! What calls of all languages check and note: instances, names of parameters, pointers that instances keep.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::BlockPrefix;
use rustc_hash::FxHashMap;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::typed::BoundInterface;
use plcc_binding::fold;
use plcc_binding::similar;
use plcc_model::{BlockKey, Direction, Passing};

/// Instance memory, identified across the whole program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InstanceId {
    Db(u16),
    /// In the instances of a block, at a byte.
    Multi(BlockKey, u32),
    /// In a data block, at a byte.
    Inner(u16, u32),
}

/// Calls of an instance and one of its pointer parameters.
pub struct PointerUse {
    supplied: bool,
    /// The first call.
    span: Span,
    block: BlockKey,
    parameter: String,
    /// Where the pointer or number is in the instance.
    byte: u32,
    bytes: u32,
}

/// Pointer parameters of instances: whether some call supplies them, and a call that does not.
#[derive(Default)]
pub struct InstancePointers(FxHashMap<(InstanceId, usize), PointerUse>);

impl InstancePointers {
    /// Notes which pointer parameters the call of an instance supplies.
    pub fn note(&mut self, id: InstanceId, key: BlockKey, bound: &BoundInterface, supplied: &[usize], span: Span) {
        for (index, parameter) in bound.interface.parameters.iter().enumerate() {
            let points = match parameter.passing {
                Passing::Number | Passing::Pointer | Passing::Any | Passing::Variant => true,
                Passing::Complex { .. } => parameter.direction == Direction::InOut,
                Passing::Elementary(_) | Passing::OpenArray { .. } => false,
            };
            if !points {
                continue;
            }
            let supplied = supplied.contains(&index);
            let entry = self.0.entry((id, index)).or_insert_with(|| PointerUse {
                supplied,
                span,
                block: key,
                parameter: parameter.name.clone(),
                byte: parameter.byte,
                bytes: match parameter.passing {
                    Passing::Number => 2,
                    Passing::Any => 10,
                    _ => 6,
                },
            });
            entry.supplied |= supplied;
        }
    }
}

/// Inputs and outputs of timers, counters and edges in other systems, and what they are called here.
const PARAMETER_WORDS: [(&str, &str); 17] = [
    ("RESET", "R"),
    ("LOAD", "LD"),
    ("PRESET", "PV"),
    ("PRESET", "PT"),
    ("PV", "PT"),
    ("TIME", "PT"),
    ("TV", "PT"),
    ("START", "IN"),
    ("ENABLE", "IN"),
    ("CLOCK", "CLK"),
    ("IN", "CLK"),
    ("OUT", "Q"),
    ("DONE", "Q"),
    ("ELAPSED", "ET"),
    ("COUNT", "CV"),
    ("UP", "CU"),
    ("DOWN", "CD"),
];

impl Declarations<'_> {
    /// Checks that a data block is an instance of a function block.
    pub fn check_instance_db(&mut self, key: BlockKey, number: u16, span: Span) -> Option<()> {
        let Some(db) = self.data.blocks.get(&number) else {
            // The DB has its own error.
            return None;
        };
        if db.block.instance_of != Some(key) {
            let (other, defined) = (db.block.instance_of, db.block.span);
            let (other, key) = (other.map(|other| self.globals.shown(other)), self.globals.shown(key));
            let what = match other {
                Some(other) => format!("DB {number} is an instance of {other}"),
                None => format!("DB {number} is a shared data block"),
            };
            self.report(
                Diagnostic::new(Code::NoBlockFits, span, format!("DB {number} is not an instance of {key}"))
                    .label(what)
                    .also(defined, "the data block")
                    .help(format!("name a data block of {key}; if it is not defined, plcc creates it for the call")),
            );
            return None;
        }
        Some(())
    }

    /// Reports a parameter that the block does not have; returns the one that may be meant.
    pub fn unknown_parameter(
        &mut self,
        key: BlockKey,
        bound: &BoundInterface,
        (name, span): (&str, Span),
        supplied: &[&str],
    ) -> Option<String> {
        let is_own = |name: &&str| !self.globals.is_shared_input(key, name);
        let names = || bound.interface.parameters.iter().map(|parameter| parameter.name.as_str()).filter(is_own);
        let message = Diagnostic::new(
            Code::UnknownParameter,
            span,
            format!("{} has no parameter `{name}`", self.globals.shown(key)),
        )
        .label("no such parameter");
        let is_static = bound.locals.contains_key(&fold(name)) && is_own(&name);
        // Those that the call supplies are not meant.
        let is_free = |name: &&str| !supplied.iter().any(|other| other.eq_ignore_ascii_case(name));
        let is_word = |own: &&str| {
            let known = |(word, wanted): &(&str, &str)| word.eq_ignore_ascii_case(name) && wanted == own;
            PARAMETER_WORDS.iter().any(known) && self.globals.in_library(key)
        };
        let meant = similar(name, names().filter(is_free)).or_else(|| names().filter(is_free).find(is_word));
        let meant = meant.filter(|_| !is_static);
        self.report(match meant {
            _ if is_static => message.help("it is static or temporary data of the block, which a call cannot supply"),
            Some(other) => message.help(format!("is `{other}` meant?")),
            None => {
                let result = |name: &&str| !name.eq_ignore_ascii_case("RET_VAL");
                let all: Vec<&str> = names().filter(result).take(12).collect();
                let help = match all.is_empty() {
                    _ if self.is_own_value(key, bound, name) => format!(
                        "the value of the function is `RET_VAL`; in SCL the call itself has it: `… := \"{name}\"(…);`"
                    ),
                    true => "the block has no parameters".to_string(),
                    false => format!("its parameters are {}{}", all.join(", "), self.of_both_directions(key, name)),
                };
                message.help(self.globals.with_library_note(key, help))
            }
        });
        meant.map(str::to_owned)
    }

    /// Whether a call supplies the value of a function under the name of the function.
    fn is_own_value(&self, key: BlockKey, bound: &BoundInterface, name: &str) -> bool {
        key.kind == BlockKind::Fc
            && bound.interface.parameters.iter().any(|parameter| parameter.name == "RET_VAL")
            && fold(&self.globals.names.block_name(BlockPrefix::Fc, key.number)) == fold(name)
    }

    /// A note that the counter CTUD has the parameter, which one of a single direction does not have.
    fn of_both_directions(&self, key: BlockKey, name: &str) -> String {
        let shown = self.globals.shown(key);
        let other: &[&str] = match shown.trim_start_matches('`').get(..4) {
            Some("CTU_" | "CTU`") => &["CD", "LD"],
            Some("CTD_" | "CTD`") => &["CU", "R"],
            _ => return String::new(),
        };
        let is_other = self.globals.in_library(key) && other.iter().any(|pin| pin.eq_ignore_ascii_case(name));
        if is_other { format!("; `CTUD` has `{name}`") } else { String::new() }
    }

    /// Whether the data block gives the parameter a start value.
    fn has_start_value(&self, id: InstanceId, pointer: &PointerUse) -> bool {
        let (number, start) = match id {
            InstanceId::Db(number) => (number, 0),
            InstanceId::Inner(number, start) => (number, start),
            InstanceId::Multi(..) => return false,
        };
        let first = start + pointer.byte;
        let range = first as usize..(first + pointer.bytes) as usize;
        let data = self.data.blocks.get(&number).and_then(|db| db.block.data.get(range));
        // `P#P 0.0 VOID 0`, as STEP 7 writes it, points nowhere.
        data.is_some_and(|bytes| {
            !matches!(bytes, [0x10, 0, ..] | [0, 0, 0x80, 0, 0, 0]) && bytes.iter().any(|byte| *byte != 0)
        })
    }

    /// Warns of pointer parameters that no call of an instance supplies.
    pub fn check_pointers(&mut self) {
        let mut uses: Vec<PointerUse> = std::mem::take(&mut self.pointers.0)
            .into_iter()
            .filter(|((id, _), pointer)| !pointer.supplied && !self.has_start_value(*id, pointer))
            // Those of the library know pointers that point nowhere: GET has four areas, of which most calls use one.
            .filter(|(_, pointer)| self.globals.library_block(pointer.block).is_none())
            .map(|(_, pointer)| pointer)
            .collect();
        uses.sort_by_key(|pointer| (pointer.span.file, pointer.span.start, pointer.byte));
        for PointerUse { span, block, parameter, .. } in uses {
            self.report(
                Diagnostic::new(
                    Code::MissingPointer,
                    span,
                    format!("no call supplies `{parameter}` of {block} for this instance"),
                )
                .label("the parameter points nowhere")
                .help(format!("add `{parameter} := ...` to a call that is executed first")),
            );
        }
    }
}
