//! `plcc test`.

use crate::cli::{FormArg, TestArgs};
use crate::command::exit;
use crate::pipeline::Settings;
use crate::testing::{self, Form, Outcome, Plan, Variant};
use crate::{inputs, report};

/// Runs all tests and prints what failed, then `N passed, M failed`.
pub fn test(args: &TestArgs) -> u8 {
    let forms: &[Form] = match args.form {
        FormArg::Interp => &[Form::Interp],
        FormArg::Jit => &[Form::Jit],
        FormArg::Exe => &[Form::Exe],
        FormArg::All => &[Form::Interp, Form::Jit, Form::Exe],
    };
    let optimization = args.optimization.optimization();
    let plan = Plan {
        settings: Settings::new(&args.compile),
        variants: forms.iter().map(|&form| Variant { form, optimization }).collect(),
        linker: args.linker.clone(),
    };
    let tests = inputs::find_tests(&args.inputs);
    let outcomes = testing::run(&tests, &plan);
    for scenario in inputs::lone_scenarios(&args.inputs, &tests) {
        println!("no source next to the scenario: {}", scenario.display());
    }
    if outcomes.is_empty() {
        report::say("no source in the given folders");
        return exit::USAGE;
    }
    for outcome in &outcomes {
        eprint!("{}", outcome.messages);
        print!("{}", outcome.failures);
        for file in &outcome.untested {
            println!("no assertions: {file}");
        }
    }
    let sum = |count: fn(&Outcome) -> u64| outcomes.iter().map(count).sum::<u64>();
    let failed = sum(|outcome| outcome.failed);
    println!("{} passed, {failed} failed", sum(|outcome| outcome.passed));
    if outcomes.iter().any(|outcome| outcome.unreadable) {
        exit::USAGE
    } else if outcomes.iter().any(|outcome| outcome.rejected) {
        exit::COMPILE
    } else if failed > 0 {
        exit::FAILED
    } else {
        exit::OK
    }
}
