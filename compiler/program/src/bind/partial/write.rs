//! Declarations that stand in for missing names, as their uses show.

use plcc_diag::{FileId, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::{
    self, Area, Block, BlockName, BlockPrefix, Bound, CellKind, CodeKind, DataContent, Header, Retain, Section,
    SectionKind, TypeKind, TypeRef, Variable, Width,
};
use plcc_syntax::scl::ast as scl;
use rustc_hash::{FxHashMap, FxHashSet};

use super::evidence::{Evidence, Guess, Interface, Shape};
use super::size;
use super::types::{
    elementary_of, has_components, members, name_of, named, parameter_type, type_of, written_structure,
};
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::layout;
use plcc_model::types::{DataType, StructType};
use plcc_syntax::symbols::{External, GlobalConstant, Symbol, SymbolTable, SymbolTarget};

/// No CPU has bit memory from this address on: missing tags go there.
pub const MEMORY_START: u32 = 32_768;

/// Where the memory of tags ends.
const MEMORY_END: u32 = plcc_abi::layout::AREA_BYTES;

/// Bytes of a data block if no use shows its size.
pub const OPENED_BYTES: u32 = 1024;

/// The value of the first missing constant; each has its own value. Those that are lower bounds of arrays have the values below.
const FIRST_CONSTANT: i64 = 101;

/// Declarations that stand in.
#[derive(Default)]
pub struct StandIns {
    pub blocks: Vec<Block>,
    pub table: SymbolTable,
    /// One line for each missing name, in order of their spans; the text of the file that contains them.
    pub lines: Vec<Line>,
}

/// The stand-in for one missing name.
pub struct Line {
    pub missing: Missing,
    /// `FC 105`, `` `Start` ``.
    pub name: String,
    /// `a stub that does nothing`.
    pub what: String,
}

/// The possible declarations for a missing name.
enum Kind {
    Constant,
    Type,
    Function,
    FunctionBlock,
    DataBlock,
    /// An instance of a block or a data type, or of a block that stands in for it alone.
    Instance,
    Cell(CellKind),
    Tag,
}

/// Addresses that no stand-in has: the next byte of memory, and the numbers below which timers and counters are free.
struct Free {
    byte: u32,
    cells: [u32; 2],
}

/// Writes stand-ins for missing names.
pub struct Writer<'e> {
    pub evidence: &'e Evidence,
    pub file: FileId,
    pub guess: Guess,
    /// Names that cannot have a stand-in.
    pub refused: &'e FxHashSet<Missing>,
    /// Timers and counters of the CPU, and those that the program uses.
    pub cells: [u32; 2],
    pub used_cells: &'e FxHashSet<(CellKind, u32)>,
    /// Interfaces as calls describe them, by folded names.
    pub outlines: &'e FxHashMap<String, &'e ast::CodeBlock>,
}

