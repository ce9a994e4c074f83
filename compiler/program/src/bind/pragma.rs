//! Assertion pragmas.

use plcc_abi::image::AssertOp;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, Pragma, Width};
use plcc_syntax::literal::Literal;

use super::report::Report;
use super::settle::Settled;
use super::{Binder, Ctx};
use crate::model::{Assert, AssertSide, Operand, StlStatementKind, TestSettings};
use crate::profile;

/// One side of an assertion.
struct Side {
    side: AssertSide,
    /// The value, if it is a constant.
    constant: Option<u32>,
    real: bool,
}

impl Binder<'_> {
    /// A pragma between statements.
    pub fn statement_pragma(&mut self, ctx: &mut Ctx, pragma: &Pragma) -> Option<StlStatementKind> {
        if !self.input.pragmas {
            return None;
        }
        let (word, rest) = split(&pragma.text);
        match word {
            "assert" => self.assert(ctx, pragma),
            "sleep" => match rest.parse::<u32>() {
                Ok(milliseconds) => Some(StlStatementKind::Sleep(milliseconds)),
                Err(_) => {
                    self.bad_pragma(pragma.span, "`sleep` takes a number of milliseconds", "write `//@ sleep 100`");
                    None
                }
            },
            // Those of the whole file, which the file lists by itself.
            "cpu" | "test" => None,
            _ if word.starts_with('^') => None,
            _ => {
                self.unknown_pragma(pragma);
                None
            }
        }
    }

    /// A pragma of the whole file.
    pub fn file_pragma(&mut self, pragma: &Pragma, settings: &mut TestSettings) {
        file_pragma(&mut self.report, pragma, settings);
    }

    fn unknown_pragma(&mut self, pragma: &Pragma) {
        unknown_pragma(&mut self.report, pragma);
    }

    fn bad_pragma(&mut self, span: Span, title: &str, help: &str) {
        bad_pragma(&mut self.report, span, title, help);
    }

    fn assert(&mut self, ctx: &mut Ctx, pragma: &Pragma) -> Option<StlStatementKind> {
        // One that is not built as `assert LHS OP RHS` was reported when it was read.
        let sides = pragma.assert.as_ref()?;
        let left = self.assert_side(ctx, &sides.left, pragma.span);
        let right = self.assert_side(ctx, &sides.right, pragma.span);
        let (left, right) = (left?, right?);
        let op = match sides.op {
            ast::AssertOp::Eq => AssertOp::Eq,
            ast::AssertOp::Ne => AssertOp::Ne,
            ast::AssertOp::Lt => AssertOp::Lt,
            ast::AssertOp::Le => AssertOp::Le,
            ast::AssertOp::Gt => AssertOp::Gt,
            ast::AssertOp::Ge => AssertOp::Ge,
        };
        let ordered = matches!(op, AssertOp::Lt | AssertOp::Le | AssertOp::Gt | AssertOp::Ge);
        Some(StlStatementKind::Assert(Assert {
            op,
            real: ordered && (left.real || right.real),
            trap: matches!((left.constant, right.constant), (Some(left), Some(right)) if left != right),
            left: left.side,
            right: right.side,
            text: pragma.text.clone(),
        }))
    }

    fn assert_side(&mut self, ctx: &mut Ctx, side: &ast::AssertSide, pragma: Span) -> Option<Side> {
        let operand = match side {
            ast::AssertSide::Register(register) => {
                if let ast::AssertRegister::Accu(number @ (3 | 4)) = register
                    && self.input.profile.accumulators < 4
                {
                    self.bad_pragma(
                        pragma,
                        &format!("this CPU has no ACCU{number}"),
                        "add `//@ cpu accus=4` to the file",
                    );
                    return None;
                }
                return Some(Side { side: AssertSide::Register(*register), constant: None, real: false });
            }
            ast::AssertSide::Operand(operand) => operand,
        };
        let constant = |value: u32, real: bool| {
            let side = AssertSide::Operand(Operand::Const { value, wide: true });
            Some(Side { side, constant: Some(value), real })
        };
        let variable =
            |operand: Operand| Some(Side { side: AssertSide::Operand(operand), constant: None, real: false });
        match self.settle(ctx, operand)? {
            Settled::Memory { width: Width::Lword, .. } => {
                let text = self.text(operand.span);
                self.bad_pragma(
                    operand.span,
                    &format!("`{text}` has 64 bits"),
                    "assertions compare up to 32 bits: convert the value to another variable first, or compare it in the program",
                );
                None
            }
            Settled::Memory { place, width, .. } => variable(Operand::Memory { place, width }),
            Settled::Cell { kind, number } => variable(Operand::Cell { kind, number }),
            Settled::Literal(Literal::Bool(value)) => constant(u32::from(*value), false),
            Settled::Literal(literal) => match self.loaded(literal, operand.span)? {
                Operand::Const { value, .. } => constant(value, matches!(literal, Literal::Real(_))),
                _ => None,
            },
            Settled::Pointer(value) => constant(value, false),
            Settled::Status(status) => variable(Operand::Status(status)),
            Settled::Special(special) => variable(Operand::Special(special)),
            Settled::Complex(_)
            | Settled::Block { .. }
            | Settled::ParameterPointer(_)
            | Settled::Register(_)
            | Settled::Label => {
                let text = self.text(operand.span);
                self.bad_pragma(
                    operand.span,
                    &format!("`{text}` has no value of up to 32 bits"),
                    "name an address, a variable, a constant, or a register such as ACCU1, AR1, STW, STW.RLO, DBNO",
                );
                None
            }
        }
    }
}

