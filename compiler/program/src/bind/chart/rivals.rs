//! Which steps use what the code of others writes.

use std::ops::Range;

use plcc_syntax::Elementary;
use rustc_hash::FxHashMap;

use super::alone::IsShared;
use super::assemble::Parts;
use super::engine_data::Engine;
use plcc_model::Place;
use plcc_model::layout;
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Base, Statement, StatementKind};
use plcc_model::types::DataType;

/// Steps whose code uses the same memory, as sets.
#[derive(Clone, Copy, Default)]
struct Users {
    /// Their actions write it, or read it.
    act: u64,
    look: u64,
    /// What they do when they are left writes it.
    leave: u64,
    /// Their conditions, or what they do when they are left, read it.
    depend: u64,
}

/// Code of a step.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Code {
    Actions,
    Leaving,
    Conditions,
}

/// Collects which bits of memory the code of steps uses.
pub struct Uses<'a> {
    /// The step whose code is looked at, as a set; which code; where its own data and the modes are in the instance.
    step: u64,
    code: Code,
    own: [Range<u32>; 2],
    /// The target of the assignment that is looked at.
    target: Option<*const Access>,
    users: FxHashMap<(u32, u32), Users>,
    /// Steps that write the instance, and those that read one by its number, which may be the same one.
    writers: u64,
    readers: u64,
    /// Actions read data that the chart keeps about something else.
    pub sees_others: bool,
    begin: u32,
    is_shared: &'a IsShared<'a>,
}

impl<'a> Uses<'a> {
    /// Looks at the code of all steps, and at the conditions of all transitions.
    pub fn of(engine: &Engine, parts: &Parts, is_shared: &'a IsShared<'a>) -> Uses<'a> {
        let mut uses = Uses {
            step: 0,
            code: Code::Actions,
            own: [0..0, 0..0],
            target: None,
            users: FxHashMap::default(),
            writers: 0,
            readers: 0,
            sees_others: false,
            begin: engine.data_begin(),
            is_shared,
        };
        for (step, code) in parts.codes.iter().enumerate() {
            uses.step = 1 << step;
            uses.own = [engine.bytes_of_step(step), engine.bytes_of("MOP")];
            uses.code = Code::Actions;
            walk::statements(&code.active, &mut uses);
            uses.code = Code::Leaving;
            walk::statements(&code.leave, &mut uses);
        }
        uses.code = Code::Conditions;
        for ((before, value), from) in parts.conditions.iter().zip(&parts.from) {
            // Its first step evaluates a transition.
            uses.step = from.iter().min().map_or(0, |step| 1 << step);
            walk::statements(before, &mut uses);
            walk::expr(value, &mut uses);
        }
        uses
    }

    /// True if no actions of a step read what they write.
    pub fn can_be_repeated(&self) -> bool {
        self.users.values().all(|users| users.act & users.look == 0) && self.writers & self.readers == 0
    }

    /// For each step the steps that use what its actions write, or whose actions write what it uses.
    pub fn rivals(&self, steps: usize) -> Vec<u64> {
        let of_step = |step: usize| {
            let own = 1 << step;
            let of = |users: &Users| {
                let mut rivals = 0;
                let all = users.act | users.look | users.leave | users.depend;
                for (one, other) in
                    [(users.act, all), (all, users.act), (users.look, users.leave), (users.leave, users.look)]
                {
                    rivals |= if one & own != 0 { other } else { 0 };
                }
                rivals
            };
            let in_memory =
                self.users.values().filter(|users| users.act | users.leave != 0).fold(0, |set, users| set | of(users));
            let mut in_instances = 0;
            for (one, other) in [(self.writers, self.readers), (self.readers, self.writers)] {
                in_instances |= if one & own != 0 { other } else { 0 };
            }
            (in_memory | in_instances) & !own
        };
        (0..steps).map(of_step).collect()
    }

    /// For each step whether what it does when it is left uses what another one writes then, or the other way round.
    pub fn leave_together(&self, steps: usize) -> Vec<bool> {
        let of_step = |step: usize| {
            let own = 1u64 << step;
            self.users.values().any(|users| {
                users.leave & own != 0 && (users.leave | users.depend) & !own != 0
                    || users.depend & own != 0 && users.leave & !own != 0
            })
        };
        (0..steps).map(of_step).collect()
    }
}

impl Visitor for Uses<'_> {
    fn statement(&mut self, statement: &Statement) {
        self.target = match &statement.kind {
            StatementKind::Assign { target, .. } => Some(std::ptr::from_ref(target)),
            _ => None,
        };
    }

    fn access(&mut self, access: &Access, _: Role) {
        let writes = self.target == Some(std::ptr::from_ref(access));
        let Base::Place(place) = &access.base else { return };
        let (area, byte, bit) = match *place {
            Place::I { byte, bit } => (0, byte, bit),
            Place::Q { byte, bit } => (1, byte, bit),
            Place::M { byte, bit } => (2, byte, bit),
            Place::L { byte, bit } => (3, byte, bit),
            Place::Instance { byte, bit } => {
                if writes {
                    self.writers |= self.step;
                } else if self.code == Code::Actions && byte >= self.begin {
                    self.sees_others |= !self.own.iter().any(|own| own.contains(&byte));
                }
                (4, byte, bit)
            }
            Place::Db { number, byte, bit } => {
                if (self.is_shared)(number) != Some(true) {
                    self.readers |= self.step;
                    self.sees_others |= self.code == Code::Actions;
                }
                (8 + u32::from(number), byte, bit)
            }
            _ => return,
        };
        let length = match access.ty {
            DataType::Elementary(Elementary::Bool) => 1,
            _ => 8 * layout::bytes(&access.ty),
        };
        let first = 8 * byte + u32::from(bit);
        for bit in first..first.saturating_add(length) {
            let users = self.users.entry((area, bit)).or_default();
            let set = match (self.code, writes) {
                (Code::Actions, true) => &mut users.act,
                (Code::Actions, false) => &mut users.look,
                (Code::Leaving, true) => &mut users.leave,
                (Code::Leaving | Code::Conditions, _) => &mut users.depend,
            };
            *set |= self.step;
        }
    }
}
