//! Which block an instruction for texts or dates is, where several have its name: for STRING or WSTRING, DTL or DATE_AND_TIME, and for long
//! texts of wide characters.

use plcc_stdlib::SystemBlock;
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::{Argument as Given, AssignOp, Expr as Node, ExprKind as NodeKind, Name};

use crate::bind::scl::call::is_result;
use crate::bind::scl::callee::Callee;
use crate::bind::scl::function::Named;
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::BlockKey;
use plcc_model::types::DataType;

/// True of a value that is a text of wide characters.
pub fn is_wide_text(value: &Value) -> bool {
    match value {
        Value::Complex { ty, .. } => matches!(ty, DataType::WideString(_)),
        Value::Constant(constant, _) => matches!(constant, Constant::WideText(_)),
        _ => false,
    }
}

/// Most characters of a result of wide characters, but for instructions of [`for_long_texts`].
const USUAL_MAX: u16 = 254;

/// The end of the names of instructions for wide characters.
const WIDE: &str = "_WSTRING";

/// True of a text of wide characters that may have more of them than most results.
pub fn is_long_text(value: &Value) -> bool {
    match value {
        Value::Complex { ty, .. } => is_long_type(ty),
        Value::Constant(Constant::WideText(text), _) => text.len() > usize::from(USUAL_MAX),
        _ => false,
    }
}

fn is_long_type(ty: &DataType) -> bool {
    matches!(ty, DataType::WideString(most) if *most > USUAL_MAX)
}

/// The instruction for long texts of wide characters, where `name` is the usual one: `LEFT` or `LEFT_WSTRING`.
pub fn for_long_texts(name: &str) -> Option<&'static SystemBlock> {
    let parts = name.len().checked_sub(WIDE.len()).and_then(|at| name.split_at_checked(at));
    let base = parts.filter(|(_, end)| end.eq_ignore_ascii_case(WIDE)).map_or(name, |(base, _)| base);
    plcc_stdlib::find_tia(&format!("{base}_LONG{WIDE}"))
}

/// The key that selects among the blocks of an instruction.
enum Overload<'n> {
    Clock,
    /// A time of day.
    TimeOfDay(Option<&'n Node>),
    /// A text.
    Text(Option<&'n Node>),
}

/// The argument with this name (lower case), or the last: the text of Chars_TO_Strg, the time of day of T_COMBINE.
fn named_or_last<'n>(given: &'n [Given], own: &str) -> Option<&'n Node> {
    let named = given.iter().find(|argument| argument.name.as_ref().is_some_and(|name| fold(&name.text) == own));
    named.or_else(|| given.last().filter(|argument| argument.name.is_none()))?.value.as_ref()
}

/// The first argument that is not EN or ENO.
fn first_text(given: &[Given]) -> Option<&Node> {
    let enable = |name: &Name| matches!(fold(&name.text).as_str(), "en" | "eno");
    given.iter().find(|argument| !argument.name.as_ref().is_some_and(enable))?.value.as_ref()
}

impl SclBinder<'_, '_> {
    /// An instruction with a separate block for the type of an operand: LEN, MID and others of a WSTRING, RD_SYS_T and related ones of
    /// DATE_AND_TIME and LDT, T_COMBINE of an LTOD. CONCAT selects by itself.
    pub fn overload(&mut self, ctx: &mut SclBlock, callee: &Node, given: &[Given]) -> Option<BlockKey> {
        let NodeKind::Name(name) = &callee.kind else { return None };
        let own = name.text.trim();
        let deciding = first_text(given);
        let kind = match plcc_stdlib::find_tia(own).filter(|_| Named::find(own).is_none())?.name {
            "RD_SYS_T" | "RD_LOC_T" | "WR_SYS_T" | "WR_LOC_T" => Overload::Clock,
            "T_COMBINE" => Overload::TimeOfDay(named_or_last(given, "in2")),
            "Chars_TO_Strg" => Overload::Text(named_or_last(given, "strg")),
            _ => Overload::Text(deciding),
        };
        if self.is_instance(ctx, name) || self.program.globals.names.symbols.contains_key(&fold(own)) {
            return None;
        }
        let suffix = match kind {
            Overload::Clock => match self.quiet_type(ctx, deciding?)? {
                DataType::DateAndTime => "DT",
                DataType::Elementary(Elementary::Ldt) => "LDT",
                _ => return None,
            },
            Overload::TimeOfDay(node) => {
                let node = node?;
                let is_long = match &node.kind {
                    // Calls are not bound for this, as in `is_wide`.
                    NodeKind::Call { callee, .. } => matches!(
                        &callee.kind,
                        NodeKind::Name(name) if name.text.to_ascii_uppercase().ends_with("TO_LTOD")
                    ),
                    _ => self.quiet_type(ctx, node) == Some(DataType::Elementary(Elementary::Ltod)),
                };
                let block = plcc_stdlib::find_tia("CONCAT_DATE_LTOD").filter(|_| is_long)?;
                return Some(self.program.globals.library.key_of(block));
            }
            Overload::Text(node) => {
                let is_named_so = own.to_ascii_uppercase().ends_with(WIDE);
                let is_wide =
                    is_named_so || plcc_stdlib::find_tia(&format!("{own}{WIDE}")).is_some() && self.is_wide(ctx, node?);
                if !is_wide {
                    return None;
                }
                if let Some(block) = for_long_texts(own)
                    && (ctx.scope.long_texts || given.iter().any(|one| self.is_long(ctx, one.value.as_ref())))
                {
                    return Some(self.program.globals.library.key_of(block));
                }
                if is_named_so {
                    return None;
                }
                "WSTRING"
            }
        };
        plcc_stdlib::find_tia(&format!("{own}_{suffix}")).map(|block| self.program.globals.library.key_of(block))
    }

