//! Where the program can stop: the probes before statements, by lines, blocks, networks and names.

use std::collections::HashMap;

use plcc_abi::image::BlockKind;
use plcc_diag::{FileId, SourceMap};
use plcc_lower::probe::{Place, Probe};
use plcc_model::{BlockKey, Body, CodeBlock, Program};

/// A place, as stepping sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spot {
    pub file: FileId,
    /// From 1.
    pub line: u32,
    /// In characters, from 1.
    pub column: u32,
    pub end_line: u32,
    /// A statement; else a block begins or gets its formals.
    pub is_statement: bool,
}

/// The places of a program.
pub struct Places {
    pub list: Vec<Place>,
    spots: Vec<Spot>,
    /// Places of statements, by file and line.
    lines: HashMap<(u32, u32), Vec<u32>>,
    /// Paths of the files, from the root on.
    pub paths: Vec<String>,
}

impl Places {
    pub fn new(list: Vec<Place>, sources: &SourceMap, absolute: &dyn Fn(&str) -> String) -> Places {
        let spot = |place: &Place| {
            let file = sources.file(place.span.file);
            let (line, column) = file.line_column(place.span.start);
            let end_line = file.line(place.span.end.max(place.span.start));
            let is_statement = matches!(place.probe, Probe::Statement(_));
            Spot { file: place.span.file, line, column, end_line, is_statement }
        };
        let spots: Vec<Spot> = list.iter().map(spot).collect();
        let mut lines: HashMap<(u32, u32), Vec<u32>> = HashMap::new();
        for (number, spot) in spots.iter().enumerate().filter(|(_, spot)| spot.is_statement) {
            lines.entry((spot.file.0, spot.line)).or_default().push(number as u32);
        }
        let paths = sources.files().map(|(_, file)| absolute(&file.name)).collect();
        Places { list, spots, lines, paths }
    }

    pub fn place(&self, number: u32) -> Option<&Place> {
        self.list.get(number as usize)
    }

    pub fn spot(&self, number: u32) -> Option<Spot> {
        self.spots.get(number as usize).copied()
    }

    /// The file with a path from the root on.
    pub fn file(&self, path: &str) -> Option<FileId> {
        self.paths.iter().position(|own| own == path).map(|index| FileId(index as u32))
    }

    /// The statements at a line, or where there is none, those of the network or the statement around it, or the next ones. With their line.
    pub fn at_line(&self, file: FileId, line: u32, program: &Program, sources: &SourceMap) -> Option<(u32, Vec<u32>)> {
        let at = |line: u32| self.lines.get(&(file.0, line)).map(|places| (line, places.clone()));
        if let Some(found) = at(line) {
            return Some(found);
        }
        if line == 0 || line > sources.file(file).line_count() {
            return None;
        }
        let own = || self.spots.iter().zip(&self.list).filter(|(spot, _)| spot.is_statement && spot.file == file);
        let before = own().filter(|(spot, _)| spot.line < line).max_by_key(|(spot, _)| spot.line);
        let after = own().filter(|(spot, _)| spot.line > line).min_by_key(|(spot, _)| spot.line);
        let source = sources.file(file);
        let end = source.line_range(line).end as u32;
        let network = before.and_then(|(_, place)| network_at(program, place.block, end.saturating_sub(1)));
        match (before, after) {
            (Some((spot, place)), _) if network == Some(place.network) => match after {
                // Below the last network there may be another block.
                Some((_, next))
                    if next.block != place.block
                        && spot.end_line < line
                        && source.line_text(line).trim().is_empty() =>
                {
                    at(after?.0.line)
                }
                _ => at(spot.line),
            },
            (Some((spot, _)), _) if network.is_none() && spot.end_line >= line => at(spot.line),
            (_, after) => at(after?.0.line),
        }
    }

    /// The lines from `first` to `last` where statements are.
    pub fn lines_between(&self, file: FileId, first: u32, last: u32) -> Vec<u32> {
        let mut lines: Vec<u32> = self
            .lines
            .keys()
            .filter(|(own, line)| *own == file.0 && (first..=last).contains(line))
            .map(|(_, line)| *line)
            .collect();
        lines.sort_unstable();
        lines
    }

