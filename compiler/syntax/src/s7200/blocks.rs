//! Turns lines into blocks and networks: framed blocks, flat lists with `MEND`, `SBR 0`, `INT 0`, and files without any header.

use plcc_diag::{Code, Diagnostic, FileId, Span};

use super::Insn;
use super::ast::{Block, BlockKind, DataLine, Network, Section, Source, Statement, StatementKind};
use super::line::{BlockLabel, Line, LineKind};

/// Turns the lines of a file into blocks.
pub fn build(file: FileId, lines: Vec<Line>, bare_data: bool, diagnostics: &mut Vec<Diagnostic>) -> Source {
    let mut builder = Builder {
        source: Source::default(),
        open: None,
        pending: Vec::new(),
        next_network: None,
        after: After::Nothing,
        data: None,
        bare_data,
        end: Span { file, start: 0, end: 0 },
        diagnostics,
    };
    for line in lines {
        builder.line(line);
    }
    builder.close();
    builder.source
}

/// What ended before a line that is outside blocks.
#[derive(Clone, Copy, PartialEq, Eq)]
enum After {
    Nothing,
    /// A block with a header.
    Frame,
    /// A section of a flat list.
    Section,
    /// The same, and a statement after it has been reported.
    Reported,
}

struct Open {
    block: Block,
    /// After `BEGIN`, or after the first network or statement.
    in_code: bool,
    /// The section whose variables are being declared.
    section: Option<(Section, Span)>,
    /// Begins with `SBR 0`, `INT 0`.
    marked: bool,
}

struct Builder<'d> {
    source: Source,
    open: Option<Open>,
    /// Comment lines that belong to what comes next.
    pending: Vec<String>,
    /// A network of a flat list before the marker of its section.
    next_network: Option<Network>,
    after: After,
    /// The `DATA_BLOCK` line.
    data: Option<Span>,
    bare_data: bool,
    /// The last line.
    end: Span,
    diagnostics: &'d mut Vec<Diagnostic>,
}

