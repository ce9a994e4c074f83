//! What has run of each block, added up over tests.

use std::collections::BTreeMap;

use plcc_diag::SourceFile;
use plcc_view::book::Page;
use plcc_view::covered::Mark;
use serde::Serialize;

/// A range of bytes of a source: first byte, first byte after it.
pub type Range = (u32, u32);

/// The sources of a run, by their names.
#[derive(Clone, Debug, Default)]
pub struct Coverage {
    pub files: BTreeMap<String, File>,
}

/// A source.
#[derive(Clone, Debug)]
pub struct File {
    pub source: SourceFile,
    /// Blocks with code, in the order of the source.
    pub blocks: Vec<Block>,
}

/// A block with code.
#[derive(Clone, Debug)]
pub struct Block {
    /// `FC 1`.
    pub id: String,
    pub name: String,
    /// Where its name is.
    pub span: Range,
    pub calls: u64,
    /// Its networks by number; none in SCL and GRAPH.
    pub networks: BTreeMap<u16, Network>,
    /// How often each has run. Networks of LAD and FBD have none.
    pub statements: BTreeMap<Range, Statement>,
    /// How often each was 0 and 1: contacts, conditions, what acts under a condition.
    pub contacts: BTreeMap<Range, Contact>,
    pub steps: Vec<Named>,
    pub transitions: Vec<Named>,
    /// The block as it is drawn.
    pub page: Page,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Network {
    /// Where its first statement or element is.
    pub start: u32,
    pub runs: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statement {
    pub runs: u64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contact {
    /// How often it was 0, how often 1.
    pub seen: [u64; 2],
}

impl Contact {
    /// Whether it was 0 and was 1.
    pub fn is_covered(&self) -> bool {
        self.seen.iter().all(|count| *count > 0)
    }
}

/// A step or a transition.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Named {
    pub name: String,
    pub start: u32,
    /// Calls after which the step was active, or in which the transition switched.
    pub runs: u64,
}

/// How many there are, and how many tests have covered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Part {
    pub covered: u64,
    pub all: u64,
}

/// The sums of a block, a source or a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Sums {
    pub blocks: Part,
    pub statements: Part,
    pub networks: Part,
    pub contacts: Part,
    pub steps: Part,
    pub transitions: Part,
}

impl Part {
    fn of(covered: impl Iterator<Item = bool>) -> Part {
        covered
            .fold(Part::default(), |sum, covered| Part { covered: sum.covered + u64::from(covered), all: sum.all + 1 })
    }

    fn and(self, other: Part) -> Part {
        Part { covered: self.covered + other.covered, all: self.all + other.all }
    }
}

impl Sums {
    /// Names and numbers, in the order in which they are shown.
    pub fn parts(&self) -> [(&'static str, Part); 6] {
        [
            ("blocks", self.blocks),
            ("statements", self.statements),
            ("networks", self.networks),
            ("contacts", self.contacts),
            ("steps", self.steps),
            ("transitions", self.transitions),
        ]
    }

    pub fn and(self, other: Sums) -> Sums {
        Sums {
            blocks: self.blocks.and(other.blocks),
            statements: self.statements.and(other.statements),
            networks: self.networks.and(other.networks),
            contacts: self.contacts.and(other.contacts),
            steps: self.steps.and(other.steps),
            transitions: self.transitions.and(other.transitions),
        }
    }
}

impl Sums {
    /// As it is printed, for one block.
    pub fn inside(&self) -> String {
        Sums { blocks: Part::default(), ..*self }.to_string()
    }
}

/// `blocks 3 of 3, statements 12 of 14`, without the kinds that do not occur.
impl std::fmt::Display for Sums {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let parts = self.parts().into_iter().filter(|(_, part)| part.all > 0);
        let texts: Vec<String> = parts.map(|(name, part)| format!("{name} {} of {}", part.covered, part.all)).collect();
        f.write_str(&if texts.is_empty() { "nothing to count".to_string() } else { texts.join(", ") })
    }
}

impl Coverage {
    /// Adds what another test has run.
    pub fn add(&mut self, other: Coverage) {
        for (name, file) in other.files {
            match self.files.get_mut(&name) {
                Some(known) => known.add(file),
                None => {
                    self.files.insert(name, file);
                }
            }
        }
    }

    pub fn sums(&self) -> Sums {
        self.files.values().fold(Sums::default(), |sums, file| sums.and(file.sums()))
    }
}

impl File {
    fn add(&mut self, other: File) {
        for block in other.blocks {
            match self.blocks.iter_mut().find(|known| known.span == block.span) {
                Some(known) => known.add(block),
                None => self.blocks.push(block),
            }
        }
        self.blocks.sort_by_key(|block| block.span);
    }

    pub fn sums(&self) -> Sums {
        self.blocks.iter().fold(Sums::default(), |sums, block| sums.and(block.sums()))
    }
}

impl Block {
    fn add(&mut self, other: Block) {
        self.calls += other.calls;
        for (number, network) in other.networks {
            self.networks.entry(number).or_insert(Network { runs: 0, ..network }).runs += network.runs;
        }
        for (range, statement) in other.statements {
            self.statements.entry(range).or_default().runs += statement.runs;
        }
        for (range, contact) in other.contacts {
            let known = self.contacts.entry(range).or_default();
            known.seen = [known.seen[0] + contact.seen[0], known.seen[1] + contact.seen[1]];
        }
        for (known, more) in [(&mut self.steps, other.steps), (&mut self.transitions, other.transitions)] {
            for (known, more) in known.iter_mut().zip(more) {
                known.runs += more.runs;
            }
        }
    }

    pub fn sums(&self) -> Sums {
        Sums {
            blocks: Part { covered: u64::from(self.calls > 0), all: 1 },
            statements: Part::of(self.statements.values().map(|statement| statement.runs > 0)),
            networks: Part::of(self.networks.values().map(|network| network.runs > 0)),
            contacts: Part::of(self.contacts.values().map(Contact::is_covered)),
            steps: Part::of(self.steps.iter().map(|step| step.runs > 0)),
            transitions: Part::of(self.transitions.iter().map(|transition| transition.runs > 0)),
        }
    }

    /// What has been seen of what begins at a place of the source, for a drawing. A contact of a statement list tells more than that its
    /// statement has run.
    pub fn mark(&self, start: u32) -> Option<Mark> {
        let at = (start, 0)..(start, u32::MAX);
        let contact = self.contacts.range(at.clone()).next().map(|(_, contact)| contact.seen.map(|count| count > 0));
        let statement = || self.statements.range(at).next().map(|(_, statement)| statement.runs > 0);
        let named = || {
            let mut all = self.steps.iter().chain(&self.transitions);
            all.find(|one| one.start == start).map(|one| one.runs > 0)
        };
        contact.map(Mark::Bit).or_else(|| named().or_else(statement).map(Mark::Ran))
    }
}
