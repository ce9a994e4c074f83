//! Settings of an element: types, ENO, the formula of CALCULATE, the comparisons of SWITCH.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_literal::distance;

use super::Builder;
use crate::sd::pragma::Attribute;
use crate::simatic_ml::parts::OTHER_TEMPLATES;
use plcc_syntax::network::ast::{Comparison, Eno, Template, TemplateKey};
use plcc_syntax::network::elements::{Kind, Row};
use plcc_syntax::scl::ast::Expr;

/// The contents of the attributes of an element.
#[derive(Default)]
pub struct Settings {
    pub templates: Vec<Template>,
    /// None: not given.
    pub eno: Option<Eno>,
    pub equation: Option<Expr>,
    /// By the number of the branch.
    pub cases: Vec<(usize, Comparison)>,
}

/// Functions whose ENO always reports errors (LAD/FBD reference B.9); the other boxes have a switch for it.
const ENO_ALWAYS: [&str; 17] = [
    "T_CONV",
    "T_ADD",
    "T_SUB",
    "T_DIFF",
    "T_COMBINE",
    "LEN",
    "MAX_LEN",
    "CONCAT",
    "LEFT",
    "RIGHT",
    "MID",
    "DELETE",
    "INSERT",
    "REPLACE",
    "FIND",
    "RUNTIME",
    "GET_ERR_ID",
];

/// Boxes without a value that have the switch (LAD/FBD reference B.5).
const ENO_SWITCHED: [&str; 4] = ["MOVE_BLK", "UMOVE_BLK", "FILL_BLK", "UFILL_BLK"];

/// Whether ENO of an element reports errors. `inline`: its settings come after its name, as V20 writes them.
pub fn eno(row: &Row, said: Option<Eno>, inline: bool) -> Eno {
    let switch = row.flow.1 == "eno"
        && match row.kind {
            Kind::Instance(_) => false,
            Kind::Procedure(name) => ENO_SWITCHED.contains(&name),
            Kind::Function(name) => !ENO_ALWAYS.contains(&name),
            _ => true,
        };
    match said {
        Some(eno) => eno,
        None if switch && !inline => Eno::Disabled,
        None => Eno::Default,
    }
}

impl Builder<'_, '_> {
    /// Reads the attributes before an element and those after its name.
    pub(super) fn settings(&mut self, attributes: &[Attribute], inline: &[Attribute]) -> Settings {
        let mut settings = Settings::default();
        for attribute in attributes {
            match () {
                () if attribute.is("S7_Templates") => self.templates(attribute, &mut settings.templates),
                () => self.setting(attribute, &mut settings),
            }
        }
        for attribute in inline {
            let key = TemplateKey::of(&attribute.key);
            match key {
                _ if attribute.is("S7_Templates") => self.templates(attribute, &mut settings.templates),
                TemplateKey::Other => self.setting(attribute, &mut settings),
                // The pins show how many there are.
                TemplateKey::Card => {}
                _ => settings.templates.push(Template {
                    key,
                    value: type_name(&attribute.value),
                    span: attribute.key_span.to(attribute.value_span),
                }),
            }
        }
        settings
    }

    fn setting(&mut self, attribute: &Attribute, settings: &mut Settings) {
        let truth = |yes, no| attribute.truth().map(|truth| if truth { yes } else { no });
        let case = attribute.key.get(..4).filter(|head| head.eq_ignore_ascii_case("CASE"));
        match () {
            () if attribute.is("S7_GenerateENO") => settings.eno = truth(Eno::Generated, Eno::Disabled),
            () if attribute.is("DisableENO") || attribute.is("DisabledENO") => {
                settings.eno = truth(Eno::Disabled, Eno::Generated);
            }
            () if attribute.is("S7_Expression") || attribute.is("Equation") || attribute.is("Expression") => {
                settings.equation = Some(self.expression(attribute.value_span));
            }
            () if case.is_some() => {
                let number = attribute.key[4..].parse::<usize>().ok().filter(|number| *number < 1000);
                match (number, Comparison::of(&attribute.value)) {
                    (Some(number), Some(comparison)) => settings.cases.push((number, comparison)),
                    _ => self.report(
                        Diagnostic::new(
                            Code::ElementType,
                            attribute.key_span.to(attribute.value_span),
                            "not a comparison of SWITCH",
                        )
                        .label("`==`, `<>`, `<`, `<=`, `>` or `>=` is expected")
                        .help("write e.g. `{ CASE0 := \"==\"; CASE1 := \">\" }`"),
                    ),
                }
            }
            () => self.misspelt_templates(attribute),
        }
    }

