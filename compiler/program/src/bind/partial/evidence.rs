//! What the uses of undefined names show about them.

use std::collections::BTreeMap;

use plcc_diag::{FileId, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::CellKind;
use rustc_hash::FxHashSet;

use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::types::{DataType, ParameterType};
use plcc_stdlib::BlockClass;

/// Which names and components get a declaration. What is not declared still learns its type from its uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Guess {
    /// Those whose type some use shows.
    Nothing,
    /// Those with the type of an address or constant, too.
    ByConstants,
    /// All.
    Anything,
}

impl Guess {
    pub const ALL: [Guess; 3] = [Guess::Nothing, Guess::ByConstants, Guess::Anything];
}

/// The type that a use needs, the most certain first.
#[derive(Clone, Debug, PartialEq)]
pub enum Hint {
    /// A declared type.
    Type(DataType),
    /// An address: any type of this width.
    Width(Elementary),
    /// A constant without a type, and the type that it has alone.
    Literal(DataType),
    /// A timer or counter.
    Cell(CellKind),
    /// A data block as a whole.
    DataBlock,
}

/// Elements of an array.
#[derive(Clone, Debug)]
pub struct Elements {
    /// Least and greatest index of each dimension that was seen as a constant.
    pub bounds: Vec<(i64, i64)>,
    /// Some index is only known at run time.
    pub open: bool,
    pub shape: Shape,
}

/// A parameter of a call.
#[derive(Clone, Debug)]
pub struct Formal {
    pub name: String,
    pub output: bool,
    pub shape: Shape,
}

/// Calls of a block.
#[derive(Clone, Debug, Default)]
pub struct Interface {
    pub formals: Vec<Formal>,
    /// Its value is used.
    pub result: bool,
    /// What the uses of its value show.
    pub value: Box<Shape>,
    /// It is called with an instance.
    pub instance: bool,
}

/// What the uses of one name show.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    /// Its first spelling.
    pub name: String,
    pub place: Option<Span>,
    /// Where it is used, for the message.
    pub ty: Option<DataType>,
    pub width: Option<Elementary>,
    pub literal: Option<DataType>,
    pub cell: Option<CellKind>,
    /// Components by folded name, in the order of their first use.
    pub members: Vec<(String, Shape)>,
    pub elements: Option<Box<Elements>>,
    /// Number of bytes that absolute addresses in it reach.
    pub extent: u32,
    pub call: Option<Interface>,
    /// A type in a declaration.
    pub is_type: bool,
    /// A data block as a whole: opened, or passed.
    pub is_db: bool,
    /// It is used where only a constant is possible.
    pub is_constant: bool,
    /// The constant is the lower bound of an array.
    pub is_lower: bool,
    /// The block of which this data block is an instance, or its data type: as a whole variable of the program, a call of the data block
    /// alone or a symbol table shows.
    pub of: Option<Missing>,
}

impl Shape {
    /// Adds what one use shows.
    pub fn learn(&mut self, hint: Option<&Hint>) {
        match hint {
            Some(Hint::Type(ty)) => {
                self.of = self.of.take().or_else(|| instance(ty));
                self.ty = Some(joined(self.ty.take(), ty));
            }
            Some(Hint::Width(ty)) => {
                self.width = Some(match self.width {
                    Some(known) if known.bits() >= ty.bits() => known,
                    _ => *ty,
                });
            }
            Some(Hint::Literal(ty)) => self.literal = Some(joined(self.literal.take(), ty)),
            Some(Hint::Cell(kind)) => self.cell = Some(*kind),
            Some(Hint::DataBlock) => self.is_db = true,
            None => {}
        }
    }

    /// The component with this name.
    pub fn member(&mut self, name: &str) -> &mut Shape {
        let folded = fold(name);
        let at = match self.members.iter().position(|(known, _)| *known == folded) {
            Some(at) => at,
            None => {
                self.members.push((folded, Shape { name: name.trim().to_string(), ..Shape::default() }));
                self.members.len() - 1
            }
        };
        &mut self.members[at].1
    }

