//! Data blocks: their layout and their current values. `instances` makes those that only calls name.

mod instances;

use std::rc::Rc;

use plcc_abi::image::{BlockKind, Kept};
use plcc_abi::names::External;
use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, DataContent, PathPart, PathRoot, TypeKind};
use plcc_syntax::count::counted;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::bind::declarations::Declarations;
use crate::bind::declarations::path::{Base, Variable};
use crate::bind::declarations::typed::{StructBuilder, Typed, TypedStruct, Use};
use crate::bind::trees::blocks;
use plcc_abi::{any, layout};
use plcc_binding::fold;
use plcc_model::layout::{bytes as layout_bytes, same_type};
use plcc_model::types::{DataType, Elementary, StructType};
use plcc_model::{BlockKey, DataBlock};
use plcc_syntax::symbols::SymbolTarget;

/// Name of the array in an ARRAY data block.
const ARRAY_DB_MEMBER: &str = "THIS";

/// A data block with its layout.
pub struct BoundDb {
    pub block: DataBlock,
    pub ty: Rc<StructType>,
}

/// The data blocks with their layout.
#[derive(Default)]
pub struct DataBlocks {
    pub blocks: FxHashMap<u16, BoundDb>,
    /// Size of all so far.
    pub bytes: u64,
    /// Data blocks that calls name as instances of undefined blocks: nothing is known of them.
    pub unknown_instances: FxHashSet<u16>,
}

impl DataBlocks {
    /// Layout of DB `number`, if known.
    pub fn db_type(&self, number: u16) -> Option<Rc<StructType>> {
        self.blocks.get(&number).map(|db| Rc::clone(&db.ty))
    }
}

