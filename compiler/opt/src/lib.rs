//! Optimisation passes over the SSA IR.
