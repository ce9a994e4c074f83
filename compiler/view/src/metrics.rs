//! Widths of texts. Drawings use monospaced fonts, none of which is wider than this table says.

use unicode_width::UnicodeWidthStr;

/// Fonts of drawings: a character of each is at most 0.61 times as wide as the font is high.
pub const FONTS: &str = "'DejaVu Sans Mono','Liberation Mono',Menlo,Consolas,'Noto Sans Mono','Courier New',monospace";

/// Height of ordinary text, in pixels.
pub const TEXT: i32 = 12;
/// Height of addresses, types and other small text.
pub const SMALL: i32 = 10;
/// From one line of text to the next.
pub const LINE: i32 = 14;

/// The width of a text in pixels, rounded up. Characters of East Asia take two cells.
pub fn width(text: &str, height: i32) -> i32 {
    let cells = text.width() as i32;
    (cells * height * 61 + 99) / 100
}

/// Breaks a text into lines of at most `cells` characters, after a point where there is one, else after a bracket, an underscore or such.
pub fn wrapped(text: &str, cells: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    // Where the line may end: after its last point, and after another sign.
    let mut chances: [Option<usize>; 2] = [None; 2];
    for c in text.chars() {
        let c = if c.is_control() { ' ' } else { c };
        line.push(c);
        if line.as_str().width() > cells && line.chars().count() > 1 {
            let [point, sign] = std::mem::take(&mut chances);
            let at = point.or(sign).unwrap_or(line.len() - c.len_utf8());
            let rest = line.split_off(at);
            lines.push(std::mem::replace(&mut line, rest));
        }
        if line.as_str().width() > 3 {
            match c {
                '.' => chances[0] = Some(line.len()),
                '_' | '[' | ',' | ' ' | '"' | '-' | '/' => chances[1] = Some(line.len()),
                _ => {}
            }
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_at_points_and_have_all_characters() {
        assert_eq!(wrapped("\"Tank\".Valves[3].IsOpen", 14), ["\"Tank\".", "Valves[3].", "IsOpen"]);
        assert_eq!(wrapped("aVeryLongNameWithoutAnyPoint", 10), ["aVeryLongN", "ameWithout", "AnyPoint"]);
        assert_eq!(wrapped("", 10), Vec::<String>::new());
        let text = "液位液位液位液位";
        assert_eq!(wrapped(text, 8).concat(), text);
    }
}
