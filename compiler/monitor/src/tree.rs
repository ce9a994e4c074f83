//! The tree of the program: its blocks, and the values that it uses.

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
    let mut last: Vec<&str> = Vec::new();
    for (name, ty) in names {
        if !search.is_empty() && !name.to_lowercase().contains(&search) {
            continue;
        }
        let parts: Vec<&str> = name.split('.').collect();
        // An address such as DB1.DBW2 and I0.0 is one part.
        let is_address = name.chars().next().is_some_and(char::is_uppercase)
            && parts.get(1).is_some_and(|part| part.starts_with("DB") || part.parse::<u32>().is_ok());
        let parts = if is_address { vec![name.as_str()] } else { parts };
        let common = parts.iter().zip(&last).take_while(|(one, other)| one == other).count();
        let mut is_hidden = false;
        for depth in 0..parts.len() {
            let path = parts[..=depth].join(".");
            let is_leaf = depth + 1 == parts.len();
            let is_open = !search.is_empty() || open.contains(&path);
            if (depth >= common || is_leaf) && !is_hidden {
                tree.push(Node {
                    depth,
                    label: parts[depth].to_string(),
                    path: path.clone(),
                    ty: if is_leaf { ty.clone() } else { String::new() },
                    open: (!is_leaf).then_some(is_open),
                    block: None,
                });
            }
            is_hidden |= !is_leaf && !is_open;
        }
        last = parts;
    }
    tree
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
