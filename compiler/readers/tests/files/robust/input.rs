//! Inputs of a notation: any text, pieces in any order, and sources with changes.

use std::process::abort;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use plcc_syntax::decode;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{Config, TestRunner};

/// How many inputs of each kind a test has, about.
const CASES: u32 = 300;
const KINDS: u32 = 5;

/// Longest time for one input: reading it does not end.
const LIMIT: Duration = Duration::from_secs(20);

/// What inputs of a notation are made of.
pub struct Notation {
    /// Sources with most forms of the notation.
    pub sources: &'static [&'static str],
    /// Pieces that changes put into sources.
    pub pieces: &'static [&'static str],
    /// Texts before and after pieces, so that more of them are understood.
    pub frames: &'static [(&'static str, &'static str)],
}

impl Notation {
    /// Runs `check` with many inputs; it panics if one is not read as it should be. A failure is shown with a small input.
    pub fn test(&self, check: impl Fn(&str)) {
        let (begins, begun) = channel::<String>();
        let watch = thread::spawn(move || watch(&begun));
        let config = Config { cases: CASES * KINDS, failure_persistence: None, ..Config::default() };
        let result = TestRunner::new(config).run(&self.inputs(), |text| {
            begins.send(text.clone()).expect("the watch runs until the sender is dropped");
            check(&text);
            Ok(())
        });
        drop(begins);
        watch.join().expect("the watch does not panic");
        if let Err(error) = result {
            panic!("{error}");
        }
    }

    fn inputs(&self) -> impl Strategy<Value = String> {
        let bytes = vec(any::<u8>(), 0..400).prop_map(|bytes| decode(&bytes));
        prop_oneof![bytes, "\\PC{0,200}", self.pieces(), self.changed(), self.part()]
    }

    /// Pieces in any order.
    fn pieces(&self) -> impl Strategy<Value = String> {
        let frames: Vec<_> = self.frames.iter().copied().chain([("", "")]).collect();
        (vec(select(self.pieces), 0..120), select(vec!["", " ", "\n"]), select(frames))
            .prop_map(|(pieces, between, (before, after))| format!("{before}{}{after}", pieces.join(between)))
    }

    /// A source with pieces in place of some bytes.
    fn changed(&self) -> impl Strategy<Value = String> {
        let edits = vec((any::<Index>(), 0..12usize, select(self.pieces)), 1..12);
        (select(self.sources), edits).prop_map(|(source, edits)| {
            let mut text = source.to_owned();
            for (place, removed, piece) in edits {
                let start = boundary(&text, place.index(text.len()));
                let end = boundary(&text, (start + removed).min(text.len()));
                text.replace_range(start..end, piece);
            }
            text
        })
    }

    /// The beginning or the end of a source.
    fn part(&self) -> impl Strategy<Value = String> {
        (select(self.sources), any::<Index>(), any::<bool>()).prop_map(|(source, place, first)| {
            let (before, after) = source.split_at(boundary(source, place.index(source.len())));
            if first { before } else { after }.to_owned()
        })
    }
}

/// Shows the input that is not read in time, and ends the process: what never ends cannot be stopped.
fn watch(begun: &Receiver<String>) {
    let mut current = String::new();
    loop {
        match begun.recv_timeout(LIMIT) {
            Ok(text) => current = text,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                eprintln!("reading does not end: {current:?}");
                abort();
            }
        }
    }
}

/// The last boundary of a character at or before byte `at`.
fn boundary(text: &str, at: usize) -> usize {
    (0..=at).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
}

/// Names, values and texts of elements of XML exchanged for words: the file usually stays well-formed.
pub fn exchanged(sources: &'static [&'static str], words: &'static [&'static str]) -> impl Strategy<Value = String> {
    let edits = vec((any::<Index>(), select(words)), 1..8);
    (select(sources), edits).prop_map(|(source, edits)| {
        let mut text = source.to_owned();
        for (place, word) in edits {
            // The inside of a pair of quotes or of an element.
            let starts: Vec<usize> = text.match_indices(['"', '>']).map(|(at, _)| at + 1).collect();
            let start = starts[place.index(starts.len())];
            let length = text[start..].find(['"', '<']).unwrap_or(0);
            if !text[start..start + length].contains('=') {
                text.replace_range(start..start + length, word);
            }
        }
        text
    })
}
