//! What comes back after the end of a process, for each kind of restart.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use plcc_abi::image::{AssertType, DbEntry, Family, Kept, ProgramImage, RetainInterval};
use plcc_abi::layout;
use plcc_abi::names::{External, NamedMember, NamedStruct, NamedType};

use super::helpers::{Block, cpu_with, run};
use crate::counters;
use crate::cpu::Cpu;
use crate::events::StartInfo;
use crate::options::{Restart, RunOptions};
use crate::restart::retained;
use crate::retain::Items;
use crate::timers;
use plcc_abi::functions::TimerMode;

const M: u32 = layout::M;
const DB: u32 = layout::DB_DATA;

/// A file in a folder of this test.
fn file(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("plcc-retain-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder.join("retain")
}

/// DB 1 of two words, `first` and `second`, that begin with 7.
fn db(number: u16, kept: Kept) -> DbEntry {
    DbEntry {
        number,
        name: String::new(),
        address: DB + 16 * u32::from(number),
        data: vec![0, 7, 0, 7],
        read_only: false,
        unlinked: false,
        optimized: false,
        kept,
        ty: Some(1),
    }
}

fn types(second: &str) -> Vec<NamedType> {
    let external = External::default();
    let member = |name: &str, byte| NamedMember { name: name.to_string(), ty: 0, byte, bit: 0, external };
    let members = vec![member("first", 0), member("second", 2)];
    let members =
        members.into_iter().map(|m| if m.name == "second" { NamedMember { name: second.to_string(), ..m } } else { m });
    let all = NamedStruct { name: String::new(), data_type: String::new(), members: members.collect(), is_dtl: false };
    vec![NamedType::Value(AssertType::Signed(16)), NamedType::Struct(all)]
}

/// A CPU with DB 1 and a DB 2 that is not retentive, and blocks for OB 1, 100, 101, 102.
fn with(path: &Path, obs: Vec<(u16, Block)>, change: impl FnOnce(&mut ProgramImage)) -> Rc<Cpu> {
    cpu_with(obs, |image| {
        image.config.retain.file = Some(path.display().to_string());
        image.dbs = vec![db(1, Kept::Everything), db(2, Kept::Nothing)];
        image.types = types("second");
        image.db_end = DB + 64;
        change(image);
    })
}

fn nothing() -> Vec<(u16, Block)> {
    [1, 100, 101, 102].map(|ob| (ob, Box::new(|_: &Cpu, _: u32| {}) as Block)).into()
}

/// Words that a program has left and another one finds: MW 2, MW 20, C 1, C 9, DB1.DBW0, DB2.DBW0.
fn words(cpu: &Cpu) -> [u16; 6] {
    let memory = &cpu.memory;
    [
        memory.word(M + 2),
        memory.word(M + 20),
        counters::value(memory, 1) as u16,
        counters::value(memory, 9) as u16,
        memory.word(DB + 16),
        memory.word(DB + 32),
    ]
}

const FILLED: [u16; 6] = [2, 20, 5, 6, 100, 200];
const START: [u16; 6] = [0, 0, 0, 0, 7, 7];

fn set_counter(cpu: &Cpu, number: u32, count: u16) {
    let cell = layout::C + number * layout::COUNTER_CELL_BYTES;
    cpu.memory.set_bytes(cell + layout::counter_cell::COUNT, count.to_ne_bytes());
}

fn fill(cpu: &Cpu) {
    cpu.memory.set_word(M + 2, 2);
    cpu.memory.set_word(M + 20, 20);
    set_counter(cpu, 1, 5);
    set_counter(cpu, 9, 6);
    cpu.memory.set_word(DB + 16, 100);
    cpu.memory.set_word(DB + 32, 200);
}

fn leave(path: &Path, change: impl FnOnce(&mut ProgramImage)) {
    let mut obs = nothing();
    obs[0].1 = Box::new(|cpu, _| fill(cpu));
    let cpu = with(path, obs, change);
    run(&cpu, 1);
    assert_eq!(words(&cpu), FILLED);
}

fn found(path: &Path, change: impl FnOnce(&mut ProgramImage)) -> [u16; 6] {
    let cpu = with(path, nothing(), change);
    run(&cpu, 1);
    words(&cpu)
}

#[test]
fn a_warm_restart_keeps_what_is_retentive() {
    let path = file("warm");
    assert_eq!(found(&path, |_| {}), START);
    leave(&path, |_| {});
    let kept = [2, 0, 5, 0, 100, 7];
    assert_eq!(found(&path, |_| {}), kept);
    assert_eq!(found(&path, |_| {}), kept);
}

#[test]
fn startup_obs_are_told_what_came_back() {
    let path = file("told");
    let told = |family| {
        let cpu = with(&path, nothing(), |image| image.profile.family = family);
        run(&cpu, 1);
        let info = StartInfo::new(0x13, 0x82, 100);
        let portal = cpu.startup_info_of_portal(info).0[4];
        (portal, u32::from_be_bytes(*cpu.startup_info_of_step7(info, true).0.last_chunk().unwrap()))
    };
    // Automatic warm restarts; only these are allowed, or hot ones, too.
    assert_eq!(told(Family::S71500), (0, 0x0820_7720), "nothing was there");
    assert_eq!(told(Family::S7400), (retained::LOST, 0x0820_FF20), "memory of another family");
    assert!(path.with_file_name("retain.old").exists());
    assert_eq!(told(Family::S7400), (retained::REMANENCE, 0x0810_FF10));
    assert_eq!(told(Family::S7300), (retained::REMANENCE, 0x0810_7710), "a program is moved with its data");
    let mut bytes = std::fs::read(&path).unwrap();
    bytes.iter_mut().skip(64).for_each(|byte| *byte ^= 0x55);
    std::fs::write(&path, bytes).unwrap();
    assert_eq!(told(Family::S71500), (retained::LOST, 0x0820_7720));
}

#[test]
fn plc_toml_says_what_is_retentive() {
    let path = file("configured");
    let change = |image: &mut ProgramImage| {
        image.config.retain.bit_memory = Some(21);
        image.config.retain.counters = Some(0);
    };
    leave(&path, change);
    // MB 20 is retentive, MB 21 is not.
    assert_eq!(found(&path, change), [2, 0, 0, 0, 100, 7]);
}

#[test]
fn cold_restart_and_memory_reset_begin_with_start_values() {
    let path = file("cold");
    leave(&path, |_| {});
    assert_eq!(found(&path, |image| image.config.startup = 102), START);
    assert_eq!(found(&path, |_| {}), START, "the cold restart has written its own values");
    leave(&path, |_| {});
    assert_eq!(found(&path, |image| image.config.retain.reset = true), START);
}

#[test]
fn a_hot_restart_keeps_everything() {
    let path = file("hot");
    let hot = |image: &mut ProgramImage| {
        image.profile.family = Family::S7400;
        image.config.startup = 101;
    };
    let started = |path: &Path, change: &dyn Fn(&mut ProgramImage)| {
        let mut obs = nothing();
        for (index, mark) in [(1, 100u16), (2, 101), (3, 102)] {
            obs[index].1 = Box::new(move |cpu, _| cpu.memory.set_word(M + 30, mark));
        }
        let cpu = with(path, obs, change);
        run(&cpu, 1);
        (cpu.memory.word(M + 30), words(&cpu))
    };
    // Nothing was interrupted: a warm restart.
    assert_eq!(started(&path, &hot), (100, START));
    leave(&path, hot);
    assert_eq!(started(&path, &hot), (101, FILLED));
    // `--restart` says how one run begins; the next one is hot again.
    for (restart, mark) in [(Restart::Cold, 102), (Restart::Warm, 100)] {
        let other = |image: &mut ProgramImage| {
            hot(image);
            RunOptions { restart: Some(restart), ..RunOptions::default() }.configure(&mut image.config);
        };
        assert_eq!(started(&path, &other).0, mark);
        leave(&path, other);
        assert_eq!(started(&path, &hot), (101, FILLED));
    }
    // The program has changed.
    leave(&path, hot);
    assert_eq!(
        started(&path, &|image| {
            hot(image);
            image.types = types("other");
        })
        .0,
        100
    );
    // Only its code has.
    leave(&path, hot);
    assert_eq!(
        started(&path, &|image| {
            hot(image);
            image.sources_sum = 1;
        })
        .0,
        100
    );
}

#[test]
fn a_changed_data_block_begins_with_its_start_values() {
    let path = file("changed");
    leave(&path, |_| {});
    let cpu = with(&path, nothing(), |image| image.types = types("other"));
    run(&cpu, 1);
    assert_eq!(words(&cpu), [2, 0, 5, 0, 7, 7]);
    let events: Vec<u16> = cpu.diagnostics.newest_first().iter().map(|entry| entry.event).collect();
    assert!(events.contains(&crate::diagnostics::RETAIN_CHANGED));
}

#[test]
fn data_blocks_with_names_are_found_by_them() {
    let path = file("named");
    let named = |image: &mut ProgramImage, names: [&str; 2]| {
        image.profile.family = Family::S71500;
        image.dbs[1].kept = Kept::Everything;
        for (db, name) in image.dbs.iter_mut().zip(names) {
            db.name = name.to_string();
        }
    };
    leave(&path, |image| named(image, ["First", "Second"]));
    // A new block comes before them: DB 1 is another block with the same layout, and the block that was DB 1 is DB 2 now.
    let cpu = with(&path, nothing(), |image| named(image, ["New", "first"]));
    run(&cpu, 1);
    assert_eq!(words(&cpu)[4..], [7, 100]);
}

#[test]
fn values_of_data_blocks_that_are_gone_are_not_lost_in_silence() {
    let path = file("gone");
    let two = |image: &mut ProgramImage| image.dbs[1].kept = Kept::Everything;
    let before = with(&path, nothing(), two);
    let mut content = Vec::new();
    Items::of(&before, false).collect(&before, &mut content);
    drop(before);
    leave(&path, two);
    let old = path.with_file_name("retain.old");
    for (change, gone, is_kept) in [
        // It is no longer retentive, as somebody wanted.
        ((|_| {}) as fn(&mut ProgramImage), &[][..], false),
        (|image| drop(image.dbs.pop()), &["DB 2"], true),
    ] {
        let cpu = with(&path, nothing(), change);
        assert_eq!(Items::of(&cpu, false).load(&cpu, &content).unwrap().gone, gone);
        assert_eq!(found(&path, change)[4], 100);
        assert_eq!(old.exists(), is_kept);
        leave(&path, two);
    }
}

/// The number of a data block is that of the compiler.
#[test]
fn references_into_other_data_blocks_get_their_initial_values() {
    let program = |image: &mut ProgramImage, target: &str| {
        let structure = |name: &str, members| NamedStruct {
            name: name.to_string(),
            data_type: String::new(),
            members,
            is_dtl: false,
        };
        let external = External::default();
        let reference = NamedMember { name: "p".to_string(), ty: 2, byte: 0, bit: 0, external };
        image.types.push(NamedType::Struct(structure("REF_TO INT", Vec::new())));
        image.types.push(NamedType::Struct(structure("", vec![reference])));
        image.profile.family = Family::S71500;
        let own = db(1, Kept::Everything);
        image.dbs[0] = DbEntry { name: "Own".to_string(), data: vec![0; 8], ty: Some(3), ..own };
        image.dbs[1].name = target.to_string();
    };
    let path = file("references");
    let mut obs = nothing();
    obs[0].1 = Box::new(|cpu, _| cpu.memory.set_word(DB + 16, 2));
    run(&with(&path, obs, |image| program(image, "Target")), 1);
    let left = |target: &str| {
        let cpu = with(&path, nothing(), |image| program(image, target));
        run(&cpu, 1);
        cpu.memory.word(DB + 16)
    };
    assert_eq!(left("Target"), 2);
    assert_eq!(left("Other"), 0, "DB 2 is another block now");
}

#[test]
fn the_end_of_the_process_before_is_waited_for() {
    let path = file("busy");
    leave(&path, |_| {});
    let other = std::fs::File::open(&path).unwrap();
    other.lock().unwrap();
    let before = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(200));
        drop(other);
    });
    assert_eq!(found(&path, |_| {}), [2, 0, 5, 0, 100, 7]);
    before.join().unwrap();
}

