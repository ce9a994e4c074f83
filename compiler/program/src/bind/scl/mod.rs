//! Binding of SCL: names, types and conversions of statements and expressions.
//!
//! - `statement`: statements, labels, loops.
//! - `expression`: operators, and the types of what they combine; `convert`: implicit conversions of each dialect.
//! - `access`: names, components, indices, slices, absolute addresses.
//! - `call`: calls of blocks; `function`: the functions of the language, one table row each.
//! - `value`: what an expression is before its context decides on its type.

mod value;

use plcc_syntax::Elementary;
use plcc_syntax::ast;
use plcc_syntax::scl::ast::{Body as Tree, Expr as Node};

use super::{Binder, Ctx};
use crate::model::scl::{Access, Body, Complex, Expr};
use crate::types::DataType;
use value::Value;

/// The rules that a block's source and the CPU choose together. Source: SCL reference, dialects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rules {
    /// S7-SCL of STEP 7 V5.
    Classic,
    /// TIA Portal, S7-300/400.
    Tia300,
    /// TIA Portal, S7-1200.
    Tia1200,
    /// TIA Portal, S7-1500; also what a TIA source without a named CPU is taken for.
    Tia1500,
}

/// What an access is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intent {
    Read,
    Write,
    /// IN_OUT.
    Both,
}

impl Binder<'_> {
    /// Binds the statements of a block.
    pub fn bind_scl(&mut self, _ctx: &mut Ctx, _block: &ast::CodeBlock, _body: &Tree) -> Body {
        Body::default()
    }

    /// Binds an expression, calls included.
    fn scl_value(&mut self, _ctx: &mut Ctx, _node: &Node) -> Option<Value> {
        None
    }

    /// Binds an expression that must give a value of type `ty`, by implicit conversion if need be.
    fn scl_of_type(&mut self, _ctx: &mut Ctx, _node: &Node, _ty: Elementary) -> Option<Expr> {
        None
    }

    /// Gives a bound value the type `ty`, by implicit conversion if need be; what has no conversion is reported.
    fn scl_convert(&mut self, _ctx: &mut Ctx, _value: Value, _ty: Elementary) -> Option<Expr> {
        None
    }

    /// Binds an expression that must give a value of the complex type `ty` (a text may have another length).
    fn scl_complex(&mut self, _ctx: &mut Ctx, _node: &Node, _ty: &DataType) -> Option<Complex> {
        None
    }

    /// Binds a variable.
    fn scl_access(&mut self, _ctx: &mut Ctx, _node: &Node, _intent: Intent) -> Option<Access> {
        None
    }

    /// Binds a call: of a block, an instance, a function of the language. `statement`: its value may be dropped.
    fn scl_call(&mut self, _ctx: &mut Ctx, _node: &Node, _statement: bool) -> Option<Value> {
        None
    }
}
