//! The target and its settings.

use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};

use crate::{CodegenError, CodegenOptions};

/// Where the code will live.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// An object file: position-independent, by default for the baseline instruction set.
    Object,
    /// The memory of this process.
    Memory,
}

/// Settings of a function in addition to the options.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tuning {
    /// Cranelift's optimisation would take too long.
    pub plain: bool,
    /// Good register allocation would take too long: it is done in one pass.
    pub quick: bool,
}

/// The code generator of this computer's architecture.
pub fn isa(placement: Placement, options: &CodegenOptions, tuning: Tuning) -> Result<OwnedTargetIsa, CodegenError> {
    let mut flags = settings::builder();
    let regalloc = if tuning.quick { "single_pass" } else { "backtracking" };
    let optimize = options.optimize && !tuning.plain;
    let settings = [
        ("opt_level", if optimize { "speed" } else { "none" }),
        ("regalloc_algorithm", regalloc),
        ("is_pic", if placement == Placement::Object { "true" } else { "false" }),
        ("enable_verifier", if options.verify { "true" } else { "false" }),
        ("log2_min_function_alignment", "4"),
        // A program runs in its own process; there are no secrets to protect.
        ("enable_table_access_spectre_mitigation", "false"),
        ("enable_heap_access_spectre_mitigation", "false"),
        // Large frames must touch each page, so that a stack overflow cannot jump over the guard page.
        ("enable_probestack", "true"),
        ("probestack_strategy", "inline"),
        // Where blocks begin tells code from tables when it is read back.
        ("machine_code_cfg_info", "true"),
        // No exception passes through generated code.
        ("unwind_info", "false"),
    ];
    for (name, value) in settings {
        flags.set(name, value).map_err(|error| CodegenError::Host(error.to_string()))?;
    }
    cranelift_native::builder_with_options(options.native)
        .map_err(|message| CodegenError::Host(message.to_string()))?
        .finish(settings::Flags::new(flags))
        .map_err(|error| CodegenError::Host(error.to_string()))
}
