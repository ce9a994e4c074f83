//! Labels and jumps, and data that is read and never written. Source: SCL reference, GOTO.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic};
use plcc_syntax::ast;
use plcc_syntax::scl::ast::{Name, Statement, StatementKind};
use rustc_hash::FxHashSet;

use super::scope::Label;
use crate::bind::scl::message::DEPTH_MAX;
use crate::bind::scl::{SclBinder, SclBlock};
use crate::bind::trees::SYSTEM_FILE;
use plcc_binding::fold;
use plcc_binding::similar;
use plcc_model::LabelId;

impl SclBinder<'_, '_> {
    /// The first walk: labels, with the statement lists that contain them.
    pub(in crate::bind) fn collect_labels(&mut self, ctx: &mut SclBlock, statements: &[Statement]) {
        let mut open: Vec<(&[Statement], u32)> = vec![(statements, 0)];
        while let Some((list, depth)) = open.pop() {
            if depth > DEPTH_MAX {
                continue;
            }
            for statement in list {
                if let StatementKind::Label(name) = &statement.kind {
                    self.define_jump_label(ctx, name, list);
                }
                open.extend(statement.kind.bodies().into_iter().map(|body| (body, depth + 1)));
            }
        }
    }

    fn define_jump_label(&mut self, ctx: &mut SclBlock, name: &Name, list: &[Statement]) {
        let id = LabelId(ctx.scope.labels.len() as u32);
        let label = Label { id, span: name.span, list: list.as_ptr() as usize };
        let Some(other) = ctx.scope.labels.get(&fold(&name.text)) else {
            ctx.scope.labels.insert(fold(&name.text), label);
            return;
        };
        let (first, second) =
            if other.span.start <= name.span.start { (other.span, name.span) } else { (name.span, other.span) };
        self.program.report(
            Diagnostic::new(Code::DuplicateLabel, second, format!("the label `{}` is defined twice", name.text))
                .label("the second one")
                .also(first, "the first one")
                .help("labels are unique in their block; upper and lower case are the same"),
        );
    }

    /// A label, at its definition; none for the second of two.
    pub(in crate::bind) fn label(&mut self, ctx: &SclBlock, name: &Name) -> Option<LabelId> {
        let label = ctx.scope.labels.get(&fold(&name.text))?;
        (label.span == name.span).then_some(label.id)
    }

    pub(in crate::bind) fn goto(&mut self, ctx: &SclBlock, name: &Name) -> Option<LabelId> {
        let text = &name.text;
        let Some(label) = ctx.scope.labels.get(&fold(text)) else {
            let message = Diagnostic::new(Code::UnknownLabel, name.span, format!("this block has no label `{text}`"))
                .label("nowhere to jump to");
            self.program.report(match similar(text, ctx.scope.labels.keys().map(String::as_str)) {
                Some(other) => message.help(format!("is `{other}` meant?")),
                None => message
                    .help(format!("write `{text}:` before the statement to jump to, or give the network this label")),
            });
            return None;
        };
        if !ctx.scope.lists.contains(&label.list) {
            self.program.report(
                Diagnostic::new(Code::JumpIntoStatement, name.span, format!("`{text}` is inside another statement"))
                    .label("a jump into a loop, an IF or a CASE is not possible")
                    .also(label.span, "the label")
                    .help("place the label before that statement, or the jump inside it"),
            );
            return None;
        }
        Some(label.id)
    }

    /// Reports TEMP data that is read and never written, and a value and outputs of a function that are never set. `empty`: the block has
    /// no statements, or only `;`.
    pub(in crate::bind) fn unused_data(&mut self, ctx: &mut SclBlock, block: &ast::CodeBlock, empty: bool) {
        let reads = std::mem::take(&mut ctx.scope.temp_reads);
        let supplied = ctx.block.bound.interface.start_bytes;
        // Sorted by first byte, each with the furthest end so far.
        let mut writes = std::mem::take(&mut ctx.scope.temp_writes);
        writes.sort_unstable();
        let mut furthest = 0;
        for (_, end) in &mut writes {
            furthest = furthest.max(*end);
            *end = furthest;
        }
        let is_written = |first: u32, end: u32| {
            let before_end = writes.partition_point(|&(start, _)| start < end);
            before_end > 0 && writes[before_end - 1].1 > first
        };
        // What a statement assigns that has a message of its own is not known.
        let unread = ctx.scope.unread || !ctx.block.unknown_locals.is_empty();
        // An initial value, which temporary data does not have, is reported where it stands.
        let initial: FxHashSet<String> = block
            .sections
            .iter()
            .filter(|section| section.kind == ast::SectionKind::Temp)
            .flat_map(|section| &section.variables)
            .filter(|variable| variable.initial.is_some())
            .map(|variable| fold(&variable.name))
            .collect();
        let mut told = FxHashSet::default();
        for read in reads {
            let known = unread || read.first < supplied || is_written(read.first, read.end);
            let known = known || (!initial.is_empty() && initial.contains(&fold(&read.name)));
            if known || !told.insert((read.first, read.end)) {
                continue;
            }
            self.program.report(
                Diagnostic::new(Code::NeverWritten, read.span, format!("`{}` is read and never written", read.name))
                    .label("temporary data is undefined on the CPU until it is written")
                    .help("assign a value to it first, or declare it as static data"),
            );
        }
        let has_value = ctx.block.bound.interface.parameters.iter().any(|parameter| parameter.name == "RET_VAL");
        let is_function = matches!(ctx.block.key.kind, BlockKind::Fc | BlockKind::Sfc) && block.return_type.is_some();
        if is_function && has_value && !ctx.scope.value_set && !empty && !unread {
            let name = own_value(&block.name);
            self.program.report(
                Diagnostic::new(Code::ValueNeverSet, block.name.span(), "the value of this function is never set")
                    .label("it is always 0")
                    .help(format!("assign it: `{name} := …;`, or make the function VOID")),
            );
        }
        let is_text = matches!(block.code, ast::Code::Scl(_)) && block.name.span().file != SYSTEM_FILE;
        if ctx.block.key.kind == BlockKind::Fc && is_text && !empty && !unread {
            self.unset_outputs(ctx, block);
        }
    }

    /// Reports the outputs of a function that no statement names.
    fn unset_outputs(&mut self, ctx: &SclBlock, block: &ast::CodeBlock) {
        let outputs = block.sections.iter().filter(|section| section.kind == ast::SectionKind::Output);
        let views = block.sections.iter().flat_map(|section| &section.variables).filter_map(|view| view.at.as_ref());
        let viewed: FxHashSet<String> = views.map(|(name, _)| fold(name)).collect();
        for output in outputs.flat_map(|section| &section.variables) {
            let name = fold(&output.name);
            let mut parameters = ctx.block.bound.interface.parameters.iter();
            let Some(index) = parameters.position(|parameter| fold(&parameter.name) == name) else { continue };
            if output.at.is_some() || viewed.contains(&name) || ctx.scope.named_parameters.contains(&index) {
                continue;
            }
            let name = &output.name;
            self.program.report(
                Diagnostic::new(Code::ValueNeverSet, output.name_span, format!("the output `{name}` is never set"))
                    .label("the caller gets no value from it")
                    .help(format!("assign it: `#{name} := …;`, or remove it")),
            );
        }
    }
}

/// How a function writes its own value.
pub(in crate::bind) fn own_value(name: &ast::BlockName) -> String {
    match name {
        ast::BlockName::Symbol { name, .. } => format!("#{name}"),
        ast::BlockName::Numbered { number, .. } => format!("FC{number}"),
    }
}
