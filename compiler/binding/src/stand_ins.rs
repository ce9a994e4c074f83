//! Programs with missing parts: their stand-ins, the parts that are left out, and the messages about both.

use plcc_diag::{Code, Diagnostic, FileId, Severity, Span};
use plcc_model::Program;
use plcc_syntax::ast::{BlockPrefix, SourceUnit};
use plcc_syntax::symbols::SymbolTable;
use rustc_hash::FxHashSet;

use crate::report::{MissingKey, Uses};
use crate::{BindInput, Bound, fold};

/// A partial program that has been completed.
pub struct Completed {
    pub program: Program,
    pub diagnostics: Vec<Diagnostic>,
    /// Text of the file with the positions of the stand-ins: the next file of the source map.
    pub stand_ins: String,
}

/// A name or block that is defined nowhere.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Missing {
    /// A name, folded.
    Name(String),
    /// A block by its number; also UDTs.
    Block(u8, u16),
}

/// Order of prefixes in a list: types, functions, function blocks, data blocks.
const PREFIXES: [BlockPrefix; 6] =
    [BlockPrefix::Udt, BlockPrefix::Fc, BlockPrefix::Fb, BlockPrefix::Sfc, BlockPrefix::Sfb, BlockPrefix::Db];

impl Missing {
    /// A name in any letter case.
    pub fn name(name: &str) -> Missing {
        Missing::Name(fold(name))
    }

    /// A block by its number; none for kinds without stand-ins.
    pub fn block(prefix: BlockPrefix, number: u32) -> Option<Missing> {
        let prefix = if prefix == BlockPrefix::Di { BlockPrefix::Db } else { prefix };
        let at = PREFIXES.iter().position(|known| *known == prefix)?;
        Some(Missing::Block(at as u8, u16::try_from(number).ok()?))
    }

    /// Prefix and number, if it is a block by its number.
    pub fn numbered(&self) -> Option<(BlockPrefix, u16)> {
        match self {
            Missing::Block(at, number) => Some((PREFIXES[usize::from(*at)], *number)),
            Missing::Name(_) => None,
        }
    }
}

/// Sources with stand-ins.
pub struct Whole {
    pub units: Vec<(FileId, SourceUnit)>,
    pub tables: Vec<SymbolTable>,
}

impl Whole {
    /// These sources as the input of a binder. `file`: the one with the stand-ins.
    pub fn as_input<'a>(&'a self, input: &BindInput<'a>, file: FileId) -> BindInput<'a> {
        BindInput {
            name: input.name.clone(),
            sources: input.sources,
            units: &self.units,
            tables: &self.tables,
            profile: input.profile.clone(),
            config: input.config.clone(),
            partial: true,
            stand_ins: Some(file),
            pragmas: input.pragmas,
            require_main: input.require_main,
            safety_as_standard: input.safety_as_standard,
            plain_charts: input.plain_charts,
        }
    }
}

/// A part that was left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    pub span: Span,
    pub what: &'static str,
}

/// Codes and positions of the errors.
pub fn errors(diagnostics: &[Diagnostic]) -> impl Iterator<Item = (Code, Span)> {
    diagnostics
        .iter()
        .filter(|diagnostic| diagnostic.is_error())
        .map(|diagnostic| (diagnostic.code, diagnostic.primary.span))
}

/// The stand-in for one name, in words.
pub struct Told {
    pub missing: Missing,
    /// The whole line.
    pub line: String,
    /// Without the name.
    pub what: String,
}

/// The stand-ins of a program, and the parts that were left out.
pub struct Parts {
    pub told: Vec<Told>,
    /// Components that data blocks got: the position of the data block's name, and a line.
    pub added: Vec<(Span, String)>,
    pub left: Vec<LeftOut>,
    /// An empty main program stands in for a missing one.
    pub no_main: bool,
    /// Text of the file of stand-ins.
    pub stand_ins: String,
}

/// The program with its messages: those of the first binding except errors that missing names caused, the stand-ins, and the parts left
/// out. `places`: parts that could not be left out, which remain errors.
pub fn finish(
    input: &BindInput,
    first: Bound,
    bound: Bound,
    wrong: &FxHashSet<(Code, Span)>,
    places: &[Span],
    parts: Parts,
) -> Completed {
    // A call that supplies a pointer may have been unreadable before, or left out since.
    let pointers: FxHashSet<Span> = bound
        .diagnostics
        .iter()
        .filter(|message| message.code == Code::MissingPointer && parts.left.is_empty())
        .map(|message| message.primary.span)
        .collect();
    let kept = |diagnostic: &Diagnostic| {
        !diagnostic.is_error()
            && (diagnostic.code != Code::MissingPointer || pointers.contains(&diagnostic.primary.span))
            || diagnostic.code == Code::NoMainBlock
            || wrong.contains(&(diagnostic.code, diagnostic.primary.span))
    };
    let reviewed = reliable(first.reviewed, &bound, &first.missing, &parts.left);
    let mut diagnostics: Vec<Diagnostic> = first.diagnostics.into_iter().filter(kept).collect();
    diagnostics.extend(reviewed);
    diagnostics.extend(
        bound
            .diagnostics
            .into_iter()
            .filter(|diagnostic| diagnostic.is_error() && !wrong.contains(&(diagnostic.code, diagnostic.primary.span))),
    );
    if !places.is_empty() {
        let rest = bound.missing.into_iter().filter(|uses| !matches!(uses.key, MissingKey::Db(_)));
        diagnostics.extend(rest.map(|uses| Diagnostic { severity: Severity::Error, ..uses.diagnostic }));
    }
    let mut program = bound.program;
    program.partial = tell(input, &first.missing, &parts, &mut diagnostics);
    Completed { program, diagnostics, stand_ins: parts.stand_ins }
}

