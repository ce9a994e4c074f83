//! An element of a rung: its name, its arguments, and the settings in braces before it.

use plcc_syntax::Elementary;
use plcc_syntax::network::ast::{
    Comparison, Element, Eno, Graph, Language, Pin, PinValue, Storage, Target, TemplateKey,
};
use plcc_syntax::network::elements::{CounterCoil, Kind, PinDirection, Row};
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal};

use super::wires::Wires;
use super::written;
use crate::names;
use crate::scl::expression;
use crate::writer::Writer;

impl Writer<'_> {
    /// `is_negated`: the flow is inverted between the attributes and the element.
    pub(super) fn sd_element(
        &mut self,
        graph: &Graph,
        wires: &Wires,
        at: usize,
        language: Language,
        is_negated: bool,
    ) -> String {
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

/// An inverter of the flow.
pub(super) fn is_not(element: &Element) -> bool {
    matches!(&element.target, Target::Element { row, .. } if row.kind == Kind::Not)
}

/// The pin that the flow enters by.
pub(super) fn flow_pin(element: &Element) -> Option<&Pin> {
    match &element.target {
        Target::Element { row, .. } if row.flow.0.is_empty() => None,
        Target::Element { row, .. } => element.pin(row.pin(row.flow.0)?.0.name()).filter(|pin| !pin.output),
        Target::Block { .. } => element.pins.iter().find(|pin| pin.name == "en"),
    }
}

/// The pin that the flow leaves by.
pub(super) fn out_pin(element: &Element) -> Option<(usize, &Pin)> {
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
