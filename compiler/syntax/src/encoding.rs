//! Bytes of a source file to text.

/// Text of a file: by its byte order mark, else UTF-8 if it is that, else Windows-1252.
///
/// STEP 7 writes Windows-1252, newer tools UTF-8. Bytes that Windows-1252 leaves open keep their number as a character.
pub fn decode(bytes: &[u8]) -> String {
    if let Some((encoding, length)) = encoding_rs::Encoding::for_bom(bytes) {
        return encoding.decode_without_bom_handling(&bytes[length..]).0.into_owned();
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => encoding_rs::WINDOWS_1252.decode_without_bom_handling(bytes).0.into_owned(),
    }
}
