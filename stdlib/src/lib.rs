//! System functions and function blocks, as PLC source where possible.
