//! What is known about memory: ranges of bits that hold a value, or 0.

use std::rc::Rc;

use plcc_ir::{Function, Region, RuntimeFn, Value};
use rustc_hash::FxHashMap;

use crate::effects::Effects;
use crate::extents::{Access, Extent, Extents};

/// Ranges that are known for one base; more are forgotten.
const RANGES_MAX: usize = 256;
/// Regions with their bases.
const BASES_MAX: usize = 64;

/// The content of a range of memory.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    /// A part of the value that was in `start..end`: the rest may have been written since.
    Value {
        value: Value,
        start: u64,
        end: u64,
        /// It was stored, not loaded.
        stored: bool,
    },
    /// All bits are 0.
    Zero,
}

/// Where the content comes from makes no difference.
impl PartialEq for Content {
    fn eq(&self, other: &Content) -> bool {
        match (self, other) {
            (
                Content::Value { value, start, end, .. },
                Content::Value { value: other, start: other_start, end: other_end, .. },
            ) => (value, start, end) == (other, other_start, other_end),
            (Content::Zero, Content::Zero) => true,
            (Content::Value { .. }, Content::Zero) | (Content::Zero, Content::Value { .. }) => false,
        }
    }
}

/// The facts from each base of a region. What blocks have in common is shared until one of them changes it.
type Bases = Rc<Vec<(Option<Value>, Rc<Extents<Content>>)>>;

/// The facts about memory.
#[derive(Clone, Default)]
pub(super) struct Memory {
    pub(super) regions: FxHashMap<Region, Bases>,
    /// Entries of the DB table: (number, whether it is the length, value).
    pub(super) dbs: Vec<(Value, bool, Value)>,
}

impl Memory {
    pub(super) fn bound(&mut self) {
        if self.regions.values().map(|bases| bases.len()).sum::<usize>() > BASES_MAX {
            self.regions.clear();
        }
    }

    /// The facts about the function's own frame.
    pub(super) fn frame(&self) -> Memory {
        let mut frame = Memory::default();
        if let Some(bases) = self.regions.get(&Region::L) {
            frame.regions.insert(Region::L, bases.clone());
        }
        frame
    }

    pub(super) fn find(&self, access: &Access) -> Option<&Extents<Content>> {
        let bases = self.regions.get(&access.region)?;
        bases.iter().find(|(base, _)| *base == access.base).map(|(_, extents)| &**extents)
    }

    /// Records the value that an access has read or written, for those parts that nothing is known about.
    pub(super) fn learn(&mut self, access: &Access, value: Value, stored: bool) {
        self.fill(access, Content::Value { value, start: access.start, end: access.end, stored });
    }

    pub(super) fn fill(&mut self, access: &Access, content: Content) {
        let bases = Rc::make_mut(self.regions.entry(access.region).or_default());
        let index = match bases.iter().position(|(base, _)| *base == access.base) {
            Some(index) => index,
            None => {
                if bases.len() >= BASES_MAX {
                    bases.clear();
                }
                bases.push((access.base, Rc::default()));
                bases.len() - 1
            }
        };
        let extents = Rc::make_mut(&mut bases[index].1);
        if extents.len() >= RANGES_MAX {
            extents.clear();
        }
        extents.fill(access.start, access.end, content);
    }

    /// The bytes of `from` are copied to `to`: what was known of them is known of the copy.
    pub(super) fn copy(&mut self, to: &Access, from: &Access) {
        let known = self.find(from).filter(|_| !to.region.is_host_order() && !from.region.is_host_order());
        // A value that began before what is copied may begin before all of the memory that `to` is in.
        let moved = |at: u64| (at + to.start).checked_sub(from.start);
        let of_copy = |item: &Extent<Content>| {
            let known = match item.known {
                Content::Value { value, start, end, .. } => {
                    Content::Value { value, start: moved(start)?, end: moved(end)?, stored: true }
                }
                Content::Zero => Content::Zero,
            };
            let (start, end) = (item.start.max(from.start), item.end.min(from.end));
            Some(Extent { start: moved(start)?, end: moved(end)?, known })
        };
        let copied: Vec<Extent<Content>> =
            known.map(|known| known.iter_in(from.start, from.end).filter_map(of_copy).collect()).unwrap_or_default();
        self.forget(to);
        for Extent { start, end, known } in copied {
            self.fill(&Access { start, end, ..*to }, known);
        }
    }