#[test]
fn another_program_finds_nothing() {
    let path = file("program");
    leave(&path, |_| {});
    assert_eq!(found(&path, |image| image.name = "other".to_string()), START);
    // What the first program has left is not lost.
    std::fs::rename(path.with_file_name("retain.old"), &path).unwrap();
    assert_eq!(found(&path, |_| {}), [2, 0, 5, 0, 100, 7]);
}

#[test]
fn single_bits_are_retentive() {
    let path = file("bits");
    // Bits 3 to 20 of DB 1.
    let change = |image: &mut ProgramImage| image.dbs[0].kept = Kept::Bits(vec![(3, 18)]);
    let mut obs = nothing();
    obs[0].1 = Box::new(|cpu, _| cpu.memory.set_dword(DB + 16, u32::MAX));
    run(&with(&path, obs, change), 1);
    let cpu = with(&path, nothing(), change);
    run(&cpu, 1);
    assert_eq!(cpu.memory.bytes::<4>(DB + 16), [0xF8, 0xFF, 0x1F, 7]);
}

#[test]
fn timers_go_on() {
    let path = file("timers");
    let change = |image: &mut ProgramImage| image.config.retain.timers = Some(4);
    // 2 seconds in units of 10 ms, begun in the first of 50 cycles.
    let mut obs = nothing();
    obs[0].1 = Box::new(|cpu, _| timers::start(&cpu.memory, &cpu.clock, 3, TimerMode::OnDelay, 0x0200, true));
    let cpu = with(&path, obs, change);
    run(&cpu, 50);
    let (left, counted) = (timers::remaining(&cpu.memory, &cpu.clock, 3), cpu.clock.ticks());
    drop(cpu);
    let cpu = with(&path, nothing(), change);
    run(&cpu, 1);
    assert_eq!((left, timers::remaining(&cpu.memory, &cpu.clock, 3)), (0x0150, 0x0149));
    assert_eq!(cpu.clock.ticks(), counted + 10, "the time of IEC timers goes on");
}

