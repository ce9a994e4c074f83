//! Charts whose steps or transitions change: a chart goes on at its active steps if the new program has all of them.
//!
//! Steps and transitions are the same by name, and by number where they are elements of arrays (`G7S`, `G7T`). The lists of the engine
//! count steps by position, so they are made again. Whether it is possible is known at the change only, when it is known which steps are active.
//!
//! Source: GRAPH reference, chapter F, for the data; that a chart goes on is an extension, since STEP 7 begins it again.

use plcc_abi::names::{NamedMember, NamedStruct, NamedType, TypeNumber};

use super::pairs::{Move, Pairs, Side, is_same};
use super::takeover::take_moves;
use crate::memory::Memory;

/// Structure around the data of the engine in the TIA Portal.
const TIA_DATA: &str = "RT_DATA";
/// What the engine keeps of the chart as a whole.
const WHOLE: [&str; 3] = ["MOPEDGE", "MOP", "SQ_FLAGS"];
/// Structure of what only plcc keeps.
const OWN_DATA: &str = "G7_DATA";
/// Lists of positions: steps that are active, were left and were entered.
const LISTS: [&str; 3] = ["SAX", "S0X", "S1X"];
/// Requests, a bit for each position.
const REQUESTS: [&str; 2] = ["ASKED_ON", "ASKED_OFF"];
/// The active steps as a set, in words of 64 bits.
const SET: &str = "ACTIVE";
/// The step that is shown: its number, its position from 1, and whether a user has chosen it.
const SHOWN: [&str; 3] = ["SHOWN", "SHOWN_AT", "PAGED"];
/// Names that a message lists.
const NAMES_MAX: usize = 5;

/// A step or a transition.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Its name, or `step 3` where only the number says which it is.
    name: String,
    number: u16,
    is_step: bool,
    /// In bits from the beginning of the block.
    place: u64,
    /// Of the number, in bytes from the beginning of its structure.
    number_at: u32,
    ty: TypeNumber,
}

impl Part {
    fn is_same(&self, other: &Part) -> bool {
        self.is_step == other.is_step && is_same(&self.name, &other.name)
    }
}

/// The number in the data of a step or a transition; `None` for other types.
fn number_of<'s>(side: &Side<'s>, ty: TypeNumber) -> Option<&'s NamedMember> {
    match side.ty(ty)? {
        NamedType::Struct(inner) => inner.members.iter().find(|member| matches!(member.name.as_str(), "SNO" | "TNO")),
        _ => None,
    }
}

/// The steps and transitions of a chart in the order by which its data counts them; empty for anything else.
pub(super) fn parts(side: &Side<'_>, structure: &NamedStruct, start: u64) -> Vec<Part> {
    let number_of = |ty: TypeNumber| number_of(side, ty);
    let part = |name: Option<&str>, ty: TypeNumber, number: &NamedMember, place: u64| {
        let is_step = number.name == "SNO";
        let value = side.word(place + 8 * u64::from(number.byte));
        let name = match name {
            Some(name) => name.to_string(),
            None => format!("{} {value}", if is_step { "step" } else { "transition" }),
        };
        Part { name, number: value, is_step, place, number_at: number.byte, ty }
    };
    let mut all = Vec::new();
    for member in &structure.members {
        let at = start + 8 * u64::from(member.byte);
        if let Some(number) = number_of(member.ty) {
            all.push(part(Some(&member.name), member.ty, number, at));
        } else if let Some(NamedType::Array { dimensions, element }) = side.ty(member.ty)
            && let ([dimension], Some(number)) = (dimensions.as_slice(), number_of(*element))
        {
            for index in 0..=dimension.high.saturating_sub(dimension.low).max(0) as u64 {
                all.push(part(None, *element, number, at + index * u64::from(dimension.distance)));
            }
        }
    }
    all
}

/// Whether two charts have the same steps and transitions with the same numbers in the same order.
pub(super) fn are_same(old: &[Part], new: &[Part]) -> bool {
    old.len() == new.len() && old.iter().zip(new).all(|(a, b)| a.number == b.number && a.is_same(b))
}

