//! Places of the objects of a network: columns from left to right in the direction of the flow, and rows that nothing else takes.
//!
//! A contact, coil or block is in the column after those that feed it, on the line of its first source, or below what is there. Values stand
//! before the pins of their block, results after them. Lines between columns take their row too, so they do not cross other objects.

use super::objects::{Kind, Object, ROW};

/// Between columns, where lines go up and down.
const GAP: i32 = 40;
/// Left edge of a body, and of its first column.
const LEFT: i32 = 20;
/// Between networks.
const BELOW: i32 = 40;

/// A range of places that is taken. Columns have even numbers, the gaps after them odd ones.
struct Taken {
    from: usize,
    to: usize,
    top: i32,
    bottom: i32,
    /// Objects whose signal it is: lines of one signal may share a place.
    of: Vec<usize>,
}

/// Places the objects from `first` on below `top`; returns where the next network begins.
pub fn network(objects: &mut [Object], first: usize, top: i32) -> i32 {
    for object in &mut objects[first..] {
        object.measure();
    }
    let mut top = top;
    // Comments and labels stand above.
    for object in objects[first..].iter_mut().filter(|object| matches!(object.kind, Kind::Comment | Kind::Label)) {
        (object.x, object.y) = (LEFT, top);
        top += object.height + 10;
    }
    let attached = attached(objects, first);
    let mut columns: Vec<usize> = vec![0; objects.len()];
    let mut taken: Vec<Taken> = Vec::new();
    let ends: Vec<usize> = objects[first..]
        .iter()
        .filter(|object| object.kind == Kind::RightRail)
        .flat_map(|rail| &rail.inputs)
        .flat_map(|input| &input.from)
        .map(|origin| origin.object)
        .collect();
    // The first line of the network, where the highest object still has its text below `top`.
    let line = objects[first..].iter().map(|object| object.above() + 10 + object.input_place(0).1).max().unwrap_or(0);
    let line = top + line;
    let mut bottom = top + ROW;
    for at in first..objects.len() {
        let kind = objects[at].kind;
        if matches!(kind, Kind::Comment | Kind::Label | Kind::LeftRail | Kind::RightRail) || attached[at].is_some() {
            continue;
        }
        // Values that feed it directly stand before it, in its own column.
        let sources: Vec<(usize, String)> = objects[at]
            .inputs
            .iter()
            .flat_map(|input| &input.from)
            .map(|origin| (origin.object, origin.pin.clone()))
            .collect();
        let is_flow = |from: &usize| attached[*from].is_none() && objects[*from].kind != Kind::LeftRail;
        let column =
            sources.iter().map(|(from, _)| *from).filter(is_flow).map(|from| columns[from]).max().unwrap_or(0) + 1;
        columns[at] = column;
        // On the line of its first source.
        let lead = objects[at].inputs.iter().enumerate().find_map(|(pin, input)| {
            let origin = input.from.first()?;
            is_flow(&origin.object).then(|| (pin, origin.object, origin.pin.clone()))
        });
        let object = &objects[at];
        let above = object.above() + 10;
        let mut y = match &lead {
            Some((pin, from, formal)) => {
                objects[*from].y + objects[*from].output_place(formal).1 - object.input_place(*pin).1
            }
            None => line - object.input_place(0).1,
        };
        y = y.max(top + above);
        let lines = |y: i32| -> Vec<Taken> {
            let row = |from, to, line: i32, of| Taken { from, to, top: line - 5, bottom: line + 5, of };
            let own = 2 * column;
            let mut lines =
                vec![Taken { from: own, to: own, top: y - above, bottom: y + object.height + 10, of: Vec::new() }];
            // Where signals leave it.
            let pins = object.outputs.iter().map(|output| output.formal.as_str());
            for pin in pins.chain(object.outputs.is_empty().then_some("")) {
                lines.push(row(own + 1, own + 1, y + object.output_place(pin).1, vec![at]));
            }
            // The line from a coil to the right rail.
            if ends.contains(&at) {
                lines.push(row(own + 1, usize::MAX, y + ROW / 2, vec![at]));
            }
            for (pin, input) in object.inputs.iter().enumerate() {
                let of: Vec<usize> = input.from.iter().map(|origin| origin.object).collect();
                for origin in input.from.iter().filter(|origin| attached[origin.object].is_none()) {
                    let from = 2 * columns[origin.object] + 1;
                    lines.push(row(from, own - 1, y + object.input_place(pin).1, of.clone()));
                }
            }
            lines
        };
        let clash = |wanted: &Taken| {
            taken.iter().any(|other| {
                wanted.from <= other.to
                    && other.from <= wanted.to
                    && wanted.top < other.bottom
                    && other.top < wanted.bottom
                    && !wanted.of.iter().any(|one| other.of.contains(one))
            })
        };
        while lines(y).iter().any(clash) {
            y += 10;
        }
        let new = lines(y);
        bottom = bottom.max(new.iter().map(|one| one.bottom).max().unwrap_or(0));
        taken.extend(new);
        objects[at].y = y;
    }
    widths(objects, first, &columns, &attached);
    rails(objects, first, top, bottom);
    bottom + BELOW
}

