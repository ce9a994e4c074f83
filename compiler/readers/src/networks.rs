//! Sources that are surely statement lists, by a look at the first words of their lines.
//!
//! Exports of STEP 7 begin the code of each block with `NETWORK`, which no other language has after BEGIN. To see that takes a
//! fraction of the time of [`outline`](plcc_syntax::scl::outline), which reads all tokens.

/// Where a line is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Outside,
    /// Among the declarations of a block of code.
    Declarations,
    /// After BEGIN, before the first network.
    Begin,
    /// In a network.
    Network,
    /// In a data block or a type.
    Data,
}

/// Words that begin and end a block of code.
const CODE: [(&str, &str); 3] = [
    ("ORGANIZATION_BLOCK", "END_ORGANIZATION_BLOCK"),
    ("FUNCTION_BLOCK", "END_FUNCTION_BLOCK"),
    ("FUNCTION", "END_FUNCTION"),
];
/// The same for data.
const DATA: [(&str, &str); 2] = [("DATA_BLOCK", "END_DATA_BLOCK"), ("TYPE", "END_TYPE")];

/// Whether the code of each block of `text` is a list of networks, there is such a block, and nothing is outside blocks. `false` also
/// for sources whose lines do not show it: with comments of several lines, misspelt keywords, or data blocks of arrays.
pub fn are_all_code(text: &str) -> bool {
    if text.contains("(*") || text.contains("/*") {
        return false;
    }
    let mut place = Place::Outside;
    let mut has_code = false;
    for line in text.lines() {
        let line = line.trim_start();
        let word = first_word(line);
        if word.is_empty() && (line.is_empty() || line.starts_with("//")) {
            continue;
        }
        let known = if looks_like_keyword(word) { word } else { "" };
        let is = |keyword: &str| known.eq_ignore_ascii_case(keyword);
        let ends_line = || matches!(line[word.len()..].trim_start(), rest if rest.is_empty() || rest.starts_with("//"));
        let begins_block = || CODE.iter().chain(&DATA).any(|(begin, _)| is(begin));
        place = match place {
            Place::Outside if CODE.iter().any(|(begin, _)| is(begin)) => Place::Declarations,
            Place::Outside if DATA.iter().any(|(begin, _)| is(begin)) && !has_array(line) => Place::Data,
            Place::Declarations if is("BEGIN") && ends_line() => Place::Begin,
            Place::Begin if is("NETWORK") => {
                has_code = true;
                Place::Network
            }
            Place::Network if CODE.iter().any(|(_, end)| is(end)) && ends_line() => Place::Outside,
            Place::Data if DATA.iter().any(|(_, end)| is(end)) && ends_line() => Place::Outside,
            Place::Outside | Place::Begin => return false,
            Place::Declarations | Place::Network | Place::Data if begins_block() => return false,
            Place::Data if has_array(line) => return false,
            Place::Declarations | Place::Network | Place::Data => place,
        };
    }
    has_code && place == Place::Outside
}

/// The letters and underscores that a line begins with.
fn first_word(line: &str) -> &str {
    let end = line.bytes().position(|byte| !byte.is_ascii_alphanumeric() && byte != b'_').unwrap_or(line.len());
    &line[..end]
}

/// False for the first words of most lines: none of the keywords above is shorter than `TYPE`, and they have few first letters.
fn looks_like_keyword(word: &str) -> bool {
    word.len() >= 4 && b"BDEFNOT".contains(&word.as_bytes()[0].to_ascii_uppercase())
}

/// Whether a line of a data block has an `ARRAY` that is not the type of a component: then it may be the content of an array data block.
fn has_array(line: &str) -> bool {
    let bytes = line.as_bytes();
    let found = bytes.windows(5).position(|word| word.eq_ignore_ascii_case(b"ARRAY"));
    found.is_some_and(|at| {
        let before = line.get(..at).unwrap_or_default().trim_end();
        let is_of = before.len() >= 3 && before.as_bytes()[before.len() - 3..].eq_ignore_ascii_case(b" OF");
        !before.ends_with(':') && !is_of
    })
}

#[cfg(test)]
mod tests {
    use super::are_all_code;

    const BLOCKS: &str = "// plant\nTYPE UDT 1\nSTRUCT\n a : ARRAY [1..2] OF INT;\nEND_STRUCT;\nEND_TYPE\n\nDATA_BLOCK DB 1\nUDT 1\nBEGIN\n\
        END_DATA_BLOCK\nFUNCTION FC 1 : VOID\nTITLE = IF it runs\nVAR_TEMP\n x : INT;\nEND_VAR\nBEGIN\n\nNETWORK\nTITLE = first\n      \
        A I 0.0; // motor\n= Q 0.0\nEND_FUNCTION\n";

    #[test]
    fn networks_after_begin_are_statement_lists() {
        assert!(are_all_code(BLOCKS));
        assert!(are_all_code(&BLOCKS.to_lowercase()));
        assert!(are_all_code(&BLOCKS.replace('\n', "\r\n")));
    }

    #[test]
    fn what_lines_do_not_show_is_looked_at_in_full() {
        let not = [
            ("BEGIN\n\nNETWORK", "BEGIN\n"),
            ("BEGIN\n\nNETWORK", "BEGIN\n#x := 1;\nNETWORK"),
            ("// plant", "(* plant *)"),
            ("// plant", "plant"),
            ("END_FUNCTION\n", "END_FUNCTION\nA I 0.0\n"),
            ("END_FUNCTION\n", "END_FUNCTIONS\n"),
            ("DATA_BLOCK DB 1\nUDT 1", "DATA_BLOCK DB 1\nARRAY [0..9] OF INT"),
            ("END_FUNCTION\n", "END_FUNCTION\nFUNCTION FC 2 : INT\nVAR_TEMP\nEND_VAR\nFC2 := 1;\nEND_FUNCTION\n"),
            ("= Q 0.0\nEND_FUNCTION", "= Q 0.0\nFUNCTION FC 2 : INT"),
        ];
        for (from, to) in not {
            let text = BLOCKS.replace(from, to);
            assert_ne!(text, BLOCKS);
            assert!(!are_all_code(&text), "{text}");
        }
        assert!(!are_all_code("DATA_BLOCK DB 1\nUDT 1\nBEGIN\nEND_DATA_BLOCK\n"));
    }
}
