//! Data types of declarations: finds out which type a declaration means.

use std::rc::Rc;

use plcc_abi::image::{BlockKind, Family};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, Bound, SectionKind, TypeKind, TypeRef};
use plcc_syntax::chart::ast as chart;
use rustc_hash::FxHashMap;

use crate::bind::declarations::typed::{
    DeclarationScope, StructBuilder, Typed, TypedStruct, Use, elementary_typed, put, string, wide_string,
};
use crate::bind::declarations::{Declarations, State, predefined};
use crate::bind::trees::{SYSTEM_FILE, blocks};
use plcc_binding::fold;
use plcc_model::BlockKey;
use plcc_model::layout::{self, BYTES_MAX};
use plcc_model::types::{ArrayType, DataType, Elementary, Member, OpenArrayType, ParameterType, StructType};

/// Limit of nested types; STEP 7 allows 8 structures.
const DEPTH_MAX: u32 = 64;

/// Types that an S7-1200 does not have, with the nearest that it has. Source: SCL reference, elementary types.
const NOT_OF_S7_1200: [(Elementary, &str); 7] = [
    (Elementary::Lword, "DWORD"),
    (Elementary::Lint, "DINT"),
    (Elementary::Ulint, "UDINT"),
    (Elementary::Ltime, "TIME"),
    (Elementary::Ltod, "TOD"),
    (Elementary::Ldt, "DTL"),
    (Elementary::S5Time, "TIME"),
];

/// The types of the program that have been needed so far, and where declarations are bound.
#[derive(Default)]
pub struct Types {
    pub udts: FxHashMap<u16, State<Option<Typed>>>,
    /// DTL and other predefined structures.
    pub predefined: FxHashMap<&'static str, TypedStruct>,
    /// Where the declarations are that are currently bound.
    pub scope: DeclarationScope,
    /// Current depth of nested types.
    pub depth: u32,
    /// Components by folded name; the structure is kept so that no other gets its address.
    pub member_index: FxHashMap<*const StructType, (Rc<StructType>, FxHashMap<String, usize>)>,
}

impl Types {
    /// The component of a structure with this name. Large structures are indexed once.
    pub fn member(&mut self, structure: &Rc<StructType>, name: &str) -> Option<Member> {
        const INDEXED: usize = 12;
        let folded = match plcc_stdlib::own_member(structure.instance_of, name) {
            Some(own) => fold(own),
            None => fold(name),
        };
        if structure.members.len() < INDEXED {
            return structure.members.iter().find(|member| fold(&member.name) == folded).cloned();
        }
        let key = Rc::as_ptr(structure);
        let (_, index) = self.member_index.entry(key).or_insert_with(|| {
            let index: FxHashMap<String, usize> =
                structure.members.iter().enumerate().rev().map(|(at, member)| (fold(&member.name), at)).collect();
            (Rc::clone(structure), index)
        });
        index.get(&folded).map(|&at| structure.members[at].clone())
    }
}

impl<'a> Declarations<'a> {
    /// Every UDT, so that unused ones are checked, too.
    pub fn bind_types(&mut self) {
        let mut numbers: Vec<u16> = self.globals.sources.types.keys().copied().collect();
        numbers.sort_unstable();
        for number in numbers {
            let span = self.globals.sources.types[&number].name.span();
            self.udt(number, span);
        }
    }

    /// The type of a variable; `None` if it is not known, which is reported.
    pub fn variable_type(&mut self, variable: &ast::Variable, used: Use) -> Option<Typed> {
        let outer = std::mem::replace(&mut self.types.scope.variable, variable.name.clone());
        let typed = self.resolve_type(&variable.ty, used);
        self.types.scope.variable = outer;
        typed
    }

    /// Determines a type; `None` if it is not known, which is reported.
    pub fn resolve_type(&mut self, ty: &TypeRef, used: Use) -> Option<Typed> {
        if self.types.depth >= DEPTH_MAX {
            self.report(
                Diagnostic::new(Code::LayoutTooLarge, ty.span, "types are nested too deep")
                    .label(format!("more than {DEPTH_MAX} nested types"))
                    .help("STEP 7 allows 8 nested structures"),
            );
            return None;
        }
        self.types.depth += 1;
        let result = self.resolve_type_inner(ty, used);
        self.types.depth -= 1;
        result
    }

