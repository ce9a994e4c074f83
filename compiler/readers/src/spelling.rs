//! Misspelt elements and attributes of exports in XML.
//!
//! The readers look for the parts that they know, so a misspelt part does not exist for them, and everything below it would be left out.
//! Therefore a file with a part that resembles a known one is not read at all: the message for this part is the only one.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_literal::distance::{between, nearest};
use roxmltree::{Document, Node};

use crate::xml::{elements, head};

/// Names of attributes or elements.
#[derive(Clone, Copy)]
pub enum Names {
    /// Separated by blanks.
    Words(&'static str),
    List(&'static [&'static str]),
}

impl Names {
    fn iter(self) -> impl Iterator<Item = &'static str> {
        let (words, list): (&str, &[&str]) = match self {
            Names::Words(words) => (words, &[]),
            Names::List(list) => ("", list),
        };
        words.split_whitespace().chain(list.iter().copied())
    }

    fn contains(self, name: &str) -> bool {
        self.iter().any(|known| known == name)
    }
}

/// What an element may have. Parts that resemble none of these are left to the readers.
#[derive(Clone, Copy)]
pub struct Parts {
    pub attributes: Names,
    pub children: Names,
}

/// How a kind of file spells its elements.
pub struct Grammar {
    /// The kind of file, as in "an element of PLCopen XML".
    pub format: &'static str,
    /// The parts of an element; `None`: everything in it is left alone.
    pub parts: fn(Node) -> Option<Parts>,
    /// Elements and attributes that may be anywhere.
    pub everywhere: Names,
}

/// The misspelt parts of a file, each name once, in the order of the text.
pub fn faults(file: FileId, document: &Document, grammar: &Grammar) -> Vec<Diagnostic> {
    let mut found: Vec<Fault> = Vec::new();
    let mut open = vec![document.root_element()];
    while let Some(node) = open.pop() {
        let Some(parts) = (grammar.parts)(node) else { continue };
        let own = node.tag_name().name();
        for attribute in node.attributes().filter(|attribute| attribute.namespace().is_none()) {
            let Some(meant) = meant(attribute.name(), parts.attributes, grammar.everywhere) else { continue };
            let what = format!("`{}` is not an attribute of `{own}`", attribute.name());
            let at = attribute.range();
            Fault::add(&mut found, what, meant, at.start..at.start + attribute.name().len(), "its value");
        }
        for child in elements(node) {
            match meant(child.tag_name().name(), parts.children, grammar.everywhere) {
                Some(meant) => {
                    let what = format!("`{}` is not an element of {}", child.tag_name().name(), grammar.format);
                    Fault::add(&mut found, what, meant, head(child), "everything in it");
                }
                None => open.push(child),
            }
        }
    }
    found.sort_by_key(|fault| fault.at.start);
    found.into_iter().map(|fault| fault.message(file)).collect()
}

/// The known name that `name` is a slip of.
fn meant(name: &str, known: Names, everywhere: Names) -> Option<&'static str> {
    if known.contains(name) || everywhere.contains(name) {
        return None;
    }
    nearest(name, known.iter()).filter(|meant| {
        // Short names resemble each other: `Gate` is not a slip of `Name`.
        let slips = between(&name.to_lowercase(), &meant.to_lowercase());
        slips <= if name.chars().count() < SHORT { 1 } else { 2 }
    })
}

/// Names of fewer letters have one slip at most.
const SHORT: usize = 6;

/// Further names are not reported; the file is not read anyway.
const FAULTS_MAX: usize = 100;

struct Fault {
    what: String,
    meant: &'static str,
    at: Range<usize>,
    lost: &'static str,
    uses: usize,
}

impl Fault {
    fn add(found: &mut Vec<Fault>, what: String, meant: &'static str, at: Range<usize>, lost: &'static str) {
        let is_full = found.len() >= FAULTS_MAX;
        match found.iter_mut().find(|fault| fault.what == what) {
            Some(fault) => {
                fault.uses += 1;
                if at.start < fault.at.start {
                    fault.at = at;
                }
            }
            None if is_full => {}
            None => found.push(Fault { what, meant, at, lost, uses: 1 }),
        }
    }

    fn message(self, file: FileId) -> Diagnostic {
        let count = if self.uses > 1 { format!("; the first of {}", self.uses) } else { String::new() };
        Diagnostic::new(Code::ForeignContent, Span::new(file, self.at), self.what)
            .label(format!("{} would be left out{count}", self.lost))
            .help(format!("is `{}` meant? plcc does not read the file before this is corrected", self.meant))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAMMAR: Grammar = Grammar {
        format: "a test",
        parts: |node| match node.tag_name().name() {
            "list" => Some(Parts { attributes: Names::Words("name"), children: Names::List(&["entry", "total"]) }),
            "entry" => Some(Parts { attributes: Names::Words("value"), children: Names::Words("") }),
            _ => None,
        },
        everywhere: Names::Words("comment"),
    };

    fn told(text: &str) -> Vec<String> {
        let document = Document::parse(text).expect("well-formed");
        faults(FileId(0), &document, &GRAMMAR)
            .into_iter()
            .map(|message| format!("{}: {}", message.title, message.primary.text))
            .collect()
    }

    #[test]
    fn only_slips_are_told() {
        let none: [&str; 0] = [];
        assert_eq!(told("<list gate='a'/>"), none);
        assert_eq!(told("<list name='a'><entry value='1'/><comment/><other><entyr/></other></list>"), none);
        assert_eq!(
            told("<list nmae='a'><entyr/><entry vaule='1'><entyr/></entry><entyr/></list>"),
            [
                "`nmae` is not an attribute of `list`: its value would be left out",
                "`entyr` is not an element of a test: everything in it would be left out; the first of 2",
                "`vaule` is not an attribute of `entry`: its value would be left out"
            ]
        );
    }
}
