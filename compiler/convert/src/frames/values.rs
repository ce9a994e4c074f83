//! Start values of variables.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Bound, DataContent, InitialKind, InitialValue, TypeKind, TypeRef, Variable};
use plcc_syntax::scl::ast::Name;

use crate::scl::expression;
use crate::to_stl::types::elementary;
use crate::writer::{Notation, Writer};
use crate::{literal, operand};

/// Start values with the places in their data block, `a[2].w`.
pub(crate) type Assignments = Vec<(String, InitialValue)>;

impl Writer<'_> {
    /// The content of a data block without those start values that a declaration does not have; these come after BEGIN.
    pub(crate) fn declared_content(&self, content: &DataContent) -> (DataContent, Assignments) {
        let (mut content, mut found) = (content.clone(), Vec::new());
        if let DataContent::Struct(members) = &mut content {
            self.move_values("", members, &mut found);
        }
        (content, found)
    }

    fn move_values(&self, before: &str, members: &mut [Variable], found: &mut Assignments) {
        for member in members {
            let path = format!("{before}{}", self.declared(&member.name, member.name_span));
            match member.initial.take() {
                Some(value) if self.fits(&value, &member.ty) => member.initial = Some(value),
                Some(value) => self.spread(path, value, found),
                None => {
                    if let TypeKind::Struct(members) = &mut member.ty.kind {
                        self.move_values(&format!("{path}."), members, found);
                    }
                }
            }
        }
    }

    /// The values of single components and elements, each with its place.
    fn spread(&self, path: String, value: InitialValue, found: &mut Assignments) {
        match value.kind {
            InitialKind::Elements(elements) => {
                for (index, value) in elements {
                    let index: Vec<String> = index.iter().map(i64::to_string).collect();
                    self.spread(format!("{path}[{}]", index.join(", ")), value, found);
                }
            }
            InitialKind::Fields(fields) if fields.iter().all(|(name, _)| name.is_some()) => {
                for (name, value) in fields {
                    let name = name.map(|name| self.declared(&name.text, name.span)).unwrap_or_default();
                    self.spread(format!("{path}.{name}"), value, found);
                }
            }
            InitialKind::Literal(_)
            | InitialKind::List(_)
            | InitialKind::Repeat { .. }
            | InitialKind::Expr(_)
            | InitialKind::Fields(_)
            | InitialKind::Operand(_)
            | InitialKind::Default => found.push((path, value)),
        }
    }

    /// Whether only components and elements can be assigned, not the whole value.
    pub(super) fn has_parts(&self, value: &InitialValue) -> bool {
        let is_named = |fields: &[(Option<Name>, InitialValue)]| fields.iter().any(|(name, _)| name.is_some());
        has_elements(value)
            || self.notation == Notation::Stl && matches!(&value.kind, InitialKind::Fields(fields) if is_named(fields))
    }

    /// Values as those of their components and elements.
    pub(super) fn parts(&self, list: Assignments) -> Assignments {
        let mut found = Vec::new();
        for (path, value) in list {
            self.spread(path, value, &mut found);
        }
        found
    }

    /// Whether a declaration has such a start value.
    fn fits(&self, value: &InitialValue, ty: &TypeRef) -> bool {
        let is_stl = self.notation == Notation::Stl;
        match (&value.kind, &ty.kind) {
            (InitialKind::Elements(elements), TypeKind::Array { bounds, element }) => {
                let fits = |place: Option<&InitialValue>| match place {
                    Some(value) => self.fits(value, element),
                    None => default_text(element, is_stl).is_some(),
                };
                (!is_stl || matches!(element.kind, TypeKind::Named(_) | TypeKind::String(_)))
                    && places(elements, bounds).is_some_and(|places| places.into_iter().all(fits))
            }
            (InitialKind::Elements(_), _) => false,
            // STL has the values of a structure in their order only.
            (InitialKind::Fields(fields), _) => {
                let is_left =
                    |(name, value): &(Option<Name>, InitialValue)| is_stl && name.is_some() || has_elements(value);
                !fields.iter().any(is_left)
            }
            (
                InitialKind::Literal(_)
                | InitialKind::List(_)
                | InitialKind::Repeat { .. }
                | InitialKind::Expr(_)
                | InitialKind::Operand(_)
                | InitialKind::Default,
                _,
            ) => true,
        }
    }

    pub(crate) fn assignments(&mut self, list: &Assignments) {
        for (path, value) in list {
            let text = self.initial(value);
            self.out.line(format!("{path} := {text};"));
        }
    }

    /// The start value of a variable. Text has those of an array as a list from its first element on, XML those of single elements.
    pub(super) fn initial_of(&mut self, value: &InitialValue, ty: &TypeRef) -> String {
        let (InitialKind::Elements(elements), TypeKind::Array { bounds, element }) = (&value.kind, &ty.kind) else {
            return self.initial(value);
        };
        // STL has lists of constants only.
        let is_stl = self.notation == Notation::Stl;
        if is_stl && !matches!(element.kind, TypeKind::Named(_) | TypeKind::String(_)) {
            return self.initial(value);
        }
        let list = places(elements, bounds).and_then(|places| {
            let texts = places.into_iter().map(|place| match place {
                Some(value) => Some(self.initial_of(value, element)),
                None => default_text(element, is_stl).map(str::to_string),
            });
            texts.collect::<Option<Vec<String>>>()
        });
        let Some(list) = list else { return self.no_elements(value.span) };
        let runs = list.chunk_by(|a, b| a == b).map(|run| match run {
            [one] => one.clone(),
            // Lists in lists are not repeated, nor are structures.
            several if several[0].starts_with(['[', '(']) => several.join(", "),
            several => format!("{}({})", several.len(), several[0]),
        });
        let list = runs.collect::<Vec<_>>().join(", ");
        if is_stl { list } else { format!("[{list}]") }
    }

    pub(crate) fn initial(&mut self, value: &InitialValue) -> String {
        match &value.kind {
            InitialKind::Literal(constant) => self.slice(value.span, constant),
            InitialKind::List(values) => {
                let list = self.initials(values);
                let of_structures = values.iter().any(|value| matches!(value.kind, InitialKind::Fields(_)));
                if self.notation == Notation::Stl && !of_structures { list } else { format!("[{list}]") }
            }
            InitialKind::Repeat { count, values } => format!("{}({})", self.bound(count), self.initials(values)),
            InitialKind::Expr(constant) => match (self.notation, operand::constant(constant)) {
                (Notation::Stl, _) if operand::only_declared(constant) => expression::text(constant, self),
                (Notation::Stl, Some(constant)) => literal::stl(&constant, self.mnemonics),
                (Notation::Stl, None) => {
                    self.needs_scl(value.span, "an expression as an initial value");
                    String::new()
                }
                (Notation::Scl | Notation::Sd | Notation::Gr7 | Notation::St, _) => expression::text(constant, self),
            },
            InitialKind::Elements(_) if self.notation == Notation::Stl => {
                self.needs_scl(value.span, "initial values of single elements");
                String::new()
            }
            InitialKind::Elements(_) => self.no_elements(value.span),
            InitialKind::Fields(fields) => {
                if fields.iter().any(|(name, _)| name.is_some()) {
                    self.needs_scl(value.span, "the names of components in an initial value");
                }
                let list: Vec<String> = fields
                    .iter()
                    .map(|(name, value)| match (name, &value.kind) {
                        (Some(name), _) => {
                            format!("{} := {}", self.declared(&name.text, name.span), self.initial(value))
                        }
                        (None, InitialKind::List(values)) => format!("[{}]", self.initials(values)),
                        (None, _) => self.initial(value),
                    })
                    .collect();
                format!("({})", list.join(", "))
            }
            InitialKind::Operand(kind) => operand::text(kind, value.span, self),
            InitialKind::Default => String::new(),
        }
    }

    fn no_elements(&mut self, span: Span) -> String {
        let title = "a declaration has no start values of single elements of this array";
        self.refuse(span, title, "give all elements before them a value as well");
        String::new()
    }

    fn initials(&mut self, values: &[InitialValue]) -> String {
        let list: Vec<String> = values.iter().map(|value| self.initial(value)).collect();
        list.join(", ")
    }
}

