//! A drawing of the page in the characters of a terminal: lines become box characters, and texts stand where they are.
//!
//! ```text
//!  │   M0.0    I0.1      Q0.0
//!  └────┤ ├─────┤/├───────( )─
//! ```
//!
//! Columns are as wide as small letters of the drawing. What is at the same height is in one line, what is higher is in a line above it.

use std::collections::{BTreeSet, HashMap};

use serde_json::Value;

use crate::flow::{Logic, flow};
use crate::forcing::Forcing;
use crate::messages::Step;
use crate::picture::{self, Anchor, Glyph, Item, columns};
use crate::row::{Piece, Row, Tone};
use crate::status::{Status, text};

/// Pixels of a column.
const COLUMN: i32 = 6;
/// Items whose heights differ by less are in the same line.
const SAME: i32 = 3;
/// From here on there is a free line between two lines.
const FAR: i32 = 30;
/// Columns and lines of a drawing at most: what is beyond is left out.
const COLUMNS_MAX: usize = 1_000;
const LINES_MAX: usize = 5_000;

/// Directions in which lines leave a character.
const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const UP: u8 = 4;
const DOWN: u8 = 8;
/// The characters of these, by their sum.
const LINES: [char; 16] = [' ', '─', '─', '─', '│', '┘', '└', '┴', '│', '┐', '┌', '┬', '│', '┤', '├', '┼'];

/// A column that the letter before it takes too.
const COVERED: char = '\0';

/// What a character belongs to.
#[derive(Clone, Debug, PartialEq)]
enum Owner {
    Nobody,
    /// A line that belongs to no net.
    Line,
    Net(usize),
    /// The operand at this place of the source.
    Operand(u32),
    /// The contact with this number.
    Contact(usize),
    /// The step with this name, as [`folded`] writes it.
    Step(String),
    Text(Tone),
}

#[derive(Clone, Debug)]
struct Cell {
    /// Directions of lines; of a letter none.
    lines: u8,
    letter: Option<char>,
    owner: Owner,
}

/// A drawing.
pub struct Drawing {
    lines: Vec<Vec<Cell>>,
    /// Values that are written where they fit: line, column, where the column is in the text, and place of the operand.
    values: Vec<(usize, i32, Anchor, u32)>,
    /// Texts of operands: line, first column, number of columns, and address.
    operands: Vec<(usize, i32, i32, String)>,
    logic: Logic,
    /// Place of the operand of each contact, and whether it is open at 1.
    contacts: HashMap<usize, (u32, bool)>,
}

/// The name of a step in a form that the chart and the CPU have in common.
pub fn folded(name: &str) -> String {
    name.chars()
        .filter(|letter| !matches!(letter, '"' | '#' | '%') && !letter.is_whitespace())
        .collect::<String>()
        .to_lowercase()
}

impl Drawing {
    pub fn new(svg: &str, logic: Option<&Logic>) -> Drawing {
        let items = picture::items(svg);
        let logic = logic.cloned().unwrap_or_default();
        let contacts = logic.contacts.iter().map(|&(part, place, open)| (part, (place, open))).collect();
        let heights = Heights::of(&items);
        let mut drawing = Drawing {
            lines: vec![Vec::new(); heights.count()],
            values: Vec::new(),
            operands: Vec::new(),
            logic,
            contacts,
        };
        for item in &items {
            drawing.line(item, &heights);
        }
        for item in &items {
            drawing.sign(item, &heights);
        }
        drawing
    }

    /// The character at a place; `None`: it is beyond the edge.
    fn at(&mut self, line: usize, column: i32) -> Option<&mut Cell> {
        let column = usize::try_from(column).ok().filter(|column| *column < COLUMNS_MAX)?;
        let cells = self.lines.get_mut(line)?;
        if cells.len() <= column {
            cells.resize(column + 1, Cell { lines: 0, letter: None, owner: Owner::Nobody });
        }
        cells.get_mut(column)
    }

    fn lines_at(&mut self, line: usize, column: i32, directions: u8, owner: &Owner) {
        let Some(cell) = self.at(line, column) else { return };
        if directions != 0 {
            cell.lines |= directions;
            // Where lines meet, the one with a value goes first.
            if matches!(cell.owner, Owner::Nobody | Owner::Line) {
                cell.owner = owner.clone();
            }
        }
    }

    fn across(&mut self, line: usize, from: i32, to: i32, owner: &Owner) {
        let (from, to) = (from.min(to).max(0), from.max(to).min(COLUMNS_MAX as i32));
        for column in from..=to {
            let left = if column > from { LEFT } else { 0 };
            let right = if column < to { RIGHT } else { 0 };
            self.lines_at(line, column, left | right, owner);
        }
    }

