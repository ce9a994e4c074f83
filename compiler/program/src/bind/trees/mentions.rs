//! Which numbers of blocks the text of a block mentions, so that no block without a number gets one of them, and which instance
//! data blocks of calls.

use plcc_syntax::ast::{self, BlockName, BlockPrefix, Code, OperandKind, StatementKind, TypeKind, TypeRef};
use plcc_syntax::chart::ast as chart;
use plcc_syntax::network::ast as network;
use plcc_syntax::scl::ast as scl;

use plcc_syntax::symbols::{SymbolTarget, parse_address};

/// Block numbers that the declarations and statements of a block name.
pub fn numbers(block: &ast::Block) -> Vec<(BlockPrefix, u32)> {
    let mut numbers = Vec::new();
    match block {
        ast::Block::Code(code) => {
            code.return_type.iter().for_each(|ty| type_numbers(ty, &mut numbers));
            for section in &code.sections {
                variable_numbers(&section.variables, &mut numbers);
            }
            match &code.code {
                Code::Stl(networks) => {
                    stl_numbers(networks.iter().flat_map(|network| &network.statements), &mut numbers);
                }
                Code::Scl(_) | Code::Graphic(_) | Code::Chart(_) => {
                    expressions(&code.code, &mut |value| scl_number(value, &mut numbers));
                    stl_numbers(stl_statements(&code.code), &mut numbers);
                }
            }
        }
        ast::Block::Data(data) => match &data.content {
            ast::DataContent::Struct(variables) => variable_numbers(variables, &mut numbers),
            ast::DataContent::OfType(ty) | ast::DataContent::Array(ty, _) => type_numbers(ty, &mut numbers),
            ast::DataContent::Empty => {}
        },
        ast::Block::Type(ty) => {
            variable_numbers(&ty.members, &mut numbers);
            ty.alias.iter().for_each(|ty| type_numbers(ty, &mut numbers));
        }
    }
    numbers
}

fn variable_numbers(variables: &[ast::Variable], numbers: &mut Vec<(BlockPrefix, u32)>) {
    for variable in variables {
        type_numbers(&variable.ty, numbers);
    }
}

fn type_numbers(ty: &TypeRef, numbers: &mut Vec<(BlockPrefix, u32)>) {
    match &ty.kind {
        TypeKind::Block(name) => note(name, numbers),
        TypeKind::Named(word) => numbers.extend(written_number(word)),
        TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => {
            type_numbers(element, numbers);
        }
        TypeKind::Struct(variables) => variable_numbers(variables, numbers),
        TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Error => {}
    }
}

fn note(name: &BlockName, numbers: &mut Vec<(BlockPrefix, u32)>) {
    match name {
        BlockName::Numbered { prefix, number, .. } => {
            let prefix = if *prefix == BlockPrefix::Di { BlockPrefix::Db } else { *prefix };
            numbers.push((prefix, *number));
        }
        BlockName::Symbol { name, .. } => numbers.extend(written_number(name)),
    }
}

/// `DB10` in the form of a name.
fn written_number(name: &str) -> Option<(BlockPrefix, u32)> {
    match parse_address(name) {
        Some(SymbolTarget::Block { prefix, number }) => Some((prefix, number)),
        Some(SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. }) | None => None,
    }
}

fn operand_number(kind: &OperandKind, numbers: &mut Vec<(BlockPrefix, u32)>) {
    match kind {
        OperandKind::Block(name) | OperandKind::DbAbsolute { db: name, .. } => note(name, numbers),
        OperandKind::Path(path) => path_numbers(path, numbers),
        _ => {}
    }
}

fn path_numbers(path: &ast::Path, numbers: &mut Vec<(BlockPrefix, u32)>) {
    if let ast::PathRoot::Block(name) = &path.root {
        note(name, numbers);
    }
    for part in &path.parts {
        if let ast::PathPart::Index { values, .. } = part {
            for value in values {
                if let ast::Bound::Path(index) = value {
                    path_numbers(index, numbers);
                }
            }
        }
    }
}

