//! Settings of a block: lines `key: value` of `$_CMPSET` and `$_SETTINGS`. Keys without an effect are ignored.
//! Source: GRAPH reference A.4.

use plcc_syntax::chart::ast::{Interface, Settings, StepData};

/// Reads the lines into `settings`. An unknown value is ignored.
pub fn read(text: &str, settings: &mut Settings) {
    for line in text.split(['\n', '\r']) {
        let Some((key, value)) = line.split_once(':') else { continue };
        let (key, value) = (key.trim(), value.trim());
        let is = |known: &str| known.eq_ignore_ascii_case(key);
        match () {
            () if is("FBInterface") => settings.interface = interface(value),
            () if is("SSBLevel") => settings.data = step_data(value),
            () if is("SSkipOn") => settings.skip_steps = truth(value),
            () if is("AckReq") => settings.acknowledge = truth(value),
            () if is("PermILMan") => settings.manual_interlocks = truth(value),
            () if is("SaveSwitching") => settings.safe_activation = truth(value),
            () if is("SWMLocked") => settings.locked_mode = truth(value),
            () => {}
        }
    }
}

fn interface(value: &str) -> Option<Interface> {
    let is = |known: &str| known.eq_ignore_ascii_case(value);
    match () {
        () if is("Minimum") => Some(Interface::Minimum),
        () if is("Standard") => Some(Interface::Standard),
        () if is("Maximum") => Some(Interface::Maximum),
        () if is("UserDefined") => Some(Interface::UserDefined),
        () => None,
    }
}

fn step_data(value: &str) -> Option<StepData> {
    let is = |known: &str| known.eq_ignore_ascii_case(value);
    match () {
        () if is("Individual") => Some(StepData::Individual),
        () if is("Array") => Some(StepData::Array),
        () if is("Minimized") => Some(StepData::Minimized),
        () => None,
    }
}

fn truth(value: &str) -> Option<bool> {
    let is = |known: &[&str]| known.iter().any(|known| known.eq_ignore_ascii_case(value));
    match () {
        () if is(&["T", "TRUE"]) => Some(true),
        () if is(&["F", "FALSE"]) => Some(false),
        () => None,
    }
}
