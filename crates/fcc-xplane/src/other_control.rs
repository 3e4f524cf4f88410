//! What acts on the controls besides this program.
//!
//! X-Plane adds up the yoke, the servos of its own autopilot and its artificial
//! stability: `override_joystick` replaces the first only (DataRefs.txt of 12.10:
//! `total_pitch_ratio` is "sum of user yoke plus autopilot servo plus artificial
//! stability"). So its autopilot, and plugins that compute the artificial
//! stability or move the surfaces themselves, act whatever is written to the
//! yoke.

use core::time::Duration;

use fcc_core::flight::OtherControl;
use fcc_core::framework::Time;

use crate::lasting::Lasting;
use crate::link::{Control, SharedState};
use crate::quantity::Quantity;
use crate::values::Values;

const SERVOS: [Quantity; 3] = [Quantity::Servos, Quantity::Servos2, Quantity::Servos3];
const PLUGINS: [Quantity; 3] = [
    Quantity::OverrideStability,
    Quantity::OverrideFlightControl,
    Quantity::OverrideSurfaces,
];
const STABILITY: [Quantity; 3] = [
    Quantity::StabilityPitch,
    Quantity::StabilityRoll,
    Quantity::StabilityHeading,
];
const YOKE: [Quantity; 3] = [
    Quantity::YokePitch,
    Quantity::YokeRoll,
    Quantity::YokeHeading,
];

/// Artificial stability counts from 2 % of the controls' travel upwards, and
/// until it has been less for 10 s: a yaw damper passes through 0 all the time.
const STABILITY_RATIO: f64 = 0.02;
const STABILITY_ENDS: Duration = Duration::from_secs(10);

/// Thrust is reversed below this throttle: idle is read as 0, or a rounding
/// error less.
const REVERSE_BELOW: f64 = -0.01;
/// `ENGN_propmode` in reverse, for jets as well.
const MODE_REVERSE: f64 = 3.0;

/// A yoke that is overridden by another program moves by more than this, at
/// intervals of less than [`MOVES_WITHIN`], for [`WRITER_BEGINS`]. One that
/// stands still was left overridden by a program that has ended; that is
/// reported after [`LEFT_AFTER`], in which the release helper of a daemon that
/// was killed has usually released it.
const MOVED: f64 = 0.005;
const MOVES_WITHIN: Duration = Duration::from_millis(500);
const WRITER_BEGINS: Duration = Duration::from_secs(1);
const WRITER_ENDS: Duration = Duration::from_secs(2);
const LEFT_AFTER: Duration = Duration::from_secs(3);

/// Finds out what acts on the controls besides this program.
#[derive(Clone, Debug)]
pub(crate) struct OtherControlWatch {
    stability: Lasting,
    yoke: [f64; 3],
    moved: Time,
    writer: Lasting,
    left: Lasting,
    /// When a reading first said that thrust is reversed; never if the last one
    /// did not.
    reversed: Time,
}

impl Default for OtherControlWatch {
    fn default() -> Self {
        Self {
            stability: Lasting::new(Duration::ZERO, STABILITY_ENDS),
            yoke: [0.0; 3],
            moved: Time::NEVER,
            writer: Lasting::new(WRITER_BEGINS, WRITER_ENDS),
            left: Lasting::new(LEFT_AFTER, Duration::ZERO),
            reversed: Time::NEVER,
        }
    }
}

impl OtherControlWatch {
    /// Evaluates the latest values; what is not known counts as off. `writing`
    /// is the connection over which this program writes.
    pub(crate) fn step(
        &mut self,
        now: Time,
        values: &Values,
        writing: &SharedState,
    ) -> OtherControl {
        let recent = |quantity| values.recent(quantity, now);
        let is_set = |quantity| recent(quantity).is_some_and(|value| value >= 0.5);
        let augmented = STABILITY
            .iter()
            .any(|axis| recent(*axis).is_some_and(|ratio| ratio.abs() >= STABILITY_RATIO));
        OtherControl {
            autopilot: SERVOS.into_iter().any(is_set),
            autothrottle: is_set(Quantity::Autothrottle),
            fly_by_wire: PLUGINS.into_iter().any(is_set),
            stability: self.stability.step(now, augmented),
            writer: self.is_written(now, values, writing) || writing.has_other_writer(),
            reverse_thrust: self.is_reversed(now, values),
        }
    }

    /// Whether thrust is reversed, by two readings in a row.
    fn is_reversed(&mut self, now: Time, values: &Values) -> bool {
        let since = |quantity, says: fn(f64) -> bool| {
            let reading = values.recent(quantity, now).filter(|value| says(*value));
            reading.map(|_| values.arrived(quantity))
        };
        let throttle = since(Quantity::Throttle, |ratio| ratio < REVERSE_BELOW);
        let mode = since(Quantity::EngineMode, |mode| mode == MODE_REVERSE);
        let Some(arrived) = throttle.max(mode) else {
            self.reversed = Time::NEVER;
            return false;
        };
        if self.reversed.is_never() {
            self.reversed = arrived;
        }
        arrived > self.reversed
    }