/// A pragma of the whole file.
pub fn file_pragma(report: &mut Report, pragma: &Pragma, settings: &mut TestSettings) {
    let (word, rest) = split(&pragma.text);
    match word {
        "cpu" => {
            let accumulators = rest.strip_prefix("accus=");
            let good = match accumulators {
                Some(count) => matches!(count, "2" | "4"),
                None => profile::lookup(rest).is_some(),
            };
            if !good {
                report.push(
                    Diagnostic::new(Code::UnknownCpu, pragma.span, "this CPU is not known")
                        .label(rest.to_string())
                        .help(profile::help(rest)),
                );
            }
        }
        "test" => {
            if rest == "expect=fail" {
                settings.expect_fail = true;
            } else if let Some(Ok(cycles)) = rest.strip_prefix("cycles=").map(str::parse::<u32>) {
                settings.cycles = Some(cycles);
            } else if rest != "partial" {
                bad_pragma(
                    report,
                    pragma.span,
                    "`test` takes `cycles=N`, `expect=fail` or `partial`",
                    "write `//@ test cycles=10`, `//@ test expect=fail` or `//@ test partial`",
                );
            }
        }
        "assert" | "sleep" => bad_pragma(
            report,
            pragma.span,
            &format!("`{word}` must stand between the statements of a block"),
            "move it behind the statement after which it holds",
        ),
        _ if word.starts_with('^') => {}
        _ => unknown_pragma(report, pragma),
    }
}

/// A line `//@` that is none of the pragmas.
pub fn unknown_pragma(report: &mut Report, pragma: &Pragma) {
    bad_pragma(
        report,
        pragma.span,
        &format!("`{}` is no pragma", split(&pragma.text).0),
        "the pragmas are assert, sleep, cpu and test; a plain comment begins with `//`",
    );
}

/// A pragma that is not built as it must be.
pub fn bad_pragma(report: &mut Report, span: Span, title: &str, help: &str) {
    report.push(Diagnostic::new(Code::Pragma, span, title).label("not understood").help(help));
}

/// First word, and the rest without outer blanks.
pub fn split(text: &str) -> (&str, &str) {
    let text = text.trim();
    match text.split_once(char::is_whitespace) {
        Some((word, rest)) => (word, rest.trim()),
        None => (text, ""),
    }
}
