//! Rules that only show in the whole program: what drives a timer, steps of S bits, how deep calls are nested.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::s7200::Insn;
use rustc_hash::FxHashMap;

use super::Binder;
use plcc_model::s7200::Operand;

/// Limit of nested subroutines that the main program may call.
const DEPTH_MAX: u32 = 8;
/// The same for an interrupt routine.
const INTERRUPT_DEPTH_MAX: u32 = 1;
/// Limit of EU and ED in a program. Source: S7-200 system manual, memory ranges and features.
const EDGES_MAX: usize = 256;

/// Something that instructions drive by number.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Cell {
    Timer(u8),
    Counter(u8),
    Loop(u32),
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Cell::Timer(number) => write!(f, "T{number}"),
            Cell::Counter(number) => write!(f, "C{number}"),
            Cell::Loop(number) => write!(f, "PID loop {number}"),
        }
    }
}

/// The timers, counters, steps and calls in the statements of all blocks.
#[derive(Default)]
pub struct Uses {
    cells: FxHashMap<Cell, Vec<(Insn, Span)>>,
    /// LSCR of each S bit.
    steps: FxHashMap<(u32, u8), Vec<Span>>,
    edges: Vec<Span>,
    /// Caller, callee, and the first such call.
    calls: FxHashMap<(usize, usize), Span>,
}

impl Uses {
    /// Checks an instruction that is correct by itself.
    pub fn instruction(&mut self, insn: Insn, operands: &[Operand], span: Span) {
        let cell = match (insn, operands) {
            (Insn::Ton | Insn::Tonr | Insn::Tof, [Operand::Timer { number, .. }, ..]) => Cell::Timer(*number),
            (Insn::Ctu | Insn::Ctd | Insn::Ctud, [Operand::Counter { number, .. }, ..]) => Cell::Counter(*number),
            (Insn::Pid, [_, Operand::Const(number)]) => Cell::Loop(*number),
            (Insn::Lscr, [Operand::Memory { byte, bit, .. }]) => {
                return self.steps.entry((*byte, *bit)).or_default().push(span);
            }
            (Insn::RisingEdge | Insn::FallingEdge, _) => return self.edges.push(span),
            _ => return,
        };
        self.cells.entry(cell).or_default().push((insn, span));
    }

    pub fn call(&mut self, caller: usize, callee: usize, span: Span) {
        self.calls.entry((caller, callee)).or_insert(span);
    }
}

impl Binder<'_> {
    pub fn check_program(&mut self) {
        let uses = std::mem::take(&mut self.uses);
        self.check_cells(&uses);
        for ((byte, bit), places) in sorted(&uses.steps) {
            if let [first, second, ..] = places.as_slice() {
                let title = format!("S{byte}.{bit} begins two sequence steps (008C)");
                self.push(
                    Diagnostic::new(Code::DuplicateSequenceStep, *second, title)
                        .label("the second LSCR of this bit")
                        .also(*first, "the first one")
                        .help("give each step its own S bit"),
                );
            }
        }
        if let Some(span) = uses.edges.get(EDGES_MAX)
            && self.input.profile.name != "s7-200"
        {
            let title = format!("the program has {} EU and ED", uses.edges.len());
            let message = Diagnostic::new(Code::CpuLimit, *span, title)
                .label("a CPU 22x has room for 256 of them")
                .help("build edges from a bit of V memory: compare it with its value in the previous scan");
            self.push(message);
        }
        self.check_depth(&uses);
    }

    fn check_cells(&mut self, uses: &Uses) {
        for (cell, places) in sorted(&uses.cells) {
            let Some((&(first, first_span), rest)) = places.split_first() else { continue };
            if let Some(&(other, span)) = rest.iter().find(|(insn, _)| *insn != first) {
                let (first, other) = (self.mnemonic(first), self.mnemonic(other));
                let title = format!("{cell} is driven by {first} and by {other} (0090)");
                self.push(
                    Diagnostic::new(Code::MixedCells, span, title)
                        .label(format!("{other} here"))
                        .also(first_span, format!("{first} here"))
                        .help("use another number for one of them"),
                );
            } else if let Some(&(_, span)) = rest.first() {
                self.push(
                    Diagnostic::new(Code::CellTwice, span, format!("{cell} is driven at {} places", places.len()))
                        .label("the second one")
                        .also(first_span, "the first one")
                        .help("they interfere if both are executed in one scan; use another number for one of them"),
                );
            }
        }
    }

    /// Recursion, and calls nested deeper than the CPU allows.
    fn check_depth(&mut self, uses: &Uses) {
        let mut calls: Vec<(usize, usize, Span)> =
            uses.calls.iter().map(|(&(caller, callee), &span)| (caller, callee, span)).collect();
        calls.sort_by_key(|&(caller, callee, span)| (span.file, span.start, caller, callee));
        if let Some(span) = circle(&calls, self.blocks.len()) {
            self.push(
                Diagnostic::new(Code::CallDepth, span, "a subroutine calls itself, directly or through others")
                    .label("this call is part of the recursion")
                    .help("the CPU skips a call that is nested more than 8 deep (0008); use FOR and NEXT to repeat"),
            );
            return;
        }
        for kind in [BlockKind::Ob, BlockKind::Int] {
            let limit = if kind == BlockKind::Ob { DEPTH_MAX } else { INTERRUPT_DEPTH_MAX };
            let mut level: Vec<bool> = self.blocks.iter().map(|block| block.kind == kind).collect();
            for depth in 0..=limit {
                let mut next = vec![false; level.len()];
                let mut last = None;
                for &(caller, callee, span) in &calls {
                    if level.get(caller) == Some(&true)
                        && let Some(called) = next.get_mut(callee)
                    {
                        *called = true;
                        last.get_or_insert(span);
                    }
                }
                if let Some(span) = last.filter(|_| depth == limit) {
                    let (from, levels) = match kind {
                        BlockKind::Ob => ("the main program", "8 levels"),
                        _ => ("an interrupt routine", "one level"),
                    };
                    self.push(
                        Diagnostic::new(Code::CallDepth, span, format!("from {from}, this call is nested too deeply"))
                            .label(format!("{from} can call {levels} of subroutines"))
                            .help("the CPU skips the call (0008): call the subroutine from a higher level"),
                    );
                }
                level = next;
            }
        }
    }
}

/// Entries in order of their keys.
fn sorted<K: Copy + Ord, V>(map: &FxHashMap<K, V>) -> Vec<(K, &V)> {
    let mut entries: Vec<(K, &V)> = map.iter().map(|(key, value)| (*key, value)).collect();
    entries.sort_by_key(|(key, _)| *key);
    entries
}

/// The first call that is part of a recursion.
fn circle(calls: &[(usize, usize, Span)], blocks: usize) -> Option<Span> {
    let mut left = calls.to_vec();
    loop {
        let mut calls_out = vec![false; blocks];
        let mut called = vec![false; blocks];
        for &(caller, callee, _) in &left {
            if let (Some(out), true) = (calls_out.get_mut(caller), callee < blocks) {
                *out = true;
            }
            if let Some(called) = called.get_mut(callee) {
                *called = true;
            }
        }
        let before = left.len();
        // A block that calls nothing, or that nothing calls, is not in a recursion.
        left.retain(|&(caller, callee, _)| called.get(caller) == Some(&true) && calls_out.get(callee) == Some(&true));
        if left.len() == before {
            return left.first().map(|(_, _, span)| *span);
        }
    }
}
