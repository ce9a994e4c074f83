//! Reads the text form of a module; see [`print`](crate::print) for its shape.
//!
//! Values and blocks may have any number in the text; they are numbered again in the order of their definitions, so
//! that the result is canonical. The parser checks what it needs to build the module (names, result types); whether
//! the module is valid is for the [verifier](crate::verify).

mod body;
mod cursor;
mod operands;
mod operation;

use std::fmt;

use plcc_abi::Type;
use plcc_abi::image::{BlockKind, Site};
use rustc_hash::FxHashMap;

use crate::entities::{Entity, FuncId};
use crate::function::Function;
use crate::module::{Module, StaticDb};
use body::FunctionParser;
use cursor::Cursor;

/// An error in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseError {
    /// 1-based.
    pub line: u32,
    pub message: String,
}

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for ParseError {}

/// An error in a line; the caller adds the line number.
type LineResult<T> = Result<T, String>;

/// Reads a module. Errors: the first line that cannot be read.
pub fn parse_module(text: &str) -> Result<Module, ParseError> {
    let mut module = Module::default();
    let mut signatures = Signatures::default();
    // Function headers first: calls name functions that come later.
    for (number, line) in lines(text) {
        if line.starts_with("func ") {
            let function = located(number, parse_header(&mut Cursor::new(line)))?;
            let id = FuncId::new(signatures.returns.len());
            signatures.returns.push(function.returns);
            if signatures.ids.insert(function.name.clone(), id).is_some() {
                return Err(ParseError {
                    line: number,
                    message: format!("function @{} is defined twice", function.name),
                });
            }
        }
    }
    let mut open: Option<FunctionParser> = None;
    let mut last = 1;
    for (number, line) in lines(text) {
        last = number;
        let cursor = &mut Cursor::new(line);
        open = match open {
            None if line.starts_with("func ") => {
                Some(FunctionParser::new(located(number, parse_header(cursor))?, &signatures))
            }
            None => {
                located(number, parse_item(cursor, &mut module, &signatures))?;
                None
            }
            Some(parser) if line == "}" => {
                module.functions.push(parser.finish(number)?);
                None
            }
            Some(mut parser) => {
                parser.line = number;
                located(number, parser.parse_line(cursor))?;
                Some(parser)
            }
        };
    }
    match open {
        Some(parser) => {
            Err(ParseError { line: last, message: format!("function @{} has no end `}}`", parser.function.name) })
        }
        None => Ok(module),
    }
}

/// Numbered lines without comments and surrounding space; empty ones are left out.
fn lines(text: &str) -> impl Iterator<Item = (u32, &str)> {
    (1u32..).zip(text.lines()).filter_map(|(number, line)| {
        let line = without_comment(line).trim();
        (!line.is_empty()).then_some((number, line))
    })
}

fn without_comment(line: &str) -> &str {
    let mut quoted = false;
    let mut escaped = false;
    for (index, byte) in line.bytes().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if quoted => escaped = true,
            b'"' => quoted = !quoted,
            b';' if !quoted => return &line[..index],
            _ => {}
        }
    }
    line
}

fn located<T>(line: u32, result: LineResult<T>) -> Result<T, ParseError> {
    result.map_err(|message| ParseError { line, message })
}

/// Functions of the module by name.
#[derive(Default)]
struct Signatures {
    ids: FxHashMap<String, FuncId>,
    returns: Vec<Vec<Type>>,
}

impl Signatures {
    fn find(&self, name: &str) -> LineResult<FuncId> {
        self.ids.get(name).copied().ok_or_else(|| format!("there is no function @{name}"))
    }
}

/// `func @NAME -> TYPE, TYPE frame N inlined N apart {`
fn parse_header(cursor: &mut Cursor) -> LineResult<Function> {
    cursor.word_is("func")?;
    let mut function = Function::new(cursor.function_name()?);
    if cursor.take("->") {
        function.returns.push(cursor.ty()?);
        while cursor.take(",") {
            function.returns.push(cursor.ty()?);
        }
    }
    if cursor.take_word("frame") {
        function.frame_bytes = cursor.number()?;
    }
    if cursor.take_word("inlined") {
        function.inlined_bytes = cursor.number()?;
    }
    function.apart = cursor.take_word("apart");
    function.by_pointers = cursor.take_word("by_pointers");
    cursor.expect("{")?;
    cursor.end()?;
    Ok(function)
}

/// A line outside a function.
fn parse_item(cursor: &mut Cursor, module: &mut Module, signatures: &Signatures) -> LineResult<()> {
    match cursor.word()? {
        "file" => module.files.push(cursor.string()?),
        "site" => {
            let number: usize = cursor.number()?;
            if number != module.sites.len() + 1 {
                return Err(format!("site {} is expected here", module.sites.len() + 1));
            }
            cursor.expect(":")?;
            module.sites.push(parse_site(cursor)?);
        }
        "db" => {
            let number = cursor.number()?;
            cursor.word_is("at")?;
            let address = cursor.number()?;
            cursor.word_is("length")?;
            let length = cursor.number()?;
            let read_only = cursor.take_word("read_only");
            module.dbs.push(StaticDb { number, address, length, read_only });
        }
        "entry" => module.entries.push(signatures.find(cursor.function_name()?)?),
        word => return Err(format!("`file`, `site`, `db`, `entry` or `func` is expected, not `{word}`")),
    }
    cursor.end()
}

fn parse_site(cursor: &mut Cursor) -> LineResult<Site> {
    cursor.word_is("file")?;
    let file = cursor.number()?;
    cursor.word_is("line")?;
    let line = cursor.number()?;
    let name = cursor.word()?;
    let digits = name.find(|c: char| c.is_ascii_digit()).unwrap_or(name.len());
    let kinds =
        [BlockKind::Ob, BlockKind::Fc, BlockKind::Fb, BlockKind::Sfc, BlockKind::Sfb, BlockKind::Db].into_iter();
    let block = kinds.into_iter().find(|kind| kind.prefix() == &name[..digits]);
    let (Some(block), Ok(block_number)) = (block, name[digits..].parse()) else {
        return Err(format!("`{name}` is not a block, e.g. `FC12`"));
    };
    cursor.word_is("network")?;
    Ok(Site { file, line, block, block_number, network: cursor.number()? })
}

#[cfg(test)]
mod tests;
