//! Standard library: system functions and function blocks, and blocks of the libraries, as PLC source where possible.
//!
//! The sources are the declarations of all these blocks; the attribute `plcc` states where the code is. They are split into blocks
//! once, without parsing them: a program only pays for the blocks that it names.
//!
//! - SFC, SFB below [`TIA_NUMBERS`]: blocks of the CPU, by number and name.
//! - FC, FB: blocks of the libraries of STEP 7 V5, by number and name. A block of the program with the same number replaces it.
//! - SFC, SFB from [`TIA_NUMBERS`] on: instructions of the TIA Portal, which have a name but no number; see [`find_tia`].

mod absent;
mod library;

use std::sync::OnceLock;

pub use absent::{Group, absent_system_block, absent_type, catalogued};
pub use library::{LIBRARY, LibraryBlock};

/// Language of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Language {
    Stl,
    Scl,
}

/// Sources of the blocks.
const SOURCES: &[(Language, &str)] = &[
    (Language::Stl, include_str!("../stl/sfc.stl")),
    (Language::Stl, include_str!("../stl/sfb.stl")),
    (Language::Scl, include_str!("../scl/clock.scl")),
    (Language::Scl, include_str!("../scl/errors.scl")),
    (Language::Scl, include_str!("../scl/technology.scl")),
    (Language::Scl, include_str!("../scl/variants.scl")),
    (Language::Stl, include_str!("../stl/primitives.stl")),
    (Language::Stl, include_str!("../stl/strings.stl")),
    (Language::Stl, include_str!("../stl/dates.stl")),
    (Language::Scl, include_str!("../scl/technology_parts.scl")),
    (Language::Stl, include_str!("../stl/selection.stl")),
    (Language::Stl, include_str!("../stl/tia_strings.stl")),
    (Language::Stl, include_str!("../stl/tia_numbers.stl")),
    (Language::Scl, include_str!("../scl/texts.scl")),
    (Language::Scl, include_str!("../scl/wide_texts.scl")),
    (Language::Scl, include_str!("../scl/long_texts.scl")),
    (Language::Scl, include_str!("../scl/names.scl")),
    (Language::Scl, include_str!("../scl/overloads.scl")),
    (Language::Scl, include_str!("../scl/scaling.scl")),
    (Language::Scl, include_str!("../scl/bits.scl")),
    (Language::Scl, include_str!("../scl/instances.scl")),
    (Language::Scl, include_str!("../scl/iec.scl")),
    (Language::Scl, include_str!("../scl/drum.scl")),
    (Language::Scl, include_str!("../scl/converting.scl")),
    (Language::Scl, include_str!("../scl/communication.scl")),
    (Language::Scl, include_str!("../scl/connections.scl")),
    (Language::Scl, include_str!("../scl/udp.scl")),
    (Language::Scl, include_str!("../scl/classic_connections.scl")),
    (Language::Scl, include_str!("../scl/s7_connections.scl")),
    (Language::Scl, include_str!("../scl/hardware.scl")),
    (Language::Scl, include_str!("../scl/web.scl")),
    (Language::Scl, include_str!("../scl/opcua_methods.scl")),
    (Language::Scl, include_str!("../scl/modbus.scl")),
    (Language::Scl, include_str!("../scl/modbus_serial.scl")),
    (Language::Scl, include_str!("../scl/serial.scl")),
    (Language::Scl, include_str!("../scl/serial_settings.scl")),
    (Language::Scl, include_str!("../scl/uss.scl")),
    (Language::Scl, include_str!("../scl/motion/axis.scl")),
    (Language::Scl, include_str!("../scl/motion/commands.scl")),
    (Language::Scl, include_str!("../scl/motion/sequences.scl")),
    (Language::Scl, include_str!("../scl/motion/parts.scl")),
    (Language::Scl, include_str!("../scl/records.scl")),
    (Language::Scl, include_str!("../scl/data_blocks.scl")),
    (Language::Scl, include_str!("../scl/alarms.scl")),
    (Language::Scl, include_str!("../scl/module_records.scl")),
    (Language::Scl, include_str!("../scl/partners.scl")),
    (Language::Scl, include_str!("../scl/pid/compact.scl")),
    (Language::Scl, include_str!("../scl/pid/step3.scl")),
    (Language::Scl, include_str!("../scl/pid/temp.scl")),
    (Language::Scl, include_str!("../scl/pid/cont_c.scl")),
    (Language::Scl, include_str!("../scl/pid/cont_s.scl")),
    (Language::Scl, include_str!("../scl/pid/pulsegen.scl")),
    (Language::Scl, include_str!("../scl/pid/tcont_cp.scl")),
    (Language::Scl, include_str!("../scl/pid/tcont_s.scl")),
];

