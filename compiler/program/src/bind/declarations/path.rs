//! Names to places: `"sym"`, `#local.x[3]`, `"db".a.b`, `DB10.member`.

use std::rc::Rc;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{Area, BlockPrefix, CellKind, Path, PathPart, PathRoot, Width};

use crate::bind::declarations::Declarations;
use crate::bind::declarations::block::CurrentBlock;
use crate::bind::declarations::unknown_member::no_component;
use crate::bind::globals::names::kind_prefix;
use plcc_binding::report::MissingKey;
use plcc_binding::{fold, similar};
use plcc_model::layout;
use plcc_model::types::{DataType, Elementary, StructType};
use plcc_model::{ElementIndex, Place};
use plcc_syntax::symbols::SymbolTarget;

/// Where a variable is, without its offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    I,
    Q,
    M,
    Pi,
    Pq,
    L,
    OpenDb,
    OpenDi,
    /// A DB by number.
    Db(u16),
    /// The instance of this FB.
    Instance,
    /// A parameter of this FC.
    Parameter(usize),
    /// After the POINTER at this byte of the instance.
    ThroughPointer(u32),
}

impl Base {
    pub const fn of_area(area: Area) -> Base {
        match area {
            Area::I => Base::I,
            Area::Q => Base::Q,
            Area::M => Base::M,
            Area::Pi => Base::Pi,
            Area::Pq => Base::Pq,
            Area::L => Base::L,
            Area::Db => Base::OpenDb,
            Area::Di => Base::OpenDi,
        }
    }

    pub const fn at(self, byte: u32, bit: u8) -> Place {
        match self {
            Base::I => Place::I { byte, bit },
            Base::Q => Place::Q { byte, bit },
            Base::M => Place::M { byte, bit },
            Base::Pi => Place::Pi { byte, bit },
            Base::Pq => Place::Pq { byte, bit },
            Base::L => Place::L { byte, bit },
            Base::OpenDb => Place::OpenDb { byte, bit },
            Base::OpenDi => Place::OpenDi { byte, bit },
            Base::Db(number) => Place::Db { number, byte, bit },
            Base::Instance => Place::Instance { byte, bit },
            Base::Parameter(parameter) => Place::Parameter { parameter, byte, bit },
            Base::ThroughPointer(pointer) => Place::ThroughPointer { pointer, byte, bit },
        }
    }
}

/// A variable with its type.
#[derive(Clone, Debug)]
pub struct Variable {
    pub base: Base,
    pub byte: u32,
    pub bit: u8,
    pub ty: DataType,
    /// The type is only the width of an address, so any type of this width fits.
    pub untyped: bool,
}

impl Variable {
    pub fn place(&self) -> Place {
        self.base.at(self.byte, self.bit)
    }
}

/// The meaning of a path.
#[derive(Clone, Debug)]
pub enum Resolved {
    Variable(Variable),
    Cell { kind: CellKind, number: u32 },
    Block { prefix: BlockPrefix, number: u16 },
}

/// A type of a width, for addresses with no other known type.
pub const fn type_of_width(width: Width) -> Elementary {
    match width {
        Width::Bit => Elementary::Bool,
        Width::Byte => Elementary::Byte,
        Width::Word => Elementary::Word,
        Width::Dword => Elementary::Dword,
        Width::Lword => Elementary::Lword,
    }
}

