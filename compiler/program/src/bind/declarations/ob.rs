//! Organization blocks: what starts each, and the values that an S7-1200/1500 passes to it.
//!
//! Source: LAD/FBD reference for S7-1200, organization blocks.

use crate::bind::trees::blocks;
use plcc_abi::image::BlockKind;
use plcc_abi::ob::{OB_CLASSES, OB_FREE, ObClass, START_VALUES, StartInput, same_start_value};
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::{self, SectionKind};
use rustc_hash::FxHashMap;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::path::Base;
use crate::bind::declarations::sources::CodeSource;
use crate::bind::declarations::types::{self, BoundInterface, Local, Use};
use plcc_binding::fold;
use plcc_model::layout::{self, Placer};
use plcc_model::types::{DataType, Elementary};

/// TEMP of an OB holds at least its start information.
pub const OB_START_INFORMATION_BYTES: u32 = 20;

/// Attributes that state what starts an OB: in sources, in SimaticML.
const CLASS_ATTRIBUTES: [&str; 2] = ["S7_EventClass", "SecondaryType"];

/// What the attributes of a block state about its start; also the value, for messages.
pub fn class_attribute(header: &ast::Header) -> Option<(Option<ObClass>, &str)> {
    let is_class = |name: &str| CLASS_ATTRIBUTES.iter().any(|known| known.eq_ignore_ascii_case(name));
    let (_, value) = header.attributes.iter().find(|(name, _)| is_class(name))?;
    let value = value.trim().trim_matches(['\'', '"']);
    Some((ObClass::of_name(value), value))
}

impl Declarations<'_> {
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
            let Some((class, text)) = class_attribute(&block.header) else { continue };
            if self.config.ob_classes.iter().any(|(ob, _)| *ob == number) {
                continue;
            }
            match class {
                None => {
                    let names: Vec<&str> = OB_CLASSES.iter().map(|row| row.names[0]).collect();
                    self.report.push(
                        Diagnostic::new(
                            Code::BlockFrame,
                            block.name.span(),
                            format!("`{text}` is not a class of organization blocks"),
                        )
                        .label(format!("it is not known what starts OB {number}"))
                        .help(format!("one of {}", names.join(", "))),
                    );
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

    /// An OB of a class with events that plcc does not simulate.
    fn not_started(&mut self, number: u16, class: ObClass, span: Span) {
        let mut message = Diagnostic::new(
            Code::BlockFrame,
            span,
            format!("nothing starts OB {number}: it is a {} OB", class.row().word),
        )
        .label("compiled, but never called")
        .help("call its blocks in a cyclic OB if the program needs them");
        message.severity = Severity::Warning;
        self.report.push(message);
    }

    fn wrong_class(&mut self, number: u16, class: ObClass, span: Span) {
        let row = class.row();
        let (first, last) = row.numbers;
        let numbers = if first == last { format!("OB {first}") } else { format!("OB {first} to OB {last}") };
        let free = if row.free { format!(", or OB {OB_FREE} and above") } else { String::new() };
        self.report.push(
            Diagnostic::new(Code::BlockFrame, span, format!("OB {number} cannot be a {} OB", row.word))
                .label(format!("the block states {}", row.names[0]))
                .help(format!("{} OBs are {numbers}{free}", row.word)),
        );
    }

    /// The OBs of S7-1200/1500 have no start information in VAR_TEMP; those of S7-300/400 declare it first, `OB1_EV_CLASS` and the
    /// rest.
    pub fn hides_start_information(&self, number: u16, block: &ast::CodeBlock) -> bool {
        let always = matches!(number, 1 | 30..=38 | 100..=102 | 123..);
        let first = block.sections.iter().flat_map(|section| &section.variables).next();
        let declared = first.is_some_and(|variable| {
            let digits = variable.name.get(2..).unwrap_or("");
            variable.name.get(..2).is_some_and(|letters| letters.eq_ignore_ascii_case("OB"))
                && digits.starts_with(|letter: char| letter.is_ascii_digit())
        });
        self.has_start_inputs(block) && !declared && (always || types::portal_cpu(self.input))
    }

    /// OBs of the TIA Portal may have input parameters.
    pub fn has_start_inputs(&self, block: &ast::CodeBlock) -> bool {
        match blocks::dialect(block) {
            Some(dialect) => !crate::bind::declarations::rules::Rules::of(self.input, dialect).is_300(),
            None => types::portal_cpu(self.input),
        }
    }

    /// The input parameters of an OB, after the start information.
    pub fn start_inputs(
        &mut self,
        number: u16,
        block: &ast::CodeBlock,
        bound: &mut BoundInterface,
        names: &mut FxHashMap<String, Span>,
        placer: &mut Placer,
    ) {
        let class = self.config.class_of(number);
        let inputs = block.sections.iter().filter(|section| section.kind == SectionKind::Input);
        let variables: Vec<&ast::Variable> = inputs.flat_map(|section| &section.variables).collect();
        if variables.is_empty() {
            return;
        }
        // If TEMP does not already follow the start information, the inputs do.
        placer.reserve(OB_START_INFORMATION_BYTES);
        for variable in variables {
            self.declare_name(names, &variable.name, variable.name_span);
            self.ignored_initial(variable, "the CPU sets it at each start");
            let Some(typed) = self.variable_type(variable, Use::Component) else { continue };
            let known =
                START_VALUES.iter().find(|(of, name, ..)| Some(*of) == class && same_start_value(name, &variable.name));
            let Some(&(_, _, bits, value)) = known else {
                self.no_start_value(number, class, variable);
                continue;
            };
            // Versions of the TIA Portal differ in whether a small number is a byte or a word.
            let declared = match typed.ty {
                DataType::Elementary(ty) if ty.bits() == bits || (bits == 8 && ty.bits() == 16) => Some(ty.bits()),
                _ => None,
            };
            let Some(bits) = declared else {
                let wanted = match bits {
                    1 => Elementary::Bool,
                    8 => Elementary::Byte,
                    _ => Elementary::Word,
                };
                self.report.push(
                    Diagnostic::new(
                        Code::WidthMismatch,
                        variable.ty.span,
                        format!("`{}` of OB {number} is not of this type", variable.name),
                    )
                    .label(layout::type_name(&typed.ty))
                    .help(format!("declare it as {}", wanted.name())),
                );
                continue;
            };
            let (byte, bit) = placer.place(&typed.ty);
            bound.interface.start_inputs.push(StartInput { value, byte, bit, bits });
            let local = Local { name: variable.name.clone(), ty: typed.ty, base: Base::L, byte, bit };
            bound.locals.entry(fold(&variable.name)).or_insert(local);
        }
        bound.interface.start_bytes = placer.clone().size();
    }

    fn no_start_value(&mut self, number: u16, class: Option<ObClass>, variable: &ast::Variable) {
        let known: Vec<&str> =
            START_VALUES.iter().filter(|(of, ..)| Some(*of) == class).map(|(_, name, ..)| *name).collect();
        let help = match known.as_slice() {
            [] => "use VAR_TEMP, bit memory or a data block".to_string(),
            names => format!("it gets {}; for other data use VAR_TEMP or a data block", names.join(", ")),
        };
        self.report.push(
            Diagnostic::new(
                Code::SectionNotAllowed,
                variable.name_span,
                format!("the CPU does not pass `{}` to OB {number}", variable.name),
            )
            .label("not an input of this organization block")
            .help(help),
        );
    }
}
