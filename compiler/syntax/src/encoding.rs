//! Bytes of a source file to text.

use std::str::FromStr;

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{
    BIG5, EUC_KR, Encoding, GBK, SHIFT_JIS, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1250, WINDOWS_1251, WINDOWS_1252,
    WINDOWS_1254, WINDOWS_1258,
};

/// Text of a file: by its byte order mark, else as UTF-8 if it is valid, else in the code page that its letters suggest.
///
/// STEP 7 and Micro/WIN write the code page of the PC, newer tools UTF-8. Windows-1252 is used where nothing decides. Bytes
/// that it does not define keep their number as a character.
pub fn decode(bytes: &[u8]) -> String {
    decode_as(bytes, None)
}

/// As [`decode`], with the code page of texts that are not UTF-8, if it is known.
pub fn decode_as(bytes: &[u8], page: Option<CodePage>) -> String {
    let text = decode_bytes(bytes, page);
    match has_lone_returns(&text) {
        true => lines_of_returns(&text),
        false => text,
    }
}

/// How the bytes of a file stand for its text, to write another text in the same way.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    encoding: &'static Encoding,
    /// Bytes of its byte order mark.
    mark: &'static [u8],
    line_end: &'static str,
}

impl Form {
    /// The form of a file. `None`: its bytes are not those of its text, so that writing it would change more than the text.
    pub fn of(bytes: &[u8], page: Option<CodePage>) -> Option<Form> {
        let (encoding, mark): (_, &[u8]) = match encoding_rs::Encoding::for_bom(bytes) {
            Some((encoding, 3)) => (encoding, b"\xEF\xBB\xBF"),
            Some((encoding, _)) if encoding == UTF_16LE => (encoding, b"\xFF\xFE"),
            Some((encoding, _)) => (encoding, b"\xFE\xFF"),
            None if std::str::from_utf8(bytes).is_ok() => (UTF_8, b""),
            None => (page.map_or_else(|| code_page(bytes), |page| page.0), b""),
        };
        let text = decode_bytes(bytes, page);
        let count = |end: &str| text.matches(end).count();
        let (both, feeds) = (count("\r\n"), count("\n"));
        let line_end = match (both, feeds) {
            _ if both * 2 > feeds => "\r\n",
            (0, 0) if count("\r") > 0 => "\r",
            _ => "\n",
        };
        let form = Form { encoding, mark, line_end };
        (form.bytes(&text)? == bytes).then_some(form)
    }

    /// The bytes of a text whose lines end with `\n`. `None`: the code page lacks one of its characters.
    pub fn write(&self, text: &str) -> Option<Vec<u8>> {
        match self.line_end {
            "\n" => self.bytes(text),
            end => self.bytes(&text.replace('\n', end)),
        }
    }

    fn bytes(&self, text: &str) -> Option<Vec<u8>> {
        let mut out = self.mark.to_vec();
        if self.encoding == UTF_16LE {
            out.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
        } else if self.encoding == UTF_16BE {
            out.extend(text.encode_utf16().flat_map(u16::to_be_bytes));
        } else {
            let (bytes, _, lacking) = self.encoding.encode(text);
            if lacking {
                return None;
            }
            out.extend_from_slice(&bytes);
        }
        Some(out)
    }
}

/// A code page as a user names it: `gbk`, `936`, `windows-1250`, `1250`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodePage(&'static Encoding);

impl FromStr for CodePage {
    type Err = String;

    fn from_str(text: &str) -> Result<CodePage, String> {
        let name = text.trim().to_ascii_lowercase();
        let number = name.strip_prefix("cp").unwrap_or(&name);
        let windows = format!("windows-{number}");
        let label = match number {
            "932" => "shift_jis",
            "936" | "gb2312" => "gbk",
            "949" => "euc-kr",
            "950" => "big5",
            "1250" | "1251" | "1252" | "1253" | "1254" | "1255" | "1256" | "1257" | "1258" => &windows,
            _ => name.as_str(),
        };
        let found = Encoding::for_label(label.as_bytes()).map(CodePage);
        found.ok_or_else(|| format!("`{text}` is not a code page; write a number as 936 or 1252, or a name as gbk"))
    }
}

/// Whether some carriage return is followed neither by a line feed nor by another one.
fn has_lone_returns(text: &str) -> bool {
    let bytes = text.as_bytes();
    let lone = |at: &usize| bytes[*at] == b'\r' && !matches!(bytes.get(at + 1), Some(b'\n' | b'\r'));
    (0..bytes.len()).any(|at| lone(&at))
}

/// Lone carriage returns end lines in files of old editors: they become line feeds, at the same bytes.
fn lines_of_returns(text: &str) -> String {
    let mut rest = text.chars().peekable();
    let mut lines = String::with_capacity(text.len());
    while let Some(c) = rest.next() {
        let lone = c == '\r' && !matches!(rest.peek(), Some('\n' | '\r'));
        lines.push(if lone { '\n' } else { c });
    }
    lines
}

