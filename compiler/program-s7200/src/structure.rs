//! Loops, sequence steps, labels and jumps of a block: they must be paired, and jumps must have a possible target.
//!
//! Source: S7-200 system manual, program control and sequence control relay instructions.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::s7200::Insn;
use rustc_hash::FxHashMap;

use plcc_binding::report::Report;
use plcc_model::s7200::Operand;

/// Limit of nested FOR loops.
const LOOPS_MAX: usize = 8;

/// Open loops and steps.
enum Open {
    Loop(Span),
    Step(Span),
}

#[derive(Default)]
pub struct Structure {
    open: Vec<Open>,
    /// Steps so far.
    steps: u32,
    /// The open step, from 1; 0: none.
    step: u32,
    /// Step and position of each label.
    labels: FxHashMap<u32, (u32, Span)>,
    jumps: Vec<(u32, u32, Span)>,
    /// The target of a jump could not be read.
    lost: bool,
}

impl Structure {
    pub fn in_step(&self) -> bool {
        self.step != 0
    }

    /// A statement; `operands` are missing if one of them is wrong.
    pub fn visit(&mut self, insn: Insn, operands: Option<&[Operand]>, span: Span, report: &mut Report) {
        let number = match operands.and_then(<[Operand]>::first) {
            Some(Operand::Const(number)) => Some(*number),
            _ => None,
        };
        match insn {
            Insn::For => {
                self.open.push(Open::Loop(span));
                let loops = self.open.iter().filter(|open| matches!(open, Open::Loop(_))).count();
                if loops == LOOPS_MAX + 1 {
                    report.push(
                        Diagnostic::new(Code::LoopNesting, span, "FOR loops are nested more than 8 deep (0093)")
                            .label("the ninth one")
                            .help("put the inner loops into a subroutine"),
                    );
                }
            }
            Insn::Next => self.next(span, report),
            Insn::Lscr => {
                if let Some(first) = self.open_step() {
                    // With a wrong operand, something else than a step may be meant.
                    if operands.is_some() {
                        report.push(
                            Diagnostic::new(Code::StepPair, span, "a sequence step begins inside another one (0096)")
                                .label("the previous step has no SCRE yet")
                                .also(first, "this step")
                                .help("end the previous step with SCRE"),
                        );
                    }
                    // The new one replaces it.
                    self.open.retain(|open| !matches!(open, Open::Step(_)));
                }
                self.open.push(Open::Step(span));
                self.steps = self.steps.saturating_add(1);
                self.step = self.steps;
            }
            Insn::Scre => self.end_step(span, report),
            Insn::Scrt | Insn::Cscre if self.step == 0 => {
                let name = if insn == Insn::Scrt { "SCRT" } else { "CSCRE" };
                report.push(
                    Diagnostic::new(Code::StepPair, span, format!("`{name}` is outside of a sequence step (0095)"))
                        .label("no LSCR is open here")
                        .help("move it between LSCR and SCRE"),
                );
            }
            Insn::Jmp => match number {
                Some(number) => self.jumps.push((number, self.step, span)),
                None => self.lost = true,
            },
            Insn::Lbl => {
                let Some(number) = number else { return };
                match self.labels.get(&number) {
                    Some(&(_, first)) => report.push(
                        Diagnostic::new(
                            Code::DuplicateLabel,
                            span,
                            format!("the label {number} is defined twice (008C)"),
                        )
                        .label("the second one")
                        .also(first, "the first one")
                        .help("use another number for one of them"),
                    ),
                    None => {
                        self.labels.insert(number, (self.step, span));
                    }
                }
            }
            _ => {}
        }
    }

    fn open_step(&self) -> Option<Span> {
        self.open.iter().rev().find_map(|open| match open {
            Open::Step(span) => Some(*span),
            Open::Loop(_) => None,
        })
    }

    fn next(&mut self, span: Span, report: &mut Report) {
        match self.open.last() {
            Some(Open::Loop(_)) => {
                self.open.pop();
            }
            Some(Open::Step(step)) => {
                report.push(
                    Diagnostic::new(Code::LoopPair, span, "NEXT without FOR in this sequence step (0085)")
                        .label("a loop begins and ends in the same step")
                        .also(*step, "the step begins here")
                        .help("put both FOR and NEXT inside the step, or both around it"),
                );
                // A loop around the step counts as closed, so that it is reported once.
                if let Some(at) = self.open.iter().rposition(|open| matches!(open, Open::Loop(_))) {
                    self.open.remove(at);
                }
            }
            None => report.push(
                Diagnostic::new(Code::LoopPair, span, "NEXT without FOR (0085)")
                    .label("no loop is open here")
                    .help("add the FOR, or remove the NEXT"),
            ),
        }
    }

    fn end_step(&mut self, span: Span, report: &mut Report) {
        if self.step == 0 {
            report.push(
                Diagnostic::new(Code::StepPair, span, "SCRE without LSCR (0095)")
                    .label("no sequence step is open here")
                    .help("add the LSCR, or remove the SCRE"),
            );
            return;
        }
        self.step = 0;
        while let Some(open) = self.open.pop() {
            match open {
                Open::Step(_) => return,
                Open::Loop(first) => report.push(loop_without_next(first)),
            }
        }
    }

    /// The end of the block.
    pub fn finish(self, report: &mut Report) {
        for open in &self.open {
            report.push(match open {
                Open::Loop(span) => loop_without_next(*span),
                Open::Step(span) => Diagnostic::new(Code::StepPair, *span, "a sequence step without SCRE (0096)")
                    .label("nothing ends this step")
                    .help("end it with SCRE"),
            });
        }
        // A jump to a label that is not there is reported: it may mean one of these.
        let is_lost = self.lost || self.jumps.iter().any(|jump| !self.labels.contains_key(&jump.0));
        let mut unused: Vec<Span> = self
            .labels
            .iter()
            .filter(|(number, _)| !is_lost && !self.jumps.iter().any(|jump| jump.0 == **number))
            .map(|(_, (_, span))| *span)
            .collect();
        unused.sort_by_key(|span| span.start);
        for span in unused {
            report.push(
                Diagnostic::new(Code::UnusedLabel, span, "no jump of the block leads to this label")
                    .label("is never used")
                    .help("remove it, or look whether a jump is missing"),
            );
        }
        for &(number, step, span) in &self.jumps {
            match self.labels.get(&number) {
                None => report.push(
                    Diagnostic::new(Code::UnknownLabel, span, format!("the block has no label {number} (0087)"))
                        .label("this jump has no target")
                        .help(format!("add `LBL {number}` to the same block")),
                ),
                Some(&(other, label)) if other != step => report.push(
                    Diagnostic::new(
                        Code::JumpAcrossStep,
                        span,
                        format!("the jump to label {number} crosses the border of a sequence step (008B)"),
                    )
                    .label("the jump")
                    .also(label, "its label")
                    .help("only jump inside the step; leave a step with SCRT, or end it early with CSCRE"),
                ),
                Some(_) => {}
            }
        }
    }
}

fn loop_without_next(span: Span) -> Diagnostic {
    Diagnostic::new(Code::LoopPair, span, "FOR without NEXT (0086)")
        .label("nothing ends this loop")
        .help("end it with NEXT in the same block, and in the same sequence step")
}
