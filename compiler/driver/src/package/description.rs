//! `modelDescription.xml`: what a simulator knows about a unit. Source: FMI 2.0.4 and 3.0.2, chapters 2.2 and 2.4.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::rc::Rc;
use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_runtime::code::Code;
use plcc_runtime::fmi::instance::{self, Instance, Scalar};
use plcc_runtime::fmi::variables::{Kind, Role, TIME_NUMBER, Variable, variables};

use super::fmu::Version;

/// A model description.
pub struct Description {
    pub xml: String,
    /// Variables that are left out because there are too many.
    pub left_out: usize,
}

/// A CPU that never runs: it has the start values.
struct Nothing;

impl Code for Nothing {
    fn call(&self, _entry: u32, _mem: *mut u8, _lbase: u32, _vbase: u32) {}
}

/// Units with their base units.
const UNITS: [(&str, &str); 6] = [
    ("s", "s=\"1\""),
    ("V", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-1\""),
    ("mV", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-1\" factor=\"0.001\""),
    ("mA", "A=\"1\" factor=\"0.001\""),
    ("Ohm", "kg=\"1\" m=\"2\" s=\"-3\" A=\"-2\""),
    ("°C", "K=\"1\" offset=\"273.15\""),
];

/// Describes the program to a simulator, which finds the unit as `identifier`.
pub fn describe(image: &ProgramImage, identifier: &str, version: Version) -> Description {
    let token = plcc_runtime::fmi::token(image);
    let mut image = image.clone();
    image.config.retain.file = None;
    let cpu = instance::cpu(&Arc::new(image), Rc::new(Nothing));
    let (list, left_out) = variables(&cpu);
    let step = cpu.cycle_time() as f64 / 1e9;
    let (name, profile) = (escaped(&cpu.image.name), escaped(&cpu.image.profile.name));
    let list: Arc<[Variable]> = list.into();
    let start = Instance::new(cpu, list.clone());
    let tool = concat!("plcc ", env!("CARGO_PKG_VERSION"));
    let capabilities = "canHandleVariableCommunicationStepSize=\"true\" canBeInstantiatedOnlyOncePerProcess=\"false\"";
    let (version_text, token_name, further, more) = match version {
        Version::V2 => {
            ("2.0", "guid", " numberOfEventIndicators=\"0\"", " canNotUseMemoryManagementFunctions=\"true\"")
        }
        Version::V3 => ("3.0", "instantiationToken", "", ""),
    };
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiModelDescription fmiVersion=\"{version_text}\" modelName=\"{name}\" {token_name}=\"{token}\" \
         description=\"PLC program for {profile}\" generationTool=\"{tool}\" variableNamingConvention=\"flat\"{further}>\n  \
         <CoSimulation modelIdentifier=\"{identifier}\" {capabilities}{more}/>\n"
    );
    let units: BTreeSet<&str> = list.iter().filter_map(|variable| variable.unit).chain(["s"]).collect();
    xml.push_str("  <UnitDefinitions>\n");
    for (unit, base) in UNITS.iter().filter(|(unit, _)| units.contains(unit)) {
        // Writing to a String cannot fail.
        let _ = writeln!(xml, "    <Unit name=\"{unit}\"><BaseUnit {base}/></Unit>");
    }
    xml.push_str("  </UnitDefinitions>\n  <LogCategories>\n");
    for category in ["logEvents", "logStatusWarning", "logStatusError"] {
        let _ = writeln!(xml, "    <Category name=\"{category}\"/>");
    }
    let _ = writeln!(xml, "  </LogCategories>\n  <DefaultExperiment startTime=\"0\" stepSize=\"{step}\"/>");
    xml.push_str("  <ModelVariables>\n");
    if version == Version::V3 {
        let _ = writeln!(
            xml,
            "    <Float64 name=\"plcc.time\" valueReference=\"{TIME_NUMBER}\" causality=\"independent\" \
             variability=\"continuous\" unit=\"s\"/>"
        );
    }
    for (number, variable) in (0u32..).zip(list.iter()) {
        let value = start.read(number).unwrap_or(Scalar::Text(String::new()));
        xml.push_str(&match version {
            Version::V2 => variable_v2(number, variable, &value),
            Version::V3 => variable_v3(number, variable, &value),
        });
    }
    xml.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    let outputs: Vec<usize> = (0..list.len()).filter(|&number| list[number].role == Role::Output).collect();
    match version {
        Version::V2 => {
            for (open, close) in [("Outputs", "Outputs"), ("InitialUnknowns", "InitialUnknowns")] {
                let _ = writeln!(xml, "    <{open}>");
                for number in &outputs {
                    // Counted from 1.
                    let _ = writeln!(xml, "      <Unknown index=\"{}\"/>", number + 1);
                }
                let _ = writeln!(xml, "    </{close}>");
            }
        }
        Version::V3 => {
            for element in ["Output", "InitialUnknown"] {
                for number in &outputs {
                    let _ = writeln!(xml, "    <{element} valueReference=\"{number}\"/>");
                }
            }
        }
    }
    xml.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    Description { xml, left_out }
}

