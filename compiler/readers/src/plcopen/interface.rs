//! Declarations: variables, their types and their initial values.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};
use roxmltree::Node;

use super::Reader;
use super::editor::Editor;
use super::functions;
use super::overlay::content;
use super::scope::FlipFlop;
use plcc_syntax::ast::{
    BlockName, Bound, Constant, InitialKind, InitialValue, Retain, Section, SectionKind, TypeKind, TypeRef, Variable,
};
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind, Literal, Name, NameForm, UnaryOp};

/// Types inside types are read up to this depth.
const DEPTH_MAX: usize = 32;

/// Characters of a text without a length in CODESYS, and with MATIEC.
const TEXT_OF_CODESYS: i64 = 80;
const TEXT_OF_MATIEC: i64 = 126;

/// A variable list of an interface.
pub const LISTS: &[(&str, SectionKind)] = &[
    ("inputVars", SectionKind::Input),
    ("outputVars", SectionKind::Output),
    ("inOutVars", SectionKind::InOut),
    ("localVars", SectionKind::Static),
    ("tempVars", SectionKind::Temp),
];

/// Whether an attribute of a node is true.
pub fn is_true(node: Node, attribute: &str) -> bool {
    matches!(node.attribute(attribute).map(str::trim), Some("true" | "1"))
}

/// The elements below a node.
pub fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

/// The first element of that name below a node.
pub fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    elements(node).find(|child| child.tag_name().name() == name)
}

