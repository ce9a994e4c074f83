//! `plcc xref`.

use plcc_xref::Reference;

use super::exit;
use crate::cli::XrefArgs;
use crate::command::build::accepted;
use crate::{inputs, pipeline, report};

/// Prints the reference data of a program.
pub fn xref(args: &XrefArgs) -> u8 {
    let inputs = match inputs::or_here(&args.inputs) {
        Ok(inputs) => inputs,
        Err(code) => return code,
    };
    let read = inputs::read_as(&inputs, args.compile.code_page);
    let unreadable = read.is_unreadable();
    let settings = pipeline::Settings::new(&args.compile);
    let bound = match accepted(pipeline::front(read, &settings), unreadable, &settings) {
        Ok(bound) => bound,
        Err(code) => return code,
    };
    let reference = plcc_xref::reference(&bound.program, &bound.sources);
    let text = match (args.json, args.csv) {
        (true, _) => format!("{:#}\n", serde_json::json!(reference)),
        (false, true) => csv(&reference),
        (false, false) => plcc_xref::text::document(&reference),
    };
    report::print(&text).err().unwrap_or(exit::OK)
}

/// The cross references, a row for each use.
pub fn csv(reference: &Reference) -> String {
    const HEAD: [&str; 10] =
        ["address", "symbol", "access", "block", "block name", "network", "file", "line", "column", "statement"];
    let mut writer = csv::Writer::from_writer(Vec::new());
    let rows = reference.operands.iter().flat_map(|operand| operand.uses.iter().map(move |place| (operand, place)));
    let rows = rows.map(|(operand, place)| {
        [
            operand.address.clone(),
            operand.symbol.clone(),
            place.access.name().to_string(),
            place.block.clone(),
            place.block_name.clone(),
            place.network.to_string(),
            place.file.clone(),
            place.line.to_string(),
            place.column.to_string(),
            place.statement.clone(),
        ]
    });
    for row in std::iter::once(HEAD.map(String::from)).chain(rows) {
        writer.write_record(&row).expect("a list in memory takes all");
    }
    String::from_utf8(writer.into_inner().expect("a list in memory takes all")).expect("rows are text")
}