/// The attributes that both versions have. Inputs and what the program starts with can be set; the CPU computes the rest.
fn attributes(number: u32, variable: &Variable) -> String {
    let Variable { name, role, description, settable, .. } = variable;
    let causality = match role {
        Role::Input => "input",
        Role::Output => "output",
        Role::Local => "local",
    };
    let initial = match (role, settable) {
        (Role::Input, _) => "",
        (Role::Local, true) => " initial=\"exact\"",
        (Role::Output, _) | (Role::Local, false) => " initial=\"calculated\"",
    };
    let (name, description) = (escaped(name), escaped(description));
    format!(
        "name=\"{name}\" valueReference=\"{number}\" description=\"{description}\" causality=\"{causality}\" \
         variability=\"discrete\"{initial}"
    )
}

/// Whether the description has a start value.
fn has_start(variable: &Variable) -> bool {
    matches!((variable.role, variable.settable), (Role::Input, _) | (Role::Local, true))
}

/// The type with its unit or range.
fn limits(variable: &Variable, type_name: &str) -> String {
    match (variable.unit, variable.kind.range()) {
        (Some(unit), _) => format!(" unit=\"{unit}\""),
        (None, Some((low, high))) if type_name == "Integer" => format!(" min=\"{low}\" max=\"{high}\""),
        (None, _) => String::new(),
    }
}

fn variable_v2(number: u32, variable: &Variable, value: &Scalar) -> String {
    let ty = variable.kind.name_v2();
    let limits = limits(variable, ty);
    let start = match has_start(variable) {
        true => format!(" start=\"{}\"", escaped(&value_text(value, variable.kind))),
        false => String::new(),
    };
    let attributes = attributes(number, variable);
    format!("    <ScalarVariable {attributes}><{ty}{limits}{start}/></ScalarVariable>\n")
}

fn variable_v3(number: u32, variable: &Variable, value: &Scalar) -> String {
    let ty = variable.kind.name_v3();
    let (attributes, limits) = (attributes(number, variable), limits(variable, ty));
    let text = escaped(&value_text(value, variable.kind));
    match (has_start(variable), variable.kind) {
        (false, _) => format!("    <{ty} {attributes}{limits}/>\n"),
        (true, Kind::Text) => format!("    <{ty} {attributes}><Start value=\"{text}\"/></{ty}>\n"),
        (true, _) => format!("    <{ty} {attributes}{limits} start=\"{text}\"/>\n"),
    }
}

/// As XML Schema has it.
fn value_text(value: &Scalar, kind: Kind) -> String {
    match value {
        Scalar::Bool(bit) => bit.to_string(),
        Scalar::Whole(whole) => whole.to_string(),
        Scalar::Float(number) if number.is_nan() => "NaN".to_string(),
        Scalar::Float(number) if number.is_infinite() => if *number > 0.0 { "INF" } else { "-INF" }.to_string(),
        // A REAL has fewer digits.
        Scalar::Float(number) if kind == Kind::Float32 => (*number as f32).to_string(),
        Scalar::Float(number) => number.to_string(),
        Scalar::Text(text) => text.clone(),
    }
}

/// For an attribute. XML has no way to write most control characters.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => {
                let _ = write!(out, "&#{};", u32::from(c));
            }
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => out.push(char::REPLACEMENT_CHARACTER),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped() {
        assert_eq!(escaped("\"a\" < b & c\n\u{1}"), "&quot;a&quot; &lt; b &amp; c&#10;\u{FFFD}");
    }

    #[test]
    fn numbers_are_those_of_xml_schema() {
        assert_eq!(value_text(&Scalar::Float(f64::from(0.1f32)), Kind::Float32), "0.1");
        assert_eq!(value_text(&Scalar::Float(f64::NEG_INFINITY), Kind::Float64), "-INF");
        assert_eq!(value_text(&Scalar::Whole(-5), Kind::Signed(16)), "-5");
    }

    #[test]
    fn every_unit_of_a_range_is_described() {
        for range in plcc_runtime::analog::RANGES {
            assert!(UNITS.iter().any(|(unit, _)| *unit == range.unit), "{}", range.unit);
        }
    }
}
