//! Messages of binding, with one list of all names that are defined nowhere.
//!
//! - `meant`: what such a name may mean.
//! - `absent`: blocks and instructions that plcc does not have.

mod absent;
mod meant;

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::ast::BlockPrefix;
use plcc_syntax::symbols::{NO_ADDRESS, QUOTE_MISSING, UnreadableRow};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::{fold, similar};
use absent::{absent_instruction, absent_system_block, catalogued_instruction};
use meant::{
    foreign_type, foreign_value, is_constant, is_duration, misread_address, of_the_portal, register_of_stl,
    system_function, time_without_sign,
};

pub use meant::{bit_without_number, hexadecimal, known_type};

/// Up to this number, a block number alone does not point to a library block.
const LOW_NUMBERS: u16 = 40;

/// For how many missing names a similar one is looked for.
const SEARCHES_MAX: usize = 200;

/// The messages so far.
pub struct Report {
    pub diagnostics: Vec<Diagnostic>,
    missing: Vec<Missing>,
    index: FxHashMap<MissingKey, usize>,
    partial: bool,
    /// How often a similar name was looked for.
    searches: usize,
    /// Data blocks whose number no source states.
    pub unnumbered_dbs: Vec<String>,
    /// Bytes of the clock memory and of the system memory, if they are configured.
    pub memory_bytes: [Option<u16>; 2],
}

/// A name or block that is used but defined nowhere.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum MissingKey {
    /// A symbol or a data type, folded.
    Symbol(String),
    /// A name where the compiler must know the value, folded.
    Constant(String),
    /// A local name of statements without a header, folded.
    Local(String),
    /// A block to call.
    Block(BlockPrefix, u16),
    /// A block of the CPU or of a library that plcc does not have, by number.
    NotShipped(BlockPrefix, u16),
    /// A data block addressed by number.
    Db(u16),
    /// A data block whose components are named.
    DbLayout(u16),
}

/// A missing name or block, and where it is used.
pub struct Uses {
    pub key: MissingKey,
    pub diagnostic: Diagnostic,
    pub places: Vec<Span>,
}

struct Missing {
    key: MissingKey,
    diagnostic: Diagnostic,
    /// Where it is used, each position once even if it is visited several times.
    places: FxHashSet<Span>,
}

impl Report {
    /// No messages yet. `partial`: see [`Report::partial`].
    pub fn new(partial: bool) -> Report {
        Report {
            diagnostics: Vec::new(),
            missing: Vec::new(),
            index: FxHashMap::default(),
            partial,
            searches: 0,
            unnumbered_dbs: Vec::new(),
            memory_bytes: [None; 2],
        }
    }

    /// The sources are a part of a program: what is undefined may be in the rest.
    pub fn partial(&self) -> bool {
        self.partial
    }

    /// No error was reported, and nothing is undefined.
    pub fn is_clean(&self) -> bool {
        self.missing.is_empty() && !self.diagnostics.iter().any(Diagnostic::is_error)
    }

    /// Adds a message.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Notes a use of an undefined name or block; it is reported once, at its first use in the sources.
    pub fn missing(&mut self, key: MissingKey, span: Span, make: impl FnOnce() -> Diagnostic) {
        match self.index.get(&key) {
            Some(&at) => {
                let known = &mut self.missing[at];
                known.places.insert(span);
                let first = known.diagnostic.primary.span;
                if (span.file, span.start) < (first.file, first.start) {
                    known.diagnostic = make();
                }
            }
            None => {
                self.index.insert(key.clone(), self.missing.len());
                self.missing.push(Missing { key, diagnostic: make(), places: [span].into_iter().collect() });
            }
        }
    }

    /// Whether to look for a name that resembles a missing one; false: that has been done often enough.
    pub fn may_search(&mut self) -> bool {
        self.searches += 1;
        self.searches <= SEARCHES_MAX
    }

