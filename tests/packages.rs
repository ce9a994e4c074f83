//! What a program is packed into: units of co-simulations, static executables, container images.
//!
//! Units are loaded here as a simulator would load them, and by FMPy, which knows nothing of plcc: `python3 -m venv target/clients/venv &&
//! target/clients/venv/bin/pip install fmpy==0.3.32`. Without it these tests are ignored, as those of images are without skopeo.

#![allow(unsafe_code, reason = "a unit is a shared library")]

mod units {
    pub mod library;
}

use std::collections::HashMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_driver::cli::Level;
use plcc_driver::link::{self, Form, Runtime};
use plcc_driver::package::fmu::{self, Version};
use plcc_driver::package::oci;
use plcc_driver::pipeline::{self, Compiled, Settings};
use plcc_tests::{bind_file, kernels, tests_folder};
use sha2::{Digest as _, Sha256};
use units::library::{STATUS_ERROR, STATUS_OK, STATUS_WARNING, Unit};

fn main() -> ExitCode {
    plcc_tests::provide_runtimes();
    let arguments = Arguments::from_args();
    let python = kernels::python();
    let found = Command::new(&python).args(["-c", "import fmpy"]).output();
    let no_fmpy = !found.is_ok_and(|output| output.status.success());
    let mut trials = vec![
        trial("units/stop", stop, false),
        trial("units/order", order, false),
        trial("static", statically, false),
        trial("images/layout", image_layout, false),
        trial("images/skopeo", image_skopeo, !kernels::has("skopeo")),
    ];
    for (version, number) in [(Version::V2, 2), (Version::V3, 3)] {
        for (name, check) in
            [("types", types as fn(&Path, Version) -> Result<(), String>), ("trace", trace), ("coupled", coupled)]
        {
            let python = python.clone();
            trials.push(trial(&format!("units/fmpy/{name}-{number}"), move || check(&python, version), no_fmpy));
        }
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trial(name: &str, check: impl FnOnce() -> Result<(), String> + Send + 'static, ignored: bool) -> Trial {
    let run = move || plcc_driver::on_large_stack(check).and_then(|result| result).map_err(Failed::from);
    Trial::test(name, run).with_ignored_flag(ignored)
}

/// Compiles a source or a project; a path from the folder of tests.
fn compiled(source: &str, cpu: Option<&str>) -> Result<(Compiled, Vec<u8>), String> {
    let settings = Settings { require_main: true, cpu: cpu.map(str::to_string), ..Settings::default() };
    let compiled = pipeline::back(&bind_file(&tests_folder().join(source), &settings)?, Level::O2);
    let object = plcc_codegen::compile_object(&compiled.module, &compiled.image_bytes(), &compiled.codegen_options());
    Ok((compiled, object.map_err(text)?))
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Writes the unit of a program.
fn unit(source: &str, cpu: Option<&str>, version: Version, folder: &Path) -> Result<PathBuf, String> {
    let (compiled, object) = compiled(source, cpu)?;
    let library = link::link_bytes(Form::Unit, &[object], None).map_err(text)?;
    let (bytes, _) = fmu::pack(&compiled.image, &library, version).map_err(text)?;
    let name = Path::new(source).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let path = folder.join(name).with_extension("fmu");
    std::fs::write(&path, bytes).map_err(text)?;
    Ok(path)
}

fn check_py(python: &Path, arguments: &[&Path], what: &str) -> Result<(), String> {
    let mut command = Command::new(python);
    kernels::finished(command.arg(tests_folder().join("units/check.py")).arg(what).args(arguments)).map(drop)
}

fn types(python: &Path, version: Version) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(text)?;
    check_py(python, &[&unit("units/types.scl", Some("s7-1500"), version, folder.path())?], "types")
}

/// When the inputs of the water tank change, in seconds: for the unit, and for the program itself.
const CHANGES: &[(&str, &[(&str, &str)])] = &[
    ("0.1", &[("Start/Stop push button", "1"), ("AI0", "8.5")]),
    ("0.5", &[("Start/Stop push button", "0"), ("Level_SP", "50")]),
    ("0.9", &[("AI0", "11.25")]),
];
/// What is compared. In a flag the unit of an analog channel is named.
const WATCHED: &str = "Pump_Valve3,V1,Start/Stop push lamp,Curr_Level,db58.LMN,Proportional_Valve,MW10,M0.0,AO0 in mA";

fn trace(python: &Path, version: Version) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(text)?;
    let (inputs, scenario, expected) =
        (folder.path().join("in.csv"), folder.path().join("in.toml"), folder.path().join("out.csv"));
    let names = ["Start/Stop push button", "AI0", "Level_SP"];
    let (mut table, mut toml) = (format!("time,{}\n", names.join(",")), String::new());
    let mut now: HashMap<&str, &str> = names.iter().map(|name| (*name, "0")).collect();
    // What is not set has the word 0.
    now.insert("AI0", "4");
    for (time, values) in CHANGES {
        now.extend(values.iter().copied());
        let row: Vec<&str> = names.iter().map(|name| now[name]).collect();
        table += &format!("{time},{}\n", row.join(","));
        let set = |(name, value): &(&str, &str)| match *name {
            "AI0" => format!("\"AI0 in mA\" = {value}"),
            "Level_SP" => format!("\"Level_SP as REAL\" = {value}"),
            name => format!("\"{name}\" = {value}"),
        };
        let values: Vec<String> = values.iter().map(set).collect();
        toml += &format!("[[at]]\ntime = \"{time}s\"\nset = {{ {} }}\n", values.join(", "));
    }
    std::fs::write(&inputs, table).map_err(text)?;
    std::fs::write(&scenario, toml).map_err(text)?;
    let source = "../samples/water-tank";
    let (_, object) = compiled(source, None)?;
    let program = folder.path().join("program");
    link::link(&[object], &program, None).map_err(text)?;
    let mut run = Command::new(&program);
    run.args(["--cycles=150", "--clock=virtual", "--quiet", "--trace-signals", WATCHED]);
    kernels::finished(run.arg("--scenario").arg(&scenario).arg("--trace").arg(&expected))?;
    check_py(python, &[&unit(source, None, version, folder.path())?, &inputs, &expected], "trace")
}

fn coupled(python: &Path, version: Version) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(text)?;
    let pump = unit("units/pump.stl", None, version, folder.path())?;
    let gate = unit("units/gate.stl", None, version, folder.path())?;
    check_py(python, &[&pump, &gate], "coupled")
}

