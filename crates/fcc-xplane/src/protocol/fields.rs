//! Reading and writing packed little-endian fields in order.

/// The part of a datagram that has not been read yet.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    pub(super) const fn of(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (field, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*field)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Option<i32> {
        self.take().map(i32::from_le_bytes)
    }

    /// A finite number; `None` for an infinity, a NaN or missing bytes.
    pub(super) fn f32(&mut self) -> Option<f32> {
        self.take()
            .map(f32::from_le_bytes)
            .filter(|v| v.is_finite())
    }

    /// A finite number; `None` for an infinity, a NaN or missing bytes.
    pub(super) fn f64(&mut self) -> Option<f64> {
        self.take()
            .map(f64::from_le_bytes)
            .filter(|v| v.is_finite())
    }

    /// All remaining bytes.
    pub(super) const fn rest(self) -> &'a [u8] {
        self.0
    }
}

/// Writes `parts` one after the other and fills the rest with zeros; parts that
/// do not fit are left out (callers size their buffers so that all do).
pub(super) fn fill(into: &mut [u8], parts: &[&[u8]]) {
    let mut bytes = parts.iter().flat_map(|part| part.iter().copied());
    for place in into {
        *place = bytes.next().unwrap_or(0);
    }
}
