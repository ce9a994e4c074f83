//! The numbers that blocks state: by their names, by attributes, by the names of their files.

use plcc_abi::ob::{OB_FREE, ObClass};
use plcc_diag::{FileId, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix, CodeKind};
use plcc_syntax::scl::ast::Dialect;
use plcc_syntax::symbols::{SymbolTarget, parse_address};
use rustc_hash::FxHashMap;

use crate::bind::trees::blocks::{block_class, class_of_inputs, dialect, header_of, is_forward};

pub const fn source_prefix(kind: CodeKind) -> BlockPrefix {
    match kind {
        CodeKind::Ob => BlockPrefix::Ob,
        CodeKind::Fc => BlockPrefix::Fc,
        CodeKind::Fb => BlockPrefix::Fb,
        CodeKind::Sfc => BlockPrefix::Sfc,
        CodeKind::Sfb => BlockPrefix::Sfb,
    }
}

/// Prefix, number and name of a block of the sources.
pub fn frame(block: &ast::Block) -> (BlockPrefix, &BlockName) {
    match block {
        ast::Block::Code(code) => (source_prefix(code.kind), &code.name),
        ast::Block::Data(data) => (BlockPrefix::Db, &data.name),
        ast::Block::Type(ty) => (BlockPrefix::Udt, &ty.name),
    }
}

/// What is said of statements without a block, and what to do.
pub const LOOSE: &str = "these statements are in no block, so they are OB 1";
pub const LOOSE_HELP: &str = "put these statements into a block, or remove them";

/// Whether `name` is that of an OB 1 made of statements without a block: nobody has written it.
pub fn is_loose(prefix: BlockPrefix, name: Span) -> bool {
    prefix == BlockPrefix::Ob && name.start == name.end
}

/// The name of a block with its number, if the text states it: `FC10` in one word, a number next to the name, the attribute `S7_BlockNumber`, an OB by its usual
/// name. Also whether the number may change if a block already has it.
pub fn numbered(block: &ast::Block, prefix: BlockPrefix, name: &BlockName) -> (BlockName, bool) {
    let BlockName::Symbol { name: text, span } = name else { return (name.clone(), false) };
    let header = header_of(block);
    let written = match parse_address(text) {
        Some(SymbolTarget::Block { prefix: named, number }) if named == prefix => Some(number),
        _ => None,
    };
    let attribute = header
        .attributes
        .iter()
        .find(|(name, _)| NUMBER_ATTRIBUTES.iter().any(|number| number.eq_ignore_ascii_case(name)))
        .and_then(|(_, value)| value.trim().trim_matches(['\'', '"']).parse().ok());
    let usual = || match prefix {
        BlockPrefix::Ob => {
            ob_number(text).or_else(|| number_of_start_information(block)).or_else(|| number_in_name(block, text))
        }
        _ => None,
    };
    let said = written.or(header.number).or(attribute);
    let movable = header.auto_number || said.is_none();
    match said.or_else(usual) {
        Some(number) => (BlockName::Numbered { prefix, number, span: *span }, movable),
        None => (name.clone(), false),
    }
}

/// The number and the class of an organization block, as its name, its attributes or its inputs tell them.
pub fn told_ob(block: &ast::Block) -> (Option<u32>, Option<ObClass>) {
    let (prefix, name) = frame(block);
    let number = match numbered(block, prefix, name).0 {
        BlockName::Numbered { number, .. } => Some(number),
        BlockName::Symbol { .. } => None,
    };
    (number, block_class(block).or_else(|| class_of_inputs(block)))
}

/// Whether the sources contain organization blocks that only CPUs of the TIA Portal have: from OB 123 on, by their numbers, or because there are
/// more of a class than it has numbers.
pub fn has_free_obs(units: &[(FileId, ast::SourceUnit)]) -> bool {
    let mut classes: FxHashMap<ObClass, u16> = FxHashMap::default();
    let blocks = units.iter().flat_map(|(_, unit)| &unit.blocks);
    for block in blocks.filter(|block| !is_forward(block)) {
        let ast::Block::Code(code) = block else { continue };
        let tia = dialect(code) == Some(Dialect::Tia) || code.header.auto_number;
        if code.kind != CodeKind::Ob || !tia {
            continue;
        }
        let class = match numbered(block, BlockPrefix::Ob, &code.name).0 {
            BlockName::Numbered { number, .. } if number >= u32::from(OB_FREE) => return true,
            BlockName::Numbered { number, .. } => ObClass::of_number(number as u16),
            BlockName::Symbol { .. } => block_class(block).or(Some(ObClass::ProgramCycle)),
        };
        if let Some(class) = class {
            let count = classes.entry(class).or_insert(0);
            *count += 1;
            let (first, last) = class.row().numbers;
            let places = if class == ObClass::Startup { 1 } else { last - first + 1 };
            if *count > places {
                return true;
            }
        }
    }
    false
}