    /// `meant`: a name that resembles it. `in_stl`: an operand of STL.
    pub fn missing_symbol(&mut self, name: &str, span: Span, meant: Option<String>, in_stl: bool) {
        if let Some(message) = block_without_number(name, span) {
            return self.push(message);
        }
        let memory_bytes = self.memory_bytes;
        self.missing(MissingKey::Symbol(fold(name)), span, || {
            let message = Diagnostic::new(Code::UnknownSymbol, span, format!("the symbol `{name}` is not defined"))
                .label("no symbol table and no block has this name");
            if let Some(help) = bit_without_number(name, &["I", "Q", "M", "E", "A", "SM"]) {
                return message.help(help);
            }
            let quoted = span.end - span.start == name.len() as u32 + 2;
            let is_number = |letters: &&str| {
                let head = name.get(..letters.len()).is_some_and(|head| head.eq_ignore_ascii_case(letters));
                head && name.len() > letters.len() && name[letters.len()..].bytes().all(|digit| digit.is_ascii_digit())
            };
            if quoted && BLOCKS.iter().any(is_number) {
                return message.help(format!(
                    "the number of a block has no quotes: write `{name}`, or add the source or the table that has this name"
                ));
            }
            if let Some(value) = foreign_value(name).filter(|_| !quoted) {
                return message.help(format!("write {value}"));
            }
            let is_result = ["BR", "BIE"].iter().any(|own| own.eq_ignore_ascii_case(name));
            if let Some(help) = register_of_stl(name).filter(|_| in_stl && !quoted && (meant.is_none() || is_result)) {
                return message.help(help);
            }
            if is_duration(name) {
                return message.help(format!("a time is written `T#{name}`, without quotes"));
            }
            if quoted && is_constant(name) {
                return message.help(format!("a constant has no quotes: write `{name}`"));
            }
            if let Some(time) = time_without_sign(name).filter(|_| !quoted && meant.is_none()) {
                return message.help(format!("if a time is meant, write `{time}`"));
            }
            if let Some(help) = of_the_portal(name, memory_bytes) {
                return message.help(help);
            }
            let meant = meant.filter(|_| !name.starts_with(|c: char| c.is_ascii_digit()));
            // A name in quotes is one of the program.
            let truth = || similar(name, ["TRUE", "FALSE"].into_iter()).filter(|_| !quoted);
            let meant = meant.or_else(|| truth().map(str::to_owned));
            // `M1_2` may well be a name.
            let may_be_name = name.contains('_') && (quoted || meant.is_some());
            match (misread_address(name).filter(|_| !may_be_name), meant, hexadecimal(name)) {
                (Some(address), ..) => message.help(format!("if you mean the address, write `{address}`")),
                (None, Some(meant), _) => message.help(format!("is `{meant}` meant?")),
                (None, None, Some(number)) => {
                    message.help(format!("a hexadecimal number begins with `16#`: write `{number}`"))
                }
                (None, None, None) if name.contains('~') => message.help(format!(
                    "sources do not contain hardware constants: add it to a tag table with its number from the TIA Portal, or its module to plc.toml with `name = \"{name}\"`",
                )),
                (None, None, None) => message.help(
                    "declare it in the block, add the symbol table of the project to the sources, or define the block",
                ),
            }
        });
    }

    /// A letter alone, which begins addresses: `FOR i := 1 TO 5` without a declaration of `i`.
    pub fn missing_letter(&mut self, letter: &str, span: Span) {
        self.missing(MissingKey::Symbol(fold(letter)), span, || {
            Diagnostic::new(Code::UnknownSymbol, span, format!("`{letter}` is not declared in this block"))
                .label("no variable has this name, and an address has a number after the letter")
                .help(format!("declare it, as in `{letter} : INT;` in a VAR_TEMP section"))
        });
    }

    /// A symbol whose row in the symbol table has no address.
    pub fn unreadable_symbol(&mut self, name: &str, span: Span, row: &UnreadableRow) {
        self.missing(MissingKey::Symbol(fold(name)), span, || {
            Diagnostic::new(Code::UnknownSymbol, span, format!("the symbol `{name}` has no address"))
                .label(match row.reason == NO_ADDRESS {
                    true => "no address was entered for it in the tag table",
                    false => "its row in the symbol table cannot be read",
                })
                .also(row.span, row.reason.clone())
                .help(match &row.meant {
                    _ if row.reason == QUOTE_MISSING => "write the missing `\"` in that row".to_owned(),
                    Some(address) => format!("write `{address}` into that row"),
                    None => "write an address such as `I 0.0`, `MW 10` or `FC 105` into that row".to_owned(),
                })
        });
    }

