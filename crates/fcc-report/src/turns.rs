//! Headings as continuous lines, without a jump at north.

const FULL_TURN_DEG: f64 = 360.0;

/// Counts a heading beyond full turns, so that a line through it does not jump
/// at north.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turns {
    last_deg: Option<f64>,
}

impl Turns {
    /// The heading closest to the previous one; closest to `from_deg` if there
    /// is no previous one.
    pub(super) fn count(&mut self, heading_deg: f64, from_deg: f64) -> f64 {
        let from_deg = self.last_deg.unwrap_or(from_deg);
        let counted = from_deg + shorter_way(heading_deg - from_deg);
        self.last_deg = Some(counted);
        counted
    }

    /// Forgets the previous heading.
    pub(super) fn forget(&mut self) {
        self.last_deg = None;
    }
}

/// The same angle in -180..180.
fn shorter_way(angle_deg: f64) -> f64 {
    (angle_deg + 180.0).rem_euclid(FULL_TURN_DEG) - 180.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_is_counted_on_through_north() {
        let mut turns = Turns::default();
        let counted: Vec<_> = [350.0, 355.0, 2.0, 90.0, 180.0, 270.0, 10.0, 350.0]
            .map(|heading| turns.count(heading, 0.0))
            .into();
        assert_eq!(
            counted,
            [-10.0, -5.0, 2.0, 90.0, 180.0, 270.0, 370.0, 350.0]
        );
    }
}