    /// Whether another program writes the yoke while this one does not.
    fn is_written(&mut self, now: Time, values: &Values, writing: &SharedState) -> bool {
        let is_set = |quantity| {
            values
                .recent(quantity, now)
                .is_some_and(|value| value >= 0.5)
        };
        let overridden = is_set(Quantity::OverrideJoystick);
        for (was, axis) in self.yoke.iter_mut().zip(YOKE) {
            let is = values.recent(axis, now).unwrap_or(*was);
            if (is - *was).abs() > MOVED {
                *was = is;
                self.moved = now;
            }
        }
        let moves = !self.moved.is_never() && now.since(self.moved) < MOVES_WITHIN;
        let free = writing.control() == Control::Free;
        let stands = (overridden || is_set(Quantity::OverrideThrottles)) && !moves;
        writing.set_left_overridden(self.left.step(now, free && stands));
        self.writer.step(now, free && overridden && moves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Duration = Duration::from_millis(25);

    struct Bench {
        watch: OtherControlWatch,
        values: Values,
        link: SharedState,
        now: Time,
    }

    impl Bench {
        fn new() -> Self {
            Self {
                watch: OtherControlWatch::default(),
                values: Values::default(),
                link: SharedState::new(None),
                now: Time::from_nanos(1_000_000_000),
            }
        }

        fn tick(&mut self, values: &[(Quantity, f64)]) -> OtherControl {
            self.now = self.now + TICK;
            for (quantity, value) in values {
                self.values.set(*quantity, *value, self.now);
            }
            self.watch.step(self.now, &self.values, &self.link)
        }
    }

    #[test]
    fn each_dataref_is_named_and_an_old_x_plane_without_them_is_quiet() {
        let alone = OtherControl::default();
        assert_eq!(Bench::new().tick(&[(Quantity::Airspeed, 50.0)]), alone);
        let is = |quantity, value| Bench::new().tick(&[(quantity, value)]);
        for servos in SERVOS {
            assert_eq!(is(servos, 0.0), alone);
            assert_eq!(
                is(servos, 1.0),
                OtherControl {
                    autopilot: true,
                    ..alone
                }
            );
        }
        let throttle = OtherControl {
            autothrottle: true,
            ..alone
        };
        assert_eq!(is(Quantity::Autothrottle, 1.0), throttle);
        for plugin in PLUGINS {
            assert_eq!(
                is(plugin, 1.0),
                OtherControl {
                    fly_by_wire: true,
                    ..alone
                }
            );
        }
        let reversed = OtherControl {
            reverse_thrust: true,
            ..alone
        };
        let twice = |quantity, value| {
            let mut bench = Bench::new();
            assert_eq!(bench.tick(&[(quantity, value)]), alone);
            // Without a new reading.
            assert_eq!(bench.tick(&[]), alone);
            bench.tick(&[(quantity, value)])
        };
        assert_eq!(twice(Quantity::Throttle, -0.4), reversed);
        assert_eq!(is(Quantity::Throttle, 0.0), alone);
        assert_eq!(is(Quantity::Throttle, 1.2), alone);
        assert_eq!(twice(Quantity::EngineMode, 3.0), reversed);
        assert_eq!(is(Quantity::EngineMode, 1.0), alone);
    }

    /// A yaw damper of 5 % at half a cycle a second passes through 0 once a
    /// second.
    #[test]
    fn a_yaw_damper_is_noticed_without_interruption_until_it_is_off() {
        let mut bench = Bench::new();
        for tick in 0..400 {
            let ratio = 0.05 * (f64::from(tick) * 0.025 * core::f64::consts::PI).cos();
            assert!(bench.tick(&[(Quantity::StabilityHeading, ratio)]).stability);
        }
        for _ in 0..399 {
            assert!(bench.tick(&[(Quantity::StabilityHeading, 0.0)]).stability);
        }
        for _ in 0..40 {
            bench.tick(&[(Quantity::StabilityHeading, 0.0)]);
        }
        assert!(!bench.tick(&[(Quantity::StabilityHeading, 0.0)]).stability);
    }

    #[test]
    fn a_yoke_that_moves_while_overridden_has_another_writer() {
        let fly = |overridden: f64, moves: bool, control: Control| {
            let mut bench = Bench::new();
            bench.link.set_control(control);
            let mut other = OtherControl::default();
            for tick in 0..60 {
                let yoke = if moves {
                    (f64::from(tick) * 0.1).sin()
                } else {
                    0.3
                };
                other = bench.tick(&[
                    (Quantity::OverrideJoystick, overridden),
                    (Quantity::YokePitch, yoke),
                ]);
            }
            other.writer
        };
        assert!(fly(1.0, true, Control::Free));
        assert!(!fly(0.0, true, Control::Free), "the pilot's joystick");
        assert!(
            !fly(1.0, false, Control::Free),
            "left by a program that ended"
        );
        assert!(!fly(1.0, true, Control::Held), "this program");
    }
}
