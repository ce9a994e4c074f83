//! Where the compiled runtimes come from that linking puts into executables.
//!
//! Compiling them takes minutes. So this library does not contain them and is compiled at the same time; programs that link do.

use std::sync::OnceLock;

use plcc_abi::linked::Runtimes;

static PROVIDED: OnceLock<Runtimes> = OnceLock::new();

/// Says what executables are made from, before the first one is linked. What was said first holds.
pub fn provide(runtimes: Runtimes) {
    PROVIDED.get_or_init(|| runtimes);
}

/// Panics if [`provide`] has not been called, which is a mistake of the program around this library.
pub(super) fn provided() -> &'static Runtimes {
    PROVIDED.get().expect("a program that links executables says first which runtimes there are")
}