fn stl_numbers<'a>(statements: impl Iterator<Item = &'a ast::Statement>, numbers: &mut Vec<(BlockPrefix, u32)>) {
    for statement in statements {
        match &statement.kind {
            StatementKind::Instruction { operand: Some(operand), .. } => operand_number(&operand.kind, numbers),
            StatementKind::Call(call) => {
                let actuals = call.parameters.iter().filter_map(|parameter| parameter.actual.as_ref());
                for operand in [&call.target].into_iter().chain(&call.instance).chain(actuals) {
                    operand_number(&operand.kind, numbers);
                }
            }
            StatementKind::Instruction { operand: None, .. }
            | StatementKind::Empty
            | StatementKind::Pragma(_)
            | StatementKind::Error => {}
        }
    }
}

fn scl_number(value: &scl::Expr, numbers: &mut Vec<(BlockPrefix, u32)>) {
    match &value.kind {
        scl::ExprKind::Name(name) | scl::ExprKind::Member { name, .. } => numbers.extend(written_number(&name.text)),
        scl::ExprKind::Absolute(kind) => operand_number(kind, numbers),
        _ => {}
    }
}

/// Calls of a function block followed by a data block, `FB10.DB20(…)`, `"Fb"."Db"(…)`: both names.
pub fn instance_calls(code: &Code) -> Vec<(scl::Name, scl::Name)> {
    let mut found = Vec::new();
    if let Code::Graphic(body) = code {
        for element in graphs(body).flat_map(|graph| &graph.elements) {
            if let network::Target::Block { callee, instance: Some(instance) } = &element.target
                && let (scl::ExprKind::Name(block), scl::ExprKind::Name(name)) = (&callee.kind, &instance.kind)
            {
                found.push((block.clone(), name.clone()));
            }
        }
    }
    if let Code::Chart(chart) = code {
        for call in calls(chart) {
            if let (scl::ExprKind::Name(block), Some(scl::ExprKind::Name(name))) =
                (&call.block.kind, call.instance.as_ref().map(|instance| &instance.kind))
            {
                found.push((block.clone(), name.clone()));
            }
        }
    }
    expressions(code, &mut |value| {
        if let scl::ExprKind::Call { callee, .. } = &value.kind
            && let scl::ExprKind::Member { base, name } = &callee.kind
            && let scl::ExprKind::Name(block) = &base.kind
        {
            found.push((block.clone(), name.clone()));
        }
    });
    found
}

/// The names in a call.
pub enum Called {
    Number(BlockPrefix, u32),
    Name(String),
}

/// A call of a block, with the names of its parameters.
pub struct CallOfBlock {
    pub target: Called,
    pub formals: Vec<String>,
    /// Its arguments have no names.
    pub by_place: bool,
}

/// Calls of blocks by number or name, in all languages. If it is called with an instance, the block.
pub fn calls_of_blocks(code: &Code, found: &mut Vec<CallOfBlock>) {
    for statement in listed(code) {
        let (target, formals) = match &statement.kind {
            StatementKind::Call(call) => {
                (&call.target, call.parameters.iter().map(|parameter| parameter.name.clone()).collect())
            }
            StatementKind::Instruction { insn, operand: Some(operand), .. }
                if insn.operand() == plcc_syntax::stl::OperandClass::Block =>
            {
                (operand, Vec::new())
            }
            StatementKind::Instruction { .. }
            | StatementKind::Empty
            | StatementKind::Pragma(_)
            | StatementKind::Error => continue,
        };
        let Some(target) = block_of(&target.kind) else { continue };
        found.push(CallOfBlock { target, formals, by_place: false });
    }
    if let Code::Graphic(body) = code {
        for element in graphs(body).flat_map(|graph| &graph.elements) {
            if let network::Target::Block { callee, .. } = &element.target
                && let Some(target) = called(callee)
            {
                let formals = element.pins.iter().map(|pin| pin.name.clone()).collect();
                found.push(CallOfBlock { target, formals, by_place: false });
            }
        }
    }
    if let Code::Chart(chart) = code {
        for call in calls(chart) {
            if let Some(target) = called(&call.block) {
                let formals = call.parameters.iter().map(|parameter| parameter.name.text.clone()).collect();
                found.push(CallOfBlock { target, formals, by_place: false });
            }
        }
    }
    expressions(code, &mut |value| {
        let scl::ExprKind::Call { callee, arguments } = &value.kind else { return };
        let callee = match &callee.kind {
            scl::ExprKind::Member { base, .. } => base,
            _ => callee,
        };
        if let Some(target) = called(callee) {
            let by_place = arguments.iter().any(|argument| argument.name.is_none());
            let named = arguments.iter().filter_map(|argument| argument.name.as_ref());
            found.push(CallOfBlock { target, formals: named.map(|name| name.text.clone()).collect(), by_place });
        }
    });
}