impl Writer<'_> {
    /// The stand-ins for all names that need one, in the order of the evidence.
    pub fn write(&self) -> StandIns {
        let mut stand_ins = StandIns::default();
        let mut free = Free { byte: MEMORY_START, cells: self.cells };
        for (missing, shape) in &self.evidence.things {
            if self.refused.contains(missing) || !shape.is_declared(self.guess) {
                continue;
            }
            let span = self.span(stand_ins.lines.len());
            let name = name_of(missing, shape, span);
            let outline = match missing {
                Missing::Name(name) => self.outlines.get(name).copied(),
                Missing::Block(..) => None,
            };
            let kind = match outline {
                Some(outline) if outline.kind == CodeKind::Fb => Kind::FunctionBlock,
                Some(_) => Kind::Function,
                None => kind_of(missing, shape),
            };
            let is_fb = matches!(kind, Kind::FunctionBlock);
            let shape = &if is_fb { self.with_instances(missing, shape) } else { shape.declared(self.guess) };
            if matches!(kind, Kind::Tag) && !shape.is_declared(self.guess) {
                continue;
            }
            let what = self.stand_in(kind, shape, (name, outline), span, &mut free, &mut stand_ins);
            let Some(what) = what else { continue };
            let name = match missing.numbered() {
                Some((prefix, number)) => format!("{} {number}", prefix.letters()),
                None => format!("`{}`", shape.name),
            };
            stand_ins.lines.push(Line { missing: missing.clone(), name, what });
        }
        stand_ins
    }

    /// Adds the declaration that stands in for a name; returns what it is. `None`: no number or address is free. `outline`: the interface as
    /// calls describe it.
    fn stand_in(
        &self,
        kind: Kind,
        shape: &Shape,
        (name, outline): (BlockName, Option<&ast::CodeBlock>),
        span: Span,
        free: &mut Free,
        stand_ins: &mut StandIns,
    ) -> Option<String> {
        Some(match kind {
            Kind::Constant => {
                let count = stand_ins.table.constants.len() as i64;
                let value = if shape.is_lower { 1 + count % (FIRST_CONSTANT - 1) } else { FIRST_CONSTANT + count };
                let (constant, text) = constant(shape, value, span);
                stand_ins.table.constants.push(constant);
                format!("a constant of the value {text}")
            }
            Kind::Type => {
                let block = ast::TypeBlock {
                    name,
                    header: Header::default(),
                    members: members(shape, span),
                    alias: (shape.members.is_empty() && shape.elements.is_some()).then(|| type_of(shape, span)),
                    span,
                };
                stand_ins.blocks.push(Block::Type(block));
                format!("a structure of {}", components(shape.members.len()))
            }
            Kind::Function | Kind::FunctionBlock => {
                let fb = matches!(kind, Kind::FunctionBlock);
                let mut block = code_block(name, shape, fb, span);
                let mut what = "a stub that does nothing".to_string();
                if let Some(outline) = outline {
                    described(&mut block, outline);
                    what = "a stub that does nothing, with the interface of its calls".to_string();
                }
                stand_ins.blocks.push(Block::Code(block));
                what
            }
            Kind::Instance => {
                let of = match &shape.of {
                    Some(of) => self.block_name(of, span),
                    None => {
                        // Called by its own name, and with components: the function block is not known at all.
                        let text = format!("{} (function block)", shape.name);
                        let name = BlockName::Symbol { name: text, span };
                        stand_ins.blocks.push(Block::Code(code_block(name.clone(), shape, true, span)));
                        name
                    }
                };
                let ty = TypeRef { kind: TypeKind::Block(of), span };
                stand_ins.blocks.push(data_block(name, DataContent::OfType(ty), span));
                match shape.of.as_ref().and_then(Missing::numbered) {
                    Some((BlockPrefix::Udt, number)) => format!("a data block of type UDT {number}"),
                    _ => "an instance data block".to_string(),
                }
            }
            Kind::DataBlock => {
                let (content, what) = content(shape, span);
                stand_ins.blocks.push(data_block(name, content, span));
                what
            }
            Kind::Cell(kind) => {
                let (at, word) = if kind == CellKind::Timer { (0, "timer") } else { (1, "counter") };
                let is_free = |number: &u32| !self.used_cells.contains(&(kind, *number));
                let number = (0..free.cells[at]).rev().find(is_free)?;
                free.cells[at] = number;
                let target = SymbolTarget::Cell { kind, number };
                stand_ins.table.symbols.push(symbol(&shape.name, target, word.to_ascii_uppercase(), span));
                let letter = if kind == CellKind::Timer { "T" } else { "C" };
                format!("a substitute {word} ({letter} {number})")
            }
            Kind::Tag => self.tag(shape, span, &mut free.byte, stand_ins)?,
        })
    }

    /// A function block, with the components that are used of its instance data blocks, too.
    fn with_instances(&self, missing: &Missing, shape: &Shape) -> Shape {
        let mut whole = shape.declared(self.guess);
        for instance in self.evidence.things.values().filter(|other| other.of.as_ref() == Some(missing)) {
            for (name, member) in instance.declared(self.guess).members {
                if !whole.members.iter().any(|(known, _)| *known == name) {
                    whole.members.push((name, member));
                }
            }
        }
        whole
    }

    /// The line of the file that describes stand-in `at`, as an offset in characters.
    fn span(&self, at: usize) -> Span {
        Span { file: self.file, start: at as u32, end: at as u32 }
    }

    fn block_name(&self, missing: &Missing, span: Span) -> BlockName {
        match self.evidence.things.get(missing) {
            Some(shape) => name_of(missing, shape, span),
            None => name_of(missing, &Shape::default(), span),
        }
    }

    /// A tag: separate bit memory, beyond that of the CPU.
    fn tag(&self, shape: &Shape, span: Span, byte: &mut u32, stand_ins: &mut StandIns) -> Option<String> {
        let elementary = match (&shape.elements, elementary_of(shape)) {
            (None, Some(ty)) => Some(ty),
            (None, None)
                if shape.ty.is_none()
                    && !matches!(shape.literal, Some(DataType::String(_) | DataType::WideString(_))) =>
            {
                Some(Elementary::Int)
            }
            _ => None,
        };
        let at = byte.next_multiple_of(2);
        let (target, ty, bytes, what) = match elementary {
            Some(ty) => {
                let width = layout::width(ty);
                let target = SymbolTarget::Memory { area: Area::M, width, byte: at, bit: 0 };
                (target, ty.name().to_string(), width.bytes(), format!("a substitute variable of type {}", ty.name()))
            }
            None => {
                // A tag has the type that its table names: one that is only an alias.
                let alias = format!("{} (type)", shape.name);
                let ty = type_of(shape, span);
                let bytes = match &shape.ty {
                    Some(ty) => layout::bytes(ty),
                    None => size::bytes(shape).min(u64::from(MEMORY_END)) as u32,
                };
                stand_ins.blocks.push(Block::Type(ast::TypeBlock {
                    name: BlockName::Symbol { name: alias.clone(), span },
                    header: Header::default(),
                    members: Vec::new(),
                    alias: Some(ty),
                    span,
                }));
                let target = SymbolTarget::Memory { area: Area::M, width: Width::Byte, byte: at, bit: 0 };
                (target, alias, bytes, "a substitute variable".to_string())
            }
        };
        if at + bytes > MEMORY_END {
            return None;
        }
        *byte = at + bytes;
        stand_ins.table.symbols.push(symbol(&shape.name, target, ty, span));
        Some(what)
    }
}

