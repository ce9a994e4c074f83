//! Statements of a block.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::s7200::ast::{self, StatementKind as Ast};
use plcc_syntax::s7200::{Insn, OperandClass};
use plcc_syntax::stl::Mnemonics;

use super::Binder;
use super::interface::Locals;
use super::meant::Form;
use super::stack::Stack;
use super::structure::Structure;
use plcc_model::s7200::{Operand, S7200Body, Statement, StatementKind};

impl Binder<'_> {
    /// The code of block `index`.
    pub fn bind_body(&mut self, index: usize) -> Option<S7200Body> {
        let block = self.blocks.get(index)?;
        let (ast, kind, locals) = (block.ast, block.kind, block.locals.clone());
        let mut stack = Stack::new(kind);
        let mut structure = Structure::default();
        let mut statements = Vec::new();
        for (position, network) in ast.networks.iter().enumerate() {
            stack.begin_network();
            let messages = self.report.diagnostics.len();
            let mut is_bound = true;
            let network_number = u16::try_from(position + 1).unwrap_or(u16::MAX);
            for statement in &network.statements {
                let span = statement.span;
                let bound = match &statement.kind {
                    Ast::Instruction { insn, mnemonic_span, operands } => {
                        let is_here = self.check_place(*insn, kind, structure.in_step(), *mnemonic_span);
                        let bound = match is_here {
                            true => self.instruction(index, &locals, *insn, *mnemonic_span, operands),
                            false => None,
                        };
                        is_bound &= bound.is_some();
                        let known = match &bound {
                            Some(StatementKind::Instruction { operands, .. }) => Some(operands.as_slice()),
                            _ => None,
                        };
                        let level = match known.and_then(<[Operand]>::first) {
                            Some(Operand::Const(level)) => Some(*level),
                            _ => None,
                        };
                        let name = self.mnemonic(*insn);
                        stack.visit(*insn, level, &name, *mnemonic_span, &mut self.report);
                        if !is_here || bound.is_none() && insn.operands().is_empty() {
                            stack.doubt();
                        }
                        structure.visit(*insn, known, span, &mut self.report);
                        bound
                    }
                    Ast::Pragma { pragma, assert } => self.statement_pragma(&locals, pragma, assert.as_deref()),
                    Ast::Error => {
                        stack.unknown();
                        is_bound = false;
                        None
                    }
                };
                let addresses = std::mem::take(&mut self.addresses);
                statements.extend(bound.map(|kind| Statement { span, network: network_number, kind, addresses }));
            }
            let next = ast.networks[position + 1..].iter().find_map(|network| network.statements.first());
            let end = next.map_or(u32::MAX, |statement| statement.span.start);
            stack.end_network(end, self.input.sources, &mut self.report);
            if !is_bound {
                self.drop_doubts(messages, network.span.start);
            }
        }
        stack.finish(&mut self.report);
        structure.finish(&mut self.report);
        Some(S7200Body { parameters: locals.formals(), statements })
    }

    /// Drops doubts among message `first` and later ones about a network that begins at byte `begin` and has an error: the error may be
    /// why a contact has no use, or a coil no contact.
    fn drop_doubts(&mut self, first: usize, begin: u32) {
        let found = self.report.diagnostics.split_off(first);
        let is_doubt = |message: &Diagnostic| {
            matches!(message.code, Code::NoContact | Code::LeftOverLevel) && message.primary.span.start >= begin
        };
        self.report.diagnostics.extend(found.into_iter().filter(|message| !is_doubt(message)));
    }

    /// The mnemonic as the sources spell it.
    pub fn mnemonic(&self, insn: Insn) -> String {
        insn.mnemonic(self.set()).into_owned()
    }

    fn set(&self) -> Mnemonics {
        let german = self.input.units.iter().find(|(_, unit)| unit.s7200.is_some());
        german.map_or(Mnemonics::En, |(_, unit)| unit.mnemonics)
    }

    /// Its operands, in words: `+I` has 2 operands, separated by `,`.
    fn form(&self, insn: Insn) -> String {
        let classes: Vec<&str> = insn.operands().iter().map(|class| describe(*class)).collect();
        let form = plcc_syntax::s7200::form(insn, self.set());
        if classes.is_empty() { form } else { format!("{form}: {}", classes.join(", then ")) }
    }

    /// The text of the source.
    pub fn written(&self, span: Span) -> String {
        let mut files = self.input.sources.files();
        let file = files.nth(span.file.0 as usize).map(|(_, file)| file.text.as_str());
        file.and_then(|text| text.get(span.range())).unwrap_or_default().to_string()
    }

    /// `+I VW0, VW2, VW4`, as the box has it: what to write for the result in a third operand.
    fn three_operands(&self, insn: Insn, operands: &[ast::Operand]) -> Option<String> {
        let [left, right, result] = operands else { return None };
        let name = self.mnemonic(insn);
        let kind = ["+", "-", "*", "/", "AND", "OR", "XOR"].into_iter().find_map(|sign| name.strip_prefix(sign))?;
        let (mov, commutes) = match kind {
            "B" => ("MOVB", true),
            "I" | "W" => ("MOVW", !name.starts_with(['-', '/'])),
            "D" => ("MOVD", !name.starts_with(['-', '/'])),
            "R" => ("MOVR", !name.starts_with(['-', '/'])),
            _ => return None,
        };
        let text = |operand: &ast::Operand| self.written(operand.span);
        let (left, right, result) = (text(left), text(right), text(result));
        Some(if result.eq_ignore_ascii_case(&left) {
            format!("write `{name} {right}, {left}`: the second operand is also the result")
        } else if !result.eq_ignore_ascii_case(&right) {
            format!(
                "write `{mov} {left}, {result}`, then `{name} {right}, {result}`: the second operand is also the result"
            )
        } else if commutes {
            format!("write `{name} {left}, {right}`: the second operand is also the result")
        } else {
            format!(
                "the second operand is also the result: calculate in another operand, then write `{mov}` to {result}"
            )
        })
    }

    /// `INCW VW0, VW2`, `SLW VW0, 3, VW2`, as boxes have it: what to write for the result in another operand.
    fn in_place(&self, locals: &Locals, insn: Insn, operands: &[ast::Operand]) -> Option<String> {
        let international = insn.mnemonic(Mnemonics::En);
        let size = match insn {
            Insn::Bcdi | Insn::Ibcd => "W",
            _ => ["INC", "DEC", "INV", "SR", "SL", "RR", "RL"]
                .iter()
                .find_map(|stem| international.strip_prefix(stem))?,
        };
        let mov = match size {
            "B" => Insn::MovB,
            "W" => Insn::MovW,
            "D" => Insn::MovD,
            _ => return None,
        };
        let is_place = |operand: &ast::Operand| {
            operand.kind != ast::OperandKind::Error
                && !matches!(self.form_of(locals, operand), Form::Constant | Form::Real)
        };
        let (input, result, count) = match operands {
            [input, result] => (input, result, None),
            [input, result, count] if !is_place(count) => (input, result, Some(count)),
            [input, count, result] => (input, result, Some(count)),
            _ => return None,
        };
        if !is_place(result) || insn.operands().len() != 1 + usize::from(count.is_some()) {
            return None;
        }
        let (name, mov) = (self.mnemonic(insn), self.mnemonic(mov));
        let (input, result) = (self.written(input.span), self.written(result.span));
        let count = count.map(|count| format!(", {}", self.written(count.span))).unwrap_or_default();
        Some(if input.eq_ignore_ascii_case(&result) {
            format!("write `{name} {input}{count}`: the first operand is also the result")
        } else {
            format!(
                "write `{mov} {input}, {result}`, then `{name} {result}{count}`: the first operand is also the result"
            )
        })
    }

    /// `INCW VW0, 2`: what to write to add another number than 1.
    fn counted_by(&self, insn: Insn, operands: &[ast::Operand]) -> Option<String> {
        let [place, number] = operands else { return None };
        let other = match insn {
            Insn::IncW => Insn::AddI,
            Insn::IncD => Insn::AddD,
            Insn::DecW => Insn::SubI,
            Insn::DecD => Insn::SubD,
            _ => return None,
        };
        Some(format!("write `{} {}, {}`", self.mnemonic(other), self.written(number.span), self.written(place.span)))
    }

    /// `S Q0.0` without a number, `SQRT VD0` without a result, `O` alone, as other controllers join two groups, and `SPA 5`, a jump in
    /// German: what to write.
    fn without_operand(&self, insn: Insn, operands: &[ast::Operand]) -> Option<String> {
        let join = match (insn, operands) {
            (Insn::Or, []) => Insn::OrLoad,
            (Insn::And, []) => Insn::AndLoad,
            (Insn::Spa, [label]) => {
                let label = self.written(label.span);
                return Some(format!("{}; a jump is `JMP {label}`", self.form(insn)));
            }
            (_, [place]) if matches!(place.kind, ast::OperandKind::Direct(_) | ast::OperandKind::Symbol { .. }) => {
                let (name, place) = (self.mnemonic(insn), self.written(place.span));
                return match insn {
                    Insn::Set | Insn::Reset | Insn::SetNow | Insn::ResetNow => {
                        Some(format!("write `{name} {place}, 1` for one bit"))
                    }
                    Insn::Sqrt | Insn::Sin | Insn::Cos | Insn::Tan | Insn::Ln | Insn::Exp => {
                        Some(format!("write `{name} {place}, {place}`, or another operand for the result"))
                    }
                    _ => None,
                };
            }
            _ => return None,
        };
        let (name, join) = (self.mnemonic(insn), self.mnemonic(join));
        Some(format!("write `{name} I0.0` for a contact; two groups that begin with loads are joined with `{join}`"))
    }

    fn instruction(
        &mut self,
        block: usize,
        locals: &Locals,
        insn: Insn,
        mnemonic: Span,
        operands: &[ast::Operand],
    ) -> Option<StatementKind> {
        if insn == Insn::Call {
            return self.call(locals, block, operands, mnemonic);
        }
        let classes = insn.operands();
        // `NOP` is written with and without its number.
        let optional = insn == Insn::Nop && operands.is_empty();
        // The rest of a line that could not be read is not a count.
        let unread = operands.iter().any(|operand| operand.kind == ast::OperandKind::Error);
        if operands.len() < classes.len() && !optional && !unread {
            let what = classes.get(operands.len()).map_or("one", |class| describe(*class));
            let help = self.without_operand(insn, operands).unwrap_or_else(|| self.form(insn));
            self.missing_operand(what, mnemonic, &help);
            // Which one is missing is not certain, and so neither what the others should be.
            return None;
        }
        if operands.len() == classes.len() + 1
            && let Some(at) = decimal_comma(classes, operands)
        {
            let (whole, part) = (&operands[at].span, &operands[at + 1].span);
            let text = self.written(whole.to(*part));
            self.push(
                Diagnostic::new(Code::ForeignForm, whole.to(*part), "a decimal number has a point")
                    .label("read as two operands")
                    .help(format!("write `{}`", text.replace(',', "."))),
            );
            return None;
        }
        if let Some(surplus) = operands.get(classes.len()).filter(|_| !unread) {
            let title = format!("`{}` has {}", self.mnemonic(insn), count(classes.len()));
            let next = operands.get(classes.len() + 1).map(|operand| self.written(operand.span).to_string());
            let written = self.written(surplus.span).to_ascii_uppercase();
            let joined = [("AND", "A"), ("OR", "O"), ("A", "A"), ("O", "O"), ("AN", "AN"), ("ON", "ON")]
                .into_iter()
                .find(|(word, _)| *word == written);
            // `LD I0.0 & I0.1`
            let second = match (&surplus.kind, classes) {
                (ast::OperandKind::AddressOf(place), [OperandClass::Bit | OperandClass::InputBit]) => {
                    Some(self.written(place.span))
                }
                _ => None,
            };
            let help = match (joined, next) {
                (Some((_, mnemonic)), Some(next)) => format!("write `{mnemonic} {next}` on a line of its own"),
                _ if let Some(operand) = &second => {
                    format!("write `{} {operand}` on a line of its own", self.mnemonic(Insn::And))
                }
                _ if matches!(classes, [OperandClass::Bit | OperandClass::BitWrite | OperandClass::InputBit]) => {
                    format!("write `{} {}` on a line of its own", self.mnemonic(insn), self.written(surplus.span))
                }
                _ if insn == Insn::Not => {
                    let (and, or) = (self.mnemonic(Insn::AndNot), self.mnemonic(Insn::OrNot));
                    format!("write `{and} {written}` or `{or} {written}`")
                }
                _ => self
                    .three_operands(insn, operands)
                    .or_else(|| self.in_place(locals, insn, operands))
                    .or_else(|| self.counted_by(insn, operands))
                    .unwrap_or_else(|| format!("remove it: {}", self.form(insn))),
            };
            self.push(
                Diagnostic::new(Code::SurplusOperand, surplus.span, title)
                    .label("the first surplus operand")
                    .help(help),
            );
            return None;
        }
        let meant = match self.other_order(locals, insn, operands) {
            Some(message) => vec![message],
            None => self.other_instruction(locals, insn, operands),
        };
        if !meant.is_empty() {
            meant.into_iter().for_each(|message| self.push(message));
            return None;
        }
        let bound: Vec<Option<Operand>> = classes
            .iter()
            .zip(operands)
            .map(|(class, operand)| match class {
                OperandClass::Interrupt => self.interrupt_operand(locals, operand),
                OperandClass::Label => self.label_operand(locals, operand),
                class => self.operand(locals, *class, operand),
            })
            .collect();
        let mut bound: Vec<Operand> = bound.into_iter().collect::<Option<_>>()?;
        if optional {
            bound.push(Operand::Const(0));
        }
        if bound.len() != classes.len() || operands.len() > classes.len() {
            return None;
        }
        self.check_values(insn, &bound, operands, mnemonic)?;
        self.uses.instruction(insn, &bound, mnemonic);
        Some(StatementKind::Instruction { insn, operands: bound })
    }
}

