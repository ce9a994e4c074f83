//! Data types of declarations, with the values that variables of them start with.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, Bound, SectionKind, TypeKind, TypeRef};
use rustc_hash::FxHashMap;

use super::names::{elementary, fold};
use super::path::Base;
use super::{Binder, State};
use crate::layout::{self, BYTES_MAX, Placer};
use crate::model::{BlockKey, Interface};
use crate::types::{ArrayType, DataType, Elementary, Member, ParameterType, StructType};

/// Types inside types, at most; STEP 7 allows 8 structures.
const DEPTH_MAX: u32 = 64;

/// A type with the bytes that a variable of it starts with; a BOOL is one byte, 0 or 1.
#[derive(Clone, Debug)]
pub struct Typed {
    pub ty: DataType,
    pub image: Rc<[u8]>,
}

/// A structure with the bytes it starts with.
#[derive(Clone, Debug)]
pub struct TypedStruct {
    pub ty: Rc<StructType>,
    pub image: Rc<[u8]>,
}

/// A variable that the code of a block can name.
#[derive(Clone, Debug)]
pub struct Local {
    pub name: String,
    pub ty: DataType,
    pub base: Base,
    pub byte: u32,
    pub bit: u8,
}

/// The declarations of a block.
#[derive(Debug, Default)]
pub struct BoundInterface {
    pub interface: Interface,
    /// FB, SFB: the instance as a type.
    pub instance: Option<TypedStruct>,
    /// Folded names.
    pub locals: FxHashMap<String, Local>,
    /// `VAR CONSTANT` and CONST.
    pub constants: super::constant::Constants,
    pub temp_bytes: u32,
}

/// Where a type is used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// A component of a structure, a UDT or a DB.
    Component,
    Parameter(SectionKind),
    Static,
    Temp,
    Result,
}

impl<'a> Binder<'a> {
    /// Finds out a type; `None` if it is not known, which is reported.
    pub fn resolve_type(&mut self, ty: &TypeRef, used: Use) -> Option<Typed> {
        if self.depth >= DEPTH_MAX {
            self.report.push(
                Diagnostic::new(Code::LayoutTooLarge, ty.span, "types are nested too deep")
                    .label(format!("more than {DEPTH_MAX} types inside each other"))
                    .help("STEP 7 allows 8 structures inside each other"),
            );
            return None;
        }
        self.depth += 1;
        let result = self.resolve_type_inner(ty, used);
        self.depth -= 1;
        result
    }

    fn resolve_type_inner(&mut self, ty: &TypeRef, used: Use) -> Option<Typed> {
        match &ty.kind {
            TypeKind::Named(word) => self.named_type(word, ty.span, used),
            TypeKind::String(None) => Some(string(254)),
            TypeKind::String(Some(bound)) => match self.bound(bound)? {
                length @ 0..=254 => Some(string(length as u8)),
                _ => {
                    self.report.push(
                        Diagnostic::new(Code::DeclarationSyntax, ty.span, "a STRING holds up to 254 characters")
                            .label("this length is not possible"),
                    );
                    None
                }
            },
            TypeKind::Array { bounds, element } => self.array_type(bounds, element, ty.span),
            TypeKind::Struct(variables) => {
                let typed = self.structure(String::new(), variables, ty.span)?;
                Some(Typed { ty: DataType::Struct(typed.ty), image: typed.image })
            }
            TypeKind::Block(name) => self.block_type(name, used),
            TypeKind::WideString(_) | TypeKind::OpenArray { .. } | TypeKind::Reference(_) => {
                self.report.push(
                    Diagnostic::new(Code::DeclarationSyntax, ty.span, "this type is not supported")
                        .label("not possible here"),
                );
                None
            }
        }
    }

