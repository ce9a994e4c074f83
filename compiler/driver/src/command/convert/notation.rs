//! Sources in another notation, each by itself.

use plcc_abi::image::Family;
use plcc_convert::element_values::Components;
use plcc_convert::own_types::{OwnTypes, is_written_out};
use plcc_convert::scl::Others;
use plcc_convert::to_stl::{self, types::Types};
use plcc_convert::trivia::Trivia;
use plcc_convert::{from_scl, sd, to_graph, xml};
use plcc_diag::{Diagnostic, FileId, SourceFile};
use plcc_model::{Program, profile};
use plcc_readers::plcopen;
use plcc_readers::simatic_ml::Remarks;
use plcc_readers::xml::XmlKind;
use plcc_syntax::ast::{Block, Code, SourceUnit};
use plcc_syntax::network::ast::Language as Graphic;
use plcc_syntax::stl::{self, Mnemonics};
use plcc_syntax::symbols::SymbolTable;
use plcc_syntax::{ParseOptions, ast_text, scl};

use super::output::store;
use super::{
    Beside, Converted, asserted, bound, companions, has, languages, name_by_files, other_family, remarks, texts_beside,
    whole_blocks, without_stl,
};
use crate::cli::{ConvertArgs, ConvertTo};
use crate::command::exit;
use crate::{inputs, pipeline, report};

/// Writes each source in another notation. Returns the exit code.
pub fn notation(args: &ConvertArgs, to: ConvertTo) -> u8 {
    let read = inputs::read_as(&args.inputs, args.code_page);
    let unreadable = read.is_unreadable();
    let tables = companions::tables(&read);
    let texts = read.texts.clone();
    let mut parsed = pipeline::parse(read, &pipeline::Settings::default());
    if to != ConvertTo::Stl {
        name_by_files(&mut parsed);
    }
    let mut messages = std::mem::take(&mut parsed.diagnostics);
    // What only warns about the source stays as it is.
    messages.retain(Diagnostic::is_error);
    settle_types(&mut parsed, to);
    let told = companions::cpu_of_pragmas(&parsed).filter(|name| profile::lookup(name).is_some());
    let default = cpu_for_stl(&parsed);
    let program = match messages.is_empty() && has_scl_for_stl(to, &parsed) {
        true => match bound(args, &parsed, default) {
            Ok(bound) => Some(bound.program),
            Err(code) => return code,
        },
        false => None,
    };
    let project = parsed.project.as_ref().and_then(|project| project.cpu.as_ref());
    let cpu = args.cpu.as_deref().or(project.map(|(name, _)| name.as_str())).or(told);
    // What nobody names, the statements do.
    let usual = default.filter(|default| cpu.is_none() && program.is_some() && *default == without_stl::USUAL);
    let cpu = cpu.or(usual);
    let mut files = Vec::new();
    if messages.is_empty() {
        let maker = Maker::new((args, to), &parsed, &texts, program.as_ref(), (cpu, usual));
        for (id, unit) in &parsed.units {
            files.extend(maker.source(*id, unit, &mut messages));
        }
    }
    report::messages(&mut messages, &parsed.sources);
    if unreadable {
        return exit::USAGE;
    }
    if messages.iter().any(Diagnostic::is_error) {
        report::say(&report::summary(&messages));
        return exit::COMPILE;
    }
    if to == ConvertTo::Stl
        && let Some(cpu) = cpu.filter(|cpu| without_stl::is_without(cpu))
    {
        report::say(&without_stl::warning(cpu));
    }
    let companions = match companions::of(args, &tables, &parsed, Some((to, &files))) {
        Ok(companions) => companions,
        Err(code) => return code,
    };
    store(args, Some(to.extension()), &files, &companions).err().unwrap_or(exit::OK)
}