    /// An element of the array; `indices`: `None` for those that are not constants.
    pub fn element(&mut self, indices: &[Option<i64>]) -> &mut Shape {
        let elements = self
            .elements
            .get_or_insert_with(|| Box::new(Elements { bounds: Vec::new(), open: false, shape: Shape::default() }));
        for (at, index) in indices.iter().enumerate() {
            match index {
                Some(index) => match elements.bounds.get_mut(at) {
                    Some((low, high)) => (*low, *high) = ((*low).min(*index), (*high).max(*index)),
                    None => elements.bounds.push((*index, *index)),
                },
                None => {
                    elements.open = true;
                    if elements.bounds.len() <= at {
                        elements.bounds.push((0, 0));
                    }
                }
            }
        }
        &mut elements.shape
    }

    /// The parameter with this name.
    pub fn formal(&mut self, name: &str, output: bool) -> &mut Shape {
        let formals = &mut self.call.get_or_insert_with(Interface::default).formals;
        let at = match formals.iter().position(|known| fold(&known.name) == fold(name)) {
            Some(at) => at,
            None => {
                formals.push(Formal { name: name.trim().to_string(), output, shape: Shape::default() });
                formals.len() - 1
            }
        };
        formals[at].output |= output;
        &mut formals[at].shape
    }

    /// True if no use shows its type yet.
    fn is_vague(&self) -> bool {
        self.ty.is_none()
            && self.cell.is_none()
            && self.members.is_empty()
            && self.elements.is_none()
            && self.call.is_none()
            && !self.is_type
            && !self.is_db
            && self.extent == 0
            && self.of.is_none()
            && !self.is_constant
    }

    /// Whether it gets a declaration.
    pub fn is_declared(&self, guess: Guess) -> bool {
        match guess {
            Guess::Nothing => !self.is_vague(),
            Guess::ByConstants => !self.is_vague() || self.width.is_some() || self.literal.is_some(),
            Guess::Anything => true,
        }
    }

    /// Without the components and elements that get no declaration.
    pub fn declared(&self, guess: Guess) -> Shape {
        let mut shape = self.clone();
        if guess < Guess::Anything {
            shape.prune(guess);
        }
        shape
    }

    fn prune(&mut self, guess: Guess) {
        self.members.iter_mut().for_each(|(_, member)| member.prune(guess));
        self.members.retain(|(_, member)| member.is_declared(guess));
        if let Some(elements) = &mut self.elements {
            elements.shape.prune(guess);
            if !elements.shape.is_declared(guess) {
                self.elements = None;
            }
        }
    }

    /// Number of facts in it, to see whether a round found new ones.
    pub fn weight(&self) -> usize {
        let own = self.ty.as_ref().map_or(0, |ty| 1 + components(ty))
            + usize::from(self.width.is_some())
            + usize::from(self.literal.is_some())
            + usize::from(self.cell.is_some())
            + usize::from(self.is_type)
            + usize::from(self.is_db)
            + usize::from(self.is_constant)
            + usize::from(self.is_lower)
            + usize::from(self.of.is_some())
            + self.extent as usize;
        let members: usize = self.members.iter().map(|(_, shape)| 1 + shape.weight()).sum();
        let elements = self.elements.as_ref().map_or(0, |elements| {
            let bounds: usize = elements.bounds.iter().map(|(low, high)| (high - low).unsigned_abs() as usize).sum();
            1 + elements.bounds.len() + bounds + usize::from(elements.open) + elements.shape.weight()
        });
        let call = self.call.as_ref().map_or(0, |call| {
            let formals: usize = call.formals.iter().map(|formal| 1 + formal.shape.weight()).sum();
            1 + formals + usize::from(call.result) + usize::from(call.instance) + call.value.weight()
        });
        own + members + elements + call
    }
}

/// The block of the library whose instance a type is, such as an axis. Only its name is known to sources.
fn instance(ty: &DataType) -> Option<Missing> {
    let DataType::Struct(structure) = ty else { return None };
    let (is_system, number) = structure.instance_of?;
    let block = plcc_stdlib::find(BlockClass::Sfb, number)?;
    (is_system && block.is_tia()).then(|| Missing::name(block.name))
}