/// What `"Db"(…)` calls, what blocks get as parameters, `m := "Db"`, and what is opened for `UC FB 1`, `OPN DI 11`; blocks of other kinds
/// are among them.
pub fn data_of_calls(code: &Code) -> Vec<Called> {
    let mut calls = Vec::new();
    calls_of_blocks(code, &mut calls);
    let mut found: Vec<Called> = calls.into_iter().map(|call| call.target).collect();
    expressions(code, &mut |value| {
        if let scl::ExprKind::Call { arguments, .. } = &value.kind {
            found.extend(arguments.iter().filter_map(|argument| argument.value.as_ref()).filter_map(called));
        }
    });
    for statement in listed(code) {
        match &statement.kind {
            StatementKind::Instruction { operand: Some(operand), .. } => {
                if let OperandKind::Block(BlockName::Numbered { prefix: prefix @ BlockPrefix::Di, number, .. }) =
                    &operand.kind
                {
                    found.push(Called::Number(*prefix, *number));
                }
            }
            StatementKind::Call(call) => {
                let actuals = call.parameters.iter().filter_map(|parameter| parameter.actual.as_ref());
                found.extend(actuals.filter_map(|operand| block_of(&operand.kind)));
            }
            StatementKind::Instruction { operand: None, .. }
            | StatementKind::Empty
            | StatementKind::Pragma(_)
            | StatementKind::Error => {}
        }
    }
    found
}

/// The statements of STL in a block of any language.
fn listed(code: &Code) -> Vec<&ast::Statement> {
    match code {
        Code::Stl(networks) => networks.iter().flat_map(|network| &network.statements).collect(),
        Code::Scl(_) | Code::Graphic(_) | Code::Chart(_) => stl_statements(code).collect(),
    }
}

/// The block that an operand of STL is.
fn block_of(operand: &OperandKind) -> Option<Called> {
    match operand {
        OperandKind::Block(BlockName::Numbered { prefix, number, .. }) => Some(Called::Number(*prefix, *number)),
        OperandKind::Block(BlockName::Symbol { name, .. }) => Some(Called::Name(name.clone())),
        OperandKind::Path(ast::Path { root: ast::PathRoot::Quoted { name, .. }, parts, .. }) if parts.is_empty() => {
            Some(Called::Name(name.clone()))
        }
        _ => None,
    }
}

/// The block that the callee of a graphic call is.
fn called(callee: &scl::Expr) -> Option<Called> {
    match &callee.kind {
        scl::ExprKind::Name(name) => match (written_number(&name.text), name.form) {
            (Some((prefix, number)), scl::NameForm::Bare) => Some(Called::Number(prefix, number)),
            (_, scl::NameForm::Quoted) => Some(Called::Name(name.text.clone())),
            // A word may be a function of the language, with pins that differ by dialect.
            (None, scl::NameForm::Bare) | (_, scl::NameForm::Local) => None,
        },
        scl::ExprKind::Absolute(OperandKind::Block(BlockName::Numbered { prefix, number, .. })) => {
            Some(Called::Number(*prefix, *number))
        }
        _ => None,
    }
}

/// Goes through all expressions of a block in SCL, LAD, FBD or GRAPH, including their parts.
pub fn expressions(code: &Code, visit: &mut dyn FnMut(&scl::Expr)) {
    match code {
        Code::Stl(_) => {}
        Code::Scl(body) => statements(&body.statements, visit),
        Code::Graphic(body) => body.networks.iter().for_each(|network| network_expressions(network, visit)),
        Code::Chart(chart) => chart_expressions(chart, visit),
    }
}

