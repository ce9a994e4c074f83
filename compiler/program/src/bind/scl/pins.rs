//! Arguments of functions of the language, assigned to the pins of their row.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::scl::ast::{Argument as Given, Expr as Node};

use super::arguments::names_eno;
use super::function::{Kind, Row};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::fold;
use plcc_binding::similar;

/// A pin of a row.
#[derive(Clone, Copy)]
pub(super) struct Pin {
    /// Its spellings, with `|` between them.
    pub(super) names: &'static str,
    pub(super) optional: bool,
    pub(super) output: bool,
    /// The first of numbered ones.
    pub(super) numbered: bool,
}

impl Pin {
    /// The pins of a function, in order.
    pub(super) fn list(row: &Row) -> Vec<Pin> {
        row.pins.split_whitespace().map(Pin::read).collect()
    }

    fn read(word: &'static str) -> Pin {
        let (optional, word) = word.strip_prefix('?').map_or((false, word), |rest| (true, rest));
        let (output, word) = word.strip_prefix('>').map_or((false, word), |rest| (true, rest));
        let (numbered, names) = word.strip_suffix('+').map_or((false, word), |rest| (true, rest));
        Pin { names, optional, output, numbered }
    }

    /// The name that messages use.
    fn name(self) -> &'static str {
        self.names.split('|').next().unwrap_or(self.names)
    }

    /// Its name in a list; of numbered pins the first two.
    fn shown(self) -> String {
        match self.numbered {
            true => format!("{}, {} …", self.name(), self.numbered_name(1)),
            false => self.name().to_string(),
        }
    }

    /// The name of the one at a position among numbered pins, from 0.
    fn numbered_name(self, position: usize) -> String {
        let stem = self.name().trim_end_matches(|letter: char| letter.is_ascii_digit());
        match self.name()[stem.len()..].parse::<usize>() {
            Ok(first) if self.numbered => format!("{stem}{}", first + position),
            _ => self.name().to_string(),
        }
    }

    /// Position among numbered pins, 0 for others; `None`: another pin.
    fn matches(self, name: &str) -> Option<usize> {
        if !self.numbered {
            return self.names.split('|').any(|own| own.eq_ignore_ascii_case(name)).then_some(0);
        }
        let letters = self.names.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let first: usize = self.names[letters.len()..].parse().ok()?;
        let (head, digits) = name.split_at_checked(letters.len())?;
        if !head.eq_ignore_ascii_case(letters) {
            return None;
        }
        digits.parse::<usize>().ok()?.checked_sub(first)
    }
}

/// Whether the function has a pin of that name.
pub fn has_pin(row: &Row, name: &str) -> bool {
    Pin::list(row).into_iter().any(|pin| pin.matches(name).is_some())
}

/// The input that the argument at `at`, which has no name, may be meant for: those without an argument belong to the arguments without a
/// name, in their order.
fn open_pin(list: &[Pin], given: &[Given], at: usize) -> Option<String> {
    let before = given[..at].iter().filter(|argument| argument.name.is_none()).count();
    let mut open = list.iter().filter(|pin| !pin.output).flat_map(|pin| {
        let count = if pin.numbered { given.len() } else { 1 };
        let is_named = move |position: usize| {
            given.iter().filter_map(|other| other.name.as_ref()).any(|name| pin.matches(&name.text) == Some(position))
        };
        (0..count).filter(move |position| !is_named(*position)).map(move |position| pin.numbered_name(position))
    });
    open.nth(before)
}

/// Arguments of a function, each at its pin.
pub struct Pins<'n> {
    /// Name of the pin, position among numbered ones, argument.
    given: Vec<(&'static str, usize, &'n Node)>,
    /// The position of the call's name.
    pub name: Span,
    /// The variable of `ENO => x`, of functions that are calls of a block.
    pub eno: Option<&'n Node>,
}