    fn resolve_type_inner(&mut self, ty: &TypeRef, used: Use) -> Option<Typed> {
        match &ty.kind {
            TypeKind::Named(word) => self.named_type(word, ty.span, used),
            TypeKind::String(None) => Some(string(254)),
            TypeKind::String(Some(bound)) => match self.bound(bound)? {
                length @ 0..=254 => Some(string(length as u8)),
                _ => {
                    self.report(
                        Diagnostic::new(Code::DeclarationSyntax, ty.span, "a STRING can have up to 254 characters")
                            .label("this length is not possible")
                            .help("write `STRING[254]`, or use an ARRAY of STRING or of CHAR"),
                    );
                    None
                }
            },
            TypeKind::WideString(None) => Some(wide_string(254)),
            TypeKind::WideString(Some(bound)) => match self.bound(bound)? {
                length @ 0..=16_382 => Some(wide_string(length as u16)),
                _ => {
                    self.bad_type(ty.span, "a WSTRING can have up to 16382 characters", "this length is not possible");
                    None
                }
            },
            TypeKind::Array { bounds, element } => self.array_type(bounds, element, ty.span, used),
            TypeKind::OpenArray { dimensions, element } => self.open_array(*dimensions, element, ty.span, used),
            TypeKind::Struct(variables) => {
                let typed = self.structure(String::new(), variables, ty.span, used.inside(self.types.scope.scl))?;
                Some(Typed { ty: DataType::Struct(typed.ty), image: typed.image })
            }
            TypeKind::Block(name) => self.block_type(name, used),
            TypeKind::Error => None,
            TypeKind::Reference(target) => {
                self.check_type_of_cpu("REF_TO", "pass the variable as an in/out parameter", ty.span);
                self.reference_type(target, ty.span)
            }
        }
    }

    fn bad_type(&mut self, span: Span, title: &str, label: &str) {
        self.report(Diagnostic::new(Code::DeclarationSyntax, span, title).label(label));
    }

    /// `ARRAY[*]`: the actual determines the bounds.
    fn open_array(&mut self, dimensions: u8, element: &TypeRef, span: Span, used: Use) -> Option<Typed> {
        let allowed = match used {
            Use::Parameter(SectionKind::InOut) => true,
            Use::Parameter(SectionKind::Input | SectionKind::Output) => !self.types.scope.instance,
            _ => false,
        };
        if !allowed {
            self.report(
                Diagnostic::new(Code::SectionNotAllowed, span, "ARRAY[*] is only possible for parameters")
                    .label("not possible in this declaration")
                    .help("a function can declare it in VAR_INPUT, VAR_OUTPUT and VAR_IN_OUT, a function block in VAR_IN_OUT"),
            );
            return None;
        }
        if !(1..=6).contains(&dimensions) {
            self.bad_type(span, "an array has 1 to 6 dimensions", "more than 6");
            return None;
        }
        let element = self.resolve_type(element, Use::Component)?.ty;
        let ty = DataType::OpenArray(Rc::new(OpenArrayType { dimensions, element }));
        let image = vec![0; layout::bytes(&ty) as usize];
        Some(Typed { ty, image: Rc::from(image) })
    }

