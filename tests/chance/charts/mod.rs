//! Random GRAPH charts: the interpreter and machine code do the same in each call as a model written only from the reference.

mod chart;
mod generate;
mod golden;
mod memory;
mod model;
mod reduce;
mod run;
mod state;
mod text;

use plcc_tests::passes_of;
use plcc_tests::random::setting;
use plcc_tests::reduce::Best;
use run::{FORMS, Failure, Form};

/// How many random charts: `PLCC_RANDOM_CHARTS`, else as many as some seconds take. The first: `PLCC_RANDOM_CHARTS_FROM`.
#[test]
fn charts_do_what_the_model_does() {
    let first = setting("PLCC_RANDOM_CHARTS_FROM", 1);
    for seed in first..first + setting("PLCC_RANDOM_CHARTS", 40) {
        let result = plcc_driver::on_large_stack(move || {
            let case = generate::case(seed);
            run::check(&case, &FORMS).map_err(|failure| {
                let Best { case, failure } = reduce::reduce(case, failure);
                (text::graph(&case.chart), text::calls(&case.calls), failure)
            })
        });
        if let Err((graph, calls, failure)) = result.expect("no panic") {
            let text = match failure {
                Failure::Refused(text) => text,
                Failure::Different { call, text } => format!("call {call}: {text}"),
            };
            panic!("chart {seed}\n{graph}\n{calls}\n{text}");
        }
    }
}

/// The short way of the ordinary modes leaves the same in the instance as the long one, except for the bit that forbids it.
#[test]
fn both_ways_leave_the_same() {
    /// IL_PERM in its byte of MOP, and in that of the last MOP.
    const IL_PERM: u8 = 0x20;
    let first = setting("PLCC_RANDOM_CHARTS_FROM", 1);
    for seed in first..first + setting("PLCC_RANDOM_CHARTS", 40) {
        let result = plcc_driver::on_large_stack(move || {
            let case = generate::case(seed);
            let [short, long] = [false, true].map(|long| run::instances(&case, long).expect("it runs"));
            assert_eq!(short.len(), long.len());
            for (call, (short, long)) in short.iter().zip(&long).enumerate() {
                let different: Vec<(usize, u8)> =
                    short.iter().zip(long).map(|(a, b)| a ^ b).enumerate().filter(|(_, bits)| *bits != 0).collect();
                assert!(
                    different.len() <= 2 && different.iter().all(|(_, bits)| *bits == IL_PERM),
                    "chart {seed}, call {}: {different:?}\n{}",
                    call + 1,
                    text::graph(&case.chart)
                );
            }
            long != short
        });
        assert!(result.expect("no panic"), "chart {seed}: IL_PERM was not set");
    }
}

/// Statement lists that are made of charts do what the model does.
#[test]
fn charts_as_lists_do_what_the_model_does() {
    let first = setting("PLCC_RANDOM_CHARTS_FROM", 1);
    for seed in first..first + setting("PLCC_RANDOM_CHARTS", 40) / 2 {
        let result = plcc_driver::on_large_stack(move || {
            let case = generate::case(seed);
            run::check_as_list(&case).map_err(|failure| (text::graph(&case.chart), text::calls(&case.calls), failure))
        });
        if let Err((graph, calls, failure)) = result.expect("no panic") {
            panic!("chart {seed}\n{graph}\n{calls}\n{failure:?}");
        }
    }
}

/// The same without a pass, another one for each seed: no pass is needed for a right result.
#[test]
fn any_pass_may_be_off() {
    let first = setting("PLCC_RANDOM_CHARTS_FROM", 1);
    for seed in first..first + setting("PLCC_RANDOM_CHARTS", 40) {
        let forms: Vec<Form> = passes_of(seed as usize, 1).into_iter().flat_map(Form::without).collect();
        let result = plcc_driver::on_large_stack(move || run::check(&generate::case(seed), &forms));
        if let Err(failure) = result.expect("no panic") {
            panic!("chart {seed}: {failure:?}");
        }
    }
}
