//! Charts of GRAPH: steps from top to bottom, transitions with their conditions, branches side by side.
//!
//! A branch ends where all its ways have come together again: a single line joins alternatives, a double line paths that run at the same
//! time. Where a drawing cannot show that (a jump, a loop, ways that cross), an arrow names the step. Once only one way to a step is left,
//! since all others are arrows, the step is below that way.

mod piece;
mod tiles;

use std::collections::{HashMap, HashSet};

use plcc_syntax::chart::ast::{Body, Transition};

use crate::scene::Scene;
use piece::{End, Piece};
pub use tiles::Tiles;

/// Free space around a drawing.
const MARGIN: i32 = 10;

/// Draws a chart.
pub fn draw(body: &Body, tiles: &Tiles) -> Scene {
    let mut maker = Maker::new(body, tiles);
    let mut scene = Scene::default();
    let mut top = MARGIN;
    while let Some(start) = maker.start() {
        let mut piece = match start {
            Start::Step(step) => maker.sequence(step),
            Start::Join(transition) => maker.joined(transition),
        };
        maker.finish(&mut piece);
        scene.width = scene.width.max(piece.width + 2 * MARGIN);
        let height = piece.height;
        scene.add(piece.scene, (MARGIN, top));
        top += height + 3 * MARGIN;
    }
    scene.width = scene.width.max(2 * MARGIN);
    scene.height = top.max(2 * MARGIN);
    scene
}

/// What a drawing begins with.
enum Start {
    Step(usize),
    /// A transition whose paths end at arrows.
    Join(usize),
}

struct Maker<'a> {
    body: &'a Body,
    tiles: &'a Tiles<'a>,
    /// Steps by name.
    steps: HashMap<String, usize>,
    /// Transitions that leave a step, in the order of the drawing.
    leaving: Vec<Vec<usize>>,
    /// The group of each transition, and the transitions of each group, in the order of the drawing: those that leave the same steps.
    group: Vec<usize>,
    groups: Vec<Vec<usize>>,
    /// How many ways to a step are neither jumps nor drawn as arrows.
    entries: Vec<usize>,
    placed: HashSet<usize>,
    drawn: HashSet<usize>,
    /// Branches inside each other.
    level: usize,
}

/// Branches inside each other; deeper ones begin a drawing of their own.
const LEVELS_MAX: usize = 40;

