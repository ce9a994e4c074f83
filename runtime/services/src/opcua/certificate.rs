//! The certificate and the key of this server, which it makes itself, and the certificates of clients.
//!
//! | File in the folder | Content |
//! | --- | --- |
//! | `own.der` | the certificate, to be given to clients |
//! | `own.pem` | the private key; only its owner may read it |
//! | `trusted/*.der` | if the folder is there: certificates of the only clients that may come in by a secured channel |

use std::fs;
use std::net::IpAddr;
use std::path::Path;
use std::time::SystemTime;

use rsa::RsaPrivateKey;
use rsa::pkcs8::DecodePrivateKey;
use rsa::traits::PublicKeyParts;

use super::crypto::thumbprint;
use super::status::{self, Status};
pub use crate::certificate::Client;
use crate::certificate::{KEY_BITS, Subject, hold, is_of, make, write_key, write_whole};

/// Certificate and key of this server.
pub struct Own {
    pub key: RsaPrivateKey,
    pub certificate: Vec<u8>,
    pub thumbprint: [u8; 20],
}

impl Own {
    /// Reads them from the folder, or makes them. `Err`: why it cannot.
    pub fn load(folder: &Path, uri: &str, name: &str, ip: IpAddr) -> Result<Own, String> {
        let (key_file, file) = (folder.join("own.pem"), folder.join("own.der"));
        if !key_file.exists() || !file.exists() {
            make_both(folder, uri, name, ip)?;
        }
        let failed = |path: &Path, error: &dyn std::fmt::Display| format!("--opcua: {}: {error}", path.display());
        let text = fs::read_to_string(&key_file).map_err(|error| failed(&key_file, &error))?;
        let key = RsaPrivateKey::from_pkcs8_pem(&text).map_err(|_| failed(&key_file, &"not a private key of RSA"))?;
        let certificate = fs::read(&file).map_err(|error| failed(&file, &error))?;
        match Client::parse(&certificate) {
            Some(found) if found.key == key.to_public_key() && KEY_BITS / 8 == key.size() => {}
            Some(_) | None => return Err(failed(&file, &"not the certificate of a key of 2048 bits in own.pem")),
        }
        if !is_of(&certificate, uri) {
            let file = file.display();
            crate::say(&format!(
                "--opcua: {file} is not the certificate of {uri}, so some clients refuse it: each program needs a folder of its own, \
                 `opcua_folder` in [services]; a new certificate is made if own.der and own.pem are removed"
            ));
        }
        let thumbprint = thumbprint(&certificate);
        Ok(Own { key, certificate, thumbprint })
    }
}

/// Makes key and certificate, unless one of them is there.
fn make_both(folder: &Path, uri: &str, name: &str, ip: IpAddr) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("--opcua: {}: {error}", folder.display());
    let _held = hold(folder).map_err(failed)?;
    let (key_file, file) = (folder.join("own.pem"), folder.join("own.der"));
    if key_file.exists() || file.exists() {
        return Ok(());
    }
    let (key, certificate) =
        make(&Subject { name, uri: Some(uri), hosts: &[], ip }).map_err(|error| format!("--opcua: {error}"))?;
    write_key(&key_file, &key).map_err(failed)?;
    write_whole(&file, &certificate).map_err(failed)
}

/// The clients that may come in.
pub struct Trusted(Vec<Vec<u8>>);

impl Trusted {
    /// `None`: there is no such folder, and every client may come in.
    pub fn load(folder: &Path) -> Result<Option<Trusted>, String> {
        let folder = folder.join("trusted");
        if !folder.exists() {
            return Ok(None);
        }
        let failed = |error: std::io::Error| format!("--opcua: {}: {error}", folder.display());
        let mut list = Vec::new();
        for entry in fs::read_dir(&folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_some_and(|extension| extension == "der") {
                list.push(fs::read(&path).map_err(failed)?);
            }
        }
        Ok(Some(Trusted(list)))
    }

    /// Whether a client may come in at this moment. `Err`: why not.
    pub fn check(&self, client: &Client, moment: SystemTime) -> Result<(), Status> {
        if !self.0.contains(&client.der) {
            return Err(status::CERTIFICATE_UNTRUSTED);
        }
        if client.is_valid_at(moment) { Ok(()) } else { Err(status::CERTIFICATE_TIME_INVALID) }
    }
}
