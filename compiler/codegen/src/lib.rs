//! SSA IR to machine code, in an object file or in memory; the only crate that names Cranelift.
