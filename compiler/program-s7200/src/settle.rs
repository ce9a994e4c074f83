//! What an operand is, whatever the instruction needs: symbols are replaced by their addresses, addresses are in the CPU's range.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{self, Area, Constant, Direct, OperandKind, Shown, SymbolForm};
use plcc_syntax::s7200::{self, OperandClass, libraries};

use super::address;
use super::call::{of_library, of_wizard, what};
use super::interface::{Locals, Type};
use super::names::{block_kind, fold};
use super::{Binder, operand};
use plcc_binding::report::{MissingKey, bit_without_number, hexadecimal};
use plcc_model::s7200::Operand;

/// Names of special memory in the symbol tables of Micro/WIN.
const SPECIAL_BITS: [(&str, &str); 9] = [
    ("Always_On", "SM0.0"),
    ("First_Scan_On", "SM0.1"),
    ("First_Scan", "SM0.1"),
    ("Retentive_Lost", "SM0.2"),
    ("RUN_Power_Up", "SM0.3"),
    ("Clock_60s", "SM0.4"),
    ("Clock_1s", "SM0.5"),
    ("Clock_Scan", "SM0.6"),
    ("Mode_Switch", "SM0.7"),
];

/// An operand whose names are settled.
#[derive(Clone, Debug)]
pub enum Settled {
    /// Its range is checked once its width is known.
    Direct(Direct),
    /// A variable of type STRING: the place of its pointer.
    StringVariable(Direct),
    Constant(Constant),
    /// `&VB100`.
    Pointer(u32),
    /// `*VD200`: the place of the pointer.
    Indirect(Operand),
    /// A block that exists.
    Block(usize),
}

