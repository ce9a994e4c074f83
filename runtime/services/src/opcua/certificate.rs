//! The certificate and the key of this server, which it makes itself, and the certificates of clients.
//!
//! | File in the folder | Content |
//! | --- | --- |
//! | `own.der` | the certificate, to be given to clients |
//! | `own.pem` | the private key; only its owner may read it |
//! | `trusted/*.der` | if the folder is there: certificates of the only clients that may come in by a secured channel |

use std::fs;
use std::io::Write;
use std::net::IpAddr;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

use rsa::pkcs1v15::{Signature, SigningKey};
use rsa::pkcs8::{DecodePrivateKey, EncodePrivateKey, LineEnding};
use rsa::rand_core::OsRng;
use rsa::traits::PublicKeyParts;
use rsa::{RsaPrivateKey, RsaPublicKey};
use sha2::Sha256;
use x509_cert::Certificate;
use x509_cert::builder::{Builder, CertificateBuilder, Profile};
use x509_cert::der::asn1::{Ia5String, OctetString};
use x509_cert::der::oid::db::rfc5280::{ID_KP_CLIENT_AUTH, ID_KP_SERVER_AUTH};
use x509_cert::der::{Decode, Encode, SliceReader};
use x509_cert::ext::pkix::name::GeneralName;
use x509_cert::ext::pkix::{BasicConstraints, ExtendedKeyUsage, KeyUsage, KeyUsages, SubjectAltName};
use x509_cert::name::Name;
use x509_cert::serial_number::SerialNumber;
use x509_cert::spki::SubjectPublicKeyInfoOwned;
use x509_cert::spki::der::referenced::OwnedToRef;
use x509_cert::time::Validity;

use super::crypto::{random, thumbprint};

const KEY_BITS: usize = 2048;
/// Bytes of the keys of clients. Source: OPC 10000-7, key lengths of the policies.
const CLIENT_KEY_BYTES: std::ops::RangeInclusive<usize> = 256..=512;
/// Twenty years.
const VALID: Duration = Duration::from_secs(20 * 365 * 24 * 3600);

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
        if !key_file.exists() && !file.exists() {
            make(folder, uri, name, ip)?;
        }
        let failed = |path: &Path, error: &dyn std::fmt::Display| format!("--opcua: {}: {error}", path.display());
        let text = fs::read_to_string(&key_file).map_err(|error| failed(&key_file, &error))?;
        let key = RsaPrivateKey::from_pkcs8_pem(&text).map_err(|_| failed(&key_file, &"not a private key of RSA"))?;
        let certificate = fs::read(&file).map_err(|error| failed(&file, &error))?;
        match Client::parse(&certificate) {
            Some(found) if found.key == key.to_public_key() && KEY_BITS / 8 == key.size() => {}
            Some(_) | None => return Err(failed(&file, &"not the certificate of a key of 2048 bits in own.pem")),
        }
        let thumbprint = thumbprint(&certificate);
        Ok(Own { key, certificate, thumbprint })
    }
}

fn make(folder: &Path, uri: &str, name: &str, ip: IpAddr) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("--opcua: {}: {error}", folder.display());
    let cannot = || "--opcua: the certificate cannot be made".to_string();
    fs::create_dir_all(folder).map_err(failed)?;
    let key = RsaPrivateKey::new(&mut OsRng, KEY_BITS).map_err(|_| cannot())?;
    let certificate = self_signed(&key, uri, name, ip).ok_or_else(cannot)?;
    let pem = key.to_pkcs8_pem(LineEnding::LF).map_err(|_| cannot())?;
    let file = fs::OpenOptions::new().write(true).create_new(true).mode(0o600).open(folder.join("own.pem"));
    file.and_then(|mut file| file.write_all(pem.as_bytes())).map_err(failed)?;
    fs::write(folder.join("own.der"), certificate).map_err(failed)
}

/// Source: OPC 10000-6, section 6.2.2, application instance certificate.
fn self_signed(key: &RsaPrivateKey, uri: &str, name: &str, ip: IpAddr) -> Option<Vec<u8>> {
    let signer = SigningKey::<Sha256>::new(key.clone());
    let serial = SerialNumber::new(&[&[1], &random::<8>()?[..]].concat()).ok()?;
    let subject = Name::from_str(&format!("CN={name},O=plcc")).ok()?;
    let public = SubjectPublicKeyInfoOwned::from_key(key.to_public_key()).ok()?;
    let validity = Validity::from_now(VALID).ok()?;
    let profile = Profile::Manual { issuer: None };
    let mut builder = CertificateBuilder::new(profile, serial, validity, subject, public, &signer).ok()?;
    let address = match ip {
        IpAddr::V4(ip) => ip.octets().to_vec(),
        IpAddr::V6(ip) => ip.octets().to_vec(),
    };
    let names = vec![
        GeneralName::UniformResourceIdentifier(Ia5String::new(uri).ok()?),
        GeneralName::DnsName(Ia5String::new("localhost").ok()?),
        GeneralName::IpAddress(OctetString::new(address).ok()?),
    ];
    builder.add_extension(&SubjectAltName(names)).ok()?;
    builder.add_extension(&BasicConstraints { ca: false, path_len_constraint: None }).ok()?;
    let usage = KeyUsages::DigitalSignature
        | KeyUsages::NonRepudiation
        | KeyUsages::KeyEncipherment
        | KeyUsages::DataEncipherment
        | KeyUsages::KeyCertSign;
    builder.add_extension(&KeyUsage(usage)).ok()?;
    builder.add_extension(&ExtendedKeyUsage(vec![ID_KP_SERVER_AUTH, ID_KP_CLIENT_AUTH])).ok()?;
    builder.build::<Signature>().ok()?.to_der().ok()
}

/// A certificate of a client.
#[derive(Clone)]
pub struct Client {
    pub der: Vec<u8>,
    pub key: RsaPublicKey,
}

impl Client {
    /// The first certificate of a chain.
    pub fn parse(chain: &[u8]) -> Option<Client> {
        let mut reader = SliceReader::new(chain).ok()?;
        let certificate = Certificate::decode(&mut reader).ok()?;
        let length = usize::try_from(certificate.encoded_len().ok()?).ok()?;
        let der = chain.get(..length)?.to_vec();
        let info = certificate.tbs_certificate.subject_public_key_info;
        let key = RsaPublicKey::try_from(info.owned_to_ref()).ok()?;
        CLIENT_KEY_BYTES.contains(&key.size()).then_some(Client { der, key })
    }
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

    pub fn contains(&self, client: &Client) -> bool {
        self.0.contains(&client.der)
    }
}