    /// `S7_Template := …`
    fn misspelt_templates(&mut self, attribute: &Attribute) {
        const NAMES: [&str; 4] = ["S7_Templates", "S7_GenerateENO", "S7_Expression", "DisabledENO"];
        let Some(meant) = distance::nearest(&attribute.key, NAMES.into_iter()) else { return };
        let title = format!("the attribute `{}` is not known", attribute.key);
        self.report(
            Diagnostic::new(Code::AttributeValue, attribute.key_span, title)
                .label("has no effect")
                .help(format!("is `{meant}` meant?")),
        );
    }

    /// Warns of a misspelt key or type of a template: the types would follow from the operands in its place.
    fn check_template(&mut self, key: &str, value: &str, span: Span) {
        const KEYS: [&str; 5] = ["SrcType", "DestType", "Card", "value_type", "time_type"];
        // `SrcType1` and `SrcType2` of EXPT.
        let known = |name: &str| {
            let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
            TemplateKey::of(stem) != TemplateKey::Other
                || KEYS.iter().chain(OTHER_TEMPLATES).any(|known| known.eq_ignore_ascii_case(name))
        };
        let types = || plcc_syntax::Elementary::ALL.iter().map(|ty| ty.name());
        // A data type of the program may have any name that is not a slip.
        const OTHERS: [&str; 8] = ["DTL", "STRING", "WSTRING", "VARIANT", "ANY", "STRUCT", "DB_ANY", "VOID"];
        let is_type = |name: &str| {
            let upper = name.to_ascii_uppercase();
            plcc_syntax::Elementary::from_word(&upper).is_some() || OTHERS.contains(&upper.as_str())
        };
        let (written, meant) = match (known(key), is_type(value)) {
            (false, _) => (key, distance::nearest(key, KEYS.into_iter())),
            (true, false) => (value, distance::nearest(value, types())),
            (true, true) => return,
        };
        let help = match meant {
            Some(meant) => format!("is `{meant}` meant?"),
            None if !known(key) => "check whether the element works as intended without it".to_owned(),
            None => return,
        };
        let title = format!("`{written}` is not known in `S7_Templates`");
        self.report(Diagnostic::new(Code::AttributeValue, span, title).label("has no effect").help(help));
    }

    /// `SrcType := Int`, `[SrcType := Int, DestType := Real]`
    fn templates(&mut self, attribute: &Attribute, templates: &mut Vec<Template>) {
        let text = attribute.value.as_str();
        let bare = text.trim().trim_start_matches('[').trim_end_matches(']');
        if bare.trim().is_empty() {
            return;
        }
        for entry in bare.split([',', ';']) {
            let offset = entry.as_ptr() as usize - text.as_ptr() as usize;
            let start = attribute.value_span.start + offset as u32;
            let span = Span { start, end: start + entry.len() as u32, ..attribute.value_span };
            match entry.split_once(":=") {
                Some((key, value)) if !key.trim().is_empty() => {
                    self.check_template(key.trim(), value.trim(), span);
                    let key = TemplateKey::of(key.trim());
                    if key != TemplateKey::Card {
                        templates.push(Template { key, value: type_name(value), span });
                    }
                }
                _ => self.report(
                    Diagnostic::new(Code::ElementType, span, "not a data type of an element")
                        .label("`key := type` is expected")
                        .help("write e.g. `\"SrcType := Int\"`, or `\"[SrcType := Int, DestType := Real]\"`"),
                ),
            }
        }
    }
}

/// A type name without quotes; empty where the type is found from the operands.
fn type_name(text: &str) -> String {
    text.trim().trim_matches(['"', '\'']).trim().to_string()
}
