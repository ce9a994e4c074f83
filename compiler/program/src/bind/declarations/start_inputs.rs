//! Inputs of organization blocks: the values that an S7-1200/1500 passes at each start.
//!
//! Source: LAD/FBD reference for S7-1200, organization blocks.

use plcc_abi::ob::{ObClass, START_VALUES, StartInput, same_start_value};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, SectionKind};
use rustc_hash::FxHashMap;

use crate::bind::declarations::Declarations;
use crate::bind::declarations::path::Base;
use crate::bind::declarations::typed::{BoundInterface, Local, Use};
use crate::bind::globals::rules::Rules;
use crate::bind::globals::sources::portal_cpu;
use crate::bind::trees::blocks;
use plcc_binding::fold;
use plcc_model::layout::{self, Placer};
use plcc_model::types::{DataType, Elementary};

/// TEMP of an OB holds at least its start information.
pub const OB_START_INFORMATION_BYTES: u32 = 20;

impl Declarations<'_> {
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
        self.has_start_inputs(block) && !declared && (always || portal_cpu(self.globals.input))
    }

    /// OBs of the TIA Portal may have input parameters.
    pub fn has_start_inputs(&self, block: &ast::CodeBlock) -> bool {
        match blocks::dialect(block) {
            Some(dialect) => !Rules::of(self.globals.input, dialect).is_300(),
            None => portal_cpu(self.globals.input),
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
        let class = self.globals.config.class_of(number);
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
                if has_known_inputs(class) {
                    self.no_start_value(number, class, variable);
                }
                // It is 0, as all local data of the OB at its start; what was reported is known, so that its uses are not errors too.
                let (byte, bit) = placer.place(&typed.ty);
                let local = Local { name: variable.name.clone(), ty: typed.ty, base: Base::L, byte, bit };
                bound.locals.entry(fold(&variable.name)).or_insert(local);
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
                self.report(
                    Diagnostic::new(
                        Code::WidthMismatch,
                        variable.ty.span,
                        format!("`{}` of OB {number} is not of this type", variable.name),
                    )
                    .label(layout::type_name(&typed.ty))
                    .help(format!("declare it as {}", wanted.name())),
                );
                let (byte, bit) = placer.place(&typed.ty);
                let local = Local { name: variable.name.clone(), ty: typed.ty, base: Base::L, byte, bit };
                bound.locals.entry(fold(&variable.name)).or_insert(local);
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
        self.report(
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

/// Whether it is known which inputs the OBs of a class have. Those of motion control, of synchronous cycles and of interrupts that are
/// defined by a device have others in each version of the TIA Portal, and nothing here supplies their values.
fn has_known_inputs(class: Option<ObClass>) -> bool {
    class.is_none_or(|class| START_VALUES.iter().any(|(of, ..)| *of == class))
}
