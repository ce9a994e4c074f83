//! The reference page of the standard library: interface, behaviour and source of each block, from the blocks themselves.

use std::fmt::Write as _;

use plcc_stdlib::{BlockClass, Form, Language, SystemBlock};

use plcc_model::layout;
use plcc_model::{Direction, Interface};
use plcc_program::library_interface;

/// Chapters of the page, and the blocks of each.
const CHAPTERS: [(&str, BlockClass, bool); 6] = [
    ("System functions (SFC)", BlockClass::Sfc, false),
    ("System function blocks (SFB)", BlockClass::Sfb, false),
    ("Library functions (FC)", BlockClass::Fc, false),
    ("Library function blocks (FB)", BlockClass::Fb, false),
    ("Instructions of the TIA Portal: functions", BlockClass::Sfc, true),
    ("Instructions of the TIA Portal: function blocks", BlockClass::Sfb, true),
];

/// The page in Markdown: `docs/reference/stdlib.md`.
pub fn standard_library() -> String {
    let mut page = String::from(
        "# Standard library\n\n\
         Printed from the sources in `stdlib/`; do not edit.\n\n\
         BR of STL corresponds to ENO of the other languages. Hexadecimal codes of RET_VAL are written without `W#16#`; one with bit 15 set is an\n\
         error. General codes 8xyy name parameter x: 01 syntax of an ANY, 22 and 23 length of an area, 24 and 25 area, 28 and 29 bit address,\n\
         30 write-protected data block, 3A no such data block.\n\n\
         A block of the program has priority over one of the library with the same number.\n",
    );
    let mut blocks: Vec<&SystemBlock> = plcc_stdlib::blocks().iter().collect();
    blocks.sort_by_key(|block| block.number);
    for (title, class, tia) in CHAPTERS {
        let chapter = blocks.iter().filter(|block| block.class == class && block.is_tia() == tia);
        let (missing, shipped): (Vec<&SystemBlock>, Vec<&SystemBlock>) =
            chapter.filter(|block| !block.is_part()).partition(|block| block.form == Form::NotShipped);
        let _ = write!(page, "\n## {title}\n");
        for block in shipped {
            describe(&mut page, block);
        }
        let mut names: Vec<String> =
            missing.iter().map(|block| format!("{} {}", prefix(block.class), named(block))).collect();
        let library = plcc_stdlib::LIBRARY.iter().filter(|other| !tia && other.fb == (class == BlockClass::Fb));
        if matches!(class, BlockClass::Fc | BlockClass::Fb) {
            let is_missing = |number: u16| plcc_stdlib::find(class, number).is_none();
            names.extend(
                library
                    .filter(|other| is_missing(other.number))
                    .map(|other| format!("{} {} {}", prefix(class), other.number, other.name)),
            );
        }
        if !names.is_empty() {
            let _ = write!(page, "\nKnown by name, not included: {}.\n", names.join(", "));
        }
    }
    page
}

fn prefix(class: BlockClass) -> &'static str {
    match class {
        BlockClass::Fc => "FC",
        BlockClass::Fb => "FB",
        BlockClass::Sfc => "SFC",
        BlockClass::Sfb => "SFB",
    }
}

fn named(block: &SystemBlock) -> String {
    format!("{} {}", block.number, block.name)
}

fn describe(page: &mut String, block: &SystemBlock) {
    let heading =
        if block.is_tia() { block.name.to_string() } else { format!("{} {}", prefix(block.class), named(block)) };
    let _ = write!(page, "\n### {heading}\n\n");
    let told_below = |line: &&str| !line.starts_with("// Source: ");
    for line in block.comment.lines().take_while(told_below) {
        let _ = writeln!(page, "{}", line.trim_start_matches("//").trim());
    }
    if let Some(interface) = library_interface(block) {
        table(page, block, &interface);
    }
    let language = match (block.form, block.language) {
        (Form::Runtime, _) => "the runtime",
        (_, Language::Stl) => "STL",
        (_, Language::Scl) => "SCL",
    };
    let origin: Vec<&str> = block.origin.lines().map(|line| line.trim_start_matches("//").trim()).collect();
    let _ = write!(page, "\nSource: {} Code: {language}.\n", origin.join(" "));
}

fn table(page: &mut String, block: &SystemBlock, interface: &Interface) {
    let instance = matches!(block.class, BlockClass::Fb | BlockClass::Sfb);
    if interface.parameters.is_empty() && interface.instance.is_empty() {
        return;
    }
    let _ = write!(
        page,
        "\n{}",
        if instance {
            "| Parameter | Direction | Type | Offset | Initial value | Meaning |\n| --- | --- | --- | --- | --- | --- |\n"
        } else {
            "| Parameter | Direction | Type | Meaning |\n| --- | --- | --- | --- |\n"
        }
    );
    for parameter in &interface.parameters {
        let direction = match parameter.direction {
            Direction::Input => "IN",
            Direction::Output => "OUT",
            Direction::InOut => "IN_OUT",
        };
        row(
            page,
            block,
            &parameter.name,
            direction,
            &layout::type_name(&parameter.ty),
            (parameter.byte, parameter.bit),
        );
    }
    let is_parameter = |name: &str| interface.parameters.iter().any(|parameter| parameter.name == name);
    for member in interface.instance.iter().filter(|member| !is_parameter(&member.name)) {
        row(page, block, &member.name, "STAT", &layout::type_name(&member.ty), (member.byte, member.bit));
    }
    if instance {
        let _ = write!(page, "\nThe instance has {} bytes.\n", interface.bytes);
    }
}

fn row(page: &mut String, block: &SystemBlock, name: &str, direction: &str, ty: &str, (byte, bit): (u32, u8)) {
    let _ = write!(page, "| {name} | {direction} | {ty} |");
    if matches!(block.class, BlockClass::Fb | BlockClass::Sfb) {
        let _ = write!(page, " {byte}.{bit} | {} |", initial(block.source, name));
    }
    let _ = writeln!(page, " {} |", meaning(block.source, name));
}

/// The initial value of a variable, as in its declaration.
fn initial(source: &'static str, name: &str) -> &'static str {
    let declaration = declaration(source, name).map(|text| text.split("//").next().unwrap_or(text));
    declaration
        .and_then(|rest| rest.split_once(":=").filter(|(before, _)| !before.contains('{') || before.contains('}')))
        .map_or("", |(_, value)| value.split(';').next().unwrap_or("").trim())
}

/// The comment after the declaration of a variable.
fn meaning(source: &'static str, name: &str) -> &'static str {
    declaration(source, name).and_then(|text| text.split_once("//")).map_or("", |(_, comment)| comment.trim())
}

/// The text after the name in the declaration of a variable. Components of structures are indented more than variables.
fn declaration(source: &'static str, name: &str) -> Option<&'static str> {
    source
        .lines()
        .take_while(|line| !line.starts_with("BEGIN"))
        .filter_map(|line| {
            let text = line.trim_start();
            let rest = text.strip_prefix(name)?.trim_start();
            rest.starts_with([':', '{']).then_some((line.len() - text.len(), rest))
        })
        .min_by_key(|(indent, _)| *indent)
        .map(|(_, rest)| rest)
}
