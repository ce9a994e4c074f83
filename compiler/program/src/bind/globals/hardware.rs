//! System constants of an S7-1200/1500: hardware identifiers, events of hardware interrupts, numbers of organization blocks.
//!
//! Also the access to blocks: those with optimised access have no addresses.
//!
//! Source: LAD/FBD reference for S7-1200, data types HW_*, EVENT_* and OB_*; optimised and standard access.

use plcc_abi::image::BlockKind;
use plcc_abi::technology::{EVENT_ID, HSC_ID, PULSE_ID};
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockName, BlockPrefix};

use crate::bind::globals::Globals;
use crate::bind::trees::blocks::{is_optimized, states_access};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::types::Elementary;
use plcc_model::{BlockKey, profile};
use plcc_syntax::symbols::SymbolTarget;

/// Hardware identifiers that each CPU has, by folded name.
const OF_EACH_CPU: [(&str, u16); 6] = [
    ("local", 49),
    ("local~common", 50),
    ("local~mc", 51),
    ("local~exec", 52),
    ("local~profinet_interface_1", 64),
    ("local~profinet-schnittstelle_1", 64),
];

impl Globals<'_> {
    /// Reports the name of a fast counter or pulse generator that the CPU does not have; false: the name means something else.
    pub fn missing_hardware(&mut self, name: &str, span: Span) -> bool {
        let folded = fold(name);
        let board = profile::on_board(&self.input.profile);
        let rows = [
            ("local~hsc_", "fast counter", board.map_or(0, |board| board.fast_counters)),
            ("local~pulse_", "pulse generator", board.map_or(0, |board| board.pulse_generators)),
        ];
        let found = rows.iter().find_map(|(prefix, what, count)| {
            let number: u32 = folded.strip_prefix(prefix)?.parse().ok()?;
            Some((what, number, count))
        });
        let Some((what, number, count)) = found else { return false };
        let cpu = self.input.profile.name.clone();
        let help = match count {
            0 => format!("only CPUs of the S7-1200 have {what}s; name one with --cpu or in plc.toml"),
            _ => format!("it has {what}s 1 to {count}"),
        };
        let title = format!("the CPU {cpu} has no {what} {number}");
        self.report
            .push(Diagnostic::new(Code::AddressRange, span, title).label("a system constant of other CPUs").help(help));
        true
    }

    /// Reports an address in a data block with optimised access; `None`: no optimised access.
    pub fn check_absolute_access(&mut self, number: u16, span: Span) -> Option<()> {
        let title = format!("`{}` is an address in a block with optimised access", self.text(span));
        self.check_standard_access(number, span, title)
    }

    /// The same for PEEK and POKE, whose data block has this number.
    pub fn check_coded_access(&mut self, number: u16, span: Span) -> Option<()> {
        let title = "PEEK and POKE cannot reach a block with optimised access".to_owned();
        self.check_standard_access(number, span, title)
    }

    fn check_standard_access(&mut self, number: u16, span: Span, title: String) -> Option<()> {
        let Some(data) = self.sources.data.get(&number).copied() else { return Some(()) };
        if !self.input.profile.family.is_portal() {
            return Some(());
        }
        let Some((stated, of)) = self.optimized_by(data) else { return Some(()) };
        self.report.push(
            Diagnostic::new(Code::OperandKind, span, title)
                .label(format!("DB {number} has no addresses"))
                .also(stated, "`S7_Optimized_Access` is TRUE here")
                .help(format!("write the name of the component, or switch off the optimised access of {of}")),
        );
        None
    }

    /// Where a block states that a data block has optimised access, and which one: itself, or else the function block whose instance
    /// it is.
    fn optimized_by(&self, data: &ast::DataBlock) -> Option<(Span, &'static str)> {
        if states_access(&data.header) {
            return is_optimized(&data.header).then(|| (data.name.span(), "the data block"));
        }
        let ast::DataContent::OfType(ast::TypeRef { kind: ast::TypeKind::Block(name), .. }) = &data.content else {
            return None;
        };
        let (prefix, number) = match name {
            BlockName::Numbered { prefix, number, .. } => (*prefix, *number),
            BlockName::Symbol { name, .. } => match self.names.symbols.get(&fold(name))?.target {
                SymbolTarget::Block { prefix, number } => (prefix, number),
                SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => return None,
            },
        };
        let key = BlockKey { kind: BlockKind::Fb, number: u16::try_from(number).ok()? };
        let block = self.sources.code.get(&key).filter(|_| prefix == BlockPrefix::Fb)?.block();
        is_optimized(&block.header).then(|| (block.name.span(), "the function block"))
    }

    /// Reports a view in a block with optimised access.
    pub fn check_view_access(&mut self, block: &ast::CodeBlock, section: &ast::Section, at: Span) {
        if !self.input.profile.family.is_portal()
            || !is_optimized(&block.header)
            || section.retain == ast::Retain::DbSpecific
        {
            return;
        }
        self.report.push(
            Diagnostic::new(Code::SectionNotAllowed, at, "a block with optimised access cannot have views")
                .label("AT needs addresses")
                .also(block.name.span(), "`S7_Optimized_Access` is TRUE for this block")
                .help("switch off the optimised access of the block, or use slices such as `.%B0`"),
        );
    }

    /// The system constant `name`: `Local~Common`, `Local~HSC_1`, `Local~Pulse_1`, an event or a module of plc.toml, `OB_Main`.
    pub fn system_constant(&self, name: &str) -> Option<Constant> {
        if !self.input.profile.family.is_portal() {
            return None;
        }
        let name = fold(name);
        let word = |bits: u16| Some(Constant::Typed { ty: Elementary::Word, bits: u64::from(bits) });
        if let Some((_, id)) = OF_EACH_CPU.iter().find(|(own, _)| *own == name) {
            return word(*id);
        }
        let board = profile::on_board(&self.input.profile);
        let numbered = |prefix: &str, count: u8| {
            let number: u8 = name.strip_prefix(prefix)?.parse().ok()?;
            (1..=count).contains(&number).then_some(u16::from(number))
        };
        if let Some(number) = board.and_then(|board| numbered("local~hsc_", board.fast_counters)) {
            return word(HSC_ID + number);
        }
        if let Some(number) = board.and_then(|board| numbered("local~pulse_", board.pulse_generators)) {
            return word(PULSE_ID + number);
        }
        if let Some(index) = self.input.config.hardware_events.iter().position(|event| fold(&event.name) == name) {
            let bits = u64::from(EVENT_ID) + index as u64 + 1;
            return Some(Constant::Typed { ty: Elementary::Dword, bits });
        }
        // If a block or tag has the name of a module, the name means the block or tag.
        let config = &self.input.config;
        if !self.names.symbols.contains_key(&name) {
            let mut named = config.modules.iter().flatten().filter(|module| fold(&module.name) == name);
            // A name of two modules does not tell which one is meant.
            if let (Some(module), None) = (named.next(), named.next()) {
                return word(config.hardware_id(module));
            }
        }
        match self.names.symbols.get(name.strip_prefix("ob_")?)?.target {
            SymbolTarget::Block { prefix: BlockPrefix::Ob, number } => {
                Some(Constant::Typed { ty: Elementary::Int, bits: u64::from(number) })
            }
            SymbolTarget::Block { .. } | SymbolTarget::Memory { .. } | SymbolTarget::Cell { .. } => None,
        }
    }
}
