//! Random GRAPH charts: the interpreter and machine code do the same in each call as a model written only from the reference.

mod chart;
mod generate;
mod golden;
mod model;
mod reduce;
mod run;
mod text;

use run::{Failure, Form};

/// How many random charts: `PLCC_RANDOM_CHARTS`, else as many as some seconds take.
fn cases() -> u64 {
    std::env::var("PLCC_RANDOM_CHARTS").ok().and_then(|number| number.parse().ok()).unwrap_or(100)
}

/// The first of them: `PLCC_RANDOM_CHARTS_FROM`.
fn first() -> u64 {
    std::env::var("PLCC_RANDOM_CHARTS_FROM").ok().and_then(|number| number.parse().ok()).unwrap_or(1)
}

#[test]
fn charts_do_what_the_model_does() {
    let (first, forms) = (first(), [Form::Plain, Form::Machine]);
    for seed in first..first + cases() {
        let result = plcc_driver::on_large_stack(move || {
            let case = generate::case(seed);
            run::check(&case, &forms).map_err(|failure| {
                let (case, failure) = reduce::reduce(&case, failure, &forms);
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