/// Index of the first part of a REAL that is written with a comma: `3,5`.
fn decimal_comma(classes: &[OperandClass], operands: &[ast::Operand]) -> Option<usize> {
    let whole = |operand: &ast::Operand| matches!(&operand.kind, ast::OperandKind::Constant(constant) if super::constant::whole(constant).is_some());
    classes.iter().zip(operands.windows(2)).position(|(class, pair)| {
        *class == OperandClass::RealIn && pair.iter().all(whole) && pair[0].span.end + 1 == pair[1].span.start
    })
}

fn count(operands: usize) -> String {
    match operands {
        0 => "no operand".to_string(),
        1 => "one operand".to_string(),
        count => format!("{count} operands"),
    }
}

/// The missing operand, in a few words.
fn describe(class: OperandClass) -> &'static str {
    match class {
        OperandClass::Bit
        | OperandClass::BitWrite
        | OperandClass::InputBit
        | OperandClass::OutputBit
        | OperandClass::SBit => "a bit",
        OperandClass::Count | OperandClass::SignedCount => "the number of elements",
        OperandClass::Timer => "a timer",
        OperandClass::Counter => "a counter",
        OperandClass::Number(_) => "a number",
        OperandClass::Label => "the number of a label",
        OperandClass::Interrupt => "an interrupt routine",
        OperandClass::Subroutine => "a subroutine",
        OperandClass::ByteIn | OperandClass::ByteOut | OperandClass::InputByte | OperandClass::OutputByte => "a byte",
        OperandClass::WordIn | OperandClass::IntIn | OperandClass::WordOut | OperandClass::WordOutAnalog => "a word",
        OperandClass::DwordIn | OperandClass::DintIn | OperandClass::DwordInAddress | OperandClass::DwordOut => {
            "a double word"
        }
        OperandClass::RealIn | OperandClass::RealOut => "a REAL",
        OperandClass::StringIn | OperandClass::StringOut => "a string",
        OperandClass::Buffer => "the first byte of a buffer",
        OperandClass::Table => "the first word of a table",
        OperandClass::BytesIn | OperandClass::BytesOut => "the first of several bytes",
        OperandClass::WordsIn | OperandClass::WordsOut => "the first of several words",
        OperandClass::DwordsIn | OperandClass::DwordsOut => "the first of several double words",
        OperandClass::LoopTable => "the first byte of a loop table",
    }
}

/// Name of a block of this kind with its article.
pub fn block_name(kind: BlockKind) -> &'static str {
    match kind {
        BlockKind::Sbr => "a subroutine",
        BlockKind::Int => "an interrupt routine",
        _ => "the main program",
    }
}
