//! The password that lifts the protection of a CPU: hashes of it, and who tries it.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use argon2::Argon2;
use argon2::password_hash::rand_core::OsRng;
use argon2::password_hash::{PasswordHash, PasswordHasher, PasswordVerifier, SaltString};
use tokio::sync::{Semaphore, SemaphorePermit};

use crate::limits::{GUESSERS_MAX, PASSWORD_PAUSE, WRONG_PASSWORDS_MAX};

/// Characters that a password of an S7 CPU has at most.
pub const CHARACTERS_MAX: usize = 8;

/// The hash of a password for plc.toml. `Err`: why it cannot be one.
pub fn hash(password: &str) -> Result<String, String> {
    let characters = password.len();
    if !(1..=CHARACTERS_MAX).contains(&characters) || !password.bytes().all(|c| c.is_ascii_graphic()) {
        return Err(format!("a password of a CPU has 1 to {CHARACTERS_MAX} letters, digits and signs of ASCII"));
    }
    salted(password)
}

/// Characters that a password of a user of the page has.
pub const USER_CHARACTERS: std::ops::RangeInclusive<usize> = 8..=128;

/// The hash of a user's password for plc.toml. `Err`: why it cannot be one.
pub fn hash_of_user(password: &str) -> Result<String, String> {
    if !USER_CHARACTERS.contains(&password.chars().count()) {
        let (low, high) = (USER_CHARACTERS.start(), USER_CHARACTERS.end());
        return Err(format!("a password of a user has {low} to {high} characters"));
    }
    salted(password)
}

fn salted(password: &str) -> Result<String, String> {
    let salt = SaltString::generate(&mut OsRng);
    let hash = Argon2::default().hash_password(password.as_bytes(), &salt);
    hash.map(|hash| hash.to_string()).map_err(|error| error.to_string())
}

/// Whether a text is a hash that [`hash`] could have made.
pub fn is_hash(text: &str) -> bool {
    PasswordHash::new(text).is_ok_and(|hash| hash.algorithm == argon2::ARGON2ID_IDENT && hash.hash.is_some())
}

/// Whether a password is the one of a hash. It takes some ten milliseconds.
pub fn is_right(password: &[u8], hash: &str) -> bool {
    PasswordHash::new(hash).is_ok_and(|hash| Argon2::default().verify_password(password, &hash).is_ok())
}

/// The permit to check a password of any service: one after the other, since a check takes time and memory on purpose. Many at once
/// would take all the memory of the computer.
pub async fn turn() -> Option<SemaphorePermit<'static>> {
    static TURN: Semaphore = Semaphore::const_new(1);
    TURN.acquire().await.ok()
}

/// Checks the password of S7 clients.
#[derive(Clone)]
pub struct Guard {
    hash: Option<Arc<str>>,
    wrong: Arc<Mutex<HashMap<IpAddr, (u32, Instant)>>>,
}

impl Guard {
    pub fn new(hash: Option<&str>) -> Guard {
        Guard { hash: hash.map(Arc::from), wrong: Arc::default() }
    }

    pub fn has_password(&self) -> bool {
        self.hash.is_some()
    }

    /// Whether it is the password. A computer that was wrong too often waits.
    pub async fn check(&self, from: IpAddr, password: Vec<u8>) -> bool {
        let Some(hash) = self.hash.clone() else { return false };
        // Who was wrong too often waits before it is its turn, so that others do not wait with it.
        let _turn = loop {
            if self.must_wait(from) {
                tokio::time::sleep(PASSWORD_PAUSE).await;
            }
            let Some(turn) = turn().await else { return false };
            // Another connection of this computer may have been wrong meanwhile.
            if !self.must_wait(from) {
                break turn;
            }
        };
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
    fn guessing_delays_nobody_else() {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap();
        runtime.block_on(async {
            let guard = Guard::new(Some(&hash("secret").unwrap()));
            let [one, other] = ["10.0.0.1", "10.0.0.2"].map(|address| address.parse().unwrap());
            for _ in 0..WRONG_PASSWORDS_MAX {
                assert!(!guard.check(one, b"wrong".to_vec()).await);
            }
            let began = Instant::now();
            tokio::select! {
                biased;
                _ = guard.check(one, b"wrong".to_vec()) => panic!("it does not wait"),
                right = guard.check(other, b"secret".to_vec()) => assert!(right),
            }
            assert!(began.elapsed() < PASSWORD_PAUSE);
        });
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