/// The warnings of the first review that are not about what is missing. In a block that uses something missing they must hold with the
/// stand-ins, too, and none says that a variable is not written: a missing block may write it. A block with a part left out has none.
fn reliable(reviewed: Vec<Diagnostic>, bound: &Bound, missing: &[Uses], left: &[LeftOut]) -> Vec<Diagnostic> {
    let mut starts: Vec<(FileId, u32)> =
        bound.program.blocks.iter().map(|block| (block.span.file, block.span.start)).collect();
    starts.sort_unstable();
    let block_of = |span: Span| (span.file, starts.partition_point(|start| *start <= (span.file, span.start)));
    let left: FxHashSet<(FileId, usize)> = left.iter().map(|part| block_of(part.span)).collect();
    let lacking: FxHashSet<(FileId, usize)> =
        missing.iter().flat_map(|uses| &uses.places).map(|place| block_of(*place)).collect();
    let again: FxHashSet<(Code, Span)> =
        bound.reviewed.iter().map(|message| (message.code, message.primary.span)).collect();
    let is_reliable = |message: &Diagnostic| {
        let (code, span) = (message.code, message.primary.span);
        let block = block_of(span);
        let holds = code != Code::NeverWritten && again.contains(&(code, span));
        !left.contains(&block) && (holds || !lacking.contains(&block))
    };
    reviewed.into_iter().filter(is_reliable).collect()
}

fn missing_of(key: &MissingKey) -> Option<Missing> {
    match key {
        // A local name of statements without a header has no type that could be known.
        MissingKey::Local(_) => None,
        MissingKey::Symbol(name) | MissingKey::Constant(name) => {
            // A type without a symbol has its number.
            let number = name.strip_prefix("udt ").and_then(|number| number.parse().ok());
            let udt = number.and_then(|number| Missing::block(BlockPrefix::Udt, number));
            Some(udt.unwrap_or_else(|| Missing::Name(name.clone())))
        }
        MissingKey::Block(prefix, number) | MissingKey::NotShipped(prefix, number) => {
            Missing::block(*prefix, u32::from(*number))
        }
        MissingKey::Db(number) | MissingKey::DbLayout(number) => Missing::block(BlockPrefix::Db, u32::from(*number)),
    }
}

/// Lists the stand-ins and the parts left out: in the messages, and in lines for the start of a run.
fn tell(input: &BindInput, missing: &[Uses], parts: &Parts, diagnostics: &mut Vec<Diagnostic>) -> Vec<String> {
    let mut lines = Vec::new();
    if parts.no_main {
        lines.push("OB 1 is missing: an empty one".to_string());
        for diagnostic in diagnostics.iter_mut().filter(|diagnostic| diagnostic.code == Code::NoMainBlock) {
            diagnostic.severity = Severity::Warning;
            diagnostic.help = Some("in its place: an empty one".to_string());
        }
    }
    for told in &parts.told {
        lines.push(told.line.clone());
        let uses = missing.iter().filter(|uses| missing_of(&uses.key).as_ref() == Some(&told.missing));
        for uses in uses {
            let (code, span) = (uses.diagnostic.code, uses.diagnostic.primary.span);
            let of_it = diagnostics.iter_mut().find(|message| message.code == code && message.primary.span == span);
            if let Some(message) = of_it {
                message.help = Some(format!("in its place: {}", told.what));
            }
        }
    }
    for (place, line) in &parts.added {
        lines.push(line.clone());
        diagnostics.push(
            Diagnostic::new(Code::Added, *place, line.clone())
                .label("the program uses them, and this version of the data block does not declare them")
                .help("add the source of the data block that belongs to the program"),
        );
    }
    for message in diagnostics.iter().filter(|message| message.code == Code::LeftOut) {
        let span = message.primary.span;
        let source = input.sources.file(span.file);
        lines.push(format!("{}:{}: {}", source.name, source.line(span.start), message.title));
    }
    for part in &parts.left {
        let source = input.sources.file(part.span.file);
        let line = source.line(part.span.start);
        lines.push(format!("{}:{line}: {} is left out", source.name, part.what.trim_end_matches(',')));
        diagnostics.push(
            Diagnostic::new(Code::LeftOut, part.span, format!("{} is left out", part.what))
                .label("it needs a missing name, and no type fits all uses of that name")
                .help("add the sources and symbol tables that define what is missing"),
        );
    }
    lines
}
