//! `CALL NORM_X`, `CALL LIMIT` and other instructions of the TIA Portal that SCL computes in place.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, Width};

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::globals::instruction::{Instruction, PinType, Types};
use crate::bind::globals::sources::portal_cpu;
use crate::bind::stl::StlBinder;
use crate::bind::stl::move_call::{called_name, named_type};
use crate::bind::stl::settle::Settled;
use plcc_binding::fold;
use plcc_model::BlockKey;
use plcc_model::types::Elementary;

impl StlBinder<'_, '_> {
    /// The instruction that a call means; none: it means a block.
    pub fn called_instruction(&self, call: &ast::Call) -> Option<&'static Instruction> {
        let name = called_name(call)?;
        let instruction = Instruction::find(name)?;
        // LIMIT and others are also blocks of the library of STEP 7 V5, which have no OUT.
        let has_out = call.parameters.iter().any(|parameter| fold(&parameter.name) == "out");
        let is_block = self.program.globals.names.symbols.contains_key(&fold(name))
            || !has_out && self.program.globals.global(name).is_some();
        (!is_block).then_some(instruction)
    }

    /// The function for the types of a call; none after a message.
    pub fn instruction_function(
        &mut self,
        ctx: &mut CurrentBlock,
        call: &ast::Call,
        instruction: &'static Instruction,
    ) -> Option<BlockKey> {
        let (name, span) = (instruction.name, call.target.span);
        if !self.has_instructions(name, span) {
            return None;
        }
        let value = self.type_of_pins(ctx, call, instruction, PinType::Value)?;
        let result = match instruction.converts {
            true => self.type_of_pins(ctx, call, instruction, PinType::Result)?,
            false => value,
        };
        let types = Types { value, result, index: self.type_of_index(ctx, call, instruction) };
        if let Some(expected) = instruction.wrong_types(types) {
            let label = format!("here {} from {}", result.name(), value.name());
            self.program.report(
                Diagnostic::new(Code::TypeMismatch, span, format!("`{name}` computes {expected}")).label(label),
            );
            return None;
        }
        let given = call.parameters.iter().map(|parameter| parameter.name.as_str());
        let source = instruction.function(types, given);
        self.program.globals.write_function(name, source, span)
    }

    /// The type that a call names for its values or for its result, or the one that an actual of these has.
    fn type_of_pins(
        &mut self,
        ctx: &mut CurrentBlock,
        call: &ast::Call,
        instruction: &Instruction,
        wanted: PinType,
    ) -> Option<Elementary> {
        let of_result = |name: &str| fold(name).starts_with("dest");
        let in_braces = call.types.iter().filter_map(|one| {
            let ty = Elementary::from_word(&one.ty.trim().to_ascii_uppercase())?;
            Some((one.name.as_str(), ty))
        });
        let in_list = call.parameters.iter().filter_map(|one| Some((one.name.as_str(), named_type(one)?)));
        let named = in_braces.chain(in_list).find(|one| of_result(one.0) == (wanted == PinType::Result));
        if let Some((_, ty)) = named {
            return Some(ty);
        }
        for parameter in &call.parameters {
            let Some(actual) = parameter.actual.as_ref().filter(|_| instruction.pin(&parameter.name) == Some(wanted))
            else {
                continue;
            };
            if let Settled::Memory { ty: Some(ty), .. } = self.settle(ctx, actual)? {
                return Some(ty);
            }
        }
        let word = match (instruction.converts, wanted) {
            (false, _) => "value_type",
            (true, PinType::Result) => "dest_type",
            (true, _) => "src_type",
        };
        self.no_type(instruction.name, word, call.target.span)
    }

    /// Whether the CPU has instructions with types; reports the first call if not.
    pub fn has_instructions(&mut self, name: &str, span: Span) -> bool {
        const NEEDS: &str = "needs an S7-1500";
        if portal_cpu(self.program.globals.input) {
            return true;
        }
        let mut told = self.program.globals.report.diagnostics.iter();
        if told.any(|told| told.code == Code::CpuInstruction && told.title.ends_with(NEEDS)) {
            return false;
        }
        let cpu = &self.program.globals.input.profile.name;
        let message = Diagnostic::new(Code::CpuInstruction, span, format!("`CALL {name}` {NEEDS}"))
            .label(format!("the CPU is {cpu}"))
            .help("name the CPU, e.g. --cpu s7-1500");
        self.program.report(message);
        false
    }

    /// Reports a call without a type; `word`: the parameter that names one.
    pub fn no_type<T>(&mut self, name: &str, word: &str, span: Span) -> Option<T> {
        self.program.report(
            Diagnostic::new(Code::MissingParameter, span, format!("`{name}` is called for no type"))
                .label("none of its actual parameters tells the type")
                .help(format!("name it as the first parameter, e.g. `{word} := Int`")),
        );
        None
    }

    /// The type of the input K: that of its actual, INT for a number.
    fn type_of_index(&mut self, ctx: &mut CurrentBlock, call: &ast::Call, instruction: &Instruction) -> Elementary {
        let index = |parameter: &&ast::Parameter| instruction.pin(&parameter.name) == Some(PinType::Index);
        let actual = call.parameters.iter().find(index).and_then(|parameter| parameter.actual.as_ref());
        match actual.and_then(|actual| self.settle(ctx, actual)) {
            Some(Settled::Memory { ty: Some(ty), .. }) => ty,
            Some(Settled::Memory { width: Width::Byte, .. }) => Elementary::Usint,
            Some(Settled::Memory { width: Width::Dword, .. }) => Elementary::Dint,
            _ => Elementary::Int,
        }
    }
}
