//! Checks the addresses of inputs and outputs that the program uses against the modules.
//!
//! Only addresses in the text of the program are checked here; pointers are checked at run time (OB 122).

use std::collections::BTreeMap;

use plcc_abi::image::Module;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Base, Statement, StatementKind};
use plcc_model::{Actual, Body, Operand, Place, Program, StlStatement, StlStatementKind, Width};

/// The four kinds of addresses.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Area {
    Input,
    Output,
    PeripheralInput,
    PeripheralOutput,
}

impl Area {
    fn letters(self) -> &'static str {
        match self {
            Area::Input => "I",
            Area::Output => "Q",
            Area::PeripheralInput => "PI",
            Area::PeripheralOutput => "PQ",
        }
    }

    fn is_input(self) -> bool {
        matches!(self, Area::Input | Area::PeripheralInput)
    }

    fn is_peripheral(self) -> bool {
        matches!(self, Area::PeripheralInput | Area::PeripheralOutput)
    }
}

/// Messages about the uses of a program with modules: a warning for each range of bytes that no module has, an error for a
/// peripheral access of the wrong direction or width.
pub fn check_modules(program: &Program) -> Vec<Diagnostic> {
    let Some(modules) = &program.config.modules else { return Vec::new() };
    let mut uses = Uses { program, modules, missing: BTreeMap::new(), diagnostics: Vec::new() };
    for block in &program.blocks {
        match &block.body {
            Body::Stl(statements) => statements.iter().for_each(|statement| uses.stl_statement(statement)),
            Body::Scl(body) => walk::statements(&body.statements, &mut uses),
            Body::S7200(_) | Body::Runtime => {}
        }
    }
    uses.finish()
}

fn width_bytes(width: Width) -> u32 {
    match width {
        Width::Bit | Width::Byte => 1,
        Width::Word => 2,
        Width::Dword => 4,
        Width::Lword => 8,
    }
}

fn passing_bytes(passing: Option<plcc_model::Passing>) -> u32 {
    match passing {
        Some(plcc_model::Passing::Elementary(width)) => width_bytes(width),
        Some(plcc_model::Passing::Complex { bytes }) => bytes,
        _ => 1,
    }
}

struct Uses<'a> {
    program: &'a Program,
    modules: &'a [Module],
    /// Bytes that no module has, with their first use in the sources.
    missing: BTreeMap<(Area, u32), Span>,
    diagnostics: Vec<Diagnostic>,
}

impl Visitor for Uses<'_> {
    fn statement(&mut self, statement: &Statement) {
        if let StatementKind::Stl(statement) = &statement.kind {
            self.stl_statement(statement);
        }
    }

    fn access(&mut self, access: &Access, _role: Role) {
        if let (Base::Place(place), Some(ty)) = (&access.base, access.elementary()) {
            self.place(place, ty.bits().div_ceil(8), access.span);
        }
    }
}

impl Uses<'_> {
    fn stl_statement(&mut self, statement: &StlStatement) {
        match &statement.kind {
            StlStatementKind::Instruction { operand: Operand::Memory { place, width }, .. } => {
                self.place(place, width_bytes(*width), statement.span);
            }
            StlStatementKind::Call(call) => {
                for argument in &call.arguments {
                    if let Actual::Place(place) = &argument.actual {
                        let ty = self.program.block(call.target).and_then(|block| {
                            block.interface.parameters.get(argument.parameter).map(|parameter| parameter.passing)
                        });
                        self.place(place, passing_bytes(ty), argument.span);
                    }
                }
            }
            _ => {}
        }
    }

    fn place(&mut self, place: &Place, bytes: u32, span: Span) {
        let (area, start) = match *place {
            Place::I { byte, .. } => (Area::Input, byte),
            Place::Q { byte, .. } => (Area::Output, byte),
            Place::Pi { byte, .. } => (Area::PeripheralInput, byte),
            Place::Pq { byte, .. } => (Area::PeripheralOutput, byte),
            Place::Indirect { ref pointer, .. } => return self.place(pointer, 4, span),
            Place::Element { ref base, ref indices } => {
                indices.iter().for_each(|index| self.place(&index.place, index.ty.bits().div_ceil(8), span));
                return self.place(base, bytes, span);
            }
            _ => return,
        };
        let missing: Vec<u32> =
            (start..start + bytes).filter(|&byte| self.module(byte, area.is_input()).is_none()).collect();
        let Some(&first) = missing.first() else { return };
        if area.is_peripheral() {
            let address = format!("{}{} {start}", area.letters(), letter(bytes));
            let other = self.module(start, !area.is_input());
            let here = self.module(start, area.is_input());
            if let Some(module) = here {
                let title =
                    format!("{address} is wider than the module `{}`, which ends before byte {first}", module.name);
                let message = Diagnostic::new(Code::ModuleAccess, span, title);
                return self.diagnostics.push(message.help("access only the bytes that the module has"));
            }
            if let Some(module) = other {
                let (has, wrong) = if area.is_input() { ("outputs", "reads") } else { ("inputs", "writes") };
                let title = format!("{address} {wrong} the module `{}`, which has only {has} there", module.name);
                let message = Diagnostic::new(Code::ModuleAccess, span, title);
                return self.diagnostics.push(
                    message.help("inputs are read (PI), outputs are written (PQ); `plcc station` lists the addresses"),
                );
            }
        }
        for byte in missing {
            let first = self.missing.entry((area, byte)).or_insert(span);
            if (span.file, span.start) < (first.file, first.start) {
                *first = span;
            }
        }
    }

    fn module(&self, byte: u32, input: bool) -> Option<&Module> {
        self.modules.iter().find(|module| {
            let (start, bytes) = match input {
                true => (module.input_start, module.input_bytes),
                false => (module.output_start, module.output_bytes),
            };
            byte >= start && byte - start < bytes
        })
    }

    fn finish(mut self) -> Vec<Diagnostic> {
        let bytes: Vec<((Area, u32), Span)> = self.missing.into_iter().collect();
        for range in bytes.chunk_by(|a, b| a.0.0 == b.0.0 && a.0.1 + 1 == b.0.1) {
            let ((area, first), (_, last)) = (range[0].0, range[range.len() - 1].0);
            let text = match range.len() {
                1 => format!("{}B {first}", area.letters()),
                _ => format!("{0}B {first} to {0}B {last}", area.letters()),
            };
            // The first use in the sources.
            let span =
                range.iter().map(|(_, span)| *span).min_by_key(|span| (span.file, span.start)).unwrap_or(range[0].1);
            let effect = match (area.is_peripheral(), area.is_input()) {
                (true, _) => "the access is an I/O access error (OB 122)",
                (false, true) => "they read 0",
                (false, false) => "nothing is put out",
            };
            let title = format!("no module of the station has {text}");
            self.diagnostics.push(
                Diagnostic::new(Code::NoModule, span, title)
                    .label(effect)
                    .help("add the module to `[station]` in plc.toml, or use an address that `plcc station` lists"),
            );
        }
        self.diagnostics
    }
}

fn letter(bytes: u32) -> &'static str {
    match bytes {
        1 => "B",
        2 => "W",
        _ => "D",
    }
}
