//! The reference page of all diagnostic codes, printed from the table.

use plcc_diag::{Code, Severity};

/// `docs/reference/diagnostics.md`.
pub fn diagnostics() -> String {
    let mut text = String::from(
        "# Diagnostics\n\n\
         Every message of plcc has a code. `plcc explain CODE` prints its page, which is also below.\n\
         This page is generated from `compiler/diag/src/codes.rs`; `UPDATE_EXPECT=1 cargo test --release` renews it.\n\n\
         | Code | Severity | Meaning |\n| --- | --- | --- |\n",
    );
    for &code in Code::ALL {
        text.push_str(&format!(
            "| [{name}](#{}) | {} | {} |\n",
            anchor(code),
            match code.severity() {
                Severity::Error => "error",
                Severity::Warning => "warning",
            },
            code.title(),
            name = code.name(),
        ));
    }
    for &code in Code::ALL {
        text.push('\n');
        for line in code.page().lines() {
            // The pages become sections: one level deeper.
            if line.starts_with('#') {
                text.push('#');
            }
            text.push_str(line);
            text.push('\n');
        }
    }
    text
}

/// The anchor that Markdown viewers give the heading `P0203: title`.
fn anchor(code: Code) -> String {
    format!("{}: {}", code.name(), code.title())
        .to_lowercase()
        .chars()
        .filter_map(|c| match c {
            ' ' => Some('-'),
            c if c.is_alphanumeric() || c == '-' || c == '_' => Some(c),
            _ => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_has_its_heading_and_two_examples() {
        for &code in Code::ALL {
            let page = code.page();
            assert!(page.starts_with(&format!("# {}: {}\n", code.name(), code.title())), "{}: heading", code.name());
            assert!(page.contains("\n## Failing\n"), "{}: no failing example", code.name());
            assert!(page.contains("\n## Repaired\n"), "{}: no repaired example", code.name());
            assert!(page.ends_with('\n') && !page.ends_with("\n\n"), "{}: end of the page", code.name());
        }
    }
}
