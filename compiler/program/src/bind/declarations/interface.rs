//! Interfaces of blocks: parameters, static and temporary data with their addresses.

use std::rc::Rc;

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::{self, SectionKind, TypeKind};
use plcc_syntax::scl::ast::Dialect;
use rustc_hash::FxHashMap;

use crate::bind::declarations::path::Base;
use crate::bind::declarations::predefined;
use crate::bind::declarations::typed::{
    BoundInterface, DeclarationScope, Local, StructBuilder, Typed, Use, is_complex,
};
use crate::bind::declarations::{Declarations, State};
use crate::bind::globals::sources::{CodeSource, portal_cpu};
use crate::bind::trees::blocks;
use plcc_binding::fold;
use plcc_model::layout::{self, Placer};
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{BlockKey, Direction, Parameter, Passing};

impl<'a> Declarations<'a> {
    /// The interface of a block of the program or the system; a block that is defined nowhere is reported at `span`.
    pub fn interface(&mut self, key: BlockKey, span: Span) -> Option<Rc<BoundInterface>> {
        match self.interfaces.get(&key) {
            Some(State::Done(done)) => {
                let done = done.clone();
                return done;
            }
            Some(State::Running) => {
                self.recursive(&self.globals.shown(key), span);
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
        if self.globals.in_library(key) && !self.globals.use_system(key, span) {
            return None;
        }
        if !self.globals.sources.code.contains_key(&key) {
            self.globals.unknown_block(crate::bind::globals::names::kind_prefix(key.kind), key.number, span);
            return None;
        }
        self.globals.sources.code.get(&key).cloned()
    }

    fn bind_interface(&mut self, key: BlockKey, block: &ast::CodeBlock) -> Option<BoundInterface> {
        let scope = self.block_scope(key, block);
        let outer = std::mem::replace(&mut self.types.scope, scope);
        let mut bound = self.bind_declarations(key, block);
        let scope = std::mem::replace(&mut self.types.scope, outer);
        if let Some(bound) = &mut bound {
            bound.constants = scope.constants;
        }
        bound
    }

    fn block_scope(&self, key: BlockKey, block: &ast::CodeBlock) -> DeclarationScope {
        let tia = match blocks::dialect(block) {
            Some(Dialect::Tia) => true,
            Some(Dialect::Classic) => false,
            Some(Dialect::Either) | None => portal_cpu(self.globals.input),
        };
        DeclarationScope {
            scl: !matches!(block.code, ast::Code::Stl(_)),
            tia,
            instance: matches!(key.kind, BlockKind::Fb | BlockKind::Sfb),
            ..DeclarationScope::default()
        }
    }

    fn bind_declarations(&mut self, key: BlockKey, block: &ast::CodeBlock) -> Option<BoundInterface> {
        let mut bound = BoundInterface::default();
        bound.interface.code_version1 = block.header.code_version1;
        let mut names = FxHashMap::default();
        self.constants(block, &mut bound, &mut names);
        self.check_sections(key, block);
        match key.kind {
            BlockKind::Fb | BlockKind::Sfb => self.instance_interface(key, block, &mut bound, &mut names)?,
            BlockKind::Ob => {}
            BlockKind::Fc | BlockKind::Sfc | BlockKind::Db | BlockKind::Sbr | BlockKind::Int => {
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
                BlockKind::Ob if section.kind == SectionKind::Input => self.has_start_inputs(block),
                BlockKind::Ob => section.kind == SectionKind::Temp,
                BlockKind::Fc | BlockKind::Sfc | BlockKind::Sbr | BlockKind::Int => section.kind != SectionKind::Static,
                BlockKind::Fb | BlockKind::Sfb | BlockKind::Db => true,
            };
            if !allowed {
                self.report(
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
                self.declare_name(names, &variable.name, variable.name_span);
                let used = if kind == SectionKind::Static { Use::Static } else { Use::Parameter(kind) };
                let typed = self.variable_type(variable, used);
                if let Some(Typed { ty: DataType::Parameter(parameter), .. }) = &typed {
                    self.no_initial(variable, "a parameter of this type points to its actual");
                    if kind == SectionKind::Output {
                        let name = layout::type_name(&DataType::Parameter(*parameter));
                        self.report(
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
                let open = matches!(&typed, Some(Typed { ty: DataType::OpenArray(_), .. }));
                let complex = open || typed.as_ref().is_some_and(|typed| is_complex(&typed.ty));
                let pointer = complex && kind == SectionKind::InOut;
                if pointer {
                    self.ignored_initial(variable, "a complex IN_OUT parameter points to its actual");
                }
                let points = matches!(&typed, Some(Typed { ty: DataType::Parameter(_), .. }));
                let typed = if pointer || points {
                    typed.unwrap_or(Typed { ty: DataType::Void, image: Rc::from([]) })
                } else {
                    self.with_initial(typed, variable)
                };
                // The bounds of an ARRAY[*] are after its POINTER.
                let stored = if pointer && !open {
                    Typed { ty: DataType::Parameter(ParameterType::Pointer), image: Rc::from([0u8; 6]) }
                } else {
                    typed.clone()
                };
                let external = blocks::external(variable);
                let (byte, bit) = builder.add_external(variable.name.clone(), &stored, external);
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
        let prefix = crate::bind::globals::names::kind_prefix(key.kind);
        let name = match self.globals.names.block_name(prefix, key.number) {
            name if name.is_empty() => match self.globals.library_block(key) {
                Some(block) => block.name.to_string(),
                None => key.to_string(),
            },
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
                self.declare_name(names, &variable.name, variable.name_span);
                self.ignored_initial(variable, "a function has no static data, so the value has no effect");
                let ty = self.variable_type(variable, Use::Parameter(kind)).map_or(DataType::Void, |typed| typed.ty);
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
        if key.kind == BlockKind::Ob {
            bound.interface.start_bytes = crate::bind::declarations::start_inputs::OB_START_INFORMATION_BYTES;
            if self.hides_start_information(key.number, block) {
                placer.reserve(crate::bind::declarations::start_inputs::OB_START_INFORMATION_BYTES);
            }
            if self.has_start_inputs(block) {
                self.start_inputs(key.number, block, bound, names, &mut placer);
            }
        }
        for variable in variables(block, SectionKind::Temp).filter(|variable| variable.at.is_none()) {
            self.declare_name(names, &variable.name, variable.name_span);
            self.no_temporary_initial(variable);
            let ty = self.variable_type(variable, Use::Temp).map_or(DataType::Void, |typed| typed.ty);
            let (byte, bit) = placer.place(&ty);
            add_local(&mut bound.locals, variable, ty, Base::L, byte, bit);
        }
        if key.kind == BlockKind::Ob {
            self.refused_sections(block, bound, names, &mut placer);
        }
        let bytes = u64::from(placer.size());
        if bytes > u64::from(plcc_abi::layout::L_CLASS_BYTES) {
            self.too_large(block.name.span(), "the temporary data of this block", bytes);
            return;
        }
        bound.temp_bytes = bytes as u32;
        let profile = &self.globals.input.profile;
        if bound.temp_bytes > profile.local_data {
            let code = if profile.limits_checked { Code::LayoutTooLarge } else { Code::CpuLimit };
            let name = profile.name.clone();
            let limit = profile.local_data;
            self.report(
                Diagnostic::new(
                    code,
                    block.name.span(),
                    "the temporary data of this block is more than the CPU has room for",
                )
                .label(format!("{bytes} bytes; the profile {name} has {limit} bytes of local data"))
                .help("move data to a data block, or name a larger CPU with --cpu"),
            );
        }
        if key.kind == BlockKind::Ob {
            bound.temp_bytes =
                bound.temp_bytes.max(crate::bind::declarations::start_inputs::OB_START_INFORMATION_BYTES);
        }
    }

    /// Parameters of an OB, which were reported where it does not have them: they are known, so that their uses are not errors too.
    fn refused_sections(
        &mut self,
        block: &ast::CodeBlock,
        bound: &mut BoundInterface,
        names: &mut FxHashMap<String, Span>,
        placer: &mut Placer,
    ) {
        let has_inputs = self.has_start_inputs(block);
        for kind in [SectionKind::Input, SectionKind::Output, SectionKind::InOut] {
            let refused = kind != SectionKind::Input || !has_inputs;
            for variable in variables(block, kind).filter(|variable| refused && variable.at.is_none()) {
                self.declare_name(names, &variable.name, variable.name_span);
                let ty = self.variable_type(variable, Use::Temp).map_or(DataType::Void, |typed| typed.ty);
                let (byte, bit) = placer.place(&ty);
                add_local(&mut bound.locals, variable, ty, Base::L, byte, bit);
            }
        }
    }

    /// `b AT a : TYPE`: the address of `a` with another type.
    fn overlays(&mut self, block: &ast::CodeBlock, bound: &mut BoundInterface, names: &mut FxHashMap<String, Span>) {
        for section in &block.sections {
            for variable in &section.variables {
                let Some((base, span)) = &variable.at else { continue };
                self.globals.check_view_access(block, section, *span);
                self.declare_name(names, &variable.name, variable.name_span);
                let Some(under) = bound.locals.get(&fold(base)).cloned() else {
                    self.report(
                        Diagnostic::new(Code::UnknownLocal, *span, format!("`{base}` is not declared"))
                            .label("AT names a variable of this block that is declared before it"),
                    );
                    continue;
                };
                self.no_initial(variable, "it is at the address of the other variable");
                // An ANY may be a view of a structure whose parts are written.
                let any = matches!(&variable.ty.kind, TypeKind::Named(word) if word == "ANY");
                let used = if any { Use::Temp } else { Use::Component };
                let ty = self.variable_type(variable, used).map_or(DataType::Void, |typed| typed.ty);
                self.check_view(variable, &ty, base, &under.ty);
                add_local(&mut bound.locals, variable, ty, under.base, under.byte, under.bit);
            }
        }
    }
}

impl Declarations<'_> {
    /// A view is within the variable that it shows. Source: SCL reference, AT views.
    fn check_view(&mut self, variable: &ast::Variable, ty: &DataType, base: &str, under: &DataType) {
        if matches!(ty, DataType::Void) || matches!(under, DataType::Void) {
            return;
        }
        if matches!(under, DataType::OpenArray(_)) {
            self.report(
                Diagnostic::new(Code::WidthMismatch, variable.ty.span, format!("`{base}` cannot have a view"))
                    .label("the length of an ARRAY[*] is only known at run time"),
            );
            return;
        }
        let (view, target) = (layout::used_bits(ty), 8 * layout::bytes(under));
        let target = if *under == DataType::Elementary(Elementary::Bool) { 1 } else { target };
        if view > target {
            let size = |bits: u32| if bits == 1 { "1 bit".to_string() } else { format!("{} bytes", bits.div_ceil(8)) };
            self.report(
                Diagnostic::new(
                    Code::WidthMismatch,
                    variable.ty.span,
                    format!("`{}` is longer than `{base}`", variable.name),
                )
                .label(format!("{} over {}", size(view), size(target)))
                .help("a view can only show the bytes of its variable"),
            );
        }
    }

    /// TEMP has no initial values; sources of the TIA Portal may have some, which have no effect.
    fn no_temporary_initial(&mut self, variable: &ast::Variable) {
        let why = "temporary data starts again with each call";
        if self.types.scope.tia { self.ignored_initial(variable, why) } else { self.no_initial(variable, why) }
    }

    /// An initial value without effect, as programs that run on CPUs may have it.
    pub fn ignored_initial(&mut self, variable: &ast::Variable, why: &str) {
        let before = self.globals.report.diagnostics.len();
        self.no_initial(variable, why);
        for diagnostic in &mut self.globals.report.diagnostics[before..] {
            diagnostic.severity = Severity::Warning;
        }
    }
}

/// The variables of the sections of this kind. An axis in VAR_INPUT is the axis itself and no copy of it, so it counts as VAR_IN_OUT.
pub(in crate::bind) fn variables(block: &ast::CodeBlock, kind: SectionKind) -> impl Iterator<Item = &ast::Variable> {
    let of = |section: &ast::Section, variable: &ast::Variable| match section.kind {
        SectionKind::Input if predefined::is_axis(&variable.ty.kind) => SectionKind::InOut,
        other => other,
    };
    let all = block.sections.iter().flat_map(|section| section.variables.iter().map(move |one| (section, one)));
    all.filter(move |(section, one)| of(section, one) == kind).map(|(_, one)| one)
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
    // A parameter of unknown type keeps its position in the list; the call does not check it.
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
        DataType::DateAndTime
        | DataType::String(_)
        | DataType::WideString(_)
        | DataType::Array(_)
        | DataType::Struct(_) => Some(Passing::Complex { bytes: layout::bytes(ty) }),
        DataType::OpenArray(array) => Some(Passing::OpenArray { dimensions: array.dimensions }),
        DataType::Parameter(ParameterType::Pointer) => Some(Passing::Pointer),
        DataType::Parameter(ParameterType::Any) => Some(Passing::Any),
        DataType::Parameter(ParameterType::Variant) => Some(Passing::Variant),
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
