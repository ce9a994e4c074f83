//! Security policies: signatures, encryption and keys. Source: OPC 10000-7, security policies; OPC 10000-6, section 6.7.

use aes::cipher::block_padding::NoPadding;
use aes::cipher::{BlockDecryptMut, BlockEncryptMut, KeyIvInit};
use aes::{Aes128, Aes256};
use hmac::{Hmac, Mac};
use rsa::rand_core::OsRng;
use rsa::traits::PublicKeyParts;
use rsa::{Oaep, Pkcs1v15Sign, Pss, RsaPrivateKey, RsaPublicKey};
use sha1::Sha1;
use sha2::{Digest, Sha256};

/// How messages of a channel are secured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    None,
    Basic256Sha256,
    Aes128Sha256RsaOaep,
    Aes256Sha256RsaPss,
}

/// Bytes of a nonce, of a signature by a shared key, and of a block of AES.
pub const NONCE_BYTES: usize = 32;
pub const MAC_BYTES: usize = 32;
pub const BLOCK_BYTES: usize = 16;

/// Encryption of passwords by OAEP with SHA-1, and with SHA-256.
const OAEP: &str = "http://www.w3.org/2001/04/xmlenc#rsa-oaep";
const OAEP_SHA256: &str = "http://opcfoundation.org/UA/security/rsa-oaep-sha2-256";

impl Policy {
    pub const ALL: [Policy; 4] =
        [Policy::None, Policy::Basic256Sha256, Policy::Aes128Sha256RsaOaep, Policy::Aes256Sha256RsaPss];

    pub fn uri(self) -> &'static str {
        match self {
            Policy::None => "http://opcfoundation.org/UA/SecurityPolicy#None",
            Policy::Basic256Sha256 => "http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256",
            Policy::Aes128Sha256RsaOaep => "http://opcfoundation.org/UA/SecurityPolicy#Aes128_Sha256_RsaOaep",
            Policy::Aes256Sha256RsaPss => "http://opcfoundation.org/UA/SecurityPolicy#Aes256_Sha256_RsaPss",
        }
    }

    pub fn from_uri(uri: &[u8]) -> Option<Policy> {
        Policy::ALL.into_iter().find(|policy| policy.uri().as_bytes() == uri)
    }

    /// The algorithm of its signatures.
    pub fn signature_uri(self) -> &'static str {
        match self {
            Policy::None => "",
            Policy::Basic256Sha256 | Policy::Aes128Sha256RsaOaep => "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256",
            Policy::Aes256Sha256RsaPss => "http://opcfoundation.org/UA/security/rsa-pss-sha2-256",
        }
    }

    /// Bytes of the shared key for AES.
    fn key_bytes(self) -> usize {
        match self {
            Policy::None => 0,
            Policy::Aes128Sha256RsaOaep => 16,
            Policy::Basic256Sha256 | Policy::Aes256Sha256RsaPss => 32,
        }
    }

    /// Bytes that a block of RSA has besides its content.
    fn oaep_bytes(self) -> usize {
        if self == Policy::Aes256Sha256RsaPss { 66 } else { 42 }
    }

    pub fn sign(self, key: &RsaPrivateKey, data: &[u8]) -> Option<Vec<u8>> {
        let digest = Sha256::digest(data);
        let signed = match self {
            Policy::Aes256Sha256RsaPss => key.sign_with_rng(&mut OsRng, Pss::new::<Sha256>(), &digest),
            _ => key.sign_with_rng(&mut OsRng, Pkcs1v15Sign::new::<Sha256>(), &digest),
        };
        signed.ok()
    }

    pub fn is_signed(self, key: &RsaPublicKey, data: &[u8], signature: &[u8]) -> bool {
        let digest = Sha256::digest(data);
        let checked = match self {
            Policy::Aes256Sha256RsaPss => key.verify(Pss::new::<Sha256>(), &digest, signature),
            _ => key.verify(Pkcs1v15Sign::new::<Sha256>(), &digest, signature),
        };
        checked.is_ok()
    }

    /// Bytes of content that a block of RSA takes.
    pub fn block_content(self, key: &RsaPublicKey) -> usize {
        key.size().saturating_sub(self.oaep_bytes()).max(1)
    }

    pub fn encrypt(self, key: &RsaPublicKey, data: &[u8]) -> Option<Vec<u8>> {
        let mut out = Vec::new();
        for block in data.chunks(self.block_content(key)) {
            let encrypted = match self {
                Policy::Aes256Sha256RsaPss => key.encrypt(&mut OsRng, Oaep::new::<Sha256>(), block),
                _ => key.encrypt(&mut OsRng, Oaep::new::<Sha1>(), block),
            };
            out.extend(encrypted.ok()?);
        }
        Some(out)
    }

    pub fn decrypt(self, key: &RsaPrivateKey, data: &[u8]) -> Option<Vec<u8>> {
        decrypt(key, data, self == Policy::Aes256Sha256RsaPss)
    }
}