#[test]
fn each_cycle_can_count() {
    let path = file("cycle");
    let mut obs = nothing();
    obs[0].1 = Box::new(|cpu, _| cpu.memory.set_word(M, cpu.memory.word(M) + 1));
    let change = |image: &mut ProgramImage| image.config.retain.interval = RetainInterval::Cycle;
    let cpu = with(&path, obs, change);
    run(&cpu, 40);
    // The process is killed: nothing is done at its end.
    let copy = path.with_file_name("copy");
    std::fs::copy(&path, &copy).unwrap();
    let cpu = with(&copy, nothing(), change);
    run(&cpu, 1);
    assert_eq!(cpu.memory.word(M), 40);
}

#[test]
fn a_file_that_cannot_be_written_does_not_stop_the_cpu() {
    let folder = file("denied");
    std::fs::create_dir(&folder).unwrap();
    for (path, is_lost) in [(folder.join("no/such/folder"), true), (PathBuf::from("/proc/retain"), false)] {
        let cpu = with(&path, nothing(), |_| {});
        run(&cpu, 3);
        assert!(!cpu.is_stopped());
        assert!(has_logged(&cpu, crate::diagnostics::RETAIN_NOT_WRITTEN), "{}", path.display());
        // A folder without the file has nothing that could be lost.
        assert_eq!(has_logged(&cpu, crate::diagnostics::RETAIN_LOST), is_lost, "{}", path.display());
    }
}

