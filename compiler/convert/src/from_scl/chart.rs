//! Charts of GRAPH: the binder makes statements of them; here are their declarations, which sources leave out, and what their statements
//! expect of the block.

use plcc_diag::Span;
use plcc_model::scl::{Statement, StatementKind};
use plcc_model::types::Elementary;
use plcc_syntax::ast::{
    self, Code, CodeBlock, InitialKind, InitialValue, Operand, Section, SectionKind, TypeKind, TypeRef, Variable,
};
use plcc_syntax::chart::ast::{Body, Dialect, StepData};
use plcc_syntax::scl::ast::Dialect as SclDialect;
use plcc_syntax::stl::StlInsn;

use super::Maker;
use super::code::number;

/// Adds to a block what its chart declares without saying so: operating parameters, steps, transitions, data of the chart.
pub type ChartData = fn(&CodeBlock, &Body) -> CodeBlock;

/// The order of sections in STL.
const ORDER: [SectionKind; 5] =
    [SectionKind::Input, SectionKind::Output, SectionKind::InOut, SectionKind::Static, SectionKind::Temp];

/// A block with all declarations of its chart, which are at the name of the block.
pub fn declared(block: &CodeBlock, chart: &Body, data: ChartData) -> CodeBlock {
    let mut made = data(block, chart);
    let span = block.name.span();
    let variables = made.sections.iter_mut().flat_map(|section| &mut section.variables);
    variables.filter(|variable| variable.name_span.file != span.file).for_each(|variable| settle(variable, span));
    made.sections = merged(&made.sections);
    made
}

/// Sections of one kind as one, where they do not differ in what is retentive.
fn merged(sections: &[Section]) -> Vec<Section> {
    let mut made: Vec<Section> = Vec::new();
    for kind in ORDER {
        for section in sections.iter().filter(|section| section.kind == kind && !section.variables.is_empty()) {
            match made.last_mut().filter(|last| last.kind == kind && last.retain == section.retain) {
                Some(last) => {
                    last.variables.extend(section.variables.iter().cloned());
                    // The one in the source, where its comments are.
                    if section.span.start > last.span.start {
                        last.span = section.span;
                    }
                }
                None => made.push(section.clone()),
            }
        }
    }
    made
}

/// All of a declaration is at this place.
fn settle(variable: &mut Variable, span: Span) {
    variable.name_span = span;
    settle_type(&mut variable.ty, span);
    if let Some(value) = &mut variable.initial {
        settle_value(value, span);
    }
}

fn settle_type(ty: &mut TypeRef, span: Span) {
    ty.span = span;
    match &mut ty.kind {
        TypeKind::Struct(members) => members.iter_mut().for_each(|member| settle(member, span)),
        TypeKind::Array { element, .. } | TypeKind::OpenArray { element, .. } | TypeKind::Reference(element) => {
            settle_type(element, span);
        }
        TypeKind::Named(_) | TypeKind::String(_) | TypeKind::WideString(_) | TypeKind::Block(_) | TypeKind::Error => {}
    }
}

fn settle_value(value: &mut InitialValue, span: Span) {
    value.span = span;
    match &mut value.kind {
        InitialKind::Expr(constant) => constant.span = span,
        InitialKind::List(values) | InitialKind::Repeat { values, .. } => {
            values.iter_mut().for_each(|value| settle_value(value, span));
        }
        InitialKind::Fields(fields) => fields.iter_mut().for_each(|(_, value)| settle_value(value, span)),
        InitialKind::Elements(elements) => elements.iter_mut().for_each(|(_, value)| settle_value(value, span)),
        InitialKind::Literal(_) | InitialKind::Operand(_) | InitialKind::Default => {}
    }
}

/// The block follows the rules of the TIA Portal.
pub fn is_of_portal(code: &Code) -> bool {
    match code {
        Code::Scl(body) => body.dialect == SclDialect::Tia,
        Code::Chart(chart) => chart.dialect != Dialect::Classic,
        // Only blocks of the TIA Portal have networks in SCL.
        Code::Graphic(_) | Code::Stl(_) => true,
    }
}