/// Whether a member of the instance belongs to the chart and not to the declarations of the block, which may have the names of the engine
/// where that has a structure of its own.
pub(super) fn is_of_chart(side: &Side<'_>, structure: &NamedStruct, one: &NamedMember) -> bool {
    let name = one.name.to_ascii_uppercase();
    let is_engine = match member(structure, TIA_DATA) {
        Some(_) => name == TIA_DATA,
        None => LISTS.contains(&name.as_str()) || WHOLE.contains(&name.as_str()) || name == OWN_DATA,
    };
    is_engine || matches!(name.as_str(), "G7S" | "G7T") || number_of(side, one.ty).is_some()
}

/// A place in both programs, in bytes from the beginning of memory.
#[derive(Clone, Copy, Debug)]
struct Both {
    old: u32,
    new: u32,
}

/// What is necessary for a chart to go on.
#[derive(Debug)]
pub(super) struct Chart {
    path: String,
    /// The names of the old steps, and their positions in the new chart.
    steps: Vec<(String, Option<u8>)>,
    new_steps: u8,
    /// Data that goes from one place to another.
    moves: Vec<Move>,
    /// Numbers of the new steps in their order, then of the transitions: place and value.
    numbers: Vec<(u32, u16)>,
    lists: [Both; 3],
    requests: [Both; 2],
    set: Both,
    /// Number and position of the step that is shown.
    shown: [Both; 2],
    /// The bit which says that a user has chosen it.
    paged: (u32, u8),
}

/// Compares two charts with other steps or transitions. Adds what a user must know to the items of `pairs`.
pub(super) fn compare(
    pairs: &mut Pairs<'_>,
    (a, b): (&NamedStruct, &NamedStruct),
    (old_start, new_start): (u64, u64),
    path: &str,
) {
    let (old, new) = (parts(&pairs.old, a, old_start), parts(&pairs.new, b, new_start));
    let names = |of: &[Part], other: &[Part], steps: bool| -> Vec<String> {
        let missing = |part: &&Part| part.is_step == steps && !other.iter().any(|one| one.is_same(part));
        of.iter().filter(missing).map(|part| part.name.clone()).collect()
    };
    let gone = names(&old, &new, true);
    let mut text = format!("{path}: the chart has other steps or transitions");
    for (what, list) in [
        ("new", [names(&new, &old, true), names(&new, &old, false)].concat()),
        ("gone", [gone.clone(), names(&old, &new, false)].concat()),
    ] {
        if !list.is_empty() {
            text += &format!(", {what}: {}", listed(&list));
        }
    }
    let kept = std::mem::take(&mut pairs.moves);
    let chart = chart(pairs, (a, &old, old_start), (b, &new, new_start), path);
    pairs.moves = kept;
    let begins = "it begins at its initial step, and what its active steps have switched on stays on: switch the chart off \
                  before (OFF_SQ) if it must not";
    text += &match (&chart, gone.len()) {
        (None, _) => format!("; {begins}"),
        (Some(_), 0) => "; it goes on at its active steps".to_string(),
        (Some(_), 1) => format!("; it goes on at its active steps; if {} is one of them, {begins}", gone[0]),
        (Some(_), _) => format!("; it goes on at its active steps; if one of them is gone, {begins}"),
    };
    pairs.item(text, chart.is_none() || !gone.is_empty());
    pairs.charts.extend(chart);
}

/// `a, b and 3 more`.
fn listed(names: &[String]) -> String {
    let shown = names[..names.len().min(NAMES_MAX)].join(", ");
    if names.len() > NAMES_MAX { format!("{shown} and {} more", names.len() - NAMES_MAX) } else { shown }
}

