//! Synchronous errors, time errors, STOP.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::codes::sync;
use plcc_abi::image::{BlockKind, Family, Site};
use plcc_abi::layout::{self, state};

use super::helpers::{Block, cpu, cpu_with, run};
use crate::cpu::Cpu;
use crate::diagnostics::NO_SITE;

fn site() -> Site {
    Site { file: 0, line: 17, block: BlockKind::Fc, block_number: 3, network: 2 }
}

#[test]
fn missing_ob_121_stops_with_place_and_cause() {
    let ob1: Block = Box::new(|cpu, _| assert_eq!(cpu.sync_error(0, sync::DB_MISSING, 0, 12), 1));
    let cpu = cpu_with(vec![(1, ob1)], |image| {
        image.sites.push(site());
        image.files.push("main.stl".to_string());
    });
    run(&cpu, 1);
    assert_eq!(
        cpu.stop_text(&cpu.stopped().unwrap()),
        "16#4562 STOP: programming error and no OB 121 (16#253A DB 12 is not loaded); FC 3, network 2, main.stl:17"
    );
}

#[test]
fn places_name_blocks_as_their_author_does() {
    let place = |block, block_number, network, name: &str| {
        let cpu = cpu_with(Vec::new(), |image| {
            image.sites.push(Site { file: 0, line: 17, block, block_number, network });
            image.files.push("main.scl".to_string());
            image.inner_blocks.push((block, block_number, name.to_string()));
        });
        cpu.log(0x2522, 0, 0);
        crate::diagnostics::place_text(&cpu.image, &cpu.diagnostics.newest_first()[0])
    };
    assert_eq!(place(BlockKind::Fb, 1, 0, "Barrier"), "Barrier (FB 1), main.scl:17");
    assert_eq!(place(BlockKind::Fc, 3, 2, "Fill"), "Fill (FC 3), network 2, main.scl:17");
    assert_eq!(place(BlockKind::Fc, 3, 2, ""), "FC 3, network 2, main.scl:17");
    assert_eq!(place(BlockKind::Sfb, 1720, 0, "Program_Alarm"), "Program_Alarm, first used in main.scl:17");
}

#[test]
fn ob_121_gets_its_start_information_inside_the_class() {
    let seen: Rc<RefCell<Vec<[u8; 12]>>> = Rc::default();
    let keep = seen.clone();
    let ob121: Block = Box::new(move |cpu, lbase| {
        assert_ne!(lbase, layout::l_stack(1));
        assert_eq!(cpu.memory.host32(state::DEPTH_MAX), 4);
        keep.borrow_mut().push(cpu.memory.bytes(lbase));
        let block = layout::SCRATCH;
        cpu.memory.set_dword(block, 0xAABB_CCDD);
        assert_eq!(cpu.system_function(0, 44, block, lbase), 1);
    });
    let ob1: Block = Box::new(|cpu, lbase| {
        assert_eq!(cpu.sync_error(0, sync::LENGTH_READ, 0x24, 0x1234), 0);
        assert_eq!(cpu.memory.host32(state::SUBSTITUTE), 0xAABB_CCDD);
        assert_eq!(cpu.system_function(0, 44, layout::SCRATCH, lbase), 0, "8080 outside of OB 121");
        assert_eq!(cpu.memory.word(layout::SCRATCH + 4), 0x8080);
    });
    let cpu = cpu_with(vec![(1, ob1), (121, ob121)], |image| {
        image.sites.push(site());
        image.profile.family = Family::S7400;
    });
    run(&cpu, 1);
    assert_eq!(*seen.borrow(), [[0x25, 0x22, 1, 121, 0x8C, 0x24, 0x12, 0x34, 0, 3, 0, 0]]);
    assert!(!cpu.is_stopped());
}

#[test]
fn io_errors_run_ob_122() {
    let runs = Rc::new(RefCell::new(0));
    let count = runs.clone();
    let ob122: Block = Box::new(move |_, _| *count.borrow_mut() += 1);
    let ob1: Block = Box::new(|cpu, _| {
        cpu.sync_error(0, sync::IO_READ, 0, 256);
        assert_eq!(cpu.memory.host32(state::SUBSTITUTE), 0);
    });
    run(&cpu(vec![(1, ob1), (122, ob122)]), 2);
    assert_eq!(*runs.borrow(), 2);
}

/// Source: CPU manuals, S7-1500, default reactions to events.
#[test]
fn an_s7_1500_goes_on_without_ob_122() {
    let ob1: Block = Box::new(|cpu, _| {
        assert_eq!(cpu.sync_error(0, sync::IO_READ, 0, 256), 0);
        assert_eq!(cpu.sync_error(0, sync::IO_WRITE, 0, 256), 0);
    });
    let cpu = cpu_with(vec![(1, ob1)], |image| image.profile.family = Family::S71500);
    run(&cpu, 1);
    assert!(!cpu.is_stopped());
    let ob1: Block = Box::new(|cpu, _| assert_eq!(cpu.sync_error(0, sync::DB_MISSING, 0, 12), 1));
    let cpu = cpu_with(vec![(1, ob1)], |image| image.profile.family = Family::S71500);
    run(&cpu, 1);
    assert_eq!(cpu.stopped().unwrap().entry.event, 0x4562, "but not without OB 121");
}

