//! Networks of LAD and FBD as drawings in text, for messages.
//!
//! ```text
//!     #Start      #Stop      #Motor
//! |---| |-----+---|/|--------( )---
//! |           |
//! |   #Motor  |
//! |---| |-----+
//! ```
//!
//! Elements that follow each other are on one line; a net with several ends is a column that joins its lines. A branch begins or ends
//! at the column of its net; where a net only feeds pins of boxes, or the drawing is cut, its name is there instead. The drawing
//! shows the network even if it makes no sense: loops, open pins, nets without a source.

mod canvas;
mod operand;
mod plan;
mod shape;

use super::ast::{Content, Graph, Network};
use canvas::Canvas;
use plan::Plan;
use shape::Shape;

pub use operand::{formula_of, operand, whole, whole_of};
pub use shape::{is_timer_box, symbol};

/// Most elements of a drawing; those next to the marked one are shown.
const ELEMENTS_MAX: usize = 24;
/// Most columns of a drawing, if fewer elements can make it narrower.
const COLUMNS_MAX: usize = 140;

/// Draws a network; a line of `^` is below the element `mark`. Empty for networks in SCL and STL.
pub fn draw(network: &Network, mark: Option<usize>) -> String {
    let Content::Graphic(graph) = &network.content else { return String::new() };
    let mut most = ELEMENTS_MAX;
    loop {
        let canvas = draw_part(network, graph, mark, most);
        if most == 1 || canvas.width() <= COLUMNS_MAX {
            return canvas.text();
        }
        most = most * 2 / 3;
    }
}

fn draw_part(network: &Network, graph: &Graph, mark: Option<usize>, most: usize) -> Canvas {
    let chosen = plan::choose(graph, mark, most);
    let shapes: Vec<Shape> =
        chosen.iter().map(|&at| Shape::of(graph, &graph.elements[at], network.language, mark == Some(at))).collect();
    Plan::of(graph, &chosen, &shapes).paint(graph, &shapes)
}