fn network_expressions(network: &network::Network, visit: &mut dyn FnMut(&scl::Expr)) {
    match &network.content {
        network::Content::Graphic(graph) => graph_expressions(graph, visit),
        network::Content::Scl(list) => statements(list, visit),
        network::Content::Stl(_) => {}
    }
}

fn chart_expressions(chart: &chart::Body, visit: &mut dyn FnMut(&scl::Expr)) {
    chart.before.iter().chain(&chart.after).for_each(|permanent| permanent_expressions(permanent, visit));
    chart.steps.iter().flat_map(|step| &step.actions).for_each(|action| action_expressions(action, visit));
    let of_steps = chart.steps.iter().flat_map(|step| step.interlock.iter().chain(&step.supervision));
    let of_transitions = chart.transitions.iter().flat_map(|transition| &transition.condition);
    of_steps.chain(of_transitions).for_each(|condition| condition_expressions(condition, visit));
}

/// Goes through all expressions of a condition in a chart, including their parts.
pub fn condition_expressions(condition: &chart::Condition, visit: &mut dyn FnMut(&scl::Expr)) {
    match condition {
        chart::Condition::Expression(value) => expression(value, visit),
        chart::Condition::Network(network) => network_expressions(network, visit),
        chart::Condition::Statements(list) => statements(list, visit),
    }
}

/// Goes through all expressions of a row of actions, including their parts.
pub fn action_expressions(action: &chart::Action, visit: &mut dyn FnMut(&scl::Expr)) {
    match &action.body {
        chart::ActionBody::Operand(operand) => expression(operand, visit),
        chart::ActionBody::Value { operand, value } => {
            [operand, value].into_iter().for_each(|value| expression(value, visit));
        }
        chart::ActionBody::Call(call) => call_expressions(call, visit),
        chart::ActionBody::Statements(list) => statements(list, visit),
        chart::ActionBody::Network(network) => network_expressions(network, visit),
        chart::ActionBody::All { .. } | chart::ActionBody::Error => {}
    }
}

/// Goes through all expressions of a permanent instruction, including their parts.
pub fn permanent_expressions(permanent: &chart::Permanent, visit: &mut dyn FnMut(&scl::Expr)) {
    match &permanent.kind {
        chart::PermanentKind::Coil { operand, value, .. } => {
            [operand, value].into_iter().for_each(|value| expression(value, visit));
        }
        chart::PermanentKind::Call(call) => call_expressions(call, visit),
        chart::PermanentKind::Network(network) => network_expressions(network, visit),
    }
}

fn call_expressions(call: &chart::Call, visit: &mut dyn FnMut(&scl::Expr)) {
    let values = call.parameters.iter().filter_map(|parameter| parameter.value.as_ref());
    [&call.block].into_iter().chain(&call.instance).chain(values).for_each(|value| expression(value, visit));
}

/// Block calls in rows of actions and permanent instructions.
fn calls(chart: &chart::Body) -> impl Iterator<Item = &chart::Call> {
    let permanent = chart.before.iter().chain(&chart.after).filter_map(|permanent| match &permanent.kind {
        chart::PermanentKind::Call(call) => Some(call),
        chart::PermanentKind::Coil { .. } | chart::PermanentKind::Network(_) => None,
    });
    let actions = chart.steps.iter().flat_map(|step| &step.actions).filter_map(|action| match &action.body {
        chart::ActionBody::Call(call) => Some(call),
        _ => None,
    });
    permanent.chain(actions)
}

/// The statements name ENO of their block.
pub fn names_eno(list: &[scl::Statement]) -> bool {
    let mut found = false;
    statements(list, &mut |value| {
        found |= matches!(&value.kind, scl::ExprKind::Name(name) if name.text.eq_ignore_ascii_case("ENO"));
    });
    found
}

/// The statements of STL networks in a block of LAD or FBD.
pub fn stl_statements(code: &Code) -> impl Iterator<Item = &ast::Statement> {
    let networks = match code {
        Code::Graphic(body) => body.networks.as_slice(),
        Code::Stl(_) | Code::Scl(_) | Code::Chart(_) => &[],
    };
    networks
        .iter()
        .filter_map(|network| match &network.content {
            network::Content::Stl(list) => Some(list),
            network::Content::Graphic(_) | network::Content::Scl(_) => None,
        })
        .flatten()
}

