//! Pages: one with the sums, and one for each source with its networks, charts and lines.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

use plcc_view::book::Body;
use plcc_view::svg::{self, escaped};
use plcc_view::{covered, metrics};

use crate::data::{Block, Coverage, File, Part, Sums};

const STYLE: &str = include_str!("html.css");

/// Writing to a String cannot fail.
const WRITES: &str = "a String takes all text";

/// The pages by the names of their files; `index.html` is the first.
pub fn pages(coverage: &Coverage) -> Vec<(String, String)> {
    let mut used: HashMap<String, usize> = HashMap::new();
    let mut files = Vec::new();
    for (name, file) in &coverage.files {
        let safe: String = name.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect();
        let count = used.entry(safe.to_lowercase()).or_insert(0);
        *count += 1;
        let page = if *count == 1 { format!("{safe}.html") } else { format!("{safe}-{count}.html") };
        files.push((page, name.as_str(), file));
    }
    let mut pages = vec![("index.html".to_string(), index(coverage, &files))];
    pages.extend(files.iter().map(|(page, name, file)| (page.clone(), file_page(name, file))));
    pages
}

fn document(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<title>{title}</title>\n<style>\n:root{{--fonts:{}}}\n{STYLE}\n{}\n{}\n</style>\n\
         </head>\n<body>\n{body}</body>\n</html>\n",
        metrics::FONTS,
        svg::STYLE,
        covered::STYLE,
        title = escaped(title),
    )
}

/// The sums of all sources, and of each block.
fn index(coverage: &Coverage, files: &[(String, &str, &File)]) -> String {
    let sums = coverage.sums();
    let shown: Vec<&str> = sums.parts().iter().filter(|(_, part)| part.all > 0).map(|(name, _)| *name).collect();
    let mut body = String::from("<h1>Coverage</h1>\n<table>\n<tr><th></th>");
    for name in &shown {
        write!(body, "<th>{name}</th>").expect(WRITES);
    }
    body.push_str("</tr>\n");
    row(&mut body, "all", "all", sums, &shown);
    for (page, name, file) in files {
        row(&mut body, "file", &format!("<a href=\"{page}\">{}</a>", escaped(name)), file.sums(), &shown);
        for block in &file.blocks {
            let link = format!("<a href=\"{page}#{}\">{}</a>", anchor(block), escaped(&title(block)));
            row(&mut body, "block", &link, block.sums(), &shown);
        }
    }
    body.push_str("</table>\n");
    document("Coverage", &body)
}

fn row(out: &mut String, class: &str, head: &str, sums: Sums, shown: &[&str]) {
    write!(out, "<tr class=\"{class}\"><td>{head}</td>").expect(WRITES);
    for (_, part) in sums.parts().iter().filter(|(name, _)| shown.contains(name)) {
        match part {
            Part { all: 0, .. } => out.push_str("<td></td>"),
            Part { covered, all } => {
                let class = if covered == all { "good" } else { "bad" };
                let percent = covered * 100 / all;
                write!(out, "<td class=\"{class}\">{covered} of {all}<i>{percent} %</i></td>").expect(WRITES);
            }
        }
    }
    out.push_str("</tr>\n");
}

fn title(block: &Block) -> String {
    if block.name.is_empty() || block.name == block.id {
        block.id.clone()
    } else {
        format!("{} {}", block.id, block.name)
    }
}

fn anchor(block: &Block) -> String {
    format!("b{}", block.span.0)
}

