//! samples/fleet: the compose file and the manifests name what is there: images, flags, ports, probes, volumes.

use std::collections::HashMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use libtest_mimic::Failed;
use saphyr_parser::{Event, Parser};
use serde_json::{Map, Value};

use crate::process::{Plc, free_port, get, plcc};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../samples/fleet")
}

/// The documents of a file. Scalars are texts, but for those that are whole numbers.
fn documents(name: &str) -> Result<Vec<Value>, Failed> {
    let text = std::fs::read_to_string(folder().join(name))?;
    // Lists and objects that are open, each with the key that waits for a value.
    let mut open: Vec<(Value, Option<String>)> = Vec::new();
    let mut found = Vec::new();
    for event in Parser::new_from_str(&text) {
        let (event, _) = event.map_err(|error| format!("{name}: {error}"))?;
        let mut done = match event {
            Event::MappingStart(..) => {
                open.push((Value::Object(Map::new()), None));
                continue;
            }
            Event::SequenceStart(..) => {
                open.push((Value::Array(Vec::new()), None));
                continue;
            }
            Event::MappingEnd | Event::SequenceEnd => open.pop().ok_or("an end without a start")?.0,
            Event::Scalar(text, ..) => text.parse::<u64>().map_or_else(|_| text.as_ref().into(), Value::from),
            Event::Alias(_) => return Err(format!("{name}: an alias").into()),
            Event::Nothing | Event::StreamStart | Event::StreamEnd | Event::DocumentStart(_) | Event::DocumentEnd => {
                continue;
            }
        };
        match open.last_mut() {
            None => found.push(done.take()),
            Some((Value::Array(list), _)) => list.push(done.take()),
            Some((Value::Object(object), key)) => match key.take() {
                Some(key) if object.insert(key.clone(), done.take()).is_some() => {
                    return Err(format!("{name}: {key} is there twice").into());
                }
                Some(_) => {}
                None => *key = Some(done.as_str().map_or_else(|| done.to_string(), str::to_string)),
            },
            Some(_) => return Err(format!("{name}: a value within a value").into()),
        }
    }
    Ok(found)
}

/// The arguments of a container, as texts.
fn arguments(list: &Value) -> Result<Vec<String>, Failed> {
    let texts = list.as_array().ok_or("no arguments")?.iter().map(|text| text.as_str().map(str::to_string));
    texts.collect::<Option<_>>().ok_or_else(|| "an argument is not a text".into())
}

/// The value of `--flag=value`, or of `--flag` and `value`.
fn value_of<'a>(arguments: &'a [String], flag: &str) -> Result<&'a str, Failed> {
    let same = arguments.iter().find_map(|argument| argument.strip_prefix(flag)?.strip_prefix('='));
    let next = arguments.iter().position(|argument| argument == flag).and_then(|at| arguments.get(at + 1));
    same.or(next.map(String::as_str)).ok_or_else(|| format!("no {flag} in {arguments:?}").into())
}

/// The part of an image with the configuration of containers, and the name of the image.
fn image(path: &Path) -> Result<(Value, String), Failed> {
    let mut files = HashMap::new();
    for entry in tar::Archive::new(std::fs::File::open(path)?).entries()? {
        let mut entry = entry?;
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes)?;
        files.insert(entry.path()?.display().to_string(), bytes);
    }
    let json = |name: &str| -> Result<Value, Failed> {
        Ok(serde_json::from_slice(files.get(name).ok_or_else(|| format!("no {name} in the image"))?)?)
    };
    let blob =
        |descriptor: &Value| json(&format!("blobs/{}", descriptor["digest"].as_str().unwrap_or("").replace(':', "/")));
    let index = json("index.json")?;
    let manifest = blob(&index["manifests"][0])?;
    let name = index["manifests"][0]["annotations"]["io.containerd.image.name"].as_str().unwrap_or("").to_string();
    Ok((blob(&manifest["config"])?["config"].take(), name))
}

