//! Keeps what the probes of watched calls tell.

use plcc_abi::monitor::{BlockProbes, Tells};

use super::history::History;
use super::{Call, Monitor, Recorded, Seen, Watch, is_root, steps, text_of};
use crate::cpu::Cpu;
use crate::probe::Registers;

/// Ways to a block that are told apart; others are not listed.
pub const CALLS_MAX: usize = 100;

impl Watch {
    pub(super) fn new(client: u64, block: Option<usize>, call: Option<&str>) -> Watch {
        Watch {
            client,
            block,
            wanted: call.map(str::to_string),
            calls: Vec::new(),
            inside: Vec::new(),
            depth: 0,
            now: Recorded::default(),
            done: None,
        }
    }

    /// Its block begins; `running` are the blocks that run.
    fn enter(&mut self, cpu: &Cpu, running: &[(u32, u32)], block: &BlockProbes) {
        if self.depth != 0 {
            return;
        }
        let instance = running.last().map_or(0, |(_, instance)| *instance);
        let same = |call: &Call| {
            call.instance == instance
                && call.path.len() <= running.len()
                && call.path.iter().eq(running[running.len() - call.path.len()..].iter().map(|(first, _)| first))
        };
        let call = match self.calls.iter().position(same) {
            Some(call) => call,
            None if self.calls.len() >= CALLS_MAX => return,
            None => {
                let path = path(cpu, running);
                let name = cpu.call_name(&path, instance);
                self.calls.push(Call { path, instance, name, history: History::default() });
                self.calls.len() - 1
            }
        };
        if !block.steps.is_empty() {
            // A call that the CPU has left by a STOP did not end.
            self.inside.retain(|(depth, _)| *depth < running.len());
            self.inside.push((running.len(), call));
        }
        let is_wanted = self.wanted.as_ref().is_none_or(|wanted| *wanted == self.calls[call].name);
        if !is_wanted || self.done.is_some() {
            return;
        }
        self.depth = running.len();
        self.now.cycle = cpu.cycle_number();
        self.now.call = call;
        self.now.steps.clear();
        self.now.seen.clear();
        self.now.seen.resize(block.probes.len(), None);
    }

    /// The call of its chart ends, in which so many blocks run.
    fn note(&mut self, cpu: &Cpu, block: &BlockProbes, depth: usize, instance: u32) {
        if let Some((_, call)) = self.inside.pop_if(|(inside, _)| *inside == depth)
            && let Some(call) = self.calls.get_mut(call)
        {
            call.history.call(&block.steps, cpu, instance);
        }
    }
}

/// The blocks from the last one on that no block has called.
fn path(cpu: &Cpu, running: &[(u32, u32)]) -> Vec<u32> {
    let blocks = cpu.probes().map_or(&[][..], |probes| &probes.blocks);
    let kind = |first: &u32| blocks.binary_search_by_key(first, |block| block.first).ok().map(|at| blocks[at].kind);
    let from = running.iter().rposition(|(first, _)| kind(first).is_some_and(is_root)).unwrap_or(0);
    running[from..].iter().map(|(first, _)| *first).collect()
}

impl Monitor {
    /// Whether anybody looks.
    fn is_idle(&self) -> bool {
        self.watches.borrow().is_empty()
    }

    /// A block begins.
    pub(crate) fn enter(&self, cpu: &Cpu, place: u32, instance: u32) {
        if self.is_idle() {
            return;
        }
        let Some((probes, (block, _))) = cpu.probes().and_then(|probes| Some((probes, probes.find(place)?))) else {
            return;
        };
        let of = &probes.blocks[block];
        let mut running = self.running.borrow_mut();
        running.push((of.first, instance));
        if is_root(of.kind) {
            self.started.borrow_mut().push(cpu.clock.now());
        }
        let mut watches = self.watches.borrow_mut();
        for watch in watches.iter_mut().filter(|watch| watch.block == Some(block)) {
            watch.enter(cpu, &running, of);
        }
        self.is_keeping.set(watches.iter().any(|watch| watch.depth == running.len()));
    }

    /// The block that began last ends.
    pub(crate) fn leave(&self, cpu: &Cpu) {
        if self.is_idle() {
            return;
        }
        let mut running = self.running.borrow_mut();
        let mut watches = self.watches.borrow_mut();
        let (depth, instance) = (running.len(), running.last().map_or(0, |(_, instance)| *instance));
        for watch in watches.iter_mut() {
            let block = cpu.probes().zip(watch.block).and_then(|(probes, block)| probes.blocks.get(block));
            let Some(block) = block else { continue };
            watch.note(cpu, block, depth, instance);
            if watch.depth == 0 || watch.depth != depth {
                continue;
            }
            watch.depth = 0;
            let mut recorded = std::mem::take(&mut watch.now);
            recorded.steps = steps::seen(&block.steps, cpu, instance);
            let call = watch.calls.get(recorded.call);
            recorded.history = call.map_or_else(Vec::new, |call| call.history.list(&block.steps));
            watch.done = Some(recorded);
        }
        if let Some((first, _)) = running.pop() {
            self.count(cpu, first);
        }
        self.is_keeping.set(watches.iter().any(|watch| watch.depth != 0 && watch.depth == running.len()));
    }

    /// An organization block has run.
    fn count(&self, cpu: &Cpu, first: u32) {
        let blocks = cpu.probes().map_or(&[][..], |probes| &probes.blocks);
        let found = blocks.binary_search_by_key(&first, |block| block.first);
        if !found.is_ok_and(|at| is_root(blocks[at].kind)) {
            return;
        }
        if let Some(start) = self.started.borrow_mut().pop() {
            let time = cpu.clock.now().saturating_sub(start);
            let mut obs = self.obs.borrow_mut();
            let runs = obs.entry(first).or_default();
            runs.count += 1;
            runs.total += time;
            runs.longest = runs.longest.max(time);
        }
    }

    /// Keeps what a probe tells, for all whose call runs.
    fn keep(&self, cpu: &Cpu, place: u32, seen: impl Fn(&Tells) -> Seen) {
        if !self.is_keeping.get() {
            return;
        }
        let Some((probes, (block, at))) = cpu.probes().and_then(|probes| Some((probes, probes.find(place)?))) else {
            return;
        };
        let tells = &probes.blocks[block].probes[at].tells;
        let depth = self.running.borrow().len();
        for watch in
            self.watches.borrow_mut().iter_mut().filter(|watch| watch.block == Some(block) && watch.depth == depth)
        {
            if let Some(place) = watch.now.seen.get_mut(at) {
                *place = Some(seen(tells));
            }
        }
    }

    /// A statement has run.
    pub(crate) fn registers(&self, cpu: &Cpu, place: u32, registers: Registers) {
        self.keep(cpu, place, |tells| {
            let cell = match tells {
                Tells::Timer(number) => text_of(cpu, &format!("T{number}")),
                Tells::Counter(number) => text_of(cpu, &format!("C{number}")),
                _ => None,
            };
            Seen::Registers(registers, cell)
        });
    }

    /// A value was seen.
    pub(crate) fn value(&self, cpu: &Cpu, place: u32, value: u64) {
        self.keep(cpu, place, |tells| match tells {
            Tells::Stack(operands) => {
                let text = |name: &String| text_of(cpu, name).unwrap_or_default();
                Seen::Stack(value, operands.iter().map(text).collect())
            }
            _ => Seen::Value(value),
        });
    }
}
