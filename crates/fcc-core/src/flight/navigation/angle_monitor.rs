//! The measured angle of attack is held against lift and path.

use super::airspeed_reason::{Doubt, DoubtReason};

/// A measured angle that differs by more from both is doubted, rad (6°): 3° of
/// rigging that the lift has not learned, and 3° by which a vane on the wing or
/// the fuselage is wrong; in the path, a vertical wind of 3 m/s at 57 kt.
const DOUBTED_RAD: f64 = 0.105;
/// One that differs by less from either agrees, rad (4°).
const AGREES_RAD: f64 = 0.07;
/// Doubted after this time, s: longer than a gust; believed again after this one.
const DOUBTED_AFTER_S: f64 = 1.0;
const BELIEVED_AFTER_S: f64 = 5.0;
/// The lift says little below this multiple of the stalling speed, and the path
/// little in a spin: yaw or roll faster than this, rad/s (20 °/s).
const TELLS_ABOVE: f64 = 1.0;
const TELLS_BELOW_RADPS: f64 = 0.35;

/// What the other sensors say of the angle of attack.
#[derive(Clone, Copy, Debug)]
pub(super) struct OtherAngles {
    pub(super) by_lift_rad: f64,
    pub(super) by_path_rad: f64,
    /// Airspeed over the stalling speed.
    pub(super) speed_ratio: f64,
    /// The faster one of roll and yaw, rad/s.
    pub(super) turning_radps: f64,
}

impl OtherAngles {
    fn are_valid(&self) -> bool {
        self.speed_ratio > TELLS_ABOVE && self.turning_radps < TELLS_BELOW_RADPS
    }

    /// How far a measured angle is from the nearer of the two, rad. A stalled
    /// wing's lift no longer follows the angle, but the path does; vertical wind
    /// moves the path, but not the lift.
    fn distance_rad(&self, measured_rad: f64) -> f64 {
        let by_lift = (measured_rad - self.by_lift_rad).abs();
        by_lift.min((measured_rad - self.by_path_rad).abs())
    }
}

/// Decides whether the measured angle of attack is believed.
#[derive(Clone, Copy, Debug)]
pub(super) struct AngleMonitor {
    doubt: Option<Doubt>,
    /// How long it has contradicted, or agreed again, s.
    lasted_s: f64,
}

impl AngleMonitor {
    pub(super) const fn new() -> Self {
        Self {
            doubt: None,
            lasted_s: 0.0,
        }
    }

    /// The doubt, while it lasts.
    pub(super) const fn doubt(&self) -> Option<Doubt> {
        self.doubt
    }

    /// The measured angle, rad, if it is believed. `measured` has its source;
    /// `impossible` is the source of one that is beyond ±90° or no number.
    pub(super) fn step(
        &mut self,
        measured: Option<(f64, u8)>,
        impossible: Option<u8>,
        others: &OtherAngles,
        dt_s: f64,
    ) -> Option<f64> {
        let source = impossible.or(measured.map(|(_, source)| source));
        if source.is_some_and(|source| self.doubt.is_some_and(|doubt| doubt.source != source)) {
            *self = Self::new();
        }
        let distance_rad = measured
            .filter(|_| impossible.is_none() && others.are_valid())
            .map(|(rad, _)| others.distance_rad(rad));
        let (changes, after_s) = if self.doubt.is_some() {
            let agrees = distance_rad.is_some_and(|rad| rad < AGREES_RAD);
            (agrees, BELIEVED_AFTER_S)
        } else {
            let contradicts = distance_rad.is_some_and(|rad| rad > DOUBTED_RAD);
            (contradicts || impossible.is_some(), DOUBTED_AFTER_S)
        };
        self.lasted_s = if changes { self.lasted_s + dt_s } else { 0.0 };
        if self.lasted_s > after_s {
            self.lasted_s = 0.0;
            let reason = if impossible.is_some() {
                DoubtReason::Impossible
            } else {
                DoubtReason::Contradicts
            };
            self.doubt = match self.doubt {
                Some(_) => None,
                None => source.map(|source| Doubt { source, reason }),
            };
        }
        let believed = measured.filter(|_| self.doubt.is_none() && impossible.is_none());
        believed.map(|(rad, _)| rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREE: f64 = core::f64::consts::PI / 180.0;

    /// Cruise of a Cessna 172 at 100 kt.
    const CRUISE: OtherAngles = OtherAngles {
        by_lift_rad: 2.0 * DEGREE,
        by_path_rad: 2.0 * DEGREE,
        speed_ratio: 1.9,
        turning_radps: 0.0,
    };

    /// Whether a vane that shows this for `seconds` is believed then.
    fn is_believed(
        monitor: &mut AngleMonitor,
        deg: f64,
        others: OtherAngles,
        seconds: f64,
    ) -> bool {
        let step = |_| monitor.step(Some((deg * DEGREE, 3)), None, &others, 0.025);
        (0..(seconds * 40.0) as u32)
            .map(step)
            .last()
            .flatten()
            .is_some()
    }

    #[test]
    fn a_jammed_vane_is_doubted_after_a_second_and_believed_when_it_agrees() {
        for jammed_deg in [-20.0, -5.0, 12.0, 15.0, 85.0] {
            let mut monitor = AngleMonitor::new();
            assert!(is_believed(&mut monitor, jammed_deg, CRUISE, 0.9));
            assert!(!is_believed(&mut monitor, jammed_deg, CRUISE, 0.2));
            let doubt = Doubt {
                source: 3,
                reason: DoubtReason::Contradicts,
            };
            assert_eq!(monitor.doubt(), Some(doubt));
            assert!(!is_believed(&mut monitor, 3.0, CRUISE, 4.5));
            assert!(is_believed(&mut monitor, 3.0, CRUISE, 1.0));
        }
    }

    /// A value beyond ±90° does not pass the gate: nothing is measured then.
    #[test]
    fn an_impossible_value_is_doubted_after_a_second() {
        let mut monitor = AngleMonitor::new();
        for _ in 0..50 {
            assert_eq!(monitor.step(None, Some(1), &CRUISE, 0.025), None);
        }
        let reason = monitor.doubt().map(|doubt| doubt.reason);
        assert_eq!(reason, Some(DoubtReason::Impossible));
    }

    /// Beyond the stall 25° give the lift of 12°, and the path sinks: pitch 5°,
    /// path -20°. In a spin, and in a strong vertical wind, one of the two says
    /// nothing either.
    #[test]
    fn a_stall_a_spin_and_a_vertical_wind_leave_it_believed() {
        let stalled = OtherAngles {
            by_lift_rad: 12.0 * DEGREE,
            by_path_rad: 25.0 * DEGREE,
            speed_ratio: 1.1,
            ..CRUISE
        };
        assert!(is_believed(&mut AngleMonitor::new(), 25.0, stalled, 10.0));
        let spinning = OtherAngles {
            by_path_rad: 0.0,
            turning_radps: 1.5,
            ..stalled
        };
        assert!(is_believed(&mut AngleMonitor::new(), 35.0, spinning, 10.0));
        let wind = OtherAngles {
            by_path_rad: 14.0 * DEGREE,
            ..CRUISE
        };
        assert!(is_believed(&mut AngleMonitor::new(), 3.0, wind, 60.0));
    }
}