/// Values before the only pin that reads them, and variables after the only pin of a block that they are written from: the other object, and
/// the row of its pin.
fn attached(objects: &[Object], first: usize) -> Vec<Option<(usize, i32)>> {
    let mut found = vec![None; objects.len()];
    let mut pins: Vec<(usize, String)> = Vec::new();
    for at in first..objects.len() {
        for (pin, input) in objects[at].inputs.iter().enumerate() {
            if let [origin] = input.from.as_slice() {
                let source = &objects[origin.object];
                if source.kind == Kind::InVariable {
                    found[origin.object] = Some((at, objects[at].input_place(pin).1));
                }
                let key = (origin.object, origin.pin.clone());
                if objects[at].kind == Kind::OutVariable && source.kind == Kind::Block && !pins.contains(&key) {
                    pins.push(key);
                    found[at] = Some((origin.object, source.output_place(&origin.pin).1));
                }
            }
        }
    }
    found
}

/// Gives columns their widths, and all objects their places from left to right.
fn widths(objects: &mut [Object], first: usize, columns: &[usize], attached: &[Option<(usize, i32)>]) {
    let count = columns[first..].iter().max().map_or(0, |last| last + 1);
    // Of each column: values on the left, objects, variables on the right.
    let mut sizes = vec![(0, 0, 0); count];
    for at in first..objects.len() {
        match attached[at] {
            Some((to, _)) => {
                let side = &mut sizes[columns[to]];
                let width = objects[at].width + 20;
                match objects[at].kind {
                    Kind::InVariable => side.0 = side.0.max(width),
                    _ => side.2 = side.2.max(width),
                }
            }
            None if columns[at] > 0 => {
                let side = &mut sizes[columns[at]];
                side.1 = side.1.max(objects[at].whole_width());
            }
            None => {}
        }
    }
    let mut starts = Vec::with_capacity(count);
    let mut x = LEFT + 10;
    for (left, middle, right) in &sizes {
        if *middle > 0 {
            x += GAP;
        }
        starts.push(x + left);
        x += left + middle + right;
    }
    // Lines of different objects of a column go up and down side by side.
    let mut lines = vec![0; count];
    for at in first..objects.len() {
        if attached[at].is_none() && columns[at] > 0 {
            let column = columns[at];
            let end = starts[column] + sizes[column].1 + sizes[column].2;
            objects[at].exit = end + 5 + 5 * (lines[column] % 6);
            lines[column] += 1;
            objects[at].x = starts[columns[at]] + (sizes[columns[at]].1 - objects[at].width) / 2;
        }
    }
    for at in first..objects.len() {
        if let Some((to, row)) = attached[at] {
            objects[at].y = objects[to].y + row - ROW / 2;
            objects[at].x = match objects[at].kind {
                Kind::InVariable => starts[columns[to]] - 20 - objects[at].width,
                _ => starts[columns[to]] + sizes[columns[to]].1 + 20,
            };
        }
    }
}

/// The rails reach from the first row to the last.
fn rails(objects: &mut [Object], first: usize, top: i32, bottom: i32) {
    let end = objects[first..]
        .iter()
        .filter(|object| !matches!(object.kind, Kind::Comment | Kind::Label))
        .map(|object| object.x + object.width)
        .max()
        .unwrap_or(LEFT);
    for object in &mut objects[first..] {
        match object.kind {
            Kind::LeftRail => (object.x, object.y, object.height) = (LEFT, top, bottom - top),
            Kind::RightRail => (object.x, object.y, object.height) = (end + GAP, top, bottom - top),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plcopen::objects::{Input, Origin, Output};

    fn from(list: &[(usize, &str)]) -> Vec<Origin> {
        list.iter().map(|(object, pin)| Origin { object: *object, pin: (*pin).to_string() }).collect()
    }

    fn fed(kind: Kind, text: &str, list: &[(usize, &str)]) -> Object {
        let mut object = Object::new(kind, text);
        object.inputs.push(Input { from: from(list), ..Input::default() });
        object
    }

    #[test]
    fn objects_do_not_overlap() {
        let mut block = fed(Kind::Block, "TON", &[(1, "")]);
        block.instance = Some("a_rather_long_name_of_an_instance".to_string());
        block.inputs[0].formal = "IN".to_string();
        block.inputs.push(Input { formal: "PT".to_string(), from: from(&[(3, "")]), ..Input::default() });
        for name in ["Q", "ET"] {
            block.outputs.push(Output { formal: name.to_string(), negated: false });
        }
        let mut objects = vec![
            Object::new(Kind::LeftRail, ""),
            fed(Kind::Contact, "start", &[(0, "")]),
            fed(Kind::Contact, "hold", &[(0, "")]),
            Object::new(Kind::InVariable, "T#5s"),
            block,
            fed(Kind::OutVariable, "elapsed", &[(4, "ET")]),
            fed(Kind::Coil, "motor", &[(4, "Q"), (2, "")]),
            fed(Kind::Coil, "lamp", &[(4, "Q")]),
        ];
        let next = network(&mut objects, 0, 20);
        for (at, a) in objects.iter().enumerate().skip(1) {
            assert!(a.y >= 20 && a.y + a.height < next, "{}", a.text);
            for b in &objects[at + 1..] {
                let apart =
                    a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
                assert!(apart, "{} {}", a.text, b.text);
            }
        }
        assert_eq!(objects[4].y + 40, objects[1].y + 10, "on the line of its source");
        assert_eq!(objects[3].y + 10, objects[4].y + 70, "before its pin");
    }
}