/// A CPU that goes to STOP is a warning; its outputs are off, time goes on, another instance runs, and a reset starts again.
fn stop() -> Result<(), String> {
    let (compiled, object) = compiled("units/fault.stl", None)?;
    let library = link::link_bytes(Form::Unit, &[object], None).map_err(text)?;
    let (packed, _) = fmu::pack(&compiled.image, &library, Version::V2).map_err(text)?;
    assert_eq!(fmu::pack(&compiled.image, &library, Version::V2).map_err(text)?.0, packed, "the same bytes");
    let folder = tempfile::tempdir().map_err(text)?;
    let library = Unit::load(&library, &packed, folder.path())?;
    let (mut one, mut other) = (library.instance("one")?, library.instance("other")?);
    for instance in [&mut one, &mut other] {
        assert_eq!(instance.start(0.0), STATUS_OK);
        assert!(instance.boolean("plcc.running"));
        assert_eq!(instance.integer("MW2"), 7, "OB 100 has run");
        assert_eq!(instance.step(0.0, 0.05), STATUS_OK);
        assert_eq!(instance.integer("MW0"), 5);
        assert!(instance.boolean("Q0.0"));
    }
    one.set_boolean("I0.0", true);
    assert_eq!(one.step(0.05, 0.05), STATUS_WARNING);
    assert_eq!(one.step(0.10, 0.05), STATUS_OK, "it is told once");
    assert_eq!((one.integer("MW0"), one.boolean("plcc.running"), one.boolean("Q0.0")), (6, false, false));
    let messages = one.messages();
    let message = messages.first().ok_or("nothing was told")?;
    assert!(message.contains("STOP") && message.contains("253A") && message.contains("fault.stl"), "{messages:?}");
    assert_eq!(other.step(0.05, 0.1), STATUS_OK);
    assert_eq!((other.integer("MW0"), other.boolean("Q0.0")), (15, true));
    assert_eq!(one.reset(), STATUS_OK);
    assert_eq!(one.start(100.0), STATUS_OK);
    assert_eq!(one.step(100.0, 0.01), STATUS_OK);
    assert_eq!((one.integer("MW0"), one.integer("MW2"), one.boolean("Q0.0")), (1, 7, true));
    assert!(other.messages().is_empty());
    Ok(())
}

