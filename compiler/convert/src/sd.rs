//! Documents of SIMATIC SD, from trees of blocks whose networks are LAD and FBD.
//!
//! ```text
//! element ─ net ─ element    a rung as long as each element takes the flow of the one before it
//!            └─── element    another rung, which begins at the wire of the net
//! ```

pub(crate) mod attributes;
mod checks;
mod wires;
mod written;

use plcc_diag::Diagnostic;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, DataBlock, DataContent, SourceUnit, TypeBlock};
use plcc_syntax::network::ast::{
    Comparison, Content, Element, Eno, Graph, Language, NetId, Network, Pin, PinValue, Source, Storage, Target,
    TemplateKey,
};
use plcc_syntax::network::elements::{CounterCoil, Kind, PinDirection, Row};
use plcc_syntax::scl::ast::{Dialect, Expr, ExprKind, Literal, Statement};
use plcc_syntax::stl::Mnemonics;

use crate::frames::{is_implied, is_standard, with_retention};
use crate::names;
use crate::scl::expression;
use crate::trivia::{Remark, Trivia};
use crate::writer::{Notation, Writer};

use attributes::{Braces, Texts};
use wires::{Wires, crossed};

/// A document, and the texts of its titles (`.s7res`), if it has some.
pub struct Document {
    pub text: String,
    pub texts: Option<String>,
    pub messages: Vec<Diagnostic>,
}

/// Writes a document. `source`: the text that spans mean, if its constants are those of SCL.
pub fn write(unit: &SourceUnit, trivia: Trivia, source: Option<&str>) -> Document {
    let mut writer = Writer::new(Notation::Sd, Mnemonics::En, trivia, source);
    writer.quotes_words = unit.overlay.is_some();
    units(writer, unit)
}

/// Like [`write`]; blocks in SCL of the TIA Portal are written, too, as a network in SCL each.
pub fn write_all(unit: &SourceUnit, trivia: Trivia, source: Option<&str>) -> Document {
    let mut writer = Writer::new(Notation::Sd, Mnemonics::En, trivia, source);
    writer.quotes_words = unit.overlay.is_some();
    writer.scl_as_networks = true;
    units(writer, unit)
}

/// Writes a document that is made of another one, with the attributes of its author: its texts are those of the other one.
///
/// `is_redrawn`: its networks may have another language now.
pub fn rewrite(unit: &SourceUnit, trivia: Trivia, source: &str, is_redrawn: bool) -> Document {
    let mut writer = Writer::new(Notation::Sd, Mnemonics::En, trivia, Some(source));
    writer.braces = Some(Braces::of(source, is_redrawn));
    units(writer, unit)
}

fn units(mut writer: Writer, unit: &SourceUnit) -> Document {
    let mut texts = Texts::default();
    for (at, block) in unit.blocks.iter().enumerate() {
        if writer.scl_as_networks && checks::is_forward(block, &unit.blocks) {
            continue;
        }
        let next = unit.blocks.get(at + 1);
        let (is_joined, is_followed) = (writer.is_joined(block), next.is_some_and(|next| writer.is_joined(next)));
        if !is_joined {
            writer.out.gap();
        }
        // What follows statements without a header is still in their block.
        let next = next.map_or(u32::MAX, |next| next.span().start);
        let end = if is_implied(block) { next } else { block.span().end };
        match block {
            Block::Code(code) => writer.sd_block(code, end, &mut texts),
            Block::Data(data) => writer.sd_data(data, &mut texts),
            Block::Type(ty) => writer.sd_type(ty, (is_joined, is_followed), &mut texts),
        }
    }
    writer.remarks_before(u32::MAX);
    Document { text: writer.out.into_text(), texts: texts.into_text(), messages: writer.messages }
}

