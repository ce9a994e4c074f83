//! RESET_TIMER and PRESET_TIMER: they change the instance of an IEC timer. Source: S7-1200 reference, timers.

use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::Expr as Node;

use super::Intent;
use super::expression::{binary_expr, constant_expr};
use super::pins::Pins;
use super::place::shifted;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_model::layout;
use plcc_model::scl::{Access, BinaryOp, StatementKind};
use plcc_model::types::DataType;

impl SclBinder<'_, '_> {
    /// The time begins again: no time has passed, Q is FALSE, and an IN that is TRUE counts as a rising edge.
    pub(super) fn reset_timer(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Vec<StatementKind>> {
        // Those of LTIME have two bits in place of a state.
        let members =
            self.timer_members(ctx, pins.get("TIMER")?, &[&["Q", "ET", "STATE"], &["Q", "ET", "RU", "OLD"]])?;
        let zero = |target: Access| {
            let value = constant_expr(0, target.elementary()?, span);
            Some(StatementKind::Assign { target, value })
        };
        members.into_iter().map(zero).collect()
    }

    /// The running time then also ends with the new PT; a negative one is 0, as at a start.
    pub(super) fn preset_timer(&mut self, ctx: &mut SclBlock, pins: &Pins) -> Option<Vec<StatementKind>> {
        let members = self.timer_members(ctx, pins.get("TIMER")?, &[&["PT", "LATCHED"]])?;
        let Ok([preset, latched]) = <[Access; 2]>::try_from(members) else { return None };
        // LTIME of a TON_LTIME.
        let ty = preset.elementary().unwrap_or(Elementary::Time);
        let value = self.of_type(ctx, pins.get("PT")?, ty);
        let mut code = Vec::new();
        let value = self.kept(ctx, &mut code, value?);
        let zero = constant_expr(0, ty, value.span);
        let duration = binary_expr(BinaryOp::Max, value.clone(), zero, ty, value.span);
        code.push(StatementKind::Assign { target: preset, value });
        code.push(StatementKind::Assign { target: latched, value: duration });
        Some(code)
    }

    /// Components of the instance of an IEC timer: the first of the lists of names that it has.
    fn timer_members(&mut self, ctx: &mut SclBlock, node: &Node, lists: &[&[&str]]) -> Option<Vec<Access>> {
        let access = self.access(ctx, node, Intent::Both)?;
        let member = |name: &&str| match &access.ty {
            DataType::Struct(ty) => {
                let member = ty.members.iter().find(|member| member.name.eq_ignore_ascii_case(name))?;
                shifted(&access, member.byte, member.bit, &member.ty)
            }
            _ => None,
        };
        let members: Option<Vec<Access>> = lists.iter().find_map(|names| names.iter().map(member).collect());
        // Those of an S7-300 have a STATE, too.
        let members = members.filter(|_| member(&"LATCHED").is_some());
        if members.is_none() {
            let label = format!("of type {}", layout::type_name(&access.ty));
            let help =
                "name a variable of type TON_TIME, TOF_TIME, TP_TIME, TONR_TIME or IEC_TIMER, or the data block of one";
            self.refuse(Code::TypeMismatch, node.span, "this is not an IEC timer", &label, help);
        }
        members
    }
}
