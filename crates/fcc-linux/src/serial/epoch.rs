//! Fixes from the sentences of NMEA, each of which has a part of one.

use core::time::Duration;

use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_core::framework::Time;
use fcc_device::{EpochOrder, NO_FIX, SLOW_FIXES, VerticalSpeed};

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
    /// By the last GSA: the altitude of GGA is held.
    is_flat: bool,
    /// Sentences have none.
    vertical_speed: VerticalSpeed,
    order: EpochOrder,
    since_fix: Heard,
}

/// How many sentences have come since the last fix.
#[derive(Clone, Copy, Debug, Default)]
struct Heard {
    /// From the first to the last.
    span: Option<(Time, Time)>,
    motions: u32,
    places: u32,
    /// Epochs that are complete but for the vertical speed.
    without_climb: u32,
}

/// A receiver that sends a sentence sends it within this time.
const SENT_WITHIN: Duration = Duration::from_secs(10);

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
            is_flat: false,
            vertical_speed: VerticalSpeed::default(),
            order: EpochOrder::of_day(),
            since_fix: Heard::default(),
        }
    }
}

impl Epochs {
    /// Takes a sentence that has arrived at a time.
    pub fn take(&mut self, sentence: Sentence, arrived: Time) -> Epoch {
        let heard = &mut self.since_fix;
        heard.span = Some((heard.span.map_or(arrived, |(first, _)| first), arrived));
        match sentence {
            Sentence::Motion(motion) => {
                self.motion = motion;
                heard.motions = heard.motions.saturating_add(1);
            }
            Sentence::Place(place) => {
                self.place = place.filter(|_| !self.is_flat);
                heard.places = heard.places.saturating_add(1);
            }
            Sentence::Accuracy {
                horizontal_m,
                vertical_m,
            } => {
                self.accuracy_m = [horizontal_m, vertical_m];
                return Epoch::Incomplete;
            }
            Sentence::Kind { has_altitude } => {
                self.is_flat = !has_altitude;
                return Epoch::Incomplete;
            }
            Sentence::Other => return Epoch::Incomplete,
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
            self.since_fix.without_climb += 1;
            return Epoch::Incomplete;
        };
        self.since_fix = Heard::default();
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

    /// What is missing for a fix, by the sentences since the last one, and what to do
    /// about that. The first epoch has no vertical speed at any rate: after it, `None`.
    pub fn waits_for(&self) -> Option<&'static str> {
        if self.is_flat {
            return Some(NO_FIX);
        }
        let heard = self.since_fix;
        match heard.without_climb {
            0 => {}
            1 => return None,
            _ => return Some(SLOW_FIXES),
        }
        let span = heard
            .span
            .map_or(Duration::ZERO, |(first, last)| last.since(first));
        match (heard.places, heard.motions) {
            (0, 0) => (span > SENT_WITHIN).then_some(NEITHER),
            (2.., 0) => Some(NO_RMC),
            (0, 2..) => Some(NO_GGA),
            _ if self.motion.is_none() && self.place.is_some() => Some(NO_SPEED),
            // Those of one time would have been taken.
            _ if self.motion.is_some() && self.place.is_some() => Some(NOT_TOGETHER),
            _ => Some(NO_FIX),
        }
    }
}

const NO_RMC: &str = "GGA arrives and no RMC, which has the speed: switch RMC on, at the \
                      receiver's port that is used";
const NO_GGA: &str = "RMC arrives and no GGA, which has the altitude: switch GGA on, at the \
                      receiver's port that is used";
const NO_SPEED: &str = "GGA has a place, and RMC no valid speed and course: wait until the receiver \
                        knows them, or set its binary protocol";
const NEITHER: &str = "sentences arrive, and neither GGA nor RMC: switch both on, at the \
                       receiver's port that is used";
const NOT_TOGETHER: &str = "GGA and RMC never have the same time: set both to the same rate";
