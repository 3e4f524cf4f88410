//! A line that arrives in parts.

/// The longest line, with its end.
pub(super) const MOST_BYTES: usize = 512;

/// What has arrived of a line.
#[derive(Default, Debug)]
pub(super) struct Line(Vec<u8>);

impl Line {
    /// Adds what has arrived; what comes after the line is ignored. Returns the
    /// line without its end once that has arrived, or why there is none.
    pub(super) fn add(&mut self, part: &[u8]) -> Option<Result<String, &'static str>> {
        let room = MOST_BYTES.saturating_sub(self.0.len());
        self.0.extend(part.iter().take(room));
        match self.0.iter().position(|byte| *byte == b'\n') {
            Some(end) => {
                self.0.truncate(end);
                let line = String::from_utf8(std::mem::take(&mut self.0));
                Some(line.map_err(|_| "it is not a text"))
            }
            None if self.0.len() >= MOST_BYTES => Some(Err("it is too long")),
            None => None,
        }
    }
}

/// The first line of these bytes, if they arrive in parts of so many.
#[cfg(fuzzing)]
pub fn line_of_parts(bytes: &[u8], part: usize) -> Option<Result<String, &'static str>> {
    let mut line = Line::default();
    bytes.chunks(part.max(1)).find_map(|part| line.add(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_at_most_512_bytes_however_it_arrives() {
        for (letters, expected) in [(511, Some(511)), (512, None), (900, None)] {
            let sent = ["x".repeat(letters).as_bytes(), b"\nmore"].concat();
            for part in [1, 100, 512, 1_000] {
                let mut line = Line::default();
                let got = sent.chunks(part).find_map(|part| line.add(part)).unwrap();
                assert_eq!(
                    got.ok().map(|line| line.len()),
                    expected,
                    "{letters}, {part}"
                );
            }
        }
        assert_eq!(Line::default().add(b"engage"), None);
        assert_eq!(
            Line::default().add(b"\xff\n"),
            Some(Err("it is not a text"))
        );
    }
}
