//! Operands, labels and formulas of a network: parts of its text, read with the grammar of SCL.

use plcc_diag::{Code, Diagnostic, Span};

use super::Builder;
use plcc_syntax::network::ast::Language;
use plcc_syntax::network::elements;
use plcc_syntax::scl::ast::{Argument, BinaryOp, Expr, ExprKind, Name, NameForm, UnaryOp};
use plcc_syntax::scl::fragment;

impl Builder<'_, '_> {
    pub(super) fn slice(&self, span: Span) -> &str {
        self.text.text.get(span.range()).unwrap_or_default()
    }

    pub(super) fn expression(&mut self, span: Span) -> Expr {
        let (expr, messages) = fragment::expression(self.text.file, self.text.text, span.range());
        self.diagnostics.extend(messages);
        expr
    }

    /// The expression of an operand: a variable, an address or a constant.
    pub(super) fn operand(&mut self, span: Span) -> Expr {
        let (expr, messages) = fragment::expression(self.text.file, self.text.text, span.range());
        let told = messages.iter().any(|message| message.is_error() && message.code != Code::Syntax);
        self.diagnostics.extend(messages.into_iter().filter(|message| message.code != Code::Syntax));
        if told || is_operand(&expr) {
            return expr;
        }
        let help = self.as_elements(&expr).unwrap_or_else(|| {
            "write e.g. `#name`, `\"Tag\"`, `\"DB\".member`, `%I0.0` or a constant; CALCULATE has a formula".to_owned()
        });
        self.report(
            Diagnostic::new(Code::Syntax, span, format!("`{}` is not an operand", self.slice(span)))
                .label("neither a variable nor an address nor a constant")
                .help(help),
        );
        Expr { kind: ExprKind::Error, span }
    }

    /// The elements that do what the expression does: a comparison, an operation, contacts in series or in branches.
    fn as_elements(&self, expr: &Expr) -> Option<String> {
        if let ExprKind::Call { callee, arguments } = &expr.kind {
            return self.call_as_element(callee, arguments);
        }
        let ExprKind::Binary { op, left, right, .. } = &expr.kind else { return None };
        if !is_operand(left) || !is_operand(right) {
            return None;
        }
        let (left, right) = (self.slice(left.span), self.slice(right.span));
        let operation = |element: &str| {
            let written = format!("`{element}( in1 := {left}, in2 := {right}, out => … )`");
            Some(format!("write {written} before this element, and its result here"))
        };
        let (contact, gate) = match op {
            BinaryOp::Equal => ("EQ_Contact", "Eq"),
            BinaryOp::NotEqual => ("NE_Contact", "Ne"),
            BinaryOp::Greater => ("GT_Contact", "Gt"),
            BinaryOp::GreaterEqual => ("GE_Contact", "Ge"),
            BinaryOp::Less => ("LT_Contact", "Lt"),
            BinaryOp::LessEqual => ("LE_Contact", "Le"),
            BinaryOp::And if self.language == Language::Lad => {
                return Some(format!(
                    "write two elements one after the other: `Contact( {left} )  Contact( {right} )`"
                ));
            }
            BinaryOp::Or if self.language == Language::Lad => {
                return Some(format!(
                    "write two branches that end in the same wire: one for `{left}`, one for `{right}`"
                ));
            }
            BinaryOp::Add => return operation("Add"),
            BinaryOp::Subtract => return operation("Sub"),
            BinaryOp::Multiply => return operation("Mul"),
            BinaryOp::Divide | BinaryOp::DivideInteger => return operation("Div"),
            BinaryOp::Modulo => return operation("Mod"),
            BinaryOp::And | BinaryOp::Or | BinaryOp::Xor | BinaryOp::Power => return None,
        };
        let element = if self.language == Language::Lad { contact } else { gate };
        Some(format!("a comparison is an element of its own: write `{element}( in1 := {left}, in2 := {right} )`"))
    }

    /// `#list(0)`, which is an element of an array, and `ABS(#x)`.
    fn call_as_element(&self, callee: &Expr, arguments: &[Argument]) -> Option<String> {
        let name = self.slice(callee.span);
        if name.starts_with(['#', '"']) {
            let indices: Vec<&str> = arguments.iter().map(|argument| self.slice(argument.span)).collect();
            return Some(format!("an element of an array is `{name}[{}]`", indices.join(", ")));
        }
        let element = match elements::find_sd(name) {
            Some(_) => name,
            None if name.to_ascii_uppercase().contains("_TO_") => "Convert",
            None => return None,
        };
        Some(format!("write `{element}( … )` before this element, and its result here"))
    }

    /// A label; it may have the name of a keyword.
    pub(super) fn label_name(&self, span: Span) -> Name {
        let text = self.slice(span).trim_matches(['"', '#']).to_string();
        Name { text, form: NameForm::Bare, span }
    }

    pub(super) fn label_expression(&self, span: Span) -> Expr {
        Expr { kind: ExprKind::Name(self.label_name(span)), span }
    }
}

/// Whether an expression can be connected to a pin.
fn is_operand(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(_)
        | ExprKind::Name(_)
        | ExprKind::Absolute(_)
        | ExprKind::Member { .. }
        | ExprKind::MemberAbsolute { .. }
        | ExprKind::Slice { .. }
        | ExprKind::Index { .. }
        | ExprKind::Dereference(_) => true,
        ExprKind::Unary { op, operand } => {
            *op != UnaryOp::Not && matches!(operand.kind, ExprKind::Literal(_) | ExprKind::Name(_))
        }
        ExprKind::Call { .. } | ExprKind::Reference(_) | ExprKind::Binary { .. } | ExprKind::Error => false,
    }
}
