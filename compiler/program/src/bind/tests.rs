//! Whole programs through parser and binding.
