//! Random GRAPH charts: the interpreter and machine code do in each call what a model does that was written from the reference alone.

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
                let (case, failure) = reduce::reduce(&case, failure, forms[0]);
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

#[test]
fn stats() {
    let (mut fired, mut calls, mut la, mut va, mut multi, mut off, mut ev, mut entered) = (0, 0, 0, 0, 0, 0, [0; 8], 0);
    let mut modes = [0; 4];
    for seed in 1..2000 {
        let case = generate::case(seed);
        let mut model = model::Model::new(&case.chart);
        let mut memory = model::Memory::new();
        let mut now = 0;
        for call in &case.calls {
            now += call.after;
            memory.inputs[..4].copy_from_slice(&call.process);
            if !call.paused {
                model.call(&call.inputs, &mut memory, now);
                calls += 1;
                fired += model.transitions.iter().filter(|t| t.ts).count();
                la += model.outputs.error as u32;
                va += model.outputs.fault as u32;
                multi += (model.order.len() > 1) as u32;
                off += model.outputs.sq_isoff as u32;
                let o = &model.outputs;
                modes[0] += o.auto_on as u32;
                modes[1] += o.tap_on as u32;
                modes[2] += o.top_on as u32;
                modes[3] += o.man_on as u32;
                for s in &model.steps {
                    entered += s.s1 as u32;
                    for (i, e) in [s.s1, s.s0, s.l1, s.l0, s.v1, s.v0, s.a1, s.r1].into_iter().enumerate() {
                        ev[i] += e as u32;
                    }
                }
            }
        }
    }
    println!(
        "calls {calls} fired {fired} la {la} va {va} multi {multi} off {off} ev {ev:?} modes {modes:?} entered {entered}"
    );
    let case = generate::case(12);
    println!("{}{}", text::graph(&case.chart), text::caller(&case.chart));
}
