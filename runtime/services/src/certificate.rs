//! Certificates with keys that this side makes itself, and what certificates of others say.

use std::fs;
use std::io::Write;
use std::net::IpAddr;
use std::ops::RangeInclusive;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::str::FromStr;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use rsa::pkcs1v15::{Signature, SigningKey};
use rsa::pkcs8::{EncodePrivateKey, LineEnding};
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

use crate::opcua::crypto::random;

/// Of a key that is made here.
pub const KEY_BITS: usize = 2048;
/// Bytes of the keys of clients. Source: OPC 10000-7, key lengths of the policies.
const CLIENT_KEY_BYTES: RangeInclusive<usize> = 256..=512;
/// Twenty years.
const VALID: Duration = Duration::from_secs(20 * 365 * 24 * 3600);

/// The name of a program as it can be in certificates and addresses.
pub fn plain_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '-' }).take(64).collect()
}

/// Whom a certificate is for.
pub struct Subject<'a> {
    /// Common name, a [`plain_name`].
    pub name: &'a str,
    /// Name of an application of OPC UA.
    pub uri: Option<&'a str>,
    /// Names of this computer besides `localhost`.
    pub hosts: &'a [String],
    pub ip: IpAddr,
}

/// A new key, and a certificate for it that it signs itself: in the form DER. `Err`: this cannot be done.
pub fn make(subject: &Subject) -> Result<(RsaPrivateKey, Vec<u8>), String> {
    let cannot = || "the certificate cannot be made".to_string();
    let key = RsaPrivateKey::new(&mut OsRng, KEY_BITS).map_err(|_| cannot())?;
    let certificate = self_signed(&key, subject).ok_or_else(cannot)?;
    Ok((key, certificate))
}

/// The folder for a new key and its certificate, which is made if it is not there. Other processes that hold it wait until the result is
/// dropped: programs that start at once in one folder make one certificate.
pub fn hold(folder: &Path) -> std::io::Result<fs::File> {
    fs::create_dir_all(folder)?;
    let held = fs::File::open(folder)?;
    // Without it only programs that start at once could disturb each other: a file system may have no locks.
    let _ = held.lock();
    Ok(held)
}

/// Writes a file that is there as a whole or not at all.
pub fn write_whole(path: &Path, content: &[u8]) -> std::io::Result<()> {
    let new = path.with_extension("new");
    fs::write(&new, content)?;
    fs::rename(new, path)
}

/// Writes a private key to a new file, which only its owner may read.
pub fn write_key(path: &Path, key: &RsaPrivateKey) -> std::io::Result<()> {
    let pem = key.to_pkcs8_pem(LineEnding::LF).map_err(|error| std::io::Error::other(error.to_string()))?;
    let mut file = fs::OpenOptions::new().write(true).create_new(true).mode(0o600).open(path)?;
    file.write_all(pem.as_bytes())
}

/// Source: OPC 10000-6, section 6.2.2, application instance certificate.
fn self_signed(key: &RsaPrivateKey, subject: &Subject) -> Option<Vec<u8>> {
    let signer = SigningKey::<Sha256>::new(key.clone());
    let serial = SerialNumber::new(&[&[1], &random::<8>()?[..]].concat()).ok()?;
    let name = Name::from_str(&format!("CN={},O=plcc", subject.name)).ok()?;
    let public = SubjectPublicKeyInfoOwned::from_key(key.to_public_key()).ok()?;
    let validity = Validity::from_now(VALID).ok()?;
    let profile = Profile::Manual { issuer: None };
    let mut builder = CertificateBuilder::new(profile, serial, validity, name, public, &signer).ok()?;
    let address = match subject.ip {
        IpAddr::V4(ip) => ip.octets().to_vec(),
        IpAddr::V6(ip) => ip.octets().to_vec(),
    };
    let uri = subject.uri.map(|uri| Ia5String::new(uri).map(GeneralName::UniformResourceIdentifier));
    let hosts = ["localhost"].into_iter().chain(subject.hosts.iter().map(String::as_str));
    let hosts = hosts.map(|host| Ia5String::new(host).map(GeneralName::DnsName));
    let mut names = uri.into_iter().chain(hosts).collect::<Result<Vec<_>, _>>().ok()?;
    names.push(GeneralName::IpAddress(OctetString::new(address).ok()?));
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

/// Whether a certificate, the first one of a chain, is for the application of OPC UA with this name.
pub fn is_of(chain: &[u8], uri: &str) -> bool {
    let certificate = SliceReader::new(chain).and_then(|mut reader| Certificate::decode(&mut reader));
    let Ok(certificate) = certificate else { return false };
    let Ok(Some((_, SubjectAltName(names)))) = certificate.tbs_certificate.get::<SubjectAltName>() else {
        return false;
    };
    names.iter().any(|name| match name {
        GeneralName::UniformResourceIdentifier(own) => AsRef::<str>::as_ref(own) == uri,
        _ => false,
    })
}

/// A certificate of somebody else.
#[derive(Clone)]
pub struct Client {
    pub der: Vec<u8>,
    pub key: RsaPublicKey,
    /// From when to when, since 1970.
    pub valid: RangeInclusive<Duration>,
}

impl Client {
    /// The first certificate of a chain.
    pub fn parse(chain: &[u8]) -> Option<Client> {
        let mut reader = SliceReader::new(chain).ok()?;
        let certificate = Certificate::decode(&mut reader).ok()?;
        let length = usize::try_from(certificate.encoded_len().ok()?).ok()?;
        let der = chain.get(..length)?.to_vec();
        let content = certificate.tbs_certificate;
        let key = RsaPublicKey::try_from(content.subject_public_key_info.owned_to_ref()).ok()?;
        let Validity { not_before, not_after } = content.validity;
        let valid = not_before.to_unix_duration()..=not_after.to_unix_duration();
        CLIENT_KEY_BYTES.contains(&key.size()).then_some(Client { der, key, valid })
    }

    /// Whether it has begun to be valid, and has not expired.
    pub fn is_valid_at(&self, moment: SystemTime) -> bool {
        moment.duration_since(UNIX_EPOCH).is_ok_and(|since| self.valid.contains(&since))
    }
}