impl Declarations<'_> {
    /// Determines what `path` means, and the variable indices that move a variable; reports unknown names.
    pub fn resolve(&mut self, ctx: &mut CurrentBlock, path: &Path) -> Option<(Resolved, Vec<ElementIndex>)> {
        let start = match &path.root {
            PathRoot::Local { name, span } => match self.local(ctx, name).or_else(|| self.own_value(ctx, name)) {
                Some(variable) => Resolved::Variable(variable),
                // As STEP 7 does: a `#` before a name that the block does not declare is ignored.
                None if self.globals.names.symbols.contains_key(&fold(name)) => {
                    self.resolve_global(ctx, name, *span)?
                }
                None => {
                    self.undeclared(ctx, name, *span, Code::UnknownSymbol);
                    return None;
                }
            },
            PathRoot::Bare { name, span } => match self.local(ctx, name) {
                Some(variable) => Resolved::Variable(variable),
                None if self.globals.global_at(name, *span).is_none() => {
                    let locals = ctx.bound.locals.values().map(|local| local.name.as_str());
                    self.globals.unknown_operand(name, *span, locals);
                    return None;
                }
                None => self.resolve_global(ctx, name, *span)?,
            },
            PathRoot::Quoted { name, span } => self.resolve_global(ctx, name, *span)?,
            PathRoot::Block(name) => {
                let (prefix, number) = self.globals.block_number(name)?;
                Resolved::Block { prefix, number }
            }
        };
        if path.parts.is_empty() {
            return Some((start, Vec::new()));
        }
        let variable = match start {
            Resolved::Variable(variable) => variable,
            Resolved::Block { prefix: BlockPrefix::Db, number } => {
                let Some(ty) = self.data.db_type(number) else {
                    if !self.globals.sources.data.contains_key(&number)
                        && !self.data.unknown_instances.contains(&number)
                    {
                        self.globals.report.missing_db_layout(number, path.span);
                    }
                    return None;
                };
                Variable { base: Base::Db(number), byte: 0, bit: 0, ty: DataType::Struct(ty), untyped: false }
            }
            Resolved::Block { prefix: BlockPrefix::Udt, .. } => {
                let text = match &path.root {
                    PathRoot::Local { name, .. } | PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } => {
                        name.clone()
                    }
                    PathRoot::Block(name) => self.globals.text(name.span()),
                };
                self.globals.report.missing_beside_type(&text, path.span);
                return None;
            }
            other @ (Resolved::Cell { .. } | Resolved::Block { .. }) => {
                let is_fb = matches!(other, Resolved::Block { prefix: BlockPrefix::Fb | BlockPrefix::Sfb, .. });
                let message =
                    Diagnostic::new(Code::UnknownMember, path.span, "only data blocks and structures have components")
                        .label("this name means something else");
                let text = self.globals.text(path.span);
                self.report(match text.split_once('.') {
                    Some((block, data)) if is_fb => {
                        message.help(format!("a call names the instance after a comma: `CALL {block}, {data}`"))
                    }
                    _ => message,
                });
                return None;
            }
        };
        let (variable, indices) = self.walk_in(Some(ctx), variable, &path.parts)?;
        Some((Resolved::Variable(variable), indices))
    }

    pub fn local(&self, ctx: &CurrentBlock, name: &str) -> Option<Variable> {
        let local = ctx.bound.locals.get(&fold(name))?;
        let (base, byte, bit, ty) = (local.base, local.byte, local.bit, local.ty.clone());
        Some(Variable { base, byte, bit, ty, untyped: false })
    }

    /// The value of the function itself, which the TIA Portal shows under the name of the function: `T #Sum`.
    fn own_value(&self, ctx: &CurrentBlock, name: &str) -> Option<Variable> {
        let prefix = kind_prefix(ctx.key.kind);
        let is_own =
            prefix == BlockPrefix::Fc && fold(&self.globals.names.block_name(prefix, ctx.key.number)) == fold(name);
        if is_own { self.local(ctx, "RET_VAL") } else { None }
    }

    /// `#name` in SCL and networks, where only the block itself can declare it.
    pub fn unknown_local(&mut self, ctx: &mut CurrentBlock, name: &str, span: Span) {
        self.undeclared(ctx, name, span, Code::UnknownLocal);
    }

    /// `code`: in STL a `#` before a symbol is ignored, so an unknown name is also an unknown symbol.
    fn undeclared(&mut self, ctx: &mut CurrentBlock, name: &str, span: Span, code: Code) {
        if !ctx.unknown_locals.insert(fold(name)) || self.is_refused_constant(ctx, name) {
            return;
        }
        let message = || match code {
            Code::UnknownSymbol => {
                let title = format!("`#{name}` is neither declared in this block nor a symbol of the program");
                Diagnostic::new(code, span, title).label("no parameter, no variable and no symbol has this name")
            }
            _ => Diagnostic::new(code, span, format!("`#{name}` is not declared in this block"))
                .label("neither a parameter nor static or temporary data"),
        };
        // Statements without a header are part of a block: its declarations are missing.
        if ctx.fragment {
            let help = "add the header of the block, with its VAR sections, before the statements";
            return self.globals.report.missing(MissingKey::Local(fold(name)), span, || message().help(help));
        }
        let message = message();
        let help = self.meant_by(ctx, name, code);
        self.report(message.help(help));
    }

    /// Whether the block declares a constant of that name, with a type or value that has been reported.
    pub fn is_refused_constant(&self, ctx: &CurrentBlock, name: &str) -> bool {
        let source = self.globals.sources.code.get(&ctx.key);
        let mut constants = source.into_iter().flat_map(|source| &source.block().constants);
        self.globals.is_refused(name) && constants.any(|constant| fold(&constant.name) == fold(name))
    }

    /// What `#name` may mean: something else that the block has under a similar name, or a global name.
    fn meant_by(&self, ctx: &CurrentBlock, name: &str, code: Code) -> String {
        let source = self.globals.sources.code.get(&ctx.key);
        let constants = source.into_iter().flat_map(|source| &source.block().constants);
        let constants = constants.map(|constant| constant.name.as_str());
        let result = ctx.bound.interface.parameters.iter().any(|parameter| parameter.name == "RET_VAL");
        let own = self.globals.names.block_name(kind_prefix(ctx.key.kind), ctx.key.number);
        let own = Some(own.as_str()).filter(|_| result && code == Code::UnknownLocal);
        let locals = ctx.bound.locals.values().map(|local| local.name.as_str());
        if let Some(other) = similar(name, locals.chain(constants).chain(own)) {
            return format!("is `#{other}` meant?");
        }
        let is_function = kind_prefix(ctx.key.kind) == BlockPrefix::Fc;
        let number = fold(name).strip_prefix("fc").and_then(|number| number.parse::<u16>().ok());
        if is_function && result && number == Some(ctx.key.number) {
            return "the value of the function is `#RET_VAL`".to_owned();
        }
        if is_function && !result && fold(name) == "ret_val" {
            return "this function has no value: write its type after its name in place of VOID".to_owned();
        }
        match self.globals.names.symbols.get(&fold(name)) {
            Some(global)
                if kind_prefix(ctx.key.kind) == BlockPrefix::Fc
                    && global.target
                        == (SymbolTarget::Block { prefix: BlockPrefix::Fc, number: u32::from(ctx.key.number) }) =>
            {
                format!("this function has no value: give it a type, as in `FUNCTION \"{}\" : Int`", global.name)
            }
            Some(global)
                if kind_prefix(ctx.key.kind) == BlockPrefix::Fb
                    && global.target
                        == (SymbolTarget::Block { prefix: BlockPrefix::Fb, number: u32::from(ctx.key.number) }) =>
            {
                "a function block has no value: declare it in VAR_OUTPUT".to_owned()
            }
            Some(global) => format!("write `\"{}\"`: `#` is for what the block itself declares", global.name),
            None => {
                constant_meant(name).unwrap_or_else(|| "declare it in one of the VAR sections of the block".to_owned())
            }
        }
    }

    pub fn resolve_global(&mut self, ctx: &mut CurrentBlock, name: &str, span: Span) -> Option<Resolved> {
        let Some(target) = self.globals.global_at(name, span) else {
            let locals = ctx.bound.locals.values().map(|local| local.name.as_str());
            self.globals.unknown_name(name, span, locals);
            return None;
        };
        self.globals.check_system_tag(name, target, span);
        let ty = self.globals.names.symbols.get(&fold(name)).and_then(|global| global.ty);
        Some(match target {
            SymbolTarget::Memory { area, width, byte, bit } => {
                if let Some(variable) = self.stand_in(name, span) {
                    return Some(Resolved::Variable(variable));
                }
                self.check_address(ctx, area, width, byte, span)?;
                if let Some(structure) = self.structure_of_tag(name, span) {
                    let last = byte.saturating_add(structure.bytes.saturating_sub(1));
                    self.check_address(ctx, area, Width::Byte, last, span)?;
                    let ty = DataType::Struct(structure);
                    return Some(Resolved::Variable(Variable {
                        base: Base::of_area(area),
                        byte,
                        bit: 0,
                        ty,
                        untyped: false,
                    }));
                }
                let ty = ty.filter(|ty| layout::width(*ty) == width);
                let untyped = ty.is_none();
                let ty = DataType::Elementary(ty.unwrap_or(type_of_width(width)));
                Resolved::Variable(Variable { base: Base::of_area(area), byte, bit, ty, untyped })
            }
            SymbolTarget::Cell { kind, number } => Resolved::Cell { kind, number },
            SymbolTarget::Block { prefix, number } => Resolved::Block { prefix, number: number as u16 },
        })
    }

    /// A tag that stands in for a missing one: of any type, in memory that the CPU does not have.
    pub fn stand_in(&mut self, name: &str, span: Span) -> Option<Variable> {
        let global = self
            .globals
            .names
            .symbols
            .get(&fold(name))
            .filter(|global| Some(global.span.file) == self.globals.input.stand_ins)?;
        let SymbolTarget::Memory { area, byte, bit, .. } = global.target else { return None };
        let ty = match (global.ty, global.structure.clone()) {
            (Some(ty), _) => DataType::Elementary(ty),
            (None, Some(alias)) => {
                let SymbolTarget::Block { prefix: BlockPrefix::Udt, number } =
                    self.globals.names.symbols.get(&fold(&alias))?.target
                else {
                    return None;
                };
                self.udt(u16::try_from(number).ok()?, span)?.ty
            }
            (None, None) => return None,
        };
        Some(Variable { base: Base::of_area(area), byte, bit, ty, untyped: false })
    }

    /// The structure of a tag whose type in the tag table is one of the program.
    fn structure_of_tag(&mut self, name: &str, span: Span) -> Option<Rc<StructType>> {
        let ty = self.globals.names.symbols.get(&fold(name))?.structure.clone()?;
        let (BlockPrefix::Udt, number) = self.type_block(&ty)? else { return None };
        match self.udt(number, span)?.ty {
            DataType::Struct(structure) => Some(structure),
            _ => None,
        }
    }

    /// Follows components and constant indices. A component of unknown type ends it silently: its type is reported.
    pub fn walk(&mut self, variable: Variable, parts: &[PathPart]) -> Option<Variable> {
        self.walk_in(None, variable, parts).map(|(variable, _)| variable)
    }

    /// The same, also with variable indices in the statements of a block.
    fn walk_in(
        &mut self,
        mut ctx: Option<&mut CurrentBlock>,
        mut variable: Variable,
        parts: &[PathPart],
    ) -> Option<(Variable, Vec<ElementIndex>)> {
        let mut moved = Vec::new();
        for part in parts {
            match (part, &variable.ty) {
                (_, DataType::Void) => return None,
                (PathPart::Member { name, span }, DataType::Struct(structure)) => {
                    let structure = Rc::clone(structure);
                    let Some(member) = self.types.member(&structure, name) else {
                        self.unknown_member(&structure, name, *span);
                        return None;
                    };
                    variable.byte += member.byte;
                    variable.bit = member.bit;
                    variable.ty = member.ty;
                }
                (PathPart::Index { values, span }, DataType::Array(array)) => {
                    let array = Rc::clone(array);
                    let positions = self.positions(ctx.as_deref_mut(), values)?;
                    self.element(&mut variable, &mut moved, &array, positions, *span)?;
                }
                (PathPart::Index { values, span }, DataType::String(length)) => {
                    let length = *length;
                    let positions = self.positions(ctx.as_deref_mut(), values)?;
                    self.character(&mut variable, &mut moved, length, positions, *span)?;
                }
                (PathPart::Member { name, span }, DataType::Elementary(ty)) if name.starts_with('%') => {
                    let Some((byte, bit, part)) = slice(name, *ty) else {
                        self.report(
                            Diagnostic::new(Code::UnknownMember, *span, format!("{} has no part `{name}`", ty.name()))
                                .label(format!("{} bits", ty.bits()))
                                .help("`%X0` is the lowest bit, `%B0` the lowest byte, `%W0` the lowest word"),
                        );
                        return None;
                    };
                    variable.byte += byte;
                    variable.bit = bit;
                    variable.ty = DataType::Elementary(part);
                }
                (PathPart::Member { name, span }, ty) => {
                    self.report(no_component(name, ty, "", *span));
                    return None;
                }
                (PathPart::Index { span, .. }, ty) => {
                    self.report(
                        Diagnostic::new(Code::UnknownMember, *span, "this is not an array")
                            .label(format!("the name before it is of type {}", layout::type_name(ty))),
                    );
                    return None;
                }
            }
        }
        Some((variable, moved))
    }
}

