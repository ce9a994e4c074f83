//! What can be left out of a program of an S7-200, and of its scans.

use plcc_tests::reduce::{self, Best};

use super::generate::Case;
use super::program::Operand;
use super::run::{self, FORMS, Failure};

/// A small case that fails as `case` does, with its failure.
pub fn reduce(case: Case, failure: Failure) -> Best<Case> {
    Best::of(case, failure, |best| {
        statements(best);
        pairs(best);
        blocks(best);
        data(best);
        scans(best);
    })
}

impl reduce::Case for Case {
    type Failure = Failure;

    fn check(&self) -> Result<(), Failure> {
        run::check(self, &FORMS)
    }

    fn alike(new: &Failure, old: &Failure) -> bool {
        match (new, old) {
            (Failure::Refused(new), Failure::Refused(old)) => new.lines().next() == old.lines().next(),
            (Failure::Panicked(_), Failure::Panicked(_)) | (Failure::Different { .. }, Failure::Different { .. }) => {
                true
            }
            (Failure::Refused(_) | Failure::Panicked(_) | Failure::Different { .. }, _) => false,
        }
    }

    fn cut(&mut self, failure: &Failure) {
        if let Failure::Different { scan, .. } = failure {
            self.scans.truncate(*scan);
        }
    }

    fn size(&self) -> usize {
        self.program.to_string().len() + format!("{:?}", self.scans).len()
    }
}

fn length(case: &Case, block: usize) -> usize {
    case.program.blocks[block].code.len()
}

fn statements(best: &mut Best<Case>) {
    for block in 0..best.case.program.blocks.len() {
        best.runs(|case| length(case, block), |case, run| _ = case.program.blocks[block].code.drain(run));
    }
}

/// The beginning and end of a part are removed together.
fn pairs(best: &mut Best<Case>) {
    for block in 0..best.case.program.blocks.len() {
        for (first, last) in [("FOR", "NEXT"), ("JMP", "LBL"), ("LSCR", "SCRE"), ("LPS", "LPP"), ("LDS", "LPP")] {
            let mut at = 0;
            while at < length(&best.case, block) {
                let code = &best.case.program.blocks[block].code;
                let end = code[at..].iter().position(|statement| statement.op == last);
                if let (true, Some(end)) = (code[at].op == first, end) {
                    best.attempt(|case| {
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
fn blocks(best: &mut Best<Case>) {
    let last = best.case.program.blocks.len() - 1;
    let calls = |case: &Case, block: usize| {
        let code = case.program.blocks.iter().flat_map(|block| &block.code);
        code.filter(|statement| statement.operands.first() == Some(&Operand::Block(block))).count()
    };
    if last > 0 && calls(&best.case, last - 1) == 0 {
        best.attempt(|case| _ = case.program.blocks.pop());
    }
}

fn data(best: &mut Best<Case>) {
    best.runs(|case| case.program.data.len(), |case, run| _ = case.program.data.drain(run));
}

fn scans(best: &mut Best<Case>) {
    for scan in (0..best.case.scans.len()).rev() {
        if best.case.scans.len() > 1 && scan < best.case.scans.len() {
            best.attempt(|case| _ = case.scans.remove(scan));
        }
    }
    for scan in 0..best.case.scans.len() {
        if best.case.scans.get(scan).is_some_and(|scan| scan.inputs.iter().any(|&byte| byte != 0)) {
            best.attempt(|case| case.scans[scan].inputs.fill(0));
        }
    }
}
