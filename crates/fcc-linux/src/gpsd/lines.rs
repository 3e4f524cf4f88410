//! Lines in a stream of bytes.

/// Longer than any line of gpsd: a list of satellites takes 15 kB.
const LONGEST: usize = 64 * 1024;

/// Finds lines in bytes that arrive in pieces of any size. Never holds more than
/// one line; of one that is longer than 64 KiB nothing is passed on.
///
/// ```
/// use fcc_linux::gpsd::Lines;
///
/// let (mut lines, mut found) = (Lines::default(), Vec::new());
/// for piece in [b"{}\r".as_slice(), b"\n{\"a\"", b":1}\n"] {
///     lines.push(piece, |line| found.push(line.to_vec()));
/// }
/// assert_eq!(found, [b"{}".to_vec(), b"{\"a\":1}".to_vec()]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Lines {
    begun: Vec<u8>,
    is_too_long: bool,
}

impl Lines {
    /// Takes bytes, and passes on each line that they complete, without its end;
    /// not empty ones.
    pub fn push(&mut self, received: &[u8], mut each: impl FnMut(&[u8])) {
        for piece in received.split_inclusive(|byte| *byte == b'\n') {
            let is_complete = piece.last() == Some(&b'\n');
            if self.begun.len() + piece.len() > LONGEST {
                self.begun.clear();
                self.is_too_long = true;
            }
            if !self.is_too_long {
                self.begun.extend(piece);
            }
            if is_complete {
                let line = self.begun.trim_ascii_end();
                if !line.is_empty() {
                    each(line);
                }
                self.begun.clear();
                self.is_too_long = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_line_that_is_too_long_nothing_is_passed_on() {
        let mut lines = Lines::default();
        let mut found = Vec::new();
        let long = [b'x'; 1_000];
        for _ in 0..100 {
            lines.push(&long, |line| found.push(line.to_vec()));
            assert!(lines.begun.len() <= LONGEST);
        }
        lines.push(b"end\nnext\n", |line| found.push(line.to_vec()));
        assert_eq!(found, [b"next".to_vec()]);
    }
}