/// The block that the name of a file, or of a block, states: `FC19_Name`, `OB1_MAIN`, `FB 3`.
pub fn block_of_file(stem: &str) -> Option<(BlockPrefix, u32)> {
    let stem = stem.trim();
    let letters = stem.get(..2)?;
    let prefix = [BlockPrefix::Ob, BlockPrefix::Fc, BlockPrefix::Fb]
        .into_iter()
        .find(|prefix| prefix.letters().eq_ignore_ascii_case(letters))?;
    let rest = stem[2..].trim_start_matches([' ', '_', '-']);
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    if rest[digits..].starts_with(char::is_alphanumeric) {
        return None;
    }
    Some((prefix, rest[..digits].parse().ok()?))
}

/// Names that STEP 7 and the TIA Portal give to organization blocks, and their numbers: the first one, and how many there are. Further
/// ones are called `_1`, `_2`; in STEP 7 they are counted from 0, `Cyclic Interrupt 5`, `CYC_INT5`.
#[rustfmt::skip]
const OB_NAMES: &[(&str, u32, u32)] = &[
    ("Cycle Execution", 1, 1), ("CYCL_EXC", 1, 1), ("TOD_INT", 10, 8), ("Time of Day Interrupt", 10, 8), ("DEL_INT", 20, 4),
    ("CYC_INT", 30, 9), ("HW_INT", 40, 8), ("MP_INT", 60, 1), ("Multicomputing Interrupt", 60, 1), ("Multiprocessing Interrupt", 60, 1),
    ("I/O Redundancy Error", 70, 1), ("CPU Redundancy Error", 72, 1), ("Communication Redundancy Error", 73, 1),
    ("CYCL_FLT", 80, 1), ("Cycle Time Fault", 80, 1), ("Time Error", 80, 1), ("PS_FLT", 81, 1), ("Power Supply Fault", 81, 1),
    ("I/O_FLT1", 82, 1), ("I/O Point Fault 1", 82, 1), ("I/O_FLT2", 83, 1), ("I/O Point Fault 2", 83, 1), ("CPU_FLT", 84, 1),
    ("CPU Fault", 84, 1), ("OBNL_FLT", 85, 1), ("OB Not Loaded Fault", 85, 1), ("RACK_FLT", 86, 1), ("Loss of Rack Fault", 86, 1),
    ("COMM_FLT", 87, 1), ("Communication Fault", 87, 1), ("BACKGRND", 90, 1), ("Background Cycle", 90, 1), ("Background", 90, 1),
    ("Complete Restart", 100, 1), ("Warm Restart", 100, 1), ("Restart", 101, 1), ("Hot Restart", 101, 1),
    ("Cold Restart", 102, 1), ("PROG_ERR", 121, 1), ("MOD_ERR", 122, 1), ("Module Access Error", 122, 1),
    ("Main", 1, 1), ("Startup", 100, 1), ("Cyclic interrupt", 30, 9), ("Time of day", 10, 8),
    ("Time delay interrupt", 20, 4), ("Hardware interrupt", 40, 8), ("Status", 55, 1), ("Update", 56, 1), ("Profile", 57, 1),
    ("Time error interrupt", 80, 1), ("Diagnostic error interrupt", 82, 1), ("Pull or plug of modules", 83, 1),
    ("Rack or station failure", 86, 1), ("Programming error", 121, 1), ("IO access error", 122, 1),
    ("Synchronous Cycle", 61, 4), ("MC-PreServo", 67, 1), ("MC-PreInterpolator", 68, 1),
    ("MC-Servo", 91, 1), ("MC-Interpolator", 92, 1), ("MC-PostServo", 95, 1), ("MC-LookAhead", 97, 1), ("MC-Transformation", 98, 1),
];

/// The number of an organization block by its usual name.
fn ob_number(name: &str) -> Option<u32> {
    let name = name.trim();
    let row = |base: &str| OB_NAMES.iter().find(|(usual, ..)| usual.eq_ignore_ascii_case(base));
    if let Some((_, first, _)) = row(name) {
        return Some(*first);
    }
    let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let index: u32 = name[base.len()..].parse().ok()?;
    let (_, first, count) = row(base.trim_end_matches(['_', ' ']))?;
    (index < *count).then_some(first + index)
}

/// The number with which the name of an organization block begins, `OB35_PID`: in sources of the TIA Portal and in STL. It says what starts the block,
/// so the block must not state something else.
fn number_in_name(block: &ast::Block, name: &str) -> Option<u32> {
    let ast::Block::Code(code) = block else { return None };
    let (prefix, number) = block_of_file(name)?;
    let class = ObClass::of_number(u16::try_from(number).ok()?)?;
    let stated = block_class(block).or_else(|| class_of_inputs(block)).unwrap_or(class);
    (prefix == BlockPrefix::Ob && dialect(code) != Some(Dialect::Classic) && stated == class).then_some(number)
}

/// The number of an organization block by the names of its start information: `OB35_EV_CLASS`.
fn number_of_start_information(block: &ast::Block) -> Option<u32> {
    let ast::Block::Code(code) = block else { return None };
    let temporary = code.sections.iter().find(|section| section.kind == ast::SectionKind::Temp)?;
    let name = &temporary.variables.first()?.name;
    let digits = name.get(..2).filter(|letters| letters.eq_ignore_ascii_case("OB")).and_then(|_| name.get(2..))?;
    digits.split_once('_')?.0.parse().ok()
}

/// Attributes with the number of a block that is written with a name.
const NUMBER_ATTRIBUTES: [&str; 2] = ["S7_BlockNumber", "BlockNumber"];
