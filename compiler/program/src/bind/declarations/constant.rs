//! Constants in declarations: bounds of arrays, lengths of texts, constants of the block that is declared.

use plcc_binding::constant::Constant;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Bound;
use plcc_syntax::scl::ast::Expr;

use crate::bind::declarations::Declarations;

impl Declarations<'_> {
    /// A bound, a length, an index or a number of repetitions.
    pub fn bound(&mut self, bound: &Bound) -> Option<i64> {
        match bound {
            Bound::Number(number, _) => Some(*number),
            Bound::Expr(value) => {
                let constant = self.scope_constant(value)?;
                match constant.integer().map(i64::try_from) {
                    Some(Ok(number)) => Some(number),
                    Some(Err(_)) => {
                        self.report(
                            Diagnostic::new(Code::LiteralRange, value.span, "this number is too large here")
                                .label("more than an array can have"),
                        );
                        None
                    }
                    None => {
                        self.report(
                            Diagnostic::new(Code::TypeMismatch, value.span, "an integer is expected here")
                                .label(format!("this is {}", constant.describe())),
                        );
                        None
                    }
                }
            }
            Bound::Name(name, span) => self.constant_number(name).or_else(|| self.unknown_bound(name, *span)),
            Bound::Path(path) => match path.name() {
                Some(name) => self.constant_number(name).or_else(|| self.unknown_bound(name, path.span)),
                None => {
                    let text = self.globals.text(path.span);
                    self.unknown_bound(&text, path.span)
                }
            },
        }
    }

    /// The value of a constant of the block or of the program that is an integer.
    pub fn constant_number(&self, name: &str) -> Option<i64> {
        let folded = plcc_binding::fold(name);
        let constant = self.types.scope.constants.get(&folded).or_else(|| self.globals.names.constants.get(&folded));
        constant.and_then(Constant::integer).and_then(|number| i64::try_from(number).ok())
    }

    /// Reports a name that is not a constant, in a declaration.
    fn unknown_bound<T>(&mut self, name: &str, span: Span) -> Option<T> {
        self.globals.unknown_constant(name, false, span);
        None
    }

    /// Reports a name that is not a constant, as the index of a statement.
    pub fn not_a_constant<T>(&mut self, name: &str, span: Span) -> Option<T> {
        if self.types.scope.scl || self.globals.input.partial {
            self.globals.unknown_constant(name, false, span);
            return None;
        }
        self.report(
            Diagnostic::new(Code::ConstantRequired, span, format!("`{name}` is not a constant"))
                .label("a number is expected here")
                .help("an index that changes needs an S7-1500; other CPUs use a pointer, e.g. `L DBW [AR1,P#0.0]`"),
        );
        None
    }

    /// A constant expression among the declarations of a block.
    pub fn scope_constant(&mut self, value: &Expr) -> Option<Constant> {
        let constants = std::mem::take(&mut self.types.scope.constants);
        let constant = self.globals.constant(&constants, value);
        self.types.scope.constants = constants;
        constant
    }
}
