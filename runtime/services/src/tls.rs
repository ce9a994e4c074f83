//! TLS: of the page and the metrics, to a broker, and to the page of another process.
//!
//! | File in the folder of the server | Content |
//! | --- | --- |
//! | `certificate.pem` | its certificate, and those between it and a root that clients know |
//! | `key.pem` | the private key |
//!
//! If neither is there, both are made at the start: a certificate that signs itself, for this computer by its name, `localhost` and its address.

use std::fs;
use std::net::IpAddr;
use std::path::Path;
use std::sync::Arc;

use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::client::WebPkiServerVerifier;
use tokio_rustls::rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use tokio_rustls::rustls::crypto::{CryptoProvider, ring};
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName, UnixTime};
use tokio_rustls::rustls::{self, ClientConfig, DigitallySignedStruct, RootCertStore, ServerConfig, SignatureScheme};
use x509_cert::der::pem::{LineEnding, encode_string};

use crate::certificate::{Subject, hold, make, plain_name, write_key, write_whole};
use crate::limits::FRAME_TIME;

/// A connection of a client, with TLS or without.
pub trait Stream: AsyncRead + AsyncWrite + Send + Unpin {}

impl<T: AsyncRead + AsyncWrite + Send + Unpin> Stream for T {}

/// The program of cryptography.
fn provider() -> Arc<CryptoProvider> {
    Arc::new(ring::default_provider())
}

/// What a broker must show, and what this side shows, as flags name the files.
#[derive(Clone, Debug, Default)]
pub struct BrokerFiles<'a> {
    /// Certificates of the authority; `None`: those that this computer knows.
    pub authority: Option<&'a str>,
    pub certificate: Option<&'a str>,
    pub key: Option<&'a str>,
}

impl BrokerFiles<'_> {
    /// The first flag that is given.
    pub fn flag(&self) -> Option<&'static str> {
        let flags = [(self.authority, "--mqtt-ca"), (self.certificate, "--mqtt-certificate"), (self.key, "--mqtt-key")];
        flags.into_iter().find_map(|(file, flag)| file.map(|_| flag))
    }

    /// `Err`: a file is not there or has something else in it.
    pub fn config(&self) -> Result<Arc<ClientConfig>, String> {
        let mut roots = RootCertStore::empty();
        match self.authority {
            Some(file) => {
                for certificate in certificates("--mqtt-ca", Path::new(file))? {
                    roots.add(certificate).map_err(|error| wrong("--mqtt-ca", Path::new(file), &error))?;
                }
            }
            None => {
                roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
                if roots.is_empty() {
                    return Err("--mqtt: this computer knows no authority for certificates: name one with --mqtt-ca \
                                FILE"
                        .to_string());
                }
            }
        }
        let failed = |error: rustls::Error| format!("--mqtt: {error}");
        let builder = ClientConfig::builder_with_provider(provider()).with_safe_default_protocol_versions();
        let builder = builder.map_err(failed)?.with_root_certificates(roots);
        let config = match (self.certificate, self.key) {
            (Some(certificate), Some(key)) => {
                let chain = certificates("--mqtt-certificate", Path::new(certificate))?;
                let key = private_key("--mqtt-key", Path::new(key))?;
                let wrong = |error| wrong("--mqtt-certificate", Path::new(certificate), &error);
                builder.with_client_auth_cert(chain, key).map_err(wrong)?
            }
            (None, None) => builder.with_no_client_auth(),
            (Some(_), None) => return Err("--mqtt-certificate: its private key is missing: add --mqtt-key".to_string()),
            (None, Some(_)) => {
                return Err("--mqtt-key: the certificate of the key is missing: add --mqtt-certificate".to_string());
            }
        };
        Ok(Arc::new(config))
    }
}

fn wrong(flag: &str, path: &Path, error: &dyn std::fmt::Display) -> String {
    format!("{flag}: {}: {error}", path.display())
}

fn certificates(flag: &str, path: &Path) -> Result<Vec<CertificateDer<'static>>, String> {
    let text = fs::read(path).map_err(|error| wrong(flag, path, &error))?;
    let all: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&text).collect();
    let all = all.map_err(|_| wrong(flag, path, &"not certificates in PEM format"))?;
    if all.is_empty() { Err(wrong(flag, path, &"it contains no certificate in PEM format")) } else { Ok(all) }
}

fn private_key(flag: &str, path: &Path) -> Result<PrivateKeyDer<'static>, String> {
    let text = fs::read(path).map_err(|error| wrong(flag, path, &error))?;
    // What is wrong in it is not shown: it may be part of the key.
    PrivateKeyDer::from_pem_slice(&text)
        .map_err(|_| wrong(flag, path, &"it contains no private key in PEM format without a password"))
}

/// The server with the certificate and the key in a folder; makes them if there are none. `name`: of the program. `Err`: why there is none.
pub fn server(folder: &Path, name: &str, ip: IpAddr) -> Result<TlsAcceptor, String> {
    let (certificate, key) = (folder.join("certificate.pem"), folder.join("key.pem"));
    if !certificate.exists() || !key.exists() {
        create(folder, &certificate, &key, name, ip)?;
    }
    let chain = certificates("--tls", &certificate)?;
    let builder = ServerConfig::builder_with_provider(provider()).with_safe_default_protocol_versions();
    let builder = builder.map_err(|error| format!("--tls: {error}"))?.with_no_client_auth();
    let config = builder.with_single_cert(chain, private_key("--tls", &key)?);
    let mut config = config.map_err(|error| wrong("--tls", &certificate, &error))?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(TlsAcceptor::from(Arc::new(config)))
}