    /// A constant with a name that nothing defines.
    pub fn missing_constant(&mut self, name: &str, span: Span) {
        self.missing(MissingKey::Constant(fold(name)), span, || {
            Diagnostic::new(Code::ConstantRequired, span, format!("the constant `{name}` is not defined"))
                .label("a value that is known at compile time is expected here")
                .help(match span.end - span.start == name.len() as u32 + 2 {
                    true => format!(
                        "declare it first, in VAR CONSTANT or CONST, or add the tag table that has it; a text is written in single quotes: `'{name}'`"
                    ),
                    false => "declare it first, in VAR CONSTANT or CONST, add the tag table that has it, or write the number"
                        .to_owned(),
                })
        });
    }

    /// An instruction that STEP 7 or the TIA Portal has but plcc does not; false: no instruction has the name.
    pub fn missing_instruction(&mut self, name: &str, span: Span) -> bool {
        let Some(message) = absent_instruction(name, span) else { return false };
        self.missing(MissingKey::Symbol(fold(name)), span, || message);
        true
    }

    /// The same without elements of networks that text languages write in another way.
    pub fn missing_in_catalogue(&mut self, name: &str, span: Span) -> bool {
        let Some(message) = catalogued_instruction(name, span) else { return false };
        self.missing(MissingKey::Symbol(fold(name)), span, || message);
        true
    }

    /// A function of SCL whose name means nothing, or that plcc does not have.
    pub fn missing_function(&mut self, name: &str, span: Span, meant: Option<String>, known: bool) {
        self.missing(MissingKey::Symbol(fold(name)), span, || match known {
            true => Diagnostic::new(Code::NotShipped, span, format!("the function `{name}` is not supported"))
                .label("plcc knows this function but does not support it")
                .help("avoid it, or write a function that does the same"),
            false => {
                let message = Diagnostic::new(Code::UnknownBlock, span, format!("the block `{name}` is not defined"))
                    .label("neither a block of the program nor a function of SCL");
                match meant {
                    Some(other) => message.help(format!("is `{other}` meant?")),
                    None => message.help("add the source that defines it, or the symbol table that names it"),
                }
            }
        });
    }

    /// A call of a data block that nothing defines, by a name that begins with that of the function block `fb`.
    pub fn missing_instance(&mut self, name: &str, fb: &str, span: Span, help: String) {
        self.missing(MissingKey::Symbol(fold(name)), span, || {
            Diagnostic::new(Code::UnknownBlock, span, format!("the instance `{name}` is not defined"))
                .label(format!("no data block of `{fb}` has this name"))
                .help(help)
        });
    }

    /// A block of the program with the name of a library block, but other parameters.
    pub fn missing_own(&mut self, name: &str, span: Span) {
        self.missing(MissingKey::Symbol(fold(name)), span, || {
            Diagnostic::new(Code::UnknownBlock, span, format!("the block `{name}` is not defined"))
                .label("the library block with this name has other parameters, so this must be a block of the program")
                .help("add the source that defines it")
        });
    }

