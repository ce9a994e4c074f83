//! Builds the runtime that is in every executable: as an executable with room for a program, to which plcc adds one, and as
//! one relocatable object for linking with a C compiler. Each comes without services, and with them for programs that have clients.
//! Further forms with room for a program: an executable that needs no dynamic library, and a shared library, which becomes a unit of a
//! co-simulation.
//!
//! The crates of the runtime are compiled once more as one static library, in a separate target folder, so that the
//! outer build's lock is not touched. A partial link then picks from it and from the standard library what `main` and the
//! runtime functions need: linking an executable takes a fraction of the time that it takes with the archive.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

use plcc_abi::{RuntimeFn, linked};

/// What the object is built from, relative to the root of the workspace.
const SOURCES: [&str; 10] = [
    "Cargo.lock",
    "Cargo.toml",
    "runtime/abi/Cargo.toml",
    "runtime/abi/src",
    "runtime/core/Cargo.toml",
    "runtime/core/src",
    "runtime/literal/Cargo.toml",
    "runtime/literal/src",
    "runtime/services/Cargo.toml",
    "runtime/services/src",
];

/// Settings of the outer build that must not reach the inner one.
const FOREIGN_VARIABLES: [&str; 6] = [
    "RUSTC_WORKSPACE_WRAPPER",
    "CARGO_TARGET_DIR",
    "CARGO_BUILD_TARGET_DIR",
    "CARGO_BUILD_TARGET",
    "CARGO_ENCODED_RUSTFLAGS",
    "RUSTFLAGS",
];

/// Profile of the inner build. In a debug build of plcc the crates of the project are compiled for a short wait instead.
const PROFILE: [(&str, &str); 6] = [
    ("CARGO_PROFILE_RELEASE_PANIC", "abort"),
    ("CARGO_PROFILE_RELEASE_OPT_LEVEL", "2"),
    ("CARGO_PROFILE_RELEASE_DEBUG", "0"),
    ("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1"),
    ("CARGO_PROFILE_RELEASE_LTO", "off"),
    ("CARGO_PROFILE_RELEASE_INCREMENTAL", "false"),
];

fn main() {
    if only_checked() {
        return without_runtime(&variable("OUT_DIR"));
    }
    let root = variable("CARGO_MANIFEST_DIR").join("../..");
    let out = variable("OUT_DIR");
    println!("cargo::rerun-if-changed=build.rs");
    for source in SOURCES {
        println!("cargo::rerun-if-changed={}", root.join(source).display());
    }
    let archive = build_archive(&root, &out.join("runtime"));
    for (name, entry) in RUNTIMES {
        let runtime = out.join(format!("{name}.o"));
        prelink(&archive, entry, &runtime);
        link_template(&runtime, &out.join(format!("{name}-template")), &["-fPIE", "-pie", "-static-libgcc"]);
        link_static(&runtime, &out.join(format!("{name}-static")));
    }
    link_template(&prelinked_unit(&archive, &out), &out.join(UNIT), &unit_options(&out));
}

/// The runtimes: name of the file, and the function of the library that is `main`. What it does not reach is left
/// out.
const RUNTIMES: [(&str, &str); 2] = [("runtime", "plcc_main"), ("services", "plcc_main_with_services")];

/// The library with room for a program that becomes a unit of a co-simulation.
const UNIT: &str = "unit";

/// Whether clippy looks at the crate, which then is neither linked nor run.
fn only_checked() -> bool {
    env::var_os("RUSTC_WORKSPACE_WRAPPER")
        .is_some_and(|wrapper| Path::new(&wrapper).file_stem() == Some(OsStr::new("clippy-driver")))
}

/// Writes empty files in the place of all runtimes: they are not used, and compiling the runtime takes minutes.
fn without_runtime(out: &Path) {
    let forms =
        RUNTIMES.iter().flat_map(|(name, _)| [".o", "-template", "-static"].map(|form| format!("{name}{form}")));
    for file in forms.chain([UNIT.to_string()]) {
        std::fs::write(out.join(file), []).expect("cargo's output folder can be written");
    }
}

fn variable(name: &str) -> PathBuf {
    PathBuf::from(env::var_os(name).unwrap_or_else(|| panic!("cargo sets {name}")))
}