#[test]
fn errors_in_error_obs_are_bounded() {
    let error: fn(&Cpu, u32) = |cpu, _| {
        cpu.sync_error(0, sync::BCD, 0, 0);
    };
    let cpu = cpu(vec![(1, Box::new(error)), (121, Box::new(error))]);
    run(&cpu, 1);
    assert_eq!(cpu.stopped().unwrap().entry.event, 0x4573);
}

#[test]
fn too_much_local_data() {
    let cpu = cpu_with(vec![(1, Box::new(|_: &Cpu, _| ()))], |image| image.blocks[0].frame = 40_000);
    run(&cpu, 1);
    assert_eq!(cpu.stopped().unwrap().entry.event, 0x4576);
}

#[test]
fn calls_by_number() {
    let ob1: Block = Box::new(|cpu, lbase| {
        let end = cpu.memory.host32(state::L_END);
        assert_eq!(cpu.call_block(0, BlockKind::Fc as u32, 7, end - 24, lbase), 0);
        assert_eq!(cpu.memory.byte(layout::M), 1);
        assert_eq!(cpu.call_block(0, BlockKind::Fc as u32, 7, end - 16, lbase), 1);
    });
    let fc: Block = Box::new(|cpu, _| cpu.memory.set_byte(layout::M, 1));
    let cpu = cpu_with(vec![(1, ob1), (7, fc)], |image| {
        image.blocks[1].kind = BlockKind::Fc;
    });
    run(&cpu, 1);
    assert_eq!(cpu.stopped().unwrap().entry.event, 0x4576);
}

#[test]
fn calls_of_missing_blocks() {
    for (kind, number, event) in
        [(1, 7, 0x253C), (2, 7, 0x253E), (3, 7, 0x253D), (4, 7, 0x253F), (1, 70_000, 0x2534), (9, 1, 0x253C)]
    {
        let ob1: Block = Box::new(move |cpu, lbase| {
            cpu.call_block(0, kind, number, lbase, lbase);
        });
        let cpu = cpu(vec![(1, ob1)]);
        run(&cpu, 1);
        assert_eq!(cpu.stopped().unwrap().cause.unwrap().event, event);
    }
}

/// Waits this many milliseconds with SFC 47.
fn wait(ms: u32) -> Block {
    Box::new(move |cpu, lbase| {
        for _ in 0..ms {
            cpu.memory.set_word(layout::SCRATCH, 1000);
            if cpu.system_function(0, 47, layout::SCRATCH, lbase) & 2 != 0 {
                return;
            }
        }
    })
}

#[test]
fn cycle_time_without_ob_80() {
    let cpu = cpu(vec![(1, wait(200))]);
    run(&cpu, 1);
    assert_eq!(cpu.clock.now(), 150_000_000);
    assert_eq!(cpu.stopped().unwrap().entry.event, 0x4568);
}

#[test]
fn cycle_time_with_ob_80_once_and_twice() {
    for (ms, stops) in [(149, false), (299, false), (300, true)] {
        let runs = Rc::new(RefCell::new(Vec::new()));
        let keep = runs.clone();
        let ob80: Block = Box::new(move |cpu, lbase| keep.borrow_mut().push(cpu.memory.bytes::<8>(lbase)));
        let cpu = cpu(vec![(1, wait(ms)), (80, ob80)]);
        run(&cpu, 1);
        assert_eq!(cpu.is_stopped(), stops, "{ms}");
        let expected: &[[u8; 8]] = if ms < 150 { &[] } else { &[[0x35, 1, 26, 80, 0, 0, 0, 150]] };
        assert_eq!(*runs.borrow(), expected, "{ms}");
    }
}

#[test]
fn sleep_is_not_monitored_and_sfc_43_restarts() {
    let ob1: Block = Box::new(|cpu, lbase| {
        cpu.pass_time(1_000_000_000, false);
        wait(149)(cpu, lbase);
        cpu.system_function(0, 43, layout::SCRATCH, lbase);
        wait(149)(cpu, lbase);
    });
    let cpu = cpu(vec![(1, ob1)]);
    run(&cpu, 2);
    assert!(!cpu.is_stopped());
}

#[test]
fn endless_loop_under_the_virtual_clock() {
    let runs = Rc::new(RefCell::new(0));
    let count = runs.clone();
    let endless: Block = Box::new(|cpu, _| {
        while cpu.memory.attention().load(std::sync::atomic::Ordering::Relaxed) == 0 || cpu.safepoint(NO_SITE) == 0 {}
    });
    let cpu = cpu(vec![(1, endless), (80, Box::new(move |_: &Cpu, _| *count.borrow_mut() += 1))]);
    run(&cpu, 1);
    assert_eq!(*runs.borrow(), 1);
    assert!(cpu.stop_text(&cpu.stopped().unwrap()).contains("endless loop"));
}
