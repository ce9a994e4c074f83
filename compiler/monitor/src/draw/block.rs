//! The block that is open, in the place of all parts.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph};

use super::colored;
use crate::block;
use crate::model::{Model, Part};
use crate::row::{Row, Tone};

pub fn block(model: &Model, open: &block::Block, frame: &mut Frame, area: Rect) {
    let lines: Vec<Line> = open.rows.iter().skip(model.row(Part::Block)).take(area.height.into()).map(line).collect();
    let edge = Block::bordered()
        .title(format!(" {} ", open.title()))
        .title_bottom(format!(" {} ", open.note))
        .border_style(Style::new().add_modifier(Modifier::BOLD));
    let aside = u16::try_from(model.aside).unwrap_or(u16::MAX);
    let inner = edge.inner(area);
    let widths: Vec<usize> = lines.iter().map(width).collect();
    frame.render_widget(Paragraph::new(lines).scroll((0, aside)).block(edge), area);
    // A number that is cut at the edge must not be read as another number.
    let Some(last) = inner.right().checked_sub(1).filter(|_| inner.width > 0) else { return };
    for (y, width) in (inner.top()..inner.bottom()).zip(widths) {
        if width > usize::from(aside) + usize::from(inner.width) {
            frame.buffer_mut()[(last, y)].set_symbol("…");
        }
    }
}

/// Columns of a line without the blanks at its end.
fn width(line: &Line<'_>) -> usize {
    let text: String = line.iter().map(|span| &*span.content).collect();
    Span::raw(text.trim_end()).width()
}

fn line(row: &Row) -> Line<'_> {
    row.iter().map(|piece| Span::styled(piece.text.as_str(), style(piece.tone))).collect()
}

fn style(tone: Tone) -> Style {
    match tone {
        Tone::Plain => Style::new(),
        Tone::Title => Style::new().add_modifier(Modifier::BOLD),
        Tone::Note | Tone::Unknown => Style::new().fg(Color::DarkGray),
        Tone::On => Style::new().fg(Color::Green).add_modifier(Modifier::BOLD),
        Tone::Off => Style::new().fg(Color::Blue),
        Tone::Value => Style::new().fg(Color::Yellow),
        Tone::Active => colored(Color::Green),
        Tone::Faulty => colored(Color::Red),
        Tone::Forced => colored(Color::Yellow),
    }
}