/// What a simulator must not do is refused with a message, and nothing happens.
fn order() -> Result<(), String> {
    let (compiled, object) = compiled("units/pump.stl", None)?;
    let library = link::link_bytes(Form::Unit, &[object], None).map_err(text)?;
    let (packed, _) = fmu::pack(&compiled.image, &library, Version::V2).map_err(text)?;
    let folder = tempfile::tempdir().map_err(text)?;
    let library = Unit::load(&library, &packed, folder.path())?;
    assert!(library.instance_with("one", "{another program}").is_none());
    let mut one = library.instance("one")?;
    assert_eq!(one.step(0.0, 0.1), STATUS_ERROR, "before the initialization");
    assert_eq!(one.start(0.0), STATUS_OK);
    assert_eq!(one.start(0.0), STATUS_ERROR, "twice");
    for (from, length) in
        [(0.0, -0.1), (1.0, 0.1), (f64::NAN, 0.1), (0.0, f64::INFINITY), (0.0, f64::NAN), (0.0, 1e300)]
    {
        assert_eq!(one.step(from, length), STATUS_ERROR, "{from} {length}");
    }
    assert_eq!(one.get_boolean(u32::MAX), STATUS_ERROR);
    assert_eq!(one.set_integer("IW2", 70_000), STATUS_ERROR);
    assert_eq!(one.set_integer("IW2", 100), STATUS_OK);
    assert_eq!(one.step(0.0, 0.1), STATUS_OK);
    assert_eq!(one.terminate(), STATUS_OK);
    assert_eq!(one.step(0.1, 0.1), STATUS_ERROR, "after the end");
    assert_eq!(one.set_integer("IW2", 5), STATUS_ERROR);
    assert_eq!(one.integer("IW2"), 100, "values can be read after the end");
    let messages = one.messages();
    assert!(messages.iter().any(|message| message.contains("70000 is not from 0 to 65535")), "{messages:?}");
    assert_eq!(messages.len(), 12, "each error has its message: {messages:?}");
    Ok(())
}

/// An executable without a dynamic library does what the other one does.
fn statically() -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(text)?;
    let (_, object) = compiled("units/pump.stl", None)?;
    let run = |form: Form| {
        let path = folder.path().join(format!("{form:?}"));
        link::link_form(form, &[&object], &path, None).map_err(text)?;
        let mut command = Command::new(&path);
        command.args(["--cycles=20", "--clock=virtual", "--set=I0.0=1,IW2=100", "--print=Q0.0,MW0", "--diag"]);
        let output = kernels::finished(&mut command)?;
        Ok::<_, String>((std::fs::read(&path).map_err(text)?, output.stdout, output.stderr))
    };
    let (ordinary, alone) = (run(Form::Executable(Runtime::Plain))?, run(Form::Static(Runtime::Plain))?);
    assert_eq!((&ordinary.1, &ordinary.2), (&alone.1, &alone.2));
    assert!(String::from_utf8_lossy(&alone.1).contains("Q0.0 = 1"), "{}", String::from_utf8_lossy(&alone.1));
    assert!(needs_loader(&ordinary.0) && !needs_loader(&alone.0));
    Ok(())
}

/// Whether an executable names a program that loads its libraries, PT_INTERP.
fn needs_loader(elf: &[u8]) -> bool {
    let number = |at: usize, bytes: usize| {
        elf[at..at + bytes].iter().rev().fold(0usize, |value, byte| value << 8 | usize::from(*byte))
    };
    let (table, size, count) = (number(32, 8), number(54, 2), number(56, 2));
    (0..count).any(|index| number(table + index * size, 4) == 3)
}

