//! Declarations of blocks: types, and the addresses of parameters and variables in local memory.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_abi::s7200::LOCAL_BYTES;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{self, Area, Direct, Section};
use rustc_hash::{FxHashMap, FxHashSet};

use super::Binder;
use super::names::fold;
use plcc_binding::report::known_type;
use plcc_binding::similar;
use plcc_model::s7200::{Direction, Parameter};
use plcc_model::types::Elementary;

/// Limit of parameters of a subroutine.
const PARAMETERS_MAX: usize = 16;

/// Data types of local variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    Bool,
    /// BYTE, CHAR.
    Byte,
    Word,
    Int,
    Dword,
    Dint,
    Real,
    /// The pointer to a string.
    String,
}

const TYPES: &[(&str, Type)] = &[
    ("BOOL", Type::Bool),
    ("BYTE", Type::Byte),
    ("CHAR", Type::Byte),
    ("WORD", Type::Word),
    ("INT", Type::Int),
    ("DWORD", Type::Dword),
    ("DINT", Type::Dint),
    ("REAL", Type::Real),
    ("STRING", Type::String),
];

impl Type {
    pub fn width(self) -> Width {
        match self {
            Type::Bool => Width::Bit,
            Type::Byte => Width::Byte,
            Type::Word | Type::Int => Width::Word,
            Type::Dword | Type::Dint | Type::Real | Type::String => Width::Dword,
        }
    }

    fn elementary(self) -> Elementary {
        match self {
            Type::Bool => Elementary::Bool,
            Type::Byte => Elementary::Byte,
            Type::Word => Elementary::Word,
            Type::Int => Elementary::Int,
            Type::Dword | Type::String => Elementary::Dword,
            Type::Dint => Elementary::Dint,
            Type::Real => Elementary::Real,
        }
    }
}

/// A local variable with its address.
pub struct Local {
    pub name: String,
    pub section: Section,
    pub ty: Type,
    pub place: Direct,
}

/// The local variables of a block.
#[derive(Default)]
pub struct Locals {
    /// In order of their addresses: IN, IN_OUT, OUT, temporary ones.
    pub list: Vec<Local>,
    index: FxHashMap<String, usize>,
    /// Names whose declarations were reported.
    unknown: FxHashSet<String>,
}

impl Locals {
    pub fn find(&self, name: &str) -> Option<&Local> {
        self.list.get(*self.index.get(&fold(name))?)
    }

    /// Whether the declaration of the name was reported.
    pub fn is_unknown(&self, name: &str) -> bool {
        self.unknown.contains(&fold(name))
    }

    /// Whether a declaration was reported.
    pub fn has_unknown(&self) -> bool {
        !self.unknown.is_empty()
    }

    /// The parameters, in the order of a call.
    pub fn parameters(&self) -> impl Iterator<Item = &Local> {
        self.list.iter().filter(|local| local.section != Section::Temp)
    }

    /// As in the bound program. A block that gets the pointer to a string writes through it, so it is always an input.
    pub fn formals(&self) -> Vec<Parameter> {
        let formal = |local: &Local| Parameter {
            name: local.name.clone(),
            direction: match (local.section, local.ty) {
                (_, Type::String) | (Section::Input | Section::Temp, _) => Direction::In,
                (Section::InOut, _) => Direction::InOut,
                (Section::Output, _) => Direction::Out,
            },
            width: local.ty.width(),
            ty: local.ty.elementary(),
            byte: local.place.number,
            bit: local.place.bit,
        };
        self.parameters().map(formal).collect()
    }
}

/// Allocates local memory: up to eight BOOLs share a byte, other variables begin with the next whole byte.
#[derive(Default)]
struct Layout {
    byte: u32,
    /// The next bit of `byte`, while BOOLs follow one another.
    bit: u8,
}

impl Layout {
    fn place(&mut self, width: Width) -> Direct {
        if self.bit == 8 || self.bit > 0 && width != Width::Bit {
            (self.byte, self.bit) = (self.byte.saturating_add(1), 0);
        }
        let place = Direct { area: Area::L, width: Some(width), number: self.byte, bit: self.bit };
        match width {
            Width::Bit => self.bit += 1,
            _ => self.byte = self.byte.saturating_add(width.bytes()),
        }
        place
    }

    fn end(&self) -> u32 {
        self.byte.saturating_add(u32::from(self.bit > 0))
    }
}

