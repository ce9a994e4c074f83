//! Retentive and permanent memory of an S7-200.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use plcc_abi::layout;
use plcc_abi::s7200::system;

use super::helpers::{Block, run, run_observed, s7200_with};
use crate::cpu::Cpu;
use crate::cycle::Observer;

const SM: u32 = layout::SYSTEM;
const V: u32 = layout::DB_DATA;

/// A file in a directory of this test.
fn file(name: &str) -> PathBuf {
    let directory = std::env::temp_dir().join(format!("plcc-s7200-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let file = directory.join("retentive");
    let _ = std::fs::remove_file(&file);
    file
}

fn keeping(path: &Path, main: Block) -> Rc<Cpu> {
    s7200_with(main, Vec::new(), |image| image.config.retain.file = Some(path.display().to_string()))
}

/// Runs a scan and returns V, values of T5, T37 and C50, bit of C50, MB13, MB14 as it found them, and SM0.2.
fn found(path: &Path) -> ([u16; 7], bool) {
    let seen = Rc::new(RefCell::new(([0; 7], false)));
    let log = seen.clone();
    let main: Block = Box::new(move |cpu, _| {
        let memory = &cpu.memory;
        let values = [
            memory.word(V + 100),
            memory.word(SM + system::TIMER_VALUES + 10),
            memory.word(SM + system::TIMER_VALUES + 74),
            memory.word(SM + system::COUNTER_VALUES + 100),
            memory.byte(SM + system::COUNTER_BITS + 50).into(),
            memory.byte(layout::M + 13).into(),
            memory.byte(layout::M + 14).into(),
        ];
        *log.borrow_mut() = (values, memory.bit(SM, 2));
    });
    run(&keeping(path, main), 1);
    seen.take()
}

fn fill(cpu: &Cpu) {
    let memory = &cpu.memory;
    memory.set_word(V + 100, 0x1234);
    memory.set_word(SM + system::TIMER_VALUES + 10, 5);
    memory.set_word(SM + system::TIMER_VALUES + 74, 37);
    memory.set_word(SM + system::COUNTER_VALUES + 100, 50);
    memory.set_byte(SM + system::COUNTER_BITS + 50, 1);
    memory.set_byte(layout::M + 13, 13);
    memory.set_byte(layout::M + 14, 14);
}

#[test]
fn retentive_memory_survives() {
    let path = file("survives");
    assert_eq!(found(&path), ([0; 7], true), "expected, but not there");
    run(&keeping(&path, Box::new(|cpu, _| fill(cpu))), 1);
    let kept = [0x1234, 5, 0, 50, 0, 0, 14];
    assert_eq!(found(&path), (kept, false));
    assert_eq!(found(&path), (kept, false));
    // Damaged: a cold start, and the next run has a good file again.
    let bytes = damage(&path);
    assert_eq!(found(&path), ([0; 7], true));
    assert_eq!(found(&path), ([0; 7], false));
    for cut in [0, 3, 8, 20, 100, 4100] {
        std::fs::write(&path, &bytes[..cut.min(bytes.len())]).unwrap();
        assert!(found(&path).1, "cut at {cut}");
    }
    std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
}

/// Changes a byte of both copies in the file, and returns the file.
fn damage(path: &Path) -> Vec<u8> {
    let mut bytes = std::fs::read(path).unwrap();
    let slot = u64::from_le_bytes(bytes[8..16].try_into().unwrap()) as usize;
    for place in [4096 + 100, 4096 + slot + 100] {
        bytes[place] ^= 1;
    }
    std::fs::write(path, &bytes).unwrap();
    bytes
}

/// Reads the file after each scan.
struct Reader<'a>(&'a Path, Vec<bool>);

impl Observer for Reader<'_> {
    fn before(&mut self, _: &Cpu, cycle: u64, _: u64) {
        if cycle > 1 {
            // A thread writes it.
            std::thread::sleep(std::time::Duration::from_millis(200));
            self.1.push(std::fs::read(self.0).is_ok_and(|file| file.windows(2).any(|pair| pair == [0x12, 0x34])));
        }
    }
    fn after(&mut self, _: &Cpu, _: u64, _: u64) {}
}

#[test]
fn retentive_memory_is_written_while_the_program_runs() {
    let path = file("runs");
    let mut reader = Reader(&path, Vec::new());
    run_observed(&keeping(&path, Box::new(|cpu, _| fill(cpu))), 2, &mut reader);
    assert_eq!(reader.1, [true]);
    std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
}

#[test]
fn a_new_data_block_replaces_v() {
    let path = file("block");
    run(&keeping(&path, Box::new(|cpu, _| fill(cpu))), 1);
    let cpu = s7200_with(Box::new(|_, _| ()), Vec::new(), |image| {
        image.config.retain.file = Some(path.display().to_string());
        image.dbs[0].data[100] = 7;
    });
    run(&cpu, 1);
    assert_eq!((cpu.memory.word(V + 100), cpu.memory.word(SM + system::COUNTER_VALUES + 100)), (0x700, 50));
    std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
}

#[test]
fn permanent_memory() {
    let path = file("permanent");
    let main: Block = Box::new(|cpu, _| {
        cpu.memory.set_word(V + 100, 0x1234);
        // A word at VW100, by a direct write and by one that is only seen at the end of the scan.
        cpu.memory.set_word(SM + 32, 100);
        cpu.memory.set_byte(SM + 31, 0x82);
        if cpu.clock.now() == 0 {
            cpu.s7200_special_written(31);
            assert_eq!(cpu.memory.byte(SM + 31), 2);
        } else {
            cpu.memory.set_word(SM + 32, 10_239);
        }
    });
    let cpu = keeping(&path, main);
    run(&cpu, 2);
    assert_eq!(cpu.memory.byte(SM + 31), 2);
    assert!(cpu.s7200_error_report()[0].contains("non-fatal error 0094"));
    drop(cpu);
    // V of another run, with the saved word.
    let (values, lost) = found(&path);
    assert_eq!((values[0], lost), (0x1234, false));
    std::fs::remove_dir_all(path.parent().unwrap()).unwrap();
}

/// The path may be mistyped: what is there and is not ours stays as it is.
#[test]
fn other_files_are_left_alone() {
    for (name, content) in [("prose", "a plant diary"), ("short", "P8"), ("similar", "PLCREX1 ...")] {
        let path = file(name);
        std::fs::write(&path, content).unwrap();
        let cpu = keeping(&path, Box::new(|cpu, _| fill(cpu)));
        assert!(cpu.check_retentive_file().is_err_and(|message| message.contains("left as it is")), "{name}");
        run(&cpu, 1);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), content, "{name}");
    }
    let path = file("beside");
    let beside = path.with_file_name("retentive.new");
    std::fs::write(&beside, "notes").unwrap();
    run(&keeping(&path, Box::new(|cpu, _| fill(cpu))), 1);
    assert_eq!(std::fs::read_to_string(&beside).unwrap(), "notes");
    // A folder, a device.
    for path in [std::env::temp_dir(), "/dev/null".into()] {
        assert!(keeping(&path, Box::new(|_, _| {})).check_retentive_file().is_err());
    }
}