fn graphs(body: &network::Body) -> impl Iterator<Item = &network::Graph> {
    body.networks.iter().filter_map(|network| match &network.content {
        network::Content::Graphic(graph) => Some(graph),
        network::Content::Scl(_) | network::Content::Stl(_) => None,
    })
}

fn graph_expressions(graph: &network::Graph, visit: &mut dyn FnMut(&scl::Expr)) {
    for source in graph.nets.iter().flat_map(|net| &net.sources) {
        if let network::Source::Operand { value, .. } = source {
            expression(value, visit);
        }
    }
    for element in &graph.elements {
        let (callee, instance) = match &element.target {
            network::Target::Element { instance, .. } => (None, instance),
            network::Target::Block { callee, instance } => (Some(callee), instance),
        };
        callee.into_iter().chain(instance).chain(&element.equation).for_each(|value| expression(value, visit));
        for pin in &element.pins {
            if let network::PinValue::Operand(value) = &pin.value {
                expression(value, visit);
            }
        }
    }
}

fn statements(list: &[scl::Statement], visit: &mut dyn FnMut(&scl::Expr)) {
    for statement in list {
        match &statement.kind {
            scl::StatementKind::Expression(value) => expression(value, visit),
            scl::StatementKind::Assign { targets, value } => {
                targets.iter().for_each(|(target, _)| expression(target, visit));
                expression(value, visit);
            }
            scl::StatementKind::If { branches, otherwise } => {
                for (condition, body) in branches {
                    expression(condition, visit);
                    statements(body, visit);
                }
                statements(otherwise, visit);
            }
            scl::StatementKind::Case { selector, arms, otherwise } => {
                expression(selector, visit);
                for arm in arms {
                    for value in &arm.values {
                        expression(&value.low, visit);
                        value.high.iter().for_each(|high| expression(high, visit));
                    }
                    statements(&arm.body, visit);
                }
                statements(otherwise, visit);
            }
            scl::StatementKind::For { variable, start, end, step, body } => {
                [variable, start, end].into_iter().chain(step).for_each(|value| expression(value, visit));
                statements(body, visit);
            }
            scl::StatementKind::While { condition, body } => {
                expression(condition, visit);
                statements(body, visit);
            }
            scl::StatementKind::Repeat { body, until } => {
                statements(body, visit);
                expression(until, visit);
            }
            scl::StatementKind::Return(value) => value.iter().for_each(|value| expression(value, visit)),
            scl::StatementKind::Empty
            | scl::StatementKind::Label(_)
            | scl::StatementKind::Exit
            | scl::StatementKind::Continue
            | scl::StatementKind::Goto(_)
            | scl::StatementKind::Pragma(_)
            | scl::StatementKind::Error => {}
        }
    }
}

fn expression(value: &scl::Expr, visit: &mut dyn FnMut(&scl::Expr)) {
    visit(value);
    match &value.kind {
        scl::ExprKind::Member { base, .. }
        | scl::ExprKind::MemberAbsolute { base, .. }
        | scl::ExprKind::Slice { base, .. } => expression(base, visit),
        scl::ExprKind::Index { base, indices } => {
            expression(base, visit);
            indices.iter().for_each(|index| expression(index, visit));
        }
        scl::ExprKind::Call { callee, arguments } => {
            expression(callee, visit);
            arguments.iter().filter_map(|argument| argument.value.as_ref()).for_each(|value| expression(value, visit));
        }
        scl::ExprKind::Dereference(operand)
        | scl::ExprKind::Reference(operand)
        | scl::ExprKind::Unary { operand, .. } => expression(operand, visit),
        scl::ExprKind::Binary { left, right, .. } => {
            expression(left, visit);
            expression(right, visit);
        }
        scl::ExprKind::Literal(_) | scl::ExprKind::Name(_) | scl::ExprKind::Absolute(_) | scl::ExprKind::Error => {}
    }
}