/// SFCs and SFBs from this number on are instructions of the TIA Portal. No program calls them by number.
pub const TIA_NUMBERS: u16 = 1000;

/// SFCs from this number on are parts of other blocks of the library, which no program calls.
const PART_NUMBERS: u16 = 2000;

/// The actual name of a component of an SFB's instance that programs call by another name, as exports of the TIA Portal do.
///
/// `instance`: whether an SFB, and the number. The counters of one type share a layout, in which QU and QD are separate outputs.
pub fn own_member(instance: Option<(bool, u16)>, name: &str) -> Option<&'static str> {
    let Some((true, number)) = instance else { return None };
    if number < TIA_NUMBERS {
        return None;
    }
    let block = find(BlockClass::Sfb, number)?.name;
    let is = |own: &str| name.trim().eq_ignore_ascii_case(own);
    match block {
        "R_TRIG" | "F_TRIG" if is("Stat_Bit") => Some("OLD"),
        _ if block.starts_with("CTU_") && is("QU") => Some("Q"),
        _ if block.starts_with("CTD_") && is("QD") => Some("Q"),
        _ => None,
    }
}

/// True of a parameter that a timer or counter has only because all of them share a layout: R of timers belongs to TONR alone, and
/// CD, LD and QD do not belong to CTU, nor CU, R and QU to CTD.
pub fn is_shared_input(block: &SystemBlock, name: &str) -> bool {
    let timer = block.name.trim_end_matches("_LTIME");
    let shared: &[&str] = match timer {
        "TP" | "TON" | "TOF" => &["R"],
        counter if counter.starts_with("CTU_") => &["CD", "LD", "LOAD", "QD"],
        counter if counter.starts_with("CTD_") => &["CU", "R", "QU"],
        _ => &[],
    };
    block.is_tia() && shared.iter().any(|own| own.eq_ignore_ascii_case(name))
}

/// True of a parameter whose pointer names an area of a partner, which need not exist here.
pub fn is_of_partner(block: &SystemBlock, parameter: &str) -> bool {
    matches!(block.name, "GET" | "PUT" | "GET_E" | "PUT_E") && parameter.to_ascii_uppercase().starts_with("ADDR_")
}

/// Where the code of a block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// In the source itself.
    Source,
    /// In the runtime, under the block's number.
    Runtime,
    /// Nowhere: using it is reported.
    NotShipped,
}

/// Kind of a block of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BlockClass {
    Fc,
    Fb,
    Sfc,
    Sfb,
}

impl BlockClass {
    /// The kind with these letters, `"SFC"`; `None`: the library has no such blocks.
    pub fn of_letters(letters: &str) -> Option<BlockClass> {
        match letters {
            "FC" => Some(BlockClass::Fc),
            "FB" => Some(BlockClass::Fb),
            "SFC" => Some(BlockClass::Sfc),
            "SFB" => Some(BlockClass::Sfb),
            _ => None,
        }
    }
}

/// A block of the standard library.
#[derive(Clone, Copy, Debug)]
pub struct SystemBlock {
    pub class: BlockClass,
    pub number: u16,
    /// Standard name, `BLKMOV`.
    pub name: &'static str,
    /// The block's own source.
    pub source: &'static str,
    /// The comment above it, or at its head, as written there: what the block does.
    pub comment: &'static str,
    /// Where its behaviour is described: the text after `Source:` at the head of its file, including `//` of following lines.
    pub origin: &'static str,
    pub form: Form,
    pub language: Language,
}