/// Runs the program with the arguments of a container: paths, ports and hosts are those of this test.
fn runs(program: &Path, arguments: &[String], metrics: &str) -> Result<(), Failed> {
    let (folder, port) = (tempfile::tempdir()?, free_port());
    let local = |argument: &String| {
        let argument = argument.replace("/data", &folder.path().display().to_string());
        let argument = argument.replace(metrics, &format!("127.0.0.1:{port}"));
        // Nobody answers there, which is not the fault of the flag.
        argument.replace("mosquitto:1883", "127.0.0.1:9").replace("$(NAME)", "fleet-7")
    };
    let flags: Vec<String> = arguments.iter().map(local).collect();
    let plc = Plc::run(program, &flags.iter().map(String::as_str).collect::<Vec<_>>())?;
    for _ in 0..100 {
        // A cycle takes 2 ms here.
        if get(port, "/health").is_ok_and(|answer| answer.starts_with("HTTP/1.1 200")) {
            plc.end()?;
            return Ok(());
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    Err(format!("{flags:?}: not healthy, {}", plc.end()?).into())
}

fn check(holds: bool, what: &str) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(what.into()) }
}

pub fn manifests() -> Result<(), Failed> {
    let out = tempfile::tempdir()?;
    let (program, packed) = (out.path().join("station"), out.path().join("fleet.tar"));
    plcc(&["build", "--quiet", "--static"], &[&folder().join("station")], &program)?;
    plcc(&["build", "--quiet", "--emit", "oci"], &[&folder().join("station")], &packed)?;
    let (config, name) = image(&packed)?;
    let name = name.strip_prefix("docker.io/library/").ok_or("no name")?;
    let data = config["WorkingDir"].as_str().ok_or("no folder")?;
    check(!config["Volumes"][data].is_null(), "the working folder is not a volume")?;

    let compose = documents("compose.yaml")?;
    let station = &compose.first().ok_or("no document")?["services"]["station"];
    check(station["image"] == name, "compose.yaml: image")?;
    check(station["volumes"] == serde_json::json!([data]), "compose.yaml: volume")?;
    let given = arguments(&station["command"])?;
    check(Path::new(value_of(&given, "--retain")?).starts_with(data), "compose.yaml: --retain is not in the volume")?;
    runs(&program, &given, value_of(&given, "--metrics")?)?;

    let all = documents("statefulset.yaml")?;
    let of = |kind: &str| all.iter().find(|document| document["kind"] == kind).ok_or_else(|| format!("no {kind}"));
    let (service, set) = (of("Service")?, of("StatefulSet")?);
    check(all.len() == 2, "statefulset.yaml: other documents")?;
    let template = &set["spec"]["template"];
    let labels = &template["metadata"]["labels"];
    check(set["spec"]["serviceName"] == service["metadata"]["name"], "serviceName")?;
    check(set["spec"]["selector"]["matchLabels"] == *labels && service["spec"]["selector"] == *labels, "labels")?;
    let pod = &template["spec"];
    let container = &pod["containers"][0];
    check(container["image"].as_str().is_some_and(|image| image.ends_with(&format!("/{name}"))), "image")?;
    let given = arguments(&container["args"])?;
    let metrics = value_of(&given, "--metrics")?;
    let port = metrics.rsplit(':').next().and_then(|port| port.parse::<u64>().ok()).ok_or("no port")?;
    check(metrics.starts_with("0.0.0.0:"), "probes come from outside of the container")?;
    let ports = &container["ports"][0];
    check(ports["containerPort"] == port && service["spec"]["ports"][0]["port"] == port, "ports")?;
    let scraped = &template["metadata"]["annotations"]["prometheus.io/port"];
    check(*scraped == port, "the port of Prometheus")?;
    for probe in ["readinessProbe", "livenessProbe"] {
        let asked = &container[probe]["httpGet"];
        check(asked["path"] == "/health" && asked["port"] == ports["name"], probe)?;
    }
    let volume = &container["volumeMounts"][0];
    check(volume["name"] == set["spec"]["volumeClaimTemplates"][0]["metadata"]["name"], "the name of the volume")?;
    check(volume["mountPath"] == data && value_of(&given, "--retain")?.starts_with(data), "the volume")?;
    let user = config["User"].as_str().and_then(|user| user.split(':').next()?.parse::<u64>().ok());
    let user = user.ok_or("the image names no user")?;
    let context = &pod["securityContext"];
    check(context["runAsUser"] == user && context["fsGroup"] == user, "the user")?;
    let url = value_of(&given, "--mqtt")?;
    check(url.contains(&format!("$({})", container["env"][0]["name"].as_str().unwrap_or(""))), "the name of the pod")?;
    runs(&program, &given, metrics)
}