    /// The type of an expression; reports no mistakes in it.
    fn quiet_type(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<DataType> {
        match self.quiet_value(ctx, node)? {
            Value::Elementary(expr) => Some(DataType::Elementary(expr.ty)),
            Value::Complex { ty, .. } => Some(ty),
            Value::Constant(Constant::Typed { ty, .. }, _) => Some(DataType::Elementary(ty)),
            Value::Constant(Constant::DateAndTime(_), _) => Some(DataType::DateAndTime),
            _ => None,
        }
    }

    /// True of an expression of type WSTRING; reports no mistakes in it.
    fn is_wide(&mut self, ctx: &mut SclBlock, node: &Node) -> bool {
        match &node.kind {
            // Calls are not bound for this, so that a chain of them is not bound repeatedly.
            NodeKind::Call { callee, arguments } => match &callee.kind {
                NodeKind::Name(name) if name.text.to_ascii_uppercase().ends_with("WSTRING") => true,
                NodeKind::Name(name) if plcc_stdlib::find_tia(&format!("{}_WSTRING", name.text.trim())).is_some() => {
                    first_text(arguments).is_some_and(|first| self.is_wide(ctx, first))
                }
                _ => self.gives_wide_text(ctx, callee),
            },
            NodeKind::Name(_) | NodeKind::Member { .. } | NodeKind::Index { .. } | NodeKind::Literal(_) => {
                self.quiet_value(ctx, node).as_ref().is_some_and(is_wide_text)
            }
            _ => false,
        }
    }

    /// True of an expression whose value [`is_long_text`]; reports no mistakes in it.
    fn is_long(&mut self, ctx: &mut SclBlock, node: Option<&Node>) -> bool {
        let Some(node) = node else { return false };
        match &node.kind {
            // As in `is_wide`. A function of texts gives no longer texts than it is given.
            NodeKind::Call { callee, arguments } => match &callee.kind {
                NodeKind::Name(name) if for_long_texts(name.text.trim()).is_some() => {
                    arguments.iter().any(|one| self.is_long(ctx, one.value.as_ref()))
                }
                _ => self.gives(ctx, callee, is_long_type),
            },
            NodeKind::Name(_) | NodeKind::Member { .. } | NodeKind::Index { .. } | NodeKind::Literal(_) => {
                self.quiet_value(ctx, node).as_ref().is_some_and(is_long_text)
            }
            _ => false,
        }
    }

    /// Whether the value of an assignment is a call of an instruction for texts, and goes to a text with room for more characters than
    /// most results have; reports no mistakes.
    pub fn goes_to_long_text(&mut self, ctx: &mut SclBlock, targets: &[(Node, AssignOp)], value: &Node) -> bool {
        let NodeKind::Call { callee, .. } = &value.kind else { return false };
        let NodeKind::Name(name) = &callee.kind else { return false };
        for_long_texts(name.text.trim()).is_some()
            && targets.iter().any(|(target, _)| {
                let access = self.quietly(ctx, |binder, ctx| binder.access(ctx, target, Intent::Write));
                access.is_some_and(|access| is_long_type(&access.ty))
            })
    }

    /// True of a function whose result is a WSTRING; reports no mistakes.
    fn gives_wide_text(&mut self, ctx: &mut SclBlock, callee: &Node) -> bool {
        self.gives(ctx, callee, |ty| matches!(ty, DataType::WideString(_)))
    }

    /// True of a function whose result is of such a type; reports no mistakes.
    fn gives(&mut self, ctx: &mut SclBlock, callee: &Node, is_such: impl Fn(&DataType) -> bool) -> bool {
        self.quietly(ctx, |binder, ctx| match binder.callee(ctx, callee) {
            Some(Callee::Block { key, instance: None }) => {
                binder.program.interface(key, callee.span).is_some_and(|bound| {
                    let mut parameters = bound.interface.parameters.iter();
                    parameters.any(|one| is_result(key, one) && is_such(&one.ty))
                })
            }
            _ => false,
        })
    }
}
