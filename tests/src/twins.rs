//! IR of one program in several files, without the parts of the text that name the files.

use std::collections::HashSet;

use plcc_driver::cli::Level;
use plcc_driver::pipeline::{self, Bound};
use plcc_ir::print::module_text;

/// Runtime functions whose first argument is a site.
const WITH_SITE: [&str; 6] =
    ["@safepoint(", "@sync_error(", "@local_error(", "@stop(", "@call_block(", "@system_function("];

/// The IR after lowering, without files, sites and their numbers.
pub fn ir_text(bound: &Bound) -> String {
    let text = module_text(&pipeline::lower(bound, Level::O0).module);
    let mut out = String::new();
    for function in text.split_inclusive("\n}\n") {
        let lines: Vec<String> = function
            .lines()
            .filter(|line| !line.starts_with("file ") && !line.starts_with("site "))
            .map(without_site)
            .collect();
        let sites: HashSet<&str> = lines.iter().filter_map(|line| site_argument(line)).collect();
        for line in &lines {
            match line.split_once(" = const.i32 ") {
                Some((value, _)) if sites.contains(value.trim()) => out.push_str(&format!("{value} = site")),
                _ => out.push_str(line),
            }
            out.push('\n');
        }
    }
    out
}

/// The value that is the site of a call of the runtime: `v7` of `rt @stop(v7, v8)`.
fn site_argument(line: &str) -> Option<&str> {
    let (_, arguments) = WITH_SITE.iter().find_map(|name| line.split_once(name))?;
    arguments.split([',', ')']).next()
}

/// A line without `!7`, the number of its site.
fn without_site(line: &str) -> String {
    let words = line.split(' ').filter(|word| {
        !word.strip_prefix('!').is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
    });
    words.collect::<Vec<_>>().join(" ")
}
