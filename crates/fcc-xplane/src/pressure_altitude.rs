//! Pressure altitude: X-Plane's own, or else what the pilot's altimeter
//! indicates, corrected by its setting.
//!
//! An altimeter indicates less than the pressure altitude by the pressure
//! altitude of its setting ([`Altimeter`]); for X-Plane's this is assumed, no
//! source was found.
//!
//! A change of the setting may reach us some frames before or after the
//! indicated altitude that it changes: X-Plane may compute the altimeter before
//! it reads the knob, and rows of Data Output come in other datagrams than
//! datarefs. Neither leads to a step:
//! - for [`SETTLES`] after a change, each indicated altitude is corrected by
//!   that of the settings in this time that leaves it nearest to where the
//!   aircraft is expected;
//! - a jump that no known setting explains is passed on: the autopilot's
//!   plausibility gate rejects it until its setting is there. It does not count
//!   for what is expected before it has lasted for [`LASTS_FOR`].
//!
//! Where the aircraft is expected is tracked from the altitudes before by an
//! alpha-beta filter (Benedict and Bordner 1962).

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
/// A setting that was changed may still be in the indicated altitude for this
/// long: five frames at the lowest rate that is not slow.
const SETTLES: Duration = Duration::from_millis(250);
/// An altitude that was not expected counts from then on.
const LASTS_FOR: Duration = Duration::from_millis(150);
/// What an altitude may differ from the expected one: noise, and a click of the
/// knob, 0.01 inHg or 2.8 m.
const MOST_OFF_M: f64 = 4.0;
/// The filter's gains: one altitude by the wrong setting moves it little, and
/// beta is alpha²/(2 - alpha).
const ALPHA: f64 = 0.2;
const BETA: f64 = 0.022;
/// More than are turned through in [`SETTLES`] at 20 frames a second.
const SETTINGS: usize = 8;

/// A setting of the pilot's altimeter.
#[derive(Clone, Copy, Debug)]
struct Setting {
    pa: f64,
    /// The pressure altitude of it, m.
    datum_m: f64,
    /// When another replaced it; never for the present one.
    replaced: Time,
}

/// Finds the pressure altitude.
#[derive(Clone, Debug)]
pub(crate) struct PressureAltitude {
    /// When X-Plane's own last arrived.
    own: Time,
    /// When the altimeter first arrived.
    indicated_since: Time,
    /// The present setting first.
    settings: [Option<Setting>; SETTINGS],
    /// Where the aircraft was, by the altimeter.
    track: Option<Track>,
}

/// Altitude and climb rate at a time.
#[derive(Clone, Copy, Debug)]
struct Track {
    altitude_m: f64,
    climb_mps: f64,
    at: Time,
}

impl Track {
    const fn new(altitude_m: f64, at: Time) -> Self {
        Self {
            altitude_m,
            climb_mps: 0.0,
            at,
        }
    }

    fn expected_m(&self, now: Time) -> f64 {
        self.altitude_m + self.climb_mps * now.since(self.at).as_secs_f64()
    }

    fn after(&self, altitude_m: f64, now: Time) -> Self {
        let passed_s = now.since(self.at).as_secs_f64();
        let off_m = altitude_m - self.expected_m(now);
        if passed_s <= 0.0 {
            return *self;
        }
        Self {
            altitude_m: self.expected_m(now) + ALPHA * off_m,
            climb_mps: self.climb_mps + BETA / passed_s * off_m,
            at: now,
        }
    }
}

