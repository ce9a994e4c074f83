//! Who may do what on the page.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use plcc_abi::services::{Role, User};

use crate::limits::{SESSION_TIME, SESSIONS_MAX};
use crate::password;

/// All users and those who are signed in. Without users everyone may look.
#[derive(Clone, Default)]
pub struct Users {
    users: Arc<[User]>,
    sessions: Arc<Mutex<HashMap<String, Session>>>,
}

/// What somebody may do.
#[derive(Clone, Copy, Debug)]
pub struct May {
    /// By the role of the user.
    pub role: Role,
    /// At most, by the right of the computer.
    pub most: Role,
}

impl May {
    /// What both allow.
    pub fn role(self) -> Role {
        self.role.min(self.most)
    }

    /// The computer may do less than the user.
    pub fn is_limited(self) -> bool {
        self.most < self.role
    }

    /// Whether it is as much as `needed`. `Err`: why not.
    pub fn check(self, needed: Role) -> Result<(), &'static str> {
        match (self.role >= needed, self.most >= needed, needed) {
            (true, true, _) => Ok(()),
            (true, false, Role::Change) => {
                Err("clients need the right `control` for this: `access` in plc.toml and --access say what they may do")
            }
            (true, false, Role::Operate | Role::Look) => {
                Err("clients need the right `write` for this: `access` in plc.toml and --access say what they may do")
            }
            (false, _, Role::Change) => Err("only a user with the role `change` may do this"),
            (false, _, Role::Operate | Role::Look) => {
                Err("only a user with the role `operate` or `change` may do this")
            }
        }
    }
}

struct Session {
    user: usize,
    until: Instant,
}

/// The hash of a password that no user has.
pub(super) const NOBODY: &str =
    "$argon2id$v=19$m=19456,t=2,p=1$c29tZXNhbHRzb21lc2FsdA$3mB0uVJ8ZkqjZ2TgzrPfQH9aZ1sXy0B1tW1vJtVn2nE";
impl Users {
    pub fn new(users: &[User]) -> Users {
        Users { users: users.into(), sessions: Arc::default() }
    }

    /// Signing in is not necessary.
    pub fn is_open(&self) -> bool {
        self.users.is_empty()
    }

    /// Checks a password, which takes some ten milliseconds. Result: the number of the user.
    pub fn check(&self, name: &str, password: &str) -> Option<usize> {
        let user = self.users.iter().position(|user| user.name == name);
        // A name that does not exist takes as long as a wrong password.
        let hash = user.map_or(NOBODY, |user| &self.users[user].password);
        let is_right = password::is_right(password.as_bytes(), hash);
        user.filter(|_| is_right)
    }

    /// The role of the user with a number.
    pub fn role(&self, user: usize) -> Role {
        self.users[user].role
    }

    /// Checks a password as [`check`](Users::check). Result: the token of a new session.
    pub fn sign_in(&self, name: &str, password: &str) -> Option<String> {
        let user = self.check(name, password)?;
        let mut bytes = [0; 24];
        getrandom::fill(&mut bytes).ok()?;
        let token: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let mut sessions = self.sessions.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        sessions.retain(|_, session| session.until > now);
        if sessions.len() >= SESSIONS_MAX
            && let Some(oldest) =
                sessions.iter().min_by_key(|(_, session)| session.until).map(|(token, _)| token.clone())
        {
            sessions.remove(&oldest);
        }
        sessions.insert(token.clone(), Session { user, until: now + SESSION_TIME });
        Some(token)
    }

    /// Who a token belongs to; without users, someone who may look. `None`: sign in first.
    pub fn of(&self, token: Option<&str>) -> Option<(String, Role)> {
        if self.is_open() {
            return Some((String::new(), Role::Look));
        }
        let mut sessions = self.sessions.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        let session = sessions.get_mut(token?).filter(|session| session.until > now)?;
        session.until = now + SESSION_TIME;
        let user = &self.users[session.user];
        Some((user.name.clone(), user.role))
    }

    pub fn sign_out(&self, token: &str) {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner).remove(token);
    }
}
