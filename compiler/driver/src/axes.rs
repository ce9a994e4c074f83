//! `[axis.NAME]` of plc.toml: technology objects of motion control, as the source text that declares them.

use std::collections::BTreeMap;
use std::fmt::Write;

use plcc_diag::{Code, Diagnostic, FileId, SourceMap, Span};
use serde::Deserialize;
use toml::Spanned;

use crate::inputs::AXES_ENDING;
use crate::keys::{Reader, one_of};

/// Types of axes, and whether each has positions.
const TYPES: [(&str, bool); 3] = [("TO_PositioningAxis", true), ("TO_SynchronousAxis", true), ("TO_SpeedAxis", false)];
/// Greatest number of axes; each has a number above 0 of type INT.
const AXES_MAX: usize = 1000;

/// `[axis.NAME]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisKeys {
    #[serde(rename = "type")]
    ty: Option<Spanned<String>>,
    max_velocity: Option<Spanned<f64>>,
    min_velocity: Option<Spanned<f64>>,
    velocity: Option<Spanned<f64>>,
    acceleration: Option<Spanned<f64>>,
    deceleration: Option<Spanned<f64>>,
    emergency_deceleration: Option<Spanned<f64>>,
    jerk: Option<Spanned<f64>>,
    min_position: Option<Spanned<f64>>,
    max_position: Option<Spanned<f64>>,
    home_mark: Option<Spanned<f64>>,
    home_position: Option<Spanned<f64>>,
    home_offset: Option<Spanned<f64>>,
    approach_velocity: Option<Spanned<f64>>,
}

/// Least value of a key.
#[derive(Clone, Copy, PartialEq)]
enum Least {
    AboveZero,
    Zero,
    Any,
}

/// The source in SCL with a data block for each axis, and an OB that moves them at the end of each cycle; empty without axes.
pub fn source(axes: &BTreeMap<Spanned<String>, AxisKeys>, file: FileId) -> (String, Vec<Diagnostic>) {
    let mut reader = Reader::new(file);
    let mut blocks = String::new();
    let mut calls = String::new();
    // In the order of the file, which numbers them.
    let mut axes: Vec<_> = axes.iter().collect();
    axes.sort_by_key(|(name, _)| name.span().start);
    for (index, (name, keys)) in axes.iter().enumerate() {
        if index == AXES_MAX {
            reader.report(name, format!("more than {AXES_MAX} axes"), "leave some out");
            break;
        }
        let text = name.get_ref();
        if text.trim().is_empty() || text.contains(['"', '$', '\n', '\r']) {
            reader.report(name, format!("`{text}` is not a name of an axis"), "write `[axis.Axis_1]`");
            continue;
        }
        let values = reader.values(keys, index + 1);
        // Writing to a String cannot fail.
        let _ = write!(blocks, "DATA_BLOCK \"{text}\" TO_PositioningAxis\nBEGIN\n{values}END_DATA_BLOCK\n");
        let _ = writeln!(calls, "  \"{text}\"();");
    }
    if !calls.is_empty() {
        let _ = write!(
            blocks,
            "ORGANIZATION_BLOCK \"Axes of plc.toml\"\n{{ S7_EventClass := 'ProgramCycle' }}\nBEGIN\n{calls}END_ORGANIZATION_BLOCK\n"
        );
    }
    (blocks, reader.diagnostics)
}

/// Moves what messages say of the source of the axes to the headings of plc.toml, which its author knows. A name that is defined twice
/// says all that is wrong with the axis.
pub fn show_headings(diagnostics: &mut Vec<Diagnostic>, names: &[(String, Span)], sources: &SourceMap) {
    let heading = |span: Span| {
        let source = sources.file(span.file);
        let text = source.text.get(span.range()).filter(|_| source.name.ends_with(AXES_ENDING))?;
        names.iter().find(|(name, _)| name == text.trim_matches('"')).map(|(_, heading)| *heading)
    };
    let mut twice = Vec::new();
    for message in diagnostics.iter_mut() {
        let primary = message.primary.span;
        for label in std::iter::once(&mut message.primary).chain(&mut message.secondary) {
            label.span = heading(label.span).unwrap_or(label.span);
        }
        if message.code == Code::DuplicateBlock && message.primary.span != primary {
            let help = "the heading is the data block of an axis: give one of them another name, or remove the heading";
            message.help = Some(help.to_string());
            twice.push(message.primary.span);
        }
    }
    diagnostics.retain(|message| message.code == Code::DuplicateBlock || !twice.contains(&message.primary.span));
}