    /// `shown`: the name as written; `meant`: a type of the program that resembles it.
    pub fn missing_type(&mut self, name: &str, shown: &str, span: Span, meant: Option<String>) {
        self.missing(MissingKey::Symbol(fold(name)), span, || {
            if let Some(message) = block_without_number(shown, span).or_else(|| absent_instruction(name, span)) {
                return message;
            }
            if let Some(known) = plcc_stdlib::absent_type(name) {
                let title = format!("`{known}` is a data type of the TIA Portal that plcc does not have");
                return Diagnostic::new(Code::UnknownType, span, title)
                    .label("a data type of the system")
                    .help("write a data type with this name that has the components which the program uses");
            }
            let title = format!("the data type `{shown}` is not defined");
            // A name in quotes is one of the program.
            let is_quoted = span.end - span.start == shown.len() as u32 + 2;
            if !is_quoted && let Some(function) = system_function(shown) {
                return Diagnostic::new(Code::UnknownType, span, title)
                    .label("a function, which has no instance")
                    .help(format!("remove the variable, and call the function by its name: `{function}( … );`"));
            }
            let message = Diagnostic::new(Code::UnknownType, span, title)
                .label("neither a data type nor a UDT or FB of the program");
            if let Some(ty) = foreign_type(name) {
                return message.help(format!("write `{ty}`"));
            }
            // Data of timers, whose blocks have shorter names.
            const TIMERS: [&str; 6] = ["IEC_TIMER", "TON_TIME", "TOF_TIME", "TP_TIME", "TONR_TIME", "IEC_COUNTER"];
            let instructions = plcc_stdlib::blocks()
                .iter()
                .filter(|block| block.is_tia() && block.class == plcc_stdlib::BlockClass::Sfb)
                .map(|block| block.name)
                .chain(TIMERS);
            let meant = meant.or_else(|| known_type(name).map(str::to_owned));
            message.help(match meant.or_else(|| similar(name, instructions).map(str::to_owned)) {
                Some(ty) => format!("is `{ty}` meant? Otherwise add the source that defines it"),
                None => "add the source that defines it".to_owned(),
            })
        });
    }

    /// `text`: the name of a data type where a block or a variable is expected. A block may have the name of a type.
    pub fn missing_beside_type(&mut self, text: &str, span: Span) {
        self.missing(MissingKey::Symbol(fold(text.trim_matches('"'))), span, || {
            Diagnostic::new(Code::OperandKind, span, format!("`{text}` is a data type"))
                .label("a data block, a function or a variable is expected here")
                .help("declare a variable of this type, or add the source of the block that has the same name")
        });
    }

    /// A block to call that nothing defines.
    pub fn missing_block(&mut self, prefix: BlockPrefix, number: u16, span: Span) {
        self.missing(MissingKey::Block(prefix, number), span, || {
            let name = format!("{} {number}", prefix.letters());
            if let Some(message) = absent_system_block(prefix, number, &name, span) {
                return message;
            }
            let message = Diagnostic::new(Code::UnknownBlock, span, format!("{name} is not defined"))
                .label("no source of the program defines this block");
            // Low numbers are usually the user's own.
            let library = plcc_stdlib::LIBRARY.iter().find(|block| {
                block.number == number && block.fb == (prefix == BlockPrefix::Fb) && number > LOW_NUMBERS
            });
            let named = match prefix {
                BlockPrefix::Fc => plcc_stdlib::find_named(plcc_stdlib::BlockClass::Fc, number),
                BlockPrefix::Fb => plcc_stdlib::find_named(plcc_stdlib::BlockClass::Fb, number),
                _ => None,
            };
            if let Some(block) = named {
                let library = block.name;
                let row = format!("`\"{library}\",\"{name}\",\"{name}\",\"\"`");
                return message.help(format!(
                    "add the source that defines it; if it is `{library}` of the library, write {row} into a symbol table"
                ));
            }
            match (prefix, library) {
                (BlockPrefix::Fc | BlockPrefix::Fb, Some(block)) => message.help(format!(
                    "add the source that defines it; {name} is often the number of the library block `{}`, which plcc does not include yet",
                    block.name
                )),
                (BlockPrefix::Sfc | BlockPrefix::Sfb, _) => message.help("no S7-300/400 CPU is known to have it"),
                _ => message.help("add the source that defines it"),
            }
        });
    }

    /// A block that nothing defines. Its number is that of a library block, but its symbol is not.
    pub fn renamed_block(&mut self, prefix: BlockPrefix, number: u16, library: &str, span: Span) {
        if number <= LOW_NUMBERS {
            return self.missing_block(prefix, number, span);
        }
        self.missing(MissingKey::Block(prefix, number), span, || {
            Diagnostic::new(Code::UnknownBlock, span, format!("{} {number} is not defined", prefix.letters()))
                .label("no source of the program defines this block")
                .help(format!(
                    "add the source that defines it; if it is `{library}` of the library, name it `{library}` in the symbol table"
                ))
        });
    }

