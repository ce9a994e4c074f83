//! A module of the IR becomes an executable that runs.

use std::collections::HashSet;
use std::path::Path;
use std::process::Command;

use object::read::elf::ProgramHeader as _;
use object::{LittleEndian, elf};
use plcc_abi::image::{BlockEntry, BlockKind, Config, Family, Profile, ProgramImage};
use plcc_abi::{RuntimeFn, Type, linked};
use plcc_codegen::{CodegenOptions, compile_object};
use plcc_driver::link::{self, Form, LinkError, Runtime, Template};
use plcc_ir::{Address, FunctionBuilder, Module, Region};

fn provide() {
    link::provide(plcc_prebuilt::RUNTIMES);
}

/// OB 1 adds 1 to MW 0 and sets Q 4.0; MD 4 becomes the sine of 1.0.
fn module() -> Module {
    let mut b = FunctionBuilder::new("OB1", &[], &[]);
    let count = b.load(Type::I16, Address::direct(Region::M, 0));
    let one = b.iconst(Type::I16, 1);
    let count = b.iadd(count, one);
    b.store(Address::direct(Region::M, 0), count);
    let set = b.bool_const(true);
    b.store_bit(Address::direct(Region::Q, 4), 0, set);
    let x = b.f32_const(1.0);
    let y = b.call_pure(RuntimeFn::Sin, &[x]);
    b.store(Address::direct(Region::M, 4), y);
    b.ret(&[]);
    let mut module = Module::default();
    let id = module.functions.push(b.finish());
    module.entries.push(id);
    module
}

fn image() -> ProgramImage {
    let profile = Profile {
        name: "s7-300".to_string(),
        family: Family::S7300,
        accumulators: 2,
        inputs: 2048,
        outputs: 2048,
        bit_memory: 8192,
        timers: 2048,
        counters: 2048,
        local_data: 32768,
        db_bytes_max: 65534,
        block_depth: 16,
        error_depth: 4,
        limits_checked: false,
    };
    let ob1 = BlockEntry {
        kind: BlockKind::Ob,
        number: 1,
        name: String::new(),
        entry: 0,
        frame: 32,
        local_data_used: true,
        start_inputs: Vec::new(),
    };
    ProgramImage {
        name: "test".to_string(),
        profile,
        config: Config::default(),
        blocks: vec![ob1],
        dbs: Vec::new(),
        db_end: plcc_abi::layout::DB_DATA,
        sites: Vec::new(),
        error_slots: Vec::new(),
        files: Vec::new(),
        asserts: Vec::new(),
        symbols: Vec::new(),
        types: Vec::new(),
        used: Vec::new(),
        partial: Vec::new(),
        stops_itself: false,
        sources_sum: 0,
        shapes: Vec::new(),
        outputs_used: u32::MAX,
        notices: Vec::new(),
        inner_blocks: Vec::new(),
        s7200: None,
    }
}

#[test]
fn an_executable_runs_the_program() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let executable = folder.path().join("program");
    let image = postcard::to_stdvec(&image()).expect("an image can be encoded");
    let code = compile_object(&module(), &image, &CodegenOptions::default()).expect("it compiles");
    provide();
    link::link(&[code], &executable, None).expect("it links");
    let output = Command::new(&executable)
        .args(["--cycles", "5", "--clock", "virtual", "--print", "MW0,Q4.0,MD4"])
        .output()
        .expect("it starts");
    let sine = format!("MD4 = 16#{:08X}", 1.0f32.sin().to_bits());
    let text = String::from_utf8_lossy(&output.stdout);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines, ["MW0 = 16#0005", "Q4.0 = 1", sine.as_str()], "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn an_output_that_cannot_be_written_is_an_error() {
    let code = compile_object(&module(), b"", &CodegenOptions::default()).expect("it compiles");
    provide();
    let error = link::link(&[code], Path::new("/no/such/folder/program"), None).expect_err("there is no such folder");
    assert!(error.to_string().contains("/no/such/folder/program"), "{error}");
}

const NO_OBJECTS: [&[u8]; 0] = [];

#[test]
fn a_missing_linker_is_named() {
    provide();
    let error = link::link(&NO_OBJECTS, Path::new("out"), Some("/no/such/linker")).expect_err("there is none");
    assert!(matches!(error, LinkError::Start { .. }));
    assert!(error.to_string().contains("`/no/such/linker`"), "{error}");
}

#[test]
fn a_failing_linker_is_shown_with_its_command() {
    provide();
    let error = link::link(&NO_OBJECTS, Path::new("out"), Some("false")).expect_err("it fails");
    assert!(matches!(error, LinkError::Failed { .. }));
    assert!(error.to_string().contains("plcc-runtime.o"), "{error}");
}

const FORMS: [Form; 5] = [
    Form::Executable(Runtime::Plain),
    Form::Executable(Runtime::Services),
    Form::Static(Runtime::Plain),
    Form::Static(Runtime::Services),
    Form::Unit,
];

fn template(form: Form) -> Template {
    provide();
    Template::read(form).expect("plcc was built with it")
}

#[test]
fn the_template_has_room_and_all_functions() {
    for form in FORMS {
        let template = template(form);
        assert!(template.program.address < template.code.address);
        let names: HashSet<&[u8]> = template.functions.iter().map(|(name, _)| *name).collect();
        let library = linked::LIBRARY_FUNCTIONS.map(|(_, name)| name);
        for name in RuntimeFn::ALL.iter().map(|function| function.symbol()).chain(library) {
            assert!(names.contains(name.as_bytes()), "{form:?}: {name}");
        }
    }
}

#[test]
fn services_are_only_where_they_are_asked_for() {
    let bytes = |runtime| template(Form::Executable(runtime)).bytes.len();
    let (plain, services) = (bytes(Runtime::Plain), bytes(Runtime::Services));
    assert!(plain < 4_000_000 && plain + 200_000 < services, "{plain} {services}");
}

#[test]
fn no_segment_is_writable_and_executable() {
    let segments = FORMS.map(|form| template(form).segments);
    for segment in segments.iter().flatten() {
        let flags = segment.p_flags(LittleEndian);
        assert!(flags & elf::PF_W == 0 || flags & elf::PF_X == 0, "{flags}");
    }
}