fn kind_of(missing: &Missing, shape: &Shape) -> Kind {
    if let Some((prefix, _)) = missing.numbered() {
        return match prefix {
            BlockPrefix::Udt => Kind::Type,
            BlockPrefix::Fc | BlockPrefix::Sfc => Kind::Function,
            BlockPrefix::Fb | BlockPrefix::Sfb => Kind::FunctionBlock,
            _ if shape.of.is_some() => Kind::Instance,
            _ => Kind::DataBlock,
        };
    }
    match &shape.call {
        _ if shape.is_constant => Kind::Constant,
        Some(_) if shape.is_type => Kind::FunctionBlock,
        None if shape.is_type => Kind::Type,
        _ if shape.of.is_some() => Kind::Instance,
        Some(call) if call.instance => Kind::FunctionBlock,
        Some(call) if !call.result && (!shape.members.is_empty() || shape.is_db) => Kind::Instance,
        Some(_) => Kind::Function,
        None => match shape.cell {
            Some(kind) => Kind::Cell(kind),
            // A tag can have a data type as well.
            None if has_components(shape) && !shape.is_db && shape.extent == 0 => Kind::Tag,
            None if !shape.members.is_empty() || shape.is_db || shape.extent > 0 => Kind::DataBlock,
            None => Kind::Tag,
        },
    }
}

fn components(count: usize) -> String {
    match count {
        0 => "a word, since no component is used".to_string(),
        1 => "the one component that is used".to_string(),
        count => format!("the {count} components that are used"),
    }
}

fn symbol(name: &str, target: SymbolTarget, ty: String, span: Span) -> Symbol {
    Symbol { name: name.to_string(), target, ty, comment: String::new(), external: External::default(), span }
}

fn data_block(name: BlockName, content: DataContent, span: Span) -> Block {
    Block::Data(ast::DataBlock {
        name,
        header: Header::default(),
        content,
        values: Vec::new(),
        retained: Vec::new(),
        span,
    })
}

/// The data type of the program that all uses of a name as a whole and of its components fit.
fn data_type(shape: &Shape) -> Option<&StructType> {
    match &shape.ty {
        Some(DataType::Struct(structure))
            if !structure.name.is_empty()
                && structure.instance_of.is_none()
                && structure.refers_to.is_none()
                && (shape.members.is_empty() || has_components(shape))
                && shape.extent <= structure.bytes =>
        {
            Some(structure)
        }
        _ => None,
    }
}

fn content(shape: &Shape, span: Span) -> (DataContent, String) {
    if let Some(structure) = data_type(shape) {
        let what = format!("a data block of type {}", structure.name);
        return (DataContent::OfType(written_structure(structure, span)), what);
    }
    if let (Some(elements), true) = (&shape.elements, shape.members.is_empty()) {
        let _ = elements;
        return (DataContent::Array(type_of(shape, span), None), "a substitute array".to_string());
    }
    let mut list = if shape.members.is_empty() { Vec::new() } else { members(shape, span) };
    let bytes = match (shape.extent, list.is_empty()) {
        (0, true) => OPENED_BYTES,
        (extent, _) => extent.min(65_000),
    };
    let what = match (list.len(), bytes) {
        (0, bytes) => format!("a substitute of {bytes} bytes"),
        (count, _) => format!("a data block with {}", components(count)),
    };
    if bytes > 0 {
        let bounds = vec![(Bound::Number(0, span), Bound::Number(i64::from(bytes) - 1, span))];
        let kind = TypeKind::Array { bounds, element: Box::new(named("BYTE", span)) };
        list.push(Variable::new("ADDRESSED", TypeRef { kind, span }, span));
    }
    (DataContent::Struct(list), what)
}

