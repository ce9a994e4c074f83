//! Lowers the bound program to the SSA IR; the place where PLC semantics are written.
