//! DWARF of an object file: its line tables, and the [`variables`](crate::variables) of the program.
//!
//! A debugger shows the statement at which the program is and steps from statement to statement. In addition to the line table
//! there is one entry for each function, with the name of its block (`FC12`). File names are written as the module
//! has them; relative ones count from where the debugger runs.

use cranelift_object::ObjectProduct;
use gimli::write::{
    Address, AttributeValue, DwarfUnit, EndianVec, LineProgram, LineString, Range, RangeList, RelocateWriter,
    Relocation, RelocationTarget, Sections,
};
use gimli::{Encoding, Format, LineEncoding, LittleEndian, SectionId};
use object::write::{Object, Relocation as ObjectRelocation, SectionId as ObjectSection, SymbolId, SymbolSection};
use object::{RelocationEncoding, RelocationFlags, RelocationKind, SectionKind};
use plcc_abi::linked;
use plcc_ir::Module;
use plcc_ir::entities::Entity;
use rustc_hash::FxHashMap;

use crate::CodegenError;
use crate::compile::CompiledFunction;
use crate::object::data_symbol;
use crate::variables::{self, Variables};

/// Every debugger reads version 4.
const ENCODING: Encoding = Encoding { address_size: 8, format: Format::Dwarf32, version: 4 };
/// The folder from which relative file names count.
const FOLDER: &str = ".";

/// Adds line tables and variables to an object file, if the module has source places.
pub fn add(
    module: &Module,
    functions: &[CompiledFunction],
    variables: Option<&Variables<'_>>,
    product: &mut ObjectProduct,
) -> Result<(), CodegenError> {
    if module.sites.is_empty() || module.files.is_empty() {
        return Ok(());
    }
    let mut symbols: Vec<SymbolId> = module
        .functions
        .keys()
        .map(|id| product.function_symbol(cranelift_module::FuncId::from_u32(id.index() as u32)))
        .collect();
    let mut dwarf = unit(module, functions);
    if let Some(variables) = variables {
        let base = Address::Symbol { symbol: symbols.len(), addend: 0 };
        symbols.push(product.object.add_symbol(data_symbol(linked::MEMORY_SYMBOL, SymbolSection::Undefined)));
        variables::add(&mut dwarf.unit, variables, base);
    }
    let mut sections = Sections::new(Section::default());
    dwarf.write(&mut sections).map_err(|error| CodegenError::Output(format!("line table: {error}")))?;
    write_sections(&mut product.object, &sections, &symbols)
}

fn unit(module: &Module, functions: &[CompiledFunction]) -> DwarfUnit {
    let mut dwarf = DwarfUnit::new(ENCODING);
    dwarf.unit.line_program = line_program(module, functions);
    let ranges = (0..functions.len())
        .map(|symbol| Range::StartLength { begin: start(symbol), length: functions[symbol].bytes.len() as u64 })
        .collect();
    let ranges = dwarf.unit.ranges.add(RangeList(ranges));
    let root = dwarf.unit.root();
    let entry = dwarf.unit.get_mut(root);
    entry.set(gimli::DW_AT_producer, AttributeValue::String(b"plcc".to_vec()));
    // Debuggers have no PLC languages; expressions are those of C.
    entry.set(gimli::DW_AT_language, AttributeValue::Language(gimli::DW_LANG_C99));
    entry.set(gimli::DW_AT_name, AttributeValue::String(text(&module.files[0])));
    entry.set(gimli::DW_AT_comp_dir, AttributeValue::String(FOLDER.into()));
    // Ranges count from here.
    entry.set(gimli::DW_AT_low_pc, AttributeValue::Address(Address::Constant(0)));
    entry.set(gimli::DW_AT_ranges, AttributeValue::RangeListRef(ranges));
    entry.set(gimli::DW_AT_stmt_list, AttributeValue::LineProgramRef);
    for (symbol, function) in module.functions.values().enumerate() {
        let id = dwarf.unit.add(root, gimli::DW_TAG_subprogram);
        let entry = dwarf.unit.get_mut(id);
        entry.set(gimli::DW_AT_name, AttributeValue::String(text(&function.name)));
        entry.set(gimli::DW_AT_low_pc, AttributeValue::Address(start(symbol)));
        entry.set(gimli::DW_AT_high_pc, AttributeValue::Udata(functions[symbol].bytes.len() as u64));
    }
    dwarf
}

