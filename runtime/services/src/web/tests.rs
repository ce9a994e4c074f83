//! Users and their sessions.

use plcc_abi::services::{Role, User};

use super::messages::exact;
use super::users::{May, NOBODY, Users};
use crate::password;

fn user(name: &str, text: &str, role: Role) -> User {
    User { name: name.to_string(), role, password: password::hash_of_user(text).expect("it is long enough") }
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
    let users = Users::new(&[user("anna", "riverside", Role::Change), user("ben", "hillside", Role::Operate)]);
    assert_eq!(users.of(None), None);
    assert_eq!(users.of(Some("0123")), None);
    assert_eq!(users.sign_in("anna", "hillside"), None);
    assert_eq!(users.sign_in("carl", "hillside"), None);
    let token = users.sign_in("ben", "hillside").expect("name and password are right");
    assert_eq!(users.of(Some(&token)), Some(("ben".to_string(), Role::Operate)));
    users.sign_out(&token);
    assert_eq!(users.of(Some(&token)), None);
}

#[test]
fn user_and_computer_are_both_allowed_what_is_done() {
    let check = |role, most| May { role, most }.check(Role::Change);
    assert_eq!(check(Role::Change, Role::Change), Ok(()));
    assert!(check(Role::Change, Role::Operate).is_err_and(|why| why.contains("the right `control`")));
    assert!(check(Role::Operate, Role::Change).is_err_and(|why| why.contains("the role `change`")));
    let may = May { role: Role::Operate, most: Role::Look };
    assert!(may.is_limited() && may.check(Role::Operate).is_err_and(|why| why.contains("the right `write`")));
    assert_eq!((may.role(), may.check(Role::Look)), (Role::Look, Ok(())));
}

#[test]
fn a_hash_that_is_none_lets_nobody_in() {
    let users = Users::new(&[User { name: "anna".to_string(), role: Role::Look, password: "riverside".to_string() }]);
    assert_eq!(users.sign_in("anna", "riverside"), None);
}

#[test]
fn a_name_that_does_not_exist_is_checked_as_long_as_another() {
    assert!(password::is_hash(NOBODY));
}

/// Browsers have 53 bits.
#[test]
fn whole_numbers_that_a_browser_would_round_are_texts() {
    use serde_json::json;
    assert_eq!(exact(json!(9_007_199_254_740_992_u64)), json!(9_007_199_254_740_992_u64));
    assert_eq!(exact(json!(9_007_199_254_740_993_u64)), json!("9007199254740993"));
    assert_eq!(exact(json!(u64::MAX)), json!("18446744073709551615"));
    assert_eq!(exact(json!(i64::MIN)), json!("-9223372036854775808"));
    assert_eq!(exact(json!(1.5e300)), json!(1.5e300));
    assert_eq!(exact(json!("text")), json!("text"));
}
