//! Which ticks are missing.

use fcc_core::framework::Tick;
use serde::Serialize;

/// At most this many gaps are listed; the rest are counted.
const MOST_GAPS: usize = 1_000;

/// Ticks that the loop served and the recording lacks.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Gap {
    /// The last tick before it, s since the first tick.
    pub from_s: f64,
    /// The first tick after it, s since the first tick.
    pub to_s: f64,
    /// How many ticks are missing.
    pub ticks: u64,
}

/// Which ticks are missing between the first in the file and the last.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct Continuity {
    /// Number of the first tick; the loop counts from 1.
    pub first_tick: u64,
    /// Number of the last tick.
    pub last_tick: u64,
    /// Ticks in the file.
    pub ticks: u64,
    /// Ticks that are missing between the first and the last.
    pub lost: u64,
    /// Number of gaps.
    pub gap_count: u64,
    /// The first thousand gaps.
    pub gaps: Vec<Gap>,
    /// Ticks that are known to be missing after the last.
    pub lost_after: u64,
    /// Ticks out of order, which were left out.
    pub out_of_order: u64,
    #[serde(skip)]
    last_s: f64,
}

/// How a tick follows the previous one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Follows {
    /// Nothing is missing between them.
    Directly,
    /// Ticks are missing between them.
    AfterGap,
    /// It is not later than the previous one.
    Not,
}

impl Continuity {
    pub(super) fn take(&mut self, tick: &Tick, time_s: f64) -> Follows {
        let mut follows = Follows::Directly;
        if self.ticks == 0 {
            self.first_tick = tick.number;
        } else if tick.number <= self.last_tick || time_s < self.last_s {
            self.out_of_order += 1;
            return Follows::Not;
        } else {
            let passed = tick.number - self.last_tick - 1;
            let lost = passed.saturating_sub(tick.missed);
            if lost > 0 {
                follows = Follows::AfterGap;
                self.lost = self.lost.saturating_add(lost);
                self.gap_count += 1;
                if self.gaps.len() < MOST_GAPS {
                    self.gaps.push(Gap {
                        from_s: self.last_s,
                        to_s: time_s,
                        ticks: lost,
                    });
                }
            }
        }
        self.ticks += 1;
        self.last_tick = tick.number;
        self.last_s = time_s;
        follows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(number: u64, missed: u64) -> Tick {
        Tick {
            number,
            missed,
            ..Tick::default()
        }
    }

    #[test]
    fn a_missed_period_is_no_gap_and_a_lost_record_is() {
        let mut continuity = Continuity::default();
        for (number, missed, follows) in [
            (10, 0, Follows::Directly),
            (11, 0, Follows::Directly),
            (14, 2, Follows::Directly),
            (20, 1, Follows::AfterGap),
            (20, 0, Follows::Not),
            (3, 0, Follows::Not),
            (21, 0, Follows::Directly),
        ] {
            let time_s = number as f64;
            assert_eq!(continuity.take(&tick(number, missed), time_s), follows);
        }
        assert_eq!((continuity.first_tick, continuity.last_tick), (10, 21));
        assert_eq!((continuity.ticks, continuity.out_of_order), (5, 2));
        let gap = Gap {
            from_s: 14.0,
            to_s: 20.0,
            ticks: 4,
        };
        assert_eq!((continuity.lost, continuity.gaps), (4, vec![gap]));
    }
}
