//! Makes a case smaller as long as it fails in the same way, so that a failure shows little more than its cause.

use crate::generate::Case;
use crate::program::Operand;
use crate::run::{self, Failure, Form};

/// A small case that fails as `case` does, with its failure.
pub fn reduce(case: &Case, failure: Failure, forms: &[Form]) -> (Case, Failure) {
    let mut best = Best { case: case.clone(), failure, forms: forms.to_vec() };
    best.cut();
    loop {
        let before = best.size();
        best.statements();
        best.pairs();
        best.blocks();
        best.data();
        best.scans();
        if best.size() >= before {
            return (best.case, best.failure);
        }
    }
}

struct Best {
    case: Case,
    failure: Failure,
    forms: Vec<Form>,
}

impl Best {
    fn size(&self) -> usize {
        self.case.program.to_string().len() + format!("{:?}", self.case.scans).len()
    }

    /// Takes the change if the case fails still. True: taken.
    fn attempt(&mut self, change: impl FnOnce(&mut Case)) -> bool {
        let mut case = self.case.clone();
        change(&mut case);
        match (run::check(&case, &self.forms), &self.failure) {
            (Err(Failure::Refused(text)), Failure::Refused(old)) if text.lines().next() != old.lines().next() => false,
            (Err(failure @ Failure::Refused(_)), Failure::Refused(_))
            | (Err(failure @ Failure::Panicked(_)), Failure::Panicked(_))
            | (Err(failure @ Failure::Different { .. }), Failure::Different { .. }) => {
                self.case = case;
                self.failure = failure;
                self.cut();
                true
            }
            (Err(_) | Ok(()), _) => false,
        }
    }

    /// Leaves out the scans after the failure.
    fn cut(&mut self) {
        if let Failure::Different { scan, .. } = self.failure {
            self.case.scans.truncate(scan);
        }
    }

    fn length(&self, block: usize) -> usize {
        self.case.program.blocks[block].code.len()
    }

    /// Runs of statements, long ones first.
    fn statements(&mut self) {
        for block in 0..self.case.program.blocks.len() {
            let mut size = self.length(block);
            while size > 0 {
                let mut at = self.length(block);
                while at > 0 {
                    let first = at.saturating_sub(size);
                    if self.length(block) >= at {
                        self.attempt(|case| _ = case.program.blocks[block].code.drain(first..at));
                    }
                    at = first;
                }
                size /= 2;
            }
        }
    }

    /// The beginning and end of a part are removed together.
    fn pairs(&mut self) {
        for block in 0..self.case.program.blocks.len() {
            for (first, last) in [("FOR", "NEXT"), ("JMP", "LBL"), ("LSCR", "SCRE"), ("LPS", "LPP"), ("LDS", "LPP")] {
                let mut at = 0;
                while at < self.length(block) {
                    let code = &self.case.program.blocks[block].code;
                    let end = code[at..].iter().position(|statement| statement.op == last);
                    if let (true, Some(end)) = (code[at].op == first, end) {
                        self.attempt(|case| {
                            let code = &mut case.program.blocks[block].code;
                            code.remove(at + end);
                            code.remove(at);
                        });
                    }
                    at += 1;
                }
            }
        }
    }

    /// Parameters of calls, from the last.
    fn blocks(&mut self) {
        let last = self.case.program.blocks.len() - 1;
        let calls = |case: &Case, block: usize| {
            let code = case.program.blocks.iter().flat_map(|block| &block.code);
            code.filter(|statement| statement.operands.first() == Some(&Operand::Block(block))).count()
        };
        if last > 0 && calls(&self.case, last - 1) == 0 {
            self.attempt(|case| _ = case.program.blocks.pop());
        }
    }

    fn data(&mut self) {
        let mut size = self.case.program.data.len();
        while size > 0 {
            let mut at = self.case.program.data.len();
            while at > 0 {
                let first = at.saturating_sub(size);
                self.attempt(|case| _ = case.program.data.drain(first..at));
                at = first;
            }
            size /= 2;
        }
    }

    fn scans(&mut self) {
        for scan in (0..self.case.scans.len()).rev() {
            if self.case.scans.len() > 1 && scan < self.case.scans.len() {
                self.attempt(|case| _ = case.scans.remove(scan));
            }
        }
        for scan in 0..self.case.scans.len() {
            if self.case.scans.get(scan).is_some_and(|scan| scan.inputs.iter().any(|&byte| byte != 0)) {
                self.attempt(|case| case.scans[scan].inputs.fill(0));
            }
        }
    }
}
