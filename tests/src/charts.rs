//! Charts of any size for measurements, as GRAPH source text: rings of steps with one active step each.

use std::fmt::Write as _;

use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Compiled, Settings};

/// A function block with rings of steps. Each step has an action N; each transition reads two bits.
#[derive(Clone, Copy, Debug)]
pub struct Rings {
    /// Steps of all rings together, as evenly as it goes.
    pub steps: usize,
    /// Rings, which is also how many steps are active.
    pub rings: usize,
    /// Set of operating parameters: `Minimum`, `Standard`.
    pub interface: &'static str,
    /// Each step has a supervision, which never finds a fault.
    pub supervised: bool,
    /// In every call a transition of the first ring switches; else none does.
    pub switching: bool,
}

impl Rings {
    /// The function block FB 1.
    pub fn source(&self) -> String {
        let mut steps = String::new();
        let mut transitions = String::new();
        let mut first = 1;
        for ring in 0..self.rings {
            let last = first + self.steps / self.rings + usize::from(ring < self.steps % self.rings) - 1;
            for number in first..=last {
                self.step(&mut steps, number, number == first);
                let next = if number == last { first } else { number + 1 };
                self.transition(&mut transitions, number, next, ring == 0);
            }
            first = last + 1;
        }
        let interface = self.interface;
        format!(
            "FUNCTION_BLOCK FB1\n(*$_CMPSET\n   FBInterface: {interface}\n*)\n{steps}{transitions}END_FUNCTION_BLOCK\n"
        )
    }

    fn step(&self, out: &mut String, number: usize, initial: bool) {
        let (keyword, bit) = (if initial { "INITIAL_STEP" } else { "STEP" }, bit(number));
        let mut line = |text: String| writeln!(out, "{text}").expect("a String takes all text");
        line(format!("{keyword} S{number} (*$_NUM {number}*):"));
        if self.supervised {
            let condition = format!("S{number:03}.U > T#20H AND NOT T{number:03}.TT");
            line(format!("SUPERVISION\n CONDITION := {condition}\nEND_SUPERVISION"));
        }
        line(format!("Q{bit} (N)\nEND_STEP"));
    }

    fn transition(&self, out: &mut String, number: usize, next: usize, in_first: bool) {
        let bit = bit(number);
        // All bits are 0.
        let condition = match self.switching && in_first {
            true => format!("NOT I{bit} AND NOT M{bit}"),
            false => format!("I{bit} AND NOT M{bit}"),
        };
        write!(
            out,
            "TRANSITION T{number} (*$_NUM {number}*)\n  FROM S{number}\n  TO S{next}\nCONDITION := {condition}\nEND_TRANSITION\n"
        )
        .expect("a String takes all text");
    }

    /// The program at -O2: FB 1 with this many instances, and OB 1, which calls each of them if `called`.
    pub fn compile(&self, instances: usize, called: bool) -> Compiled {
        let mut main = String::new();
        let mut calls = String::new();
        for number in 1..=instances {
            main.push_str(&format!("DATA_BLOCK DB {number}\nFB 1\nBEGIN\nEND_DATA_BLOCK\n"));
            calls.push_str(&format!("      CALL FB 1, DB {number} (INIT_SQ := FALSE);\n"));
        }
        let calls = if called { calls.as_str() } else { "" };
        main.push_str(&format!("ORGANIZATION_BLOCK OB 1\nBEGIN\n{calls}END_ORGANIZATION_BLOCK\n"));
        let mut read = Read { name: "rings".to_string(), ..Read::default() };
        for (name, text) in [("rings.gr7", self.source()), ("main.stl", main)] {
            read.units.push(read.sources.add(SourceFile::new(name, text)));
        }
        let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
        assert!(!bound.has_errors(), "{}", plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
        pipeline::back(&bound, Level::O2)
    }
}

/// The bit of a step in each area.
fn bit(number: usize) -> String {
    format!("{}.{}", number / 8, number % 8)
}