impl SystemBlock {
    /// True of instructions of the TIA Portal, which have no number for the user.
    pub fn is_tia(&self) -> bool {
        self.number >= TIA_NUMBERS && matches!(self.class, BlockClass::Sfc | BlockClass::Sfb)
    }

    /// What the block does: its comment without signs, up to the source of what it says.
    pub fn description(&self) -> String {
        let told = self.comment.lines().take_while(|line| !line.starts_with("// Source: "));
        let lines: Vec<&str> = told.map(|line| line.trim_start_matches("//").trim()).collect();
        lines.join("\n").trim().to_string()
    }

    /// True of a part of other blocks, which only the library calls.
    pub fn is_part(&self) -> bool {
        self.number >= PART_NUMBERS && self.class == BlockClass::Sfc
    }
}

/// All blocks.
pub fn blocks() -> &'static [SystemBlock] {
    static BLOCKS: OnceLock<Vec<SystemBlock>> = OnceLock::new();
    BLOCKS.get_or_init(|| SOURCES.iter().flat_map(|(language, source)| index(*language, source)).collect())
}

/// The block with this kind and number.
pub fn find(class: BlockClass, number: u16) -> Option<&'static SystemBlock> {
    blocks().iter().find(|block| block.class == class && block.number == number)
}

/// Blocks of libraries that are found only by their names have their numbers of STEP 7 plus this one: there other blocks are more common.
const NAMED_NUMBERS: u16 = 5000;

/// The block with this kind and number in STEP 7 that is found only by its name: FC 5 is AG_SEND.
pub fn find_named(class: BlockClass, number: u16) -> Option<&'static SystemBlock> {
    find(class, number.checked_add(NAMED_NUMBERS)?)
}

/// Names of the IEC functions in symbol tables, FC 1 to FC 40, with their standard names.
#[rustfmt::skip]
const LONG_NAMES: &[(&str, &str)] = &[
    ("ADD DT TIME", "AD_DT_TM"),
    ("DT plus TIME", "AD_DT_TM"),
    ("ADD DT and TIME", "AD_DT_TM"),
    ("DATE and TOD to DT", "D_TOD_DT"),
    ("DI to STRING", "DI_STRNG"),
    ("DINT to STRING", "DI_STRNG"),
    ("DT to DATE", "DT_DATE"),
    ("DT to DAY", "DT_DAY"),
    ("DT to TOD", "DT_TOD"),
    ("EQ DT", "EQ_DT"),
    ("EQ STRING", "EQ_STRNG"),
    ("GE DT", "GE_DT"),
    ("GE STRING", "GE_STRNG"),
    ("GT DT", "GT_DT"),
    ("GT STRING", "GT_STRNG"),
    ("I to STRING", "I_STRNG"),
    ("INT to STRING", "I_STRNG"),
    ("LE DT", "LE_DT"),
    ("LE STRING", "LE_STRNG"),
    ("LT DT", "LT_DT"),
    ("LT STRING", "LT_STRNG"),
    ("NE DT", "NE_DT"),
    ("NE STRING", "NE_STRNG"),
    ("R to STRING", "R_STRNG"),
    ("REAL to STRING", "R_STRNG"),
    ("S5TIME to TIME", "S5TI_TIM"),
    ("SUB DT DT", "SB_DT_DT"),
    ("DT minus DT", "SB_DT_DT"),
    ("SUB DT and DT", "SB_DT_DT"),
    ("SUB DT TIME", "SB_DT_TM"),
    ("DT minus TIME", "SB_DT_TM"),
    ("SUB DT and TIME", "SB_DT_TM"),
    ("STRING to DI", "STRNG_DI"),
    ("STRING to DINT", "STRNG_DI"),
    ("STRING to I", "STRNG_I"),
    ("STRING to INT", "STRNG_I"),
    ("STRING to R", "STRNG_R"),
    ("STRING to REAL", "STRNG_R"),
    ("TIME to S5TIME", "TIM_S5TI"),
];