impl Writer<'_> {
    /// `end`: where its comments end.
    fn sd_block(&mut self, block: &CodeBlock, end: u32, texts: &mut Texts) {
        let is_written = match &block.code {
            Code::Graphic(_) => true,
            Code::Scl(body) => self.scl_as_networks && body.dialect == Dialect::Tia && body.labels.is_empty(),
            Code::Stl(_) | Code::Chart(_) => false,
        };
        if !is_written {
            let name = self.block_name(&block.name);
            let help = match &block.code {
                Code::Stl(_) => "write it as networks first, with `--to lad` or `--to fbd`",
                Code::Scl(_) => {
                    "if its CPU has STL, convert it with `--to stl`, and the result with `--to lad` or `--to fbd`"
                }
                Code::Chart(_) | Code::Graphic(_) => "leave it as it is: plcc builds charts and networks together",
            };
            return self.refuse(block.name.span(), format!("{name} has no networks"), help);
        }
        let keyword = match block.kind {
            CodeKind::Ob => "ORGANIZATION_BLOCK",
            CodeKind::Fc | CodeKind::Sfc => "FUNCTION",
            CodeKind::Fb | CodeKind::Sfb => "FUNCTION_BLOCK",
        };
        let after_head =
            self.attributes_after_head(block.return_type.as_ref().map_or(block.name.span().end, |ty| ty.span.end));
        self.remarks_before(block.span.start);
        self.sd_header((&block.header, block.kind == CodeKind::Ob), block.span, &after_head, texts);
        let returns = match (&block.return_type, block.kind) {
            (Some(ty), _) => format!(" : {}", self.type_text(ty)),
            (None, CodeKind::Fc | CodeKind::Sfc) => " : Void".to_string(),
            (None, CodeKind::Ob | CodeKind::Fb | CodeKind::Sfb) => String::new(),
        };
        let name = self.document_name(&block.name);
        self.out.line(format!("{keyword} {name}{returns}"));
        self.attribute_line(&after_head);
        self.flags(&block.header);
        self.out.indent();
        self.declarations(block);
        match &block.code {
            Code::Graphic(body) => body.networks.iter().for_each(|network| self.sd_network(network, texts)),
            Code::Scl(body) => self.scl_network(&body.statements, end),
            Code::Stl(_) | Code::Chart(_) => {}
        }
        self.remarks_before(end);
        self.out.dedent();
        self.out.line(format!("END_{keyword}"));
    }

    /// The statements of a block in SCL. `end`: where their comments end.
    fn scl_network(&mut self, statements: &[Statement], end: u32) {
        self.out.line("{ S7_Language := \"SCL\" }");
        self.out.line("NETWORK");
        self.out.indent();
        self.statements(statements);
        self.remarks_before(end);
        self.out.dedent();
        self.out.line("END_NETWORK");
    }

    fn sd_data(&mut self, block: &DataBlock, texts: &mut Texts) {
        let (content, values) = self.declared_content(&block.content);
        let head_end = match &block.content {
            DataContent::OfType(ty) | DataContent::Array(ty, _) => ty.span.end,
            DataContent::Struct(_) | DataContent::Empty => block.name.span().end,
        };
        let after_head = self.attributes_after_head(head_end);
        self.remarks_before(block.span.start);
        let header =
            if self.braces.is_some() { block.header.clone() } else { with_retention(&block.header, Notation::Sd) };
        self.sd_header((&header, is_standard(&header)), block.span, &after_head, texts);
        let name = self.document_name(&block.name);
        if let DataContent::Array(_, Some(values)) = &content {
            let title = "SIMATIC SD has no start values of a data block that is an array";
            self.warn(values.span, title, "set them in the editor again");
        }
        match &content {
            DataContent::OfType(ty) | DataContent::Array(ty, _) => {
                let ty = self.type_text(ty);
                self.out.line(format!("DATA_BLOCK {name} : {ty}"));
                self.attribute_line(&after_head);
                self.flags(&block.header);
            }
            DataContent::Struct(members) => {
                self.out.line(format!("DATA_BLOCK {name}"));
                self.attribute_line(&after_head);
                self.flags(&block.header);
                self.retained(members, &block.retained);
            }
            DataContent::Empty => {
                self.out.line(format!("DATA_BLOCK {name}"));
                self.attribute_line(&after_head);
                self.flags(&block.header);
            }
        }
        // Documents need no BEGIN.
        let begins = match self.braces {
            Some(_) => self.trivia.word("BEGIN", head_end, block.span.end).is_some(),
            None => !block.values.is_empty() || !values.is_empty(),
        };
        if begins {
            self.out.line("BEGIN");
        }
        self.assignments(&values);
        block.values.iter().for_each(|value| self.value(value));
        self.remarks_before(block.span.end);
        self.out.line("END_DATA_BLOCK");
    }

    /// A name as it is declared; a block with a number only is named by it.
    fn document_name(&self, name: &BlockName) -> String {
        match name {
            BlockName::Numbered { prefix, number, .. } => format!("{}{number}", prefix.letters()),
            BlockName::Symbol { name, span } => self.declared(name, *span),
        }
    }

    /// Whether a type of a document follows another one between TYPE and its end: it begins with its name.
    fn is_joined(&self, block: &Block) -> bool {
        match block {
            Block::Type(block) => self.braces.is_some() && block.span.start == block.name.span().start,
            Block::Code(_) | Block::Data(_) => false,
        }
    }

    /// `is_joined`: it follows another one, `is_followed`: another one follows it, before the end of both.
    fn sd_type(&mut self, block: &TypeBlock, (is_joined, is_followed): (bool, bool), texts: &mut Texts) {
        let name_start = block.name.span().start;
        let inner = if is_joined { Vec::new() } else { self.attributes_before(name_start) };
        self.remarks_before(block.span.start);
        if is_joined {
            self.out.indent();
        }
        self.sd_header((&block.header, false), block.span, &inner, texts);
        let name = self.document_name(&block.name);
        if !is_joined {
            self.out.line("TYPE");
            self.out.indent();
            self.attribute_line(&inner);
        }
        match &block.alias {
            Some(alias) => {
                let ty = self.type_text(alias);
                self.out.line(format!("{name} : {ty};"));
            }
            None => {
                self.out.line(format!("{name} : STRUCT"));
                self.variables(&block.members);
                self.out.line("END_STRUCT;");
            }
        }
        self.out.dedent();
        self.remarks_before(block.span.end);
        if !is_followed {
            self.out.line("END_TYPE");
        }
    }

    fn sd_network(&mut self, network: &Network, texts: &mut Texts) {
        self.remarks_before(network.span.start);
        self.network_attributes(network, texts);
        self.out.line("NETWORK");
        if let Some(word) = self.trivia.word("NETWORK", network.span.start, network.span.end) {
            let remarks = self.trivia.on_line(word);
            self.new_remarks(remarks);
        }
        self.out.indent();
        for label in &network.labels {
            self.out.line(format!("Label( {} )", label.text));
        }
        match &network.content {
            Content::Graphic(graph) => self.rungs(graph, network.language),
            Content::Scl(list) => {
                self.statements(list);
                let from = list.last().map_or(network.span.end, |last| last.span.end);
                if let Some(end) = self.trivia.next_word("END_NETWORK", from) {
                    self.remarks_before(end);
                }
            }
            Content::Stl(_) => self.refuse(network.span, "a network in STL has no rungs", "write it in LAD or FBD"),
        }
        self.out.dedent();
        self.out.line("END_NETWORK");
    }

    /// Comments that are not written yet.
    fn new_remarks(&mut self, mut remarks: Vec<Remark>) {
        remarks.retain(|remark| !self.is_written(&remark.text));
        self.out.remarks(&remarks);
    }

    fn rungs(&mut self, graph: &Graph, language: Language) {
        let wires = Wires::new(graph);
        let crossed = crossed(graph);
        let mut rung: Option<Rung> = None;
        for (at, element) in graph.elements.iter().enumerate() {
            let flow = flow_pin(element).map(|pin| (&pin.value, pin.negated));
            let joined = match (&rung, flow) {
                (Some(rung), Some((PinValue::Net(net), _))) => {
                    rung.out == Some(*net) && wires.is_first(graph, *net, at.wrapping_sub(1))
                }
                _ => false,
            };
            if !joined {
                if let Some(rung) = rung.take() {
                    self.end(rung, &wires);
                }
                rung = Some(Rung { text: String::from("RUNG"), out: None, fed: true });
            }
            let mut current = rung.take().unwrap_or(Rung { text: String::from("RUNG"), out: None, fed: true });
            match flow {
                Some((PinValue::Net(net), _)) if joined && wires.is_only(graph, *net) => {}
                Some((PinValue::Net(net), _)) => current.text.push_str(&format!(" wire#{}", wires.name(*net))),
                Some((PinValue::Operand(value), _)) => {
                    let text = self.sd_operand(value);
                    current.text.push_str(&format!(" {text}"));
                    let passes_on = |source: &str| written::passes_on(source, value.span.end);
                    if language == Language::Fbd && self.source.is_some_and(passes_on) {
                        current.text.push_str("  A()");
                    }
                }
                Some((PinValue::Open, _)) | None if language == Language::Lad => {
                    current.text.push_str(" wire#powerrail")
                }
                Some((PinValue::Open, _)) | None => {}
            }
            let is_negated = flow.is_some_and(|(_, negated)| negated);
            // `{ … } NOT #t.TON( … )`
            let is_inner = is_negated
                && language == Language::Fbd
                && self.source.is_some_and(|source| written::is_negated(source, element.span.start));
            if is_negated && !is_inner {
                current.text.push_str(if language == Language::Lad { " Not()" } else { " NOT" });
            }
            if is_not(element) && language == Language::Fbd {
                current.text.push_str(" NOT");
            } else {
                let text = self.sd_element(graph, &wires, at, language, is_inner);
                current.text.push_str(&format!("  {text}"));
            }
            current.out = out_pin(element).and_then(|(_, pin)| match pin.value {
                PinValue::Net(net) => Some(net),
                PinValue::Operand(_) | PinValue::Open => None,
            });
            current.fed = current.out.is_none();
            if let Some(last) = at.checked_sub(1).filter(|_| !joined) {
                let remarks = self.trivia.on_line(graph.elements[last].span.end);
                self.new_remarks(remarks);
            }
            let mut remarks = self.trivia.before(element.span.start);
            remarks.retain(|remark| !self.is_written(&remark.text));
            // The last line is that of another rung.
            remarks.iter_mut().for_each(|remark| remark.own_line = true);
            let asserts = remarks.iter().any(|remark| remark.text.starts_with("//@"));
            if asserts && at > 0 && !joined && !crossed[at] {
                // An assertion stands between networks.
                self.out.dedent();
                self.out.line("END_NETWORK");
                self.out.remarks(&remarks);
                self.out.line(format!(
                    "{{ S7_Language := \"{}\" }}",
                    if language == Language::Lad { "LAD" } else { "FBD" }
                ));
                self.out.line("NETWORK");
                self.out.indent();
            } else {
                if asserts && at > 0 {
                    let title = "an assertion before this element stands inside its network, where `plcc test` does not read it";
                    self.warn(element.span, title, "move it after the network, or end the logic before it with SET");
                }
                self.out.remarks(&remarks);
            }
            rung = Some(current);
        }
        if let Some(rung) = rung.take() {
            self.end(rung, &wires);
        }
        // Nets that operands or other nets feed.
        for (at, net) in graph.nets.iter().enumerate() {
            for source in &net.sources {
                let name = wires.name(NetId(at as u32));
                match source {
                    Source::Operand { value, negated } => {
                        let text = self.sd_operand(value);
                        let not = if *negated { " NOT" } else { "" };
                        self.out.line(format!("RUNG {text}{not}  A()  END_RUNG wire#{name}"));
                    }
                    Source::Net(other) => {
                        let text = wires.name(*other).to_string();
                        self.out.line(format!("RUNG wire#{text}  END_RUNG wire#{name}"));
                    }
                    Source::Rail if net.sources.len() > 1 => {
                        self.out.line(format!("RUNG wire#powerrail  END_RUNG wire#{name}"));
                    }
                    Source::Rail | Source::Pin { .. } => {}
                }
            }
        }
    }

    fn end(&mut self, rung: Rung, wires: &Wires) {
        match rung.out.filter(|_| !rung.fed) {
            Some(net) => self.out.line(format!("{}  END_RUNG wire#{}", rung.text, wires.name(net))),
            None => self.out.line(format!("{}  END_RUNG", rung.text)),
        }
    }

    /// `is_negated`: the flow is inverted between the attributes and the element.
    fn sd_element(&mut self, graph: &Graph, wires: &Wires, at: usize, language: Language, is_negated: bool) -> String {
        let element = &graph.elements[at];
        self.sd_check_element(element);
        let source = self.source;
        let written = match &element.target {
            Target::Element { row, .. } => source
                .and_then(|source| written::element(source, element.span, row, element_name(row, element, language))),
            Target::Block { .. } => None,
        };
        let (name, row) = match &element.target {
            Target::Element { row, instance } => {
                let name = written.as_ref().map_or(element_name(row, element, language), |written| written.name);
                let instance = instance.as_ref().map(|instance| expression::text(instance, self));
                (instance.map_or_else(|| name.to_string(), |instance| format!("{instance}.{name}")), Some(*row))
            }
            Target::Block { instance: Some(instance), .. } => (expression::text(instance, self), None),
            Target::Block { callee, instance: None } => (self.sd_callee(callee), None),
        };
        let flow = flow_pin(element).map(|pin| pin.name.clone());
        let out = out_pin(element).map(|(index, _)| index);
        let mut arguments = Vec::new();
        for (index, pin) in element.pins.iter().enumerate() {
            let is_flow = !pin.output && flow.as_deref() == Some(pin.name.as_str());
            let is_out = out == Some(index) && matches!(pin.value, PinValue::Net(_));
            if is_flow || is_out {
                continue;
            }
            let text = self.sd_argument(wires, row, pin);
            let is_unnamed = self.source.is_some_and(|source| written::is_unnamed(source, pin.span));
            let value = text.strip_prefix(&pin.name).and_then(|rest| rest.trim_start().split_once(' '));
            let value = value.filter(|(sign, _)| is_unnamed && matches!(*sign, ":=" | "=>"));
            let value = value.map(|(_, value)| value.to_string());
            arguments.push((pin.span.start, text, value));
        }
        // In the order of the author, with the pins that are open.
        if let Some(written) = written {
            let is_known =
                |text: &str| element.pins.iter().any(|pin| text.split(' ').next() == Some(pin.name.as_str()));
            let open = written.open.into_iter().filter(|(_, text)| !is_known(text));
            let is_all = arguments.iter().all(|(start, ..)| written.arguments.contains(start));
            arguments.extend(open.map(|(start, text)| (start, text, None)));
            if is_all {
                arguments.sort_by_key(|(start, ..)| *start);
                for (_, text, value) in &mut arguments {
                    *text = value.take().unwrap_or_else(|| std::mem::take(text));
                }
            }
        }
        let arguments: Vec<String> = arguments.into_iter().map(|(_, text, _)| text).collect();
        let (settings, inline) = self.settings(element);
        let arguments = match arguments.is_empty() {
            true => "()".to_string(),
            false => format!("( {} )", arguments.join(", ")),
        };
        let not = if is_negated { "NOT  " } else { "" };
        format!("{settings}{not}{name}{inline}{arguments}")
    }

    fn sd_argument(&mut self, wires: &Wires, row: Option<&Row>, pin: &Pin) -> String {
        if pin.storage != Storage::None {
            self.refuse(pin.span, "an output that sets or resets its operand", "write a set or reset coil");
        }
        let is_negated_name =
            row.is_some_and(|row| matches!(row.kind, Kind::Contact | Kind::Coil)) && pin.name == "operand";
        if pin.negated && pin.output && !is_negated_name {
            self.refuse(pin.span, "an inverted output", "invert the value after the element");
        }
        let not = if pin.negated && !is_negated_name { "NOT " } else { "" };
        let value = match &pin.value {
            PinValue::Net(net) => format!("wire#{}", wires.name(*net)),
            PinValue::Operand(value) => {
                let count = count(row, &pin.name, value).filter(|_| self.source.is_none());
                count.unwrap_or_else(|| self.sd_operand(value))
            }
            PinValue::Open => String::new(),
        };
        let unnamed = row.is_some_and(|row| match row.kind {
            Kind::Contact | Kind::Coil | Kind::SetCoil | Kind::ResetCoil | Kind::OpenDb { .. } | Kind::CallCoil => {
                pin.name == "operand"
            }
            Kind::EdgeTrigger { .. } => pin.name == "bit",
            Kind::Jump { .. } => pin.name == "label",
            _ => false,
        });
        if unnamed {
            return format!("{not}{value}");
        }
        let is_assigned = self.source.is_some_and(|source| written::is_assigned(source, pin.span, &pin.name));
        let known = row.and_then(|row| row.pin(&pin.name));
        let is_in_out = known.is_some_and(|(known, _)| known.direction == PinDirection::InOut);
        let sign = if pin.output && !is_assigned && !is_in_out { "=>" } else { ":=" };
        // The parameters of a block have any names.
        let name = if row.is_some() { pin.name.clone() } else { names::declared(&pin.name) };
        format!("{name} {sign} {not}{value}").trim_end().to_string()
    }

    /// The attributes before an element, and those after its name.
    fn settings(&mut self, element: &Element) -> (String, String) {
        let mut list = Vec::new();
        let mut types = Vec::new();
        for template in &element.templates {
            let key = match template.key {
                TemplateKey::Source => "SrcType",
                TemplateKey::Destination => "DestType",
                TemplateKey::Value => "value_type",
                TemplateKey::Time => "time_type",
                TemplateKey::Card | TemplateKey::Other => continue,
            };
            types.push(format!("{key} := {}", template.value));
        }
        let is_box = matches!(&element.target, Target::Element { row, .. } if row.flow.1 == "eno" && !matches!(row.kind, Kind::Instance(_)));
        // After the name, as older versions write them, they leave ENO as it is.
        let is_inline = is_box && element.eno == Eno::Default && !types.is_empty();
        match &types[..] {
            [] => {}
            types if is_inline => list.extend(types.iter().cloned()),
            [one] => list.push(format!("S7_Templates := \"{one}\"")),
            several => list.push(format!("S7_Templates := \"[{}]\"", several.join(", "))),
        }
        if let Some(equation) = &element.equation {
            let text = expression::text(equation, self);
            list.push(format!("S7_Expression := \"{text}\""));
        }
        match element.eno {
            Eno::Generated => list.push("S7_GenerateENO := \"TRUE\"".to_string()),
            // A box without the setting has its ENO switched off.
            Eno::Disabled if is_box => {}
            Eno::Disabled => list.push("S7_GenerateENO := \"FALSE\"".to_string()),
            Eno::Default => {}
        }
        for (at, case) in element.cases.iter().enumerate() {
            let sign = match case {
                Comparison::Equal => "==",
                Comparison::NotEqual => "<>",
                Comparison::Less => "<",
                Comparison::LessEqual => "<=",
                Comparison::Greater => ">",
                Comparison::GreaterEqual => ">=",
            };
            list.push(format!("CASE{at} := \"{sign}\""));
        }
        match (list.is_empty(), is_inline) {
            (true, _) => (String::new(), String::new()),
            (false, true) => (String::new(), format!(" {{ {} }}", list.join("; "))),
            (false, false) => (format!("{{ {} }}  ", list.join("; ")), String::new()),
        }
    }
}