/// Whether an event is in the diagnostic buffer.
fn has_logged(cpu: &Cpu, event: u16) -> bool {
    cpu.diagnostics.newest_first().iter().any(|entry| entry.event == event)
}

#[test]
fn a_folder_that_comes_later_gets_the_file() {
    for interval in [RetainInterval::Cycle, RetainInterval::Milliseconds(100)] {
        let path = file("later").join("folder").join("retain");
        let before = file("earlier");
        leave(&before, |image| image.config.retain.bit_memory = Some(2));
        let kept = std::fs::read(&before).unwrap();
        let mut obs = nothing();
        let later = path.clone();
        obs[0].1 = Box::new(move |cpu, _| {
            fill(cpu);
            std::fs::create_dir_all(later.parent().unwrap()).unwrap();
            // What another run has left there must not be lost.
            std::fs::write(&later, &kept).unwrap();
        });
        let cpu = with(&path, obs, |image| image.config.retain.interval = interval);
        run(&cpu, 1);
        let logged = [crate::diagnostics::RETAIN_LOST, crate::diagnostics::RETAIN_WRITTEN];
        assert!(logged.iter().all(|event| has_logged(&cpu, *event)), "{interval:?}");
        drop(cpu);
        assert_eq!(found(&path, |_| {}), [2, 0, 5, 0, 100, 7], "{interval:?}");
        assert_eq!(std::fs::read(path.with_file_name("retain.old")).unwrap(), std::fs::read(&before).unwrap());
    }
}