/// Gives types of the program the form that they have in the new notation.
fn settle_types(parsed: &mut pipeline::Parsed, to: ConvertTo) {
    let mut own_types = OwnTypes::new(parsed.units.iter().map(|(_, unit)| unit));
    if to == ConvertTo::Xml {
        own_types = own_types.with_aliases(parsed.units.iter().map(|(_, unit)| unit));
    }
    let components = Components::new(parsed.units.iter().map(|(_, unit)| unit));
    for (id, unit) in &mut parsed.units {
        if has_quoted_types(to, unit, parsed.sources.file(*id)) {
            own_types.settle(unit);
        }
        if matches!(to, ConvertTo::Scl | ConvertTo::Sd | ConvertTo::Lad | ConvertTo::Fbd) && unit.overlay.is_some() {
            components.list_elements(unit);
        }
    }
}

/// What makes the sources of a program in the new notation, and what it needs to know for that.
struct Maker<'a> {
    args: &'a ConvertArgs,
    to: ConvertTo,
    parsed: &'a pipeline::Parsed,
    /// Sources with the texts next to them.
    texts: &'a [(FileId, FileId)],
    /// The program, for STL that is made of SCL and charts.
    program: Option<&'a Program>,
    types: Types<'a>,
    library: xml::Library,
    is_portal: bool,
    /// BR is ENO of a block, and calls leave it as it is.
    keeps_br: bool,
    /// The CPU that only the new statements name.
    usual: Option<&'a str>,
}