impl Declarations<'_> {
    pub fn bind_data(&mut self) {
        let mut numbers: Vec<u16> = self.globals.sources.data.keys().copied().collect();
        numbers.sort_unstable();
        self.types.scope = self.data_scope();
        for number in numbers {
            let source = self.globals.sources.data[&number];
            if let Some((typed, instance_of)) = self.db_content(source)
                && self.fits_with_others(typed.ty.bytes, source.name.span())
            {
                let db = self.make_db(number, source, typed, instance_of);
                self.data.blocks.insert(number, db);
            }
        }
        self.generate_instances();
    }

    /// Adds a data block; false if all of them together are too large, which is reported once.
    fn fits_with_others(&mut self, bytes: u32, span: Span) -> bool {
        let max = u64::from(layout::DB_DATA_BYTES_MAX);
        let before = self.data.bytes;
        self.data.bytes += u64::from(bytes);
        if before <= max && self.data.bytes > max {
            self.report(
                Diagnostic::new(Code::LayoutTooLarge, span, "the data blocks are too large together")
                    .label(format!("with this one they exceed {max} bytes")),
            );
        }
        self.data.bytes <= max
    }

    /// Notes the use of a DB by number; a missing DB is a warning.
    pub fn use_db(&mut self, number: u16, span: Span) {
        let known = self.data.blocks.contains_key(&number)
            || self.globals.sources.data.contains_key(&number)
            || self.data.unknown_instances.contains(&number);
        if number != 0 && !known {
            self.globals.report.missing_db(number, span);
        }
    }

    /// As [`use_db`](Self::use_db), for an ANY that is an actual parameter: it may mean a DB of a partner. Reports one that goes beyond the end
    /// of its data block.
    pub fn use_pointed_db(&mut self, callee: BlockKey, parameter: &str, bytes: [u8; 10], span: Span) {
        let block = self.globals.library_block(callee);
        if block.is_some_and(|block| plcc_stdlib::is_of_partner(block, parameter)) {
            return;
        }
        let [syntax, type_code, high, low, db_high, db_low, pointer @ ..] = bytes;
        let number = u16::from_be_bytes([db_high, db_low]);
        self.use_db(number, span);
        let fields = any::Fields {
            head: u32::from_be_bytes([syntax, type_code, high, low]),
            db: number,
            pointer: u32::from_be_bytes(pointer),
        };
        let Ok(Some(pointed)) = any::decode(fields, 0, any::Access::Read) else { return };
        let Some(db) = self.data.blocks.get(&number).filter(|_| pointed.area == layout::area::DB) else { return };
        // How long a stand-in is says nothing.
        if self.globals.input.stand_ins == Some(db.block.span.file) {
            return;
        }
        let (length, end) = (db.block.data.len() as u32, pointed.byte + pointed.bytes);
        if end <= length {
            return;
        }
        let help = match length.checked_sub(pointed.byte).filter(|rest| *rest > 0) {
            Some(rest) => format!(
                "from there on it has {rest} bytes: write `P#DB{number}.DBX{}.0 BYTE {rest}`, or declare more in it",
                pointed.byte
            ),
            None => "declare more in the data block, or write an address that it has".to_string(),
        };
        let defined = db.block.span;
        self.report(
            Diagnostic::new(Code::DbRange, span, format!("this pointer goes beyond the end of DB {number}"))
                .label(format!("to byte {}; the data block has {length} bytes", end - 1))
                .also(defined, "the data block")
                .help(help),
        );
    }

    /// Reports an address beyond the end of its data block, up to byte `end`.
    pub fn check_db_end(&mut self, number: u16, end: u32, span: Span) {
        if let Some(db) = self.data.blocks.get(&number) {
            let length = db.block.data.len() as u32;
            if end > length {
                let defined = db.block.span;
                self.report(
                    Diagnostic::new(Code::DbRange, span, format!("this address is beyond the end of DB {number}"))
                        .label(format!("the data block has {}", counted(length as usize, "byte")))
                        .also(defined, "the data block")
                        .help("at run time this is an error (OB 121)"),
                );
            }
        }
    }

    fn db_content(&mut self, source: &ast::DataBlock) -> Option<(TypedStruct, Option<BlockKey>)> {
        match &source.content {
            DataContent::Struct(variables) => {
                if let Some(instance) = self.data_of_instruction(source, variables) {
                    return Some(instance);
                }
                let typed = self.structure(String::new(), variables, source.name.span(), Use::Component)?;
                Some((typed, None))
            }
            DataContent::OfType(ty) => {
                let name = match &ty.kind {
                    TypeKind::Block(name) => name.clone(),
                    TypeKind::Named(word) => BlockName::Symbol { name: word.clone(), span: ty.span },
                    TypeKind::String(_)
                    | TypeKind::WideString(_)
                    | TypeKind::Array { .. }
                    | TypeKind::OpenArray { .. }
                    | TypeKind::Reference(_)
                    | TypeKind::Error
                    | TypeKind::Struct(_) => {
                        self.no_content(source, ty.span);
                        return None;
                    }
                };
                self.db_of_type(source, &name)
            }
            DataContent::Array(ty, initial) => {
                let typed = self.resolve_type(ty, Use::Component)?;
                let mut image = typed.image.to_vec();
                if let Some(initial) = initial {
                    self.encode_initial(initial, &typed.ty, &mut image, 0, 0);
                }
                let typed = Typed { ty: typed.ty, image: Rc::from(image) };
                Some((self.as_structure(typed, ty.span)?, None))
            }
            DataContent::Empty => {
                self.no_content(source, source.name.span());
                if !source.values.is_empty() {
                    return None;
                }
                // A block without data is complete: the TIA Portal exports an empty data block so.
                if let Some(message) = self.globals.report.diagnostics.last_mut() {
                    message.severity = Severity::Warning;
                }
                let empty = StructBuilder::default();
                Some((self.finish_structure(empty, String::new(), None, source.name.span())?, None))
            }
        }
    }

    /// The structure of a data block of type `typed`; an array is its only component, `THIS`.
    fn as_structure(&mut self, typed: Typed, span: Span) -> Option<TypedStruct> {
        match typed.ty {
            DataType::Struct(ty) => Some(TypedStruct { ty, image: typed.image }),
            _ => {
                let mut builder = StructBuilder::default();
                builder.add(ARRAY_DB_MEMBER.to_string(), &typed);
                self.finish_structure(builder, String::new(), None, span)
            }
        }
    }

    fn no_content(&mut self, source: &ast::DataBlock, span: Span) {
        let name = self.globals.text(source.name.span());
        let of = self.globals.text(span);
        let is_function =
            |target| matches!(target, SymbolTarget::Block { prefix: BlockPrefix::Fc | BlockPrefix::Sfc, .. });
        if self.globals.global(of.trim_matches('"')).is_some_and(is_function) {
            let call = of.trim();
            self.report(
                Diagnostic::new(Code::DeclarationSyntax, span, format!("{name} cannot be an instance of {call}"))
                    .label("a function, which keeps no data")
                    .help(format!("call `{call}(…)` without a data block, or make it a FUNCTION_BLOCK")),
            );
            return;
        }
        self.report(
            Diagnostic::new(Code::DeclarationSyntax, span, format!("{name} declares no data"))
                .label("a STRUCT, a UDT, an FB or an SFB is expected")
                .help("write `STRUCT ... END_STRUCT ;`, or the name of a UDT or FB"),
        );
    }

    fn db_of_type(&mut self, source: &ast::DataBlock, name: &BlockName) -> Option<(TypedStruct, Option<BlockKey>)> {
        let span = name.span();
        let (prefix, number) = match name {
            BlockName::Symbol { name, .. } => match self.type_block(name) {
                Some(block) => block,
                None if self.globals.names.symbols.contains_key(&fold(name)) => self.globals.named_block(name, span)?,
                None => {
                    if let Some(typed) = self.predefined(name, span) {
                        return Some((self.as_structure(typed, span)?, None));
                    }
                    if plcc_stdlib::LIBRARY.iter().any(|block| block.name.eq_ignore_ascii_case(name)) {
                        self.globals.unknown_name(name, span, std::iter::empty());
                    } else {
                        self.globals.unknown_type(name, span);
                    }
                    return None;
                }
            },
            BlockName::Numbered { .. } => self.globals.block_number(name)?,
        };
        match prefix {
            BlockPrefix::Udt => {
                let typed = self.udt(number, span)?;
                Some((self.as_structure(typed, span)?, None))
            }
            BlockPrefix::Fb | BlockPrefix::Sfb => {
                let kind = if prefix == BlockPrefix::Fb { BlockKind::Fb } else { BlockKind::Sfb };
                let key = BlockKey { kind, number };
                let instance = self.interface(key, span)?.instance.clone()?;
                Some((instance, Some(key)))
            }
            _ => {
                match (name, &source.name) {
                    // The block has the name of its type, which is not there.
                    (BlockName::Symbol { name, .. }, BlockName::Symbol { name: own, .. })
                        if fold(name) == fold(own) =>
                    {
                        self.globals.unknown_type(name, span);
                    }
                    _ => self.no_content(source, span),
                }
                None
            }
        }
    }

    /// The instance of a block of the library whose components the data block declares, with their start values:
    /// `{InstructionName := 'IEC_TIMER'}`, as the TIA Portal writes the data of timers and counters.
    fn data_of_instruction(
        &mut self,
        source: &ast::DataBlock,
        variables: &[ast::Variable],
    ) -> Option<(TypedStruct, Option<BlockKey>)> {
        let mut attributes = source.header.attributes.iter();
        let (_, value) = attributes.find(|(name, _)| name.eq_ignore_ascii_case("InstructionName"))?;
        let name = value.trim().trim_matches(['\'', '"']).trim();
        let names = &self.globals.names;
        if names.symbols.contains_key(&fold(name)) || names.types.contains_key(&fold(name)) {
            return None;
        }
        self.type_block(name)?;
        let name = BlockName::Symbol { name: name.to_string(), span: source.name.span() };
        let (instance, key) = self.db_of_type(source, &name)?;
        let mut members = Vec::new();
        for variable in variables {
            let member = self.types.member(&instance.ty, &variable.name)?;
            let own = self.resolve_type(&variable.ty, Use::Component)?;
            if !same_type(&own.ty, &member.ty) {
                return None;
            }
            members.push(member);
        }
        let mut image = instance.image.to_vec();
        for (variable, member) in variables.iter().zip(members) {
            if let Some(value) = &variable.initial {
                self.encode_initial(value, &member.ty, &mut image, member.byte, member.bit);
            }
        }
        Some((TypedStruct { ty: instance.ty, image: Rc::from(image) }, key))
    }

    fn make_db(
        &mut self,
        number: u16,
        source: &ast::DataBlock,
        typed: TypedStruct,
        instance_of: Option<BlockKey>,
    ) -> BoundDb {
        let mut data = typed.image.to_vec();
        let mut given: FxHashMap<(u32, u8), Span> = FxHashMap::default();
        for assignment in &source.values {
            let first = match &assignment.target.root {
                PathRoot::Local { name, span } | PathRoot::Quoted { name, span } | PathRoot::Bare { name, span } => {
                    PathPart::Member { name: name.clone(), span: *span }
                }
                PathRoot::Block(name) => PathPart::Member { name: self.globals.text(name.span()), span: name.span() },
            };
            let ty = DataType::Struct(Rc::clone(&typed.ty));
            let start = Variable { base: Base::Db(number), byte: 0, bit: 0, ty, untyped: false };
            let target = self
                .walk(start, std::slice::from_ref(&first))
                .and_then(|variable| self.walk(variable, &assignment.target.parts));
            if let Some(target) = target
                && !self.refuses_one_value(&assignment.target, &assignment.value, &target.ty)
            {
                let span = assignment.target.span;
                if matches!(target.ty, DataType::Elementary(_))
                    && let Some(first) = given.insert((target.byte, target.bit), span)
                {
                    let name = self.globals.text(span);
                    self.given_twice(&name, span, first, Severity::Warning);
                }
                self.encode_initial(&assignment.value, &target.ty, &mut data, target.byte, target.bit);
            }
        }
        self.check_db_size(number, data.len() as u32, source.name.span());
        let kept = self.kept(&source.header, &source.retained, instance_of, &typed.ty);
        let mut members = typed.ty.members.clone();
        if blocks::is_hidden(&source.header) {
            members.iter_mut().for_each(|member| member.external = External::Hidden);
        }
        let block = DataBlock {
            number,
            name: self.globals.names.block_name(BlockPrefix::Db, number),
            span: source.name.span(),
            data: at_least_a_word(data),
            members,
            instance_of,
            data_type: if instance_of.is_none() { typed.ty.name.clone() } else { String::new() },
            read_only: source.header.read_only,
            unlinked: source.header.unlinked,
            optimized: self.globals.input.profile.family.is_portal() && blocks::is_optimized(&source.header),
            kept,
        };
        BoundDb { block, ty: typed.ty }
    }

    /// What of a data block is retentive.
    ///
    /// S7-300/400: all of it, unless the header says NON_RETAIN. S7-1200/1500: the variables that say so, in the data block or in the FB
    /// whose instance it is; a block with standard access as a whole.
    fn kept(&self, header: &ast::Header, retained: &[String], instance_of: Option<BlockKey>, ty: &StructType) -> Kept {
        if !self.globals.input.profile.family.is_portal() {
            return if header.non_retain { Kept::Nothing } else { Kept::Everything };
        }
        if !header.non_retain && (header.retain || blocks::keeps_standard_data(header)) {
            return Kept::Everything;
        }
        let code = instance_of.and_then(|key| self.globals.sources.code.get(&key));
        let of_type = code.map(|code| ast::Section::retained(&code.block().sections)).unwrap_or_default();
        let names: FxHashSet<String> = retained.iter().chain(&of_type).map(|name| fold(name)).collect();
        let members = ty.members.iter().filter(|member| names.contains(&fold(&member.name)));
        let bits = members.map(|member| {
            let bits =
                if member.ty == DataType::Elementary(Elementary::Bool) { 1 } else { 8 * layout_bytes(&member.ty) };
            (8 * member.byte + u32::from(member.bit), bits)
        });
        match bits.collect::<Vec<_>>() {
            bits if bits.is_empty() => Kept::Nothing,
            bits => Kept::Bits(bits),
        }
    }

    /// A data block that the source does not name, for the constants of a block.
    pub fn add_constant_db(&mut self, number: u16, typed: TypedStruct, span: Span) {
        if !self.fits_with_others(typed.ty.bytes, span) {
            return;
        }
        let block = DataBlock {
            data_type: String::new(),
            number,
            name: self.globals.names.block_name(BlockPrefix::Db, number),
            span,
            data: at_least_a_word(typed.image.to_vec()),
            members: typed.ty.members.clone(),
            instance_of: None,
            read_only: true,
            unlinked: false,
            optimized: false,
            kept: Kept::Nothing,
        };
        self.data.blocks.insert(number, BoundDb { block, ty: typed.ty });
    }

    fn check_db_size(&mut self, number: u16, bytes: u32, span: Span) {
        let profile = &self.globals.input.profile;
        if bytes <= profile.db_bytes_max {
            return;
        }
        let code = if profile.limits_checked { Code::LayoutTooLarge } else { Code::CpuLimit };
        self.report(
            Diagnostic::new(code, span, format!("DB {number} is larger than the CPU allows"))
                .label(format!("{bytes} bytes; the profile {} allows {}", profile.name, profile.db_bytes_max)),
        );
    }
}

/// A DB of length 0 would not exist.
fn at_least_a_word(mut data: Vec<u8>) -> Vec<u8> {
    if data.is_empty() {
        data.resize(2, 0);
    }
    data
}
