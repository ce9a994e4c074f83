//! Constants of declarations and statements: looks up names, and reports anything that is not a constant.

use plcc_binding::constant::fold::{self, Fault};
use plcc_binding::constant::{Constant, Constants, fit};
use plcc_binding::rewrite;
use plcc_binding::value::{self, Mismatch};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::layout;
use plcc_model::types::DataType;
use plcc_syntax::Elementary;
use plcc_syntax::literal::Literal;
use plcc_syntax::scl::ast::{Expr, ExprKind, Name, NameForm};

use crate::bind::globals::Globals;

impl Globals<'_> {
    /// The value of a constant expression; reports anything that is not a constant.
    pub fn constant(&mut self, constants: &Constants, value: &Expr) -> Option<Constant> {
        match &value.kind {
            ExprKind::Literal(literal) => {
                let constant = Constant::of_literal(literal);
                if constant.is_none() {
                    self.no_constant(value.span, "a pointer is not possible here");
                }
                constant
            }
            ExprKind::Name(name) => self.named_constant(constants, name),
            ExprKind::Unary { op, operand } => {
                let operand = self.constant(constants, operand)?;
                let result = fold::unary(*op, &operand);
                self.computed(result, value.span)
            }
            ExprKind::Binary { op, left, right, op_span } => {
                // Both sides, so that each mistake is reported.
                let left = self.constant(constants, left);
                let right = self.constant(constants, right);
                let result = fold::binary(*op, &left?, &right?);
                let span = if result == Err(Fault::Overflow) { value.span } else { *op_span };
                self.computed(result, span)
            }
            ExprKind::Error => None,
            ExprKind::Absolute(_)
            | ExprKind::Member { .. }
            | ExprKind::MemberAbsolute { .. }
            | ExprKind::Slice { .. }
            | ExprKind::Index { .. }
            | ExprKind::Call { .. }
            | ExprKind::Dereference(_)
            | ExprKind::Reference(_) => {
                self.no_constant(value.span, "this is only known at run time");
                None
            }
        }
    }

    /// The constant of a declaration in STL, with all digits that an LREAL has; `None`: a pointer.
    pub fn constant_of_stl(&self, literal: &Literal, span: Span) -> Option<Constant> {
        match literal {
            Literal::Real(value) => {
                Some(Constant::Real(value::long_real(&self.text(span)).unwrap_or(f64::from(*value))))
            }
            other => Constant::of_stl(other),
        }
    }

    /// The bits of a constant as a value of `ty`, zero-extended, implicitly converted if needed; reports a value that does not fit.
    ///
    /// Source: SCL reference, type of a literal. An integer without a type fits every type that can hold it, `16#FFFF` also an INT.
    pub fn constant_bits(&mut self, constant: &Constant, ty: Elementary, span: Span) -> Option<u64> {
        match self.nearest(constant, ty, span).bits(ty) {
            Ok(bits) => Some(bits),
            Err(problem) => {
                let (name, text) = (ty.name(), self.text(span));
                self.report.push(match problem {
                    Mismatch::Type => Diagnostic::new(
                        Code::TypeMismatch,
                        span,
                        format!("{} is not of type {name}", constant.describe()),
                    )
                    .label(format!("a value of type {name} is expected here"))
                    .help(rewrite::help(ty, &text, rewrite::Form::Scl)),
                    Mismatch::Range => {
                        Diagnostic::new(Code::LiteralRange, span, format!("`{text}` does not fit type {name}"))
                            .label(rewrite::holds(ty))
                            .help(rewrite::wanted(ty))
                    }
                });
                None
            }
        }
    }

    /// A number without a type as the REAL that is nearest to its digits, where another one is nearest to its LREAL; else the constant.
    pub fn nearest(&self, constant: &Constant, ty: Elementary, span: Span) -> Constant {
        match constant {
            Constant::Real(value) if ty == Elementary::Real && fit::is_halfway(*value) => {
                match fit::nearest_real(*value, &self.text(span)) {
                    Some(near) => Constant::Typed { ty, bits: u64::from(near.to_bits()) },
                    None => constant.clone(),
                }
            }
            other => other.clone(),
        }
    }

    /// A constant in hexadecimal for a REAL or LREAL that looks like the bits of an ordinary number, and is a number itself.
    pub fn number_for_bits(&self, constant: &Constant, ty: Elementary, span: Span) -> Option<Diagnostic> {
        let Constant::Integer { value, based: true } = constant else { return None };
        let (of_bits, word, prefix) = match ty {
            Elementary::Real => (f64::from(f32::from_bits(u32::try_from(*value).ok()?)), "DWORD", "DW"),
            Elementary::Lreal => (f64::from_bits(u64::try_from(*value).ok()?), "LWORD", "LW"),
            _ => return None,
        };
        // Divisors and masks, 16#1_0000 and 16#FFFF_FFFF, are the bits of tiny numbers or of none.
        if !(1e-9..1e12).contains(&of_bits.abs()) {
            return None;
        }
        let written = self.text(span);
        let help = match written.starts_with(|first: char| first.is_ascii_digit()) {
            true => format!("for these bits write `{word}_TO_{}({prefix}#{written})`", ty.name()),
            false => "write the number in decimal, with a point".to_owned(),
        };
        let title = format!("`{written}` is a number here, not the bits of a value of type {}", ty.name());
        Some(Diagnostic::new(Code::Tolerated, span, title).label(format!("taken as {value}.0")).help(help))
    }

    /// The bytes of a constant as a variable of type `ty`, big-endian; a BOOL is one byte, 0 or 1.
    pub fn constant_bytes(constant: &Constant, ty: &DataType) -> Result<Vec<u8>, Mismatch> {
        fit::bytes(constant, ty)
    }

    fn named_constant(&mut self, constants: &Constants, name: &Name) -> Option<Constant> {
        let folded = plcc_binding::fold(&name.text);
        if let Some(constant) = constants.get(&folded).or_else(|| self.names.constants.get(&folded)) {
            return Some(constant.clone());
        }
        self.unknown_constant(&name.text, name.form == NameForm::Local, name.span);
        None
    }

    /// A name that is not a constant. It may be undefined (`local`: only the block itself could define it), or mean something else.
    pub fn unknown_constant(&mut self, name: &str, local: bool, span: Span) {
        if self.is_refused(name) {
            return;
        }
        if local || self.names.symbols.contains_key(&plcc_binding::fold(name)) {
            self.report.push(
                Diagnostic::new(Code::ConstantRequired, span, format!("`{name}` is not a constant of this block"))
                    .label("a value that is known at compile time is expected here")
                    .help("declare it first, in VAR CONSTANT or CONST, or write the number"),
            );
            return;
        }
        self.report.missing_constant(name, span);
    }

    /// Whether some block declares a constant of that name, with a type or value that has been reported.
    pub fn is_refused(&self, name: &str) -> bool {
        let told = &self.told.constants;
        !told.is_empty() && told.contains(&plcc_binding::fold(name)) && !self.report.is_clean()
    }

    fn no_constant(&mut self, span: Span, why: &str) {
        self.report
            .push(Diagnostic::new(Code::ConstantRequired, span, "a constant is expected here").label(why.to_string()));
    }

    fn computed(&mut self, result: Result<Constant, Fault>, span: Span) -> Option<Constant> {
        let fault = match result {
            Ok(constant) => return Some(constant),
            Err(fault) => fault,
        };
        self.report.push(match fault {
            Fault::Overflow => {
                Diagnostic::new(Code::LiteralRange, span, "the value of this expression is out of range")
                    .label("the type of the operands cannot hold it")
            }
            Fault::Zero => {
                Diagnostic::new(Code::LiteralRange, span, "a division by zero").label("the right operand is 0")
            }
            Fault::Type => {
                Diagnostic::new(Code::TypeMismatch, span, "this operator cannot combine constants of these types")
                    .label("only numbers, bit strings and durations are possible")
            }
        });
        None
    }

    /// Reports an initial value that its variable cannot have.
    pub fn bad_initial(&mut self, what: &str, ty: &DataType, problem: Mismatch, span: Span) {
        let (name, text) = (layout::type_name(ty), self.text(span));
        let message = match problem {
            Mismatch::Type => {
                Diagnostic::new(Code::InitialValue, span, format!("{what} is not a value of type {name}"))
                    .label(format!("the variable is of type {name}"))
            }
            Mismatch::Range => Diagnostic::new(Code::InitialValue, span, format!("`{text}` does not fit type {name}"))
                .label(match ty {
                    DataType::Elementary(elementary) => rewrite::holds(*elementary),
                    DataType::String(room) => format!("longer than {room} characters"),
                    DataType::WideString(room) => format!("longer than {room} characters"),
                    _ => "out of range".to_string(),
                }),
        };
        self.report.push(match ty {
            DataType::Elementary(Elementary::Bool) if problem == Mismatch::Range => {
                message.help(rewrite::wanted(Elementary::Bool))
            }
            DataType::Elementary(elementary) if problem == Mismatch::Range => {
                message.help(format!("{}, or give the variable a larger type", rewrite::wanted(*elementary)))
            }
            DataType::Elementary(elementary) => message.help(rewrite::help(*elementary, &text, rewrite::Form::Scl)),
            DataType::String(_) | DataType::WideString(_) if problem == Mismatch::Range => {
                message.help("shorten the text, or declare the variable with more characters in `[ ]`")
            }
            DataType::String(_) => message.help(rewrite::text(&text)),
            DataType::WideString(_) => message.help(rewrite::text(&text).replace("`'", "`WSTRING#'")),
            DataType::DateAndTime => message.help(rewrite::date_and_time(&text)),
            DataType::Array(_)
            | DataType::Struct(_)
            | DataType::Parameter(_)
            | DataType::OpenArray(_)
            | DataType::Void => message,
        });
    }
}