/// The blocks of a source.
fn file_page(name: &str, file: &File) -> String {
    let mut body = format!("<p><a href=\"index.html\">Coverage</a></p>\n<h1>{}</h1>\n", escaped(name));
    body.push_str(
        "<p class=\"legend\"><b class=\"ok\">run</b> <b class=\"no\">not run</b> Behind a contact the left half is for 0, the right half \
         for 1: <b class=\"ok\">0</b><b class=\"no\">1</b> has been 0, never 1.</p>\n",
    );
    for block in &file.blocks {
        let (id, head, sums) = (anchor(block), escaped(&title(block)), block.sums());
        let calls = if block.calls == 0 { "never called".to_string() } else { sums.inside() };
        writeln!(body, "<h2 id=\"{id}\">{head} <small>{} · {calls}</small></h2>", block.page.language).expect(WRITES);
        for section in &block.page.sections {
            let number = section.number as u16;
            if number > 0 {
                let runs = block.networks.get(&number).map(|network| network.runs);
                let state = match runs {
                    None => "",
                    Some(0) => "<span class=\"no\">not run</span>",
                    Some(_) => "<span class=\"ok\">run</span>",
                };
                let title = escaped(&section.title);
                writeln!(body, "<h3>Network {number} {title} {state}</h3>").expect(WRITES);
            }
            match &section.content {
                Body::Drawing { scene, sheet } => {
                    let drawing = covered::inline(scene, sheet, &|start| block.mark(start));
                    writeln!(body, "<div class=\"draw\">{drawing}</div>").expect(WRITES);
                }
                Body::Text(listing) => lines(&mut body, file, block, &listing.starts),
            }
        }
        missed(&mut body, block);
    }
    document(name, &body)
}

/// Steps that were never active, and transitions that never switched.
fn missed(out: &mut String, block: &Block) {
    for (list, what) in [(&block.steps, "was never active"), (&block.transitions, "never switched")] {
        for one in list.iter().filter(|one| one.runs == 0) {
            writeln!(out, "<p class=\"missed\">{} {what}</p>", escaped(&one.name)).expect(WRITES);
        }
    }
}

/// The lines that begin at `starts`, and those between them, with how often they have run and what is missing.
fn lines(out: &mut String, file: &File, block: &Block, starts: &[u32]) {
    #[derive(Default)]
    struct Line {
        runs: Option<u64>,
        missing: Vec<String>,
    }
    let mut found: BTreeMap<u32, Line> = BTreeMap::new();
    let (Some(first), Some(end)) = (starts.iter().min(), starts.iter().max()) else { return };
    let shown = file.source.line(*first)..=file.source.line(*end);
    let is_shown = |range: (u32, u32)| shown.contains(&file.source.line(range.0));
    let mut last = 0;
    let text = |range: (u32, u32)| {
        let text = file.source.text.get(range.0 as usize..range.1 as usize).unwrap_or_default();
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        if words.chars().count() > 40 { words.chars().take(39).chain(['…']).collect() } else { words }
    };
    for (range, statement) in block.statements.iter().filter(|(range, _)| is_shown(**range)) {
        let line = found.entry(file.source.line(range.0)).or_default();
        line.runs = Some(line.runs.unwrap_or(0).max(statement.runs));
        if statement.runs == 0 {
            line.missing.push(format!("{} not run", text(*range)));
        }
        last = last.max(file.source.line(range.1.saturating_sub(1)));
    }
    for (range, contact) in block.contacts.iter().filter(|(range, _)| is_shown(**range)) {
        let line = found.entry(file.source.line(range.0)).or_default();
        last = last.max(file.source.line(range.0));
        let missing = match contact.seen {
            // The statement says so.
            [0, 0] => continue,
            [0, _] => "never 0",
            [_, 0] => "never 1",
            [_, _] => continue,
        };
        line.missing.push(format!("{} {missing}", text(*range)));
    }
    let Some(first) = found.keys().next().copied() else { return };
    out.push_str("<table class=\"code\">\n");
    for number in first..=last.max(first) {
        let code = escaped(file.source.line_text(number));
        let (class, runs, missing) = match found.get(&number) {
            None => ("", String::new(), String::new()),
            Some(line) => {
                let class = match (line.runs, line.missing.is_empty()) {
                    (Some(0), _) => "no",
                    (_, true) => "ok",
                    (_, false) => "part",
                };
                let runs = line.runs.map_or(String::new(), |runs| runs.to_string());
                let missing = if class == "no" { String::new() } else { line.missing.join(", ") };
                (class, runs, escaped(&missing))
            }
        };
        writeln!(
            out,
            "<tr><td>{number}</td><td>{runs}</td><td class=\"{class}\"><code>{code}</code></td><td>{missing}</td></tr>"
        )
        .expect(WRITES);
    }
    out.push_str("</table>\n");
}
