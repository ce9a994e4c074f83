//! Calls of blocks in rows of actions and permanent instructions. Source: GRAPH reference A.2, call_stmt.
//!
//! All parameters are written with `:=`, also outputs; the interface of the block shows which are outputs.

use plcc_diag::Code;
use plcc_syntax::ast::{BlockName, BlockPrefix, OperandKind};
use plcc_syntax::chart::ast::Call;
use plcc_syntax::scl::ast::{
    Argument, AssignOp, Expr as Node, ExprKind as NodeKind, Name, NameForm, Statement as Tree,
    StatementKind as TreeKind,
};

use crate::bind::chart::ChartBinder;
use crate::bind::globals::names::code_kind;
use crate::bind::scl::SclBlock;
use crate::bind::scl::call::is_result;
use crate::bind::scl::callee::Callee;
use plcc_binding::fold;
use plcc_model::scl::Statement;
use plcc_model::{BlockKey, Direction};

impl ChartBinder<'_, '_> {
    /// Binds a call.
    pub(super) fn chart_call(&mut self, ctx: &mut SclBlock, call: &Call) -> Vec<Statement> {
        let mut statements = Vec::new();
        let Some(callee) = self.chart_callee(ctx, call) else {
            self.note_values(ctx, call);
            return statements;
        };
        let Some(target) = self.scl().callee(ctx, &callee) else {
            self.note_values(ctx, call);
            return statements;
        };
        let key = match target {
            Callee::Block { key, .. } => Some(key),
            Callee::Function(_) => None,
        };
        let (arguments, result) = self.chart_arguments(call, key);
        let node = Node { kind: NodeKind::Call { callee: Box::new(callee), arguments }, span: call.span };
        let kind = match result {
            Some(target) => TreeKind::Assign { targets: vec![(target, AssignOp::Set)], value: node },
            None => TreeKind::Expression(node),
        };
        self.scl().statement(ctx, &Tree { kind, span: call.span }, &mut statements);
        statements
    }

    /// The arguments of a call, and the operand that receives its value.
    fn chart_arguments(&mut self, call: &Call, key: Option<BlockKey>) -> (Vec<Argument>, Option<Node>) {
        let bound = key.and_then(|key| self.program.interface(key, call.block.span));
        let parameters = bound.as_ref().map_or(&[][..], |bound| &bound.interface.parameters);
        let mut arguments = Vec::with_capacity(call.parameters.len());
        let mut result = None;
        for given in &call.parameters {
            let folded = fold(&given.name.text);
            let formal = parameters.iter().find(|parameter| fold(&parameter.name) == folded);
            if let (Some(key), Some(formal)) = (key, formal)
                && is_result(key, formal)
                && result.is_none()
            {
                result.clone_from(&given.value);
                continue;
            }
            let output = match formal {
                Some(formal) => formal.direction == Direction::Output,
                None => folded == "eno",
            };
            let (name, value) = (Some(given.name.clone()), given.value.clone());
            arguments.push(Argument { name, output, value, span: given.span });
        }
        (arguments, result)
    }

    /// The called block, in the form of SCL: `FB1.DB1`, or the instance alone.
    fn chart_callee(&mut self, ctx: &mut SclBlock, call: &Call) -> Option<Node> {
        let Some(instance) = &call.instance else {
            if let Some((prefix @ (BlockPrefix::Fb | BlockPrefix::Sfb), number)) =
                self.scl().quiet_block(ctx, &call.block)
            {
                self.call_without_instance(call, prefix, number);
                return None;
            }
            return Some(call.block.clone());
        };
        match self.scl().quiet_block(ctx, &call.block) {
            Some((BlockPrefix::Fb | BlockPrefix::Sfb, _)) => Some(match data_block(instance) {
                Some(name) => {
                    let kind = NodeKind::Member { base: Box::new(call.block.clone()), name };
                    Node { kind, span: call.block.span }
                }
                None => instance.clone(),
            }),
            Some((prefix, _)) => {
                let text = self.program.globals.text(call.block.span);
                let help = match prefix {
                    BlockPrefix::Fc | BlockPrefix::Sfc => "a function has no instance: remove the data block",
                    _ => "call a function, or a function block with its instance",
                };
                let title = format!("`{text}` is not a function block");
                self.scl().refuse(Code::ActionText, instance.span, &title, "the instance of a function block", help);
                None
            }
            // A block of the library, named by its type, or one that is defined nowhere.
            None => {
                if let NodeKind::Name(name) = &call.block.kind
                    && (self.program.globals.is_part(&name.text)
                        || self.scl().library_function(ctx.scope.rules, &name.text).is_none())
                {
                    self.scl().callee(ctx, &call.block);
                    return None;
                }
                Some(instance.clone())
            }
        }
    }

    /// Reports `CALL FB2 () (N)`.
    fn call_without_instance(&mut self, call: &Call, prefix: BlockPrefix, number: u16) {
        let key = code_kind(prefix).map(|kind| BlockKey { kind, number });
        let instances = self.program.data.blocks.iter().filter(|(_, db)| db.block.instance_of == key);
        let instance = match instances.map(|(number, _)| *number).min() {
            Some(number) => match self.program.globals.names.block_name(BlockPrefix::Db, number) {
                name if name.is_empty() => format!("DB{number}"),
                name => format!("\"{name}\""),
            },
            None => "DB…".to_owned(),
        };
        let text = self.program.globals.text(call.block.span);
        let title = format!("the call of `{text}` names no instance");
        let help = format!("write it after the block: `CALL {text}, {instance} ( … )`");
        let label = "a function block keeps its data in an instance";
        self.scl().refuse(Code::MissingOperand, call.block.span, &title, label, &help);
    }

    /// Reports names in the parameters of a call that cannot be checked.
    fn note_values(&mut self, ctx: &mut SclBlock, call: &Call) {
        let (arguments, _) = self.chart_arguments(call, None);
        self.scl().note_arguments(ctx, &arguments);
    }
}

/// The name of an instance that may be a data block.
fn data_block(instance: &Node) -> Option<Name> {
    match &instance.kind {
        NodeKind::Name(name) => (name.form != NameForm::Local).then(|| name.clone()),
        NodeKind::Absolute(OperandKind::Block(BlockName::Numbered { prefix, number, .. })) => {
            let text = format!("{}{number}", prefix.letters());
            Some(Name { text, form: NameForm::Bare, span: instance.span })
        }
        _ => None,
    }
}