    fn down(&mut self, column: i32, from: usize, to: usize, owner: &Owner) {
        let (from, to) = (from.min(to), from.max(to));
        for line in from..=to {
            let up = if line > from { UP } else { 0 };
            let down = if line < to { DOWN } else { 0 };
            self.lines_at(line, column, up | down, owner);
        }
    }

    /// Writes a text; what is beyond the edge is left out.
    fn letters(&mut self, line: usize, mut column: i32, text: &str, owner: &Owner) {
        for letter in text.chars() {
            let end = column.saturating_add(columns(letter.encode_utf8(&mut [0; 4])));
            let mut shown = Some(letter);
            while column < end {
                if let Some(cell) = self.at(line, column) {
                    *cell = Cell { lines: 0, letter: shown.or(Some(COVERED)), owner: owner.clone() };
                }
                shown = None;
                column += 1;
            }
        }
    }

    /// All that is inside of a step is part of it.
    fn fill(&mut self, left: i32, top: usize, right: i32, bottom: usize, owner: &Owner) {
        for line in top + 1..bottom {
            for column in left.max(0)..right.min(COLUMNS_MAX as i32) {
                if let Some(cell) = self.at(line, column) {
                    cell.owner = owner.clone();
                }
            }
        }
    }

    /// The lines of an item.
    fn line(&mut self, item: &Item, heights: &Heights) {
        let column = |x: i32| x.div_euclid(COLUMN);
        match item {
            Item::Line { from, to, net, place } => {
                let owner = match (place, net) {
                    (Some(place), _) => Owner::Operand(*place),
                    (None, Some(net)) => Owner::Net(*net),
                    (None, None) => Owner::Line,
                };
                if from.1 == to.1 {
                    self.across(heights.line(from.1), column(from.0), column(to.0), &owner);
                } else if from.0 == to.0 {
                    self.down(column(from.0), heights.line(from.1), heights.line(to.1), &owner);
                }
            }
            Item::Frame { left, top, right, bottom, step } => {
                let owner = step.as_ref().map_or(Owner::Line, |name| Owner::Step(folded(name)));
                let (left, right) = (column(*left), column(*right));
                let (top, bottom) = (heights.line(*top), heights.line(*bottom));
                self.across(top, left, right, &owner);
                self.across(bottom, left, right, &owner);
                self.down(left, top, bottom, &owner);
                self.down(right, top, bottom, &owner);
                if step.is_some() {
                    self.fill(left, top, right, bottom, &owner);
                }
            }
            Item::Glyph { .. } | Item::Dot { .. } | Item::Circle { .. } | Item::Arrow { .. } | Item::Text { .. } => {}
        }
    }

    /// What is drawn on top of the lines of others.
    fn sign(&mut self, item: &Item, heights: &Heights) {
        match item {
            Item::Glyph { glyph, left, right, y, sign, part } => {
                let line = heights.line(*y);
                let middle = (left + right).div_euclid(2 * COLUMN);
                let half = (columns(sign) + 2).div_euclid(2).max(1);
                // Wires end at the edges of the symbol as it is drawn.
                let (first, last) = (left.div_euclid(COLUMN), right.div_euclid(COLUMN));
                if first < middle - half && self.has(line, first, LEFT) {
                    let before = self.owner(line, first);
                    self.across(line, first, middle - half, &before);
                }
                if last > middle + half && self.has(line, last, RIGHT) {
                    let after = self.owner(line, last);
                    self.across(line, middle + half, last, &after);
                }
                let (open, close) = match glyph {
                    Glyph::Contact => ("┤", "├"),
                    Glyph::Coil => ("(", ")"),
                };
                let owner = Owner::Contact(*part);
                self.letters(line, middle - half, open, &owner);
                for column in middle - half + 1..middle + half {
                    self.letters(line, column, " ", &owner);
                }
                self.letters(line, middle - columns(sign) / 2, sign, &owner);
                self.letters(line, middle + half, close, &owner);
            }
            Item::Dot { x, y } => {
                let (line, column) = (heights.line(*y), x.div_euclid(COLUMN));
                let owner = self.owner(line, column);
                self.letters(line, column, "●", &owner);
            }
            Item::Arrow { x, y } => self.letters(heights.line(*y), x.div_euclid(COLUMN), "▼", &Owner::Line),
            Item::Circle { x, y, net } => {
                let (line, column) = (heights.line(*y), x.div_euclid(COLUMN));
                // It is beside the edge of a box, towards its wire.
                let column = match self.has(line, column, UP | DOWN) {
                    true if self.has(line, column - 1, LEFT | RIGHT) => column - 1,
                    true => column + 1,
                    false => column,
                };
                self.letters(line, column, "o", &net.map_or(Owner::Line, Owner::Net));
            }
            Item::Text { x, y, anchor, text, tone, is_pin, key, place } => {
                let line = heights.line(*y);
                if let (Tone::Value, Some(place)) = (tone, place) {
                    self.values.push((line, x.div_euclid(COLUMN), *anchor, *place));
                    return;
                }
                // The name of a pin is not on the edge of its box.
                let x = match (is_pin, anchor) {
                    (true, Anchor::Start) => x - 4 + COLUMN,
                    (true, Anchor::End) => x + 4,
                    (..) => *x,
                };
                let column = anchor.begin(x.div_euclid(COLUMN), text);
                let owner = match (place, self.owner(line, column)) {
                    (Some(place), _) => Owner::Operand(*place),
                    (None, step @ Owner::Step(_)) => step,
                    (None, _) => Owner::Text(*tone),
                };
                self.letters(line, column, text, &owner);
                if !key.is_empty() {
                    self.operands.push((line, column, columns(text), key.clone()));
                }
            }
            Item::Line { .. } | Item::Frame { .. } => {}
        }
    }