#[test]
fn a_file_that_can_only_be_read_comes_back() {
    use std::os::unix::fs::PermissionsExt;
    let path = file("read-only");
    leave(&path, |_| {});
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o444)).unwrap();
    // The administrator may write it all the same.
    let is_denied = std::fs::File::options().write(true).open(&path).is_err();
    let cpu = with(&path, nothing(), |_| {});
    run(&cpu, 1);
    assert_eq!(words(&cpu), [2, 0, 5, 0, 100, 7]);
    assert_eq!(has_logged(&cpu, crate::diagnostics::RETAIN_NOT_WRITTEN), is_denied);
}

/// A CPU that has run and was stopped by a client.
fn stopped_by_a_client(path: &Path, change: impl FnOnce(&mut ProgramImage)) -> Rc<Cpu> {
    let mut obs = nothing();
    obs[0].1 = Box::new(|cpu, _| {
        if cpu.memory.word(M + 30) == 0 {
            fill(cpu);
            cpu.driver.set_input(4, 1, 9);
            cpu.stop_by_request();
        }
        cpu.memory.set_word(M + 30, 1);
    });
    let cpu = with(path, obs, |image| {
        image.config.retain.bit_memory = Some(4);
        change(image);
    });
    cpu.memory.set_word(M + 30, 0);
    run(&cpu, 5);
    assert!(cpu.is_stopped());
    cpu
}

#[test]
fn a_client_starts_a_stopped_cpu_again() {
    let path = file("again");
    let without: fn(&mut ProgramImage) = |image| image.config.retain.file = None;
    let reset: fn(&mut ProgramImage) = |image| image.config.retain.reset = true;
    for change in [without, |_| {}, reset] {
        let cpu = stopped_by_a_client(&path, change);
        let time = cpu.clock.now();
        let again = Cpu::restarted(cpu, Restart::Warm);
        // Memory that is not retentive begins again, before OB 100.
        again.memory.set_word(M + 30, 1);
        run(&again, 1);
        assert_eq!(words(&again)[..4], [2, 0, 5, 0]);
        assert_eq!(words(&again)[4..], [100, 7]);
        assert!(!again.is_stopped() && again.clock.now() > time);
        assert_eq!(again.driver.read(4, 1), Some(9));
        let events: Vec<u16> = again.diagnostics.newest_first().iter().map(|entry| entry.event).collect();
        assert_eq!(events[..4], [0x4302, 0x4301, 0x4304, 0x4302]);
        let again = Cpu::restarted(again, Restart::Cold);
        again.memory.set_word(M + 30, 1);
        run(&again, 1);
        assert_eq!((words(&again), again.startup.get()), (START, 102));
        let _ = std::fs::remove_file(&path);
    }
}

