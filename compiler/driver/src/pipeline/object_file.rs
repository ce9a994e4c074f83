//! The object file of a program, with code from the cache where nothing has changed.

use plcc_abi::image::ProgramImage;
use plcc_abi::linked;
use plcc_codegen::{CodegenError, Finishing};
use plcc_ir::{Function, Module};
use plcc_opt::{Usage, Without};

use super::{Compiled, Optimization};
use crate::cache::{Cache, Keys};
use crate::cli::{CpuFeatures, Level};
use crate::{memory, variables};

/// The object file of a program that is lowered, and not optimised or only begun. At -O2 the code of unchanged functions comes from `cache`, which keeps
/// the code that it did not have.
pub fn object(compiled: Compiled, cache: Option<&Cache>) -> Result<Vec<u8>, CodegenError> {
    let (finished, _) = object_of(linked::SYMBOL, compiled, Beside::Nothing, cache)?;
    Ok(finished)
}

/// The objects of a program and of its code with probes, with the directory that leads to both; see [`lower_beside`](super::lower_beside).
pub fn objects(plain: Compiled, probed: Compiled, caches: [Option<&Cache>; 2]) -> Result<[Vec<u8>; 3], CodegenError> {
    const NAMES: [&str; 2] = ["plcc_plain", "plcc_probed"];
    let (second, image) = object_of(NAMES[1], probed, Beside::Plain, caches[1])?;
    let (first, _) = object_of(NAMES[0], plain, Beside::Probed(&image), caches[0])?;
    Ok([first, second, plcc_codegen::directory_object(&NAMES)?])
}

/// Other code of the same program that an object file shares an executable with.
enum Beside<'a> {
    Nothing,
    /// The code without probes, which has the image and the variables.
    Plain,
    /// The code with probes, which has this image.
    Probed(&'a ProgramImage),
}

/// An object file that exports `name`, and the image of its program.
fn object_of(
    name: &str,
    mut compiled: Compiled,
    beside: Beside<'_>,
    cache: Option<&Cache>,
) -> Result<(Vec<u8>, ProgramImage), CodegenError> {
    let Optimization { level, without, cpu_features } = compiled.optimization;
    match (level, compiled.begun) {
        (Level::O0, _) => {}
        (Level::O2, false) => plcc_opt::optimize_together(&mut compiled.module, without),
        (Level::O2, true) => plcc_opt::optimize_begun_together(&mut compiled.module, without),
    }
    let options = compiled.codegen_options();
    let reached = compiled.reached();
    let Compiled { mut module, image, optimization, begun } = compiled;
    let surroundings = plcc_opt::Surroundings::new(&module);
    // Keys are made of canonical functions, which the passes leave, and do not name the processor of this computer.
    let is_kept = level == Level::O2 && without == Without::NOTHING && cpu_features == CpuFeatures::Baseline;
    let cache = cache.filter(|_| is_kept && Keys::is_worth_while(&module));
    let keys = cache.map(|_| Keys::new(&module, &surroundings, &options));
    let old = cache.map(Cache::read);
    let kept = |id, function: &Function| old.as_ref()?.get(keys.as_ref()?.key(id, function));
    let finish = |function: &mut Function| {
        if level == Level::O2 {
            plcc_opt::optimize_alone(function, &surroundings, without);
        }
        usage_as_note(plcc_opt::usage_of(function, &surroundings))
    };
    let finishing = Finishing { kept: &kept, finish: &finish, keep: cache.is_some() };
    let (entries, size) = (module.entries.clone(), memory::size(&module));
    let finished = plcc_codegen::finish(&mut module, &options, &finishing)?;
    memory::give_back(size);
    let usage: Vec<Usage> = finished.notes.iter().copied().map(usage_of_note).collect();
    let entries = Module { entries, ..Module::default() };
    let mut compiled = Compiled { module: entries, image, optimization, begun }.with_usage(&usage, &reached);
    let variables = match beside {
        Beside::Nothing => Some(variables::of(&compiled.image)),
        Beside::Plain => None,
        Beside::Probed(probed) => {
            compiled.share_image(probed);
            Some(variables::of(&compiled.image))
        }
    };
    let object = finished.object_as(name, &compiled.image_bytes(), variables.as_ref())?;
    if let (Some(cache), Some(old), Some(keys)) = (cache, &old, &keys) {
        cache.write(old, keys, &finished.made);
    }
    Ok((object, compiled.image))
}

/// What a function uses, in one number. Frames are shorter than what a number has room for.
fn usage_as_note(usage: Usage) -> u64 {
    let local_data = usage.local_data.min(NO_LOCAL_DATA);
    u64::from(usage.outputs) | u64::from(usage.logic_only) << 32 | u64::from(local_data) << 33
}

fn usage_of_note(note: u64) -> Usage {
    let local_data = Some((note >> 33) as u32).filter(|&first| first != NO_LOCAL_DATA).unwrap_or(u32::MAX);
    Usage { outputs: note as u32, logic_only: note >> 32 & 1 != 0, local_data }
}

/// In a note: no local data are read.
const NO_LOCAL_DATA: u32 = u32::MAX >> 1;