    fn named_type(&mut self, word: &str, span: Span, used: Use) -> Option<Typed> {
        if let Some(ty) = Elementary::from_word(word) {
            if let Some((_, instead)) = NOT_OF_S7_1200.iter().find(|(absent, _)| *absent == ty) {
                self.check_type_of_cpu(ty.name(), &format!("declare it as {instead}"), span);
            }
            return Some(elementary_typed(ty));
        }
        let parameter = match word {
            "DATE_AND_TIME" | "DT" => {
                return Some(Typed { ty: DataType::DateAndTime, image: Rc::from(plcc_binding::value::DT_DEFAULT) });
            }
            "STRING" => return Some(string(254)),
            "WSTRING" => return Some(wide_string(254)),
            "TIMER" => ParameterType::Timer,
            "COUNTER" => ParameterType::Counter,
            "BLOCK_FB" => ParameterType::BlockFb,
            "BLOCK_FC" => ParameterType::BlockFc,
            "BLOCK_DB" => ParameterType::BlockDb,
            "BLOCK_SDB" => ParameterType::BlockSdb,
            "POINTER" => ParameterType::Pointer,
            "ANY" => ParameterType::Any,
            "VARIANT" => ParameterType::Variant,
            _ => return self.block_type(&BlockName::Symbol { name: word.to_string(), span }, used),
        };
        let allowed = match used {
            Use::Parameter(SectionKind::Input) => true,
            Use::Parameter(SectionKind::Output | SectionKind::InOut) => {
                matches!(parameter, ParameterType::Pointer | ParameterType::Any | ParameterType::Variant)
            }
            Use::Parameter(SectionKind::Static | SectionKind::Temp) => false,
            Use::Temp => matches!(parameter, ParameterType::Any | ParameterType::Variant),
            Use::Result => {
                matches!(parameter, ParameterType::Pointer | ParameterType::Any | ParameterType::Variant)
            }
            Use::Component | Use::Static | Use::StaticPart => false,
        };
        if !allowed {
            self.report(
                Diagnostic::new(Code::SectionNotAllowed, span, format!("{word} is only possible for parameters"))
                    .label("not possible in this declaration")
                    .help(match word {
                        "VARIANT" => "declare it in VAR_INPUT, VAR_OUTPUT, VAR_IN_OUT or VAR_TEMP",
                        "ANY" => "declare it in VAR_INPUT, VAR_OUTPUT, VAR_IN_OUT or VAR_TEMP",
                        "POINTER" => "declare it in VAR_INPUT, VAR_OUTPUT or VAR_IN_OUT",
                        _ => "declare it in VAR_INPUT",
                    }),
            );
            return None;
        }
        let image = vec![0; layout::parameter_bytes(parameter) as usize];
        Some(Typed { ty: DataType::Parameter(parameter), image: Rc::from(image) })
    }

    /// Warns once of a type that an S7-1200 does not have, if the CPU is one. `instead`: what to do.
    fn check_type_of_cpu(&mut self, name: &str, instead: &str, span: Span) {
        if self.globals.input.profile.family != Family::S71200 || span.file == SYSTEM_FILE {
            return;
        }
        let title = format!("an S7-1200 does not have the type {name}");
        if self.globals.report.diagnostics.iter().any(|known| known.title == title) {
            return;
        }
        self.report(
            Diagnostic::new(Code::CpuLimit, span, title)
                .label("a type of other CPUs")
                .help(format!("{instead}, or name another CPU with --cpu or in plc.toml")),
        );
    }

    fn array_type(&mut self, bounds: &[(Bound, Bound)], element: &TypeRef, span: Span, used: Use) -> Option<Typed> {
        let mut limits = Vec::new();
        let mut good = true;
        for (low, high) in bounds {
            let (Some(low), Some(high)) = (self.bound(low), self.bound(high)) else { return None };
            match (i32::try_from(low), i32::try_from(high)) {
                (Ok(low), Ok(high)) if low <= high => limits.push((low, high)),
                (Ok(low), Ok(high)) => {
                    self.report(
                        Diagnostic::new(
                            Code::DeclarationSyntax,
                            span,
                            "the bounds of the array are in the wrong order",
                        )
                        .label(format!("from {low} to {high}"))
                        .help(format!("write the low bound first: `ARRAY[{high}..{low}]`")),
                    );
                    return None;
                }
                _ => good = false,
            }
        }
        if !good || limits.is_empty() || limits.len() > 6 {
            self.report(
                Diagnostic::new(Code::DeclarationSyntax, span, "these array bounds are not possible")
                    .label("1 to 6 dimensions, each from a low to a high bound of type DINT")
                    .help("write the bounds as `low..high`, those of several dimensions separated by `,`"),
            );
            return None;
        }
        let element = self.resolve_type(element, used.inside(self.types.scope.scl))?;
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
        self.report(
            Diagnostic::new(Code::LayoutTooLarge, span, format!("{what} is too large"))
                .label(format!("it needs {bytes} bytes; {BYTES_MAX} are possible")),
        );
    }

