//! Frames in a stream of bytes.

/// A protocol whose frames can be told from noise.
///
/// A protocol knows the frames that are used here, and takes all others for
/// noise: their content is scanned, too, and a checksum keeps what is in it from
/// being taken for a frame. So no length field of a foreign or damaged frame
/// delays the next one by more than [`LONGEST`](Self::LONGEST) bytes.
pub trait Protocol {
    /// What a frame says.
    type Frame;

    /// The longest frame, bytes.
    const LONGEST: usize;

    /// What these bytes, at least one, begin with.
    fn begin(bytes: &[u8]) -> Begin<Self::Frame>;
}

/// What bytes begin with.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Begin<F> {
    /// No frame.
    Noise,
    /// A frame, if the bytes that follow complete it.
    Incomplete,
    /// A complete frame whose content or checksum is wrong.
    Damaged,
    /// A frame, and its length in bytes, at least 1.
    Frame(F, usize),
}

/// Finds frames in bytes that arrive in pieces of any size, with noise between.
/// Never holds more than one frame's bytes.
///
/// ```
/// use fcc_linux::serial::{Frames, Sbus};
///
/// let mut frames = Frames::<Sbus>::default();
/// let mut found = 0;
/// for piece in [&[0x0f_u8][..], &[0; 24]] {
///     frames.push(piece, |_| found += 1);
/// }
/// assert_eq!(found, 1);
/// ```
#[derive(Debug)]
pub struct Frames<P> {
    bytes: Vec<u8>,
    damaged: u64,
    protocol: core::marker::PhantomData<P>,
}

impl<P: Protocol> Default for Frames<P> {
    fn default() -> Self {
        Self {
            bytes: Vec::with_capacity(P::LONGEST),
            damaged: 0,
            protocol: core::marker::PhantomData,
        }
    }
}

impl<P: Protocol> Frames<P> {
    /// Takes bytes, and passes on each frame that they complete.
    pub fn push(&mut self, received: &[u8], mut each: impl FnMut(P::Frame)) {
        for byte in received {
            self.bytes.push(*byte);
            self.find(&mut each);
        }
    }

    /// The line was silent for longer than within a frame: what is incomplete
    /// remains so, and the next byte is the first of a frame.
    pub fn restart(&mut self) {
        self.bytes.clear();
    }

    /// How many frames were damaged so far.
    pub const fn damaged(&self) -> u64 {
        self.damaged
    }

    fn find(&mut self, each: &mut impl FnMut(P::Frame)) {
        let mut begin = 0;
        while let Some(rest) = self.bytes.get(begin..).filter(|rest| !rest.is_empty()) {
            begin += match P::begin(rest) {
                Begin::Incomplete if rest.len() < P::LONGEST => break,
                Begin::Noise | Begin::Incomplete => 1,
                Begin::Damaged => {
                    self.damaged += 1;
                    1
                }
                Begin::Frame(frame, length) => {
                    each(frame);
                    length.max(1)
                }
            };
        }
        self.bytes.drain(..begin.min(self.bytes.len()));
    }
}
