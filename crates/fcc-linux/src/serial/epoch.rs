//! Fixes from the sentences of NMEA, each of which has a part of one.

use std::collections::VecDeque;

use fcc_core::flight::{GnssFix, Position, Velocity};

use super::Sentence;

const DAY_S: f64 = 86_400.0;
/// Sentences have no vertical speed: it is the mean over this time, s. The
/// quarter is for receivers that are not exactly on time.
const CLIMB_OVER_S: f64 = 1.25;
/// At most 25 a second.
const MOST_ALTITUDES: usize = 32;

/// Puts the sentences of one epoch together.
///
/// GGA and RMC with the same time make a fix, whichever comes first. The
/// vertical speed is the change of altitude over the last second, so there is
/// none with the first fix, and it is half a second late: a receiver that speaks
/// UBX gives a better one. Accuracies are those of the last GST, 0 without.
#[derive(Clone, Debug, Default)]
pub struct Epochs {
    motion: Option<(f64, [f64; 2])>,
    place: Option<(f64, Position)>,
    accuracy_m: [f64; 2],
    /// With their times, the oldest first.
    altitudes: VecDeque<(f64, f64)>,
}

impl Epochs {
    /// Takes a sentence; the fix that it completes, if it does.
    pub fn take(&mut self, sentence: Sentence) -> Option<GnssFix> {
        match sentence {
            Sentence::Motion {
                time_s,
                velocity_mps,
            } => self.motion = velocity_mps.map(|velocity| (time_s, velocity)),
            Sentence::Place { time_s, position } => {
                self.place = position.map(|position| (time_s, position));
            }
            Sentence::Accuracy {
                horizontal_m,
                vertical_m,
            } => {
                self.accuracy_m = [horizontal_m, vertical_m];
                return None;
            }
        }
        let (moved_at, [north_mps, east_mps]) = self.motion?;
        let (time_s, position) = self.place?;
        if moved_at != time_s {
            return None;
        }
        (self.motion, self.place) = (None, None);
        let down_mps = self.down_mps(time_s, position.altitude_m)?;
        let [horizontal_accuracy_m, vertical_accuracy_m] = self.accuracy_m;
        Some(GnssFix {
            position,
            velocity: Velocity {
                north_mps,
                east_mps,
                down_mps,
            },
            horizontal_accuracy_m,
            vertical_accuracy_m,
            speed_accuracy_mps: 0.0,
        })
    }

    fn down_mps(&mut self, time_s: f64, altitude_m: f64) -> Option<f64> {
        let since = |then: f64| (time_s - then).rem_euclid(DAY_S);
        while let Some((then, _)) = self.altitudes.front()
            && (since(*then) > CLIMB_OVER_S || self.altitudes.len() >= MOST_ALTITUDES)
        {
            self.altitudes.pop_front();
        }
        let first = self.altitudes.front().copied();
        self.altitudes.push_back((time_s, altitude_m));
        let (then, before_m) = first?;
        let passed_s = since(then);
        (passed_s > 0.0).then(|| (before_m - altitude_m) / passed_s)
    }
}