/// A valid name for a table of strings: not empty, without a 0 byte.
pub fn text(name: &str) -> Vec<u8> {
    let bytes: Vec<u8> = name.bytes().filter(|&byte| byte != 0).collect();
    if bytes.is_empty() { b"?".to_vec() } else { bytes }
}

fn start(symbol: usize) -> Address {
    Address::Symbol { symbol, addend: 0 }
}

fn line_program(module: &Module, functions: &[CompiledFunction]) -> LineProgram {
    let name = |name: &str| LineString::String(text(name));
    let mut program =
        LineProgram::new(ENCODING, LineEncoding::default(), name(FOLDER), None, name(&module.files[0]), None);
    let folder = program.default_directory();
    let files: Vec<_> = module.files.iter().map(|file| program.add_file(name(file), folder, None)).collect();
    for (symbol, function) in functions.iter().enumerate() {
        let site = |place: u32| module.sites.get((place as usize).checked_sub(1)?);
        let mut places = function.places.iter().filter_map(|place| Some((place.at, site(place.site)?))).peekable();
        // Code before the first statement belongs to it.
        let Some(&(_, first)) = places.peek() else { continue };
        program.begin_sequence(Some(start(symbol)));
        let mut before = None;
        for (at, site) in std::iter::once((0, first)).chain(places) {
            // The first statement begins twice: with the function and after its prologue, where a debugger stops.
            if before == Some((site.file, site.line)) && program.row().address_offset > 0 {
                continue;
            }
            before = Some((site.file, site.line));
            let Some(&file) = files.get(site.file as usize) else { continue };
            let row = program.row();
            row.address_offset = u64::from(at);
            row.file = file;
            row.line = u64::from(site.line);
            program.generate_row();
        }
        program.end_sequence(function.bytes.len() as u64);
    }
    program
}

/// A section that is being written, with the places that the linker fills in.
#[derive(Clone)]
struct Section {
    bytes: EndianVec<LittleEndian>,
    relocations: Vec<Relocation>,
}

impl Default for Section {
    fn default() -> Self {
        Section { bytes: EndianVec::new(LittleEndian), relocations: Vec::new() }
    }
}

impl RelocateWriter for Section {
    type Writer = EndianVec<LittleEndian>;

    fn writer(&self) -> &Self::Writer {
        &self.bytes
    }

    fn writer_mut(&mut self) -> &mut Self::Writer {
        &mut self.bytes
    }

    fn relocate(&mut self, relocation: Relocation) {
        self.relocations.push(relocation);
    }
}

fn write_sections(
    object: &mut Object<'static>,
    sections: &Sections<Section>,
    symbols: &[SymbolId],
) -> Result<(), CodegenError> {
    let mut made: FxHashMap<SectionId, ObjectSection> = FxHashMap::default();
    let mut written = Vec::new();
    let result: Result<(), CodegenError> = sections.for_each(|id, section| {
        if !section.bytes.slice().is_empty() {
            let name = id.name().as_bytes().to_vec();
            let number = object.add_section(Vec::new(), name, SectionKind::Debug);
            object.append_section_data(number, section.bytes.slice(), 1);
            made.insert(id, number);
            written.push((number, section));
        }
        Ok(())
    });
    result?;
    for (number, section) in written {
        for relocation in &section.relocations {
            let symbol = match relocation.target {
                RelocationTarget::Symbol(index) => symbols[index],
                RelocationTarget::Section(id) => object.section_symbol(made[&id]),
            };
            let flags = RelocationFlags::Generic {
                kind: RelocationKind::Absolute,
                encoding: RelocationEncoding::Generic,
                size: relocation.size * 8,
            };
            let offset = relocation.offset as u64;
            object
                .add_relocation(number, ObjectRelocation { offset, symbol, addend: relocation.addend, flags })
                .map_err(|error| CodegenError::Output(format!("line table: {error}")))?;
        }
    }
    Ok(())
}