impl Reader {
    /// The start values of one axis.
    fn values(&mut self, keys: &AxisKeys, number: usize) -> String {
        let mut text = format!("  S.Number := {number};\n");
        let positions = match &keys.ty {
            None => true,
            Some(ty) => match TYPES.iter().find(|(name, _)| name.eq_ignore_ascii_case(ty.get_ref())) {
                Some((_, positions)) => *positions,
                None => {
                    let names: Vec<&str> = TYPES.iter().map(|(name, _)| *name).collect();
                    let title = format!("`{}` is not a type of an axis", ty.get_ref());
                    self.report(ty, title, &one_of(ty.get_ref(), &names));
                    true
                }
            },
        };
        if !positions {
            text += "  S.SpeedAxis := TRUE;\n";
        }
        let limits = [&keys.min_position, &keys.max_position];
        let marks = [&keys.home_mark, &keys.home_position, &keys.home_offset, &keys.approach_velocity];
        if !positions && let Some(key) = limits.into_iter().chain(marks).flatten().next() {
            self.report(
                key,
                "a speed axis has no positions".to_string(),
                "leave it out, or write `type = \"TO_PositioningAxis\"`",
            );
        }
        if let [Some(least), Some(most)] = limits
            && least.get_ref() >= most.get_ref()
        {
            self.report(most, "`max_position` is not above `min_position`".to_string(), "the axis moves between them");
        }
        let own_max = keys.max_velocity.as_ref().map_or(250.0, |key| *key.get_ref());
        for key in [&keys.velocity, &keys.min_velocity, &keys.approach_velocity].into_iter().flatten() {
            if *key.get_ref() > own_max {
                self.report(key, format!("it is above `max_velocity`, {own_max}"), "the axis cannot be that fast");
            }
        }
        if keys.velocity.is_none() && own_max < 10.0 && own_max > 0.0 {
            let _ = writeln!(text, "  DynamicDefaults.Velocity := {own_max:?};");
        }
        if limits.iter().any(|limit| limit.is_some()) {
            text += "  PositionLimits_SW.Active := TRUE;\n";
        }
        if keys.home_mark.is_some() {
            text += "  Homing.MarkExists := TRUE;\n";
        }
        for (key, member, least) in [
            (&keys.max_velocity, "DynamicLimits.MaxVelocity", Least::AboveZero),
            (&keys.min_velocity, "DynamicLimits.MinVelocity", Least::Zero),
            (&keys.velocity, "DynamicDefaults.Velocity", Least::AboveZero),
            (&keys.acceleration, "DynamicDefaults.Acceleration", Least::AboveZero),
            (&keys.deceleration, "DynamicDefaults.Deceleration", Least::AboveZero),
            (&keys.emergency_deceleration, "DynamicDefaults.EmergencyDeceleration", Least::AboveZero),
            (&keys.jerk, "DynamicDefaults.Jerk", Least::Zero),
            (&keys.min_position, "PositionLimits_SW.MinPosition", Least::Any),
            (&keys.max_position, "PositionLimits_SW.MaxPosition", Least::Any),
            (&keys.home_mark, "Homing.Mark", Least::Any),
            (&keys.home_position, "Homing.HomePosition", Least::Any),
            (&keys.home_offset, "Homing.HomePositionOffset", Least::Any),
            (&keys.approach_velocity, "Homing.ApproachVelocity", Least::AboveZero),
        ] {
            let Some(key) = key else { continue };
            let value = *key.get_ref();
            let good = match least {
                Least::AboveZero => value > 0.0,
                Least::Zero => value >= 0.0,
                Least::Any => true,
            };
            if !good || value.abs() > 1e12 || value.is_nan() {
                let help = match least {
                    Least::AboveZero => "a number above 0, up to 1e12",
                    Least::Zero => "0 or more, up to 1e12",
                    Least::Any => "a number from -1e12 to 1e12",
                };
                self.report(key, format!("{value} is not possible here"), help);
                continue;
            }
            // With a point, as SCL wants it; the shortest digits that give the number again.
            let _ = writeln!(text, "  {member} := {value:?};");
        }
        text
    }
}