impl Binder<'_> {
    /// The declarations of all blocks, because calls need them.
    pub fn bind_interfaces(&mut self) {
        for index in 0..self.blocks.len() {
            let Some((ast, kind)) = self.blocks.get(index).map(|block| (block.ast, block.kind)) else { continue };
            let locals = Rc::new(self.locals(ast, kind));
            if let Some(block) = self.blocks.get_mut(index) {
                block.locals = locals;
            }
        }
    }

    fn locals(&mut self, block: &ast::Block, kind: BlockKind) -> Locals {
        let mut locals = Locals::default();
        let mut spans: FxHashMap<String, Span> = FxHashMap::default();
        let mut layout = Layout::default();
        let mut overflow = None;
        for section in [Section::Input, Section::InOut, Section::Output, Section::Temp] {
            for declaration in block.declarations.iter().filter(|declaration| declaration.section == section) {
                let span = declaration.name_span;
                // In a block with a header, the parser has reported it.
                if section != Section::Temp && kind != BlockKind::Sbr && block.is_bare {
                    self.section_not_allowed(kind, span);
                }
                if let Some(initial) = &declaration.initial {
                    self.push(
                        Diagnostic::new(
                            Code::InitialValue,
                            initial.span,
                            "a local variable cannot have an initial value",
                        )
                        .label("local memory is new at each call")
                        .help("write the value with an instruction at the beginning of the block"),
                    );
                }
                if let Some(&first) = spans.get(&fold(&declaration.name)) {
                    let message = format!("`{}` is declared twice", declaration.name);
                    self.push(
                        Diagnostic::new(Code::DuplicateName, span, message)
                            .label("the second one")
                            .also(first, "the first one")
                            .help("give one of them another name"),
                    );
                    continue;
                }
                spans.insert(fold(&declaration.name), span);
                let Some(ty) = self.local_type(declaration) else {
                    locals.unknown.insert(fold(&declaration.name));
                    continue;
                };
                let place = layout.place(ty.width());
                if layout.end() > LOCAL_BYTES {
                    overflow.get_or_insert(span);
                }
                locals.index.insert(fold(&declaration.name), locals.list.len());
                locals.list.push(Local { name: declaration.name.clone(), section, ty, place });
            }
        }
        if let Some(span) = overflow {
            self.push(
                Diagnostic::new(Code::LayoutTooLarge, span, "the local variables need more than 64 bytes (0090)")
                    .label(format!("all of them need {} bytes", layout.end()))
                    .help("keep some of them in V memory"),
            );
        } else if let Some(first) = block.declarations.first().filter(|_| self.input.profile.local_data == 0) {
            let cpu = &self.input.profile.name;
            self.push(
                Diagnostic::new(Code::CpuInstruction, first.name_span, format!("the CPU {cpu} has no local variables"))
                    .label("CPUs have local memory from the 22x on")
                    .help("use V memory, or name a CPU 22x with --cpu"),
            );
        }
        if locals.parameters().count() > PARAMETERS_MAX {
            let span = block.declarations.get(PARAMETERS_MAX).map_or(block.span, |one| one.name_span);
            self.push(
                Diagnostic::new(Code::LayoutTooLarge, span, "a subroutine has at most 16 parameters (0090)")
                    .label(format!("this one has {}", locals.parameters().count()))
                    .help("pass the address of data in V memory instead"),
            );
        }
        locals
    }

    fn section_not_allowed(&mut self, kind: BlockKind, span: Span) {
        let block = if kind == BlockKind::Ob { "the main program" } else { "an interrupt routine" };
        self.push(
            Diagnostic::new(Code::SectionNotAllowed, span, format!("{block} cannot have parameters"))
                .label("nothing calls it with parameters")
                .help("declare it between VAR and END_VAR"),
        );
    }

    fn local_type(&mut self, declaration: &ast::Declaration) -> Option<Type> {
        let known = TYPES.iter().find(|(name, _)| declaration.ty.eq_ignore_ascii_case(name));
        if known.is_none() {
            let names = TYPES.iter().map(|(name, _)| *name);
            let foreign = known_type(&declaration.ty).filter(|ty| TYPES.iter().any(|(name, _)| name == ty));
            let help = match foreign.or_else(|| similar(&declaration.ty, names)) {
                Some(name) => format!("is `{name}` meant?"),
                None if matches!(declaration.ty.as_str(), "TIME" | "S5TIME" | "LTIME") => {
                    "a time is a number: INT for the steps of a timer, DINT for milliseconds".to_string()
                }
                None if declaration.ty == "ARRAY" => {
                    "declare a variable for each element, or use V memory and a pointer such as `*AC1`".to_string()
                }
                None => "the types are BOOL, BYTE, WORD, DWORD, INT, DINT, REAL and STRING".to_string(),
            };
            let title = format!("the S7-200 has no data type `{}`", declaration.ty);
            self.push(Diagnostic::new(Code::UnknownType, declaration.ty_span, title).label("unknown").help(help));
        }
        known.map(|(_, ty)| *ty)
    }
}
