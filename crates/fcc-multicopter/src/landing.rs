//! The landing detector.

use crate::estimator::State;
use crate::values::GroundContact;

/// Slower than this it does not sink, m/s; faster than the other one it does not stand.
const SINKS_MPS: f64 = 0.25;
const MOVES_MPS: f64 = 1.5;
/// 20 °/s.
const TURNS_RADPS: f64 = 0.35;
/// Thrust over hover thrust: less while a descent is commanded means that something carries it.
const CARRIED: f64 = 0.75;
/// With no more than this it stands.
const STANDS: f64 = 0.3;
/// How long each stage lasts before the next one, s (PX4: 0.35, 0.25, 0.3).
const TOUCHING_S: f64 = 0.35;
const STANDING_S: f64 = 0.25;
const LANDED_S: f64 = 0.3;

/// Detects in three stages that a descent has ended on the ground. What contradicts a stage
/// before the last one begins again; only a take-off ends the last one.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LandingDetector {
    stage: GroundContact,
    /// How long the next stage's conditions have held, s.
    since_s: f64,
}

impl LandingDetector {
    /// On the ground.
    pub const LANDED: Self = Self {
        stage: GroundContact::Landed,
        since_s: 0.0,
    };
    /// In the air.
    pub const FLYING: Self = Self {
        stage: GroundContact::Flying,
        since_s: 0.0,
    };

    /// What it sees.
    pub const fn stage(&self) -> GroundContact {
        self.stage
    }

    /// How probable it is that something touches the ground, 0..=1: what presses it sideways
    /// would tip it over.
    pub fn suspicion(&self) -> f64 {
        if self.stage == GroundContact::Flying {
            self.since_s / TOUCHING_S
        } else {
            1.0
        }
    }

    /// Takes a tick: whether a descent is commanded, and thrust over hover thrust.
    pub fn step(&mut self, descends: bool, thrust: f64, state: &State, dt_s: f64) {
        let sinks = state.velocity_mps.z.abs() >= SINKS_MPS;
        let still = !sinks
            && state.velocity_mps.norm() < MOVES_MPS
            && state.rates_radps.norm() < TURNS_RADPS;
        let touches = descends && !sinks;
        let (keeps, goes_on, next, after_s) = match self.stage {
            GroundContact::Flying => (
                true,
                touches && thrust < CARRIED,
                GroundContact::Touching,
                TOUCHING_S,
            ),
            GroundContact::Touching => (
                touches,
                still && thrust <= STANDS,
                GroundContact::Standing,
                STANDING_S,
            ),
            GroundContact::Standing => (still, still, GroundContact::Landed, LANDED_S),
            GroundContact::Landed => return,
        };
        if !keeps {
            *self = Self::FLYING;
        } else if !goes_on {
            self.since_s = 0.0;
        } else {
            self.since_s += dt_s;
            if self.since_s >= after_s {
                self.stage = next;
                self.since_s = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn sinking(mps: f64) -> State {
        State {
            velocity_mps: Vector3::new(0.0, 0.0, mps),
            ..State::default()
        }
    }

    fn after(
        detector: &mut LandingDetector,
        seconds: f64,
        thrust: f64,
        sink_mps: f64,
    ) -> GroundContact {
        for _ in 0..(seconds * 400.0) as u32 {
            detector.step(true, thrust, &sinking(sink_mps), 0.0025);
        }
        detector.stage()
    }

    #[test]
    fn three_stages_lead_to_the_ground() {
        let mut detector = LandingDetector::FLYING;
        assert_eq!(after(&mut detector, 2.0, 0.9, 0.5), GroundContact::Flying);
        assert_eq!(after(&mut detector, 0.4, 0.7, 0.0), GroundContact::Touching);
        assert_eq!(after(&mut detector, 1.0, 0.6, 0.0), GroundContact::Touching);
        assert_eq!(after(&mut detector, 0.3, 0.2, 0.0), GroundContact::Standing);
        assert_eq!(after(&mut detector, 0.35, 0.2, 0.0), GroundContact::Landed);
    }

    /// A gust from below carries it for a moment (PX4 issues 5083 and 6730: motors off in the
    /// air).
    #[test]
    fn what_still_sinks_flies() {
        let mut detector = LandingDetector::FLYING;
        assert_eq!(after(&mut detector, 0.3, 0.6, 0.1), GroundContact::Flying);
        assert_eq!(after(&mut detector, 0.1, 0.6, 0.5), GroundContact::Flying);
        assert_eq!(after(&mut detector, 0.4, 0.6, 0.1), GroundContact::Touching);
        assert_eq!(after(&mut detector, 0.1, 0.5, 0.6), GroundContact::Flying);
        assert_eq!(after(&mut detector, 0.4, 0.6, 0.1), GroundContact::Touching);
        assert_eq!(after(&mut detector, 0.3, 0.2, 0.1), GroundContact::Standing);
        assert_eq!(after(&mut detector, 0.1, 0.2, 1.0), GroundContact::Flying);
    }
}
