//! A whole program as one HTML document that needs nothing else: a list of blocks, networks that are drawn when they come into sight,
//! search, uses of addresses, links from calls to blocks, a light and a dark look, and a state at any time of a trace.

mod uses;

use serde_json::{Value, json};

use crate::book::{Body, Book, Page, Section};
use crate::listing::Kind;
use crate::logic;
use crate::metrics;
use crate::names::Names;
use crate::svg;
use crate::trace::Trace;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The document of a program. `state`: a trace, and the time in milliseconds at which the document begins; without it the last. `reference`:
/// the reference data of the program, as `plcc xref --json` prints them; a program with errors has none, and the document shows what its
/// drawings and texts tell.
pub fn document(book: &Book, names: &Names, state: Option<(&Trace, Option<f64>)>, reference: Option<&Value>) -> String {
    let pages: Vec<Value> = book.pages.iter().map(|of| page(of, book.is_live)).collect();
    let symbols: Vec<Value> = names.symbols().into_iter().map(|(address, name)| json!([address, name])).collect();
    let data = json!({
        "title": book.title,
        "pages": pages,
        "symbols": symbols,
        "uses": uses::uses(book, names, reference.is_some()),
        "xref": reference,
        "trace": state.map(|(trace, _)| signals(trace)),
        "start": state.map(|(trace, time)| trace.row(time)),
    });
    let script =
        format!("<script id=\"data\" type=\"application/json\">{}</script>\n<script>{SCRIPT}</script>", safe(&data));
    let style = format!("{STYLE}\n{}", svg::STYLE);
    let body = "<nav><header><h1></h1><input id=\"search\" type=\"search\" placeholder=\"Search (/)\" autocomplete=\"off\">\
                </header><div id=\"list\"></div></nav><main></main><aside id=\"uses\" hidden></aside>\
                <footer id=\"time\" hidden><button id=\"play\">▶</button><input id=\"slider\" type=\"range\" min=\"0\">\
                <output></output></footer>";
    html(&book.title, &style, body, &script)
}

fn html(title: &str, style: &str, body: &str, script: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<title>{}</title>\n<style>\n:root{{--fonts:{}}}\n{style}\n</style>\n</head>\n<body>\n{body}\n{script}\n</body>\n</html>\n",
        svg::escaped(title),
        metrics::FONTS,
    )
}

/// JSON that no browser takes for the end of the script.
fn safe(data: &Value) -> String {
    data.to_string().replace("</", "<\\/").replace("<!--", "\\u003c!--")
}

fn signals(trace: &Trace) -> Value {
    let rows: Vec<Value> = trace.rows.iter().map(|(time, values)| json!([time, values])).collect();
    json!({ "columns": trace.columns, "units": trace.units, "rows": rows })
}

fn page(page: &Page, is_live: bool) -> Value {
    let rows: Vec<Value> = page
        .declarations
        .iter()
        .map(|row| json!([row.section, row.name, row.ty, row.initial, row.comment, row.address, row.depth]))
        .collect();
    json!({
        "id": page.id,
        "name": page.name,
        "lang": page.language,
        "title": page.title,
        "comment": page.comment.join("\n"),
        "rows": rows,
        "secs": page.sections.iter().map(|part| section(part, is_live)).collect::<Vec<_>>(),
    })
}

fn section(section: &Section, is_live: bool) -> Value {
    let mut value = json!({
        "n": section.number,
        "title": section.title,
        "comment": section.comment.join("\n"),
        "labels": section.labels,
        "reason": section.reason,
    });
    match &section.content {
        Body::Drawing { scene, sheet } => {
            value["svg"] = json!(svg::inline(scene, is_live));
            value["h"] = json!(scene.height);
            value["logic"] = logic::logic(sheet).json(is_live);
        }
        Body::Text(listing) => {
            value["text"] = json!(listing.lines.join("\n"));
            if is_live {
                value["starts"] = json!(listing.starts);
            }
            value["kind"] = json!(match listing.kind {
                Kind::Stl => "stl",
                Kind::Scl => "scl",
            });
        }
    }
    if let Some(code) = &section.code {
        value["code"] = json!({ "text": code.lines.join("\n"), "starts": code.starts });
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_a_program_do_not_end_its_script() {
        let data = json!({ "comment": "<!-- <script> a </script> --> <\\/ \\u003c" });
        let text = safe(&data);
        assert!(!text.contains("</") && !text.contains("<!--"), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).ok(), Some(data), "{text}");
    }
}