/// `None` if the data of a chart is not where a chart of this version of plcc has it, or of another kind.
fn chart(
    pairs: &mut Pairs<'_>,
    (a, old, old_start): (&NamedStruct, &[Part], u64),
    (b, new, new_start): (&NamedStruct, &[Part], u64),
    path: &str,
) -> Option<Chart> {
    let data = if member(b, TIA_DATA).is_some() { TIA_DATA } else { "" };
    let both = |pairs: &Pairs<'_>, names: &[&'static str]| {
        let names = path_in(data, names);
        let (old, _) = find(&pairs.old, a, old_start, &names)?;
        let (new, _) = find(&pairs.new, b, new_start, &names)?;
        Some((old, new))
    };
    let bytes = |pairs: &Pairs<'_>, names: &[&'static str]| {
        let (old, new) = both(pairs, names)?;
        Some(Both { old: ((pairs.old.base() + old) / 8) as u32, new: ((pairs.new.base() + new) / 8) as u32 })
    };
    let own = |pairs: &Pairs<'_>, name: &'static str| bytes(pairs, &[OWN_DATA, name]);
    let lists = [bytes(pairs, &[LISTS[0]])?, bytes(pairs, &[LISTS[1]])?, bytes(pairs, &[LISTS[2]])?];
    let requests = [own(pairs, REQUESTS[0])?, own(pairs, REQUESTS[1])?];
    let (set, shown) = (own(pairs, SET)?, [own(pairs, SHOWN[0])?, own(pairs, SHOWN[1])?]);
    let (_, paged) = both(pairs, &[OWN_DATA, SHOWN[2]])?;
    let paged = pairs.new.base() + paged;
    let new_positions: Vec<&Part> = new.iter().filter(|part| part.is_step).collect();
    let position = |part: &Part| {
        let at = new_positions.iter().position(|one| one.is_same(part))?;
        u8::try_from(at).ok()
    };
    let steps = old.iter().filter(|part| part.is_step).map(|part| (part.name.clone(), position(part))).collect();
    // A list has a byte more than there are steps. A variable of the type of a step is not one of them.
    let new_steps = u8::try_from(new_positions.len()).ok().filter(|count| *count < u8::MAX)?;
    let old_steps = old.iter().filter(|part| part.is_step).count();
    let requested = path_in(data, &[OWN_DATA, REQUESTS[0]]);
    let has = |side: &Side<'_>, of: &NamedStruct, steps: usize| match side.ty(find(side, of, 0, &requested)?.1)? {
        NamedType::Array { dimensions, .. } => Some(dimensions.first()?.high == i32::try_from(steps).ok()?),
        _ => None,
    };
    if !has(&pairs.old, a, old_steps)? || !has(&pairs.new, b, new_positions.len())? {
        return None;
    }
    let mut numbers = Vec::new();
    for part in new_positions.iter().copied().chain(new.iter().filter(|part| !part.is_step)) {
        let number = pairs.new.base() / 8 + part.place / 8 + u64::from(part.number_at);
        numbers.push((number as u32, part.number));
        if let Some(other) = old.iter().find(|other| other.is_same(part)) {
            let name = format!("{path}.{}", part.name);
            pairs.pair_at(other.ty, part.ty, &name, (other.place, part.place));
        }
    }
    // What the engine keeps of the chart as a whole; what counts by positions is made again.
    let own_data = find(&pairs.new, b, new_start, &path_in(data, &[OWN_DATA]))?;
    let own_data: Vec<String> = match pairs.new.ty(own_data.1)? {
        NamedType::Struct(own_data) => own_data.members.iter().map(|member| member.name.clone()).collect(),
        _ => return None,
    };
    let mut kept: Vec<Vec<&str>> = WHOLE.map(|name| path_in(data, &[name])).to_vec();
    let counted = |name: &str| REQUESTS.contains(&name) || name == SET;
    let names = own_data.iter().map(String::as_str).filter(|name| !counted(name));
    kept.extend(names.map(|name| path_in(data, &[OWN_DATA, name])));
    for names in kept {
        let (from, was) = find(&pairs.old, a, old_start, &names)?;
        let (to, is) = find(&pairs.new, b, new_start, &names)?;
        pairs.pair_at(was, is, path, (from, to));
    }
    Some(Chart {
        path: path.to_string(),
        steps,
        new_steps,
        moves: std::mem::take(&mut pairs.moves),
        numbers,
        lists,
        requests,
        set,
        shown,
        paged: ((paged / 8) as u32, (paged % 8) as u8),
    })
}

