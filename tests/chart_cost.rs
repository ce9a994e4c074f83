//! The cost of a chart call depends on the active steps, not on the size of the chart. It is counted in interpreted instructions.
//! Source: GRAPH reference, chapter G, and J.13.

use plcc_driver::code;
use plcc_runtime::TestOptions;
use plcc_tests::charts::Rings;

/// Instances of the chart, each called once in a cycle.
const INSTANCES: usize = 2;

/// Cycles until each ring has come to its usual work, and cycles that are counted.
const WARM_UP: u64 = 10;
const CYCLES: u64 = 100;

/// Instructions of one call, on average.
fn cost(rings: &Rings) -> f64 {
    let compiled = rings.compile(INSTANCES, true);
    let executed = |cycles: u64| {
        let code = code::interpreter(&compiled);
        let options = TestOptions { cycles: Some(cycles), ..TestOptions::default() };
        let report = plcc_runtime::test(compiled.image.clone(), code.clone(), &options);
        assert_eq!(report.stopped, None);
        code.executed()
    };
    let counted = executed(WARM_UP + CYCLES) - executed(WARM_UP);
    counted as f64 / (CYCLES * INSTANCES as u64) as f64
}

/// All kinds of charts with this number of active steps.
fn variants(rings: usize) -> impl Iterator<Item = Rings> {
    ["Minimum", "Standard"].into_iter().flat_map(move |interface| {
        [(false, false), (false, true), (true, false), (true, true)].map(|(supervised, switching)| Rings {
            steps: 0,
            rings,
            interface,
            supervised,
            switching,
        })
    })
}

/// Sets of steps have a word for each 64 steps, so that charts with several active steps differ by a few instructions.
#[test]
fn cost_does_not_follow_the_size_of_the_chart() {
    for (active, sizes) in [(1, [50, 250]), (8, [160, 250])] {
        for kind in variants(active) {
            let [small, large] = sizes.map(|steps| cost(&Rings { steps, ..kind }));
            assert!(large <= 1.1 * small, "{kind:?}: {small} instructions with {} steps, {large} with 250", sizes[0]);
        }
    }
}

#[test]
fn cost_is_linear_in_active_steps() {
    for kind in variants(1) {
        let [one, two, eight] = [1, 2, 8].map(|rings| cost(&Rings { steps: 250, rings, ..kind }));
        assert!(eight - one <= 7.0 * 1.1 * (two - one), "{kind:?}: {one}, {two} and {eight} instructions");
    }
}

#[test]
fn an_idle_call_is_short() {
    let kind = Rings { steps: 250, rings: 1, interface: "Minimum", supervised: false, switching: false };
    let cost = cost(&kind);
    assert!(cost <= 97.0, "{cost} instructions");
}
