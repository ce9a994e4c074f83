//! The logic stack of a network: how many levels statements push and need.
//!
//! A network may contain several rungs, and each begins with a load that pushes one more level; levels that are no longer needed are
//! simply lost at the bottom. Networks do not clear the stack, but each is counted separately.
//! Source: S7-200 system manual, logic stack instructions and compile rule violations.

use plcc_abi::image::BlockKind;
use plcc_abi::s7200::STACK_LEVELS;
use plcc_diag::{Code, Diagnostic, SourceMap, Span};
use plcc_syntax::s7200::{Acts, Contact, Insn};
use plcc_syntax::stl::Mnemonics;

use plcc_binding::pragma::has_assertion;
use plcc_binding::report::Report;

/// The effect of an instruction on the stack.
enum Effect {
    /// One more level.
    Push,
    /// One more level, a copy of level n.
    Copy(usize),
    /// Uses this many levels, which stay.
    Combine(usize),
    /// Two levels become one.
    Join,
    /// Drops the top.
    Pop,
    /// Only reads the top.
    Read,
    /// The top is 1 from here on.
    Set,
    None,
}

fn effect(insn: Insn, level: Option<u32>) -> Effect {
    match insn {
        Insn::Load | Insn::LoadNot | Insn::LoadNow | Insn::LoadNotNow | Insn::Lscr => Effect::Push,
        Insn::Compare(compare) => match compare.contact {
            Contact::Load => Effect::Push,
            Contact::And | Contact::Or => Effect::Combine(1),
        },
        Insn::And
        | Insn::AndNot
        | Insn::Or
        | Insn::OrNot
        | Insn::AndNow
        | Insn::AndNotNow
        | Insn::OrNow
        | Insn::OrNotNow
        | Insn::Not
        | Insn::RisingEdge
        | Insn::FallingEdge => Effect::Combine(1),
        Insn::Read => Effect::Combine(2),
        Insn::Ctu | Insn::Ctd => Effect::Combine(2),
        Insn::Ctud => Effect::Combine(3),
        Insn::AndLoad | Insn::OrLoad => Effect::Join,
        Insn::Pop => Effect::Pop,
        Insn::Push => Effect::Copy(0),
        Insn::LoadStack => Effect::Copy(level.unwrap_or(0) as usize),
        Insn::Assign | Insn::AssignNow | Insn::AndEno | Insn::Ton | Insn::Tonr | Insn::Tof => Effect::Read,
        Insn::Next => Effect::Set,
        insn => match insn.acts() {
            Acts::Enabled => Effect::Read,
            Acts::Always | Acts::Marker => Effect::None,
        },
    }
}

/// The levels that a network has pushed.
pub struct Stack {
    kind: BlockKind,
    depth: usize,
    /// Levels at the bottom that were pushed out.
    lost: usize,
    /// The block has pushed something: levels below it are no longer those of its caller.
    loaded: bool,
    /// A message was given in this network; the count is no longer certain.
    told: bool,
    /// A message about a missing contact was given in this network.
    read_told: bool,
    /// Levels of this network, the top last: which instruction pushed them, until something uses them.
    unused: Vec<Option<Span>>,
    /// The same levels: those that LPS has pushed, until LPP, ALD or OLD takes them.
    copies: Vec<Option<Span>>,
    /// An LPS of the network before, whose level nothing has taken: the LPP may be in this one.
    left_before: Option<Span>,
    /// A level before an instruction that has no condition, and this instruction with its mnemonic.
    before_unconditional: Option<(Span, Insn, String)>,
}

impl Stack {
    pub fn new(kind: BlockKind) -> Stack {
        Stack {
            kind,
            depth: 0,
            lost: 0,
            loaded: false,
            told: false,
            read_told: false,
            unused: Vec::new(),
            copies: Vec::new(),
            left_before: None,
            before_unconditional: None,
        }
    }

    /// An operand that an instruction does not have may have been meant as the use of the result: `EU Q0.0`.
    pub fn doubt(&mut self) {
        self.read_told = true;
    }

