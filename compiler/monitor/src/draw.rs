//! The picture of the model: head, tree, watch table, diagnostic buffer, and a line that says what keys do.
//!
//! - [`block`](mod@block): a block that is open.

mod block;

use plcc_abi::services::Role;
use ratatui::Frame;
use ratatui::layout::{Constraint, Flex, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Cell, List, ListItem, ListState, Paragraph, Row, Table, TableState};

use crate::model::{Asks, Model, Part};
use crate::row::clock;

/// Draws everything.
pub fn draw(model: &Model, frame: &mut Frame) {
    let lines = rows(self::foot(model), frame.area().width);
    let [head, middle, below, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Min(5),
        Constraint::Percentage(30),
        Constraint::Length(lines.len() as u16),
    ])
    .areas(frame.area());
    let [left, right] = Layout::horizontal([Constraint::Percentage(40), Constraint::Percentage(60)]).areas(middle);
    frame.render_widget(Paragraph::new(self::head(model)), head);
    match &model.block {
        Some(open) => block::block(model, open, frame, middle.union(below)),
        None => {
            program(model, frame, left);
            watch(model, frame, right);
            diagnostics(model, frame, below);
        }
    }
    frame.render_widget(Paragraph::new(lines), foot);
}

/// A line, or the lines that it needs on a narrow screen: what two blanks separate goes below, and what is still too wide word by word.
fn rows(line: Line<'_>, width: u16) -> Vec<Line<'_>> {
    let (width, width_of) = (usize::from(width), |text: &str| Span::raw(text).width());
    if line.width() <= width {
        return vec![line];
    }
    let text = line.to_string();
    let mut rows: Vec<String> = Vec::new();
    let mut add = |part: &str, gap: &str| match rows.last_mut() {
        Some(row) if width_of(row.as_str()) + gap.len() + width_of(part) <= width => row.extend([gap, part]),
        Some(_) | None => rows.push(part.to_string()),
    };
    for part in text.trim().split("  ") {
        if width_of(part) <= width {
            add(part, "  ");
        } else {
            part.split(' ').for_each(|word| add(word, " "));
        }
    }
    let style = line.spans.first().map_or(Style::new(), |span| span.style);
    rows.into_iter().map(|row| Line::styled(row, style)).collect()
}

fn colored(color: Color) -> Style {
    Style::new().fg(Color::Black).bg(color)
}

fn head(model: &Model) -> Line<'_> {
    let mut parts = Vec::new();
    match (&model.lost, model.state.running) {
        (Some(why), _) => parts.push(Span::styled(format!(" no connection: {why} "), colored(Color::Red))),
        (None, true) => parts.push(Span::styled(" RUN ", colored(Color::Green))),
        (None, false) => parts.push(Span::styled(" STOP ", colored(Color::Yellow))),
    }
    if model.lost.is_none() && model.state.outputs {
        parts.push(Span::raw(" "));
        parts.push(Span::styled(" outputs enabled ", colored(Color::Yellow)));
    }
    if !model.forced.is_empty() {
        parts.push(Span::raw(" "));
        parts.push(Span::styled(format!(" F {} ", model.forced.len()), colored(Color::Yellow)));
    }
    if let Some(hello) = &model.hello {
        parts.push(Span::raw(format!("  {}  {}", hello.program, hello.cpu)));
    }
    if model.lost.is_none() {
        parts.push(Span::raw(format!("  cycle {}  {}", model.state.cycle, model.state.reason)));
    }
    parts.push(Span::raw(format!("  {}", model.address)));
    Line::from(parts)
}

fn frame_of(model: &Model, part: Part, title: &str) -> Block<'static> {
    let style = match model.part == part {
        true => Style::new().add_modifier(Modifier::BOLD),
        false => Style::new().fg(Color::DarkGray),
    };
    Block::bordered().title(format!(" {title} ")).border_style(style)
}

const CURSOR: Style = Style::new().add_modifier(Modifier::REVERSED);

fn program(model: &Model, frame: &mut Frame, area: Rect) {
    let title = match model.search.as_str() {
        "" => "program".to_string(),
        search => format!("program: {search}"),
    };
    let item = |node: &crate::tree::Node| {
        let mark = match node.open {
            Some(true) => "▾ ",
            Some(false) => "▸ ",
            None => "  ",
        };
        let text = format!("{:width$}{mark}{}", "", node.label, width = 2 * node.depth);
        let ty = if node.ty.is_empty() { String::new() } else { format!("  {}", node.ty) };
        ListItem::new(Line::from(vec![Span::raw(text), Span::styled(ty, Style::new().fg(Color::DarkGray))]))
    };
    let list =
        List::new(model.tree.iter().map(item)).block(frame_of(model, Part::Program, &title)).highlight_style(CURSOR);
    let selected = (model.part == Part::Program).then(|| model.row(Part::Program));
    frame.render_stateful_widget(list, area, &mut ListState::default().with_selected(selected));
}

