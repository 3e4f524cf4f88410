//! Fixes from the sentences of NMEA, each of which has a part of one.

use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_core::framework::Time;
use fcc_device::{EpochOrder, VerticalSpeed};

use super::Sentence;
use crate::Sample;

/// Puts the sentences of one epoch together.
///
/// GGA and RMC with the same time make a fix, whichever comes first. The
/// vertical speed is that of [`VerticalSpeed`]: a receiver that speaks
/// UBX gives a better one. Accuracies are those of the last GST, 0 without.
#[derive(Clone, Debug)]
pub struct Epochs {
    motion: Option<(f64, [f64; 2])>,
    place: Option<(f64, Position)>,
    accuracy_m: [f64; 2],
    /// Sentences have none.
    vertical_speed: VerticalSpeed,
    order: EpochOrder,
}

/// What a sentence adds.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Epoch {
    /// Its last part.
    Complete(Sample<GnssFix>),
    /// The last part of one that is not later than the one before.
    Repeated,
    /// A part.
    Incomplete,
}

impl Default for Epochs {
    fn default() -> Self {
        Self {
            motion: None,
            place: None,
            accuracy_m: [0.0; 2],
            vertical_speed: VerticalSpeed::default(),
            order: EpochOrder::of_day(),
        }
    }
}

impl Epochs {
    /// Takes a sentence that has arrived at a time.
    pub fn take(&mut self, sentence: Sentence, arrived: Time) -> Epoch {
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
                return Epoch::Incomplete;
            }
        }
        let (Some((moved_at, [north_mps, east_mps])), Some((time_s, position))) =
            (self.motion, self.place)
        else {
            return Epoch::Incomplete;
        };
        if moved_at != time_s {
            return Epoch::Incomplete;
        }
        (self.motion, self.place) = (None, None);
        let Some(taken) = self.order.taken(time_s, arrived) else {
            return Epoch::Repeated;
        };
        let Some(down_mps) = self.vertical_speed.down_mps(time_s, position.altitude_m) else {
            return Epoch::Incomplete;
        };
        let [horizontal_accuracy_m, vertical_accuracy_m] = self.accuracy_m;
        let fix = GnssFix {
            position,
            velocity: Velocity {
                north_mps,
                east_mps,
                down_mps,
            },
            horizontal_accuracy_m,
            vertical_accuracy_m,
            speed_accuracy_mps: 0.0,
        };
        Epoch::Complete(Sample::new(taken, fix))
    }
}