    /// The statements of a network are over; the next one begins at `end`.
    pub fn end_network(&mut self, end: u32, sources: &SourceMap, report: &mut Report) {
        let is_certain = !self.told && !self.read_told;
        // An assertion may read any level.
        let first = |levels: &mut Vec<Option<Span>>| {
            let left = std::mem::take(levels).into_iter().flatten().next();
            left.filter(|span| is_certain && !has_assertion(sources, Span { end, ..*span }))
        };
        let (left, copied) = (first(&mut self.unused), first(&mut self.copies));
        self.finish(report);
        self.left_before = copied.filter(|_| left.is_none());
        if let Some(span) = left {
            let unconditional = self.before_unconditional.take().filter(|(before, ..)| *before == span);
            let help = unconditional.map(|(_, insn, name)| without_condition(insn, &name));
            let help = help.unwrap_or_else(|| {
                "join it with ALD or OLD, or remove it; a contact in series is `A`, one in parallel `O`".to_string()
            });
            report.push(
                Diagnostic::new(Code::LeftOverLevel, span, "nothing uses the result of this contact")
                    .label("it stays on the logic stack until the network ends")
                    .help(help),
            );
        }
    }

    /// The block is over.
    pub fn finish(&mut self, report: &mut Report) {
        if let Some(span) = self.left_before.take() {
            report.push(
                Diagnostic::new(Code::LeftOverLevel, span, "no LPP takes back what this LPS pushes")
                    .label("it stays on the logic stack until the network ends")
                    .help("begin the last branch with LPP in place of LRD, or remove LPS if there is one branch only"),
            );
        }
    }

    /// What an instruction leaves of the levels that nothing has used.
    fn follow(&mut self, effect: &Effect, span: Span) {
        let used = |levels: usize, unused: &mut Vec<Option<Span>>| {
            unused.iter_mut().rev().take(levels).for_each(|level| *level = None);
        };
        match effect {
            Effect::None => {}
            Effect::Push => self.unused.push(Some(span)),
            Effect::Set => used(1, &mut self.unused),
            Effect::Copy(level) => {
                used(level + 1, &mut self.unused);
                self.unused.push(None);
            }
            // A contact in series or in parallel is not a use, a counter is.
            Effect::Combine(1) => {}
            Effect::Combine(levels) => used(*levels, &mut self.unused),
            Effect::Join => {
                // Together they are one level, which is not used yet.
                let top = self.unused.pop().flatten();
                if let Some(below) = self.unused.last_mut() {
                    *below = below.or(top);
                }
            }
            Effect::Pop => {
                self.unused.pop();
            }
            Effect::Read => used(1, &mut self.unused),
        }
    }

    pub fn begin_network(&mut self) {
        self.unused.clear();
        self.copies.clear();
        self.before_unconditional = None;
        (self.depth, self.lost, self.told, self.read_told) = (0, 0, false, false);
    }

    /// A statement that could not be read may have pushed anything.
    pub fn unknown(&mut self) {
        self.told = true;
        self.read_told = true;
        self.loaded = true;
    }

    /// A statement; `level` is the operand of `LDS`.
    pub fn visit(&mut self, insn: Insn, level: Option<u32>, name: &str, span: Span, report: &mut Report) {
        let effect = effect(insn, level);
        let has_condition = !matches!(effect, Effect::None) && insn != Insn::Lscr;
        if let Some(before) = self.unused.last().copied().flatten().filter(|_| !has_condition && insn != Insn::Nop) {
            self.before_unconditional.get_or_insert_with(|| (before, insn, name.to_string()));
        }
        self.follow(&effect, span);
        match effect {
            Effect::Push | Effect::Copy(_) => self.copies.push((insn == Insn::Push).then_some(span)),
            Effect::Join | Effect::Pop => {
                self.copies.pop();
            }
            Effect::Combine(_) | Effect::Read | Effect::Set | Effect::None => {}
        }
        if insn == Insn::Lscr {
            // The step uses it.
            self.unused.pop();
            self.unused.push(None);
        }
        match effect {
            Effect::None => {}
            Effect::Push => self.push(),
            Effect::Set => self.depth = self.depth.max(1),
            Effect::Copy(level) => {
                self.read(level, name, span, report);
                self.push();
            }
            Effect::Combine(levels) => self.need(levels, name, span, report),
            Effect::Join => {
                self.need(2, name, span, report);
                self.depth = self.depth.saturating_sub(1);
            }
            Effect::Pop => {
                // What LPS has pushed, and a level below it, which may be lost.
                let levels = if self.depth < 2 { 2 } else { 1 };
                self.need(levels, name, span, report);
                self.depth = self.depth.saturating_sub(1);
            }
            Effect::Read => self.read(0, name, span, report),
        }
    }