impl<'a> Maker<'a> {
    fn new(body: &'a Body, tiles: &'a Tiles<'a>) -> Maker<'a> {
        let steps: HashMap<String, usize> =
            body.steps.iter().enumerate().map(|(at, step)| (step.name.text.to_lowercase(), at)).collect();
        let mut maker = Maker {
            body,
            tiles,
            steps,
            leaving: vec![Vec::new(); body.steps.len()],
            group: Vec::new(),
            groups: Vec::new(),
            entries: vec![0; body.steps.len()],
            placed: HashSet::new(),
            drawn: HashSet::new(),
            level: 0,
        };
        let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
        for (at, transition) in body.transitions.iter().enumerate() {
            let mut from = maker.of(&transition.from);
            for &step in &from {
                maker.leaving[step].push(at);
            }
            from.sort_unstable();
            let own = maker.groups.len();
            let group = if from.is_empty() { own } else { *known.entry(from).or_insert(own) };
            if group == own {
                maker.groups.push(Vec::new());
            }
            maker.group.push(group);
            maker.groups[group].push(at);
            if !transition.jump {
                for step in maker.of(&transition.to) {
                    maker.entries[step] += 1;
                }
            }
        }
        let key = |at: &usize| (body.transitions[*at].path.clone(), body.transitions[*at].number);
        maker.leaving.iter_mut().chain(&mut maker.groups).for_each(|list| list.sort_by_key(key));
        maker
    }

    fn of(&self, names: &[plcc_syntax::scl::ast::Name]) -> Vec<usize> {
        names.iter().filter_map(|name| self.steps.get(&name.text.to_lowercase()).copied()).collect()
    }

    /// Where the next drawing begins: at initial steps, then at those that nothing leads to, then at transitions that join paths and could
    /// not be drawn below them, then at all steps and transitions that are left.
    fn start(&self) -> Option<Start> {
        let left = || (0..self.body.steps.len()).filter(move |at| !self.placed.contains(at));
        let undrawn = || (0..self.body.transitions.len()).filter(move |at| !self.drawn.contains(at));
        let is_placed = |at: &usize| {
            let from = self.of(&self.body.transitions[*at].from);
            from.len() > 1 && from.iter().all(|step| self.placed.contains(step))
        };
        let step = left().find(|at| self.body.steps[*at].initial).or_else(|| left().find(|at| self.entries[*at] == 0));
        let join = || undrawn().find(is_placed).map(Start::Join);
        let rest = || left().next().map(Start::Step).or_else(|| undrawn().next().map(Start::Join));
        step.map(Start::Step).or_else(join).or_else(rest)
    }

    /// A transition, and what follows, below the names of the steps that it waits for.
    fn joined(&mut self, at: usize) -> Piece {
        let names: Vec<String> =
            self.of(&self.body.transitions[at].from).into_iter().map(|step| self.name(step)).collect();
        let mut piece = Piece::joint(&names.join(", "));
        let mut next = self.after_join(at);
        self.go_on(&mut next);
        piece.below(next);
        piece
    }

    /// The transitions that leave the same steps as this one, from left to right.
    fn joining(&self, at: usize) -> &[usize] {
        &self.groups[self.group[at]]
    }

    /// The transitions that join the same paths, side by side, and what follows.
    fn after_join(&mut self, at: usize) -> Piece {
        let branches: Vec<usize> = self.joining(at).iter().copied().filter(|at| !self.drawn.contains(at)).collect();
        if branches.len() < 2 {
            return self.transition(at);
        }
        Piece::beside(branches.into_iter().map(|at| self.transition_and_more(at)).collect(), false)
    }

    /// A step and all that follows, down to the open ends.
    fn sequence(&mut self, start: usize) -> Piece {
        self.placed.insert(start);
        let mut piece = self.tiles.step(&self.body.steps[start]);
        let mut step = start;
        loop {
            let leaving = self.leaving[step].clone();
            let joins = |at: &usize| self.body.transitions[*at].from.len() > 1;
            let (joining, own): (Vec<usize>, Vec<usize>) = leaving.iter().partition(|at| joins(at));
            match (&own[..], &joining[..]) {
                ([], []) => return piece,
                ([], [join, others @ ..]) if others.iter().all(|at| self.group[*at] == self.group[*join]) => {
                    piece.ends = vec![(piece.exit, End::Join(*join))];
                    return piece;
                }
                ([only], []) => {
                    let next = self.transition(*only);
                    piece.below(next);
                }
                _ => {
                    let mut branches: Vec<Piece> = Vec::new();
                    for at in own {
                        branches.push(self.transition_and_more(at));
                    }
                    for at in joining {
                        branches.push(Piece::arrow(&format!("to {}", label(&self.body.transitions[at]))));
                    }
                    piece.below(Piece::beside(branches, false));
                }
            }
            // One way goes on where all others have come in.
            match self.closed(&mut piece) {
                Some(next) => {
                    self.placed.insert(next);
                    let more = self.tiles.step(&self.body.steps[next]);
                    piece.below(more);
                    step = next;
                }
                None => return piece,
            }
        }
    }

    /// A transition and what it leads to, inside of a branch.
    fn transition_and_more(&mut self, at: usize) -> Piece {
        let mut piece = self.transition(at);
        self.go_on(&mut piece);
        piece
    }

    fn go_on(&mut self, piece: &mut Piece) {
        if self.level >= LEVELS_MAX {
            return;
        }
        self.level += 1;
        if let Some(next) = self.closed(piece) {
            let more = self.sequence(next);
            piece.below(more);
        }
        self.level -= 1;
    }

    /// A transition, with the branches that begin below it.
    fn transition(&mut self, at: usize) -> Piece {
        self.drawn.insert(at);
        let transition = &self.body.transitions[at];
        let mut piece = self.tiles.transition(transition);
        let to = self.of(&transition.to);
        match &to[..] {
            [] => piece.below(Piece::stop()),
            [one] if transition.jump || self.placed.contains(one) => piece.below(self.arrow(*one)),
            [one] => piece.ends = vec![(piece.entry, End::Step(*one))],
            many => {
                let mut branches = Vec::new();
                for &step in many {
                    let deep = self.level >= LEVELS_MAX;
                    if transition.jump || self.placed.contains(&step) {
                        branches.push(self.arrow(step));
                    } else if deep || self.entries[step] > 1 {
                        branches.push(Piece::arrow(&self.target(End::Step(step))));
                    } else {
                        self.level += 1;
                        branches.push(self.sequence(step));
                        self.level -= 1;
                    }
                }
                piece.below(Piece::beside(branches, true));
                self.join(&mut piece);
            }
        }
        piece
    }

    /// Joins the paths of a simultaneous branch where all of them wait for one transition.
    fn join(&mut self, piece: &mut Piece) {
        let joins: Vec<usize> = piece
            .ends
            .iter()
            .filter_map(|(_, end)| match end {
                End::Join(at) => Some(*at),
                End::Step(_) => None,
            })
            .collect();
        let Some(&first) = joins.first() else { return };
        let paths = joins.iter().filter(|at| **at == first).count();
        if paths < self.body.transitions[first].from.len() || self.drawn.contains(&first) {
            return;
        }
        self.others_leave(piece, End::Join(first));
        piece.close(true);
        let next = self.after_join(first);
        piece.below(next);
    }

    /// The step that follows if all ways to it end here.
    fn closed(&mut self, piece: &mut Piece) -> Option<usize> {
        let ends: Vec<usize> = piece
            .ends
            .iter()
            .filter_map(|(_, end)| match end {
                End::Step(at) => Some(*at),
                End::Join(_) => None,
            })
            .collect();
        let complete = |at: &&usize| {
            !self.placed.contains(at) && ends.iter().filter(|end| end == at).count() >= self.entries[**at]
        };
        let next = *ends.iter().find(complete)?;
        self.others_leave(piece, End::Step(next));
        piece.close(false);
        Some(next)
    }

    /// Ends other than `kept` become arrows.
    fn others_leave(&mut self, piece: &mut Piece, kept: End) {
        // From the right, so that no line crosses the text of an arrow; ends that are left go down with the piece.
        while let Some(at) = piece.ends.iter().rposition(|(_, end)| *end != kept) {
            let (x, end) = piece.ends.remove(at);
            piece.arrow_at(x, &self.target(end));
        }
    }

    /// All open ends become arrows.
    fn finish(&mut self, piece: &mut Piece) {
        while let Some((x, end)) = piece.ends.pop() {
            piece.arrow_at(x, &self.target(end));
        }
    }

    /// What an arrow says at the end of a way.
    fn target(&mut self, end: End) -> String {
        match end {
            End::Step(at) => {
                self.entries[at] = self.entries[at].saturating_sub(1);
                self.name(at)
            }
            End::Join(at) => {
                let labels = self.joining(at).iter().map(|at| label(&self.body.transitions[*at]));
                format!("to {}", labels.collect::<Vec<_>>().join(", "))
            }
        }
    }

    fn name(&self, step: usize) -> String {
        let step = &self.body.steps[step];
        let own = format!("S{}", step.number);
        if step.name.text == own { own } else { format!("{own} {}", step.name.text) }
    }

    fn arrow(&self, step: usize) -> Piece {
        Piece::arrow(&self.name(step))
    }
}

/// `T3 Full`.
fn label(transition: &Transition) -> String {
    let own = format!("T{}", transition.number);
    if transition.name.text.is_empty() || transition.name.text.eq_ignore_ascii_case(&own) {
        return own;
    }
    format!("{own} {}", transition.name.text)
}
