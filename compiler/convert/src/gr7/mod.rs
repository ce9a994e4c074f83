//! Sources of GRAPH (`.gr7`), from charts of whatever file.
//!
//! - `rows`: actions and permanent instructions.
//! - `logic`: networks of conditions as expressions.
//!
//! Source: GRAPH reference, chapter A.

pub(crate) mod logic;
mod rows;

use plcc_diag::Diagnostic;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, DataBlock, Header, SourceUnit, TypeBlock};
use plcc_syntax::chart::ast::{Body, Condition, Dialect, Interface, Settings, Step, StepData, Transition};
use plcc_syntax::scl::ast::{ExprKind, Literal, Name, StatementKind};

use crate::scl::expression;
use crate::trivia::Trivia;
use crate::writer::{Notation, Writer};

/// Writes a source of GRAPH. Blocks of STL or SCL, data blocks and types beside its charts stay as they are. `source`: the text that spans
/// mean, if its constants are those of SCL.
pub fn write(unit: &SourceUnit, trivia: Trivia, source: Option<&str>) -> (String, Vec<Diagnostic>) {
    let mut writer = Writer::new(Notation::Gr7, unit.mnemonics, trivia, source);
    let is = |block: &Block, language: fn(&Code) -> bool| matches!(block, Block::Code(code) if language(&code.code));
    let has_chart = |block: &Block| is(block, |code| matches!(code, Code::Chart(_)));
    let has_stl = |block: &Block| is(block, |code| matches!(code, Code::Stl(_)));
    let has_charts = unit.blocks.iter().any(has_chart);
    let others = if unit.blocks.iter().any(has_stl) { Notation::Stl } else { Notation::Scl };
    for block in &unit.blocks {
        writer.out.gap();
        writer.notation = if has_chart(block) { Notation::Gr7 } else { others };
        match block {
            Block::Code(code) => match &code.code {
                Code::Chart(chart) => writer.chart_block(code, chart),
                Code::Scl(body) if has_charts => writer.scl_block(code, body),
                Code::Stl(networks) if has_charts => writer.stl_block(code, networks),
                Code::Scl(_) | Code::Stl(_) | Code::Graphic(_) => writer.no_chart(&code.name),
            },
            Block::Data(data) if has_charts => writer.data_block(data),
            Block::Type(ty) if has_charts => writer.type_block(ty),
            Block::Data(DataBlock { name, .. }) | Block::Type(TypeBlock { name, .. }) => writer.no_chart(name),
        }
    }
    writer.remarks_before(u32::MAX);
    (writer.out.into_text(), writer.messages)
}

/// Words that a step or a transition cannot have as its name without quotes.
const KEYWORDS: [&str; 22] = [
    "CALL",
    "CONDITION",
    "END_FUNCTION_BLOCK",
    "END_INTERLOCK",
    "END_PERM_CONDITION",
    "END_SEQUENCE",
    "END_STEP",
    "END_SUPERVISION",
    "END_TRANSITION",
    "END_VAR",
    "FROM",
    "FUNCTION_BLOCK",
    "INITIAL_STEP",
    "INTERLOCK",
    "PERM_CONDITION_AT_BEGIN",
    "PERM_CONDITION_AT_END",
    "SEQUENCE",
    "STEP",
    "SUPERVISION",
    "TO",
    "TRANSITION",
    "VAR",
];

/// Letters, digits and `_`; the first may be a digit, but it is not a number.
pub(crate) fn is_word(name: &str) -> bool {
    name.chars().all(|c| c.is_alphanumeric() || c == '_')
        && name.chars().any(|c| !c.is_ascii_digit() && c != '_')
        && !name.is_empty()
}

fn node_name(name: &Name) -> String {
    let is_keyword = KEYWORDS.iter().any(|word| word.eq_ignore_ascii_case(&name.text));
    if is_word(&name.text) && !is_keyword { name.text.clone() } else { format!("\"{}\"", name.text) }
}

/// The text of a comment, which must not end it.
fn harmless(text: &str) -> String {
    text.replace("*)", "* )")
}