fn decrypt(key: &RsaPrivateKey, data: &[u8], sha256: bool) -> Option<Vec<u8>> {
    if data.is_empty() || !data.len().is_multiple_of(key.size()) {
        return None;
    }
    let mut out = Vec::new();
    for block in data.chunks(key.size()) {
        let padding = if sha256 { Oaep::new::<Sha256>() } else { Oaep::new::<Sha1>() };
        out.extend(key.decrypt_blinded(&mut OsRng, padding, block).ok()?);
    }
    Some(out)
}

/// A password that was encrypted by an algorithm.
pub fn decrypt_password(algorithm: &str, key: &RsaPrivateKey, data: &[u8]) -> Option<Vec<u8>> {
    match algorithm {
        OAEP => decrypt(key, data, false),
        OAEP_SHA256 => decrypt(key, data, true),
        _ => None,
    }
}

/// SHA-1 of a certificate, its name in messages.
pub fn thumbprint(certificate: &[u8]) -> [u8; 20] {
    Sha1::digest(certificate).into()
}

/// Random bytes.
pub fn random<const N: usize>() -> Option<[u8; N]> {
    let mut bytes = [0; N];
    getrandom::fill(&mut bytes).ok()?;
    Some(bytes)
}

/// Shared keys of one direction.
#[derive(Clone)]
pub struct Keys {
    mac: Vec<u8>,
    key: Vec<u8>,
    iv: Vec<u8>,
}

impl Keys {
    /// From the nonces of both sides. Source: OPC 10000-6, section 6.7.5.
    pub fn new(policy: Policy, secret: &[u8], seed: &[u8]) -> Keys {
        let mut bytes = Vec::new();
        let mut a = mac(secret, &[seed]);
        while bytes.len() < MAC_BYTES + policy.key_bytes() + BLOCK_BYTES {
            bytes.extend(mac(secret, &[&a, seed]));
            a = mac(secret, &[&a]);
        }
        let (own, rest) = bytes.split_at(MAC_BYTES);
        let (key, rest) = rest.split_at(policy.key_bytes());
        Keys { mac: own.to_vec(), key: key.to_vec(), iv: rest[..BLOCK_BYTES].to_vec() }
    }

    pub fn mac(&self, data: &[u8]) -> Vec<u8> {
        mac(&self.mac, &[data])
    }

    pub fn is_mac(&self, data: &[u8], signature: &[u8]) -> bool {
        Hmac::<Sha256>::new_from_slice(&self.mac)
            .is_ok_and(|mac| mac.chain_update(data).verify_slice(signature).is_ok())
    }

    /// In place; whole blocks.
    pub fn encrypt(&self, data: &mut [u8]) -> Option<()> {
        let length = data.len();
        match self.key.len() {
            16 => {
                let cipher = cbc::Encryptor::<Aes128>::new_from_slices(&self.key, &self.iv).ok()?;
                cipher.encrypt_padded_mut::<NoPadding>(data, length).ok().map(|_| ())
            }
            _ => {
                let cipher = cbc::Encryptor::<Aes256>::new_from_slices(&self.key, &self.iv).ok()?;
                cipher.encrypt_padded_mut::<NoPadding>(data, length).ok().map(|_| ())
            }
        }
    }

    pub fn decrypt(&self, data: &mut [u8]) -> Option<()> {
        match self.key.len() {
            16 => {
                let cipher = cbc::Decryptor::<Aes128>::new_from_slices(&self.key, &self.iv).ok()?;
                cipher.decrypt_padded_mut::<NoPadding>(data).ok().map(|_| ())
            }
            _ => {
                let cipher = cbc::Decryptor::<Aes256>::new_from_slices(&self.key, &self.iv).ok()?;
                cipher.decrypt_padded_mut::<NoPadding>(data).ok().map(|_| ())
            }
        }
    }
}

fn mac(key: &[u8], parts: &[&[u8]]) -> Vec<u8> {
    // A key of any length is a key of HMAC.
    let Ok(mut mac) = Hmac::<Sha256>::new_from_slice(key) else { return vec![0; MAC_BYTES] };
    parts.iter().for_each(|part| mac.update(part));
    mac.finalize().into_bytes().to_vec()
}
