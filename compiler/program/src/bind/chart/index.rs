//! Steps and transitions of a chart by name and number.

use plcc_syntax::chart::ast::Body as Chart;
use rustc_hash::FxHashMap;

use plcc_binding::fold;

/// Steps and transitions by their positions in the lists of the chart. Of duplicates, the first counts.
#[derive(Debug, Default)]
pub struct Index {
    steps: FxHashMap<String, usize>,
    step_numbers: FxHashMap<u32, usize>,
    transitions: FxHashMap<String, usize>,
    transition_numbers: FxHashMap<u32, usize>,
}

impl Index {
    pub fn new(chart: &Chart) -> Index {
        let mut index = Index::default();
        for (at, step) in chart.steps.iter().enumerate() {
            index.steps.entry(fold(&step.name.text)).or_insert(at);
            index.step_numbers.entry(step.number).or_insert(at);
        }
        for (at, transition) in chart.transitions.iter().enumerate() {
            index.transitions.entry(fold(&transition.name.text)).or_insert(at);
            index.transition_numbers.entry(transition.number).or_insert(at);
        }
        index
    }

    /// The step with this name.
    pub fn step(&self, name: &str) -> Option<usize> {
        self.steps.get(&fold(name)).copied()
    }

    /// The step that code names, or gives by number, as `S002`.
    pub fn step_reference(&self, text: &str) -> Option<usize> {
        self.step(text).or_else(|| self.step_numbers.get(&number(text, 'S')?).copied())
    }

    /// The transition that code names, or gives by number, as `T002`.
    pub fn transition_reference(&self, text: &str) -> Option<usize> {
        let named = self.transitions.get(&fold(text)).copied();
        named.or_else(|| self.transition_numbers.get(&number(text, 'T')?).copied())
    }
}

/// The number after a letter: `S002`.
fn number(text: &str, letter: char) -> Option<u32> {
    let digits = text.strip_prefix([letter, letter.to_ascii_lowercase()])?;
    if digits.is_empty() || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
        return None;
    }
    digits.parse().ok()
}
