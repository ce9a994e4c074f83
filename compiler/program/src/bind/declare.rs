//! Declarations: data types with their initial values, and the interfaces of blocks.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, Bound, SectionKind, TypeKind, TypeRef};
use rustc_hash::FxHashMap;

use super::names::{elementary, fold};
use super::path::Base;
use super::{Binder, CodeSource, State};
use crate::layout::{self, BYTES_MAX, Placer};
use crate::model::{BlockKey, Direction, Interface, Parameter, Passing};
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
    pub temp_bytes: u32,
}

/// Where a type is used.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    /// A component of a structure, a UDT or a DB.
    Component,
    Parameter(SectionKind),
    Static,
    Temp,
    Result,
}

impl<'a> Binder<'a> {
    /// Finds out a type; `None` if it is not known, which is reported.
    fn resolve_type(&mut self, ty: &TypeRef, used: Use) -> Option<Typed> {
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

    fn too_large(&mut self, span: Span, what: &str, bytes: u64) {
        self.report.push(
            Diagnostic::new(Code::LayoutTooLarge, span, format!("{what} is too large"))
                .label(format!("it takes {bytes} bytes; {BYTES_MAX} are possible")),
        );
    }

    /// A bound or length, which must be a number in STL.
    pub fn bound(&mut self, bound: &Bound) -> Option<i64> {
        match bound {
            Bound::Number(number, _) => Some(*number),
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

    fn recursive(&mut self, name: &str, span: Span) {
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

    fn finish_structure(
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

    fn declare_name(&mut self, names: &mut FxHashMap<String, Span>, variable: &ast::Variable) {
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
    fn with_initial(&mut self, typed: Option<Typed>, variable: &ast::Variable) -> Typed {
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

    fn no_initial(&mut self, variable: &ast::Variable, why: &str) {
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

    /// The interface of a block of the program or the system; a block that is defined nowhere is reported at `span`.
    pub fn interface(&mut self, key: BlockKey, span: Span) -> Option<Rc<BoundInterface>> {
        match self.interfaces.get(&key) {
            Some(State::Done(done)) => {
                let done = done.clone();
                if done.is_some() && matches!(key.kind, BlockKind::Sfc | BlockKind::Sfb) {
                    self.use_system(key, span);
                }
                return done;
            }
            Some(State::Running) => {
                self.recursive(&key.to_string(), span);
                return None;
            }
            None => {}
        }
        let source = self.code_source(key, span)?;
        self.interfaces.insert(key, State::Running);
        let bound = self.bind_interface(key, source.block()).map(Rc::new);
        self.interfaces.insert(key, State::Done(bound.clone()));
        bound
    }

    /// The syntax tree of a block; one of the system is parsed when it is first used.
    fn code_source(&mut self, key: BlockKey, span: Span) -> Option<CodeSource<'a>> {
        let system = matches!(key.kind, BlockKind::Sfc | BlockKind::Sfb);
        if system && !self.use_system(key, span) {
            return None;
        }
        if !self.code.contains_key(&key) {
            self.unknown_block(super::names::kind_prefix(key.kind), key.number, span);
            return None;
        }
        self.code.get(&key).cloned()
    }

    fn bind_interface(&mut self, key: BlockKey, block: &ast::CodeBlock) -> Option<BoundInterface> {
        let mut bound = BoundInterface::default();
        bound.interface.code_version1 = block.header.code_version1;
        let mut names = FxHashMap::default();
        self.check_sections(key, block);
        match key.kind {
            BlockKind::Fb | BlockKind::Sfb => self.instance_interface(key, block, &mut bound, &mut names)?,
            BlockKind::Ob | BlockKind::Fc | BlockKind::Sfc | BlockKind::Db => {
                self.function_interface(key, block, &mut bound, &mut names);
            }
        }
        self.temporaries(key, block, &mut bound, &mut names);
        self.overlays(block, &mut bound, &mut names);
        Some(bound)
    }

    fn check_sections(&mut self, key: BlockKey, block: &ast::CodeBlock) {
        for section in &block.sections {
            let allowed = match key.kind {
                BlockKind::Ob => section.kind == SectionKind::Temp,
                BlockKind::Fc | BlockKind::Sfc => section.kind != SectionKind::Static,
                BlockKind::Fb | BlockKind::Sfb | BlockKind::Db => true,
            };
            if !allowed {
                self.report.push(
                    Diagnostic::new(
                        Code::SectionNotAllowed,
                        section.span,
                        match key.kind {
                            BlockKind::Ob => {
                                format!("{key} is called by the system and has no parameters or static data")
                            }
                            _ => format!("{key} is a function and has no static data"),
                        },
                    )
                    .label("this section is not possible here")
                    .help(match key.kind {
                        BlockKind::Ob => "use VAR_TEMP, bit memory or a data block",
                        _ => "make it a FUNCTION_BLOCK, or use a data block",
                    }),
                );
            }
        }
    }

    fn instance_interface(
        &mut self,
        key: BlockKey,
        block: &ast::CodeBlock,
        bound: &mut BoundInterface,
        names: &mut FxHashMap<String, Span>,
    ) -> Option<()> {
        let mut builder = StructBuilder::default();
        for kind in [SectionKind::Input, SectionKind::Output, SectionKind::InOut, SectionKind::Static] {
            builder.placer.align();
            for variable in variables(block, kind).filter(|variable| variable.at.is_none()) {
                self.declare_name(names, variable);
                let used = if kind == SectionKind::Static { Use::Static } else { Use::Parameter(kind) };
                let typed = self.resolve_type(&variable.ty, used);
                if let Some(Typed { ty: DataType::Parameter(parameter), .. }) = &typed {
                    self.no_initial(variable, "a parameter of this type points to its actual");
                    if kind == SectionKind::Output {
                        let name = layout::type_name(&DataType::Parameter(*parameter));
                        self.report.push(
                            Diagnostic::new(
                                Code::SectionNotAllowed,
                                variable.ty.span,
                                format!("an output of a function block cannot be of type {name}"),
                            )
                            .label("not possible in VAR_OUTPUT")
                            .help("declare it in VAR_INPUT or VAR_IN_OUT"),
                        );
                    }
                }
                let complex = typed.as_ref().is_some_and(|typed| is_complex(&typed.ty));
                let pointer = complex && kind == SectionKind::InOut;
                if pointer {
                    self.no_initial(variable, "a complex IN_OUT parameter points to its actual");
                }
                let points = matches!(&typed, Some(Typed { ty: DataType::Parameter(_), .. }));
                let typed = if pointer || points {
                    typed.unwrap_or(Typed { ty: DataType::Void, image: Rc::from([]) })
                } else {
                    self.with_initial(typed, variable)
                };
                let stored = if pointer {
                    Typed { ty: DataType::Parameter(ParameterType::Pointer), image: Rc::from([0u8; 6]) }
                } else {
                    typed.clone()
                };
                let (byte, bit) = builder.add(variable.name.clone(), &stored);
                if builder.too_large() {
                    break;
                }
                if let Some(direction) = direction(kind)
                    && let Some(passing) = passing(&typed.ty)
                {
                    let name = variable.name.clone();
                    bound.interface.parameters.push(Parameter {
                        name,
                        direction,
                        ty: typed.ty.clone(),
                        byte,
                        bit,
                        passing,
                    });
                }
                let (base, byte, bit) =
                    if pointer { (Base::ThroughPointer(byte), 0, 0) } else { (Base::Instance, byte, bit) };
                add_local(&mut bound.locals, variable, typed.ty, base, byte, bit);
            }
        }
        let prefix = super::names::kind_prefix(key.kind);
        let name = match self.block_name(prefix, key.number) {
            name if name.is_empty() => key.to_string(),
            name => name,
        };
        let instance_of = Some((key.kind == BlockKind::Sfb, key.number));
        let instance = self.finish_structure(builder, name, instance_of, block.name.span())?;
        bound.interface.bytes = instance.ty.bytes;
        bound.interface.instance = instance.ty.members.clone();
        bound.instance = Some(instance);
        Some(())
    }

    fn function_interface(
        &mut self,
        key: BlockKey,
        block: &ast::CodeBlock,
        bound: &mut BoundInterface,
        names: &mut FxHashMap<String, Span>,
    ) {
        let system = key.kind == BlockKind::Sfc;
        let mut placer = Placer::default();
        for kind in [SectionKind::Input, SectionKind::Output, SectionKind::InOut] {
            if kind == SectionKind::Output && system {
                self.result(block, bound, names, &mut placer);
            }
            for variable in variables(block, kind).filter(|variable| variable.at.is_none()) {
                self.declare_name(names, variable);
                self.no_initial(variable, "a function has no memory of its own");
                let ty = self.resolve_type(&variable.ty, Use::Parameter(kind)).map_or(DataType::Void, |typed| typed.ty);
                let direction = direction(kind).expect("the three sections of this loop are parameters");
                add_parameter(bound, &mut placer, variable.name.clone(), direction, ty);
            }
            if kind == SectionKind::Output && !system {
                self.result(block, bound, names, &mut placer);
            }
        }
        bound.interface.bytes = placer.size();
    }

    /// The result of a function is its output RET_VAL.
    fn result(
        &mut self,
        block: &ast::CodeBlock,
        bound: &mut BoundInterface,
        names: &mut FxHashMap<String, Span>,
        placer: &mut Placer,
    ) {
        let Some(ty) = &block.return_type else { return };
        if matches!(&ty.kind, TypeKind::Named(word) if word == "VOID") {
            return;
        }
        names.insert(fold("RET_VAL"), ty.span);
        let resolved = self.resolve_type(ty, Use::Result).map_or(DataType::Void, |typed| typed.ty);
        add_parameter(bound, placer, "RET_VAL".to_string(), Direction::Output, resolved);
    }

    fn temporaries(
        &mut self,
        key: BlockKey,
        block: &ast::CodeBlock,
        bound: &mut BoundInterface,
        names: &mut FxHashMap<String, Span>,
    ) {
        let mut placer = Placer::default();
        for variable in variables(block, SectionKind::Temp).filter(|variable| variable.at.is_none()) {
            self.declare_name(names, variable);
            self.no_initial(variable, "temporary data begins anew at each call");
            let ty = self.resolve_type(&variable.ty, Use::Temp).map_or(DataType::Void, |typed| typed.ty);
            let (byte, bit) = placer.place(&ty);
            add_local(&mut bound.locals, variable, ty, Base::L, byte, bit);
        }
        let bytes = u64::from(placer.size());
        if bytes > u64::from(plcc_abi::layout::L_CLASS_BYTES) {
            self.too_large(block.name.span(), "the temporary data of this block", bytes);
            return;
        }
        bound.temp_bytes = bytes as u32;
        let profile = &self.input.profile;
        if bound.temp_bytes > profile.local_data {
            let code = if profile.limits_checked { Code::LayoutTooLarge } else { Code::CpuLimit };
            let name = profile.name.clone();
            let limit = profile.local_data;
            self.report.push(
                Diagnostic::new(code, block.name.span(), "the temporary data of this block is more than the CPU has")
                    .label(format!("{bytes} bytes; the profile {name} has {limit} bytes of local data"))
                    .help("move data to a data block, or name a larger CPU with --cpu"),
            );
        }
        if key.kind == BlockKind::Ob {
            bound.temp_bytes = bound.temp_bytes.max(super::OB_START_INFORMATION_BYTES);
        }
    }

    /// `b AT a : TYPE`: the place of `a`, seen as another type.
    fn overlays(&mut self, block: &ast::CodeBlock, bound: &mut BoundInterface, names: &mut FxHashMap<String, Span>) {
        for section in &block.sections {
            for variable in &section.variables {
                let Some((base, span)) = &variable.at else { continue };
                self.declare_name(names, variable);
                let Some(under) = bound.locals.get(&fold(base)).cloned() else {
                    self.report.push(
                        Diagnostic::new(Code::UnknownLocal, *span, format!("`{base}` is not declared"))
                            .label("AT names a variable of this block that is declared before"),
                    );
                    continue;
                };
                self.no_initial(variable, "it lies where the other variable lies");
                let ty = self.resolve_type(&variable.ty, Use::Component).map_or(DataType::Void, |typed| typed.ty);
                if layout::bytes(&ty) > layout::bytes(&under.ty).next_multiple_of(2) {
                    self.report.push(
                        Diagnostic::new(
                            Code::WidthMismatch,
                            variable.ty.span,
                            format!("`{}` is longer than `{base}`", variable.name),
                        )
                        .label(format!(
                            "{} bytes over {} bytes",
                            layout::bytes(&ty),
                            layout::bytes(&under.ty)
                        )),
                    );
                }
                add_local(&mut bound.locals, variable, ty, under.base, under.byte, under.bit);
            }
        }
    }
}

/// Components one after the other, with the bytes they start with.
#[derive(Default)]
struct StructBuilder {
    placer: Placer,
    members: Vec<Member>,
    image: Vec<u8>,
}

impl StructBuilder {
    fn add(&mut self, name: String, typed: &Typed) -> (u32, u8) {
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

    fn too_large(&self) -> bool {
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

fn variables(block: &ast::CodeBlock, kind: SectionKind) -> impl Iterator<Item = &ast::Variable> {
    block.sections.iter().filter(move |section| section.kind == kind).flat_map(|section| &section.variables)
}

fn add_local(
    locals: &mut FxHashMap<String, Local>,
    variable: &ast::Variable,
    ty: DataType,
    base: Base,
    byte: u32,
    bit: u8,
) {
    let local = Local { name: variable.name.clone(), ty, base, byte, bit };
    locals.entry(fold(&variable.name)).or_insert(local);
}

fn add_parameter(bound: &mut BoundInterface, placer: &mut Placer, name: String, direction: Direction, ty: DataType) {
    let (byte, bit) = placer.place(&ty);
    let index = bound.interface.parameters.len();
    let local = Local { name: name.clone(), ty: ty.clone(), base: Base::Parameter(index), byte: 0, bit: 0 };
    bound.locals.entry(fold(&name)).or_insert(local);
    // A parameter of unknown type keeps its place in the list; the call is not checked against it.
    let passing = passing(&ty).unwrap_or(Passing::Complex { bytes: 0 });
    bound.interface.parameters.push(Parameter { name, direction, ty, byte, bit, passing });
}

const fn direction(kind: SectionKind) -> Option<Direction> {
    match kind {
        SectionKind::Input => Some(Direction::Input),
        SectionKind::Output => Some(Direction::Output),
        SectionKind::InOut => Some(Direction::InOut),
        SectionKind::Static | SectionKind::Temp => None,
    }
}

fn passing(ty: &DataType) -> Option<Passing> {
    match ty {
        DataType::Elementary(elementary) => Some(Passing::Elementary(layout::width(*elementary))),
        DataType::DateAndTime | DataType::String(_) | DataType::Array(_) | DataType::Struct(_) => {
            Some(Passing::Complex { bytes: layout::bytes(ty) })
        }
        DataType::Parameter(ParameterType::Pointer) => Some(Passing::Pointer),
        DataType::Parameter(ParameterType::Any) => Some(Passing::Any),
        DataType::Parameter(
            ParameterType::Timer
            | ParameterType::Counter
            | ParameterType::BlockFb
            | ParameterType::BlockFc
            | ParameterType::BlockDb
            | ParameterType::BlockSdb,
        ) => Some(Passing::Number),
        DataType::Void => Some(Passing::Complex { bytes: 0 }),
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