    fn block_type(&mut self, name: &BlockName, used: Use) -> Option<Typed> {
        let span = name.span();
        let (prefix, number) = match name {
            BlockName::Symbol { name, .. } => match self.type_block(name) {
                Some(block) => block,
                None if self.globals.names.symbols.contains_key(&fold(name)) => self.globals.named_block(name, span)?,
                None => {
                    let typed = self.predefined(name, span);
                    if typed.is_none() {
                        self.globals.unknown_type(name, span);
                    }
                    return typed;
                }
            },
            BlockName::Numbered { .. } => self.globals.block_number(name)?,
        };
        match prefix {
            BlockPrefix::Udt => self.udt(number, span),
            BlockPrefix::Fb | BlockPrefix::Sfb => {
                let kind = if prefix == BlockPrefix::Fb { BlockKind::Fb } else { BlockKind::Sfb };
                let key = BlockKey { kind, number };
                let possible = match used {
                    Use::Static => true,
                    // STL of the TIA Portal reads timers and counters that its caller passes.
                    Use::Parameter(section) => {
                        let scope = &self.types.scope;
                        section == SectionKind::InOut && (scope.scl || (scope.tia && kind == BlockKind::Sfb))
                    }
                    Use::Component | Use::StaticPart => predefined::is_component(kind),
                    Use::Temp | Use::Result => false,
                };
                if !possible {
                    let title = format!("an instance of {} is not possible here", self.globals.shown(key));
                    let message = Diagnostic::new(Code::SectionNotAllowed, span, title);
                    let message = match used {
                        Use::StaticPart => {
                            let (variable, ty) = (&self.types.scope.variable, self.globals.text(span));
                            message.label("STL has no instances in arrays and structures").help(format!(
                                "declare each instance as a variable of its own in VAR, such as `{variable}_1 : {ty};`"
                            ))
                        }
                        Use::Component | Use::Parameter(_) | Use::Static | Use::Temp | Use::Result => message
                            .label("only static data of a function block can be an instance")
                            .help("declare it in VAR of a FUNCTION_BLOCK"),
                    };
                    self.report(message);
                    return None;
                }
                let bound = self.interface(key, span)?;
                if bound.interface.code_version1 {
                    self.report(
                        Diagnostic::new(Code::SectionNotAllowed, span, format!("{key} cannot be a multi-instance"))
                            .label("its source has the attribute CODE_VERSION1")
                            .help(format!("remove CODE_VERSION1 from {key}, or call it with its own DB")),
                    );
                }
                if used == Use::Static && self.is_portal_chart(key) {
                    self.report(
                        Diagnostic::new(Code::ChartInstance, span, format!("{key} cannot be a multi-instance"))
                            .label("a block in GRAPH of the TIA Portal")
                            .help("call it with its own instance DB"),
                    );
                }
                let instance = bound.instance.clone()?;
                Some(Typed { ty: DataType::Struct(instance.ty), image: instance.image })
            }
            // A part of a program may lack the type that has the name of this block.
            _ if self.globals.report.partial()
                && let BlockName::Symbol { name, .. } = name =>
            {
                self.globals.unknown_type(name, span);
                None
            }
            _ => {
                self.report(
                    Diagnostic::new(Code::UnknownType, span, "this block is not a data type")
                        .label("a UDT is expected; in VAR of a function block also an FB or SFB"),
                );
                None
            }
        }
    }

    /// A block in GRAPH of the TIA Portal. Source: GRAPH reference, chapter 0.
    fn is_portal_chart(&self, key: BlockKey) -> bool {
        match self.globals.sources.code.get(&key).map(|source| &source.block().code) {
            Some(ast::Code::Chart(body)) => body.dialect == chart::Dialect::Tia,
            Some(ast::Code::Stl(_) | ast::Code::Scl(_) | ast::Code::Graphic(_)) | None => false,
        }
    }

