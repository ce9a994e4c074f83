//! What this server offers, and who signs in.

use plcc_abi::services::{Right, Role};
use std::sync::Arc;

use super::Server;
use super::channel::Mode;
use super::code::{Reader, Writer};
use super::crypto::{Policy, decrypt_password};
use super::status::{self, Status};
use crate::limits::{OPCUA_URL_MAX, WRONG_PASSWORD_PAUSE};

const ANONYMOUS: &str = "anonymous";
const USER: &str = "user";
const TRANSPORT: &str = "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
/// Numbers of the encodings of tokens.
const ANONYMOUS_TOKEN: u32 = 321;
const USER_TOKEN: u32 = 324;

/// ApplicationDescription.
fn put_application(server: &Server, out: &mut Writer, url: &str) {
    out.text(&server.uri);
    out.text("urn:plcc");
    out.localized(&server.name);
    out.u32(0);
    out.null();
    out.null();
    out.list(&[url], |out, url| out.text(url));
}

/// The address as a client has written it: it may see this computer by another name.
fn url_for(server: &Server, asked: &str) -> String {
    match asked.starts_with("opc.tcp://") && asked.len() <= OPCUA_URL_MAX {
        true => asked.to_string(),
        false => format!("opc.tcp://{}", server.address),
    }
}

/// The servers at this address: this one.
pub fn put_servers(server: &Server, out: &mut Writer, url: &str) {
    out.u32(1);
    put_application(server, out, &url_for(server, url));
}

/// What clients can choose from, the most secure one first.
pub fn put_endpoints(server: &Server, out: &mut Writer, url: &str) {
    let url = url_for(server, url);
    let mut offers: Vec<(Policy, Mode, u8)> = Vec::new();
    for (policy, level) in
        [(Policy::Aes256Sha256RsaPss, 6), (Policy::Basic256Sha256, 4), (Policy::Aes128Sha256RsaOaep, 2)]
    {
        offers.push((policy, Mode::SignAndEncrypt, level + 1));
        offers.push((policy, Mode::Sign, level));
    }
    if server.is_open {
        offers.push((Policy::None, Mode::None, 0));
    }
    out.list(&offers, |out, (policy, mode, level)| {
        out.text(&url);
        put_application(server, out, &url);
        out.bytes(&server.own.certificate);
        out.i32(mode.number());
        out.text(policy.uri());
        let is_open = server.users.is_open();
        let tokens: &[(&str, u32)] = match (is_open, server.anonymous) {
            (true, None) => &[],
            (true, Some(_)) => &[(ANONYMOUS, 0)],
            (false, _) => &[(USER, 1)],
        };
        out.list(tokens, |out, (id, kind)| {
            out.text(id);
            out.u32(*kind);
            out.null();
            out.null();
            // A password is always encrypted.
            match (*policy, *kind) {
                (Policy::None, 1) => out.text(Policy::Basic256Sha256.uri()),
                _ => out.null(),
            }
        });
        out.text(TRANSPORT);
        out.u8(*level);
    });
}

/// What somebody who signs in may do. `right`: what this computer may do.
pub async fn sign_in(server: &Arc<Server>, token: (u32, &[u8]), nonce: &[u8], right: Right) -> Result<Right, Status> {
    let mut reader = Reader(token.1);
    match token.0 {
        // No token at all is an anonymous one.
        0 | ANONYMOUS_TOKEN => {
            let most = server.anonymous.filter(|_| server.users.is_open()).ok_or(status::IDENTITY_REJECTED)?;
            Ok(right.min(most))
        }
        USER_TOKEN => {
            let read = || Some((reader.text()?, reader.text()?, reader.bytes()?.to_vec(), reader.text()?));
            let mut read = read;
            let (policy, name, secret, algorithm) = read().ok_or(status::IDENTITY_INVALID)?;
            if policy != USER || server.users.is_open() {
                return Err(status::IDENTITY_INVALID);
            }
            let (own, nonce) = (server.clone(), nonce.to_vec());
            let turns = (server.one.acquire().await, crate::password::turn().await);
            let (Ok(_), Some(_)) = &turns else { return Err(status::SHUTDOWN) };
            let checked = tokio::task::spawn_blocking(move || {
                let password = password(&own, &algorithm, &secret, &nonce)?;
                Some(own.users.check(&name, &password).map(|user| own.users.role(user)))
            });
            let checked = checked.await.map_err(|_| status::INTERNAL)?;
            // Others need not wait for who was wrong.
            drop(turns);
            match checked {
                Some(Some(Role::Look)) => Ok(right.min(Right::Read)),
                Some(Some(Role::Operate)) => Ok(right.min(Right::Write)),
                Some(Some(Role::Change)) => Ok(right),
                Some(None) => {
                    tokio::time::sleep(WRONG_PASSWORD_PAUSE).await;
                    Err(status::USER_ACCESS_DENIED)
                }
                None => Err(status::IDENTITY_INVALID),
            }
        }
        _ => Err(status::IDENTITY_INVALID),
    }
}

/// Source: OPC 10000-4, section 7.40.2.2, legacy encrypted token secret.
fn password(server: &Server, algorithm: &str, secret: &[u8], nonce: &[u8]) -> Option<String> {
    let plain = decrypt_password(algorithm, &server.own.key, secret)?;
    let mut reader = Reader(&plain);
    let length = usize::try_from(reader.u32()?).ok()?;
    let content = reader.take(length)?;
    let password = content.strip_suffix(nonce)?;
    std::str::from_utf8(password).ok().map(str::to_string)
}
