//! The password that lifts the protection of a CPU: hashes of it, and who tries it.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use argon2::Argon2;
use argon2::password_hash::rand_core::OsRng;
use argon2::password_hash::{PasswordHash, PasswordHasher, PasswordVerifier, SaltString};
use tokio::sync::Semaphore;

use crate::limits::{GUESSERS_MAX, PASSWORD_PAUSE, WRONG_PASSWORDS_MAX};

/// Characters that a password of an S7 CPU has at most.
pub const CHARACTERS_MAX: usize = 8;

/// The hash of a password for plc.toml. `Err`: why it cannot be one.
pub fn hash(password: &str) -> Result<String, String> {
    let characters = password.len();
    if !(1..=CHARACTERS_MAX).contains(&characters) || !password.bytes().all(|c| c.is_ascii_graphic()) {
        return Err(format!("a password of a CPU has 1 to {CHARACTERS_MAX} letters, digits and signs of ASCII"));
    }
    let salt = SaltString::generate(&mut OsRng);
    let hash = Argon2::default().hash_password(password.as_bytes(), &salt);
    hash.map(|hash| hash.to_string()).map_err(|error| error.to_string())
}

/// Whether a text is a hash that [`hash`] could have made.
pub fn is_hash(text: &str) -> bool {
    PasswordHash::new(text).is_ok_and(|hash| hash.algorithm == argon2::ARGON2ID_IDENT && hash.hash.is_some())
}

fn is_right(password: &[u8], hash: &str) -> bool {
    PasswordHash::new(hash).is_ok_and(|hash| Argon2::default().verify_password(password, &hash).is_ok())
}

/// Checks passwords, one after the other: that takes time and memory on purpose.
#[derive(Clone)]
pub struct Guard {
    hash: Option<Arc<str>>,
    wrong: Arc<Mutex<HashMap<IpAddr, (u32, Instant)>>>,
    one: Arc<Semaphore>,
}

impl Guard {
    pub fn new(hash: Option<&str>) -> Guard {
        Guard { hash: hash.map(Arc::from), wrong: Arc::default(), one: Arc::new(Semaphore::new(1)) }
    }

    pub fn has_password(&self) -> bool {
        self.hash.is_some()
    }

    /// Whether it is the password. A computer that was wrong too often waits.
    pub async fn check(&self, from: IpAddr, password: Vec<u8>) -> bool {
        let Some(hash) = self.hash.clone() else { return false };
        let Ok(_turn) = self.one.acquire().await else { return false };
        if self.must_wait(from) {
            tokio::time::sleep(PASSWORD_PAUSE).await;
        }
        let right = tokio::task::spawn_blocking(move || is_right(&password, &hash)).await.unwrap_or(false);
        let mut wrong = self.wrong.lock().unwrap_or_else(PoisonError::into_inner);
        if right {
            wrong.remove(&from);
        } else {
            if wrong.len() >= GUESSERS_MAX {
                wrong.retain(|_, (_, last)| last.elapsed() < PASSWORD_PAUSE);
            }
            let (count, last) = wrong.entry(from).or_insert((0, Instant::now()));
            (*count, *last) = (count.saturating_add(1), Instant::now());
        }
        right
    }

    fn must_wait(&self, from: IpAddr) -> bool {
        let wrong = self.wrong.lock().unwrap_or_else(PoisonError::into_inner);
        wrong.get(&from).is_some_and(|(count, last)| *count >= WRONG_PASSWORDS_MAX && last.elapsed() < PASSWORD_PAUSE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_knows_its_password() {
        let one = hash("secret").unwrap();
        assert!(one.starts_with("$argon2id$") && is_hash(&one));
        assert!(is_right(b"secret", &one) && !is_right(b"Secret", &one) && !is_right(b"", &one));
        // Each has a salt of its own.
        assert_ne!(one, hash("secret").unwrap());
    }

    #[test]
    fn what_is_no_password_has_no_hash() {
        for text in ["", "123456789", "a b", "äöü"] {
            assert!(hash(text).is_err(), "{text}");
        }
        for text in ["secret", "", "$argon2id$", "$1$salt$hash"] {
            assert!(!is_hash(text), "{text}");
        }
    }
}
