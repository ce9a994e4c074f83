//! Users and their sessions.

use argon2::Argon2;
use argon2::password_hash::{PasswordHash, PasswordHasher, SaltString};

use super::users::NOBODY;
use super::{Role, User, Users};

fn user(name: &str, password: &str, role: Role) -> User {
    let salt = SaltString::encode_b64(b"a salt of tests").expect("a salt has 4 to 64 bytes");
    let hash = Argon2::default().hash_password(password.as_bytes(), &salt).expect("the salt is one");
    User { name: name.to_string(), hash: hash.to_string(), role }
}

#[test]
fn without_users_everyone_may_look() {
    let users = Users::default();
    assert!(users.is_open());
    assert_eq!(users.of(None), Some((String::new(), Role::Look)));
    assert_eq!(users.of(Some("0123")), Some((String::new(), Role::Look)));
    assert_eq!(users.sign_in("", ""), None);
}

#[test]
fn a_token_belongs_to_who_has_signed_in_until_the_session_ends() {
    let users = Users::new(vec![user("anna", "river", Role::Change), user("ben", "hill", Role::Operate)]);
    assert_eq!(users.of(None), None);
    assert_eq!(users.of(Some("0123")), None);
    assert_eq!(users.sign_in("anna", "hill"), None);
    assert_eq!(users.sign_in("carl", "hill"), None);
    let token = users.sign_in("ben", "hill").expect("name and password are right");
    assert_eq!(users.of(Some(&token)), Some(("ben".to_string(), Role::Operate)));
    users.sign_out(&token);
    assert_eq!(users.of(Some(&token)), None);
}

#[test]
fn a_hash_that_is_none_lets_nobody_in() {
    let users = Users::new(vec![User { name: "anna".to_string(), hash: "river".to_string(), role: Role::Look }]);
    assert_eq!(users.sign_in("anna", "river"), None);
}

#[test]
fn a_name_that_does_not_exist_is_checked_as_long_as_another() {
    assert!(PasswordHash::new(NOBODY).is_ok_and(|hash| hash.hash.is_some()));
}
