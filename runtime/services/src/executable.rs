//! The part of `main` that only programs with services have.

use std::ffi::{c_char, c_int};

use plcc_abi::ProgramImage;
use plcc_runtime::change::Loader;
use plcc_runtime::executable::{Opened, Opener, main_of};

use crate::ServiceOptions;

impl Opener for ServiceOptions {
    fn open(&self, image: &ProgramImage, flags_only: bool, loader: Option<Loader>) -> Result<Opened, String> {
        ServiceOptions::open(self, image, flags_only, loader)
    }

    fn allows_load(&self) -> bool {
        self.allow_load
    }
}

/// Entry point of the process.
///
/// # Safety
/// Called by the C runtime only, with its `argc` and `argv`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn plcc_main_with_services(argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: as the caller promises.
    unsafe { main_of::<ServiceOptions>(argc, argv) }
}