    /// The statements of `FB1` (where it begins), `FB1:3` (its network 3), `FB1:Fill` (its step or transition, or what else has this text).
    /// `Err`: the error.
    pub fn named(&self, name: &str, program: &Program, sources: &SourceMap) -> Result<Named, String> {
        let (block, part) = match split(name) {
            (block, Some(part)) => (find_block(program, block)?, Some(part)),
            (block, None) => (find_block(program, block)?, None),
        };
        let Some(part) = part else { return Ok(Named::Block(block)) };
        let own =
            || self.list.iter().enumerate().filter(|(_, p)| matches!(p.probe, Probe::Statement(_)) && p.block == block);
        let found: Vec<u32> = match part.parse::<u16>() {
            Ok(network) => {
                own().filter(|(_, place)| place.network == network).map(|(number, _)| number as u32).collect()
            }
            Err(_) => {
                let is_it = |place: &Place| {
                    let text = sources.text(place.span);
                    let mut words = text.split(|c: char| c.is_whitespace() || matches!(c, ':' | '(' | ';' | ','));
                    let word = match words.next() {
                        Some(word)
                            if ["STEP", "INITIAL_STEP", "TRANSITION"].contains(&word.to_uppercase().as_str()) =>
                        {
                            words.find(|word| !word.is_empty())
                        }
                        word => word,
                    };
                    word.is_some_and(|word| word.trim_matches('"').eq_ignore_ascii_case(part))
                };
                own().filter(|(_, place)| is_it(place)).map(|(number, _)| number as u32).collect()
            }
        };
        let found = if found.is_empty() { self.of_step(block, part, program, sources) } else { found };
        match found.first() {
            Some(_) => Ok(Named::Places(found)),
            None => Err(format!("{block} has no network, transition or step with actions `{part}`")),
        }
    }
}

impl Places {
    /// The statements after the line where a step of GRAPH as source text begins, up to its end.
    fn of_step(&self, block: BlockKey, name: &str, program: &Program, sources: &SourceMap) -> Vec<u32> {
        let Some(span) = program.block(block).map(|block| block.span) else { return Vec::new() };
        let file = sources.file(span.file);
        let words = |line: u32| {
            file.line_text(line).split(|c: char| c.is_whitespace() || c == ':').filter(|word| !word.is_empty())
        };
        let begins = |line: &u32| {
            let mut words = words(*line);
            words.next().is_some_and(|word| ["STEP", "INITIAL_STEP"].contains(&word.to_uppercase().as_str()))
                && words.next().is_some_and(|word| word.trim_matches('"').eq_ignore_ascii_case(name))
        };
        let Some(first) = (file.line(span.start)..=file.line_count()).find(begins) else { return Vec::new() };
        let ends = |line: &u32| words(*line).next().is_some_and(|word| word.to_uppercase().starts_with("END_STEP"));
        let last = (first..=file.line_count()).find(ends).unwrap_or(first);
        let lines = self.lines_between(span.file, first, last);
        lines.iter().filter_map(|line| self.lines.get(&(span.file.0, *line))).flatten().copied().collect()
    }
}

/// What a function breakpoint names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Named {
    /// The first statement of a call.
    Block(BlockKey),
    Places(Vec<u32>),
}

/// `FB1:3`; the name of a block may be in quotes and contain a colon.
fn split(name: &str) -> (&str, Option<&str>) {
    let name = name.trim();
    let from = name.strip_prefix('"').and_then(|rest| rest.find('"')).map_or(0, |at| at + 2);
    match name[from..].split_once(':') {
        Some((_, part)) => (name[..name.len() - part.len() - 1].trim(), Some(part.trim().trim_matches('"'))),
        None => (name, None),
    }
}

/// A block by its address or its name. `Err`: the error.
fn find_block(program: &Program, text: &str) -> Result<BlockKey, String> {
    let bare = text.trim().trim_matches('"');
    let compact: String = bare.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let is_it = |block: &&CodeBlock| {
        compact == format!("{}{}", block.kind.prefix(), block.number)
            || (!block.name.is_empty() && block.name.eq_ignore_ascii_case(bare))
    };
    match program.blocks.iter().filter(|block| block.kind != BlockKind::Db).find(is_it) {
        Some(block) if block.library => Err(format!("{text} is a block of the library, which has no source here")),
        Some(block) => Ok(block.key()),
        None => Err(format!("the program has no block {text}")),
    }
}

/// The network of LAD or FBD around a position; `None`: the block does not consist of such.
fn network_at(program: &Program, block: BlockKey, position: u32) -> Option<u16> {
    match &program.block(block)?.body {
        Body::Scl(body) if !body.networks.is_empty() => Some(body.network_at(position)),
        Body::Scl(_) | Body::Stl(_) | Body::S7200(_) | Body::Runtime => None,
    }
}