/// Two statements of a chart that follow each other, at one place, are in one network.
pub fn belong_together(one: &Statement, next: &Statement) -> bool {
    let is_simple = |statement: &Statement| {
        !matches!(
            statement.kind,
            StatementKind::If { .. }
                | StatementKind::Case { .. }
                | StatementKind::For { .. }
                | StatementKind::While { .. }
                | StatementKind::Repeat { .. }
        )
    };
    is_simple(one) && is_simple(next)
}

impl Maker<'_> {
    pub fn is_chart(&self) -> bool {
        matches!(self.tree.code, Code::Chart(_))
    }

    /// What is converted; all of a chart is at its name, so that its comments stay together, at its end.
    pub fn go_to(&mut self, span: Span) {
        if !self.is_chart() {
            self.span = span;
        }
    }

    /// Data that the chart adds to the block.
    pub fn is_chart_data(&self, name: &str) -> bool {
        let place = self.tree.name.span();
        let mut variables = self.tree.sections.iter().flat_map(|section| &section.variables);
        self.is_chart() && variables.any(|variable| variable.name_span == place && variable.name == name)
    }

    /// STL cannot declare it.
    pub fn check_chart(&mut self) {
        if let Code::Chart(chart) = &self.tree.code
            && chart.settings.data == Some(StepData::Array)
        {
            let help = "let each step be a structure with its own name: `SSBLevel: Individual`";
            self.refuse(self.tree.name.span(), "a chart whose steps are in the array G7S", help);
        }
    }

    /// Variables of the chart's statements begin with 0 in each call, which STL does not promise of temporary data. The comments of steps and
    /// transitions, which have no places of their own there, come before that.
    pub fn start_values(&mut self) -> ast::Network {
        let mut hidden: Vec<(u32, Operand, Elementary)> =
            self.hidden.iter().map(|(bit, (operand, ty))| (*bit, operand.clone(), *ty)).collect();
        hidden.sort_by_key(|(bit, ..)| *bit);
        let (bits, numbers): (Vec<_>, Vec<_>) = hidden.into_iter().partition(|(_, _, ty)| *ty == Elementary::Bool);
        self.push(StlInsn::ClearRlo, None);
        bits.into_iter().for_each(|(_, bit, _)| self.push(StlInsn::Assign, Some(bit)));
        if !numbers.is_empty() {
            self.push(StlInsn::Load, Some(number(0, self.span)));
        }
        numbers.into_iter().for_each(|(_, operand, _)| self.push(StlInsn::Transfer, Some(operand)));
        let comment = match &self.tree.code {
            Code::Chart(chart) => comments(chart),
            Code::Scl(_) | Code::Graphic(_) | Code::Stl(_) => Vec::new(),
        };
        let title = Some("Temporary data of the chart".to_string());
        ast::Network { title, comment, statements: std::mem::take(&mut self.statements) }
    }

    /// The title of a network: the permanent instruction that it is. What a chart does in each call has no place in it, and XML no text.
    pub fn title_in_chart(&self, span: Span) -> Option<String> {
        let title = self.positions.first_line(span);
        (span != self.tree.name.span() && !title.starts_with('<')).then_some(title)
    }
}

/// The comments of steps, their actions, and transitions, line by line.
fn comments(chart: &Body) -> Vec<String> {
    let mut lines = Vec::new();
    let mut add = |name: String, comment: &str| {
        lines.extend(comment.lines().map(|line| format!("{name}: {}", line.trim()).trim_end().to_string()));
    };
    for step in &chart.steps {
        let rows = step.actions.iter().filter_map(|row| row.comment.as_ref());
        step.comment.iter().chain(rows).for_each(|comment| add(format!("Step {}", step.name.text), comment));
    }
    for transition in &chart.transitions {
        let name = || format!("Transition {}", transition.name.text);
        transition.comment.iter().for_each(|comment| add(name(), comment));
    }
    lines
}
