//! A container image: a tar file in the layout of the Open Container Initiative, whose only layer is the executable.
//!
//! Source: OCI image specification 1.1, image layout, manifest and configuration.

use std::io;

use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use tar::{Builder, EntryType, Header};

/// User and group of the process: an ordinary user.
const USER: u64 = 65_532;
/// Where the process keeps its files; a volume belongs there.
const DATA: &str = "data";
/// The executable in the image.
const PROGRAM: &str = "plc";

/// A part of the image by its content.
struct Blob {
    media_type: &'static str,
    digest: String,
    bytes: Vec<u8>,
}

impl Blob {
    fn new(media_type: &'static str, bytes: Vec<u8>) -> Blob {
        let digest = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        Blob { media_type, digest, bytes }
    }

    fn json(media_type: &'static str, value: &Value) -> Blob {
        Blob::new(media_type, value.to_string().into_bytes())
    }

    fn descriptor(&self) -> Value {
        json!({ "mediaType": self.media_type, "digest": format!("sha256:{}", self.digest), "size": self.bytes.len() })
    }
}

/// The image of an executable that needs nothing but the kernel. `Err`: never, for memory takes everything.
pub fn pack(name: &str, executable: &[u8]) -> io::Result<Vec<u8>> {
    let layer = Blob::new("application/vnd.oci.image.layer.v1.tar", layer(executable)?);
    let architecture = match std::env::consts::ARCH {
        "x86_64" => "amd64",
        "aarch64" => "arm64",
        other => other,
    };
    let (program, data) = (format!("/{PROGRAM}"), format!("/{DATA}"));
    let config = json!({
        "architecture": architecture,
        "os": "linux",
        "config": {
            "User": format!("{USER}:{USER}"),
            "Entrypoint": [program],
            "WorkingDir": data,
            "Volumes": { data.as_str(): {} },
        },
        "rootfs": { "type": "layers", "diff_ids": [format!("sha256:{}", layer.digest)] },
    });
    let config = Blob::json("application/vnd.oci.image.config.v1+json", &config);
    let manifest_type = "application/vnd.oci.image.manifest.v1+json";
    let manifest = json!({
        "schemaVersion": 2,
        "mediaType": manifest_type,
        "config": config.descriptor(),
        "layers": [layer.descriptor()],
    });
    let manifest = Blob::json(manifest_type, &manifest);
    let mut entry = manifest.descriptor();
    // Tools take the name of the image from here.
    entry["annotations"] = json!({
        "org.opencontainers.image.ref.name": "latest",
        "io.containerd.image.name": format!("docker.io/library/{}:latest", image_name(name)),
    });
    let index = json!({
        "schemaVersion": 2,
        "mediaType": "application/vnd.oci.image.index.v1+json",
        "manifests": [entry],
    });
    let mut out = Builder::new(Vec::new());
    add(&mut out, "oci-layout", EntryType::Regular, 0o644, 0, br#"{"imageLayoutVersion":"1.0.0"}"#)?;
    add(&mut out, "index.json", EntryType::Regular, 0o644, 0, index.to_string().as_bytes())?;
    for blob in [&config, &manifest, &layer] {
        add(&mut out, &format!("blobs/sha256/{}", blob.digest), EntryType::Regular, 0o644, 0, &blob.bytes)?;
    }
    out.into_inner()
}

/// The files of the image: the executable, and the folder of its data.
fn layer(executable: &[u8]) -> io::Result<Vec<u8>> {
    let mut out = Builder::new(Vec::new());
    add(&mut out, PROGRAM, EntryType::Regular, 0o755, 0, executable)?;
    add(&mut out, &format!("{DATA}/"), EntryType::Directory, 0o755, USER, &[])?;
    out.into_inner()
}

fn add(out: &mut Builder<Vec<u8>>, name: &str, kind: EntryType, mode: u32, user: u64, bytes: &[u8]) -> io::Result<()> {
    let mut header = Header::new_ustar();
    header.set_entry_type(kind);
    header.set_mode(mode);
    header.set_uid(user);
    header.set_gid(user);
    header.set_mtime(0);
    header.set_size(bytes.len() as u64);
    out.append_data(&mut header, name, bytes)
}

/// The name as registries can have it.
fn image_name(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let text: String = name.chars().map(plain).collect();
    let parts: Vec<&str> = text.split('-').filter(|part| !part.is_empty()).collect();
    if parts.is_empty() { PROGRAM.to_string() } else { parts.join("-") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_registries() {
        assert_eq!(image_name("Water tank__2"), "water-tank-2");
        assert_eq!(image_name("-"), "plc");
    }

    #[test]
    fn the_same_program_is_the_same_image() {
        let image = pack("a", b"program").expect("memory");
        assert_eq!(image, pack("a", b"program").expect("memory"));
        assert_ne!(image, pack("a", b"programs").expect("memory"));
    }
}