/// Makes both files, unless one of them is there.
fn create(folder: &Path, certificate: &Path, key_file: &Path, name: &str, ip: IpAddr) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| wrong("--tls", folder, error);
    let _held = hold(folder).map_err(|error| failed(&error))?;
    if certificate.exists() || key_file.exists() {
        return Ok(());
    }
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let is_name = |host: &&str| {
        !host.is_empty() && host.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'.')
    };
    let hosts: Vec<String> = [host.trim()].into_iter().filter(is_name).map(str::to_string).collect();
    let (key, der) =
        make(&Subject { name: &plain_name(name), uri: None, hosts: &hosts, ip }).map_err(|error| failed(&error))?;
    let pem = encode_string("CERTIFICATE", LineEnding::LF, &der).map_err(|error| failed(&error))?;
    write_key(key_file, &key).map_err(|error| failed(&error))?;
    write_whole(certificate, pem.as_bytes()).map_err(|error| failed(&error))
}

/// What the page of another process must show: the certificate in a file, or one that it has signed. `path` may be a folder with
/// `certificate.pem`. `Err`: what is wrong with the file.
pub fn client(path: &Path) -> Result<Arc<ClientConfig>, String> {
    let file = if path.is_dir() { path.join("certificate.pem") } else { path.to_path_buf() };
    let known = certificates("--tls", &file)?;
    let mut roots = RootCertStore::empty();
    for certificate in &known {
        roots.add(certificate.clone()).map_err(|error| wrong("--tls", &file, &error))?;
    }
    let failed = |error: &dyn std::fmt::Display| wrong("--tls", &file, error);
    let signed = WebPkiServerVerifier::builder_with_provider(Arc::new(roots), provider()).build();
    let verifier = Arc::new(Known { known, signed: signed.map_err(|error| failed(&error))? });
    let builder = ClientConfig::builder_with_provider(provider()).with_safe_default_protocol_versions();
    let builder = builder.map_err(|error| failed(&error))?.dangerous().with_custom_certificate_verifier(verifier);
    Ok(Arc::new(builder.with_no_client_auth()))
}

/// Why a process was not believed, in the words of its user.
pub fn refused(error: &std::io::Error) -> String {
    match error.get_ref().and_then(|inner| inner.downcast_ref::<rustls::Error>()) {
        Some(rustls::Error::InvalidCertificate(_)) => {
            "its certificate is neither that of --tls nor one for this address that it has signed".to_string()
        }
        Some(rustls::Error::InvalidMessage(_)) => "it does not speak TLS: leave out --tls".to_string(),
        _ => error.to_string(),
    }
}

/// A certificate that is known byte by byte may be for any name: that is how a process is trusted that was opened for all its addresses.
/// The process that shows it must have its key all the same. Other certificates must be signed by a known one, and be for the address.
#[derive(Debug)]
struct Known {
    known: Vec<CertificateDer<'static>>,
    signed: Arc<WebPkiServerVerifier>,
}

impl ServerCertVerifier for Known {
    fn verify_server_cert(
        &self,
        end_entity: &CertificateDer<'_>,
        intermediates: &[CertificateDer<'_>],
        server_name: &ServerName<'_>,
        ocsp_response: &[u8],
        now: UnixTime,
    ) -> Result<ServerCertVerified, rustls::Error> {
        if self.known.iter().any(|known| known == end_entity) {
            return Ok(ServerCertVerified::assertion());
        }
        self.signed.verify_server_cert(end_entity, intermediates, server_name, ocsp_response, now)
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        self.signed.verify_tls12_signature(message, certificate, signature)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        self.signed.verify_tls13_signature(message, certificate, signature)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.signed.supported_verify_schemes()
    }
}

/// The connection of a client that has come in. `None`: it does not speak TLS, or is too slow.
pub async fn open(acceptor: Option<&TlsAcceptor>, stream: TcpStream) -> Option<Box<dyn Stream>> {
    match acceptor {
        None => Some(Box::new(stream)),
        Some(acceptor) => Some(Box::new(timeout(FRAME_TIME, acceptor.accept(stream)).await.ok()?.ok()?)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    #[test]
    fn a_certificate_is_made_once() {
        let folder = std::env::temp_dir().join(format!("plcc-tls-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        let start = || server(&folder, "plant 1, Süd", IpAddr::V4(Ipv4Addr::LOCALHOST)).map(|_| ());
        let read = |name: &str| fs::read(folder.join(name)).unwrap();
        // Programs that start at once have the same one.
        std::thread::scope(|scope| {
            for started in [scope.spawn(start), scope.spawn(start)] {
                started.join().unwrap().unwrap();
            }
        });
        let (certificate, key) = (read("certificate.pem"), read("key.pem"));
        start().unwrap();
        assert_eq!((read("certificate.pem"), read("key.pem")), (certificate, key));
        fs::write(folder.join("key.pem"), "secret").unwrap();
        let message = start().unwrap_err();
        assert!(message.contains("key.pem: it contains no private key") && !message.contains("secret"), "{message}");
        fs::remove_file(folder.join("certificate.pem")).unwrap();
        assert!(start().unwrap_err().contains("certificate.pem"), "a key alone is not replaced");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn certificate_and_key_belong_together() {
        let files = BrokerFiles { certificate: Some("a"), ..BrokerFiles::default() };
        assert_eq!(files.flag(), Some("--mqtt-certificate"));
        let none = BrokerFiles { authority: Some("/no/such/file"), ..BrokerFiles::default() };
        assert!(none.config().unwrap_err().starts_with("--mqtt-ca: /no/such/file: "));
    }
}