    fn named_type(&mut self, word: &str, span: Span, used: Use) -> Option<Typed> {
        if let Some(ty) = elementary(word) {
            return Some(elementary_typed(ty));
        }
        let parameter = match word {
            "DATE_AND_TIME" | "DT" => {
                return Some(Typed { ty: DataType::DateAndTime, image: Rc::from(super::value::DT_DEFAULT) });
            }
            "STRING" => return Some(string(254)),
            "TIMER" => ParameterType::Timer,
            "COUNTER" => ParameterType::Counter,
            "BLOCK_FB" => ParameterType::BlockFb,
            "BLOCK_FC" => ParameterType::BlockFc,
            "BLOCK_DB" => ParameterType::BlockDb,
            "BLOCK_SDB" => ParameterType::BlockSdb,
            "POINTER" => ParameterType::Pointer,
            "ANY" => ParameterType::Any,
            _ => return self.block_type(&BlockName::Symbol { name: word.to_string(), span }, used),
        };
        let allowed = match used {
            Use::Parameter(SectionKind::Input) => true,
            Use::Parameter(SectionKind::Output | SectionKind::InOut) => {
                matches!(parameter, ParameterType::Pointer | ParameterType::Any)
            }
            Use::Parameter(SectionKind::Static | SectionKind::Temp) => false,
            Use::Temp => parameter == ParameterType::Any,
            Use::Component | Use::Static | Use::Result => false,
        };
        if !allowed {
            self.report.push(
                Diagnostic::new(Code::SectionNotAllowed, span, format!("{word} is a type for parameters"))
                    .label("not possible in this declaration")
                    .help("declare it in VAR_INPUT; POINTER and ANY also in VAR_IN_OUT, ANY also in VAR_TEMP"),
            );
            return None;
        }
        let image = vec![0; layout::parameter_bytes(parameter) as usize];
        Some(Typed { ty: DataType::Parameter(parameter), image: Rc::from(image) })
    }

    fn array_type(&mut self, bounds: &[(Bound, Bound)], element: &TypeRef, span: Span) -> Option<Typed> {
        let mut limits = Vec::new();
        let mut good = true;
        for (low, high) in bounds {
            let (Some(low), Some(high)) = (self.bound(low), self.bound(high)) else { return None };
            good &= low <= high && (-32_768..=32_767).contains(&low) && (-32_768..=32_767).contains(&high);
            limits.push((low as i32, high as i32));
        }
        if !good || limits.is_empty() || limits.len() > 6 {
            self.report.push(
                Diagnostic::new(Code::DeclarationSyntax, span, "these array bounds are not possible")
                    .label("1 to 6 dimensions, each from a low to a high bound within -32768 to 32767"),
            );
            return None;
        }
        let element = self.resolve_type(element, Use::Component)?;
        let bytes = layout::array_bytes(&limits, &element.ty);
        let count = layout::element_count(&limits);
        if bytes > BYTES_MAX || count > 8 * BYTES_MAX {
            self.too_large(span, "this array", bytes.max(count / 8));
            return None;
        }
        let array = ArrayType { bounds: limits, element: element.ty, bytes: bytes as u32 };
        let mut image = vec![0; bytes as usize];
        if element.image.iter().any(|&byte| byte != 0) {
            for index in 0..layout::element_count(&array.bounds) {
                let (byte, bit) = layout::element_place(&array, index);
                put(&mut image, byte, bit, &array.element, &element.image);
            }
        }
        Some(Typed { ty: DataType::Array(Rc::new(array)), image: Rc::from(image) })
    }

    pub fn too_large(&mut self, span: Span, what: &str, bytes: u64) {
        self.report.push(
            Diagnostic::new(Code::LayoutTooLarge, span, format!("{what} is too large"))
                .label(format!("it takes {bytes} bytes; {BYTES_MAX} are possible")),
        );
    }

    /// A bound or length, which must be a number in STL.
    pub fn bound(&mut self, bound: &Bound) -> Option<i64> {
        match bound {
            Bound::Number(number, _) => Some(*number),
            Bound::Expr(_) => None,
            Bound::Name(name, span) => {
                self.report.push(
                    Diagnostic::new(Code::ConstantRequired, *span, format!("`{name}` is no constant"))
                        .label("a number must stand here")
                        .help("for an index that changes at run time use a pointer, e.g. `L DBW [AR1,P#0.0]`"),
                );
                None
            }
        }
    }