    /// A block that the CPU or a Siemens library has but plcc does not.
    pub fn not_shipped(&mut self, prefix: BlockPrefix, number: u16, name: &str, span: Span) {
        self.missing(MissingKey::NotShipped(prefix, number), span, || {
            let block = match prefix {
                BlockPrefix::Sfc | BlockPrefix::Sfb if number >= plcc_stdlib::TIA_NUMBERS => {
                    "the instruction".to_string()
                }
                _ => format!("{} {number}", prefix.letters()),
            };
            Diagnostic::new(Code::NotShipped, span, format!("{block} `{name}` is not included yet"))
                .label("plcc knows this block but does not include it")
                .help(match prefix {
                    BlockPrefix::Sfc | BlockPrefix::Sfb => "avoid it, or call another block that does the same",
                    _ => "add a source that defines it",
                })
        });
    }

    /// A DB that is addressed by number; it may be created at run time.
    pub fn missing_db(&mut self, number: u16, span: Span) {
        self.missing(MissingKey::Db(number), span, || {
            Diagnostic::new(Code::DbMissing, span, format!("DB {number} is not defined"))
                .label("opening it is an error at run time unless the program creates it (SFC 22)")
                .help("add the source that defines it")
        });
    }

    /// A DB with unknown components.
    pub fn missing_db_layout(&mut self, number: u16, span: Span) {
        let help = match self.unnumbered_dbs.as_slice() {
            [] => "add the source that defines it".to_string(),
            [name] => format!(
                "if it is `{name}`, write the number into that source, or name `{name}` here; otherwise add its source"
            ),
            [name, ..] => format!(
                "if it is one without a number, such as `{name}`, write the number into that source; otherwise add its source"
            ),
        };
        self.missing(MissingKey::DbLayout(number), span, || {
            Diagnostic::new(
                Code::UnknownBlock,
                span,
                format!("DB {number} is not defined, so its components are unknown"),
            )
            .label("a component of a data block that no source defines")
            .help(help)
        });
    }

    /// All messages, followed by the undefined names in one list; also returns that list separately.
    pub fn finish(self) -> (Vec<Diagnostic>, Vec<Uses>) {
        let Report { mut diagnostics, missing, index, partial, searches: _, unnumbered_dbs: _, memory_bytes: _ } = self;
        let mut list = Vec::with_capacity(missing.len());
        for Missing { key, mut diagnostic, places } in missing {
            let uses = places.len();
            // A missing DB is reported once.
            if let MissingKey::Db(number) = key
                && index.contains_key(&MissingKey::DbLayout(number))
            {
                continue;
            }
            if uses > 1 {
                let label = std::mem::take(&mut diagnostic.primary.text);
                diagnostic.primary.text = format!("{label}; the first of {uses} uses");
            }
            if partial && !matches!(key, MissingKey::Db(_)) {
                diagnostic.severity = Severity::Warning;
            }
            list.push(Uses { key, diagnostic: diagnostic.clone(), places: places.into_iter().collect() });
            diagnostics.push(diagnostic);
        }
        (diagnostics, list)
    }
}

/// Letters of the numbers of blocks.
const BLOCKS: [&str; 8] = ["OB", "FB", "FC", "SFB", "SFC", "DB", "DI", "UDT"];

/// The message for the letters of a block alone, `FB` in `DATA_BLOCK DB 10 FB`.
fn block_without_number(name: &str, span: Span) -> Option<Diagnostic> {
    let is_whole = span.end - span.start == name.len() as u32;
    if !is_whole || !BLOCKS.iter().any(|letters| letters.eq_ignore_ascii_case(name)) {
        return None;
    }
    Some(
        Diagnostic::new(Code::MissingOperand, span, format!("`{name}` has no number"))
            .label("a number is missing after this")
            .help(format!("write the number of the block, as in `{name} 5`")),
    )
}