    /// Forgets the facts that a write to `access` may change.
    pub(super) fn forget(&mut self, access: &Access) {
        match access.region {
            Region::State
            | Region::I
            | Region::Q
            | Region::M
            | Region::System
            | Region::Cells
            | Region::L
            | Region::V => {
                self.forget_in(access.region, access);
            }
            Region::Db(_) => {
                self.forget_in(access.region, access);
                self.regions.remove(&Region::AnyDb);
            }
            Region::AnyDb => {
                self.forget_in(access.region, access);
                self.regions.retain(|&region, _| region == Region::AnyDb || !region.may_alias(Region::AnyDb));
            }
            Region::Any => {
                self.forget_in(access.region, access);
                self.regions.retain(|&region, _| region == Region::Any || !region.may_alias(Region::Any));
            }
        }
        if access.region != Region::Any && access.region.may_alias(Region::Any) {
            self.regions.remove(&Region::Any);
        }
    }

    /// Forgets in one region: what overlaps from the same base, everything from others.
    fn forget_in(&mut self, region: Region, access: &Access) {
        let Some(bases) = self.regions.get_mut(&region) else { return };
        let is_touched = |(base, extents): &(Option<Value>, Rc<Extents<Content>>)| {
            *base != access.base || extents.overlaps(access.start, access.end)
        };
        if !bases.iter().any(is_touched) {
            return;
        }
        let bases = Rc::make_mut(bases);
        bases.retain(|(base, _)| *base == access.base);
        for (_, extents) in bases {
            if extents.overlaps(access.start, access.end) {
                Rc::make_mut(extents).cut(access.start, access.end);
            }
        }
    }

    /// Forgets everything but, perhaps, the own frame. Frames of inlined functions after it are overwritten.
    pub(super) fn forget_all(&mut self, keep_frame: bool, function: &Function) {
        // A new table: one that was large once would be walked from end to end at each call.
        let frame = self.regions.remove(&Region::L).filter(|_| keep_frame);
        self.regions = frame.map(|bases| (Region::L, bases)).into_iter().collect();
        self.dbs.clear();
        let Some(bases) = self.regions.get_mut(&Region::L) else { return };
        if function.inlined_bytes == 0 {
            return;
        }
        let bases = Rc::make_mut(bases);
        bases.retain(|(base, _)| base.is_none());
        let (start, end) = (u64::from(function.frame_bytes) * 8, u64::from(function.local_bytes()) * 8);
        for (_, extents) in bases {
            if extents.overlaps(start, end) {
                Rc::make_mut(extents).cut(start, end);
            }
        }
    }

    /// Forgets what organization blocks may have changed that ran at a safepoint or an error. They have their own local data.
    pub(super) fn interrupt(&mut self, function: RuntimeFn, effects: &Effects, keep_frame: bool) {
        self.regions.retain(|&region, _| {
            region == Region::System || region == Region::L && keep_frame || !effects.may_write(function, region, None)
        });
        self.forget_system(function, effects);
        if effects.interruption_changes_dbs() {
            self.dbs.clear();
        }
    }

    /// Forgets what a runtime function may change in the system area.
    pub(super) fn forget_system(&mut self, function: RuntimeFn, effects: &Effects) {
        let Some(bases) = self.regions.get_mut(&Region::System) else { return };
        Rc::make_mut(bases).retain_mut(|(base, extents)| {
            let is_kept = |start, end| !effects.may_write(function, Region::System, Some((start, end)));
            if base.is_none() && extents.iter().any(|item| is_kept(item.start, item.end)) {
                Rc::make_mut(extents).retain(|item| is_kept(item.start, item.end));
                true
            } else {
                false
            }
        });
    }

    pub(super) fn intersect(&mut self, other: &Memory) {
        self.regions.retain(|region, bases| {
            let Some(others) = other.regions.get(region) else { return false };
            if Rc::ptr_eq(bases, others) && bases.iter().all(|(_, extents)| !extents.is_empty()) {
                return !bases.is_empty();
            }
            let bases = Rc::make_mut(bases);
            bases.retain_mut(|(base, extents)| {
                let Some((_, other)) = others.iter().find(|(other_base, _)| other_base == base) else { return false };
                if !Rc::ptr_eq(extents, other) {
                    Rc::make_mut(extents).intersect(other);
                }
                !extents.is_empty()
            });
            !bases.is_empty()
        });
        self.dbs.retain(|entry| other.dbs.contains(entry));
    }
}
