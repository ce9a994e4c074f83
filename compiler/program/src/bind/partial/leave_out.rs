//! Leaves out what cannot be bound although everything missing has a stand-in: the smallest part around a message that can
//! be removed without a change in the meaning of the parts around it.

use plcc_binding::stand_ins::LeftOut;
use plcc_diag::{FileId, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{self, Block, Code, SourceUnit, StatementKind as StlKind};
use plcc_syntax::chart::ast as chart;
use plcc_syntax::network::ast as network;
use plcc_syntax::scl::ast as scl;

/// Leaves out the part at `at`; `None` if nothing there can be removed, or if that has been done since `earlier`, for another message
/// about the same part.
pub fn leave_out(units: &mut [(FileId, SourceUnit)], earlier: &[(FileId, SourceUnit)], at: Span) -> Option<LeftOut> {
    let place = units.iter().position(|(file, _)| *file == at.file)?;
    let (unit, earlier) = (&mut units[place].1, &earlier[place].1);
    let size = |block: &Block| block.span().end - block.span().start;
    // In exports a block may be shown by its name alone, so any block of the file can contain the position.
    let mut order: Vec<usize> = (0..unit.blocks.len()).collect();
    order.sort_by_key(|&index| (!holds(unit.blocks[index].span(), at), size(&unit.blocks[index])));
    if let Some(left) = order.iter().find_map(|&index| part(&mut unit.blocks[index], at)) {
        return Some(left);
    }
    let index = *order.first()?;
    let around = if holds(unit.blocks[index].span(), at) { &order[..1] } else { &order[..] };
    let is_done = |index: usize| {
        let (now, before) = (&unit.blocks[index], &earlier.blocks[index]);
        is_emptied(now, before, at) || part(&mut before.clone(), at).is_some()
    };
    if around.iter().any(|&index| is_done(index)) {
        return None;
    }
    // A message of the block as a whole.
    whole(&mut unit.blocks[index], at)
}

/// Leaves out the part of a block that holds `at`.
fn part(block: &mut Block, at: Span) -> Option<LeftOut> {
    match block {
        Block::Code(code) => code_block(code, at),
        Block::Data(data) => {
            let before = data.values.len();
            data.values.retain(|value| !holds(value.span, at));
            if data.values.len() < before {
                return Some(LeftOut { span: at, what: "this start value" });
            }
            match &mut data.content {
                ast::DataContent::Struct(variables) => declaration(variables, at),
                ast::DataContent::Array(_, initial @ Some(_)) if holds(data.span, at) => {
                    *initial = None;
                    Some(LeftOut { span: at, what: "this start value" })
                }
                ast::DataContent::OfType(_) | ast::DataContent::Array(..) | ast::DataContent::Empty => None,
            }
        }
        Block::Type(ty) => declaration(&mut ty.members, at),
    }
}

/// Whether the statement at `at` has been left out. Blocks with many messages are not copied for each of them.
fn is_emptied(now: &Block, before: &Block, at: Span) -> bool {
    let (Block::Code(now), Block::Code(before)) = (now, before) else { return false };
    match (&now.code, &before.code) {
        (Code::Scl(now), Code::Scl(before)) => {
            let is_empty = |body: &scl::Body| {
                innermost(&body.statements, at).map(|kind| matches!(kind, scl::StatementKind::Empty))
            };
            (is_empty(now), is_empty(before)) == (Some(true), Some(false))
        }
        (Code::Stl(now), Code::Stl(before)) => {
            let is_empty = |networks: &[ast::Network]| {
                let mut statements = networks.iter().flat_map(|network| &network.statements);
                let statement = statements.find(|statement| holds(statement.span, at))?;
                Some(matches!(statement.kind, StlKind::Empty))
            };
            (is_empty(now), is_empty(before)) == (Some(true), Some(false))
        }
        _ => false,
    }
}

/// The smallest statement that holds `at`.
fn innermost(list: &[scl::Statement], at: Span) -> Option<&scl::StatementKind> {
    let statement = list.iter().find(|statement| holds(statement.span, at))?;
    let inner = statement.kind.bodies().into_iter().find_map(|body| innermost(body, at));
    Some(inner.unwrap_or(&statement.kind))
}

/// Leaves out the content of a block.
fn whole(block: &mut Block, at: Span) -> Option<LeftOut> {
    match block {
        Block::Code(code) => {
            let is_empty = matches!(&code.code, Code::Scl(body) if body.statements.is_empty());
            code.code = Code::Scl(scl::Body::default());
            (!is_empty).then_some(LeftOut { span: at, what: "the code of this block" })
        }
        Block::Data(data) => {
            let span = data.name.span();
            let kind = ast::TypeKind::Named("WORD".to_string());
            let bound = |value| ast::Bound::Number(value, span);
            let element = Box::new(ast::TypeRef { kind, span });
            let kind = ast::TypeKind::Array { bounds: vec![(bound(0), bound(511))], element };
            let ty = ast::TypeRef { kind, span };
            let is_same = matches!(&data.content, ast::DataContent::Array(known, None) if *known == ty);
            data.content = ast::DataContent::Array(ty, None);
            data.values.clear();
            (!is_same).then_some(LeftOut { span: at, what: "the content of this data block" })
        }
        Block::Type(_) => None,
    }
}

fn holds(outer: Span, inner: Span) -> bool {
    outer.file == inner.file && outer.start <= inner.start && inner.end <= outer.end
}

fn declaration(variables: &mut Vec<ast::Variable>, at: Span) -> Option<LeftOut> {
    for index in 0..variables.len() {
        let variable = &mut variables[index];
        if variable.initial.as_ref().is_some_and(|initial| holds(initial.span, at)) {
            variable.initial = None;
            return Some(LeftOut { span: at, what: "this start value" });
        }
        if holds(variable.ty.span, at)
            && let ast::TypeKind::Struct(inner) = &mut variable.ty.kind
            && let Some(left) = declaration(inner, at)
        {
            return Some(left);
        }
        if holds(variable.name_span, at) || holds(variable.ty.span, at) {
            variables.remove(index);
            return Some(LeftOut { span: at, what: "this declaration" });
        }
    }
    None
}

fn code_block(code: &mut ast::CodeBlock, at: Span) -> Option<LeftOut> {
    for section in &mut code.sections {
        if let Some(left) = declaration(&mut section.variables, at) {
            return Some(left);
        }
    }
    let mut initials = code.constants.iter_mut().map(|constant| &mut constant.initial);
    if let Some(initial) = initials.find(|initial| initial.as_ref().is_some_and(|initial| holds(initial.span, at))) {
        *initial = None;
        return Some(LeftOut { span: at, what: "this start value" });
    }
    let before = code.constants.len();
    code.constants.retain(|constant| {
        !holds(constant.name_span, at)
            && !constant.ty.as_ref().is_some_and(|ty| holds(ty.span, at))
            && !constant.value.as_ref().is_some_and(|value| holds(value.span, at))
    });
    if code.constants.len() < before {
        return Some(LeftOut { span: at, what: "this constant" });
    }
    match &mut code.code {
        Code::Scl(body) => scl_list(&mut body.statements, at),
        Code::Stl(networks) => networks.iter_mut().find_map(|network| stl_list(&mut network.statements, at)),
        Code::Graphic(body) => body.networks.iter_mut().find_map(|network| one_network(network, at)),
        Code::Chart(body) => one_of_chart(body, at),
    }
}

fn scl_list(list: &mut [scl::Statement], at: Span) -> Option<LeftOut> {
    let statement = list.iter_mut().find(|statement| holds(statement.span, at))?;
    let inner = match &mut statement.kind {
        scl::StatementKind::If { branches, otherwise } => branches
            .iter_mut()
            .map(|(_, body)| body)
            .find_map(|body| scl_list(body, at))
            .or_else(|| scl_list(otherwise, at)),
        scl::StatementKind::Case { arms, otherwise, .. } => {
            let label = |arm: &scl::Arm| {
                arm.values.iter().any(|value| {
                    holds(value.low.span, at) || value.high.as_ref().is_some_and(|high| holds(high.span, at))
                })
            };
            if let Some(index) = arms.iter().position(label) {
                arms.remove(index);
                return Some(LeftOut { span: at, what: "this arm of CASE" });
            }
            arms.iter_mut().find_map(|arm| scl_list(&mut arm.body, at)).or_else(|| scl_list(otherwise, at))
        }
        scl::StatementKind::For { body, .. }
        | scl::StatementKind::While { body, .. }
        | scl::StatementKind::Repeat { body, .. } => scl_list(body, at),
        scl::StatementKind::Empty
        | scl::StatementKind::Label(_)
        | scl::StatementKind::Expression(_)
        | scl::StatementKind::Assign { .. }
        | scl::StatementKind::Exit
        | scl::StatementKind::Continue
        | scl::StatementKind::Return(_)
        | scl::StatementKind::Goto(_)
        | scl::StatementKind::Pragma(_)
        | scl::StatementKind::Error => None,
    };
    if inner.is_some() {
        return inner;
    }
    if matches!(statement.kind, scl::StatementKind::Empty) {
        return None;
    }
    statement.kind = scl::StatementKind::Empty;
    Some(LeftOut { span: at, what: "this statement" })
}

/// A call is removed alone; otherwise the whole network is, because each statement works on the results of those before it.
fn stl_list(list: &mut [ast::Statement], at: Span) -> Option<LeftOut> {
    let index = list.iter().position(|statement| holds(statement.span, at))?;
    if matches!(list[index].kind, StlKind::Call(_)) {
        list[index].kind = StlKind::Empty;
        return Some(LeftOut { span: at, what: "this call" });
    }
    if matches!(list[index].kind, StlKind::Empty) {
        return None;
    }
    for statement in list {
        statement.kind = StlKind::Empty;
    }
    Some(LeftOut { span: at, what: "this network" })
}

fn one_network(network: &mut network::Network, at: Span) -> Option<LeftOut> {
    match &mut network.content {
        network::Content::Scl(list) => scl_list(list, at),
        network::Content::Stl(list) => stl_list(list, at),
        network::Content::Graphic(graph) => {
            if graph.elements.is_empty() && graph.nets.is_empty() {
                return None;
            }
            let near = |span: Span| holds(span, at) || holds(at, span) && at.end > at.start;
            let of_pin = |pin: &network::Pin| {
                near(pin.span) || matches!(&pin.value, network::PinValue::Operand(node) if near(node.span))
            };
            let of_target = |target: &network::Target| match target {
                network::Target::Block { callee, instance } => {
                    near(callee.span) || instance.as_ref().is_some_and(|instance| near(instance.span))
                }
                network::Target::Element { instance, .. } => {
                    instance.as_ref().is_some_and(|instance| near(instance.span))
                }
            };
            let of_source = |source: &network::Source| match source {
                network::Source::Operand { value, .. } => near(value.span),
                network::Source::Rail | network::Source::Pin { .. } | network::Source::Net(_) => false,
            };
            let is_here = near(network.span)
                || graph.nets.iter().any(|net| near(net.span) || net.sources.iter().any(of_source))
                || graph.elements.iter().any(|element| {
                    near(element.span)
                        || element.pins.iter().any(of_pin)
                        || of_target(&element.target)
                        || element.templates.iter().any(|template| near(template.span))
                        || element.equation.as_ref().is_some_and(|formula| near(formula.span))
                });
            if !is_here {
                return None;
            }
            network.content = network::Content::Graphic(network::Graph::default());
            Some(LeftOut { span: at, what: "this network" })
        }
    }
}

/// A condition that is never satisfied.
fn never(span: Span) -> chart::Condition {
    let literal = scl::Literal::Typed { ty: Elementary::Bool, bits: 0 };
    chart::Condition::Expression(scl::Expr { kind: scl::ExprKind::Literal(literal), span })
}

fn condition_holds(condition: &mut chart::Condition, at: Span) -> bool {
    match condition {
        chart::Condition::Expression(value) => {
            holds(value.span, at) && !matches!(value.kind, scl::ExprKind::Literal(_))
        }
        chart::Condition::Network(network) => one_network(&mut network.clone(), at).is_some(),
        chart::Condition::Statements(list) => list.iter().any(|statement| holds(statement.span, at)),
    }
}

fn one_of_chart(body: &mut chart::Body, at: Span) -> Option<LeftOut> {
    for list in [&mut body.before, &mut body.after] {
        for index in 0..list.len() {
            let inside = match &mut list[index].kind {
                chart::PermanentKind::Network(network) => one_network(&mut network.clone(), at).is_some(),
                chart::PermanentKind::Coil { .. } | chart::PermanentKind::Call(_) => false,
            };
            if inside || holds(list[index].span, at) {
                list.remove(index);
                return Some(LeftOut { span: at, what: "this permanent instruction" });
            }
        }
    }
    for step in &mut body.steps {
        for index in 0..step.actions.len() {
            let action = &mut step.actions[index];
            let inside = match &mut action.body {
                chart::ActionBody::Network(network) => one_network(&mut network.clone(), at).is_some(),
                chart::ActionBody::Statements(list) => list.iter().any(|statement| holds(statement.span, at)),
                _ => false,
            };
            if inside || holds(action.span, at) {
                step.actions.remove(index);
                return Some(LeftOut { span: at, what: "this action" });
            }
        }
        if step.interlock.as_mut().is_some_and(|condition| condition_holds(condition, at)) {
            step.interlock = Some(never(at));
            return Some(LeftOut { span: at, what: "this interlock, which is never satisfied," });
        }
        if step.supervision.as_mut().is_some_and(|condition| condition_holds(condition, at)) {
            step.supervision = None;
            return Some(LeftOut { span: at, what: "this supervision" });
        }
        for time in [&mut step.maximum, &mut step.warning] {
            if time.as_ref().is_some_and(|value| holds(value.span, at)) {
                *time = None;
                return Some(LeftOut { span: at, what: "this time" });
            }
        }
    }
    for transition in &mut body.transitions {
        if transition.condition.as_mut().is_some_and(|condition| condition_holds(condition, at)) {
            transition.condition = Some(never(at));
            return Some(LeftOut { span: at, what: "this condition, which is never satisfied," });
        }
    }
    None
}
