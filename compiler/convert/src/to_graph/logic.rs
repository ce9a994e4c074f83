//! Logic of statements as signals: `A`, `O`, and AND before OR.

use super::drawing::Signal;

/// A level of logic: `A`, `O`, and AND before OR.
#[derive(Clone, Default)]
pub struct Logic {
    /// Series that `O` without operand has closed.
    pub alternatives: Vec<Signal>,
    /// None: the next scan is the first one.
    pub current: Option<Signal>,
}

impl Logic {
    pub fn value(&self) -> Option<Signal> {
        match (&self.alternatives[..], &self.current) {
            ([], current) => current.clone(),
            (alternatives, current) => Some(Signal::or(alternatives.iter().chain(current).cloned().collect())),
        }
    }

    pub fn is_open(&self) -> bool {
        self.current.is_some() || !self.alternatives.is_empty()
    }

    pub fn join(&mut self, join: Join, signal: Signal) {
        if join != Join::And && !self.alternatives.is_empty() {
            // Whatever is not a series ends AND before OR.
            self.current = self.value();
            self.alternatives.clear();
        }
        let Some(before) = self.current.take() else {
            self.current = Some(signal);
            return;
        };
        self.current = Some(match join {
            Join::And => Signal::and(vec![before, signal]),
            Join::Or => Signal::or(vec![before, signal]),
            Join::Xor => match before {
                Signal::Xor(mut list) => {
                    list.push(signal);
                    Signal::Xor(list)
                }
                before => Signal::Xor(vec![before, signal]),
            },
        });
    }
}

/// How a scan joins what is before it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Join {
    And,
    Or,
    Xor,
}
