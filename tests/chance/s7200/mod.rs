//! Random programs of an S7-200: the interpreter and machine code leave in each scan the memory that a model leaves that was
//! written from the manual alone. Sources with random changes are refused or compiled, never more.

mod boxes;
mod generate;
mod memory;
mod model;
mod operands;
mod program;
mod reduce;
mod robust;
mod run;

use plcc_tests::passes_of;
use plcc_tests::random::setting;
use run::{Failure, Form};

/// How many random programs: `PLCC_RANDOM_S7200`, else as many as some seconds take. The first: `PLCC_RANDOM_S7200_FROM`.
#[test]
fn programs_do_what_the_model_does() {
    let first = setting("PLCC_RANDOM_S7200_FROM", 1);
    let mut failures = Vec::new();
    for seed in first..first + setting("PLCC_RANDOM_S7200", 60) {
        let result = plcc_driver::on_large_stack(move || {
            let case = generate::case(seed);
            run::check(&case, &run::FORMS).map_err(|failure| {
                let small = reduce::reduce(case, failure);
                (small.case, small.failure)
            })
        });
        if let Err((case, failure)) = result.expect("no panic") {
            let text = match failure {
                Failure::Refused(text) | Failure::Panicked(text) => text,
                Failure::Different { scan, text } => format!("scan {scan}: {text}"),
            };
            let scans: Vec<String> =
                case.scans.iter().map(|scan| format!("+{} ms {:02X?}", scan.after, scan.inputs)).collect();
            failures.push(format!("program {seed}\n{}\n{}\n{text}", case.program, scans.join("\n")));
        }
        if failures.len() as u64 >= setting("PLCC_RANDOM_S7200_FAILURES", 1) {
            break;
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n----\n"));
}

#[test]
fn changed_sources_are_read() {
    let first = setting("PLCC_RANDOM_S7200_FROM", 1);
    for seed in first..first + setting("PLCC_RANDOM_S7200", 60) * 2 {
        let source = robust::source(seed);
        let text = source.clone();
        let result = plcc_driver::on_large_stack(move || robust::compile(&text));
        assert!(result.is_ok(), "source {seed} makes the compiler panic\n{source}");
    }
}

/// The same without a pass, another one for each seed: no pass is needed for a right result.
#[test]
fn any_pass_may_be_off() {
    let first = setting("PLCC_RANDOM_S7200_FROM", 1);
    for seed in first..first + setting("PLCC_RANDOM_S7200", 60) {
        let forms: Vec<Form> = passes_of(seed as usize, 1).into_iter().flat_map(Form::without).collect();
        let result = plcc_driver::on_large_stack(move || run::check(&generate::case(seed), &forms));
        if let Err(failure) = result.expect("no panic") {
            panic!("program {seed}: {failure:?}");
        }
    }
}