/// Whether single elements of arrays have values in it.
fn has_elements(value: &InitialValue) -> bool {
    match &value.kind {
        InitialKind::Elements(_) => true,
        InitialKind::Fields(fields) => fields.iter().any(|(_, value)| has_elements(value)),
        InitialKind::List(values) | InitialKind::Repeat { values, .. } => values.iter().any(has_elements),
        InitialKind::Literal(_) | InitialKind::Expr(_) | InitialKind::Operand(_) | InitialKind::Default => false,
    }
}

/// No array has more start values than this.
const VALUES_MAX: usize = 100_000;

/// The values of elements in the order of the array, up to the last one; `None`: they have no such order.
fn places<'v>(
    elements: &'v [(Vec<i64>, InitialValue)],
    bounds: &[(Bound, Bound)],
) -> Option<Vec<Option<&'v InitialValue>>> {
    let mut found: Vec<Option<&InitialValue>> = Vec::new();
    for (index, value) in elements {
        if index.len() != bounds.len() {
            return None;
        }
        let mut at: usize = 0;
        for (index, bounds) in index.iter().zip(bounds) {
            let (Bound::Number(low, _), Bound::Number(high, _)) = bounds else { return None };
            if index < low || index > high {
                return None;
            }
            let size = usize::try_from(high.checked_sub(*low)?).ok()?.checked_add(1)?;
            at = at.checked_mul(size)?.checked_add(usize::try_from(index.checked_sub(*low)?).ok()?)?;
        }
        if at >= VALUES_MAX {
            return None;
        }
        if found.len() <= at {
            found.resize(at + 1, None);
        }
        found[at] = Some(value);
    }
    Some(found)
}

/// The value that an element without a start value has.
fn default_text(ty: &TypeRef, is_stl: bool) -> Option<&'static str> {
    match &ty.kind {
        TypeKind::String(_) => Some("''"),
        TypeKind::WideString(_) if !is_stl => Some("WSTRING#''"),
        TypeKind::Block(_) | TypeKind::Struct(_) if !is_stl => Some("()"),
        TypeKind::Named(word) => match elementary(word)? {
            Elementary::Bool => Some("FALSE"),
            Elementary::Byte if is_stl => Some("B#16#0"),
            Elementary::Word if is_stl => Some("W#16#0"),
            Elementary::Dword if is_stl => Some("DW#16#0"),
            Elementary::Dint if is_stl => Some("L#0"),
            Elementary::Real | Elementary::Lreal => Some("0.0"),
            Elementary::Time => Some("T#0ms"),
            Elementary::Byte | Elementary::Word | Elementary::Dword | Elementary::Lword => Some("16#0"),
            ty if ty.is_integer() => Some("0"),
            _ => None,
        },
        _ => None,
    }
}
