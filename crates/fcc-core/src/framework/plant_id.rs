//! The identity of a plant among those that programs on one machine can
//! control.

use core::fmt::{self, Write};

/// The name of a plant, readable by users and from which its adapter finds it
/// again: "X-Plane at 127.0.0.1:49000". At most [`CAPACITY`](Self::CAPACITY)
/// bytes.
///
/// ```
/// use fcc_core::framework::PlantId;
///
/// let plant = PlantId::new(format_args!("servos on {}", "/dev/ttyACM0")).unwrap();
/// assert_eq!(plant.as_str(), "servos on /dev/ttyACM0");
/// let long = "x".repeat(PlantId::CAPACITY + 1);
/// assert_eq!(PlantId::new(format_args!("{long}")), None);
/// ```
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct PlantId {
    bytes: [u8; Self::CAPACITY],
    length: usize,
}

impl PlantId {
    /// The longest name, bytes.
    pub const CAPACITY: usize = 80;

    /// Creates a name; none if it is too long.
    pub fn new(text: fmt::Arguments<'_>) -> Option<Self> {
        let mut this = Self {
            bytes: [0; Self::CAPACITY],
            length: 0,
        };
        this.write_fmt(text).ok().map(|()| this)
    }

    /// The name.
    pub fn as_str(&self) -> &str {
        let written = self.bytes.get(..self.length).unwrap_or_default();
        core::str::from_utf8(written).unwrap_or_default()
    }
}

impl Write for PlantId {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let end = self.length + text.len();
        let room = self.bytes.get_mut(self.length..end).ok_or(fmt::Error)?;
        room.copy_from_slice(text.as_bytes());
        self.length = end;
        Ok(())
    }
}

impl fmt::Display for PlantId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for PlantId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PlantId({:?})", self.as_str())
    }
}
