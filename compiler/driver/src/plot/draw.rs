//! Panels as SVG, by `plotters`.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::{Column, Panels, label};

const WIDTH: u32 = 960;
const TITLE_HEIGHT: u32 = 40;
const NUMBERS_HEIGHT: u32 = 260;
const BIT_HEIGHT: u32 = 34;
/// Axis of time below the last panel.
const AXIS_HEIGHT: u32 = 46;
/// Space left of the axes, so that all panels begin at the same place.
const LABELS_WIDTH: u32 = 98;
/// Letters of a name that fit there.
const NAME_MAX: usize = 13;
/// Space left of the labels.
const MARGIN: u32 = 12;
/// The shortest axis of time, in seconds.
const END_MIN: f64 = 1e-12;
/// Smallest space above and below the values.
const ROOM_MIN: f64 = 1e-30;
const FONT: &str = "sans-serif";

/// Colours that are easy to distinguish, on paper and with colour blindness (Okabe and Ito).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The picture. `Err`: the message of the library.
pub(super) fn svg(panels: &Panels, title: &str) -> Result<String, String> {
    let title_height = if title.is_empty() { 8 } else { TITLE_HEIGHT };
    let bits_height = BIT_HEIGHT * panels.bits.len() as u32;
    let height = title_height + NUMBERS_HEIGHT * panels.numbers.len() as u32 + bits_height + AXIS_HEIGHT;
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        draw(&root, panels, title, title_height).map_err(|error| error.to_string())?;
        root.present().map_err(|error| error.to_string())?;
    }
    Ok(text)
}

fn draw(root: &Area, panels: &Panels, title: &str, title_height: u32) -> Result<(), Box<dyn std::error::Error>> {
    root.fill(&WHITE)?;
    let (head, mut rest) = root.split_vertically(title_height);
    if !title.is_empty() {
        head.titled(title, (FONT, 20))?;
    }
    // A trace with one sample also has an axis.
    let end = if panels.end > END_MIN { panels.end } else { 1.0 };
    for (index, (unit, columns)) in panels.numbers.iter().enumerate() {
        let is_last = panels.bits.is_empty() && index + 1 == panels.numbers.len();
        let (panel, below) = rest.split_vertically(NUMBERS_HEIGHT + if is_last { AXIS_HEIGHT } else { 0 });
        numbers(&panel, unit, columns, end, is_last)?;
        rest = below;
    }
    if !panels.bits.is_empty() {
        bits(&rest, &panels.bits, end)?;
    }
    Ok(())
}