    /// The type of UDT `number`.
    pub fn udt(&mut self, number: u16, span: Span) -> Option<Typed> {
        match self.types.udts.get(&number) {
            Some(State::Done(done)) => return done.clone(),
            Some(State::Running) => {
                let name = match self.globals.names.block_name(BlockPrefix::Udt, number) {
                    name if name.is_empty() => format!("UDT {number}"),
                    name => format!("`{name}`"),
                };
                self.recursive(&name, span);
                return None;
            }
            None => {}
        }
        let Some(&block) = self.globals.sources.types.get(&number) else {
            self.globals.unknown_type(&format!("UDT {number}"), span);
            return None;
        };
        self.types.udts.insert(number, State::Running);
        let name = match self.globals.names.block_name(BlockPrefix::Udt, number) {
            name if name.is_empty() => format!("UDT {number}"),
            name => name,
        };
        let scope = self.data_scope();
        let outer = std::mem::replace(&mut self.types.scope, scope);
        let typed = match &block.alias {
            Some(ty) => self.resolve_type(ty, Use::Component),
            None => self
                .structure(name, &block.members, block.name.span(), Use::Component)
                .map(|typed| Typed { ty: DataType::Struct(typed.ty), image: typed.image }),
        };
        self.types.scope = outer;
        self.types.udts.insert(number, State::Done(typed.clone()));
        typed
    }

    /// Where components of data blocks and UDTs are.
    pub fn data_scope(&self) -> DeclarationScope {
        DeclarationScope { tia: self.globals.sources.tia, ..DeclarationScope::default() }
    }

    pub fn recursive(&mut self, name: &str, span: Span) {
        self.report(
            Diagnostic::new(Code::RecursiveType, span, format!("{name} contains itself"))
                .label("this component closes the loop")
                .help("a structure must not contain itself, not even through other types"),
        );
    }

    /// Lays out the components of a structure. A component of unknown type has no size.
    pub fn structure(
        &mut self,
        name: String,
        variables: &[ast::Variable],
        span: Span,
        used: Use,
    ) -> Option<TypedStruct> {
        let mut builder = StructBuilder::default();
        let mut names = FxHashMap::default();
        for variable in variables {
            self.declare_name(&mut names, &variable.name, variable.name_span);
            if let Some((_, span)) = variable.at {
                self.report(
                    Diagnostic::new(Code::SectionNotAllowed, span, "a component of a structure cannot be a view")
                        .label("AT is only possible for variables of a block")
                        .help("declare the view in a VAR section, over the whole structure"),
                );
                continue;
            }
            let typed = self.variable_type(variable, used);
            let typed = self.with_initial(typed, variable);
            builder.add_external(variable.name.clone(), &typed, blocks::external(variable));
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
        match builder.finish(name, instance_of) {
            Ok(structure) => Some(structure),
            Err(bytes) => {
                self.too_large(span, "this structure", bytes);
                None
            }
        }
    }

    pub fn declare_name(&mut self, names: &mut FxHashMap<String, Span>, name: &str, span: Span) {
        if let Some(first) = names.insert(fold(name), span) {
            // Declarations that a language adds come after everything that the source declares.
            if span.file == SYSTEM_FILE && first.file != SYSTEM_FILE {
                self.report(
                    Diagnostic::new(Code::DuplicateName, first, format!("GRAPH uses the name `{name}` in this block"))
                        .label("the chart keeps its own data under this name")
                        .help("give the variable another name"),
                );
                return;
            }
            // Constants are looked at before variables, wherever they stand.
            let is_before = first.file == span.file && first.start > span.start;
            let (first, second) = if is_before { (span, first) } else { (first, span) };
            let written = [first, second].map(|span| self.globals.text(span).trim_matches('"').to_owned());
            let shown = if fold(&written[1]) == fold(name) { written[1].as_str() } else { name };
            let help = match fold(&written[0]) == fold(shown) && written[0] != shown {
                true => "upper and lower case are the same in names: give one of them another name",
                false => "give one of them another name",
            };
            self.report(
                Diagnostic::new(Code::DuplicateName, second, format!("`{shown}` is declared twice"))
                    .label("the second declaration")
                    .also(first, "the first declaration")
                    .help(help),
            );
        }
    }

    /// Applies the initial value of a declaration. An unknown type becomes VOID, which represents it from here on.
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
            self.report(
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
