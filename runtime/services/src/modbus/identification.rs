//! What a master learns of the device: function 43 with type 14, Read Device Identification.
//!
//! Source: Modbus application protocol V1.1b3, 6.21.

use super::functions::Exception;
use crate::s7::{Names, Plc};

/// The function, which carries several protocols.
pub const FUNCTION: u8 = 43;
/// The one of them that identifies the device.
const IDENTIFICATION: u8 = 14;

/// What is asked for: many objects of a kind, or one.
const BASIC: u8 = 1;
const REGULAR: u8 = 2;
const EXTENDED: u8 = 3;
const INDIVIDUAL: u8 = 4;

/// The last object of the basic kind.
const BASIC_LAST: u8 = 2;
/// Of the regular kind, as many as there are or one by one.
const CONFORMITY: u8 = 0x82;
/// Letters of an object: all of them fit into one answer.
const LETTERS_MAX: usize = 32;

/// The objects that the device has, with their numbers: vendor, product code, revision, product name, name of the program.
fn objects(names: Names) -> [(u8, String); 5] {
    let revision = env!("CARGO_PKG_VERSION").to_string();
    [(0, "plcc".to_string()), (1, names.order), (2, revision), (4, names.module), (6, names.program)]
}

/// The answer after the function.
pub fn read(request: &[u8], plc: &dyn Plc) -> Result<Vec<u8>, Exception> {
    let &[IDENTIFICATION, code, first] = request else {
        return Err(if request.first() == Some(&IDENTIFICATION) { Exception::Value } else { Exception::Function });
    };
    let last = match code {
        BASIC => BASIC_LAST,
        REGULAR | EXTENDED => u8::MAX,
        INDIVIDUAL => first,
        _ => return Err(Exception::Value),
    };
    let all = objects(plc.names());
    let is_there = all.iter().any(|(number, _)| *number == first && *number <= last);
    let from = match is_there {
        true => first,
        false if code == INDIVIDUAL => return Err(Exception::Address),
        // What does not exist stands for the first one.
        false => 0,
    };
    let told: Vec<_> = all.iter().filter(|(number, _)| (from..=last).contains(number)).collect();
    // No more follows, with no number.
    let mut data = vec![IDENTIFICATION, code, CONFORMITY, 0, 0, told.len() as u8];
    for (number, text) in told {
        let letter = |letter: char| if letter.is_ascii_graphic() || letter == ' ' { letter as u8 } else { b'?' };
        let letters: Vec<u8> = text.chars().take(LETTERS_MAX).map(letter).collect();
        data.extend([*number, letters.len() as u8]);
        data.extend(letters);
    }
    Ok(data)
}
