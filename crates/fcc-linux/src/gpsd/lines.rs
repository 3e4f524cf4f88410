//! Lines in a stream of bytes.

/// More bytes without the end of a line than gpsd writes.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
#[error("a line is longer than {} bytes", Lines::LONGEST)]
pub struct LineTooLong;

/// Finds lines in bytes that arrive in pieces of any size. Never holds more than
/// one line.
///
/// ```
/// use fcc_linux::gpsd::Lines;
///
/// let (mut lines, mut found) = (Lines::default(), Vec::new());
/// for piece in [b"{}\r".as_slice(), b"\n{\"a\"", b":1}\n"] {
///     lines.push(piece, |line| found.push(line.to_vec()))?;
/// }
/// assert_eq!(found, [b"{}".to_vec(), b"{\"a\":1}".to_vec()]);
/// # Ok::<(), fcc_linux::gpsd::LineTooLong>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Lines {
    begun: Vec<u8>,
}

impl Lines {
    /// The longest line, bytes with its end: gpsd (`gpsd.c`) writes the reports of an
    /// epoch, each a line, into a buffer of four times `GPS_JSON_RESPONSE_MAX`, which
    /// is 10,240 (`gps_json.h`).
    pub const LONGEST: usize = 40_960;

    /// Takes bytes, and passes on each line that they complete, without its end;
    /// not empty ones.
    ///
    /// # Errors
    /// When a line is too long: there is no use in what follows.
    pub fn push(
        &mut self,
        received: &[u8],
        mut each: impl FnMut(&[u8]),
    ) -> Result<(), LineTooLong> {
        for piece in received.split_inclusive(|byte| *byte == b'\n') {
            if self.begun.len() + piece.len() > Self::LONGEST {
                self.begun.clear();
                return Err(LineTooLong);
            }
            self.begun.extend(piece);
            if piece.last() == Some(&b'\n') {
                let line = self.begun.trim_ascii_end();
                if !line.is_empty() {
                    each(line);
                }
                self.begun.clear();
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 pieces of 1,000 bytes and 960 with the end of the line are 40,960.
    #[test]
    fn the_longest_line_is_passed_on_and_a_longer_one_an_error() {
        for (last, expected) in [(959, Ok(())), (960, Err(LineTooLong))] {
            let mut lines = Lines::default();
            let mut found = Vec::new();
            for _ in 0..40 {
                lines.push(&[b'x'; 1_000], |_| {}).unwrap();
            }
            let mut end = vec![b'x'; last];
            end.push(b'\n');
            let pushed = lines.push(&end, |line| found.push(line.len()));
            assert_eq!(pushed, expected);
            assert_eq!(found, pushed.map_or(vec![], |()| vec![40_959]));
        }
    }
}