impl Binder<'_> {
    /// Settles an operand; `None`: reported. `text`: a name in double quotes is a string constant.
    pub fn settle(&mut self, locals: &Locals, operand: &ast::Operand, text: bool) -> Option<Settled> {
        let span = operand.span;
        if let Some(shown) = &operand.shown {
            self.check_shown(locals, shown, operand)?;
        }
        match &operand.kind {
            OperandKind::Direct(direct) => Some(Settled::Direct(*direct)),
            OperandKind::Constant(constant) => Some(Settled::Constant(constant.clone())),
            OperandKind::Indirect(pointer) => self.settle_pointer(locals, pointer).map(Settled::Indirect),
            OperandKind::AddressOf(place) => self.settle_address(locals, place, span),
            OperandKind::Symbol { name, form: SymbolForm::Quoted } if text => {
                Some(Settled::Constant(Constant::Text(characters(name))))
            }
            OperandKind::Symbol { name, form } => self.settle_symbol(locals, name, *form, span),
            OperandKind::Block { kind, number } => {
                let name = operand.shown.as_ref().map(|shown| shown.name.as_str());
                self.settle_block(block_kind(*kind), *number, name, span)
            }
            OperandKind::Error => None,
        }
    }

    fn settle_symbol(&mut self, locals: &Locals, name: &str, form: SymbolForm, span: Span) -> Option<Settled> {
        if form != SymbolForm::Quoted && locals.is_unknown(name) {
            return None;
        }
        if form != SymbolForm::Quoted
            && let Some(local) = locals.find(name)
        {
            return Some(match local.ty {
                Type::String => Settled::StringVariable(local.place),
                _ => Settled::Direct(local.place),
            });
        }
        if form == SymbolForm::Local {
            self.unknown_local(locals, name, span);
            return None;
        }
        if let Some(global) = self.globals.get(&fold(name)) {
            return match global.target.clone() {
                OperandKind::Direct(direct) => Some(Settled::Direct(direct)),
                OperandKind::Constant(constant) => Some(Settled::Constant(constant)),
                OperandKind::Block { kind, number } => self.settle_block(block_kind(kind), number, Some(name), span),
                OperandKind::Indirect(_)
                | OperandKind::AddressOf(_)
                | OperandKind::Symbol { .. }
                | OperandKind::Error => {
                    let row = global.span;
                    let title = format!("the symbol `{name}` has no address of the S7-200");
                    self.push(
                        Diagnostic::new(Code::UnknownSymbol, span, title)
                            .label("used here")
                            .also(row, "its row in the symbol table")
                            .help("correct the address in the table"),
                    );
                    None
                }
            };
        }
        if let Some(&index) = self.by_name.get(&fold(name)) {
            return Some(Settled::Block(index));
        }
        self.unknown_symbol(locals, name, span);
        None
    }

    /// The number of a label. A name that no symbol has was meant as the label itself.
    pub fn label_operand(&mut self, locals: &Locals, operand: &ast::Operand) -> Option<Operand> {
        if let OperandKind::Symbol { name, form: SymbolForm::Bare } = &operand.kind
            && locals.find(name).is_none()
            && !self.globals.contains_key(&fold(name))
            && !self.by_name.contains_key(&fold(name))
        {
            let span = operand.span;
            let digits = name.trim_start_matches(|c: char| !c.is_ascii_digit());
            let help = match digits.parse::<u8>() {
                Ok(number) => format!("write `{number}`"),
                Err(_) => "write a number in its place, as in `JMP 1` and `LBL 1`".to_string(),
            };
            self.report.missing(MissingKey::Symbol(fold(name)), span, || {
                Diagnostic::new(Code::OperandKind, span, format!("`{name}` is not the number of a label"))
                    .label("the labels of the S7-200 are numbers")
                    .help(help)
            });
            return None;
        }
        self.operand(locals, OperandClass::Label, operand)
    }

    /// `Start:I0.0`: the symbol must stand for this address or block. `None`: it stands for another one, reported. A symbol that nothing
    /// declares says no more than its address.
    fn check_shown(&mut self, locals: &Locals, shown: &Shown, operand: &ast::Operand) -> Option<()> {
        let name = &shown.name;
        let is_block = matches!(operand.kind, OperandKind::Block { .. });
        let local = locals.find(name).filter(|_| shown.form != SymbolForm::Quoted && !is_block);
        let is_global = local.is_none() && shown.form != SymbolForm::Local;
        let global = self.globals.get(&fold(name)).filter(|_| is_global);
        let own = self.by_name.get(&fold(name)).filter(|_| is_global).and_then(|index| self.blocks.get(*index));
        let (meant, row) = match (local, global, own) {
            (Some(local), _, _) => (Some(address::text(local.place)), None),
            (None, Some(global), _) => (place_text(&global.target), Some(global.span)),
            (None, None, Some(block)) => (Some(format!("{}{}", block.kind.prefix(), block.number)), None),
            (None, None, None) => (None, None),
        };
        let (Some(meant), Some(written)) = (meant, place_text(&operand.kind)) else { return Some(()) };
        if meant == written {
            return Some(());
        }
        let symbol = if shown.form == SymbolForm::Local { format!("#{name}") } else { name.clone() };
        let title = format!("`{symbol}` is {meant}, not {written} (0090)");
        let message = Diagnostic::new(Code::OperandKind, operand.span, title)
            .label("symbol and address do not go together")
            .help(format!("write the one that is meant: `{symbol}` or `{written}`"));
        self.push(match row {
            Some(row) => message.also(row, "its row in the symbol table"),
            None => message,
        });
        None
    }

    fn unknown_local(&mut self, locals: &Locals, name: &str, span: Span) {
        let near: Vec<String> = self.nearest(name, locals).into_iter().filter(|name| name.starts_with('#')).collect();
        let message =
            Diagnostic::new(Code::UnknownLocal, span, format!("the block declares no local variable `{name}`"))
                .label("`#` means a variable of this block");
        self.push(match near.as_slice() {
            _ if name.bytes().all(|digit| digit.is_ascii_digit()) => {
                message.help(format!("a constant has no `#`: write `{name}`"))
            }
            [] if name.len() > 1 && name.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'A'..=b'F')) => {
                message.help(format!("declare it, or write `16#{name}` if a hexadecimal number is meant"))
            }
            [] => message.help("declare it, or remove the `#` if a global symbol is meant"),
            _ => message.help(format!("is {} meant?", near.join(" or "))),
        });
    }

    fn unknown_symbol(&mut self, locals: &Locals, name: &str, span: Span) {
        let near = self.nearest(name, locals);
        let has_tables = !self.globals.is_empty();
        self.report.missing(MissingKey::Symbol(fold(name)), span, || {
            let message = Diagnostic::new(Code::UnknownSymbol, span, format!("the symbol `{name}` is not defined"))
                .label("no symbol table and no block has this name");
            if let Some(help) = bit_without_number(name, &["I", "Q", "M", "SM", "V", "S", "L"]) {
                return message.help(help);
            }
            // As STEP 5 writes it.
            let digits = name.strip_prefix(['K', 'k']).filter(|digits| digits.parse::<u32>().is_ok());
            if let Some(digits) = digits {
                return message.help(format!("a constant has no letter: write `{digits}`"));
            }
            if let Some(address) = s7200::with_zeros(name) {
                return message.help(format!("write the digit 0 in place of the letter O: `{address}`"));
            }
            if let Some(number) = hexadecimal(name) {
                return message.help(format!("a hexadecimal number begins with `16#`: write `{number}`"));
            }
            if let Some((_, bit)) = SPECIAL_BITS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
                return message
                    .help(format!("a name of special memory: write `{bit}`, or add the symbol table of the project"));
            }
            if let Some(channels) = analog_channels(name) {
                return message.help(channels);
            }
            if let Some(number @ ("0" | "1" | "2" | "3" | "4" | "5")) = fold(name).strip_prefix("hsc") {
                return message.help(format!(
                    "the value of the counter is `HC{number}`; HDEF and HSC take its number, `{number}`"
                ));
            }
            let is_quoted = span.end - span.start == name.len() as u32 + 2;
            match (near.as_slice(), has_tables) {
                ([], _) if is_quoted && name.chars().count() <= 4 => message.help(format!(
                    "add it to a symbol table of the project; characters are written in single quotes: `'{name}'`"
                )),
                ([], false) => message.help("add the symbol table of the project to the sources"),
                ([], true) => message.help("add it to the symbol table, or write the address"),
                _ => message.help(format!("names like it: {}", near.join(", "))),
            }
        });
    }

    /// The block with a number, and the symbol by which it is named.
    pub fn settle_block(&mut self, kind: BlockKind, number: u32, symbol: Option<&str>, span: Span) -> Option<Settled> {
        let key = u16::try_from(number).ok().map(|number| (kind, number));
        if let Some(&index) = key.and_then(|key| self.by_number.get(&key)) {
            return Some(Settled::Block(index));
        }
        let name = format!("{}{number}", kind.prefix());
        self.report.missing(MissingKey::Symbol(fold(&name)), span, || {
            let title = match symbol {
                Some(symbol) => format!("the {} `{symbol}`, {name}, is not defined (0087)", what(kind)),
                None => format!("{name} is not defined (0087)"),
            };
            let message = Diagnostic::new(Code::UnknownBlock, span, title);
            if let Some((symbol, known)) = symbol.and_then(|symbol| Some((symbol, libraries::subroutine(symbol)?))) {
                return of_library(message, symbol, &known);
            }
            if let Some((symbol, purpose)) = symbol.and_then(|symbol| Some((symbol, libraries::wizard(symbol)?))) {
                return of_wizard(message, symbol, purpose);
            }
            message.label("no source of the program has this block").help("add the source that defines it")
        });
        None
    }

    /// The variable with a pointer: a double word of V or L, or AC1 to AC3.
    fn settle_pointer(&mut self, locals: &Locals, pointer: &ast::Operand) -> Option<Operand> {
        let direct = match self.settle(locals, pointer, false)? {
            Settled::Direct(direct) | Settled::StringVariable(direct) => direct,
            Settled::Constant(_) | Settled::Pointer(_) | Settled::Indirect(_) | Settled::Block(_) => {
                self.no_pointer("this cannot hold a pointer", pointer.span);
                return None;
            }
        };
        match (direct.area, direct.width, direct.number) {
            (Area::V | Area::L, Some(Width::Dword), _) => {
                self.check_range(direct, Width::Dword, 1, pointer.span)?;
                operand::memory(direct, Width::Dword)
            }
            (Area::Ac, None | Some(Width::Dword), 1..=3) => {
                Some(Operand::Accumulator { number: direct.number as u8, width: Width::Dword })
            }
            (Area::Ac, _, 0) => {
                self.no_pointer("AC0 cannot hold a pointer", pointer.span);
                None
            }
            _ => {
                self.no_pointer(&format!("{} cannot hold a pointer", address::text(direct)), pointer.span);
                None
            }
        }
    }

    fn no_pointer(&mut self, title: &str, span: Span) {
        self.push(
            Diagnostic::new(Code::OperandKind, span, format!("{title} (0090)"))
                .label("a pointer must follow `*`")
                .help("pointers are in double words of V or L, or in AC1, AC2, AC3: `*VD200`, `*AC1`"),
        );
    }

    fn settle_address(&mut self, locals: &Locals, place: &ast::Operand, span: Span) -> Option<Settled> {
        let direct = match self.settle(locals, place, false)? {
            Settled::Direct(direct) => Some(direct),
            Settled::StringVariable(_)
            | Settled::Constant(_)
            | Settled::Pointer(_)
            | Settled::Indirect(_)
            | Settled::Block(_) => None,
        };
        if let Some(direct) = direct
            && let Some(pointer) = address::pointer_to(direct)
        {
            let width = match direct.area {
                Area::T | Area::C | Area::Ai | Area::Aq => Width::Word,
                _ => direct.width.unwrap_or(Width::Byte),
            };
            self.check_range(direct, width, 1, place.span)?;
            self.addresses.push(operand::place(direct, width));
            return Some(Settled::Pointer(pointer));
        }
        self.push(
            Diagnostic::new(Code::OperandKind, span, "this has no address for a pointer (0090)")
                .label("bits, local memory, accumulators, high-speed counters and constants cannot be the target of a pointer")
                .help("use the address of a byte, word or double word: `&VB100`"),
        );
        None
    }
}