#[test]
fn blocks_that_the_program_made_outlast_a_warm_restart() {
    let path = file("made");
    let cpu = stopped_by_a_client(&path, |image| image.config.retain.file = None);
    let at = cpu.image.db_end.max(layout::DB_DATA).next_multiple_of(layout::DB_ALIGN);
    cpu.memory.load(at, &[1, 2, 3, 4]);
    cpu.memory.set_db(60, at, 4);
    cpu.created_dbs.borrow_mut().push((60, at, 4));
    cpu.meters[1].bring_back(&[9, 0, 0, 0, 0, 0, 0, 0, 0]);
    let seconds = |cpu: &Cpu| cpu.meters[1].kept(cpu.clock.now())[0];
    let again = Cpu::restarted(cpu, Restart::Warm);
    run(&again, 1);
    assert_eq!((again.memory.db(60), again.created_dbs.borrow().as_slice()), ((at, 4), &[(60, at, 4)][..]));
    assert_eq!(again.memory.view(at, 4, <[u8]>::to_vec), [1, 2, 3, 4]);
    assert_eq!(seconds(&again), 9);
    // A cold restart deletes them; meters count on.
    let again = Cpu::restarted(again, Restart::Cold);
    run(&again, 1);
    assert_eq!(again.memory.db(60).1, 0);
    assert_eq!(seconds(&again), 9);
}

/// Source: CPU manuals, operating-hours counters count in RUN.
#[test]
fn run_time_meters_stand_still_in_stop() {
    let cpu = stopped_by_a_client(&file("meters"), |image| image.config.retain.file = None);
    // 9 seconds, started.
    cpu.meters[1].bring_back(&[9, 0, 0, 0, 0, 0, 0, 0, 1]);
    let seconds = |cpu: &Cpu| cpu.meters[1].kept(cpu.clock.now())[0];
    let wait = |cpu: &Cpu, seconds: u64| cpu.clock.move_to(cpu.clock.now() + seconds * 1_000_000_000);
    wait(&cpu, 20);
    assert_eq!(seconds(&cpu), 9);
    let again = Cpu::restarted(cpu, Restart::Warm);
    again.memory.set_word(M + 30, 1);
    run(&again, 1);
    wait(&again, 5);
    assert_eq!(seconds(&again), 14, "it counts in RUN");
    again.stop_by_request();
    wait(&again, 30);
    assert_eq!((seconds(&again), again.meters[1].kept(0)[8]), (14, 1), "it is still started");
}

#[test]
fn only_some_restarts_can_be_asked_for() {
    for (family, has_cold) in
        [(Family::S7300, true), (Family::S7400, true), (Family::S71200, false), (Family::S71500, false)]
    {
        let cpu = with(&file("asked"), nothing(), |image| image.profile.family = family);
        assert!(!cpu.request_restart(Restart::Hot) && !cpu.request_restart(Restart::Reset));
        assert_eq!((cpu.request_restart(Restart::Cold), cpu.request_restart(Restart::Warm)), (has_cold, true));
    }
}

/// Also for a process that ends before the CPU was started again.
#[test]
fn a_memory_reset_by_a_client_reaches_the_file() {
    let path = file("emptied");
    drop(Cpu::after_reset(stopped_by_a_client(&path, |_| {})));
    assert_eq!(found(&path, |image| image.config.retain.bit_memory = Some(4)), START);
}
