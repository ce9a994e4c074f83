//! A trace as an HTML page that needs nothing else: bits as lanes, numbers as curves, zoom and cursors. The samples are at its end, as in
//! a CSV file, so that the page grows with the run.

use std::io::{Result, Write};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page up to its samples.
pub fn head(title: &str) -> String {
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n\
         </head>\n<body>\n<header><h1>{title}</h1><input id=\"search\" type=\"search\" placeholder=\"Signals\"><span id=\"hint\">wheel: \
         zoom, drag: move, click: cursor A, shift and click: cursor B, double click: all</span></header>\n<canvas></canvas>\n<div \
         id=\"cursors\"></div>\n<script>\n{SCRIPT}</script>\n<script id=\"samples\" type=\"text/csv\">\n"
    )
}

/// Samples on their way into a page.
pub struct Samples<W: Write>(pub W);

impl<W: Write> Write for Samples<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        // No value ends the script that holds the samples.
        for part in bytes.split_inclusive(|byte| *byte == b'<') {
            match part.strip_suffix(b"<") {
                Some(before) => {
                    self.0.write_all(before)?;
                    self.0.write_all(b"&lt;")?;
                }
                None => self.0.write_all(part)?,
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_fits_a_small_screen() {
        let page = head("a <b>");
        let viewport =
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>a &lt;b></title>\n";
        assert!(page.contains(viewport), "{page}");
    }

    #[test]
    fn no_value_ends_the_script() {
        let mut samples = Samples(Vec::new());
        samples.write_all(b"1,'</script>'\n").expect("a Vec takes all");
        assert_eq!(samples.0, b"1,'&lt;/script>'\n");
    }
}
