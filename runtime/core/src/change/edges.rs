//! The edge memories of an S7-200, which have no names: they are found again by the statements that lead to them.
//!
//! Of each block the edges are compared. Those with the same statements of their network before them, in the same order, keep their memories.
//! Edges between two of these have other conditions; if there are as many as before, of the same kinds, each has the memory of the one in its
//! place. All others begin as in the first scan: the memory of a rising edge is 1, that of a falling edge 0, so none is seen that did not happen.

use plcc_abi::s7200::S7200Image;
use plcc_abi::s7200::image::EdgeMemory;

/// Memories that go on, and networks whose edges begin again.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Edges {
    /// Number of the memory before and after the change.
    pub moves: Vec<(u32, u32)>,
    /// `SBR2, network 3`.
    pub new: Vec<String>,
}

/// An edge with the number of its memory.
type Numbered<'a> = (&'a EdgeMemory, u32);

/// All edges; falling ones are numbered after all rising ones.
fn numbered(image: &S7200Image) -> Vec<Numbered<'_>> {
    let (mut rising, mut falling) = (0, image.rising_edges);
    let mut all = Vec::new();
    for edge in &image.edges {
        let next = if edge.is_falling { &mut falling } else { &mut rising };
        all.push((edge, *next));
        *next += 1;
    }
    all
}

/// Finds the edges of the old program in the new one.
pub(super) fn compare(old: &S7200Image, new: &S7200Image) -> Edges {
    let (old, new) = (numbered(old), numbered(new));
    let mut edges = Edges::default();
    let key = |(edge, _): &Numbered<'_>| (edge.kind, edge.block);
    for block in new.chunk_by(|one, next| key(one) == key(next)) {
        let before: Vec<Numbered<'_>> = old.iter().filter(|one| key(one) == key(&block[0])).copied().collect();
        edges.block(&before, block);
    }
    edges.new.dedup();
    edges
}

impl Edges {
    /// The edges of one block.
    fn block(&mut self, old: &[Numbered<'_>], new: &[Numbered<'_>]) {
        let (mut old_at, mut new_at) = (0, 0);
        for (a, b) in same(old, new).into_iter().chain([(old.len(), new.len())]) {
            self.between(&old[old_at..a], &new[new_at..b]);
            if let (Some((_, was)), Some((_, is))) = (old.get(a), new.get(b)) {
                self.moves.push((*was, *is));
            }
            (old_at, new_at) = (a + 1, b + 1);
        }
    }

    /// Edges that have another condition, come or go.
    fn between(&mut self, old: &[Numbered<'_>], new: &[Numbered<'_>]) {
        let kinds = |edges: &[Numbered<'_>]| edges.iter().map(|(edge, _)| edge.is_falling).collect::<Vec<_>>();
        if kinds(old) == kinds(new) {
            self.moves.extend(old.iter().zip(new).map(|((_, was), (_, is))| (*was, *is)));
            return;
        }
        for (EdgeMemory { kind, block, network, .. }, _) in new {
            self.new.push(format!("{}{block}, network {network}", kind.prefix()));
        }
    }
}

/// The longest common sequence of edges with the same statements, as pairs of indices.
fn same(old: &[Numbered<'_>], new: &[Numbered<'_>]) -> Vec<(usize, usize)> {
    let is_same = |a: usize, b: usize| {
        let ((was, _), (is, _)) = (old[a], new[b]);
        (was.statements, was.is_falling) == (is.statements, is.is_falling)
    };
    // The length of the longest sequence from here to the ends, by rows of `old`. A block has some hundred edges at most.
    let mut longest = vec![vec![0u32; new.len() + 1]; old.len() + 1];
    for a in (0..old.len()).rev() {
        for b in (0..new.len()).rev() {
            longest[a][b] = match is_same(a, b) {
                true => longest[a + 1][b + 1] + 1,
                false => longest[a + 1][b].max(longest[a][b + 1]),
            };
        }
    }
    let (mut a, mut b) = (0, 0);
    let mut pairs = Vec::new();
    while a < old.len() && b < new.len() {
        if is_same(a, b) {
            pairs.push((a, b));
            (a, b) = (a + 1, b + 1);
        } else if longest[a + 1][b] >= longest[a][b + 1] {
            a += 1;
        } else {
            b += 1;
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;
    use plcc_abi::image::BlockKind;

    /// Edges of the main program, each in a network of its own: statements, and whether it is a falling one.
    fn image(edges: &[(u64, bool)]) -> S7200Image {
        let edge = |(index, &(statements, is_falling)): (usize, &(u64, bool))| EdgeMemory {
            kind: BlockKind::Ob,
            block: 1,
            network: index as u16 + 1,
            statements,
            is_falling,
        };
        S7200Image {
            rising_edges: edges.iter().filter(|one| !one.1).count() as u32,
            falling_edges: edges.iter().filter(|one| one.1).count() as u32,
            edges: edges.iter().enumerate().map(edge).collect(),
            ..S7200Image::default()
        }
    }

    #[test]
    fn edges_are_found_again() {
        const RISING: bool = false;
        const FALLING: bool = true;
        let old = image(&[(1, RISING), (2, RISING), (3, FALLING), (4, RISING)]);
        let compared = |edges: &[(u64, bool)]| {
            let Edges { moves, new } = compare(&old, &image(edges));
            (moves, new)
        };
        let none = Vec::<String>::new;
        let new = |network: u32| vec![format!("OB1, network {network}")];
        assert_eq!(compare(&old, &old).moves, [(0, 0), (1, 1), (3, 3), (2, 2)]);
        // One in front.
        let more = [(9, RISING), (1, RISING), (2, RISING), (3, FALLING), (4, RISING)];
        assert_eq!(compared(&more), (vec![(0, 1), (1, 2), (3, 4), (2, 3)], new(1)));
        // The second one has another condition.
        let other = [(1, RISING), (7, RISING), (3, FALLING), (4, RISING)];
        assert_eq!(compared(&other), (vec![(0, 0), (1, 1), (3, 3), (2, 2)], none()));
        // It is a falling one instead.
        let kind = [(1, RISING), (7, FALLING), (3, FALLING), (4, RISING)];
        assert_eq!(compared(&kind), (vec![(0, 0), (3, 3), (2, 1)], new(2)));
        // One is gone.
        assert_eq!(compared(&[(2, RISING), (3, FALLING), (4, RISING)]), (vec![(1, 0), (3, 2), (2, 1)], none()));
        assert_eq!(compare(&image(&[]), &image(&[(1, RISING)])).new, ["OB1, network 1"]);
    }
}