/// Older names of instructions of the TIA Portal.
const OLDER_NAMES: &[(&str, &str)] = &[
    ("MB_COMM_LOAD", "Modbus_Comm_Load"),
    ("MB_MASTER", "Modbus_Master"),
    ("MB_SLAVE", "Modbus_Slave"),
    ("USS_DRV", "USS_Drive_Control"),
    ("USS_RPM", "USS_Read_Param"),
    ("USS_WPM", "USS_Write_Param"),
];

/// The standard name of a block that symbol tables call by a longer one, `DT to DATE` for DT_DATE; otherwise the name itself.
pub fn standard_name(name: &str) -> &str {
    LONG_NAMES.iter().find(|(long, _)| long.eq_ignore_ascii_case(name.trim())).map_or(name, |(_, short)| short)
}

/// SFBs that only compact CPUs have, CPU 31xC: CONT_C, CONT_S and PULSEGEN. Elsewhere these are FBs of a library.
const OF_COMPACT_CPUS: std::ops::RangeInclusive<u16> = 41..=43;

/// A block of the CPU or of a library of STEP 7 V5 by standard name, in any letter case. A block of the CPU has priority, unless only
/// compact CPUs have it.
pub fn find_name(name: &str) -> Option<&'static SystemBlock> {
    let name = standard_name(name);
    blocks()
        .iter()
        .filter(|block| !block.is_tia() && block.name.eq_ignore_ascii_case(name))
        .filter(|block| block.class != BlockClass::Sfb || !OF_COMPACT_CPUS.contains(&block.number))
        .max_by_key(|block| block.class)
}

/// The block of the CPU or of a library of STEP 7 V5 that a program calls by a number with these letters: TON of `SFB 4`.
///
/// `symbol`: the name of that number in the program. `None`: there is no such block, or the symbol says that the number is that of another
/// one. Blocks of the CPU cannot be replaced.
pub fn find_numbered(letters: &str, number: u32, symbol: Option<&str>) -> Option<&'static SystemBlock> {
    let class = BlockClass::of_letters(letters)?;
    let block = find(class, u16::try_from(number).ok()?)?;
    let is_of_cpu = matches!(class, BlockClass::Sfc | BlockClass::Sfb);
    let is_same = |name: &str| standard_name(name).eq_ignore_ascii_case(block.name);
    (!block.is_tia() && (is_of_cpu || symbol.is_none_or(is_same))).then_some(block)
}

/// An instruction of the TIA Portal by name, also an older one, in any letter case.
pub fn find_tia(name: &str) -> Option<&'static SystemBlock> {
    let older = OLDER_NAMES.iter().find(|(older, _)| older.eq_ignore_ascii_case(name.trim()));
    let name = older.map_or(name, |(_, name)| name);
    blocks().iter().find(|block| block.is_tia() && block.name.eq_ignore_ascii_case(name))
}

/// An attribute line of an FB that is also an SFB, followed by its number.
const ALSO_SFB: &str = "{ plcc_also := 'SFB ";

/// Splits a source at its block frames, which begin and end at the start of a line.
fn index(language: Language, source: &'static str) -> Vec<SystemBlock> {
    let mut found = Vec::new();
    let origin = source.split_once("Source: ").map_or("", |(_, rest)| rest.split("\n//\n").next().unwrap_or(""));
    let lines_end = origin.split_inclusive('\n').enumerate();
    let lines = lines_end.take_while(|(at, line)| *at == 0 || line.starts_with("//")).map(|(_, line)| line.len()).sum();
    let origin = &origin[..lines];
    let mut start = None;
    let mut comment = 0;
    let mut at = 0;
    for line in source.split_inclusive('\n') {
        let end = at + line.len();
        if line.starts_with("FUNCTION") {
            start = Some(at);
        } else if line.starts_with("END_FUNCTION")
            && let Some(start) = start.take()
        {
            let block = described(language, &source[start..end]);
            let block = block.map(|block| SystemBlock {
                comment: if comment < start { &source[comment..start] } else { inner_comment(block.source) },
                origin,
                ..block
            });
            found.extend(block);
            // The CPU also has some library FBs as SFBs.
            let also = block.and_then(|block| block.source.lines().find_map(|line| line.strip_prefix(ALSO_SFB)));
            let number = also.and_then(|rest| rest.split('\'').next()?.parse().ok());
            found.extend(block.zip(number).map(|(block, number)| SystemBlock {
                class: BlockClass::Sfb,
                number,
                ..block
            }));
        }
        if start.is_none() && !line.starts_with("//") {
            comment = end;
        }
        at = end;
    }
    found
}