    fn block_type(&mut self, name: &BlockName, used: Use) -> Option<Typed> {
        let span = name.span();
        let (prefix, number) = match name {
            BlockName::Symbol { name, .. } if self.global(name).is_none() => {
                self.report.missing_type(name, span);
                return None;
            }
            _ => self.block_number(name)?,
        };
        match prefix {
            BlockPrefix::Udt => {
                let typed = self.udt(number, span)?;
                Some(Typed { ty: DataType::Struct(typed.ty), image: typed.image })
            }
            BlockPrefix::Fb | BlockPrefix::Sfb => {
                let kind = if prefix == BlockPrefix::Fb { BlockKind::Fb } else { BlockKind::Sfb };
                let key = BlockKey { kind, number };
                if used != Use::Static {
                    self.report.push(
                        Diagnostic::new(
                            Code::SectionNotAllowed,
                            span,
                            format!("an instance of {key} cannot stand here"),
                        )
                        .label("instances are static data of a function block")
                        .help("declare it in VAR of a FUNCTION_BLOCK"),
                    );
                    return None;
                }
                let bound = self.interface(key, span)?;
                if bound.interface.code_version1 {
                    self.report.push(
                        Diagnostic::new(Code::SectionNotAllowed, span, format!("{key} cannot be a multi-instance"))
                            .label("its source says CODE_VERSION1")
                            .help(format!("remove CODE_VERSION1 from {key}, or call it with a DB of its own")),
                    );
                }
                let instance = bound.instance.clone()?;
                Some(Typed { ty: DataType::Struct(instance.ty), image: instance.image })
            }
            _ => {
                self.report.push(
                    Diagnostic::new(Code::UnknownType, span, "this block is no data type")
                        .label("a UDT, or in VAR of a function block an FB or SFB, is wanted"),
                );
                None
            }
        }
    }

    /// The type of UDT `number`.
    pub fn udt(&mut self, number: u16, span: Span) -> Option<TypedStruct> {
        match self.udts.get(&number) {
            Some(State::Done(done)) => return done.clone(),
            Some(State::Running) => {
                self.recursive(&format!("UDT {number}"), span);
                return None;
            }
            None => {}
        }
        let Some(&block) = self.type_blocks.get(&number) else {
            self.report.missing_type(&format!("UDT {number}"), span);
            return None;
        };
        self.udts.insert(number, State::Running);
        let name = match self.block_name(BlockPrefix::Udt, number) {
            name if name.is_empty() => format!("UDT {number}"),
            name => name,
        };
        let typed = self.structure(name, &block.members, block.name.span());
        self.udts.insert(number, State::Done(typed.clone()));
        typed
    }

    pub fn recursive(&mut self, name: &str, span: Span) {
        self.report.push(
            Diagnostic::new(Code::RecursiveType, span, format!("{name} contains itself"))
                .label("this component closes the circle")
                .help("a structure can only contain types that do not contain it"),
        );
    }

    /// Lays out the components of a structure. A component of unknown type takes no place.
    pub fn structure(&mut self, name: String, variables: &[ast::Variable], span: Span) -> Option<TypedStruct> {
        let mut builder = StructBuilder::default();
        let mut names = FxHashMap::default();
        for variable in variables {
            self.declare_name(&mut names, variable);
            let typed = self.resolve_type(&variable.ty, Use::Component);
            let typed = self.with_initial(typed, variable);
            builder.add(variable.name.clone(), &typed);
            if builder.too_large() {
                break;
            }
        }
        self.finish_structure(builder, name, None, span)
    }

