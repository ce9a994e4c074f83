//! A grid of characters that grows.

/// Characters by line and column.
#[derive(Default)]
pub struct Canvas {
    lines: Vec<Vec<char>>,
}

impl Canvas {
    pub fn get(&self, x: usize, y: usize) -> char {
        self.lines.get(y).and_then(|line| line.get(x)).copied().unwrap_or(' ')
    }

    pub fn set(&mut self, x: usize, y: usize, c: char) {
        if self.lines.len() <= y {
            self.lines.resize(y + 1, Vec::new());
        }
        let line = &mut self.lines[y];
        if line.len() <= x {
            line.resize(x + 1, ' ');
        }
        line[x] = c;
    }

    /// Sets a character that is still blank.
    pub fn fill(&mut self, x: usize, y: usize, c: char) {
        if self.get(x, y) == ' ' {
            self.set(x, y, c);
        }
    }

    /// Writes a text over blanks.
    pub fn write(&mut self, x: usize, y: usize, text: &str) {
        for (at, c) in text.chars().enumerate() {
            self.fill(x + at, y, c);
        }
    }

    pub fn width(&self) -> usize {
        self.lines.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// The lines without blanks at their ends; no blank lines at the top and the bottom.
    pub fn text(&self) -> String {
        let lines: Vec<String> =
            self.lines.iter().map(|line| line.iter().collect::<String>().trim_end().to_string()).collect();
        let mut out = lines.join("\n").trim_matches('\n').to_string();
        if !out.is_empty() {
            out.push('\n');
        }
        out
    }
}
