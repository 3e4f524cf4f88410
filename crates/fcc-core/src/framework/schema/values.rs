//! The values of a struct, one after another.

use super::{Field, Sink, Source, Value};

/// The values of a struct, one after another, read from a struct or to be
/// written to one. Values beyond the first `N` are left out.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Values<const N: usize> {
    values: [Value; N],
    count: usize,
    given: usize,
}

impl<const N: usize> Default for Values<N> {
    fn default() -> Self {
        Self {
            values: [Value::Count(0); N],
            count: 0,
            given: 0,
        }
    }
}

impl<const N: usize> Values<N> {
    /// The values that are present.
    pub fn as_slice(&self) -> &[Value] {
        self.values.get(..self.count).unwrap_or_default()
    }
}

impl<const N: usize> Sink for Values<N> {
    fn value(&mut self, _: &'static Field, value: Value) {
        if let Some(place) = self.values.get_mut(self.count) {
            *place = value;
            self.count += 1;
        }
    }
}

impl<const N: usize> Source for Values<N> {
    fn value(&mut self, _: &'static Field) -> Option<Value> {
        let value = self.as_slice().get(self.given).copied();
        self.given += 1;
        value
    }
}