impl Writer<'_> {
    fn no_chart(&mut self, name: &BlockName) {
        let title = format!("{} is not in GRAPH", self.block_name(name));
        let help = "a source of GRAPH has function blocks with charts: convert the other blocks apart";
        self.refuse(name.span(), title, help);
    }

    fn chart_block(&mut self, block: &CodeBlock, chart: &Body) {
        if chart.broken {
            self.refuse(block.name.span(), "a chart that was not understood", "repair the source first");
        }
        self.remarks_before(block.span.start);
        let name = self.block_name(&block.name);
        self.out.line(format!("FUNCTION_BLOCK {name}"));
        self.chart_header(block);
        self.chart_settings(&chart.settings, chart.dialect);
        for section in &block.sections {
            self.section(section);
        }
        if let Some(first) = block.constants.first() {
            self.refuse(
                first.name_span,
                format!("GRAPH sources have no constants of a block: `{}`", first.name),
                "write its value where it is used",
            );
        }
        self.permanents("PERM_CONDITION_AT_BEGIN", &chart.before);
        for step in &chart.steps {
            self.step(step);
        }
        // The last one is drawn leftmost, and counts first.
        let mut transitions: Vec<&Transition> = chart.transitions.iter().collect();
        if chart.dialect != Dialect::Classic {
            transitions.sort_by(|a, b| (&b.path, b.number).cmp(&(&a.path, a.number)));
        }
        for transition in transitions {
            self.transition(transition);
        }
        self.permanents("PERM_CONDITION_AT_END", &chart.after);
        self.remarks_before(block.span.end);
        self.out.line("END_FUNCTION_BLOCK");
    }

    fn chart_header(&mut self, block: &CodeBlock) {
        let header = &block.header;
        if let Some(title) = &header.title {
            self.out.line(format!("TITLE = {}", title.replace(['\n', '\r'], " ")));
        }
        let texts = [
            ("AUTHOR", &header.author),
            ("FAMILY", &header.family),
            ("NAME", &header.name),
            ("VERSION", &header.version),
        ];
        for (key, value) in texts {
            if let Some(value) = value {
                self.out.line(format!("{key} : {value}"));
            }
        }
        for (word, is_set) in [("CODE_VERSION1", header.code_version1), ("KNOW_HOW_PROTECT", header.know_how_protect)] {
            if is_set {
                self.out.line(word);
            }
        }
        // What only other notations have.
        const FOREIGN: [&str; 5] =
            ["S7_BlockNumber", "S7_Version", "S7_PreferredLanguage", "S7_Optimized", "S7_Optimized_Access"];
        let attributes: Vec<String> = header
            .attributes
            .iter()
            .filter(|(key, _)| !FOREIGN.iter().any(|foreign| foreign.eq_ignore_ascii_case(key)))
            .map(|(key, value)| format!("{key} := '{value}'"))
            .collect();
        if !attributes.is_empty() {
            self.out.line(format!("{{ {} }}", attributes.join("; ")));
        }
        self.number_is_lost(header, block);
        self.comment(&header.comment);
    }

    fn number_is_lost(&mut self, header: &Header, block: &CodeBlock) {
        if let (Some(number), BlockName::Symbol { span, .. }) = (header.number, &block.name) {
            self.warn(
                *span,
                format!("the number {number} of the block is not in the source"),
                "the notation has a name or a number: give the number in the symbol table",
            );
        }
    }

    /// `(*$_COM … *)`
    fn comment(&mut self, lines: &[String]) {
        match lines {
            [] => {}
            [line] => self.out.line(format!("(*$_COM {}*)", part_of_comment(line))),
            lines => {
                self.out.line("(*$_COM");
                for line in lines {
                    self.out.line(part_of_comment(line));
                }
                self.out.line("*)");
            }
        }
    }

    fn chart_settings(&mut self, settings: &Settings, dialect: Dialect) {
        // The tool of STEP 7 V5 takes another default.
        let interface = settings.interface.or((dialect != Dialect::Classic).then_some(Interface::UserDefined));
        let interface = interface.map(|interface| match interface {
            Interface::Minimum => "Minimum",
            Interface::Standard => "Standard",
            Interface::Maximum => "Maximum",
            Interface::UserDefined => "UserDefined",
        });
        let data = settings.data.map(|data| match data {
            StepData::Individual => "Individual",
            StepData::Array => "Array",
            StepData::Minimized => "Minimized",
        });
        let truth = |value: Option<bool>| value.map(|value| if value { "T" } else { "F" });
        let rows = [
            ("FBInterface", interface),
            ("SSBLevel", data),
            ("SSkipOn", truth(settings.skip_steps)),
            ("AckReq", truth(settings.acknowledge)),
            ("PermILMan", truth(settings.manual_interlocks)),
            ("SaveSwitching", truth(settings.safe_activation)),
            ("SWMLocked", truth(settings.locked_mode)),
        ];
        if rows.iter().all(|(_, value)| value.is_none()) {
            return;
        }
        self.out.line("(*$_CMPSET");
        for (key, value) in rows {
            if let Some(value) = value {
                self.out.line(format!("   {key}: {value}"));
            }
        }
        self.out.line("*)");
    }

    fn step(&mut self, step: &Step) {
        self.remarks_before(step.span.start);
        let word = if step.initial { "INITIAL_STEP" } else { "STEP" };
        self.out.line(format!("{word} {} (*$_NUM {}*):", node_name(&step.name), step.number));
        self.out.indent();
        self.comment(&step.comment);
        // They are values of the step's data, which a chart of S7-GRAPH does not have; the editor gives all steps 10 s and 7 s.
        for (member, time, default) in [("T_MAX", &step.maximum, 10_000), ("T_WARN", &step.warning, 7_000)] {
            let Some(time) = time else { continue };
            let own = ExprKind::Literal(Literal::Typed { ty: Elementary::Time, bits: default });
            if time.kind != own {
                let title = format!("`{member}` of step `{}` is not in the source", step.name.text);
                self.warn(time.span, title, "write a supervision that compares the time, such as `Heat.T > T#10S`");
            }
        }
        let name = &step.name.text;
        self.condition_of("INTERLOCK", "END_INTERLOCK", &step.interlock, &format!("the interlock of `{name}`"));
        self.condition_of("SUPERVISION", "END_SUPERVISION", &step.supervision, &format!("the supervision of `{name}`"));
        for action in &step.actions {
            self.action(action);
        }
        self.remarks_before(step.span.end);
        self.out.dedent();
        self.out.line("END_STEP");
    }

    fn condition_of(&mut self, word: &str, end: &str, condition: &Option<Condition>, whose: &str) {
        let Some(condition) = condition else { return };
        self.out.line(word);
        self.out.indent();
        self.condition(condition, whose);
        self.out.dedent();
        self.out.line(end);
    }

    fn transition(&mut self, transition: &Transition) {
        self.remarks_before(transition.span.start);
        let name = &transition.name.text;
        if transition.missing {
            let title = format!("the drawing has a gap at transition `{name}`");
            self.refuse(transition.span, title, "draw the transition first");
        }
        self.out.line(format!("TRANSITION {} (*$_NUM {}*)", node_name(&transition.name), transition.number));
        self.out.indent();
        self.comment(&transition.comment);
        for (word, list) in [("FROM", &transition.from), ("TO", &transition.to)] {
            let names: Vec<String> = list.iter().map(node_name).collect();
            let jump = if word == "TO" && transition.jump { " (*$_JUMP*)" } else { "" };
            match names.as_slice() {
                [] => {}
                [one] => self.out.line(format!("{word} {one}{jump}")),
                several => self.out.line(format!("{word} ({}){jump}", several.join(", "))),
            }
        }
        match &transition.condition {
            Some(condition) => self.condition(condition, &format!("transition `{name}`")),
            None => self.out.line("CONDITION :="),
        }
        self.remarks_before(transition.span.end);
        self.out.dedent();
        self.out.line("END_TRANSITION");
    }

    /// `CONDITION := …`
    fn condition(&mut self, condition: &Condition, whose: &str) {
        let value = match condition {
            Condition::Expression(value) => Some(value.clone()),
            Condition::Network(network) => logic::condition(network, whose, self),
            Condition::Statements(list) => match list.as_slice() {
                [one] => match &one.kind {
                    StatementKind::Expression(value) => Some(value.clone()),
                    _ => self.no_statements(one.span, whose),
                },
                list => self.no_statements(list.first().map_or_else(Default::default, |one| one.span), whose),
            },
        };
        if let Some(value) = value {
            self.remarks_before(value.span.start);
            let text = expression::text(&value, self);
            self.out.line(format!("CONDITION := {text}"));
            self.remarks_on_line(value.span.end);
        }
    }

    fn no_statements<T>(&mut self, span: plcc_diag::Span, whose: &str) -> Option<T> {
        self.refuse(span, format!("GRAPH sources have no statements in {whose}"), "write one expression");
        None
    }
}

/// A line of `$_COM`; `@` would divide it.
fn part_of_comment(line: &str) -> String {
    harmless(line)
}
