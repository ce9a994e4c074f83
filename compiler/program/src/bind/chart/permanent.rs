//! Permanent instructions, before and after the sequencers. Source: GRAPH reference A.2, perm.

use plcc_syntax::chart::ast::{Coil, Permanent, PermanentKind};

use super::engine_data::Engine;
use crate::bind::chart::ChartBinder;
use crate::bind::network::{no, yes};
use crate::bind::scl::SclBlock;
use plcc_model::scl::{Statement, StatementKind};

impl ChartBinder<'_, '_> {
    /// Binds permanent instructions, which run in each call.
    pub fn permanent_code(&mut self, ctx: &mut SclBlock, engine: &mut Engine, list: &[Permanent]) -> Vec<Statement> {
        let mut statements = Vec::new();
        for permanent in list {
            let span = permanent.span;
            match &permanent.kind {
                PermanentKind::Coil { operand, coil, value } => {
                    let value = self.condition_value(ctx, value, "this permanent instruction");
                    let operand = self.bit_operand(ctx, operand);
                    let (Some(value), Some(operand)) = (value, operand) else { continue };
                    let target = operand.access(span);
                    let write = |value| Statement { kind: StatementKind::Assign { target, value }, span };
                    let kind = match coil {
                        Coil::Assign => {
                            statements.push(write(value));
                            continue;
                        }
                        Coil::Set => {
                            StatementKind::If { branches: vec![(value, vec![write(yes(span))])], otherwise: Vec::new() }
                        }
                        Coil::Reset => {
                            StatementKind::If { branches: vec![(value, vec![write(no(span))])], otherwise: Vec::new() }
                        }
                    };
                    statements.push(Statement { kind, span });
                }
                PermanentKind::Call(call) => statements.extend(self.chart_call(ctx, call)),
                PermanentKind::Network(network) => {
                    let bound = self.networks().bind_lone_network(ctx, &mut engine.page, network);
                    self.check_leaving(&bound);
                    statements.extend(bound);
                }
            }
        }
        statements
    }
}