/// The constant that `#00FF` or `#TRUE` may mean.
fn constant_meant(name: &str) -> Option<String> {
    let upper = name.to_ascii_uppercase();
    if matches!(upper.as_str(), "TRUE" | "FALSE") {
        return Some(format!("a constant has no `#`: write `{upper}`"));
    }
    let is_number = name.starts_with(|first: char| first.is_ascii_digit());
    let is_hexadecimal = is_number && name.bytes().all(|digit| digit.is_ascii_hexdigit());
    is_hexadecimal.then(|| format!("a hexadecimal number begins with `16#`: write `16#{upper}`"))
}

/// Where a part such as `%X3` of a value of type `ty` is, byte and bit, and its type; `None`: it has no such part. The lowest byte is the last
/// one in memory.
fn slice(name: &str, ty: Elementary) -> Option<(u32, u8, Elementary)> {
    let number: u32 = name.get(2..)?.parse().ok()?;
    let (bits, part) = match name.as_bytes()[1].to_ascii_uppercase() {
        b'X' => (1, Elementary::Bool),
        b'B' => (8, Elementary::Byte),
        b'W' => (16, Elementary::Word),
        b'D' => (32, Elementary::Dword),
        _ => return None,
    };
    let end = number.checked_add(1)?.checked_mul(bits)?;
    if end > ty.bits() || bits >= ty.bits() {
        return None;
    }
    let bytes = ty.bits() / 8;
    Some(match bits {
        1 => (bytes - 1 - number / 8, (number % 8) as u8, part),
        _ => (bytes - end / 8, 0, part),
    })
}

/// The message for more or fewer indices than an array has dimensions.
pub(crate) fn index_count(given: usize, declared: usize, span: Span) -> Diagnostic {
    let indices = |count: usize| if count == 1 { "1 index".to_owned() } else { format!("{count} indices") };
    let (dimensions, help) = match declared {
        1 => ("dimension", "write 1 index".to_owned()),
        _ => ("dimensions", format!("write {declared} indices, separated by `,`")),
    };
    Diagnostic::new(Code::ArrayIndex, span, "a wrong number of indices")
        .label(format!("{} given, {declared} {dimensions} declared", indices(given)))
        .help(help)
}