fn numbers(
    area: &Area,
    unit: &str,
    columns: &[Column],
    end: f64,
    with_time: bool,
) -> Result<(), Box<dyn std::error::Error>> {
    let values = || columns.iter().flat_map(|column| column.points.iter().map(|(_, value)| *value));
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    let room = if most > least { (most - least) * 0.06 } else { 1.0 };
    // The axis adds the distance of its lines repeatedly; the distance must not vanish next to a larger value.
    let room = room.max(most.abs().max(least.abs()) * 1e-6).max(ROOM_MIN);
    let mut chart = ChartBuilder::on(area)
        .margin_left(MARGIN)
        .margin_right(16)
        .margin_top(6)
        .margin_bottom(6)
        .set_label_area_size(LabelAreaPosition::Left, LABELS_WIDTH)
        .set_label_area_size(LabelAreaPosition::Bottom, if with_time { AXIS_HEIGHT } else { 0 })
        .build_cartesian_2d(0.0..end, least - room..most + room)?;
    let description = if unit.is_empty() { "value" } else { unit };
    let mut mesh = chart.configure_mesh();
    mesh.max_light_lines(0).bold_line_style(RGBColor(225, 225, 225)).y_desc(description).y_labels(8);
    mesh.x_labels(12).x_label_formatter(&|value| label(*value)).y_label_formatter(&|value| label(*value));
    mesh.label_style((FONT, 13)).axis_desc_style((FONT, 14));
    if with_time {
        mesh.x_desc("time in s");
    }
    mesh.draw()?;
    for (index, column) in columns.iter().enumerate() {
        let style = COLORS[index % COLORS.len()].stroke_width(2);
        chart
            .draw_series(LineSeries::new(steps(&thinned(&column.points, end)), style))?
            .label(&column.name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 22, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .legend_area_size(28)
        .margin(8)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(170, 170, 170))
        .label_font((FONT, 13))
        .draw()?;
    Ok(())
}

/// Bits one above the other, each with its name at the axis.
fn bits(area: &Area, columns: &[Column], end: f64) -> Result<(), Box<dyn std::error::Error>> {
    let count = columns.len();
    let mut chart = ChartBuilder::on(area)
        .margin_left(MARGIN)
        .margin_right(16)
        .margin_top(4)
        .set_label_area_size(LabelAreaPosition::Left, LABELS_WIDTH)
        .set_label_area_size(LabelAreaPosition::Bottom, AXIS_HEIGHT)
        .build_cartesian_2d(0.0..end, 0.0..count as f64)?;
    let mut mesh = chart.configure_mesh();
    mesh.max_light_lines(0).bold_line_style(RGBColor(225, 225, 225)).y_labels(0).x_labels(12);
    mesh.x_desc("time in s").x_label_formatter(&|value| label(*value));
    mesh.label_style((FONT, 13)).axis_desc_style((FONT, 14));
    mesh.draw()?;
    for (index, column) in columns.iter().enumerate() {
        let low = (count - 1 - index) as f64 + 0.15;
        let lane: Vec<(f64, f64)> =
            thinned(&column.points, end).into_iter().map(|(time, bit)| (time, low + 0.6 * bit)).collect();
        let color = COLORS[index % COLORS.len()];
        chart.draw_series(LineSeries::new(steps(&lane), color.stroke_width(2)))?;
        name(area, &chart, &column.name, low + 0.3)?;
    }
    Ok(())
}

/// A name left of the axis.
fn name(
    area: &Area,
    chart: &ChartContext<SVGBackend, Cartesian2d<RangedCoordf64, RangedCoordf64>>,
    text: &str,
    height: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    use plotters::style::text_anchor::{HPos, Pos, VPos};
    // Of names that are too long the end is shown, which differs within a data block.
    let count = text.chars().count();
    let shown: String = match count > NAME_MAX {
        true => std::iter::once('…').chain(text.chars().skip(count - NAME_MAX + 1)).collect(),
        false => text.to_string(),
    };
    let (x, y) = chart.backend_coord(&(0.0, height));
    let (left, top) = area.get_base_pixel();
    let style = TextStyle::from((FONT, 13).into_font()).pos(Pos::new(HPos::Right, VPos::Center));
    area.draw(&Text::new(shown, (x - left - 8, y - top), style))?;
    Ok(())
}

/// A value holds until the next sample.
fn steps(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut steps: Vec<(f64, f64)> = Vec::with_capacity(2 * points.len());
    for &(time, value) in points {
        if let Some(&(_, last)) = steps.last()
            && last != value
        {
            steps.push((time, last));
        }
        steps.push((time, value));
    }
    steps
}

/// The visible samples: for each column of pixels the first, the smallest, the largest and the last.
fn thinned(points: &[(f64, f64)], end: f64) -> Vec<(f64, f64)> {
    let pixels = f64::from(WIDTH - LABELS_WIDTH);
    let pixel = |time: f64| (time / end * pixels) as i64;
    let mut seen: Vec<(f64, f64)> = Vec::new();
    for column in points.chunk_by(|a, b| pixel(a.0) == pixel(b.0)) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let mut kept: Vec<(f64, f64)> = column.first().into_iter().copied().collect();
        let (least, most) = (column.iter().min_by(by_value), column.iter().max_by(by_value));
        let mut inner: Vec<(f64, f64)> = least.into_iter().chain(most).chain(column.last()).copied().collect();
        inner.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.extend(inner);
        kept.dedup();
        seen.extend(kept);
    }
    seen
}
