//! The values that a page watches: their names, looked up in the program, and how each value is shown.

use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::image::Family;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::signal::{Source, Value};
use plcc_runtime::watch::format::Format;
use plcc_runtime::{force, typed};

use crate::limits::{NAME_MAX, WATCHED_MAX};
use crate::web::messages::{Shown, exact};

/// What a page watches.
#[derive(Clone, Default)]
pub(super) struct Watched {
    pub(super) wanted: Wanted,
    /// How often the program had changed when the names were looked up.
    pub(super) generation: u64,
    /// Number in the list of names, where the value is, and its format.
    pub(super) found: Arc<[(usize, Source, Option<Format>)]>,
}

/// Names, and their formats if those are not the usual ones.
#[derive(Clone, Default)]
pub(super) struct Wanted {
    pub(super) names: Arc<[String]>,
    pub(super) formats: Arc<[Option<Format>]>,
}

/// Names that were looked up in a program.
pub(super) struct Found {
    wanted: Wanted,
    /// One for each name, up to as many as a page can watch.
    sources: Vec<Result<(Source, Option<Format>), String>>,
}

/// Looks names up, which takes its time when there are many.
pub(super) fn find(image: &ProgramImage, wanted: Wanted) -> Found {
    let formats = wanted.formats.iter().copied().chain(std::iter::repeat(None));
    let named = |(name, format): (&String, Option<Format>)| {
        let source = source_in(image, name)?;
        let format = format.map(|format| match source {
            Source::Bits(address) | Source::Typed(address, _) => format.check(name, &source, address.width),
            Source::Channel(..)
            | Source::Plant(_)
            | Source::PulseDuty(_)
            | Source::PulsePeriod(_)
            | Source::PulseCount(_) => Err(format!("{name} is a number with a unit: leave the format out")),
        });
        Ok((source, format.transpose()?))
    };
    let mut sources: Vec<_> = wanted.names.iter().take(WATCHED_MAX).zip(formats).map(named).collect();
    if wanted.names.len() > WATCHED_MAX {
        sources.push(Err(format!("a page can watch {WATCHED_MAX} values")));
    }
    Found { wanted, sources }
}

impl Found {
    /// The values, and why others mean nothing. `image`: where the names were looked up.
    pub(super) fn of(self, cpu: &Cpu, image: &Arc<ProgramImage>) -> (Watched, Vec<(usize, String)>) {
        if !Arc::ptr_eq(image, &cpu.image) {
            // The program has changed meanwhile.
            return find(&cpu.image, self.wanted).of(cpu, &cpu.image);
        }
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for (number, source) in self.sources.into_iter().enumerate() {
            match source.and_then(|found| found.0.check(cpu).map(|()| found)) {
                Ok((source, format)) => found.push((number, source, format)),
                Err(error) => wrong.push((number, error)),
            }
        }
        (Watched { wanted: self.wanted, generation: cpu.generation(), found: found.into() }, wrong)
    }
}

pub(super) fn source_in(image: &ProgramImage, name: &str) -> Result<Source, String> {
    if name.len() > NAME_MAX {
        return Err(format!("a name has at most {NAME_MAX} letters"));
    }
    Source::find(name, image, None)
}

pub(in crate::web) fn source(cpu: &Cpu, name: &str) -> Result<Source, String> {
    let source = source_in(&cpu.image, name)?;
    source.check(cpu)?;
    Ok(source)
}

/// A value in the format of its row, or why there is none at present.
pub(super) fn shown(family: Family, source: &Source, format: Option<Format>, value: &Result<Value, String>) -> Shown {
    let bits = match source {
        Source::Bits(address) => address.width.bits(),
        Source::Typed(address, ty) if typed::bits(ty.ty).is_some() => address.width.bits(),
        Source::Typed(..)
        | Source::Channel(..)
        | Source::Plant(_)
        | Source::PulseDuty(_)
        | Source::PulsePeriod(_)
        | Source::PulseCount(_) => 0,
    };
    let (value, text) = match (format, value) {
        (_, Err(why)) => (serde_json::Value::Null, format!("({why})")),
        // The value stays what the type says: curves and drawings are of that.
        (Some(format), Ok(value @ Value::Bits(raw, width))) => {
            let typed = match source {
                Source::Typed(_, ty) => Value::of_type(ty.ty, *raw),
                _ => value.clone(),
            };
            let text = match source.address() {
                Some(address) => format.show_at(*raw, address),
                None => format.show(*raw, *width),
            };
            (typed.json(), text)
        }
        (_, Ok(value)) => (value.json(), value.text()),
    };
    let forcible = source.address().is_some_and(|address| force::is_forced_area(address.place, family));
    Shown { value: exact(value), text, ty: source.ty(), bits, forcible }
}

/// Numbers of the names that have forced bits.
pub(super) fn marks(image: &ProgramImage, watched: &Watched, forced: Option<&[force::Forced]>) -> Vec<usize> {
    let Some(forced) = forced.filter(|forced| !forced.is_empty()) else { return Vec::new() };
    let modules = image.profile.family != Family::S7300;
    let is_forced =
        |source: &Source| source.address().is_some_and(|address| forced.iter().any(|one| one.covers(address, modules)));
    watched.found.iter().filter(|(_, source, _)| is_forced(source)).map(|(number, ..)| *number).collect()
}

#[cfg(test)]
mod tests {
    use plcc_runtime::address;

    use super::*;

    #[test]
    fn a_value_that_is_not_there_is_not_0() {
        let source = Source::Bits(address::parse("DB9.DBW0").expect("an address"));
        let why = "DB 9 is not loaded".to_string();
        let missing = shown(Family::S7300, &source, Some(Format::Dec), &Err(why));
        assert_eq!((missing.value, missing.text.as_str()), (serde_json::Value::Null, "(DB 9 is not loaded)"));
        let there = shown(Family::S7300, &source, None, &Ok(Value::Bits(5, address::Width::Word)));
        assert_eq!(there.text, "16#0005");
    }
}