fn watch(model: &Model, frame: &mut Frame, area: Rect) {
    let widths = [Constraint::Length(1), Constraint::Percentage(45), Constraint::Percentage(40), Constraint::Min(6)];
    // The same columns as those of the table inside its frame.
    let inner = Rect::new(0, 0, area.width.saturating_sub(2), 1);
    let [_, _, room, _] = Layout::horizontal(widths).flex(Flex::Start).spacing(1).areas(inner);
    let row = |name: &String| {
        let forced = model.forced.iter().any(|forced| forced.name == *name);
        let (value, ty, style) = match model.values.get(name) {
            Some(Ok(shown)) => (shown.text.clone(), shown.ty.to_string(), Style::new()),
            Some(Err(why)) => (why.clone(), String::new(), Style::new().fg(Color::Red)),
            None => (String::new(), String::new(), Style::new()),
        };
        let arrow = match (model.entered.get(name), value.is_empty()) {
            (Some(entered), true) => format!("→ {entered}"),
            (Some(entered), false) => format!("  → {entered}"),
            (None, _) => String::new(),
        };
        let arrow = Span::styled(arrow, Style::new().fg(Color::DarkGray));
        Row::new([
            Cell::new(if forced { "F" } else { "" }).style(Style::new().fg(Color::Yellow)),
            Cell::new(name.clone()),
            Cell::new(Line::from(vec![Span::styled(shortened(value, room.width.into()), style), arrow])),
            Cell::new(ty).style(Style::new().fg(Color::DarkGray)),
        ])
    };
    let title = match &model.table {
        Some(name) => format!("watch table {name}"),
        None => "watch table".to_string(),
    };
    let table = Table::new(model.watched.iter().map(row), widths)
        .block(frame_of(model, Part::Watch, &title))
        .row_highlight_style(CURSOR);
    let selected = (model.part == Part::Watch).then(|| model.row(Part::Watch));
    frame.render_stateful_widget(table, area, &mut TableState::default().with_selected(selected));
}

/// A text of at most so many columns; a longer one ends with `…`.
fn shortened(mut text: String, columns: usize) -> String {
    if Span::raw(text.as_str()).width() <= columns {
        return text;
    }
    while !text.is_empty() && Span::raw(text.as_str()).width() >= columns {
        text.pop();
    }
    text.push('…');
    text
}

fn diagnostics(model: &Model, frame: &mut Frame, area: Rect) {
    let item = |entry: &crate::messages::Entry| {
        ListItem::new(format!("{}  {}  {}", clock(entry.clock as i64), entry.text, entry.place))
    };
    let list = List::new(model.buffer.iter().map(item))
        .block(frame_of(model, Part::Diagnostics, "diagnostic buffer"))
        .highlight_style(CURSOR);
    let selected = (model.part == Part::Diagnostics).then(|| model.row(Part::Diagnostics));
    frame.render_stateful_widget(list, area, &mut ListState::default().with_selected(selected));
}

fn foot(model: &Model) -> Line<'_> {
    if let Some((asks, text)) = &model.asks {
        let question = match asks {
            Asks::Search => "search",
            Asks::Name => "name or address",
            Asks::Modify => "new value",
            Asks::Force => "forced value",
            Asks::Stop => "put the CPU into STOP? Type y",
            Asks::Run if model.has_cold_restart() => "start the CPU? Type y for a warm restart, c for a cold restart",
            Asks::Run => "start the CPU with a warm restart? Type y",
            Asks::Outputs => "enable outputs, so that values you modify reach the modules? Type y",
            Asks::Reset => "reset the memory, so that all data gets its start values, retentive data too? Type y",
        };
        return Line::from(format!("{question}: {text}▏  Enter: confirm  Esc: cancel"));
    }
    if !model.refused.is_empty() {
        return Line::from(Span::styled(format!(" {} ", model.refused), colored(Color::Red)));
    }
    // The row of a wrong name has no room for the whole reason.
    let name = (model.part == Part::Watch).then(|| model.watched.get(model.row(Part::Watch))).flatten();
    if let Some(Err(why)) = name.and_then(|name| model.values.get(name)) {
        return Line::from(vec![Span::styled(format!(" {why} "), colored(Color::Red)), Span::raw("  d: remove")]);
    }
    let own = match model.part {
        Part::Program => "Enter: open, watch  /: search",
        Part::Watch if model.role() == Role::Change => "f: force  u: end forcing  d: remove",
        Part::Watch => "d: remove",
        Part::Diagnostics if model.event().is_some() => "Enter: open its block",
        Part::Diagnostics | Part::Block => "",
    };
    let may_modify = model.part == Part::Watch && model.role() != Role::Look;
    let modify = match (may_modify, model.entered.is_empty()) {
        (true, true) => "m: modify  ",
        (true, false) => "m: modify  M: all  ",
        (false, _) => "",
    };
    let control = match (model.role(), model.lost.is_none() && !model.state.running, model.state.outputs) {
        (Role::Change, true, false) => "  R: run  O: enable outputs  C: reset memory",
        (Role::Change, true, true) => "  R: run  O: disable outputs  C: reset memory",
        (Role::Change, false, _) => "  S: stop  R: run",
        (Role::Look | Role::Operate, ..) => "",
    };
    if model.part == Part::Block {
        let other = match (&model.block, model.networks) {
            (Some(open), false) if open.has_both() => "  v: networks",
            (Some(open), true) if open.has_both() => "  v: statements",
            (_, _) => "",
        };
        return Line::from(format!("Esc: back  ↑↓ ←→  c: next call{other}{control}  q: leave"));
    }
    let tables = if model.has_tables() { "  t: next table" } else { "" };
    Line::from(format!("Tab ↑↓  {modify}{own}  a: add{tables}{control}  q: leave"))
}
