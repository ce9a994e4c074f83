//! Numbers of frames: fields taken from the front of a slice, those of [`Bytes`] big-endian, and an answer that grows.

/// Bytes of a frame, taken from the front. Nothing is taken that is not there.
#[derive(Clone, Copy)]
pub struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        take(&mut self.0, count)
    }

    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        array(&mut self.0)
    }

    pub fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|[byte]| byte)
    }

    pub fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_be_bytes)
    }
}

/// Takes bytes from the front; `None`: there are not so many, and nothing is taken.
pub fn take<'a>(from: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    from.split_off(..count)
}

/// As [`take`], of a number that is known.
pub fn array<const N: usize>(from: &mut &[u8]) -> Option<[u8; N]> {
    take(from, N)?.first_chunk().copied()
}

/// Adds a word.
pub fn put16(out: &mut Vec<u8>, value: u16) {
    out.extend(value.to_be_bytes());
}
