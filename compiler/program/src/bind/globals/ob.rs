//! What starts each organization block.
//!
//! Source: LAD/FBD reference for S7-1200, organization blocks.

use plcc_abi::image::BlockKind;
use plcc_abi::ob::{CYCLIC_PERIOD_MS, OB_CLASSES, OB_FREE, ObClass};
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::article::with_article;
use plcc_syntax::ast;
use plcc_syntax::symbols::has_own_name;

use crate::bind::globals::Globals;
use crate::bind::globals::sources::CodeSource;
use crate::bind::trees::blocks::class_attribute;

/// OBs of WinAC with ODK, of CPUs for technology and of S7-400H, which have no class here.
const RARE: [u16; 5] = [52, 53, 54, 65, 73];

/// The message about an attribute whose value is not a class.
pub fn unknown_class(text: &str, span: Span) -> Diagnostic {
    let names: Vec<&str> = OB_CLASSES.iter().map(|row| row.names[0]).collect();
    Diagnostic::new(Code::BlockFrame, span, format!("`{text}` is not a class of organization blocks")).help(
        match plcc_binding::similar(text, names.iter().copied()) {
            Some(meant) => format!("is `{meant}` meant?"),
            None => format!("one of {}", names.join(", ")),
        },
    )
}

impl Globals<'_> {
    /// The classes of the program's OBs: from plc.toml, otherwise from their attributes.
    pub fn ob_classes(&mut self) {
        let mut obs: Vec<(u16, &ast::CodeBlock)> = self
            .sources
            .code
            .iter()
            .filter(|(key, _)| key.kind == BlockKind::Ob)
            .filter_map(|(key, source)| match source {
                CodeSource::User(block) => Some((key.number, *block)),
                CodeSource::Expanded(_) | CodeSource::System(_) => None,
            })
            .collect();
        obs.sort_unstable_by_key(|(number, _)| *number);
        for (number, block) in obs {
            self.cyclic_period(number, block);
            if self.config.ob_classes.iter().any(|(ob, _)| *ob == number) {
                continue;
            }
            let Some((class, text)) = class_attribute(&block.header) else {
                let class = ObClass::of_number(number).filter(|class| !class.is_started());
                if let Some(class) = class
                    && self.input.profile.family.is_portal()
                {
                    self.not_started(number, class, block.name.span());
                }
                if number < OB_FREE && ObClass::of_number(number).is_none() && !RARE.contains(&number) {
                    self.unknown_number(number, block.name.span());
                }
                continue;
            };
            match class {
                None => {
                    // The number of an OB below 123 says what starts it.
                    let own = ObClass::of_number(number).map(|own| with_article(own.row().word));
                    let mut message = unknown_class(text, block.name.span()).label(match &own {
                        Some(own) => format!("by its number OB {number} is {own} OB"),
                        None => format!("it is not known what starts OB {number}"),
                    });
                    if own.is_some() {
                        message.severity = Severity::Warning;
                    }
                    self.report.push(message);
                }
                Some(class) if !class.is_started() => {
                    self.not_started(number, class, block.name.span());
                    self.config.ob_classes.push((number, class));
                }
                Some(class) if number >= OB_FREE && class.row().free => self.config.ob_classes.push((number, class)),
                Some(class) if ObClass::of_number(number) == Some(class) => {}
                Some(class) => self.wrong_class(number, class, block.name.span()),
            }
        }
    }

    /// The period of a cyclic interrupt of the TIA Portal, whose blocks have names, unless plc.toml sets it.
    fn cyclic_period(&mut self, number: u16, block: &ast::CodeBlock) {
        let is_portal = self.input.profile.family.is_portal() && has_own_name(&block.name);
        let is_set = self.config.cyclic_period_ms.iter().any(|(ob, _)| *ob == number);
        if is_portal && !is_set && ObClass::of_number(number) == Some(ObClass::Cyclic) {
            self.config.cyclic_period_ms.push((number, CYCLIC_PERIOD_MS));
        }
    }

    /// An OB of a class with events that plcc does not simulate.
    fn not_started(&mut self, number: u16, class: ObClass, span: Span) {
        let mut message = Diagnostic::new(
            Code::BlockFrame,
            span,
            format!("nothing starts OB {number}: it is {} OB", with_article(class.row().word)),
        )
        .label("compiled, but never called")
        .help("call its blocks in a cyclic OB if the program needs them");
        message.severity = Severity::Warning;
        self.report.push(message);
    }

    /// An OB whose number has no event on any CPU.
    fn unknown_number(&mut self, number: u16, span: Span) {
        let title = format!("nothing starts OB {number}: no event has this number");
        let mut message = Diagnostic::new(Code::BlockFrame, span, title)
            .label("compiled, but never called")
            .help("OB 1 runs in each cycle, OB 30 to OB 38 at intervals, OB 100 once at the start; put anything else into an FC");
        message.severity = Severity::Warning;
        self.report.push(message);
    }

    fn wrong_class(&mut self, number: u16, class: ObClass, span: Span) {
        let row = class.row();
        let (first, last) = row.numbers;
        let numbers = if first == last { format!("OB {first}") } else { format!("OB {first} to OB {last}") };
        let free = if row.free { format!(", or OB {OB_FREE} and above") } else { String::new() };
        self.report.push(
            Diagnostic::new(Code::BlockFrame, span, format!("OB {number} cannot be {} OB", with_article(row.word)))
                .label(format!("the block states {}", row.names[0]))
                .help(format!("{} OBs are {numbers}{free}", row.word)),
        );
    }
}
