//! The keys of `[station]` in plc.toml.

use serde::Deserialize;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StationKeys {
    pub cpu: Option<Spanned<String>>,
    pub dp_address: Option<Spanned<i64>>,
    pub mpi_address: Option<Spanned<i64>>,
    #[serde(default)]
    pub module: Vec<ModuleKeys>,
}

/// `[[station.module]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModuleKeys {
    pub rack: Option<Spanned<i64>>,
    pub slot: Spanned<i64>,
    pub order: Option<Spanned<String>>,
    pub kind: Option<Spanned<String>>,
    pub channels: Option<Spanned<OneOrMore<i64>>>,
    /// Resolution of analog channels.
    pub bits: Option<Spanned<i64>>,
    pub name: Option<String>,
    pub inputs: Option<Spanned<i64>>,
    pub outputs: Option<Spanned<i64>>,
    pub range: Option<Spanned<OneOrMore<String>>>,
    #[serde(default)]
    pub wire_break: bool,
    pub substitute: Option<Spanned<i64>>,
}

/// A value for all, or a list.
#[derive(Deserialize)]
#[serde(untagged)]
pub enum OneOrMore<T> {
    One(T),
    More(Vec<T>),
}

impl<T> OneOrMore<T> {
    pub fn as_slice(&self) -> &[T] {
        match self {
            OneOrMore::One(value) => std::slice::from_ref(value),
            OneOrMore::More(values) => values,
        }
    }
}
