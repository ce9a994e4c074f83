//! Comments with a meaning: `(*$_NUM 3*)`. Source: GRAPH reference A.1.

/// The kind of a comment with a tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tag {
    /// `$_COM`
    Comment,
    /// `$_CMPSET`, `$_SETTINGS`
    Settings,
    /// `$_NUM`
    Number,
    /// `$_JUMP`
    Jump,
}

/// The tag of `(*$_TAG …*)`; none: not known.
pub fn tag(comment: &str) -> Option<Tag> {
    let name = name(comment);
    let is = |known: &str| name.eq_ignore_ascii_case(known);
    match () {
        () if is("COM") => Some(Tag::Comment),
        () if is("CMPSET") || is("SETTINGS") => Some(Tag::Settings),
        () if is("NUM") => Some(Tag::Number),
        () if is("JUMP") => Some(Tag::Jump),
        () => slip(name),
    }
}

const TAGS: [(&str, Tag); 5] = [
    ("COM", Tag::Comment),
    ("CMPSET", Tag::Settings),
    ("SETTINGS", Tag::Settings),
    ("NUM", Tag::Number),
    ("JUMP", Tag::Jump),
];

/// The tag that a misspelt one means.
fn slip(name: &str) -> Option<Tag> {
    let meant = meant(name)?;
    TAGS.iter().find(|(known, _)| *known == meant).map(|(_, tag)| *tag)
}

/// The name of the tag that `name` is a slip of; none: it is known, or resembles none.
pub fn meant(name: &str) -> Option<&'static str> {
    let known = TAGS.iter().any(|(known, _)| known.eq_ignore_ascii_case(name));
    let meant = plcc_literal::distance::nearest(name, TAGS.iter().map(|(known, _)| *known))?;
    let one = plcc_literal::distance::between(&name.to_ascii_uppercase(), meant) <= 1;
    (!known && one).then_some(meant)
}

/// The letters of the tag.
pub fn name(comment: &str) -> &str {
    let rest = comment.strip_prefix("(*$_").unwrap_or(comment);
    &rest[..rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len())]
}

/// The text after the tag.
pub fn body(comment: &str) -> &str {
    let rest = comment.strip_prefix("(*$_").unwrap_or(comment);
    let rest = &rest[name(comment).len()..];
    rest.strip_suffix("*)").unwrap_or(rest)
}

/// Lines of a `$_COM`: those before the `@`, then those after it, each part without outer blank lines.
pub fn lines(body: &str) -> Vec<String> {
    let mut found = Vec::new();
    for part in body.split('@') {
        let part: Vec<&str> =
            part.split('\n').flat_map(|line| line.trim_end_matches('\r').split('\r')).map(str::trim).collect();
        let first = part.iter().position(|line| !line.is_empty()).unwrap_or(part.len());
        let last = part.iter().rposition(|line| !line.is_empty()).map_or(first, |last| last + 1);
        found.extend(part[first..last].iter().map(|line| (*line).to_owned()));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pragmas_are_taken_apart() {
        assert_eq!(tag("(*$_NUM 3*)"), Some(Tag::Number));
        assert_eq!(body("(*$_NUM 3*)").trim(), "3");
        assert_eq!(tag("(*$_COMMENT*)"), None);
        assert_eq!((tag("(*$_NMU 3*)"), meant("NMU")), (Some(Tag::Number), Some("NUM")));
        assert_eq!((tag("(*$_JMUP*)"), meant("JUMP")), (Some(Tag::Jump), None));
        assert_eq!(body("(*$_JUMP*)"), "");
    }

    #[test]
    fn comments_keep_their_lines() {
        assert_eq!(
            lines(" Door (left) -> right\r\n\r\n\"open\"@idle"),
            ["Door (left) -> right", "", "\"open\"", "idle"]
        );
        assert_eq!(lines("\n\n@\n"), Vec::<String>::new());
    }
}