impl<'n> Pins<'n> {
    /// The argument of a pin that is not numbered.
    pub fn get(&self, pin: &str) -> Option<&'n Node> {
        self.given.iter().find(|(name, ..)| *name == pin).map(|(.., node)| *node)
    }

    /// The name of a numbered pin without an argument, below one that has an argument.
    fn gap(&self, pin: Pin) -> Option<String> {
        let numbers =
            || self.given.iter().filter(|(name, ..)| pin.numbered && *name == pin.name()).map(|(_, at, _)| *at);
        let count = numbers().count();
        let missing = (0..count).find(|wanted| numbers().all(|at| at != *wanted))?;
        Some(pin.numbered_name(missing))
    }

    /// The arguments of numbered pins, in order of their numbers.
    pub fn numbered(&self, first: &str) -> Vec<&'n Node> {
        let mut list: Vec<(usize, &Node)> =
            self.given.iter().filter(|(name, ..)| *name == first).map(|(_, at, node)| (*at, *node)).collect();
        list.sort_by_key(|(at, _)| *at);
        list.into_iter().map(|(_, node)| node).collect()
    }
}

impl SclBinder<'_, '_> {
    /// Assigns the arguments of a function to its pins; `None` after a message.
    pub fn pins<'n>(&mut self, ctx: &mut SclBlock, row: &Row, given: &'n [Given], name: Span) -> Option<Pins<'n>> {
        let list = Pin::list(row);
        let mut pins = Pins { given: Vec::with_capacity(given.len()), name, eno: None };
        let mut good = true;
        for (at, argument) in given.iter().enumerate() {
            let is_eno = argument.name.as_ref().is_some_and(|name| fold(&name.text) == "eno");
            if matches!(row.kind, Kind::Concat | Kind::TextNumber(_)) && is_eno {
                pins.eno = argument.value.as_ref().filter(|value| !names_eno(ctx, value));
                continue;
            }
            let Some((pin, number)) = self.pin(ctx, (row, name), &list, given, at, &mut good) else { continue };
            let span = argument.name.as_ref().map_or(argument.span, |name| name.span);
            if pins.given.iter().any(|(name, other, _)| *name == pin.name() && *other == number) {
                good = false;
                self.program.report(
                    Diagnostic::new(Code::DuplicateParameter, span, format!("`{}` is given twice", pin.name()))
                        .label("the second time")
                        .help("remove one of them, or correct its name"),
                );
                continue;
            }
            if argument.output && !pin.output {
                good = false;
                self.program.report(
                    Diagnostic::new(Code::AssignSign, argument.span, format!("`{}` is an input", pin.name()))
                        .label("`=>` is for outputs of the function")
                        .help(format!("write `{} := ...`", pin.name())),
                );
            }
            if let Some(value) = &argument.value {
                pins.given.push((pin.name(), number, value));
            }
        }
        let missing: Vec<&str> = list
            .iter()
            .filter(|pin| !pin.optional && !pins.given.iter().any(|(name, ..)| *name == pin.name()))
            .map(|pin| pin.name())
            .collect();
        if good && !missing.is_empty() {
            good = false;
            let help = self.with_all_pins(name, &list, &pins, given);
            self.program.report(
                Diagnostic::new(
                    Code::MissingParameter,
                    name,
                    format!("the call of {} omits {}", row.name, missing.join(", ")),
                )
                .label("the function needs it")
                .help(help),
            );
        }
        if good && let Some(omitted) = list.iter().find_map(|pin| pins.gap(*pin)) {
            good = false;
            let title = format!("the call of {} omits {omitted}", self.program.globals.text(name));
            self.program.report(
                Diagnostic::new(Code::MissingParameter, name, title)
                    .label("its inputs are numbered without a gap")
                    .help(format!("add `{omitted} := …`, or correct the numbers of the others")),
            );
        }
        if !good {
            self.note_arguments(ctx, given);
        }
        good.then_some(pins)
    }

    /// What to add for the pins of `list` that have no argument: in a call without names, the call with all of its names.
    fn with_all_pins(&self, name: Span, list: &[Pin], pins: &Pins, given: &[Given]) -> String {
        let is_missing = |pin: &&Pin| !pin.optional && !pins.given.iter().any(|(own, ..)| *own == pin.name());
        let missing = list.iter().filter(is_missing);
        let missing = missing.map(|pin| format!("{} {} …", pin.name(), if pin.output { "=>" } else { ":=" }));
        if given.is_empty() || given.iter().any(|argument| argument.name.is_some()) {
            return format!("add `{}`", missing.collect::<Vec<_>>().join(", "));
        }
        let text = |span| self.program.globals.text(span);
        let given = pins.given.iter().filter_map(|(own, position, node)| {
            let pin = list.iter().find(|pin| pin.name() == *own)?;
            let sign = if pin.output { "=>" } else { ":=" };
            Some(format!("{} {sign} {}", pin.numbered_name(*position), text(node.span)))
        });
        format!("write `{}({})`", text(name), given.chain(missing).collect::<Vec<_>>().join(", "))
    }

    /// The pin of one argument, with its position among numbered ones.
    fn pin(
        &mut self,
        ctx: &SclBlock,
        (row, called): (&Row, Span),
        list: &[Pin],
        given: &[Given],
        at: usize,
        good: &mut bool,
    ) -> Option<(Pin, usize)> {
        let argument = &given[at];
        let names = || given.iter().filter_map(|other| other.name.as_ref());
        let Some(name) = &argument.name else {
            if names().any(|name| !matches!(fold(&name.text).as_str(), "en" | "eno")) {
                *good = false;
                self.mixed_arguments(argument.span, open_pin(list, given, at).as_deref());
                return None;
            }
            // The other arguments belong to numbered pins.
            let first = list.iter().position(|pin| pin.numbered);
            let found = match first {
                Some(first) if at >= first => Some((list[first], at - first)),
                _ => list.get(at).map(|pin| (*pin, 0)),
            };
            if found.is_none() {
                *good = false;
                self.program.report(
                    Diagnostic::new(
                        Code::SurplusOperand,
                        argument.span,
                        match list.iter().filter(|pin| !pin.optional).count() {
                            0 => format!("{} has no arguments", row.name),
                            1 => format!("{} has 1 argument", row.name),
                            count => format!("{} has {count} arguments", row.name),
                        },
                    )
                    .label("one more")
                    .help(format!("remove `{}`", self.program.globals.text(argument.span))),
                );
            }
            return found;
        };
        let found = list.iter().find_map(|pin| Some((*pin, pin.matches(&name.text)?)));
        if found.is_some() {
            return found;
        }
        let eno = fold(&name.text) == "eno";
        if eno && argument.value.as_ref().is_none_or(|value| names_eno(ctx, value)) {
            return None;
        }
        *good = false;
        let message = Diagnostic::new(
            Code::UnknownParameter,
            name.span,
            format!("{} has no parameter `{}`", self.program.globals.text(called).to_ascii_uppercase(), name.text),
        )
        .label("no such parameter");
        // Those that the call supplies are not meant.
        let supplied = |pin: &Pin| {
            given.iter().filter_map(|other| other.name.as_ref()).any(|other| pin.matches(&other.text).is_some())
        };
        let names = list.iter().filter(|pin| !supplied(pin)).map(|pin| pin.name());
        let all: Vec<String> = list.iter().map(|pin| pin.shown()).collect();
        self.program.report(match similar(&name.text, names) {
            _ if eno => message.help("read `ENO` in the statement after it"),
            Some(other) => message.help(format!("is `{other}` meant?")),
            None => message.help(format!("its parameters are {}", all.join(", "))),
        });
        None
    }

    /// A function without a value inside an expression.
    pub fn no_value(&mut self, span: Span) {
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::TypeMismatch, span, format!("`{text}` has no value"))
                .label("this function has no result that an expression could use")
                .help("call it in a separate statement"),
        );
    }
}
