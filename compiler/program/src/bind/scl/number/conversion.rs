//! Functions that convert a value: `INT_TO_REAL`, `TO_INT`, `BCD_TO_INT`.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{Argument as Given, Expr as Node};

use crate::bind::scl::convert::{self, converted};
use crate::bind::scl::message::in_two_steps;
use crate::bind::scl::text::{several_bytes, short};
use crate::bind::scl::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_model::scl::Expr;

impl SclBinder<'_, '_> {
    /// `X_TO_Y(value)`, `TO_Y(value)`.
    pub fn conversion(
        &mut self,
        ctx: &mut SclBlock,
        from: Option<Elementary>,
        to: Elementary,
        given: &[Given],
        name: Span,
        span: Span,
    ) -> Option<Value> {
        let node = self.only_argument(ctx, given, span)?;
        let told = self.program.globals.report.diagnostics.len();
        let value = match from {
            Some(from) => self.of_type(ctx, node, from)?,
            None => {
                let value = self.value(ctx, node)?;
                // Of a text, or a date of several words: `TO_INT(#text)`, `TO_DATE(#dtl)`.
                match several_bytes(&value) {
                    Some(own) => match self.converted_text(ctx, &own, short(to.name()), value, name, span) {
                        Ok(value) => return value,
                        Err(value) => self.own_type(ctx, value)?,
                    },
                    None => self.own_type(ctx, value)?,
                }
            }
        };
        // A constant that does not even fit the type before is reported.
        if told == self.program.globals.report.diagnostics.len() {
            self.check_converted(&value, to);
        }
        let from = value.ty;
        match convert::explicit_expr(ctx.scope.rules, value, to) {
            Some(expr) => Some(Value::Elementary(Expr { span, ..expr })),
            None => {
                let argument = self.program.globals.text(node.span);
                let help = in_two_steps(ctx.scope.rules, from, to, &argument)
                    .unwrap_or_else(|| "convert through a type between them, for example DINT or DWORD".to_string());
                self.program.report(
                    Diagnostic::new(
                        Code::TypeMismatch,
                        span,
                        format!("there is no conversion from {} to {}", from.name(), to.name()),
                    )
                    .label("SCL does not have this function")
                    .help(help),
                );
                None
            }
        }
    }

    /// `BCD_TO_INT` and the other BCD conversions.
    pub fn bcd_conversion(&mut self, ctx: &mut SclBlock, name: &str, given: &[Given], span: Span) -> Option<Value> {
        let node = self.only_argument(ctx, given, span)?;
        let (from, conversion, to) = convert::bcd(ctx.scope.rules, name)?;
        let value = self.of_type(ctx, node, from)?;
        Some(Value::Elementary(Expr { span, ..converted(value, conversion, to) }))
    }

    /// The argument of a function of one argument, whatever its name.
    pub fn only_argument<'n>(&mut self, ctx: &mut SclBlock, given: &'n [Given], span: Span) -> Option<&'n Node> {
        if let [Given { output: false, value: Some(value), .. }] = given {
            return Some(value);
        }
        let text = self.program.globals.text(span);
        let name = text.split('(').next().unwrap_or_default().trim_end();
        let first = given.first().and_then(|first| first.value.as_ref());
        let help = match first.map(|value| self.program.globals.text(value.span)).filter(|_| given.len() > 1) {
            Some(value) if !name.is_empty() => format!("write `{name}({value})`"),
            _ => "write the value in parentheses after the name".to_owned(),
        };
        self.program.report(
            Diagnostic::new(
                if given.len() > 1 { Code::SurplusOperand } else { Code::MissingParameter },
                span,
                "this function needs one value",
            )
            .label(format!("{} arguments are given", given.len()))
            .help(help),
        );
        self.note_arguments(ctx, given);
        None
    }
}