    /// Whether a line leaves a character in one of the directions.
    fn has(&mut self, line: usize, column: i32, directions: u8) -> bool {
        self.at(line, column).is_some_and(|cell| cell.lines & directions != 0)
    }

    fn owner(&mut self, line: usize, column: i32) -> Owner {
        self.at(line, column).map_or(Owner::Line, |cell| match &cell.owner {
            Owner::Nobody => Owner::Line,
            owner => owner.clone(),
        })
    }

    /// The drawing with what is known now.
    pub fn rows(&self, status: &Status, forcing: &Forcing) -> Vec<Row> {
        let nets = flow(&self.logic, status);
        let bit = |value: Option<bool>| match value {
            Some(true) => Tone::On,
            Some(false) => Tone::Off,
            None => Tone::Unknown,
        };
        let operand = |place: u32| status.operand_at(place).and_then(Value::as_bool);
        let steps: HashMap<String, &Step> = status.steps.iter().map(|step| (folded(&step.step), step)).collect();
        let tone = |owner: &Owner| match owner {
            Owner::Nobody | Owner::Line => Tone::Plain,
            Owner::Net(net) => bit(nets.get(net).copied()),
            // A number is neither on nor off.
            Owner::Operand(place) => operand(*place).map_or(Tone::Plain, |value| bit(Some(value))),
            Owner::Contact(part) => {
                let told = self.contacts.get(part).and_then(|(place, open)| Some(operand(*place)? != *open));
                if told == Some(true) { Tone::On } else { Tone::Plain }
            }
            Owner::Step(name) => match steps.get(name) {
                Some(step) if step.faulty => Tone::Faulty,
                Some(step) if step.active => Tone::Active,
                Some(_) | None => Tone::Plain,
            },
            Owner::Text(tone) => *tone,
        };
        let mut rows: Vec<Vec<(char, Tone)>> = self
            .lines
            .iter()
            .map(|cells| {
                cells
                    .iter()
                    .map(|cell| (cell.letter.unwrap_or(LINES[usize::from(cell.lines & 15)]), tone(&cell.owner)))
                    .collect()
            })
            .collect();
        for (line, column, width, _) in self.operands.iter().filter(|(.., key)| forcing.has(key)) {
            let columns = (*column..column.saturating_add(*width)).filter_map(|column| usize::try_from(column).ok());
            for column in columns {
                if let Some(cell) = rows[*line].get_mut(column) {
                    cell.1 = Tone::Forced;
                }
            }
        }
        for (line, column, anchor, place) in &self.values {
            let Some(value) = status.operand_at(*place) else { continue };
            write_free(&mut rows[*line], *column, *anchor, &text(value));
        }
        rows.into_iter().map(|cells| pieces(&cells)).collect()
    }
}