impl Reader<'_> {
    pub fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.file, range)
    }

    /// The position of a node in messages: the value of an attribute, otherwise the start of its tag.
    pub fn place(&self, node: Node, attribute: &str) -> Span {
        match node.attribute_node(attribute) {
            Some(found) => self.span(found.range_value()),
            None => self.span(node.range().start..(node.range().start + 1 + node.tag_name().name().len())),
        }
    }

    /// The text of a node without outer blanks, as bytes of the file.
    pub fn text_range(&self, node: Node) -> Option<Range<usize>> {
        let range = content(node)?;
        let text = self.overlay.get(range.clone())?;
        let start = range.start + text.len() - text.trim_start().len();
        let end = range.end - (text.len() - text.trim_end().len());
        (start < end).then_some(start..end)
    }

    /// The sections of an interface, without variables that have an address.
    pub fn sections(&mut self, interface: Node, function: bool) -> (Vec<Section>, Vec<Constant>) {
        let (mut sections, mut constants) = (Vec::new(), Vec::new());
        for list in elements(interface) {
            let name = list.tag_name().name();
            let Some((_, kind)) = LISTS.iter().find(|(known, _)| *known == name) else {
                if !matches!(name, "externalVars" | "returnType" | "documentation" | "addData") {
                    let text = format!("plcc does not read the list `{name}` of an interface");
                    let message = Diagnostic::new(Code::ForeignContent, self.place(list, "name"), text);
                    let help = "declare the variables as local or global ones";
                    self.messages.push(message.label("its variables are not declared").help(help));
                }
                continue;
            };
            self.unread(list, &["variable", "documentation", "addData"]);
            let kind = if function && *kind == SectionKind::Static { SectionKind::Temp } else { *kind };
            let mut variables: Vec<Node> = elements(list).filter(|node| node.tag_name().name() == "variable").collect();
            if is_true(list, "constant") {
                // Structures and arrays are not constants of this CPU; they are read-only, so variables serve instead.
                variables.retain(|node| match self.constant_value(*node) {
                    Some(constant) => {
                        constants.push(constant);
                        false
                    }
                    None => true,
                });
            }
            self.retentive(list);
            let is = |attribute: &str| is_true(list, attribute);
            let types = self.types.clone();
            let has_place = |reader: &Self, node: &Node| {
                node.has_attribute("address") && super::globals::located(&types, &reader.addresses, *node).is_some()
            };
            let variables: Vec<Node> = variables.into_iter().filter(|node| !has_place(self, node)).collect();
            let mut variables: Vec<Variable> =
                variables.into_iter().filter_map(|node| self.variable(node, 0)).collect();
            if matches!(kind, SectionKind::Static | SectionKind::Temp) {
                variables.iter_mut().for_each(|variable| self.give_length(&mut variable.ty));
            }
            let retain = match (is("retain"), is("nonretain")) {
                (true, _) if kind == SectionKind::Static => Retain::Retain,
                (_, true) if kind == SectionKind::Static => Retain::NonRetain,
                _ => Retain::Unsaid,
            };
            if !variables.is_empty() {
                sections.push(Section { kind, retain, variables, span: self.place(list, "name") });
            }
        }
        (sections, constants)
    }

    /// Reports variables that the editor keeps over a power loss: here each run begins with the start values.
    pub fn retentive(&mut self, list: Node) {
        let Some(attribute) = ["retain", "persistent"].into_iter().find(|attribute| is_true(list, attribute)) else {
            return;
        };
        let names: Vec<&str> = elements(list).filter_map(|node| node.attribute("name")).collect();
        if names.is_empty() {
            return;
        }
        let more = if names.len() > 4 { format!(" and {} others", names.len() - 3) } else { String::new() };
        let shown = if names.len() > 4 { &names[..3] } else { &names[..] };
        let named = format!("`{}`{more}", shown.join("`, `"));
        let text = format!("retentive variables begin each run with their start values without `--retain`: {named}");
        let message = Diagnostic::new(Code::Tolerated, self.place(list, attribute), text);
        let help = "run with `--retain FILE`, or set remembered values in a scenario or with `--set`";
        self.messages.push(message.label("a PLC keeps it when its power fails").help(help));
    }

    /// The constant that a variable declares; none if its value is a structure or an array, or missing.
    pub fn constant_value(&mut self, node: Node) -> Option<Constant> {
        let name = node.attribute("name")?.to_string();
        let name_span = self.place(node, "name");
        let value = child(node, "initialValue").and_then(|value| child(value, "simpleValue"))?;
        let range = value.attribute_node("value")?.range_value();
        let ty = child(node, "type").and_then(|ty| self.type_of(ty, 0));
        let ty = ty.filter(|ty| !matches!(ty.kind, TypeKind::Block(_))).or_else(|| {
            // For an enumeration or another named type: the type of its value.
            let ty = super::globals::elementary(&self.types, node)?;
            Some(TypeRef { kind: TypeKind::Named(ty), span: name_span })
        });
        let mut value = self.expression(range, None);
        self.known_names(&mut value);
        Some(Constant { name, name_span, ty, value: Some(value), initial: None })
    }

    /// Names of enumeration values and global constants become their values: for declarations, where the names of POUs are unknown.
    fn known_names(&self, value: &mut Expr) {
        match &mut value.kind {
            ExprKind::Name(name) if name.form == NameForm::Bare => {
                let text = name.text.clone();
                let named = self.enums.iter().find(|(_, known, _)| known.eq_ignore_ascii_case(&text));
                if let Some((_, _, number)) = named {
                    *value = super::globals::integer(*number, value.span);
                } else if let Some(known) = self
                    .constants
                    .iter()
                    .find(|constant| constant.name.eq_ignore_ascii_case(&text))
                    .and_then(|constant| constant.value.clone())
                {
                    let span = value.span;
                    *value = known;
                    value.span = span;
                }
            }
            ExprKind::Member { base, name } => {
                let ExprKind::Name(ty) = &base.kind else { return };
                let is_value = |(node, known, _): &&(Node, String, i64)| {
                    let of = node.ancestors().find(|node| node.tag_name().name() == "dataType");
                    known.eq_ignore_ascii_case(&name.text)
                        && of.and_then(|of| of.attribute("name")).is_some_and(|of| of.eq_ignore_ascii_case(&ty.text))
                };
                if let Some((_, _, number)) = self.enums.iter().find(is_value) {
                    *value = super::globals::integer(*number, value.span);
                } else if self.lists.contains_key(&ty.text.to_lowercase()) {
                    value.kind = ExprKind::Name(Name { form: NameForm::Bare, ..name.clone() });
                    self.known_names(value);
                }
            }
            ExprKind::Unary { operand, .. } => self.known_names(operand),
            ExprKind::Binary { left, right, .. } => {
                self.known_names(left);
                self.known_names(right);
            }
            _ => {}
        }
    }

    /// A whole number that is already known: `10`, `COUNT`, `List.COUNT - 1`.
    fn known_number(&self, value: &Expr) -> Option<i64> {
        match &value.kind {
            ExprKind::Literal(Literal::Integer { value, .. }) => i64::try_from(*value).ok(),
            ExprKind::Unary { op: UnaryOp::Minus, operand } => self.known_number(operand)?.checked_neg(),
            ExprKind::Unary { op: UnaryOp::Plus, operand } => self.known_number(operand),
            ExprKind::Literal(Literal::Typed { ty, bits }) if ty.is_integer() => i64::try_from(*bits).ok(),
            ExprKind::Binary { op, left, right, .. } => {
                let (left, right) = (self.known_number(left)?, self.known_number(right)?);
                match op {
                    BinaryOp::Add => left.checked_add(right),
                    BinaryOp::Subtract => left.checked_sub(right),
                    BinaryOp::Multiply => left.checked_mul(right),
                    BinaryOp::Divide => left.checked_div(right),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// A declared variable or component.
    pub fn variable(&mut self, node: Node, depth: usize) -> Option<Variable> {
        let name_span = self.place(node, "name");
        let (Some(name), Some(holder)) = (node.attribute("name"), child(node, "type")) else {
            let message = Diagnostic::new(Code::ForeignContent, name_span, "a variable without a name or a type");
            self.messages.push(message.label("is not declared").help("export the project again"));
            return None;
        };
        let name = name.to_string();
        let mut ty = self.type_of(holder, depth)?;
        if depth > 0 {
            self.give_length(&mut ty);
        }
        let initial = child(node, "initialValue").and_then(|value| self.initial(value, depth));
        let ranged = super::types::Ty::of(holder).map(|ty| self.kinds.resolved(ty));
        if let (Some(ty), Some(InitialValue { kind: InitialKind::Expr(value), .. })) = (&ranged, &initial) {
            self.messages.extend(super::types::out_of_range(ty, value));
        }
        let initial = initial.or_else(|| self.type_value(holder, name_span));
        // A flip-flop is represented by its state: see `Scope::flip_flops`.
        let initial = if flip_flop(node).is_some() { None } else { initial };
        let comment = child(node, "documentation").map(|node| plain_text(node)).filter(|text| !text.is_empty());
        Some(Variable { name, name_span, attributes: Vec::new(), at: None, ty, initial, comment })
    }

    /// A text that is not a parameter has a length in these editors, also where none is written. A parameter may be a reference to a longer
    /// text.
    pub fn give_length(&self, ty: &mut TypeRef) {
        let characters = match self.editor {
            Editor::Codesys => TEXT_OF_CODESYS,
            Editor::Matiec => TEXT_OF_MATIEC,
            Editor::Other => return,
        };
        let span = ty.span;
        if let TypeKind::Array { element, .. } = &mut ty.kind {
            return self.give_length(element);
        }
        if let TypeKind::String(length) | TypeKind::WideString(length) = &mut ty.kind
            && length.is_none()
        {
            *length = Some(Bound::Number(characters, span));
        }
    }

    /// The value that a variable of a named type starts with: that of the type, otherwise the first one of an enumeration.
    fn type_value(&mut self, holder: Node, span: Span) -> Option<InitialValue> {
        let mut ty = elements(holder).next()?;
        for _ in 0..DEPTH_MAX {
            if ty.tag_name().name() == "enum" {
                let first = child(ty, "values").and_then(|values| elements(values).next())?;
                let (_, _, number) = self.enums.iter().find(|(node, ..)| *node == first)?;
                let kind = InitialKind::Expr(Box::new(super::globals::integer(*number, span)));
                return (*number != 0).then_some(InitialValue { kind, span });
            }
            if ty.tag_name().name() != "derived" {
                return None;
            }
            let known = self.types.get(&ty.attribute("name")?.to_lowercase()).copied()?;
            if let Some(value) = child(known, "initialValue") {
                return self.initial(value, 0);
            }
            ty = child(known, "baseType").and_then(|base| elements(base).next())?;
        }
        None
    }

    /// The type inside a `type` or `baseType` element.
    pub fn type_of(&mut self, holder: Node, depth: usize) -> Option<TypeRef> {
        let node = elements(holder).next()?;
        let span = self.place(node, "name");
        let refused = |reader: &mut Self, what: String| {
            let help = "declare the variable with an elementary type, a structure or an array";
            reader.messages.push(Diagnostic::new(Code::ForeignContent, span, what).help(help));
            None
        };
        if depth > DEPTH_MAX {
            return refused(self, "types inside types are nested too deeply".to_string());
        }
        let kind = match node.tag_name().name() {
            "derived" => {
                let name = node.attribute("name")?;
                let own = self.pous.contains(&name.to_lowercase()) || self.types.contains_key(&name.to_lowercase());
                match standard_block(self.editor, name).filter(|_| !own) {
                    Some(name) => TypeKind::Named(name.to_string()),
                    None => TypeKind::Block(BlockName::Symbol { name: name.to_string(), span }),
                }
            }
            "string" | "STRING" => TypeKind::String(self.length(node)),
            "wstring" | "WSTRING" => TypeKind::WideString(self.length(node)),
            "array" => {
                let element = child(node, "baseType").and_then(|base| self.type_of(base, depth + 1))?;
                let mut bounds = Vec::new();
                for dimension in elements(node).filter(|node| node.tag_name().name() == "dimension") {
                    let (Some(low), Some(high)) = (self.bound(dimension, "lower"), self.bound(dimension, "upper"))
                    else {
                        return refused(self, "an array without bounds".to_string());
                    };
                    bounds.push((low, high));
                }
                TypeKind::Array { bounds, element: Box::new(element) }
            }
            "struct" => {
                TypeKind::Struct(elements(node).filter_map(|member| self.variable(member, depth + 1)).collect())
            }
            "subrangeSigned" | "subrangeUnsigned" => {
                return child(node, "baseType").and_then(|base| self.type_of(base, depth + 1));
            }
            "enum" => TypeKind::Named("INT".to_string()),
            name @ ("pointer" | "reference" | "union") => {
                return refused(self, format!("plcc has no data type for `{name}` of PLCopen XML"));
            }
            // Dates count from 1970 in these editors.
            "DATE" | "DT" | "DATE_AND_TIME" | "date" | "dt" => TypeKind::Named("LDT".to_string()),
            name => TypeKind::Named(name.to_ascii_uppercase()),
        };
        Some(TypeRef { kind, span })
    }

    fn bound(&mut self, dimension: Node, attribute: &str) -> Option<Bound> {
        let value = dimension.attribute_node(attribute).filter(|value| !value.value().trim().is_empty())?;
        Some(self.number(value.range_value()))
    }

    /// A number of a declaration.
    fn number(&mut self, range: Range<usize>) -> Bound {
        let span = self.span(range.clone());
        let mut value = self.expression(range, None);
        self.known_names(&mut value);
        match (self.known_number(&value), value.kind) {
            (Some(number), _) => Bound::Number(number, span),
            (None, ExprKind::Name(name)) => Bound::Name(name.text, span),
            (None, kind) => Bound::Expr(Box::new(Expr { kind, span })),
        }
    }

    fn length(&mut self, node: Node) -> Option<Bound> {
        let value = node.attribute_node("length").filter(|length| !length.value().trim().is_empty())?;
        Some(self.number(value.range_value()))
    }

    /// The value inside an `initialValue` or `value` element.
    pub fn initial(&mut self, holder: Node, depth: usize) -> Option<InitialValue> {
        let node = elements(holder).next()?;
        let span = self.place(node, "value");
        let refused = |reader: &mut Self, what: &str| {
            let message = Diagnostic::new(Code::ForeignContent, span, what.to_string());
            reader.messages.push(message.label("is not read").help("write a value, a list or a structure"));
            None
        };
        if depth > DEPTH_MAX {
            return refused(self, "values inside values are nested too deeply");
        }
        let kind = match node.tag_name().name() {
            "simpleValue" => {
                let range = node.attribute_node("value")?.range_value();
                if self.overlay.get(range.clone()).is_none_or(|text| text.trim().is_empty()) {
                    return None;
                }
                let mut value = self.expression(range, None);
                self.known_names(&mut value);
                InitialKind::Expr(Box::new(value))
            }
            "arrayValue" => {
                let mut values = Vec::new();
                for item in elements(node) {
                    let span = self.place(item, "value");
                    let value = self.initial(item, depth + 1);
                    let value = value.unwrap_or(InitialValue { kind: InitialKind::Default, span });
                    let count = item.attribute_node("repetitionValue").filter(|count| !count.value().trim().is_empty());
                    match count.map(|count| self.number(count.range_value())) {
                        Some(Bound::Number(1, _)) | None => values.push(value),
                        Some(count) => {
                            let span = value.span;
                            let kind = InitialKind::Repeat { count, values: vec![value] };
                            values.push(InitialValue { kind, span });
                        }
                    }
                }
                InitialKind::List(values)
            }
            "structValue" => {
                let mut fields = Vec::new();
                for item in elements(node) {
                    let Some(member) = item.attribute("member") else {
                        return refused(self, "a value of a structure without the name of its component");
                    };
                    let Some(value) = self.initial(item, depth + 1) else { continue };
                    let span = self.place(item, "member");
                    fields.push((Some(Name { text: member.to_string(), form: NameForm::Bare, span }), value));
                }
                InitialKind::Fields(fields)
            }
            name => {
                let what = format!("plcc does not read the initial value `{name}`");
                return refused(self, &what);
            }
        };
        Some(InitialValue { kind, span })
    }
}

/// The type of an instance of a standard function block; `None`: a type of the file.
fn standard_block(editor: Editor, name: &str) -> Option<&'static str> {
    // CODESYS and MATIEC read PT in each call. All other projects, also those that plcc writes, have the timers of the TIA Portal.
    const TIMERS: &[(&str, &str)] = &[("TP", "TP_IEC"), ("TON", "TON_IEC"), ("TOF", "TOF_IEC")];
    const BLOCKS: &[(&str, &str)] = &[
        ("TP", "TP_TIME"),
        ("TON", "TON_TIME"),
        ("TOF", "TOF_TIME"),
        ("TONR", "TONR_TIME"),
        ("R_TRIG", "R_TRIG"),
        ("F_TRIG", "F_TRIG"),
        ("SR", "BOOL"),
        ("RS", "BOOL"),
    ];
    let timers = TIMERS.iter().filter(|_| editor != Editor::Other);
    let vendor = timers.chain(BLOCKS).find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, ty)| *ty);
    functions::block(editor, name).or(vendor)
}

/// Which flip-flop a variable is, of type SR or RS.
pub fn flip_flop(variable: Node) -> Option<FlipFlop> {
    let ty = child(variable, "type").and_then(|ty| child(ty, "derived"))?;
    match ty.attribute("name")?.to_ascii_uppercase().as_str() {
        "SR" => Some(FlipFlop::SetWins),
        "RS" => Some(FlipFlop::ResetWins),
        _ => None,
    }
}

/// The words of a node, without markup.
pub fn plain_text(node: Node) -> String {
    let texts: Vec<&str> = node.descendants().filter(|node| node.is_text()).filter_map(|node| node.text()).collect();
    texts.join(" ").split_whitespace().collect::<Vec<_>>().join(" ")
}
