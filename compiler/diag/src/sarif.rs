//! Messages as one SARIF 2.1.0 document, which code-scanning services read.

use serde_json::{Value, json};

use crate::codes::{Code, Severity};
use crate::diagnostic::{Diagnostic, Label};
use crate::source::SourceMap;

/// `diagnostics` as a SARIF document; its rules are the codes that occur.
pub fn document(diagnostics: &[Diagnostic], sources: &SourceMap) -> String {
    let (diagnostics, omitted) = crate::shown(diagnostics);
    let mut codes: Vec<Code> = diagnostics.iter().map(|d| d.code).collect();
    codes.sort();
    codes.dedup();
    let mut document = json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "plcc",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": codes.iter().map(|&code| rule(code)).collect::<Vec<_>>(),
            }},
            "columnKind": "unicodeCodePoints",
            "results": diagnostics.iter().map(|d| result(d, &codes, sources)).collect::<Vec<_>>(),
        }],
    });
    if omitted > 0 {
        let note = json!({ "level": "warning", "message": { "text": crate::omitted_text(omitted) } });
        document["runs"][0]["invocations"] =
            json!([{ "executionSuccessful": true, "toolExecutionNotifications": [note] }]);
    }
    serde_json::to_string_pretty(&document).expect("a JSON value is JSON") + "\n"
}

fn rule(code: Code) -> Value {
    json!({
        "id": code.name(),
        "name": format!("{code:?}"),
        "shortDescription": { "text": code.title() },
        "help": { "text": code.page(), "markdown": code.page() },
        "defaultConfiguration": { "level": level(code.severity()) },
    })
}

fn result(diagnostic: &Diagnostic, codes: &[Code], sources: &SourceMap) -> Value {
    let text = match &diagnostic.help {
        Some(help) => format!("{}\nhelp: {help}", diagnostic.title),
        None => diagnostic.title.clone(),
    };
    let mut result = json!({
        "ruleId": diagnostic.code.name(),
        "ruleIndex": codes.binary_search(&diagnostic.code).unwrap_or_default(),
        "level": level(diagnostic.severity),
        "message": { "text": text },
        "locations": [location(&diagnostic.primary, sources)],
    });
    if !diagnostic.secondary.is_empty() {
        let related: Vec<Value> = diagnostic.secondary.iter().map(|label| location(label, sources)).collect();
        result["relatedLocations"] = related.into();
    }
    result
}

fn level(severity: Severity) -> &'static str {
    crate::drawing::severity_word(severity)
}

fn location(label: &Label, sources: &SourceMap) -> Value {
    let file = sources.file(label.span.file);
    let (line, column) = file.line_column(label.span.start);
    let (end_line, end_column) = file.line_column(label.span.end);
    let mut location = json!({
        "physicalLocation": {
            "artifactLocation": { "uri": uri(&file.name) },
            "region": { "startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column },
        },
    });
    if !label.text.is_empty() {
        location["message"] = json!({ "text": label.text });
    }
    location
}

/// A path as a URI reference: characters that a URI must not contain are escaped.
fn uri(path: &str) -> String {
    path.replace('\\', "/")
        .bytes()
        .map(|byte| match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'.' | b'-' | b'_' | b'~' => (byte as char).to_string(),
            _ => format!("%{byte:02X}"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SourceFile, Span};

    #[test]
    fn one_document_with_rules_and_results() {
        let mut sources = SourceMap::default();
        let file = sources.add(SourceFile::new("my file.stl", "A MW 1\n"));
        let messages = [
            Diagnostic::new(Code::OperandKind, Span::new(file, 2..6), "no"),
            Diagnostic::new(Code::BlockComment, Span::new(file, 0..1), "hm"),
        ];
        let value: Value = serde_json::from_str(&document(&messages, &sources)).unwrap();
        assert_eq!(value["version"], "2.1.0");
        let run = &value["runs"][0];
        assert_eq!(run["tool"]["driver"]["rules"][1]["id"], "P0203");
        assert_eq!(run["results"][0]["ruleIndex"], 1);
        let place = &run["results"][0]["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "my%20file.stl");
        assert_eq!(place["region"]["startColumn"], 3);
    }
}