impl<'a> Maker<'a> {
    fn new(
        (args, to): (&'a ConvertArgs, ConvertTo),
        parsed: &'a pipeline::Parsed,
        texts: &'a [(FileId, FileId)],
        program: Option<&'a Program>,
        (cpu, usual): (Option<&str>, Option<&'a str>),
    ) -> Maker<'a> {
        let types = Types::new(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
        let mut library = xml::Library::with_symbols(parsed.units.iter().map(|(_, unit)| unit), &parsed.tables);
        if to == ConvertTo::Xml {
            library.add_system(plcc_program::system_members);
        }
        let named = cpu.and_then(profile::lookup);
        let is_named = named.is_some();
        let profile = named.unwrap_or_else(|| plcc_program::implied_profile(&parsed.units));
        let is_portal = profile.family.is_portal();
        // If no CPU is named, limits are checked where the sources need an S7-300.
        let keeps_br = (is_named || profile.limits_checked) && matches!(profile.family, Family::S7300 | Family::S7400);
        let types = types.with_instructions(plcc_program::instruction_pins).for_portal(is_portal);
        let types = types.with_library(parsed.units.iter().map(|(_, unit)| unit), plcc_program::library_code);
        Maker { args, to, parsed, texts, program, types, library, is_portal, keeps_br, usual }
    }

    /// A source in the new notation; none after a message, or if there is nothing to write.
    fn source(&self, id: FileId, unit: &SourceUnit, messages: &mut Vec<Diagnostic>) -> Option<Converted> {
        let source = self.parsed.sources.file(id);
        if companions::is_made(&source.name) {
            return None;
        }
        let is_awl = self.to == ConvertTo::Awl;
        if let Some(s7200) = &unit.s7200
            && is_awl
        {
            let set = self.args.mnemonics.map_or(unit.mnemonics, Mnemonics::from);
            let text = plcc_convert::addresses::apply(&source.text, &plcc_convert::awl::edits(s7200, set));
            return Some(Converted { name: source.name.clone(), text, beside: Vec::new() });
        }
        if is_awl || unit.s7200.is_some() {
            messages.push(other_family(unit, self.to));
            return None;
        }
        let (made, found) = self.made(unit, source);
        let refused = found.iter().any(Diagnostic::is_error);
        messages.extend(found);
        if refused {
            return None;
        }
        let (file, found) = written((self.args, self.to), id, (unit, &made), &self.library, source);
        messages.extend(found);
        if self.to == ConvertTo::Xml && self.parsed.units.len() > 1 && has_only_names(unit) {
            return None;
        }
        if matches!(self.to, ConvertTo::Lad | ConvertTo::Fbd) && has(unit, |code| matches!(code, Code::Stl(_))) {
            messages.extend(asserted::of_registers(id, &source.text, unit.mnemonics));
        }
        messages.extend(languages::of_export(id, &source.text));
        let beside = self.beside(id, source, file.beside, messages);
        let text = match self.to {
            ConvertTo::Stl => {
                let pragma = self.usual.map_or_else(String::new, |cpu| format!("//@ cpu {cpu}\n"));
                pragma + &without_stl::text(&file.text, self.args.cpu.as_deref())
            }
            _ => file.text,
        };
        Some(Converted { name: source.name.clone(), text, beside })
    }

    /// The tree of a source with its blocks in the language of the new notation.
    fn made(&self, unit: &SourceUnit, source: &SourceFile) -> (SourceUnit, Vec<Diagnostic>) {
        match self.to {
            ConvertTo::Stl => self.made_of_statements(unit, source),
            ConvertTo::Lad => to_graph::unit(unit, &self.types, Graphic::Lad),
            ConvertTo::Fbd => to_graph::unit(unit, &self.types, Graphic::Fbd),
            ConvertTo::Sd if self.is_portal => (sd::of_portal(unit), Vec::new()),
            ConvertTo::Sd | ConvertTo::Scl | ConvertTo::Gr7 | ConvertTo::Xml | ConvertTo::Plcopen | ConvertTo::Awl => {
                (unit.clone(), Vec::new())
            }
        }
    }

    /// Blocks in SCL, charts and networks as STL.
    fn made_of_statements(&self, unit: &SourceUnit, source: &SourceFile) -> (SourceUnit, Vec<Diagnostic>) {
        let misplaced = to_stl::instances::of_unit(unit, &self.types);
        let (listed, mut found) = match self.program {
            // The calls of such instances need no message of their own.
            _ if !misplaced.is_empty() => (unit.clone(), misplaced),
            Some(program) => {
                let Remarks { text, comments } = remarks(unit, &source.text).unwrap_or_else(|| {
                    let meaning = unit.overlay.as_deref().unwrap_or(&source.text);
                    let comments = match plcopen::is_project(&source.text) {
                        true => plcopen::comments_and_pragmas(&source.text, meaning),
                        false => Vec::new(),
                    };
                    Remarks { text: meaning.to_string(), comments }
                });
                from_scl::unit(unit, program, (text.as_str(), comments.as_slice()), plcc_program::with_chart_data)
            }
            None => (unit.clone(), Vec::new()),
        };
        let (made, more) = to_stl::unit(&listed, &self.types, self.keeps_br);
        found.extend(more);
        (made, found)
    }

    /// The files that belong to a source: `own`, its texts and its tags.
    fn beside(&self, id: FileId, source: &SourceFile, own: Vec<Beside>, messages: &mut Vec<Diagnostic>) -> Vec<Beside> {
        let (tags, found) = tags_beside(id, &source.text, &self.parsed.tables);
        messages.extend(found);
        let texts = self.texts.iter().find(|(unit, _)| *unit == id);
        let texts = texts.map(|(_, texts)| (*texts, &self.parsed.sources.file(*texts).text));
        // What is made of a document names the texts of that.
        let is_of_sd = matches!(self.to, ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd);
        if let Some((texts, text)) = texts.filter(|_| !is_of_sd) {
            messages.extend(languages::of_document(texts, text));
        }
        let texts = texts.filter(|_| is_of_sd).map(|(_, text)| texts_beside(text.clone()));
        own.into_iter().chain(texts).chain(tags).collect()
    }
}

/// STL is made of SCL and charts, whose names and types are those of the program.
fn has_scl_for_stl(to: ConvertTo, parsed: &pipeline::Parsed) -> bool {
    let is_scl = |block: &Block| matches!(block, Block::Code(block) if from_scl::has_statements(&block.code));
    to == ConvertTo::Stl && parsed.units.iter().any(|(_, unit)| unit.blocks.iter().any(is_scl))
}

/// The CPU for STL made from SCL and charts if nothing names one; `None`: the one that the sources imply, as when they are run.
fn cpu_for_stl(parsed: &pipeline::Parsed) -> Option<&'static str> {
    let implied = plcc_program::implied_profile(&parsed.units);
    if implied.family == Family::S71200 {
        // That has no STL.
        return Some("s7-300");
    }
    // SCL of the TIA Portal follows the rules of an S7-1500, whose STL has instructions that an S7-300 does not have.
    let is_of_portal = |block: &Block| match block {
        Block::Code(block) => match &block.code {
            Code::Scl(body) => body.dialect == scl::ast::Dialect::Tia,
            Code::Graphic(_) => true,
            Code::Stl(_) | Code::Chart(_) => false,
        },
        Block::Data(_) | Block::Type(_) => true,
    };
    let is_unnamed = implied.family == Family::S7300 && !implied.limits_checked;
    let is_for_portal = is_unnamed && parsed.units.iter().flat_map(|(_, unit)| &unit.blocks).all(is_of_portal);
    is_for_portal.then_some(without_stl::USUAL)
}

/// Whether the new notation has the types of a program in quotes. SCL keeps them as its author wrote them.
fn has_quoted_types(to: ConvertTo, unit: &SourceUnit, source: &SourceFile) -> bool {
    match to {
        ConvertTo::Stl | ConvertTo::Xml => true,
        ConvertTo::Scl => unit.overlay.is_some() || is_document(source),
        ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd | ConvertTo::Gr7 | ConvertTo::Plcopen | ConvertTo::Awl => false,
    }
}

/// Whether all that a source has is written out in other documents.
fn has_only_names(unit: &SourceUnit) -> bool {
    let is_name = |block: &Block| match block {
        Block::Type(ty) => ty.alias.as_ref().is_some_and(is_written_out),
        Block::Code(_) | Block::Data(_) => false,
    };
    !unit.blocks.is_empty() && unit.blocks.iter().all(is_name)
}

/// Whether a source is a document of SIMATIC SD.
fn is_document(source: &SourceFile) -> bool {
    let parts = plcc_readers::parts(&source.text, pipeline::language_of(&source.name));
    matches!(parts[..], [(_, plcc_syntax::Language::Sd)])
}

/// The variables with addresses that a source declares itself: those of a project in PLCopen XML, and tag tables among exported blocks.
fn tags_beside(file: FileId, source: &str, tables: &[SymbolTable]) -> (Option<Beside>, Vec<Diagnostic>) {
    const WHAT: &str = "names and addresses of variables are";
    if plcopen::is_project(source) {
        let (text, found) = plcc_convert::symbols::write(file, tables);
        return (text.map(|text| Beside { extension: "sdf", text, what: WHAT }), found);
    }
    let text = plcc_readers::xml::tag_tables(source);
    (text.map(|text| Beside { extension: "tags.xml", text, what: WHAT }), Vec::new())
}

/// The new text of a source, whose tree is `made` from `unit`.
fn written(
    (args, to): (&ConvertArgs, ConvertTo),
    file: FileId,
    (unit, made): (&SourceUnit, &SourceUnit),
    library: &xml::Library,
    source: &SourceFile,
) -> (Converted, Vec<Diagnostic>) {
    let is_document = is_document(source);
    let source = source.text.as_str();
    let set = args.mnemonics.map_or(unit.mnemonics, Mnemonics::from);
    let is_stl = has(unit, |code| matches!(code, Code::Stl(_)));
    let whole;
    let made = match plcc_readers::xml::kind(source) {
        Some(kind @ (XmlKind::SimaticMl(_) | XmlKind::PlcOpen)) => {
            let mut blocks = whole_blocks(made, source.len() as u32);
            // Their comments are met in the order of the text.
            if matches!(kind, XmlKind::PlcOpen)
                && matches!(to, ConvertTo::Xml | ConvertTo::Sd | ConvertTo::Gr7 | ConvertTo::Stl)
            {
                blocks.blocks.sort_by_key(|block| block.span().start);
            }
            whole = blocks;
            &whole
        }
        _ => made,
    };
    let mut remarks = match &unit.overlay {
        Some(text)
            if matches!(to, ConvertTo::Xml | ConvertTo::Sd | ConvertTo::Gr7 | ConvertTo::Stl)
                && plcopen::is_project(source) =>
        {
            let comments = match to {
                ConvertTo::Stl => plcopen::comments_and_pragmas(source, text),
                _ => plcopen::comments(source, text),
            };
            Some(Remarks { text: text.clone(), comments })
        }
        _ => remarks(unit, source),
    };
    if let Some(remarks) = remarks.as_mut().filter(|_| is_stl && matches!(to, ConvertTo::Lad | ConvertTo::Fbd)) {
        remarks.comments = to_graph::other_comments(unit, &remarks.text, std::mem::take(&mut remarks.comments));
    }
    let trivia = |only_lines| match &remarks {
        Some(Remarks { text, comments }) => Trivia::new(text, comments.clone(), only_lines),
        None => Trivia::none(),
    };
    let meaning = unit.overlay.as_deref().unwrap_or(source);
    // Constants of STL and of projects in PLCopen XML have other forms, or are none there, as `S` of a list: they are not copied.
    let own = Some(meaning).filter(|_| !plcopen::is_project(source));
    let same = own.filter(|_| !is_stl);
    let name = String::new();
    match to {
        // Sources of the S7-200 and whole programs are written by others.
        ConvertTo::Awl | ConvertTo::Plcopen => {
            (Converted { name, text: source.to_string(), beside: Vec::new() }, Vec::new())
        }
        ConvertTo::Stl => {
            let (text, messages) = plcc_convert::stl::write(made, set, trivia(true), is_stl.then_some(meaning));
            warn_of_set(file, &text, set);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Lad | ConvertTo::Fbd | ConvertTo::Sd => {
            let sd::Document { text, texts, messages } = match is_document {
                true => sd::rewrite(made, trivia(false), source, to != ConvertTo::Sd),
                false if to == ConvertTo::Sd => sd::write_all(made, trivia(false), same),
                false => sd::write(made, trivia(false), same),
            };
            (Converted { name, text, beside: Vec::from_iter(texts.map(texts_beside)) }, messages)
        }
        ConvertTo::Gr7 => {
            let (text, messages) = plcc_convert::gr7::write(made, trivia(is_stl), own);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Xml => {
            let (text, messages) = plcc_convert::xml::write(made, library, trivia(is_stl), same);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Scl if plcopen::is_project(source) => {
            let trivia = Trivia::new(meaning, plcopen::comments(source, meaning), false);
            let (text, messages) = plcc_convert::scl::write(made, trivia, same, Others::LeftOut);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
        ConvertTo::Scl => {
            let (text, messages) = plcc_convert::scl::write(made, trivia(false), same, Others::Refused);
            (Converted { name, text, beside: Vec::new() }, messages)
        }
    }
}

/// Few mnemonics, such as `SE`, are in both sets: a source with no others must be read with the set that is meant.
fn warn_of_set(file: FileId, text: &str, set: Mnemonics) {
    let read = |mnemonics| {
        let (unit, _) = stl::parse(file, text, &ParseOptions { mnemonics, pragmas: false });
        ast_text(&unit).lines().skip(1).collect::<Vec<_>>().join("\n")
    };
    if read(None) != read(Some(set)) {
        let name = if set == Mnemonics::De { "de" } else { "en" };
        report::say(&format!("the text does not show its mnemonics: read it with `--mnemonics {name}`"));
    }
}