    pub fn finish_structure(
        &mut self,
        builder: StructBuilder,
        name: String,
        instance_of: Option<(bool, u16)>,
        span: Span,
    ) -> Option<TypedStruct> {
        let bytes = u64::from(builder.placer.clone().size());
        if bytes > BYTES_MAX {
            self.too_large(span, "this structure", bytes);
            return None;
        }
        let mut image = builder.image;
        image.resize(bytes as usize, 0);
        let ty = StructType { name, instance_of, members: builder.members, bytes: bytes as u32 };
        Some(TypedStruct { ty: Rc::new(ty), image: Rc::from(image) })
    }

    pub fn declare_name(&mut self, names: &mut FxHashMap<String, Span>, variable: &ast::Variable) {
        if let Some(first) = names.insert(fold(&variable.name), variable.name_span) {
            self.report.push(
                Diagnostic::new(
                    Code::DuplicateName,
                    variable.name_span,
                    format!("`{}` is declared twice", variable.name),
                )
                .label("the second declaration")
                .also(first, "the first declaration")
                .help("give one of them another name"),
            );
        }
    }

    /// Applies the initial value of a declaration. An unknown type becomes VOID, which stands for it from here on.
    pub fn with_initial(&mut self, typed: Option<Typed>, variable: &ast::Variable) -> Typed {
        let Some(mut typed) = typed else {
            return Typed { ty: DataType::Void, image: Rc::from([]) };
        };
        if let Some(initial) = &variable.initial {
            let mut image = typed.image.to_vec();
            self.encode_initial(initial, &typed.ty, &mut image, 0, 0);
            typed.image = Rc::from(image);
        }
        typed
    }

    pub fn no_initial(&mut self, variable: &ast::Variable, why: &str) {
        if let Some(initial) = &variable.initial {
            self.report.push(
                Diagnostic::new(
                    Code::InitialValue,
                    initial.span,
                    format!("`{}` cannot have an initial value", variable.name),
                )
                .label(why)
                .help("write the value in the code of the block"),
            );
        }
    }
}

/// Components one after the other, with the bytes they start with.
#[derive(Default)]
pub struct StructBuilder {
    pub placer: Placer,
    members: Vec<Member>,
    image: Vec<u8>,
}

impl StructBuilder {
    pub fn add(&mut self, name: String, typed: &Typed) -> (u32, u8) {
        let (byte, bit) = self.placer.place(&typed.ty);
        let end = byte as usize + typed.image.len();
        if end as u64 <= 2 * BYTES_MAX {
            if self.image.len() < end {
                self.image.resize(end, 0);
            }
            put(&mut self.image, byte, bit, &typed.ty, &typed.image);
        }
        self.members.push(Member { name, ty: typed.ty.clone(), byte, bit });
        (byte, bit)
    }

    pub fn too_large(&self) -> bool {
        u64::from(self.placer.clone().size()) > BYTES_MAX
    }
}

/// Writes the bytes of a variable of `ty` at its place.
fn put(image: &mut [u8], byte: u32, bit: u8, ty: &DataType, bytes: &[u8]) {
    let at = byte as usize;
    if *ty == DataType::Elementary(Elementary::Bool) {
        let mask = 1 << bit;
        image[at] = if bytes.first().is_some_and(|&value| value != 0) { image[at] | mask } else { image[at] & !mask };
    } else {
        image[at..at + bytes.len()].copy_from_slice(bytes);
    }
}

/// More than `L` can load.
pub fn is_complex(ty: &DataType) -> bool {
    matches!(ty, DataType::DateAndTime | DataType::String(_) | DataType::Array(_) | DataType::Struct(_))
}

fn string(length: u8) -> Typed {
    let mut image = vec![0; layout::bytes(&DataType::String(length)) as usize];
    image[0] = length;
    Typed { ty: DataType::String(length), image: Rc::from(image) }
}

/// An elementary type starts with 0; CHAR starts with a blank.
fn elementary_typed(ty: Elementary) -> Typed {
    let mut image = vec![0; ty.bits().div_ceil(8) as usize];
    if ty == Elementary::Char {
        image[0] = b' ';
    }
    Typed { ty: DataType::Elementary(ty), image: Rc::from(image) }
}