fn decode_bytes(bytes: &[u8], page: Option<CodePage>) -> String {
    if let Some((encoding, length)) = encoding_rs::Encoding::for_bom(bytes) {
        return encoding.decode_without_bom_handling(&bytes[length..]).0.into_owned();
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => {
            let encoding = page.map_or_else(|| code_page(bytes), |page| page.0);
            encoding.decode_without_bom_handling(bytes).0.into_owned()
        }
    }
}

/// Code pages of Windows, which the tools write. Sources do not use others.
const CODE_PAGES: [&Encoding; 8] =
    [GBK, BIG5, SHIFT_JIS, EUC_KR, WINDOWS_1250, WINDOWS_1251, WINDOWS_1254, WINDOWS_1258];

/// Shorter texts do not decide.
const SHORTEST_TEXT: usize = 8;

/// The code page of a text that is not UTF-8.
fn code_page(bytes: &[u8]) -> &'static Encoding {
    if bytes.len() < SHORTEST_TEXT {
        return WINDOWS_1252;
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(bytes, true);
    let guess = detector.guess(None, Utf8Detection::Deny);
    match CODE_PAGES.contains(&guess) && !guess.decode_without_bom_handling(bytes).1 {
        true => guess,
        false => WINDOWS_1252,
    }
}

#[cfg(test)]
mod tests {
    use super::{CodePage, Form, decode, decode_as};

    #[test]
    fn byte_order_marks_and_utf_8() {
        assert_eq!(decode(b"\xEF\xBB\xBFLD I0.0"), "LD I0.0");
        assert_eq!(decode("// 泵\n".as_bytes()), "// 泵\n");
        assert_eq!(decode(b"\xFF\xFEL\0D\0"), "LD");
        assert_eq!(decode(b"\xFE\xFF\0L\0D"), "LD");
    }

    #[test]
    fn code_pages() {
        // "SUBROUTINE_BLOCK", two Chinese characters in GBK, ":SBR0".
        assert_eq!(decode(b"SUBROUTINE_BLOCK \xB6\xA8\xCA\xB1:SBR0\r\n"), "SUBROUTINE_BLOCK 定时:SBR0\r\n");
        assert_eq!(decode(b"// \xC6\xF4\xB6\xAF\xCB\xAE\xB1\xC3\nLD I0.0\n"), "// 启动水泵\nLD I0.0\n");
        // Windows-1251.
        assert_eq!(decode(b"// \xCF\xF3\xF1\xEA \xED\xE0\xF1\xEE\xF1\xE0\nLD I0.0\n"), "// Пуск насоса\nLD I0.0\n");
        // Windows-1250.
        assert_eq!(
            decode(b"// Sie\xE6 zasilaj\xB9ca, w\xB3\xB9czenie pompy i zawor\xF3w\nLD I0.0\n"),
            "// Sieć zasilająca, włączenie pompy i zaworów\nLD I0.0\n"
        );
    }

    #[test]
    fn western_texts_stay_western() {
        assert_eq!(decode(b"// St\xF6rung F\xFCllstand\nU E 0.0\n"), "// Störung Füllstand\nU E 0.0\n");
        assert_eq!(decode(b"// Temperatur 25 \xB0C\nLD I0.0\n"), "// Temperatur 25 °C\nLD I0.0\n");
        assert_eq!(decode(b"// gro\xDF\n// m\xB3/h, 5 \xB5s\n"), "// groß\n// m³/h, 5 µs\n");
        for byte in 0xA0..=0xFF_u8 {
            assert_eq!(decode(&[byte]), char::from(byte).to_string());
        }
    }

    #[test]
    fn a_named_code_page_is_for_texts_that_are_not_utf_8() {
        let page = |name: &str| name.parse::<CodePage>().unwrap();
        assert_eq!(decode_as(b"// \xB6\xA8", Some(page("936"))), "// 定");
        assert_eq!(decode_as(b"// \xB6\xA8", Some(page("CP1252"))), "// ¶¨");
        assert_eq!(decode_as("// 泵".as_bytes(), Some(page("windows-1250"))), "// 泵");
        assert!("latin-77".parse::<CodePage>().is_err());
    }

    #[test]
    fn a_file_is_written_in_its_own_form() {
        for bytes in [
            b"\xEF\xBB\xBFLD I0.0\r\nEU\r\n".as_slice(),
            b"// \xC6\xF4\xB6\xAF\xCB\xAE\xB1\xC3\nLD I0.0\n",
            b"// gro\xDF und klein, St\xF6rung\n",
            b"\xFF\xFEL\0D\0",
            b"\xFE\xFF\0L\0D",
            b"LD I0.0\rEU\r",
        ] {
            let form = Form::of(bytes, None).expect("its bytes are those of its text");
            assert_eq!(form.write(&decode(bytes).replace("\r\n", "\n")).as_deref(), Some(bytes));
        }
        let western = Form::of(b"// gro\xDF\n", None).expect("its bytes are those of its text");
        assert_eq!(western.write("// \u{6CF5}\n"), None);
    }
}