/// What is meant by `PIW256`, an address of S7-300/400.
fn analog_channels(name: &str) -> Option<String> {
    let (letters, number) = name.split_at_checked(3)?;
    let (what, own) = match letters.to_ascii_uppercase().as_str() {
        "PIW" => ("inputs", "AIW"),
        "PEW" => ("inputs", "AEW"),
        "PQW" => ("outputs", "AQW"),
        "PAW" => ("outputs", "AAW"),
        _ => return None,
    };
    let is_number = !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit());
    is_number.then(|| format!("the analog {what} of the S7-200 are `{own}0`, `{own}2` and so on"))
}

/// The characters of a name as in a string of the CPU, one byte each if they have one.
fn characters(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    for letter in text.chars() {
        match u8::try_from(u32::from(letter)) {
            Ok(byte) => bytes.push(byte),
            Err(_) => bytes.extend(letter.to_string().into_bytes()),
        }
    }
    bytes
}

/// An address or the number of a block, as written; none of what is not the target of a symbol.
fn place_text(kind: &OperandKind) -> Option<String> {
    match kind {
        OperandKind::Direct(direct) => Some(address::text(*direct)),
        OperandKind::Block { kind, number } => Some(format!("{}{number}", block_kind(*kind).prefix())),
        OperandKind::Constant(_) => Some("a constant".to_owned()),
        OperandKind::Indirect(_) | OperandKind::AddressOf(_) | OperandKind::Symbol { .. } | OperandKind::Error => None,
    }
}
