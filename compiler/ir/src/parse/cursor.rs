//! A line of IR text, taken word by word.

use plcc_abi::Type;

use super::LineResult;

/// A place in a line.
pub struct Cursor<'a> {
    rest: &'a str,
}

impl<'a> Cursor<'a> {
    pub fn new(line: &'a str) -> Self {
        Cursor { rest: line.trim_start() }
    }

    pub fn advance(&mut self, bytes: usize) -> &'a str {
        let (taken, rest) = self.rest.split_at(bytes);
        self.rest = rest.trim_start();
        taken
    }

    pub fn peek(&self, text: &str) -> bool {
        self.rest.starts_with(text)
    }

    pub fn take(&mut self, text: &str) -> bool {
        let found = self.peek(text);
        if found {
            self.advance(text.len());
        }
        found
    }

    pub fn expect(&mut self, text: &str) -> LineResult<()> {
        if self.take(text) { Ok(()) } else { Err(format!("`{text}` is expected before `{}`", self.rest)) }
    }

    pub fn end(&self) -> LineResult<()> {
        if self.rest.is_empty() { Ok(()) } else { Err(format!("`{}` is too much", self.rest)) }
    }

    /// Letters, digits, `_`, and points that are followed by a letter, so that a word may be `load.bit`, but not `Q.0`.
    pub fn word_len(&self) -> usize {
        let bytes = self.rest.as_bytes();
        let mut len = 0;
        while let Some(&byte) = bytes.get(len) {
            let point = byte == b'.' && bytes.get(len + 1).is_some_and(u8::is_ascii_alphabetic);
            if !(byte.is_ascii_alphanumeric() || byte == b'_' || point) {
                break;
            }
            len += 1;
        }
        len
    }

    pub fn word(&mut self) -> LineResult<&'a str> {
        match self.word_len() {
            0 => Err(format!("a word is expected before `{}`", self.rest)),
            len => Ok(self.advance(len)),
        }
    }

    pub fn take_word(&mut self, word: &str) -> bool {
        let found = &self.rest[..self.word_len()] == word;
        if found {
            self.advance(word.len());
        }
        found
    }

    pub fn word_is(&mut self, word: &str) -> LineResult<()> {
        if self.take_word(word) { Ok(()) } else { Err(format!("`{word}` is expected before `{}`", self.rest)) }
    }

    pub fn ty(&mut self) -> LineResult<Type> {
        type_named(self.word()?)
    }

    /// True if the line continues with `v` or `b` and a number.
    pub fn starts_entity(&self, prefix: char) -> bool {
        let word = &self.rest[..self.word_len()];
        word.strip_prefix(prefix).is_some_and(|digits| digits.bytes().all(|b| b.is_ascii_digit()) && !digits.is_empty())
    }

    pub fn entity(&mut self, prefix: char) -> LineResult<u32> {
        if !self.starts_entity(prefix) {
            let what = if prefix == 'v' { "a value" } else { "a block" };
            return Err(format!("{what} (`{prefix}` and a number) is expected before `{}`", self.rest));
        }
        let word = self.word()?;
        word[1..].parse().map_err(|_| format!("the number of `{word}` is too large"))
    }

    /// `@NAME`; a name goes up to a space, `(` or `{`.
    pub fn function_name(&mut self) -> LineResult<&'a str> {
        self.expect("@")?;
        let len = self.rest.find([' ', '(', '{', '\t']).unwrap_or(self.rest.len());
        if len == 0 {
            return Err("a function name is expected after `@`".into());
        }
        Ok(self.advance(len))
    }

    /// A number without sign, decimal or with `0x`, that fits `T`.
    pub fn number<T: TryFrom<u64>>(&mut self) -> LineResult<T> {
        let len = self.rest.bytes().take_while(u8::is_ascii_alphanumeric).count();
        let text = &self.rest[..len];
        let number = match text.strip_prefix("0x") {
            Some(digits) => u64::from_str_radix(digits, 16),
            None => text.parse(),
        };
        let number = number.map_err(|_| format!("a number is expected before `{}`", self.rest))?;
        let number = T::try_from(number).map_err(|_| format!("{text} is too large"))?;
        self.advance(len);
        Ok(number)
    }

    /// Text between quotes, with the escapes that the printer writes.
    pub fn string(&mut self) -> LineResult<String> {
        self.expect("\"")?;
        let mut out = String::new();
        let mut chars = self.rest.char_indices();
        while let Some((index, c)) = chars.next() {
            match c {
                '"' => {
                    self.advance(index + 1);
                    return Ok(out);
                }
                '\\' => match chars.next() {
                    Some((_, 'u')) => {
                        let digits: String = chars.by_ref().map(|(_, c)| c).skip(1).take_while(|&c| c != '}').collect();
                        let code = u32::from_str_radix(&digits, 16).ok().and_then(char::from_u32);
                        out.push(code.ok_or_else(|| format!("`\\u{{{digits}}}` is not a character"))?);
                    }
                    Some((_, c)) => out.push(c),
                    None => break,
                },
                c => out.push(c),
            }
        }
        Err("the closing `\"` is missing".into())
    }
}

pub fn type_named(name: &str) -> LineResult<Type> {
    const TYPES: [Type; 7] = [Type::I1, Type::I8, Type::I16, Type::I32, Type::I64, Type::F32, Type::F64];
    TYPES.into_iter().find(|ty| ty.name() == name).ok_or_else(|| format!("`{name}` is not a type"))
}
