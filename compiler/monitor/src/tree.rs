//! The tree of the program: its blocks, and the values that it uses.

use std::collections::HashMap;

use crate::document::Page;

/// A line of the tree: a name, or a part that several names have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    pub depth: usize,
    /// What is shown.
    pub label: String,
    /// The whole name.
    pub path: String,
    pub ty: String,
    /// It has others below it, which are shown or not.
    pub open: Option<bool>,
    /// It is the block with this number.
    pub block: Option<usize>,
}

/// The branch of the blocks; no name of a value begins so.
const BLOCKS: &str = "\0blocks";

/// The lines that are shown: blocks with code, then names; parts of names before the last dot are branches. `open`: paths of branches that
/// are open; those of a search all are.
pub fn tree(pages: &[Page], names: &[(String, String)], search: &str, open: &[String]) -> Vec<Node> {
    let search = search.to_lowercase();
    let mut tree = blocks(pages, &search, open);
    let found = names.iter().filter(|(name, _)| search.is_empty() || name.to_lowercase().contains(&search));
    let mut found: Vec<(&str, &str, Vec<usize>)> =
        found.map(|(name, ty)| (name.as_str(), ty.as_str(), ends(name))).collect();
    // Names that begin with the same part are below one branch, at the place of the first of them.
    let mut first = HashMap::new();
    for (number, (name, _, ends)) in found.iter().enumerate() {
        for &end in ends {
            first.entry(&name[..end]).or_insert(number);
        }
    }
    found.sort_by_cached_key(|(name, _, ends)| ends.iter().map(|end| first[&name[..*end]]).collect::<Vec<usize>>());
    let (mut last, mut last_ends) = ("", Vec::new());
    for (name, ty, ends) in found {
        let is_same = |(one, other): &(&usize, &usize)| name[..**one] == last[..**other];
        let common = ends.iter().zip(&last_ends).take_while(is_same).count();
        let (mut start, mut is_hidden) = (0, false);
        for (depth, &end) in ends.iter().enumerate() {
            let path = &name[..end];
            let is_leaf = depth + 1 == ends.len();
            let is_open = !search.is_empty() || open.iter().any(|own| own == path);
            if (depth >= common || is_leaf) && !is_hidden {
                tree.push(Node {
                    depth,
                    label: name[start..end].to_string(),
                    path: path.to_string(),
                    ty: if is_leaf { ty.to_string() } else { String::new() },
                    open: (!is_leaf).then_some(is_open),
                    block: None,
                });
            }
            is_hidden |= !is_leaf && !is_open;
            start = end + 1;
        }
        (last, last_ends) = (name, ends);
    }
    tree
}

/// Where the parts of a name end; points in quotes belong to a part. An address such as DB1.DBW2 and I0.0 is one.
fn ends(name: &str) -> Vec<usize> {
    let mut is_quoted = false;
    let mut ends: Vec<usize> = Vec::new();
    for (at, c) in name.char_indices() {
        match c {
            '"' => is_quoted = !is_quoted,
            '.' if !is_quoted => ends.push(at),
            _ => {}
        }
    }
    ends.push(name.len());
    let second = ends.get(1).map(|end| &name[ends[0] + 1..*end]);
    let is_address = name.chars().next().is_some_and(char::is_uppercase)
        && second.is_some_and(|part| part.starts_with("DB") || part.parse::<u32>().is_ok());
    if is_address { vec![name.len()] } else { ends }
}

/// The branch of the blocks, if there are some.
fn blocks(pages: &[Page], search: &str, open: &[String]) -> Vec<Node> {
    let is_found = |page: &Page| {
        let words = format!("{} {} {}", page.id, page.key(), page.name).to_lowercase();
        page.has_code() && words.contains(search)
    };
    let found = pages.iter().enumerate().filter(|(_, page)| is_found(page));
    let mut blocks: Vec<Node> = found
        .map(|(number, page)| Node {
            depth: 1,
            label: page.label(),
            path: page.id.clone(),
            ty: page.language.clone(),
            open: None,
            block: Some(number),
        })
        .collect();
    if blocks.is_empty() {
        return blocks;
    }
    let is_open = !search.is_empty() || open.iter().any(|path| path == BLOCKS);
    if !is_open {
        blocks.clear();
    }
    let branch = Node {
        depth: 0,
        label: "Blocks".to_string(),
        path: BLOCKS.to_string(),
        ty: String::new(),
        open: Some(is_open),
        block: None,
    };
    blocks.insert(0, branch);
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines of a tree of names with all branches open, indented.
    fn lines(names: &[&str], open: &[&str]) -> Vec<String> {
        let names: Vec<(String, String)> = names.iter().map(|name| (name.to_string(), String::new())).collect();
        let open: Vec<String> = open.iter().map(|path| path.to_string()).collect();
        tree(&[], &names, "", &open).iter().map(|node| format!("{}{}", "  ".repeat(node.depth), node.label)).collect()
    }

    #[test]
    fn values_of_a_data_block_are_below_one_branch() {
        let names = ["Line.go", "Tank.level", "I0.0", "Line.timer.ET", "Line.count", "Line.timer.Q"];
        let open = ["Line", "Line.timer"];
        let shown = ["Line", "  go", "  timer", "    ET", "    Q", "  count", "Tank", "I0.0"];
        assert_eq!(lines(&names, &open), shown);
        assert_eq!(lines(&names, &[]), ["Line", "Tank", "I0.0"]);
    }

    #[test]
    fn a_point_in_quotes_belongs_to_a_name() {
        let names = ["Line.\"a.b\"", "Line.\"c.d\".x", "DB1.DBW2"];
        assert_eq!(lines(&names, &["Line", "Line.\"c.d\""]), ["Line", "  \"a.b\"", "  \"c.d\"", "    x", "DB1.DBW2"]);
    }
}