impl PressureAltitude {
    pub(crate) const fn new() -> Self {
        Self {
            own: Time::NEVER,
            indicated_since: Time::NEVER,
            settings: [None; SETTINGS],
            track: None,
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
        self.set(setting_pa, taken);
        let is_awaited = taken.since(self.indicated_since) < OWN_WITHIN;
        if is_awaited || taken.since(self.own) < OWN_LOST {
            self.track = None;
            return None;
        }
        let present = self.settings.first().copied().flatten()?;
        let recent = self
            .track
            .filter(|track| taken.since(track.at) < SETTLES)
            .map(|track| (track, track.expected_m(taken)));
        let Some((track, expected_m)) = recent else {
            let altitude_m = indicated_m + present.datum_m;
            self.track = Some(Track::new(altitude_m, taken));
            return Some(altitude_m);
        };
        let altitude_m = self.nearest(indicated_m, expected_m, taken)?;
        if (altitude_m - expected_m).abs() <= MOST_OFF_M {
            self.track = Some(track.after(altitude_m, taken));
        } else if taken.since(track.at) >= LASTS_FOR {
            self.track = Some(Track::new(altitude_m, taken));
        }
        Some(altitude_m)
    }

    /// Takes the present setting.
    fn set(&mut self, pa: f64, now: Time) {
        if let Some(Some(present)) = self.settings.first_mut() {
            if present.pa.to_bits() == pa.to_bits() {
                return;
            }
            present.replaced = now;
        }
        let altimeter = Altimeter {
            setting_pa: pa,
            field_elevation_m: None,
        };
        self.settings.rotate_right(1);
        if let Some(present) = self.settings.first_mut() {
            *present = altimeter
                .datum_m(AltitudeReference::SeaLevel)
                .map(|datum_m| Setting {
                    pa,
                    datum_m,
                    replaced: Time::NEVER,
                });
        }
    }

    /// The pressure altitude nearest to the expected one, by the settings that
    /// may be in the indicated altitude.
    fn nearest(&self, indicated_m: f64, expected_m: f64, now: Time) -> Option<f64> {
        let settings = self.settings.iter().flatten();
        settings
            .filter(|setting| setting.replaced.is_never() || now.since(setting.replaced) < SETTLES)
            .map(|setting| indicated_m + setting.datum_m)
            .min_by(|one, other| {
                (one - expected_m)
                    .abs()
                    .total_cmp(&(other - expected_m).abs())
            })
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

    /// The knob is turned far at 5 s; its value comes up to four frames before
    /// the altitude that it changes, or after it: then the frames between are off
    /// by more than the autopilot's gate lets pass, 50 ft.
    #[test]
    fn no_step_comes_of_a_setting_from_another_frame() {
        for (from, to) in [(29.9, 30.2), (30.2, 29.5), (31.0, 28.5)] {
            for apart in -4..=4 {
                let turned = |ms: i64, when: i64| if ms < when { from } else { to };
                let found = found(|ms| {
                    let indicated_m = reads(turned(ms, 5_000));
                    (indicated_m, turned(ms, 5_000 + apart * FRAME_MS))
                });
                let off_ft = found.iter().map(|found| (found.unwrap() - 3_000.0).abs());
                let off_ft: Vec<_> = off_ft.filter(|feet| *feet > 2.0).collect();
                let case = format!("{from} to {to}, {apart}: {off_ft:?}");
                assert_eq!(off_ft.len() as i64, apart.max(0), "{case}");
                assert!(off_ft.iter().all(|feet| *feet > 50.0), "{case}");
            }
        }
    }

    /// A knob of a tenth of an inch a second, in clicks, for five seconds, in a
    /// climb of 1,000 ft/min. 0.5 inHg are 460 ft here, by the table. The clicks
    /// come with the altitude that they change, up to two frames later, or a
    /// frame earlier: then one altitude for each is off by the click.
    #[test]
    fn no_step_comes_of_a_knob_that_is_turned_on() {
        let clicks = |ms: i64| ((ms.clamp(4_000, 9_000) - 4_000) / 100) as f64;
        for (late, wrong) in [(2, 0), (1, 0), (0, 0), (-1, 50)] {
            let climbed_ft = |ms: i64| 1_000.0 / 60_000.0 * ms as f64;
            let found = found(|ms| {
                let indicated_ft = 2_980.0 + climbed_ft(ms) + 9.2 * clicks(ms - late * FRAME_MS);
                (indicated_ft * FOOT_M, 29.9 + 0.01 * clicks(ms))
            });
            let off_ft = found.iter().zip((2_000 / FRAME_MS)..).map(|(found, n)| {
                let feet = found.unwrap();
                (feet - 3_000.0 - climbed_ft(n * FRAME_MS)).abs()
            });
            let off_ft: Vec<_> = off_ft.collect();
            assert_eq!(
                off_ft.iter().filter(|ft| **ft > 2.0).count(),
                wrong,
                "{late}"
            );
            assert!(off_ft.iter().all(|ft| *ft < 12.0));
        }
    }

    /// Repositioned by 1,000 ft, and the knob is turned half a second later.
    #[test]
    fn a_jump_that_no_setting_explains_is_passed_on() {
        let found = found(|ms| {
            let higher_m = if ms < 5_000 { 0.0 } else { 304.8 };
            let inhg = if ms < 5_500 { 29.9 } else { 30.2 };
            (reads(inhg) + higher_m, inhg)
        });
        for (found, n) in found.iter().zip((2_000 / FRAME_MS)..) {
            let feet = if n * FRAME_MS < 5_000 {
                3_000.0
            } else {
                4_000.0
            };
            assert!((found.unwrap() - feet).abs() < 2.0, "{n}: {found:?}");
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