/// The constant that a counter is set to, as `C#12`.
fn count(row: Option<&Row>, pin: &str, value: &Expr) -> Option<String> {
    let is_count = matches!(row?.kind, Kind::S5Counter(_) | Kind::CounterCoil(CounterCoil::Set)) && pin == "pv";
    let ExprKind::Literal(Literal::Typed { ty: Elementary::Word, bits }) = &value.kind else { return None };
    let is_decimal = *bits <= 0x999 && (0..3).all(|digit| *bits >> (4 * digit) & 0xF < 10);
    (is_count && is_decimal).then(|| format!("C#{bits:X}"))
}

/// A rung that is not finished.
struct Rung {
    text: String,
    /// The net that its last element feeds.
    out: Option<NetId>,
    /// Nothing is to be connected at its end.
    fed: bool,
}

fn is_not(element: &Element) -> bool {
    matches!(&element.target, Target::Element { row, .. } if row.kind == Kind::Not)
}

fn flow_pin(element: &Element) -> Option<&Pin> {
    match &element.target {
        Target::Element { row, .. } if row.flow.0.is_empty() => None,
        Target::Element { row, .. } => element.pin(row.pin(row.flow.0)?.0.name()).filter(|pin| !pin.output),
        Target::Block { .. } => element.pins.iter().find(|pin| pin.name == "en"),
    }
}

/// The pin that the flow leaves by.
fn out_pin(element: &Element) -> Option<(usize, &Pin)> {
    let name = match &element.target {
        Target::Element { row, .. } => row.pin(row.flow.1)?.1,
        Target::Block { .. } => "eno".to_string(),
    };
    element
        .pins
        .iter()
        .enumerate()
        .find(|(_, pin)| pin.output && pin.name == name && matches!(pin.value, PinValue::Net(_)))
}

fn element_name(row: &'static Row, element: &Element, language: Language) -> &'static str {
    let negated = element.pin("operand").is_some_and(|pin| pin.negated);
    match row.kind {
        Kind::Contact if negated => "I_Contact",
        Kind::Coil if negated => "I_Coil",
        Kind::Compare(_) if language == Language::Lad => row.sd.first().unwrap_or(&row.name),
        _ => row.name,
    }
}