/// Writes a value where nothing else is. If there is not enough room, only its first characters.
fn write_free(cells: &mut Vec<(char, Tone)>, point: i32, anchor: Anchor, value: &str) {
    let is_free = |column: i32| {
        let place = usize::try_from(column).ok().filter(|place| *place < COLUMNS_MAX);
        place.is_some_and(|place| cells.get(place).is_none_or(|cell| cell.0 == ' '))
    };
    let width = value.chars().count() as i32;
    let before = || (1..=width).take_while(|n| is_free(point.saturating_sub(*n))).count() as i32;
    let after = || (0..width).take_while(|n| is_free(point.saturating_add(*n))).count() as i32;
    let (left, right) = match anchor {
        Anchor::Start => (0, after()),
        Anchor::Middle => (before(), after()),
        Anchor::End => (before(), 0),
    };
    let shown = width.min(left + right);
    let first = match anchor {
        Anchor::Start => point,
        Anchor::Middle => (point - shown / 2).clamp(point - left, point + right - shown),
        Anchor::End => point - shown,
    };
    for (column, letter) in (first..first + shown).zip(value.chars()) {
        let Ok(place) = usize::try_from(column) else { continue };
        if cells.len() <= place {
            cells.resize(place + 1, (' ', Tone::Plain));
        }
        let is_cut = shown < width && column + 1 == first + shown;
        cells[place] = (if is_cut { '…' } else { letter }, Tone::Value);
    }
}

/// Characters that look alike become one piece.
fn pieces(cells: &[(char, Tone)]) -> Row {
    let end = cells.iter().rposition(|(letter, _)| *letter != ' ').map_or(0, |last| last + 1);
    let mut row: Row = Vec::new();
    for (letter, tone) in cells[..end].iter().filter(|(letter, _)| *letter != COVERED) {
        match row.last_mut() {
            Some(last) if last.tone == *tone => last.text.push(*letter),
            _ => row.push(Piece { text: letter.to_string(), tone: *tone }),
        }
    }
    row
}

/// The line of each height of a drawing.
struct Heights(Vec<(i32, usize)>);

impl Heights {
    fn of(items: &[Item]) -> Heights {
        let mut heights = BTreeSet::new();
        for item in items {
            match item {
                Item::Line { from, to, .. } if from.1 == to.1 => drop(heights.insert(from.1)),
                Item::Line { .. } => {}
                Item::Frame { top, bottom, .. } => heights.extend([*top, *bottom]),
                Item::Glyph { y, .. }
                | Item::Text { y, .. }
                | Item::Dot { y, .. }
                | Item::Circle { y, .. }
                | Item::Arrow { y, .. } => drop(heights.insert(*y)),
            }
        }
        let (mut lines, mut line) = (Vec::new(), 0_usize);
        let mut first: Option<i32> = None;
        for height in heights {
            let distance = first.map_or(0, |first| height.saturating_sub(first));
            if first.is_none() || distance > SAME {
                line += match distance {
                    0 => 0,
                    FAR.. => 2,
                    _ => 1,
                };
                first = Some(height);
            }
            lines.push((height, line.min(LINES_MAX)));
        }
        Heights(lines)
    }

    /// Number of lines.
    fn count(&self) -> usize {
        self.0.last().map_or(0, |(_, line)| line + 1)
    }

    /// The line of a height: of one that no item has that of the next one above.
    fn line(&self, height: i32) -> usize {
        let after = self.0.partition_point(|(known, _)| *known <= height);
        after.checked_sub(1).map_or(0, |at| self.0[at].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_without_room_ends_early() {
        let shown = |line: &str, point: i32, anchor: Anchor, value: &str| {
            let mut cells: Vec<(char, Tone)> = line.chars().map(|letter| (letter, Tone::Plain)).collect();
            write_free(&mut cells, point, anchor, value);
            cells.into_iter().map(|(letter, _)| letter).collect::<String>()
        };
        assert_eq!(shown("     │", 5, Anchor::End, "12"), "   12│");
        assert_eq!(shown("     │", 5, Anchor::End, "16#DEADBEEF"), "16#D…│");
        assert_eq!(shown("   │      │", 10, Anchor::End, "-2147483648"), "   │-2147…│");
        assert_eq!(shown("│", 2, Anchor::Start, "-2147483648"), "│ -2147483648");
        assert_eq!(shown("│    │", 2, Anchor::Start, "T#1s500ms"), "│ T#…│");
        assert_eq!(shown("│     │", 3, Anchor::Middle, "16#7F"), "│16#7F│");
        assert_eq!(shown("││", 1, Anchor::Middle, "1"), "││");
        assert_eq!(shown("", i32::MIN, Anchor::Start, "1"), "");
        assert_eq!(shown("", i32::MAX, Anchor::Middle, "1"), "");
    }
}