fn code_block(name: BlockName, shape: &Shape, fb: bool, span: Span) -> ast::CodeBlock {
    let none = Interface::default();
    let call = shape.call.as_ref().unwrap_or(&none);
    let mut sections = Vec::new();
    let mut section = |kind, variables: Vec<Variable>| {
        if !variables.is_empty() {
            sections.push(Section { kind, retain: Retain::Unsaid, variables, span });
        }
    };
    let formals = |output: bool| {
        call.formals
            .iter()
            .filter(|formal| formal.output == output)
            .map(|formal| {
                let member = shape.members.iter().find(|(name, _)| fb && *name == fold(&formal.name));
                let whole = member.map_or_else(|| formal.shape.clone(), |(_, member)| joined(&formal.shape, member));
                Variable::new(&formal.name, parameter_type(&whole, output, fb, span), span)
            })
            .collect()
    };
    section(SectionKind::Input, formals(false));
    section(SectionKind::Output, formals(true));
    if fb {
        let is_formal = |name: &str| call.formals.iter().any(|formal| fold(&formal.name) == *name);
        let others = shape.members.iter().filter(|(name, _)| !is_formal(name));
        section(
            SectionKind::Static,
            others.map(|(_, member)| Variable::new(&member.name, type_of(member, span), span)).collect(),
        );
    }
    ast::CodeBlock {
        kind: match (&name, fb) {
            (BlockName::Numbered { prefix: BlockPrefix::Sfc, .. }, _) => CodeKind::Sfc,
            (BlockName::Numbered { prefix: BlockPrefix::Sfb, .. }, _) => CodeKind::Sfb,
            (_, true) => CodeKind::Fb,
            (_, false) => CodeKind::Fc,
        },
        name,
        return_type: (call.result && !fb).then(|| type_of(&call.value, span)),
        header: Header::default(),
        sections,
        constants: Vec::new(),
        code: ast::Code::Scl(scl::Body::default()),
        span,
    }
}

/// What calls show about a parameter, together with what uses of that component of an instance show.
fn joined(formal: &Shape, member: &Shape) -> Shape {
    let mut whole = formal.clone();
    let fits = |ty: &DataType| match (formal.width, ty) {
        (Some(width), DataType::Elementary(ty)) => width.bits() == ty.bits(),
        (Some(_), _) => false,
        (None, _) => true,
    };
    if whole.ty.is_none() {
        whole.ty = member.ty.clone().filter(fits);
    }
    whole.literal = whole.literal.or_else(|| member.literal.clone());
    whole.width = whole.width.or(member.width);
    if whole.width.is_none() && whole.members.is_empty() && whole.elements.is_none() {
        whole.members.clone_from(&member.members);
        whole.elements.clone_from(&member.elements);
    }
    whole
}

/// Gives a stub the parameters that its calls describe. Other data that the program uses stays.
fn described(block: &mut ast::CodeBlock, outline: &ast::CodeBlock) {
    let known: FxHashSet<String> =
        outline.sections.iter().flat_map(|section| &section.variables).map(|variable| fold(&variable.name)).collect();
    let mut others: Vec<Section> =
        block.sections.drain(..).filter(|section| section.kind == SectionKind::Static).collect();
    others.iter_mut().for_each(|section| section.variables.retain(|variable| !known.contains(&fold(&variable.name))));
    others.retain(|section| !section.variables.is_empty());
    block.sections = outline.sections.iter().cloned().chain(others).collect();
    block.return_type.clone_from(&outline.return_type);
}

/// A constant with its own value, in the type that its uses need.
fn constant(shape: &Shape, value: i64, span: Span) -> (GlobalConstant, String) {
    let ty = match &shape.ty {
        Some(DataType::Elementary(ty)) => Some(*ty),
        _ => None,
    };
    let (literal, text) = match ty {
        Some(Elementary::Bool) => (scl::Literal::Typed { ty: Elementary::Bool, bits: 0 }, "FALSE".to_string()),
        Some(ty) if ty.is_float() => (scl::Literal::Real(value as f64), format!("{value}.0")),
        Some(ty) if !ty.is_integer() && !matches!(ty, Elementary::Byte | Elementary::Word | Elementary::Dword) => {
            (scl::Literal::Typed { ty, bits: value as u64 }, format!("{value} as {}", ty.name()))
        }
        _ => (scl::Literal::Integer { value: value as u64, based: false }, value.to_string()),
    };
    let value = scl::Expr { kind: scl::ExprKind::Literal(literal), span };
    (GlobalConstant { name: shape.name.clone(), ty: String::new(), value, span }, text)
}
