//! The sign of the axial load in row 4 of Data Output.
//!
//! Sources disagree: `ArduPilot` takes it as positive forwards, px4xplane as
//! positive backwards. An accelerometer along the aircraft's x measures g·sin
//! pitch and the change of the airspeed, so a flight shows which it is: with the
//! nose raised or while accelerating, the load is forwards.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::config::AxialLoad;
use crate::units::GRAVITY_MPS2;

/// The means of this much time are compared.
const OVER: Duration = Duration::from_secs(1);
/// What is expected, and what is measured, must be more than this for a
/// comparison: g·sin 2°, of a nose 2° high.
const LEAST_MPS2: f64 = 0.34;
/// The sign is that of this many more comparisons than of the opposite, and may
/// change once as many speak against it.
const DECIDED_BY: i8 = 5;

/// Finds out the sign of the axial load.
#[derive(Clone, Debug)]
pub(crate) struct AxialLoadSign {
    configured: AxialLoad,
    /// Comparisons in favour of forwards, less those against.
    votes: i8,
    backwards: bool,
    began: Time,
    airspeed_mps: f64,
    /// Sums of the load and of g·sin pitch, and their number.
    sums: [f64; 2],
    count: u32,
}

impl AxialLoadSign {
    /// Where rows are the input.
    pub(crate) fn new(configured: Option<AxialLoad>) -> Self {
        let configured = configured.unwrap_or(AxialLoad::Forwards);
        Self {
            configured,
            votes: 0,
            backwards: configured == AxialLoad::Backwards,
            began: Time::NEVER,
            airspeed_mps: 0.0,
            sums: [0.0; 2],
            count: 0,
        }
    }

    /// Whether the load is positive backwards.
    pub(crate) const fn is_backwards(&self) -> bool {
        self.backwards
    }

    /// A load as positive forwards.
    pub(crate) const fn forwards(&self, axial_mps2: f64) -> f64 {
        if self.backwards {
            -axial_mps2
        } else {
            axial_mps2
        }
    }

    /// Compares a load with pitch (rad) and airspeed (m/s), where both are
    /// known.
    pub(crate) fn step(&mut self, now: Time, axial_mps2: f64, flying: Option<(f64, f64)>) {
        let Some((pitch_rad, airspeed_mps)) = flying.filter(|_| self.configured == AxialLoad::Auto)
        else {
            return;
        };
        let took = now.since(self.began);
        if self.began.is_never() || took > 2 * OVER {
            self.begin(now, airspeed_mps);
        } else if took >= OVER && self.count > 0 {
            let [axial, gravity] = self.sums.map(|sum| sum / f64::from(self.count));
            let speeding_up = (airspeed_mps - self.airspeed_mps) / took.as_secs_f64();
            self.vote(axial, gravity + speeding_up);
            self.begin(now, airspeed_mps);
        }
        let [axial, gravity] = &mut self.sums;
        *axial += axial_mps2;
        *gravity += GRAVITY_MPS2 * pitch_rad.sin();
        self.count += 1;
    }

    fn begin(&mut self, now: Time, airspeed_mps: f64) {
        self.began = now;
        self.airspeed_mps = airspeed_mps;
        self.sums = [0.0; 2];
        self.count = 0;
    }

    fn vote(&mut self, axial_mps2: f64, expected_mps2: f64) {
        if axial_mps2.abs() < LEAST_MPS2 || expected_mps2.abs() < LEAST_MPS2 {
            return;
        }
        let vote = if axial_mps2 * expected_mps2 > 0.0 {
            1
        } else {
            -1
        };
        self.votes = (self.votes + vote).clamp(-DECIDED_BY, DECIDED_BY);
        if self.votes.abs() == DECIDED_BY {
            self.backwards = self.votes < 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Duration = Duration::from_millis(25);

    /// Whether the load is found to be backwards after these seconds with the
    /// nose 4° high, where an accelerometer measures 0.684 m/s² forwards.
    fn backwards_after(seconds: i64, configured: AxialLoad, load_mps2: f64) -> bool {
        let mut sign = AxialLoadSign::new(Some(configured));
        let mut now = Time::from_nanos(1_000_000_000);
        for _ in 0..=seconds * 40 {
            now = now + TICK;
            sign.step(now, load_mps2, Some((4.0_f64.to_radians(), 50.0)));
        }
        sign.is_backwards()
    }

    #[test]
    fn a_raised_nose_shows_the_sign_within_five_seconds() {
        assert!(backwards_after(5, AxialLoad::Auto, -0.684));
        assert!(!backwards_after(4, AxialLoad::Auto, -0.684));
        assert!(!backwards_after(60, AxialLoad::Auto, 0.684));
        assert!(
            !backwards_after(60, AxialLoad::Auto, -0.1),
            "too little to tell"
        );
    }

    #[test]
    fn a_configured_sign_is_kept() {
        assert!(!backwards_after(60, AxialLoad::Forwards, -0.684));
        assert!(backwards_after(60, AxialLoad::Backwards, 0.684));
    }

    /// Level acceleration from 40 to 60 m/s at 2 m/s².
    #[test]
    fn speeding_up_shows_the_sign_too() {
        let mut sign = AxialLoadSign::new(Some(AxialLoad::Auto));
        let mut now = Time::from_nanos(1_000_000_000);
        for tick in 0..=400 {
            now = now + TICK;
            sign.step(now, -2.0, Some((0.0, 40.0 + 2.0 * 0.025 * f64::from(tick))));
        }
        assert!(sign.is_backwards());
        assert_eq!(sign.forwards(-2.0), 2.0);
    }
}