/// One type for two uses: the wider one of numbers, otherwise the first.
fn joined(known: Option<DataType>, other: &DataType) -> DataType {
    match (known, other) {
        (None, other) => other.clone(),
        (Some(DataType::Elementary(known)), DataType::Elementary(other)) => {
            let number = |ty: Elementary| ty.is_integer() || ty.is_float();
            let rank = |ty: Elementary| (ty.is_float(), ty.bits());
            let wider = number(known) && number(*other) && rank(*other) > rank(known);
            DataType::Elementary(if wider { *other } else { known })
        }
        (Some(known), other) if is_newer(&known, other) => other.clone(),
        // NULL goes to a VARIANT only, which takes everything else as well.
        (_, variant @ DataType::Parameter(ParameterType::Variant)) => variant.clone(),
        (Some(known), _) => known,
    }
}

/// Whether a type is a structure with a name.
pub fn is_named(ty: &DataType) -> bool {
    matches!(ty, DataType::Struct(structure) if !structure.name.is_empty())
}

/// Whether a type is a structure without a name, or an array of them: what stands in for a missing one has the components that are
/// known by now.
pub fn is_unnamed(ty: &DataType) -> bool {
    match ty {
        DataType::Struct(structure) => {
            structure.name.is_empty() && structure.instance_of.is_none() && structure.refers_to.is_none()
        }
        DataType::Array(array) => is_unnamed(&array.element),
        _ => false,
    }
}

/// Limit of the components of a structure without a name: it may contain itself.
const COMPONENTS_MAX: usize = 2000;

/// Whether a type is a later state of a structure: the components of a missing one become known one after the other.
fn is_newer(before: &DataType, after: &DataType) -> bool {
    match (before, after) {
        (DataType::Struct(before), DataType::Struct(after)) if !before.name.is_empty() => before.name == after.name,
        _ if !is_unnamed(before) => false,
        _ if is_unnamed(after) => (components(before)..COMPONENTS_MAX).contains(&components(after)),
        _ => is_named(after),
    }
}

/// Number of components of a structure without a name, at most [`COMPONENTS_MAX`].
fn components(ty: &DataType) -> usize {
    fn count(ty: &DataType, left: &mut usize) {
        match ty {
            DataType::Struct(structure) if is_unnamed(ty) => {
                for member in &structure.members {
                    if *left == 0 {
                        return;
                    }
                    *left -= 1;
                    count(&member.ty, left);
                }
            }
            DataType::Array(array) => count(&array.element, left),
            _ => {}
        }
    }
    let mut left = COMPONENTS_MAX;
    count(ty, &mut left);
    COMPONENTS_MAX - left
}

/// Everything that is missing, with what its uses show.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    pub things: BTreeMap<Missing, Shape>,
    /// Components that data blocks of the sources do not have, by the position of the data block's name.
    pub added: BTreeMap<(FileId, u32), Shape>,
    /// Timers and counters that the program names by number.
    pub cells: FxHashSet<(CellKind, u32)>,
}

impl Evidence {
    /// The missing name `missing`, written `name`, used at `span`.
    pub fn of(&mut self, missing: Missing, name: &str, span: Span) -> &mut Shape {
        let shape = self.things.entry(missing).or_default();
        if shape.name.is_empty() {
            shape.name = name.trim().to_string();
        }
        let before = shape.place.is_none_or(|known| (span.file, span.start) < (known.file, known.start));
        if before {
            shape.place = Some(span);
        }
        shape
    }

    /// The missing parts of the data block whose name is at `place`.
    pub fn added(&mut self, place: Span, name: &str) -> &mut Shape {
        let shape = self.added.entry((place.file, place.start)).or_default();
        if shape.name.is_empty() {
            shape.name = name.trim().to_string();
            shape.place = Some(place);
        }
        shape
    }

    /// As [`Shape::weight`], for all.
    pub fn weight(&self) -> usize {
        self.things.values().chain(self.added.values()).map(|shape| 1 + shape.weight()).sum()
    }
}