/// Without the structure of the TIA Portal if there is none.
fn path_in<'n>(data: &'n str, names: &[&'n str]) -> Vec<&'n str> {
    [data].iter().chain(names).copied().filter(|name| !name.is_empty()).collect()
}

fn member<'s>(structure: &'s NamedStruct, name: &str) -> Option<&'s NamedMember> {
    structure.members.iter().find(|member| member.name.eq_ignore_ascii_case(name))
}

/// The place of a member, in bits, if its structure begins at `start`.
pub(super) fn at(start: u64, member: &NamedMember) -> u64 {
    start + 8 * u64::from(member.byte) + u64::from(member.bit)
}

/// The place of a member and its type, in bits from the beginning of the block.
fn find(side: &Side<'_>, structure: &NamedStruct, start: u64, names: &[&str]) -> Option<(u64, TypeNumber)> {
    let (first, rest) = names.split_first()?;
    let found = member(structure, first)?;
    match (rest, side.ty(found.ty)) {
        ([], _) => Some((at(start, found), found.ty)),
        (_, Some(NamedType::Struct(inner))) => find(side, inner, at(start, found), rest),
        _ => None,
    }
}

impl Chart {
    /// Has the chart go on in the new memory, which has initial values. Result: why it does not.
    pub(super) fn take(&self, from: &Memory, to: &Memory) -> Option<String> {
        let list = |place: Both| -> Vec<u8> {
            let length = usize::from(from.byte(place.old).saturating_sub(1)).min(self.steps.len());
            (1..=length as u32).map(|entry| from.byte(place.old + entry)).collect()
        };
        let step = |position: u8| self.steps.get(usize::from(position).checked_sub(1)?);
        let active = list(self.lists[0]);
        let is_gone = |position: &&u8| !matches!(step(**position), Some((_, Some(_))));
        if let Some(position) = active.iter().find(is_gone) {
            let name = step(*position).map_or("a step", |(name, _)| name.as_str());
            return Some(format!("{}: {name} was active and is gone; the chart begins at its initial step", self.path));
        }
        take_moves(from, to, &self.moves);
        for &(place, number) in &self.numbers {
            to.set_word(place, number);
        }
        for place in self.lists {
            let positions = list(place).into_iter().filter_map(|position| Some(step(position)?.1? + 1));
            let positions: Vec<u8> = positions.take(self.new_steps.into()).collect();
            to.set_byte(place.new, positions.len() as u8 + 1);
            to.load(place.new + 1, &positions);
            to.set_byte(place.new + 1 + positions.len() as u32, 0);
        }
        for (old, (_, new)) in (0u32..).zip(&self.steps) {
            let Some(new) = new.map(u32::from) else { continue };
            for place in self.requests {
                let is_requested = from.bit(place.old + old / 8, (old % 8) as u8);
                to.set_bit(place.new + new / 8, (new % 8) as u8, is_requested);
            }
            // A word of the set is a number with the highest byte first.
            let byte = |position: u32| position / 64 * 8 + 7 - position % 64 / 8;
            let is_active = from.bit(self.set.old + byte(old), (old % 8) as u8);
            to.set_bit(self.set.new + byte(new), (new % 8) as u8, is_active);
        }
        self.show(from, to);
        None
    }

    /// The step that is shown; if it is gone, the engine chooses one in the next call.
    fn show(&self, from: &Memory, to: &Memory) {
        let [number, position] = self.shown;
        let shown = from.word(position.old).checked_sub(1).and_then(|at| self.steps.get(usize::from(at)));
        if let Some((_, Some(new))) = shown {
            to.set_word(position.new, u16::from(*new) + 1);
            to.set_word(number.new, self.numbers.get(usize::from(*new)).map_or(0, |(_, number)| *number));
        } else {
            to.set_word(position.new, 0);
            to.set_word(number.new, 0);
            to.set_bit(self.paged.0, self.paged.1, false);
        }
    }
}
