//! The network being bound: values of its nets, hidden variables, statements.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{Element, Graph, NetId};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Name, NameForm};
use rustc_hash::FxHashMap;

use super::Page;
use super::classic::Registers;
use crate::bind::declarations::path::{self, Variable};
use crate::bind::scl::SclBlock;
use crate::bind::scl::place::Spot;
use plcc_model::scl::{Access, Expr, ExprKind, Statement, StatementKind};
use plcc_model::types::DataType;

/// A variable of the frame that no source declares.
#[derive(Clone, Debug)]
pub struct Hidden {
    pub ty: Elementary,
    /// Its name in expressions of the syntax tree.
    name: String,
    byte: u32,
}

impl Hidden {
    pub fn variable(&self) -> Variable {
        Variable { base: path::Base::L, byte: self.byte, bit: 0, ty: DataType::Elementary(self.ty), untyped: false }
    }

    pub fn access(&self, span: Span) -> Access {
        Spot::fixed(self.variable()).access(span)
    }

    /// Its value.
    pub fn load(&self, span: Span) -> Expr {
        Expr { kind: ExprKind::Load(Box::new(self.access(span))), ty: self.ty, span }
    }

    /// Assigns it a value of its type.
    pub fn set(&self, value: Expr, span: Span) -> Statement {
        Statement { kind: StatementKind::Assign { target: self.access(span), value }, span }
    }

    /// The variable as an expression of the syntax tree.
    pub fn node(&self, span: Span) -> Node {
        Node { kind: NodeKind::Name(Name { text: self.name.clone(), form: NameForm::Local, span }), span }
    }
}

/// Hidden variables of a block. The next network reuses those of the one before.
pub struct Pool {
    /// By type and use: values in the order of use in a network.
    values: FxHashMap<(Elementary, Use), Vec<Hidden>>,
    taken: FxHashMap<(Elementary, Use), usize>,
    count: u32,
}

/// The use of a hidden variable. One that is passed by reference is in memory, so it is never shared with other uses.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Use {
    Value,
    Reference,
}

impl Pool {
    pub fn new(ctx: &mut SclBlock) -> Pool {
        ctx.block.local_bytes = ctx.block.local_bytes.max(ctx.block.bound.temp_bytes);
        Pool { values: FxHashMap::default(), taken: FxHashMap::default(), count: 0 }
    }

    /// The variables of the previous network become free.
    pub fn next_network(&mut self) {
        self.taken.clear();
    }

    /// A variable for this network.
    pub fn take(&mut self, ctx: &mut SclBlock, ty: Elementary, used: Use) -> Hidden {
        let at = self.taken.entry((ty, used)).or_default();
        let known = self.values.get(&(ty, used)).and_then(|list| list.get(*at)).cloned();
        *at += 1;
        known.unwrap_or_else(|| {
            let hidden = self.lasting(ctx, ty);
            self.values.entry((ty, used)).or_default().push(hidden.clone());
            hidden
        })
    }

    /// A variable for all networks of the block.
    pub fn lasting(&mut self, ctx: &mut SclBlock, ty: Elementary) -> Hidden {
        let byte = ctx.block.local_bytes.next_multiple_of(2);
        ctx.block.local_bytes = byte + ty.bits().div_ceil(8);
        self.count += 1;
        // No name of a source has this character.
        let hidden = Hidden { ty, name: format!("\u{1}{}", self.count), byte };
        ctx.scope.hidden.insert(hidden.name.clone(), hidden.variable());
        hidden
    }
}

/// A network while it is bound.
pub struct Sheet<'n> {
    pub page: &'n mut Page,
    pub graph: &'n Graph,
    /// Values at output pins, by element and pin.
    pub outputs: FxHashMap<(usize, usize), Expr>,
    /// Values of nets that have been used.
    pub nets: FxHashMap<NetId, Expr>,
    pub statements: Vec<Statement>,
    /// Outputs of the box being bound, which also have a value if it does not run.
    pub skipped: Vec<Hidden>,
}

impl<'n> Sheet<'n> {
    pub fn new(page: &'n mut Page, graph: &'n Graph) -> Sheet<'n> {
        Sheet {
            page,
            graph,
            outputs: FxHashMap::default(),
            nets: FxHashMap::default(),
            statements: Vec::new(),
            skipped: Vec::new(),
        }
    }

    pub fn element(&self, at: usize) -> &'n Element {
        &self.graph.elements[at]
    }

    pub fn registers(&self) -> &Registers {
        &self.page.registers
    }

    /// A hidden variable.
    pub fn hidden(&mut self, ctx: &mut SclBlock, ty: Elementary) -> Hidden {
        self.page.pool.take(ctx, ty, Use::Value)
    }

    /// A hidden variable that a call writes.
    pub fn hidden_reference(&mut self, ctx: &mut SclBlock, ty: Elementary) -> Hidden {
        self.page.pool.take(ctx, ty, Use::Reference)
    }

    pub fn push(&mut self, kind: StatementKind, span: Span) {
        self.statements.push(Statement { kind, span });
    }

    /// Stores a value, so that it is not computed again.
    pub fn keep(&mut self, ctx: &mut SclBlock, value: Expr) -> Expr {
        if matches!(value.kind, ExprKind::Const(_)) {
            return value;
        }
        let span = value.span;
        let hidden = self.hidden(ctx, value.ty);
        self.statements.push(hidden.set(value, span));
        hidden.load(span)
    }
}