/// How sections are combined: one of each kind, so that the final link has little to do. Generated code and the runtime abort
/// instead of unwinding, so unwind tables go, as does the standard library's bitcode.
const LINKER_SCRIPT: &str = "SECTIONS {
  .text 0 : { *(.text .text.*) }
  .rodata 0 : { *(.rodata .rodata.*) }
  .data.rel.ro 0 : { *(.data.rel.ro .data.rel.ro.*) }
  .tdata 0 : { *(.tdata .tdata.*) }
  .tbss 0 : { *(.tbss .tbss.*) }
  .init_array 0 : { KEEP(*(.init_array .init_array.*)) }
  .data 0 : { *(.data .data.*) }
  .bss 0 : { *(.bss .bss.* COMMON) }
  /DISCARD/ : { *(.eh_frame .gcc_except_table .gcc_except_table.* .comment .note.gnu.property .llvmbc .llvmcmd) }
}
";

/// Compiles the runtime with the services; returns the path of the static library.
fn build_archive(root: &Path, target_dir: &Path) -> PathBuf {
    let target = env::var("TARGET").expect("cargo sets TARGET");
    let cargo = |offline: bool| {
        let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo")));
        cargo.current_dir(root).args(["rustc", "--release", "--locked", "--package", "plcc-services", "--lib"]);
        cargo.args(["--features", "executable", "--crate-type", "staticlib", "--target", &target]);
        cargo.arg("--target-dir").arg(target_dir);
        cargo.args(offline.then_some("--offline"));
        for name in FOREIGN_VARIABLES {
            cargo.env_remove(name);
        }
        cargo.envs(PROFILE);
        if env::var("PROFILE").is_ok_and(|profile| profile == "debug") {
            cargo.env("CARGO_PROFILE_RELEASE_INCREMENTAL", "true");
            for name in ["plcc-abi", "plcc-literal", "plcc-runtime", "plcc-services"] {
                for setting in ["opt-level=1", "codegen-units=64"] {
                    cargo.arg("--config").arg(format!("profile.release.package.{name}.{setting}"));
                }
            }
        }
        cargo
    };
    // The outer build contains the runtime, so it has already fetched everything.
    let built = cargo(true).output().is_ok_and(|output| output.status.success());
    if !built {
        run(&mut cargo(false), "building the runtime");
    }
    target_dir.join(target).join("release/libplcc_services.a")
}

/// Links what `main` and the runtime functions need into one relocatable object.
fn prelink(archive: &Path, entry: &str, object: &Path) {
    let source = object.with_extension("main.c");
    let main =
        format!("int {entry}(int, char **);\nint main(int argc, char **argv) {{ return {entry}(argc, argv); }}\n");
    std::fs::write(&source, main).expect("cargo's output folder can be written");
    let mut linker = compiler();
    linker.args(["-O1", "-fno-asynchronous-unwind-tables", "-fPIE"]).arg(&source);
    prelink_roots(linker, archive, object, runtime_functions().chain([linked::MEMORY_SYMBOL, "main"]));
}

/// What generated code calls.
fn runtime_functions<'a>() -> impl Iterator<Item = &'a str> {
    RuntimeFn::ALL
        .iter()
        .map(|function| function.symbol())
        .chain(linked::LIBRARY_FUNCTIONS.map(|(_, exported)| exported))
}

fn prelink_roots<'a>(mut linker: Command, archive: &Path, object: &Path, roots: impl Iterator<Item = &'a str>) {
    let script = object.with_extension("ld");
    std::fs::write(&script, LINKER_SCRIPT).expect("cargo's output folder can be written");
    linker.args(["-r", "-nostdlib", "-Wl,--gc-sections", "-Wl,--force-group-allocation"]);
    linker.args(["-Wl,--strip-debug", "-Wl,--discard-all", "-T"]).arg(&script);
    linker.args(roots.map(|symbol| format!("-Wl,--undefined={symbol}")));
    linker.arg("-o").arg(object).arg(archive);
    run(&mut linker, "linking the runtime");
}

/// As [`prelink`], with the functions that a simulator calls.
fn prelinked_unit(archive: &Path, out: &Path) -> PathBuf {
    let names = exported(archive);
    assert!(names.len() > 100, "the runtime exports {} functions of units", names.len());
    let object = out.join("unit.o");
    let roots = runtime_functions().chain([linked::MEMORY_SYMBOL]).chain(names.iter().map(String::as_str));
    prelink_roots(compiler(), archive, &object, roots);
    object
}

