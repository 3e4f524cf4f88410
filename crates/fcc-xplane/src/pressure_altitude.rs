//! Pressure altitude: X-Plane's own, or else what the pilot's altimeter
//! indicates, corrected by its setting.
//!
//! An altimeter indicates less than the pressure altitude by the pressure
//! altitude of its setting ([`Altimeter`]); for X-Plane's this is assumed, no
//! source was found.

use core::time::Duration;

use fcc_core::flight::{Altimeter, AltitudeReference, Measurements};
use fcc_core::framework::{Reading, Time};

use crate::values::{Group, Values};

/// After this long without X-Plane's own pressure altitude at first, the
/// altimeter is used. The requests for all datarefs take seven ticks.
const OWN_WITHIN: Duration = Duration::from_millis(300);
/// The same once it has arrived: before the altitude is too old to be flown by.
/// Both come in one datagram as a rule, so that slow frames do not matter.
const OWN_LOST: Duration = Duration::from_millis(150);

/// Finds the pressure altitude.
#[derive(Clone, Debug)]
pub(crate) struct PressureAltitude {
    /// When X-Plane's own last arrived.
    own: Time,
    /// When the altimeter first arrived.
    indicated_since: Time,
}

impl PressureAltitude {
    pub(crate) const fn new() -> Self {
        Self {
            own: Time::NEVER,
            indicated_since: Time::NEVER,
        }
    }

    /// Publishes the altitude, if there is a new one.
    pub(crate) fn publish(&mut self, values: &mut Values, into: &mut Measurements) {
        let own = values
            .whole(Group::PressureAltitude)
            .and_then(|([altitude_m], taken)| Some((self.own(altitude_m, taken)?, taken)));
        let indicated =
            values
                .whole(Group::Altimeter)
                .and_then(|([indicated_m, setting_pa], taken)| {
                    Some((self.indicated(indicated_m, setting_pa, taken)?, taken))
                });
        if let Some((altitude_m, taken)) = own.or(indicated) {
            into.altitude_m = Reading::new(altitude_m, taken);
        }
    }

    /// Takes X-Plane's own pressure altitude, m, and returns it. A version that
    /// does not have it may send 0, to the last bit, which is ignored.
    pub(crate) fn own(&mut self, altitude_m: f64, taken: Time) -> Option<f64> {
        if altitude_m == 0.0 {
            return None;
        }
        self.own = taken;
        Some(altitude_m)
    }

    /// Takes what the pilot's altimeter indicates, m, with its setting, Pa;
    /// returns the pressure altitude if it is to be used.
    pub(crate) fn indicated(
        &mut self,
        indicated_m: f64,
        setting_pa: f64,
        taken: Time,
    ) -> Option<f64> {
        if self.indicated_since.is_never() {
            self.indicated_since = taken;
        }
        let is_awaited = taken.since(self.indicated_since) < OWN_WITHIN;
        if is_awaited || taken.since(self.own) < OWN_LOST {
            return None;
        }
        let altimeter = Altimeter {
            setting_pa,
            field_elevation_m: None,
        };
        let datum_m = altimeter.datum_m(AltitudeReference::SeaLevel)?;
        Some(indicated_m + datum_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOOT_M: f64 = 0.304_8;
    const INHG_PA: f64 = 3_386.389;
    const FRAME_MS: i64 = 25;

    /// Altimeter setting in inHg, feet to be added for the pressure altitude
    /// (FAA-H-8083-25C, figure 11-3).
    const TABLE: [(f64, f64); 5] = [
        (28.5, 1_340.0),
        (29.5, 392.0),
        (29.9, 20.0),
        (30.2, -257.0),
        (31.0, -983.0),
    ];

    fn at(ms: i64) -> Time {
        Time::from_nanos(1_000_000_000_000 + ms * 1_000_000)
    }

    /// What a pilot reads at 3,000 ft pressure altitude, m.
    fn reads(inhg: f64) -> f64 {
        let add_ft = TABLE.iter().find(|(of, _)| *of == inhg).unwrap().1;
        (3_000.0 - add_ft) * FOOT_M
    }

    /// The altitudes in feet from two seconds on, of frames whose indicated
    /// altitude and setting are given by the time in ms.
    fn found(frames: impl Fn(i64) -> (f64, f64)) -> Vec<Option<f64>> {
        let mut altitude = PressureAltitude::new();
        (0..400)
            .map(|n| n * FRAME_MS)
            .map(|ms| {
                let (indicated_m, inhg) = frames(ms);
                altitude.indicated(indicated_m, inhg * INHG_PA, at(ms))
            })
            .map(|found| found.map(|m| m / FOOT_M))
            .skip((2_000 / FRAME_MS) as usize)
            .collect()
    }

    #[test]
    fn the_altimeter_is_corrected_by_the_pilots_table() {
        for (inhg, _) in TABLE {
            for found in found(|_| (reads(inhg), inhg)) {
                assert!((found.unwrap() - 3_000.0).abs() < 1.0, "{inhg}: {found:?}");
            }
        }
    }

    #[test]
    fn x_planes_own_is_preferred_and_a_zero_is_none() {
        let mut altitude = PressureAltitude::new();
        for n in 0..200 {
            let now = at(n * FRAME_MS);
            let has_it = n >= 100;
            let own_m = if has_it { 915.0 } else { 0.0 };
            assert_eq!(altitude.own(own_m, now), has_it.then_some(915.0));
            let indicated = altitude.indicated(914.0, 29.92 * INHG_PA, now);
            assert_eq!(indicated.is_some(), (12..100).contains(&n), "{n}");
        }
        // It stops: the altimeter is used instead, before the last one is too old
        // for control (`failsafe.sensor_max_age_ms`).
        let used = (200..300).find(|n| {
            let now = at(n * FRAME_MS);
            altitude.indicated(914.0, 29.92 * INHG_PA, now).is_some()
        });
        let used = used.unwrap();
        assert!((used - 199) * FRAME_MS + FRAME_MS < 250, "{used}");
    }
}
