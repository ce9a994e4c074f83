//! The keys of a `plc.toml` as they are read, before they are checked.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::axes;
use crate::connections;
use crate::remote;
use crate::retain::RetainKeys;
use crate::s7200::S7200Keys;
use crate::services::ServicesKeys;
use crate::station::StationKeys;
use crate::technology;

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keys {
    pub(super) name: Option<Spanned<String>>,
    pub(super) cpu: Option<Spanned<String>>,
    pub(super) mnemonics: Option<MnemonicsKey>,
    #[serde(default)]
    pub(super) safety_as_standard: bool,
    pub(super) sources: Option<Vec<Spanned<String>>>,
    #[serde(default)]
    pub(super) symbols: Vec<Spanned<String>>,
    #[serde(default)]
    pub(super) partial: bool,
    pub(super) startup: Option<Spanned<StartupKey>>,
    pub(super) cycle_time: Option<Spanned<String>>,
    pub(super) cycle_time_max: Option<Spanned<String>>,
    pub(super) cycle_time_exceeded: Option<Spanned<ExceededKey>>,
    #[serde(alias = "clock_memory_byte")]
    pub(super) clock_memory: Option<Spanned<i64>>,
    pub(super) system_memory_byte: Option<Spanned<i64>>,
    #[serde(default)]
    pub(super) ob: BTreeMap<Spanned<String>, ObKeys>,
    #[serde(default)]
    pub(super) module: Vec<ModuleKeys>,
    pub(super) station: Option<StationKeys>,
    #[serde(default)]
    pub(super) hsc: BTreeMap<Spanned<String>, technology::HscKeys>,
    #[serde(default)]
    pub(super) pulse: BTreeMap<Spanned<String>, technology::PulseKeys>,
    #[serde(default)]
    pub(super) hardware_interrupt: BTreeMap<Spanned<String>, technology::InterruptKeys>,
    #[serde(default)]
    pub(super) axis: BTreeMap<Spanned<String>, axes::AxisKeys>,
    /// Folder of the program's files.
    pub(super) data: Option<Spanned<String>>,
    pub(super) s7200: Option<Spanned<S7200Keys>>,
    pub(super) retain: Option<RetainKeys>,
    pub(super) services: Option<ServicesKeys>,
    #[serde(default)]
    pub(super) io: BTreeMap<Spanned<String>, remote::IoKeys>,
    #[serde(default)]
    pub(super) connection: BTreeMap<Spanned<String>, connections::ConnectionKeys>,
}

#[derive(Deserialize)]
pub(super) enum MnemonicsKey {
    #[serde(rename = "en")]
    En,
    #[serde(rename = "de")]
    De,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum StartupKey {
    Warm,
    Hot,
    Cold,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ExceededKey {
    Run,
    Stop,
}

/// `[ob.N]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObKeys {
    pub(super) class: Option<Spanned<String>>,
    pub(super) period: Option<Spanned<String>>,
    pub(super) phase: Option<Spanned<String>>,
    pub(super) priority: Option<Spanned<i64>>,
    pub(super) start: Option<Spanned<String>>,
    pub(super) every: Option<Spanned<String>>,
}

/// `[[module]]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModuleKeys {
    pub(super) name: Spanned<String>,
    #[serde(default, deserialize_with = "addresses_in_table")]
    pub(super) inputs: Option<AddressKeys>,
    #[serde(default, deserialize_with = "addresses_in_table")]
    pub(super) outputs: Option<AddressKeys>,
    pub(super) hardware_id: Option<Spanned<i64>>,
}

/// Reads a table; a list of numbers says nothing of which is which.
fn addresses_in_table<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Option<AddressKeys>, D::Error> {
    struct Table;
    impl<'de> serde::de::Visitor<'de> for Table {
        type Value = AddressKeys;

        fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
            f.write_str("struct AddressKeys")
        }

        fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<AddressKeys, A::Error> {
            AddressKeys::deserialize(serde::de::value::MapAccessDeserializer::new(map))
        }
    }
    from.deserialize_map(Table).map(Some)
}

/// `{ start = 0, bytes = 4 }`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AddressKeys {
    pub(super) start: Spanned<i64>,
    pub(super) bytes: Spanned<i64>,
}
