//! Start values of type S5TIME that hold less than is written: three digits and a time base.
//!
//! Source: Programming with STEP 7, format of S5TIME.

use plcc_binding::rewrite;
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_model::types::{DataType, Elementary};

use crate::bind::declarations::Declarations;

impl Declarations<'_> {
    /// Warns of an S5TIME of which digits are cut off. `bytes`: the value of the constant at `span`.
    pub(super) fn cut_s5time(&mut self, ty: &DataType, bytes: &[u8], span: Span) {
        let (DataType::Elementary(Elementary::S5Time), [high, low]) = (ty, bytes) else { return };
        let word = u16::from_be_bytes([*high, *low]);
        let Some((title, help)) = rewrite::cut_s5time(&self.globals.text(span), word) else { return };
        // Many elements of an array may have one value.
        let last = self.globals.report.diagnostics.last();
        if last.is_some_and(|last| last.code == Code::InitialValue && last.primary.span == span) {
            return;
        }
        let label = "digits below the time base are cut off";
        let mut message = Diagnostic::new(Code::InitialValue, span, title).label(label).help(help);
        message.severity = Severity::Warning;
        self.report(message);
    }
}