/// The first comment inside a block: consecutive lines.
fn inner_comment(source: &'static str) -> &'static str {
    let Some(start) = source.find("\n//") else { return "" };
    let text = &source[start + 1..];
    let length = text.split_inclusive('\n').take_while(|line| line.starts_with("//")).map(str::len).sum();
    &text[..length]
}

/// Reads kind, number, name and form of the block `source`.
fn described(language: Language, source: &'static str) -> Option<SystemBlock> {
    let mut words = source.split_whitespace().skip(1);
    let class = BlockClass::of_letters(words.next()?)?;
    let number = words.next()?.parse().ok()?;
    let name = source.lines().find_map(|line| line.strip_prefix("NAME : "))?.trim();
    let form = match source.lines().find_map(|line| line.strip_prefix("{ plcc := '"))?.split('\'').next()? {
        "source" => Form::Source,
        "runtime" => Form::Runtime,
        _ => Form::NotShipped,
    };
    Some(SystemBlock { class, number, name, source, comment: "", origin: "", form, language })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_is_indexed() {
        let count = |text: &str| SOURCES.iter().map(|(_, source)| source.matches(text).count()).sum::<usize>();
        let frames = count("\nEND_FUNCTION") + count(ALSO_SFB);
        assert_eq!(blocks().len(), frames);
    }

    #[test]
    fn by_name_and_number() {
        assert_eq!(find_name("blkmov").map(|block| (block.class, block.number)), Some((BlockClass::Sfc, 20)));
        assert_eq!(find(BlockClass::Sfb, 4).map(|block| (block.name, block.form)), Some(("TON", Form::Source)));
        assert_eq!(find(BlockClass::Sfc, 64).map(|block| block.form), Some(Form::Runtime));
        assert_eq!(find(BlockClass::Sfc, 78).map(|block| block.form), Some(Form::NotShipped));
        assert!(find(BlockClass::Sfc, 9999).is_none());
        assert!(find_tia("JOB_STATE").is_some_and(|block| block.is_part()));
        assert!(find_tia("FileDelete").is_some_and(|block| !block.is_part()));
        let numbered = |letters, number, symbol| find_numbered(letters, number, symbol).map(|block| block.name);
        assert_eq!(numbered("FC", 105, None), Some("SCALE"));
        assert_eq!(numbered("FC", 6, Some("DT to DATE")), Some("DT_DATE"));
        assert_eq!(numbered("FC", 105, Some("Own")), None);
        assert_eq!(numbered("SFB", 4, Some("Own")), Some("TON"));
        assert_eq!(numbered("SFC", TIA_NUMBERS.into(), None), None);
        assert_eq!(numbered("DB", 4, None), None);
        assert_eq!(find_named(BlockClass::Fb, 14).map(|block| block.name), Some("GET"));
        assert_eq!(find_named(BlockClass::Fc, 5).map(|block| block.name), Some("AG_SEND"));
    }

    #[test]
    fn names_and_numbers_are_unique() {
        for (at, block) in blocks().iter().enumerate() {
            for other in &blocks()[at + 1..] {
                assert!((block.class, block.number) != (other.class, other.number), "{}", block.name);
                let same_space = (block.class, block.is_tia()) == (other.class, other.is_tia());
                assert!(!same_space || block.name != other.name, "{}", block.name);
            }
        }
    }
}
