//! When a retractable gear goes up and down.

use super::super::Autopilot;
use fcc_core::flight::Surfaces;
use fcc_guidance::OverGroundMode;
use fcc_guidance::route::RunwayPhase;

/// The gear is down below this height over a runway, m (100 ft).
const UP_ABOVE_M: f64 = 30.48;
/// It goes up when the aircraft climbs faster than this, m/s (100 ft/min).
const UP_CLIMBING_MPS: f64 = 0.508;
const UP: Option<f64> = Some(0.0);
const DOWN: Option<f64> = Some(1.0);

/// What decides about the gear.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Decision {
    /// Of a take-off or a landing.
    phase: Option<RunwayPhase>,
    /// Whether a failsafe lands it, or a glide without power is on its final.
    lands: bool,
    on_wheels: bool,
    /// Above the runway, m.
    height_m: f64,
    climb_rate_mps: f64,
    /// What was written last; none leaves the gear as it is.
    before: Option<f64>,
}

impl Decision {
    fn gear(&self) -> Option<f64> {
        if self.lands {
            return DOWN;
        }
        let climbs = matches!(self.phase?, RunwayPhase::Climb | RunwayPhase::GoAround);
        // A height that is not known is none.
        let is_high = self.height_m >= UP_ABOVE_M;
        if !(climbs && is_high) {
            return DOWN;
        }
        // A gust in the climb does not lower it again.
        let is_up = self.before == UP;
        if is_up || self.climb_rate_mps > UP_CLIMBING_MPS && !self.on_wheels {
            UP
        } else {
            self.before
        }
    }
}

impl Autopilot {
    /// The outputs with the gear, if it is retractable.
    pub(in super::super) fn with_gear(&self, outputs: Surfaces) -> Surfaces {
        if !self.config.route.runway.retractable_gear {
            return outputs;
        }
        let demand = self.guidance.runway();
        let mode = self.guidance.mode.over_ground();
        let decision = Decision {
            phase: demand.map(|demand| demand.phase),
            lands: mode.is_some_and(OverGroundMode::glides_to_land),
            on_wheels: self.estimator.ground.stands_on_wheels(),
            height_m: demand.map_or(0.0, |demand| demand.height_m),
            climb_rate_mps: self.estimator.estimate().climb_rate_mps,
            before: self.loops.last.gear,
        };
        Surfaces {
            gear: decision.gear(),
            ..outputs
        }
    }

    /// The gear in a failsafe: down if it ends on the ground; otherwise it stays as it is,
    /// since heights may be wrong.
    pub(in super::super) fn gear_in_failsafe(&self, stops_on_wheels: bool) -> Option<f64> {
        if !self.config.route.runway.retractable_gear {
            return None;
        }
        let decision = Decision {
            phase: None,
            lands: stops_on_wheels
                || self.supervisor.degraded.lands()
                || self.supervisor.degraded.glides,
            on_wheels: false,
            height_m: 0.0,
            climb_rate_mps: 0.0,
            before: None,
        };
        decision.gear()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The climb of a take-off in which the gear goes up.
    const CLIMB: Decision = Decision {
        phase: Some(RunwayPhase::Climb),
        lands: false,
        on_wheels: false,
        height_m: 31.0,
        climb_rate_mps: 3.0,
        before: DOWN,
    };

    #[test]
    fn it_goes_up_in_the_climb_of_a_take_off_and_of_a_go_around() {
        assert_eq!(CLIMB.gear(), Some(0.0));
        let phase = Some(RunwayPhase::GoAround);
        assert_eq!(Decision { phase, ..CLIMB }.gear(), Some(0.0));
        // It was engaged there, with the gear in any position.
        let before = None;
        assert_eq!(Decision { before, ..CLIMB }.gear(), Some(0.0));
    }

    #[test]
    fn it_stays_down_below_30_m_without_a_climb_and_with_weight_on_wheels() {
        for height_m in [-1.0, 0.0, 30.0, f64::NAN] {
            for before in [None, UP, DOWN] {
                let low = Decision {
                    height_m,
                    before,
                    ..CLIMB
                };
                assert_eq!(low.gear(), Some(1.0), "{low:?}");
            }
        }
        for climb_rate_mps in [-3.0, 0.0, 0.5, f64::NAN] {
            let slow = Decision {
                climb_rate_mps,
                ..CLIMB
            };
            assert_eq!(slow.gear(), Some(1.0), "{slow:?}");
        }
        let on_wheels = true;
        assert_eq!(Decision { on_wheels, ..CLIMB }.gear(), Some(1.0));
    }

    #[test]
    fn once_up_a_gust_in_the_climb_does_not_lower_it() {
        let sinking = Decision {
            climb_rate_mps: -2.0,
            before: UP,
            ..CLIMB
        };
        assert_eq!(sinking.gear(), Some(0.0));
    }

    #[test]
    fn it_is_down_in_the_roll_and_from_the_approach_to_the_stop() {
        use RunwayPhase::{Approach, Flare, Hand, Roll, RollOut, Rotate, Stopped};
        for phase in [Hand, Roll, Rotate, Approach, Flare, RollOut, Stopped] {
            for before in [None, UP, DOWN] {
                let there = Decision {
                    phase: Some(phase),
                    height_m: 300.0,
                    before,
                    ..CLIMB
                };
                assert_eq!(there.gear(), Some(1.0), "{there:?}");
            }
        }
    }

    #[test]
    fn elsewhere_it_is_left_as_it_is_unless_the_flight_ends_there() {
        let phase = None;
        assert_eq!(Decision { phase, ..CLIMB }.gear(), None);
        for phase in [None, Some(RunwayPhase::Climb)] {
            let landing = Decision {
                phase,
                lands: true,
                ..CLIMB
            };
            assert_eq!(landing.gear(), Some(1.0));
        }
    }
}