fn image() -> Result<(Vec<u8>, Vec<u8>), String> {
    let (_, object) = compiled("units/pump.stl", None)?;
    let executable = link::link_bytes(Form::Static(Runtime::Plain), &[object], None).map_err(text)?;
    let image = oci::pack("Pump 1", &executable).map_err(text)?;
    Ok((executable, image))
}

fn files(tar: &[u8]) -> Result<HashMap<String, Vec<u8>>, String> {
    let mut files = HashMap::new();
    for entry in tar::Archive::new(tar).entries().map_err(text)? {
        let mut entry = entry.map_err(text)?;
        assert_eq!(entry.header().mtime().map_err(text)?, 0);
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(text)?;
        files.insert(entry.path().map_err(text)?.display().to_string(), bytes);
    }
    Ok(files)
}

/// The image as the OCI image specification has it: every part is there, with its digest and size, and the executable in the layer runs.
fn image_layout() -> Result<(), String> {
    let (executable, image) = image()?;
    assert_eq!(image, self::image()?.1, "the same program, the same bytes");
    let files = files(&image)?;
    let json = |bytes: &[u8]| serde_json::from_slice::<serde_json::Value>(bytes).map_err(text);
    assert_eq!(json(&files["oci-layout"])?["imageLayoutVersion"], "1.0.0");
    let part = |descriptor: &serde_json::Value| {
        let digest = descriptor["digest"].as_str().ok_or("no digest")?.strip_prefix("sha256:").ok_or("not SHA-256")?;
        let bytes = files.get(&format!("blobs/sha256/{digest}")).ok_or_else(|| format!("no {digest}"))?;
        let own: String = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(own, digest);
        assert_eq!(descriptor["size"].as_u64(), Some(bytes.len() as u64));
        Ok::<_, String>(bytes)
    };
    let index = json(&files["index.json"])?;
    assert_eq!(index["manifests"].as_array().map(Vec::len), Some(1));
    let entry = &index["manifests"][0];
    assert_eq!(entry["annotations"]["io.containerd.image.name"], "docker.io/library/pump-1:latest");
    let manifest = json(part(entry)?)?;
    assert_eq!((manifest["schemaVersion"].as_u64(), &manifest["mediaType"]), (Some(2), &entry["mediaType"]));
    let config = json(part(&manifest["config"])?)?;
    assert_eq!(config["os"], "linux");
    assert_eq!(manifest["layers"].as_array().map(Vec::len), Some(1));
    assert_eq!(config["rootfs"]["diff_ids"][0], manifest["layers"][0]["digest"], "the layer is not compressed");
    let layer = self::files(part(&manifest["layers"][0])?)?;
    let program = config["config"]["Entrypoint"][0].as_str().ok_or("no program")?;
    assert_eq!(layer.get(program.trim_start_matches('/')), Some(&executable));
    assert_eq!(files.len(), 5, "nothing else");
    Ok(())
}

fn image_skopeo() -> Result<(), String> {
    let (executable, image) = image()?;
    let folder = tempfile::tempdir().map_err(text)?;
    let (path, copy) = (folder.path().join("image.tar"), folder.path().join("copy"));
    std::fs::write(&path, image).map_err(text)?;
    let source = format!("oci-archive:{}", path.display());
    let inspected = kernels::finished(Command::new("skopeo").args(["inspect", "--config", &source]))?;
    let config: serde_json::Value = serde_json::from_slice(&inspected.stdout).map_err(text)?;
    assert_eq!(config["config"]["Entrypoint"][0], "/plc");
    // A copy checks all digests.
    let target = format!("dir:{}", copy.display());
    kernels::finished(Command::new("skopeo").args(["--insecure-policy", "copy", &source, &target]))?;
    let found = std::fs::read_dir(&copy).map_err(text)?.filter_map(|entry| std::fs::read(entry.ok()?.path()).ok());
    let mut layers = found.filter_map(|bytes| files(&bytes).ok()).filter(|files| files.contains_key("plc"));
    assert_eq!(layers.next().and_then(|mut files| files.remove("plc")), Some(executable));
    Ok(())
}
