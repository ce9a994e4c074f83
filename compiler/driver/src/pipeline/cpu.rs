//! The CPU that a program is for: of a test file, of the command line, of plc.toml, or implied by the sources.

use plcc_abi::image::{Family, Profile};
use plcc_diag::{Code, Diagnostic, FileId, SourceFile, SourceMap, Span};
use plcc_model::profile;
use plcc_syntax::ast::SourceUnit;

use super::Settings;
use crate::project::Project;

/// The CPU of a test file: the last `//@ cpu` that can be understood. Binding reports the others.
pub(super) fn pragma_profile(settings: &Settings, units: &[(FileId, SourceUnit)]) -> Option<Profile> {
    if !settings.pragmas {
        return None;
    }
    let pragmas = units.iter().flat_map(|(_, unit)| &unit.pragmas);
    let names = pragmas.filter_map(|pragma| pragma.text.strip_prefix("cpu")).map(str::trim);
    names.filter_map(profile_named).rfind(|profile| plcc_program::runs(profile, units))
}

/// Reports each `//@ cpu` of a test file that names a CPU which does not run the sources. Binding reports names that no CPU has.
pub(super) fn check_pragmas(settings: &Settings, units: &[(FileId, SourceUnit)], diagnostics: &mut Vec<Diagnostic>) {
    if !settings.pragmas {
        return;
    }
    for pragma in units.iter().flat_map(|(_, unit)| &unit.pragmas) {
        let name = pragma.text.strip_prefix("cpu").map(str::trim).filter(|name| profile::lookup(name).is_some());
        if let Some(Err((title, help))) = name.map(|name| named(name, units)) {
            diagnostics.push(Diagnostic::new(Code::UnknownCpu, pragma.span, title).help(help));
        }
    }
}

fn profile_named(name: &str) -> Option<Profile> {
    match name.strip_prefix("accus=") {
        Some("2") => Some(profile::generic(Family::S7300)),
        Some("4") => Some(profile::generic(Family::S7400)),
        Some(_) => None,
        None => profile::lookup(name),
    }
}

/// The CPU: from the command line, else from plc.toml, else the one that the sources imply.
pub(super) fn profile_of(
    settings: &Settings,
    project: Option<&Project>,
    units: &[(FileId, SourceUnit)],
    sources: &mut SourceMap,
    diagnostics: &mut Vec<Diagnostic>,
) -> Profile {
    let generic = plcc_program::implied_profile(units);
    let (name, span) = match (&settings.cpu, project.and_then(|project| project.cpu.clone())) {
        (Some(name), _) => (name.clone(), None),
        (None, Some((name, span))) => (name, Some(span)),
        (None, None) => return generic,
    };
    let (title, help) = match named(&name, units) {
        Ok(profile) => return profile,
        Err(refusal) => refusal,
    };
    let span = span.unwrap_or_else(|| Span::new(sources.add(SourceFile::new("--cpu", name.clone())), 0..name.len()));
    diagnostics.push(Diagnostic::new(Code::UnknownCpu, span, title).help(help));
    generic
}

/// The CPU of this name; or title and help of the message that it is not one, or not one that runs the sources.
fn named(name: &str, units: &[(FileId, SourceUnit)]) -> Result<Profile, (String, String)> {
    let is_s7200 = plcc_program::is_s7200(units);
    let one_of = || format!("one of {}", profile::s7200::names().join(", "));
    Err(match profile::lookup(name) {
        Some(profile) if plcc_program::runs(&profile, units) => return Ok(profile),
        Some(profile) if is_s7200 => (format!("`{}` does not run programs of the S7-200", profile.name), one_of()),
        Some(profile) if profile.family == Family::S71200 => {
            let language = plcc_program::language_beyond_s7_1200(units).unwrap_or("STL");
            (
                format!("`{}` has no {language}; it runs LAD, FBD and SCL", profile.name),
                format!("choose a CPU with {language}, such as an S7-1500, or write the blocks in SCL"),
            )
        }
        Some(profile) => (
            format!("`{}` is an S7-200, which runs sources of Micro/WIN only", profile.name),
            "choose another CPU; a source of Micro/WIN has instructions such as `LD` and `MOVW`".to_string(),
        ),
        None if is_s7200 => (format!("plcc does not know the CPU `{name}`"), one_of()),
        None => (format!("plcc does not know the CPU `{name}`"), profile::help(name)),
    })
}

/// The order number of the CPU, as far as it is known: that of a station, of the command line or of plc.toml, else how those of this CPU begin.
pub(super) fn order_of(settings: &Settings, project: Option<&Project>, profile: &Profile) -> String {
    let of_station = project.map(|project| project.config.cpu_order.as_str()).filter(|order| !order.is_empty());
    let of_project = project.and_then(|project| project.cpu.as_ref()).map(|(name, _)| name.as_str());
    match (settings.cpu.as_deref(), of_station) {
        (None, Some(order)) => order.to_string(),
        (named, _) => profile::order_number(named.or(of_project).unwrap_or_default(), profile),
    }
}
