//! Events and interlocks that rows can have. Source: GRAPH reference D.7.

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::chart::ast::{Action, Event, Qualifier};

/// Whether a row must, may or must not have an event.
#[derive(PartialEq)]
enum Rule {
    Needed,
    Possible,
    Impossible,
}

const fn rule(qualifier: Qualifier) -> Rule {
    match qualifier {
        Qualifier::N | Qualifier::S | Qualifier::R => Rule::Possible,
        Qualifier::D | Qualifier::L | Qualifier::Tf => Rule::Impossible,
        Qualifier::On
        | Qualifier::Off
        | Qualifier::Cs
        | Qualifier::Cu
        | Qualifier::Cd
        | Qualifier::Cr
        | Qualifier::Tl
        | Qualifier::Td
        | Qualifier::Tr => Rule::Needed,
    }
}

/// The interlock can be used with the event.
const fn has_interlock(event: Event) -> bool {
    match event {
        Event::S1 | Event::V1 | Event::A1 | Event::R1 => true,
        Event::S0 | Event::L1 | Event::L0 | Event::V0 => false,
    }
}

/// Mistakes in the event and the interlock of a row. `programmed`: its step has an interlock.
pub fn messages(action: &Action, programmed: bool) -> Vec<Diagnostic> {
    let (qualifier, span) = (action.qualifier.name(), action.qualifier_span);
    let mut messages = Vec::new();
    match (rule(action.qualifier), action.event) {
        (Rule::Needed, None) => messages.push(
            Diagnostic::new(Code::ActionEvent, span, format!("`{qualifier}` needs an event"))
                .label("without one it runs in every call")
                .help(format!("write for example `S1 {qualifier}`: when the step is entered")),
        ),
        (Rule::Impossible, Some(event)) => messages.push(
            Diagnostic::new(Code::ActionEvent, span, format!("`{qualifier}` cannot have an event"))
                .label(format!("it works while the step is active; {} is one call", event.name()))
                .help(format!("write `{qualifier}` alone")),
        ),
        _ => {}
    }
    match action.event {
        Some(event) if action.interlock && !has_interlock(event) => messages.push(
            Diagnostic::new(
                Code::ActionInterlock,
                span,
                format!("the event {} cannot have an interlock", event.name()),
            )
            .label("the letter C is possible with S1, V1, A1 and R1, and without an event")
            .help("remove the C"),
        ),
        _ if action.interlock && !programmed => messages.push(
            Diagnostic::new(Code::NoInterlock, span, "this step has no interlock")
                .label("the letter C refers to it; it is always satisfied")
                .help("remove the C, or give the step an interlock"),
        ),
        _ => {}
    }
    messages
}

#[cfg(test)]
mod tests {
    use plcc_diag::Span;
    use plcc_syntax::chart::ast::ActionBody;

    use super::*;

    fn codes(event: Option<Event>, qualifier: Qualifier, interlock: bool, programmed: bool) -> Vec<&'static str> {
        let span = Span::default();
        let body = ActionBody::Error;
        let action = Action { event, qualifier, interlock, qualifier_span: span, body, comment: None, span };
        messages(&action, programmed).iter().map(|message| message.code.name()).collect()
    }

    #[test]
    fn events() {
        for qualifier in Qualifier::ALL {
            let (alone, at_event) = match qualifier.name() {
                "N" | "S" | "R" => (true, true),
                "D" | "L" | "TF" => (true, false),
                _ => (false, true),
            };
            let expected = |good: bool| if good { vec![] } else { vec!["P0571"] };
            assert_eq!(codes(None, qualifier, false, false), expected(alone), "{qualifier:?}");
            for event in Event::ALL {
                assert_eq!(codes(Some(event), qualifier, false, false), expected(at_event), "{event:?} {qualifier:?}");
            }
        }
    }

    #[test]
    fn interlocks() {
        for event in Event::ALL {
            let good = matches!(event.name(), "S1" | "V1" | "A1" | "R1");
            let expected: &[&str] = if good { &[] } else { &["P0573"] };
            assert_eq!(codes(Some(event), Qualifier::S, true, true), expected, "{event:?}");
        }
        assert!(codes(None, Qualifier::D, true, true).is_empty());
        assert_eq!(codes(None, Qualifier::N, true, false), ["P0576"]);
        assert_eq!(codes(None, Qualifier::Cu, true, false), ["P0571", "P0576"]);
    }
}
