//! Fixes from the sentences of NMEA, each of which has a part of one.

use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_device::VerticalSpeed;

use super::Sentence;

/// Puts the sentences of one epoch together.
///
/// GGA and RMC with the same time make a fix, whichever comes first. The
/// vertical speed is that of [`VerticalSpeed`]: a receiver that speaks
/// UBX gives a better one. Accuracies are those of the last GST, 0 without.
#[derive(Clone, Debug, Default)]
pub struct Epochs {
    motion: Option<(f64, [f64; 2])>,
    place: Option<(f64, Position)>,
    accuracy_m: [f64; 2],
    /// Sentences have none.
    vertical_speed: VerticalSpeed,
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
        let down_mps = self.vertical_speed.down_mps(time_s, position.altitude_m)?;
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
}