    fn push(&mut self) {
        self.depth = self.depth.saturating_add(1);
        self.lost = self.lost.max(self.depth.saturating_sub(STACK_LEVELS));
        self.loaded = true;
    }

    fn need(&mut self, levels: usize, name: &str, span: Span, report: &mut Report) {
        if self.depth < levels {
            if !self.told {
                let push = self.left_before.filter(|_| self.depth == 0 && matches!(name, "LPP" | "LRD"));
                report.push(match push {
                    Some(push) => in_other_network(name, push, span),
                    None => underflow(self.depth, levels, name, span),
                });
                if push.is_some() {
                    self.left_before = None;
                }
            }
            self.told = true;
            self.depth = levels;
        }
        self.check_lost(levels.saturating_sub(1), name, span, report);
    }

    /// Reads level `level` from the top.
    fn read(&mut self, level: usize, name: &str, span: Span, report: &mut Report) {
        if level < self.depth {
            return self.check_lost(level, name, span, report);
        }
        // A subroutine and an interrupt routine begin with a 1 on top.
        let given = self.kind != BlockKind::Ob && !self.loaded;
        if !given && !self.read_told && !self.told {
            report.push(
                Diagnostic::new(Code::NoContact, span, format!("`{name}` has no contact before it in its network"))
                    .label("it uses the result of the network before")
                    .help("begin the network with a load; `LD SM0.0` is always 1"),
            );
        }
        self.read_told = true;
    }

    fn check_lost(&mut self, level: usize, name: &str, span: Span, report: &mut Report) {
        let position = self.depth.saturating_sub(1).saturating_sub(level);
        if position < self.lost && !self.told {
            self.told = true;
            report.push(
                Diagnostic::new(
                    Code::StackOverflow,
                    span,
                    format!("`{name}` needs a level that the logic stack has lost"),
                )
                .label("more than nine levels were pushed before: the oldest ones are gone")
                .help("combine branches with ALD and OLD earlier, or keep a result in a bit"),
            );
        }
    }
}

/// What to write for a contact before an instruction that is executed whatever the contact is.
fn without_condition(insn: Insn, name: &str) -> String {
    let conditional = match insn {
        Insn::Mend => Insn::End,
        Insn::Ret => Insn::Cret,
        Insn::Reti => Insn::Creti,
        Insn::Scre => Insn::Cscre,
        _ => return format!("`{name}` has no condition: remove the contact"),
    };
    format!("`{name}` has no condition: write `{}`, or remove the contact", conditional.mnemonic(Mnemonics::En))
}

/// `name` takes a level that `push` has pushed in the network before.
fn in_other_network(name: &str, push: Span, span: Span) -> Diagnostic {
    Diagnostic::new(Code::StackUnderflow, span, format!("`{name}` is in another network than its LPS (0081)"))
        .label("the network has pushed no level")
        .also(push, "pushed here, in the network before")
        .help(format!("write the branches from `LPS` to `{name}` in one network"))
}

fn underflow(depth: usize, levels: usize, name: &str, span: Span) -> Diagnostic {
    if depth == 0 && levels == 1 {
        return Diagnostic::new(Code::StackUnderflow, span, format!("the network begins with `{name}` (0081)"))
            .label("there is no value yet that it could use")
            .help("begin the network with a load such as `LD I0.0`");
    }
    let has = match depth {
        0 => "none".to_string(),
        _ => format!("only {depth}"),
    };
    Diagnostic::new(
        Code::StackUnderflow,
        span,
        format!("`{name}` needs {levels} levels of the logic stack, but the network has pushed {has} (0081)"),
    )
    .label("too few levels")
    .help(match name {
        "CTU" => "before it load the count input, then the reset input, each with LD",
        "CTD" => "before it load the count input, then the load input, each with LD",
        "CTUD" => "load the inputs for up, down and reset before it",
        "ALD" | "ULD" | "OLD" => "each of the two groups that it joins begins with a load",
        "LRD" | "LPP" => "LPS must come before it",
        _ => "push the levels with loads or LPS",
    })
}
