//! The values that can be watched.

use crate::limits::NAMES_MAX;
use plcc_abi::ProgramImage;
use plcc_runtime::names::{self, Named};
use plcc_runtime::signal::Source;
use serde::Serialize;

/// A value with its name.
#[derive(Serialize)]
pub struct Listed {
    pub name: String,
    #[serde(rename = "type")]
    pub ty: &'static str,
}

/// All values that the program uses, in order.
pub fn list(image: &ProgramImage) -> Vec<Listed> {
    let all = names::used(image).into_iter().take(NAMES_MAX);
    all.map(|(name, named): (String, Named)| Listed { name, ty: Source::of(named).ty() }).collect()
}