impl Builder<'_> {
    fn report(&mut self, code: Code, span: Span, title: impl Into<String>, label: &str, help: &str) {
        self.diagnostics.push(Diagnostic::new(code, span, title).label(label).help(help));
    }

    fn line(&mut self, line: Line) {
        let Line { kind, comment, span } = line;
        match kind {
            LineKind::Header(kind, label) => self.header(kind, label, span),
            LineKind::EndBlock(kind) => self.end_block(kind, span),
            LineKind::DataHeader => {
                self.close();
                self.data = Some(span);
            }
            LineKind::EndData => {
                if self.data.take().is_none() {
                    let help = "a data block begins with `DATA_BLOCK DB1`";
                    self.report(Code::BlockFrame, span, "`END_DATA_BLOCK` ends nothing", "no data block is open", help);
                }
            }
            LineKind::Title(title) => self.title(title, span),
            LineKind::Section(section) => self.section(section, span),
            LineKind::EndVar => {
                let ended = self.open.as_mut().and_then(|open| open.section.take());
                if ended.is_none() {
                    let help = "a section begins with `VAR_INPUT`, `VAR_IN_OUT`, `VAR_OUTPUT` or `VAR`";
                    self.report(Code::DeclarationSyntax, span, "`END_VAR` ends nothing", "no section is open", help);
                }
            }
            LineKind::Declarations(declarations) => {
                self.pending.clear();
                if let Some(open) = &mut self.open
                    && let Some((section, _)) = open.section
                {
                    let last = declarations.len();
                    open.block.declarations.extend(declarations.into_iter().zip(1..).map(
                        |(mut declaration, number)| {
                            declaration.section = section;
                            declaration.comment = comment.clone().filter(|_| number == last);
                            declaration
                        },
                    ));
                }
            }
            LineKind::Begin => self.begin(span),
            LineKind::Network { number, title } => self.network(number, title, span),
            LineKind::Marker(kind, number) => self.marker(kind, number, span),
            LineKind::Data(has_address, operands) => self.data_line(has_address, operands, span),
            LineKind::Instruction { insn, mnemonic, operands } => {
                let kind = StatementKind::Instruction { insn, mnemonic_span: mnemonic, operands };
                self.statement(Statement { kind, span, comment });
                self.end = span;
                self.end_section(insn);
            }
            LineKind::Pragma(pragma, assert) => {
                let misplaced = match &self.open {
                    Some(open) => !open.in_code && !open.block.is_bare,
                    None => self.after != After::Nothing || self.data.is_some() || self.bare_data,
                };
                if misplaced {
                    let help = "write pragmas between the statements of a block";
                    return self.report(
                        Code::Pragma,
                        span,
                        "this pragma belongs to no statement",
                        "outside of the statements",
                        help,
                    );
                }
                self.statement(Statement {
                    kind: StatementKind::Pragma { pragma: *pragma, assert },
                    span,
                    comment: None,
                });
            }
            LineKind::Comment => self.pending.extend(comment),
            LineKind::Bad => {
                if self.open.as_ref().is_some_and(|open| open.in_code) {
                    self.statement(Statement { kind: StatementKind::Error, span, comment });
                }
            }
        }
        self.end = span;
    }

    fn opened(&mut self, kind: BlockKind, span: Span, is_bare: bool) -> &mut Open {
        let block = Block {
            kind,
            name: None,
            number: None,
            is_bare,
            title: String::new(),
            comment: Vec::new(),
            declarations: Vec::new(),
            networks: Vec::new(),
            span,
        };
        self.open.insert(Open { block, in_code: false, section: None, marked: false })
    }

    /// Ends what is open; a frame that is not closed is reported.
    fn close(&mut self) {
        if let Some(header) = self.data.take() {
            let help = "end it with `END_DATA_BLOCK`";
            self.report(Code::BlockFrame, header, "this data block is not closed", "begins here", help);
        }
        self.end_declarations();
        if let Some(open) = &self.open
            && !open.block.is_bare
        {
            let (span, help) = (open.block.span, format!("end it with `{}`", open.block.kind.end_keyword()));
            self.report(Code::BlockFrame, span, "this block is not closed", "begins here", &help);
        }
        self.finish();
    }

    /// Adds the open block to the source.
    fn finish(&mut self) {
        let pending = std::mem::take(&mut self.pending);
        let Some(Open { mut block, .. }) = self.open.take() else { return };
        match block.networks.last_mut() {
            Some(network) if network.statements.is_empty() => network.comment.extend(pending),
            None if block.comment.is_empty() => block.comment = pending,
            _ => {}
        }
        block.span = block.span.to(self.end);
        self.after = if block.is_bare { After::Section } else { After::Frame };
        self.source.blocks.push(block);
    }

    fn header(&mut self, kind: BlockKind, label: BlockLabel, span: Span) {
        self.close();
        self.pending.clear();
        let BlockLabel { name, number } = label;
        if name.is_none() && number.is_none() {
            let help = format!("write `{} name:{}`", kind.keyword(), letters(kind, 0));
            self.report(Code::BlockFrame, span, "this block has no name", "a name or a number is missing", &help);
        }
        if let Some((written, at, number_span)) = number {
            if written != kind {
                let title = format!("`{}` cannot be numbered as `{}`", kind.keyword(), letters(written, at));
                let help = format!("write `{}`", letters(kind, at));
                self.report(Code::BlockFrame, number_span, title, "the number of another kind of block", &help);
            } else if kind == BlockKind::Main && at != 1 {
                let title = format!("the S7-200 does not have OB{at}");
                self.report(Code::BlockFrame, number_span, title, "the main program is OB1", "write `OB1`");
            }
        }
        self.end = span;
        let open = self.opened(kind, span, false);
        open.block.name = name;
        open.block.number = number.map(|(_, number, span)| (number, span));
    }

    fn end_block(&mut self, kind: BlockKind, span: Span) {
        self.end_declarations();
        match &self.open {
            Some(open) if !open.block.is_bare => {
                let own = open.block.kind;
                if own != kind {
                    let title = format!("`{}` cannot end this block", kind.end_keyword());
                    let help = format!("write `{}`", own.end_keyword());
                    self.report(Code::BlockFrame, span, title, "the end of another kind of block", &help);
                }
            }
            _ => {
                let title = format!("`{}` ends nothing", kind.end_keyword());
                let help = format!("the block begins with `{} name:{}`", kind.keyword(), letters(kind, 0));
                self.report(Code::BlockFrame, span, title, "no block with a header is open", &help);
            }
        }
        self.end = span;
        self.finish();
    }

    fn title(&mut self, title: String, span: Span) {
        if self.data.is_some() || self.bare_data {
            return;
        }
        if self.open.is_none() && self.after == After::Nothing {
            self.opened(BlockKind::Main, span, true);
        }
        let Some(open) = &mut self.open else { return };
        if !open.in_code {
            open.block.title = title;
            return;
        }
        match open.block.networks.last_mut() {
            Some(network) if network.statements.is_empty() && network.title.is_empty() => network.title = title,
            _ => {
                let help = "write a title after the header of its block, or after `NETWORK`";
                self.report(
                    Code::BlockFrame,
                    span,
                    "a title is not allowed among statements",
                    "not the title of anything",
                    help,
                );
            }
        }
    }

    fn section(&mut self, section: Section, span: Span) {
        self.end_declarations();
        if self.data.is_some() || self.bare_data {
            let help = "a line of a data block is an address and its values: `VW10 -5, 300`";
            return self.report(
                Code::BlockFrame,
                span,
                "a data block declares no variables",
                "not possible here",
                help,
            );
        }
        if self.open.is_none() {
            self.opened(BlockKind::Main, span, true);
        }
        let Some(open) = &mut self.open else { return };
        open.section = Some((section, span));
        let (late, kind, is_bare) = (open.in_code, open.block.kind, open.block.is_bare);
        if late {
            let help = "write the declarations of a block before `BEGIN`";
            self.report(
                Code::DeclarationSyntax,
                span,
                "declarations are not allowed among statements",
                "too late",
                help,
            );
        } else if section != Section::Temp && kind != BlockKind::Subroutine && !is_bare {
            let help = "write `VAR`; values reach it by V, M and other global addresses";
            let title = "only subroutines have parameters";
            self.report(Code::SectionNotAllowed, span, title, "this block is called by the CPU", help);
        }
    }

    /// A section that is still open where its block continues.
    fn end_declarations(&mut self) {
        if let Some((_, span)) = self.open.as_mut().and_then(|open| open.section.take()) {
            let help = "end it with `END_VAR`";
            self.report(Code::DeclarationSyntax, span, "this section is not closed", "begins here", help);
        }
    }

    fn begin(&mut self, span: Span) {
        self.end_declarations();
        if self.data.is_some() || self.bare_data {
            return;
        }
        let pending = std::mem::take(&mut self.pending);
        match &mut self.open {
            Some(open) if !open.in_code => {
                open.in_code = true;
                open.block.comment.extend(pending);
            }
            Some(_) => {
                self.report(
                    Code::BlockFrame,
                    span,
                    "this block has a second `BEGIN`",
                    "the second one",
                    "leave it out",
                );
            }
            None => {
                let help = "a block begins with its header: `SUBROUTINE_BLOCK name:SBR3`";
                self.report(Code::BlockFrame, span, "`BEGIN` belongs to no block", "no header before it", help);
            }
        }
    }

    fn network(&mut self, number: Option<i64>, title: String, span: Span) {
        self.end_declarations();
        let number = number.and_then(|number| u32::try_from(number).ok());
        let mut network = Network { number, title, comment: Vec::new(), statements: Vec::new(), span };
        if self.data.is_some() || self.bare_data {
            let help = "end the data block with `END_DATA_BLOCK` first";
            return self.report(
                Code::BlockFrame,
                span,
                "a data block cannot contain networks",
                "not possible here",
                help,
            );
        }
        let pending = std::mem::take(&mut self.pending);
        if self.open.is_none() {
            if self.after != After::Nothing {
                network.comment = pending;
                self.next_network = Some(network);
                return;
            }
            self.opened(BlockKind::Main, span, true);
        }
        let Some(open) = &mut self.open else { return };
        if open.in_code {
            network.comment = pending;
        } else {
            open.in_code = true;
            open.block.comment.extend(pending);
        }
        let twice = network.number.is_some() && open.block.networks.iter().any(|other| other.number == network.number);
        open.block.networks.push(network);
        if twice {
            let title = format!("this block has two networks with the number {}", number.unwrap_or_default());
            self.report(Code::Tolerated, span, title, "the second one", "number the networks in the order of the text");
        }
    }

    /// `SBR 0`, `INT 0` begin a section of a flat list.
    fn marker(&mut self, kind: BlockKind, number: Option<(u32, Span)>, span: Span) {
        if self.data.is_some() || self.open.as_ref().is_some_and(|open| !open.block.is_bare) {
            let help = format!("end the block, and begin the next with `{} name:{}`", kind.keyword(), letters(kind, 0));
            let title = "a section of a flat list cannot begin inside a block";
            return self.report(Code::BlockFrame, span, title, "only in sources without block headers", &help);
        }
        let mut network = self.next_network.take();
        if let Some(open) = &mut self.open
            && open.block.networks.last().is_some_and(|last| last.statements.is_empty())
        {
            network = open.block.networks.pop();
        }
        let pending = std::mem::take(&mut self.pending);
        self.finish();
        self.end = span;
        let open = self.opened(kind, span, true);
        open.block.number = number;
        open.block.comment = pending;
        open.block.networks.extend(network);
        open.in_code = true;
        open.marked = true;
    }

    /// `MEND`, and `RET` and `RETI` of a section, end the section or program that contains them.
    fn end_section(&mut self, insn: Insn) {
        let ends = self.open.as_ref().is_some_and(|open| {
            open.block.is_bare
                && match open.block.kind {
                    BlockKind::Main => insn == Insn::Mend,
                    BlockKind::Subroutine => open.marked && insn == Insn::Ret,
                    BlockKind::Interrupt => open.marked && insn == Insn::Reti,
                }
        });
        if ends {
            self.finish();
        }
    }

    fn data_line(&mut self, has_address: bool, operands: Vec<super::ast::Operand>, span: Span) {
        self.pending.clear();
        let mut operands = operands.into_iter();
        let address = if has_address { operands.next() } else { None };
        let values: Vec<_> = operands.collect();
        if values.is_empty() {
            let help = "a line is an address and its values: `VW10 -5, 300`";
            self.report(
                Code::Syntax,
                span,
                "a line of a data block has no value",
                "a value is missing after this",
                help,
            );
        }
        self.source.data.push(DataLine { address, values, span });
    }

    fn statement(&mut self, mut statement: Statement) {
        self.end_declarations();
        if self.open.is_none() {
            match self.after {
                After::Nothing => {
                    self.opened(BlockKind::Main, statement.span, true);
                }
                After::Reported => return,
                After::Frame | After::Section => {
                    let frame = self.after == After::Frame;
                    self.after = After::Reported;
                    let help = match frame {
                        true => "begin the next block with its header: `SUBROUTINE_BLOCK name:SBR3`",
                        false => "begin the next section with `SBR 3` or `INT 0`",
                    };
                    let title = "this statement belongs to no block";
                    return self.report(Code::BlockFrame, statement.span, title, "after the end of a block", help);
                }
            }
        }
        let pending = std::mem::take(&mut self.pending);
        let Some(open) = &mut self.open else { return };
        let Block { comment, networks, is_bare, .. } = &mut open.block;
        let mut lines = pending;
        if !open.in_code {
            open.in_code = true;
            if !*is_bare {
                comment.append(&mut lines);
            }
        }
        if networks.is_empty() {
            networks.push(Network {
                number: None,
                title: String::new(),
                comment: Vec::new(),
                statements: Vec::new(),
                span: statement.span,
            });
        } else if let Some(network) = networks.last_mut()
            && network.statements.is_empty()
        {
            network.comment.append(&mut lines);
        }
        lines.extend(statement.comment.take());
        statement.comment = Some(lines.join("\n")).filter(|text| !text.is_empty());
        if let Some(network) = networks.last_mut() {
            network.statements.push(statement);
        }
    }
}

fn letters(kind: BlockKind, number: u32) -> String {
    match kind {
        BlockKind::Main => "OB1".to_owned(),
        BlockKind::Subroutine => format!("SBR{number}"),
        BlockKind::Interrupt => format!("INT{number}"),
    }
}