/// The functions of the interface for co-simulation that the runtime has.
fn exported(archive: &Path) -> Vec<String> {
    let mut list = Command::new(env::var_os("NM").unwrap_or_else(|| OsString::from("nm")));
    list.args(["--extern-only", "--defined-only", "--format=posix"]).arg(archive);
    let output = list.output().unwrap_or_else(|error| panic!("nm lists the runtime: {error}"));
    let text = String::from_utf8_lossy(&output.stdout);
    let names = text.lines().filter_map(|line| line.split_whitespace().next());
    names.filter(|name| name.starts_with("fmi2") || name.starts_with("fmi3")).map(str::to_string).collect()
}

/// A shared library that shows nothing but the functions of the interface.
fn unit_options(out: &Path) -> Vec<String> {
    let script = out.join("unit.map");
    std::fs::write(&script, "{ global: fmi2*; fmi3*; local: *; };\n").expect("cargo's output folder can be written");
    let script = format!("-Wl,--version-script={}", script.display());
    ["-fPIC", "-shared", "-static-libgcc", "-Wl,-Bsymbolic", &script].map(str::to_string).into()
}

/// Links the runtime to an executable. Its last two segments have room for a program, and the first of them begins with
/// the symbol by which the runtime finds the program.
fn link_template(runtime: &Path, template: &Path, options: &[impl AsRef<OsStr>]) {
    let (program, code) = (linked::SECTION, linked::CODE_SECTION);
    let (source, script) = (template.with_extension("c"), template.with_extension("ld"));
    let room = format!(
        "__attribute__((section(\"{program}\"), used)) const long {}[{}] = {{0}};\n\
         __attribute__((section(\"{code}\"), used)) void plcc_code(void) {{}}\n",
        linked::SYMBOL,
        size_of::<linked::LinkedProgram>() / 8,
    );
    let page = "ALIGN(CONSTANT(MAXPAGESIZE))";
    let sections = format!(
        "SECTIONS {{\n  {program} {page} : {{ KEEP(*({program})) }}\n  {code} {page} : {{ KEEP(*({code})) }}\n}}\n\
         INSERT AFTER .bss;\n"
    );
    std::fs::write(&source, room).expect("cargo's output folder can be written");
    std::fs::write(&script, sections).expect("cargo's output folder can be written");
    let mut linker = compiler();
    linker.args(["-O1", "-fno-asynchronous-unwind-tables"]).args(options).arg("-o").arg(template);
    linker.arg(&source).arg(runtime).args(["-lm", "-Wl,-T"]).arg(&script);
    // Debuggers see the functions that code calls; the rest would only make executables larger.
    let names = template.with_extension("names");
    let kept = runtime_functions().chain([linked::SYMBOL, linked::MEMORY_SYMBOL, "main"]);
    std::fs::write(&names, kept.map(|name| format!("{name}\n")).collect::<String>())
        .expect("cargo's output folder can be written");
    linker.arg(format!("-Wl,--retain-symbols-file={}", names.display()));
    linker.arg("-Wl,-z,relro,-z,now,-z,noexecstack,-z,separate-code,--build-id=none,--discard-all");
    run(&mut linker, "linking the runtime to an executable");
}

/// As [`link_template`], without dynamic libraries. Where the static C library is not installed the file is empty, and plcc says so when
/// such an executable is asked for.
fn link_static(runtime: &Path, template: &Path) {
    let mut search = compiler();
    let found = search.arg("-print-file-name=libc.a").output().is_ok_and(|output| {
        // Only the name if there is no such file.
        Path::new(String::from_utf8_lossy(&output.stdout).trim()).is_absolute()
    });
    if found {
        link_template(runtime, template, &["-fPIE", "-static-pie"]);
    } else {
        println!("cargo::warning=there is no static C library: `plcc build --static` will not work");
        std::fs::write(template, []).expect("cargo's output folder can be written");
    }
}

fn compiler() -> Command {
    Command::new(env::var_os("CC").unwrap_or_else(|| OsString::from("cc")))
}

fn run(command: &mut Command, what: &str) {
    match command.output() {
        Ok(output) if output.status.success() => {}
        Ok(output) => panic!("{what} failed: {command:?}\n{}", String::from_utf8_lossy(&output.stderr)),
        Err(error) => panic!("{what} failed: {command:?}: {error}"),
    }
}
