//! Binding of SCL: names, types and conversions of statements and expressions.
//!
//! - `statement`: statements and loops; `assign`: assignments; `case`: CASE; `flow`: labels, jumps and data that is never written.
//! - `expression`: operators; `numeric`: the types that they work in; `time`: dates and times; `compare`: comparisons.
//! - `convert`: the conversions of each dialect; `coerce`, `complex`: values in the required type; `constant`: constants in their context;
//!   `bounds`: between which values an expression stays.
//! - `access`: variables; `operand`: a name or an address alone; `component`: components and slices; `peripheral`: `:P`; `indexed`: indexed
//!   addresses; `place`: what all these result in.
//! - `call`: calls; `callee`: what they name; `instance`: instances in them; `unknown_function`: names without a meaning; `arguments`,
//!   `actual`, `pointer`: what they pass.
//! - `function`: the functions of the language, one table row each; `pins`: their arguments; `number`, `timer`, `memory`, `array`, `text`:
//!   what they compute; `known`: constants with which they cannot; `signature`: what an editor shows of them.
//! - `variant`: queries of a VARIANT.
//! - `value`: what an expression is before its context decides on its type; `message`: messages that several of these report.
//! - `address_numbers`: operands in charts of S7-GRAPH V5; `scope`: what is known of a block while its statements are bound.

mod access;
mod actual;
mod address_numbers;
mod arguments;
mod array;
pub(in crate::bind) mod assign;
pub(in crate::bind) mod bounds;
pub(in crate::bind) mod call;
pub(in crate::bind) mod callee;
mod case;
pub(in crate::bind) mod coerce;
mod compare;
mod complex;
mod component;
pub(in crate::bind) mod constant;
pub(in crate::bind) mod convert;
mod enable;
pub(in crate::bind) mod expression;
mod flow;
pub(in crate::bind) mod function;
mod habits;
mod iec_timer;
mod indexed;
pub(in crate::bind) mod instance;
mod known;
mod memory;
pub(in crate::bind) mod message;
pub(in crate::bind) mod naming;
mod number;
pub(in crate::bind) mod numeric;
mod operand;
mod peripheral;
mod pins;
pub(in crate::bind) mod place;
mod pointer;
mod reference;
mod result;
mod scatter;
pub(in crate::bind) mod scope;
pub(in crate::bind) mod signature;
mod statement;
pub(in crate::bind) mod temporary;
mod text;
mod text_number;
mod time;
mod timer;
mod unknown_function;
pub(in crate::bind) mod value;
pub(in crate::bind) mod variant;

#[cfg(test)]
mod call_tests;
#[cfg(test)]
pub(in crate::bind) mod tests;

use plcc_syntax::ast;
use plcc_syntax::chart::ast as chart;
use plcc_syntax::scl::ast::{Body as Tree, Dialect, ExprKind, NameForm, StatementKind};

use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
pub use crate::bind::globals::rules::Rules;
use crate::bind::stl::StlBinder;
use plcc_model::scl::SclBody;
pub use scope::Scope;
pub(in crate::bind) use statement::leaves;

/// The purpose of an access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intent {
    Read,
    Write,
    /// IN_OUT.
    Both,
}

/// A block while statements and expressions of SCL are bound in it.
pub struct SclBlock<'c> {
    pub block: &'c mut CurrentBlock,
    pub scope: Scope,
}

/// Binds statements and expressions of SCL.
pub struct SclBinder<'b, 'a> {
    program: &'b mut Declarations<'a>,
}

impl<'b, 'a> SclBinder<'b, 'a> {
    pub fn new(program: &'b mut Declarations<'a>) -> SclBinder<'b, 'a> {
        SclBinder { program }
    }

    /// STL, for the assertions of tests.
    fn stl(&mut self) -> StlBinder<'_, 'a> {
        StlBinder::new(self.program)
    }
}

impl SclBinder<'_, '_> {
    /// Binds the statements of a block.
    pub fn bind_block(&mut self, current: &mut CurrentBlock, block: &ast::CodeBlock, body: &Tree) -> SclBody {
        let scope = Scope::new(self.program.globals.input, &block.header, body.dialect);
        let ctx = &mut SclBlock { block: current, scope };
        ctx.scope.marks_locals = marks_locals(&block.code);
        self.collect_labels(ctx, &body.statements);
        let statements = self.statements(ctx, &body.statements);
        let is_empty = body.statements.iter().all(|statement| matches!(statement.kind, StatementKind::Empty));
        self.unused_data(ctx, block, is_empty);
        let scope = &ctx.scope;
        SclBody {
            statements,
            sets_flag: scope.sets_flag,
            calls_set_flag: scope.rules != Rules::Classic,
            temporary_texts: temporary::texts(&ctx.block.bound),
            networks: Vec::new(),
            inputs_in_place: false,
            named_dbs: scope.named_dbs.clone(),
        }
    }
}

/// Whether a block of the TIA Portal writes its locals with `#`, so that a name in quotes is a global one.
pub fn marks_locals(code: &ast::Code) -> bool {
    let is_tia = match code {
        ast::Code::Scl(body) => body.dialect == Dialect::Tia,
        ast::Code::Graphic(_) => true,
        ast::Code::Chart(body) => body.dialect == chart::Dialect::Tia,
        ast::Code::Stl(_) => false,
    };
    if !is_tia {
        return false;
    }
    let mut found = false;
    crate::bind::trees::mentions::expressions(code, &mut |value| {
        found |= matches!(&value.kind, ExprKind::Name(name) if name.form == NameForm::Local);
    });
    found
}
