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
//!   that of the settings in this time that leaves it nearest to the last;
//! - a jump that no known setting explains is held back for [`HELD_FOR`], for
//!   its setting may be on its way.

use core::time::Duration;

use fcc_core::flight::{Altimeter, AltitudeReference, Measurements};
use fcc_core::framework::{Reading, Time};

use crate::values::{Group, Values};

/// After this long without X-Plane's own pressure altitude, the altimeter is
/// used. The requests for all datarefs take seven ticks.
const OWN_WITHIN: Duration = Duration::from_millis(300);
/// A setting that was changed may still be in the indicated altitude for this
/// long: five frames at the lowest rate that is not slow.
const SETTLES: Duration = Duration::from_millis(250);
/// Less than the age at which an altitude is too old.
const HELD_FOR: Duration = Duration::from_millis(150);
/// What an altitude may differ from the last one: a gust at the static source,
/// and the steepest dive. A click of the knob, 0.01 inHg, is 2.8 m.
const AT_ONCE_M: f64 = 2.0;
const PER_S_M: f64 = 60.0;
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
    /// The last altitude found from the altimeter.
    last: Option<(f64, Time)>,
}

impl PressureAltitude {
    pub(crate) const fn new() -> Self {
        Self {
            own: Time::NEVER,
            indicated_since: Time::NEVER,
            settings: [None; SETTINGS],
            last: None,
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
        if taken.since(self.own.max(self.indicated_since)) < OWN_WITHIN {
            self.last = None;
            return None;
        }
        let altitude_m = match self.last {
            Some((last_m, at)) if taken.since(at) < HELD_FOR => {
                let most_m = AT_ONCE_M + PER_S_M * taken.since(at).as_secs_f64();
                let found_m = self.nearest(indicated_m, last_m, taken)?;
                (found_m - last_m).abs().le(&most_m).then_some(found_m)?
            }
            Some((last_m, at)) if taken.since(at) < SETTLES => {
                self.nearest(indicated_m, last_m, taken)?
            }
            _ => indicated_m + self.settings.first().copied().flatten()?.datum_m,
        };
        self.last = Some((altitude_m, taken));
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

    /// The pressure altitude nearest to the last one, by the settings that may
    /// be in the indicated altitude.
    fn nearest(&self, indicated_m: f64, last_m: f64, now: Time) -> Option<f64> {
        let settings = self.settings.iter().flatten();
        settings
            .filter(|setting| setting.replaced.is_never() || now.since(setting.replaced) < SETTLES)
            .map(|setting| indicated_m + setting.datum_m)
            .min_by(|one, other| (one - last_m).abs().total_cmp(&(other - last_m).abs()))
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

    /// The knob is turned at 5 s; its value comes up to four frames before or
    /// after the altitude that it changes.
    #[test]
    fn no_step_comes_of_a_setting_from_another_frame() {
        for (from, to) in [(29.9, 30.2), (30.2, 29.5), (31.0, 28.5)] {
            for apart in -4..=4 {
                let turned = |ms: i64, when: i64| if ms < when { from } else { to };
                let found = found(|ms| {
                    let indicated_m = reads(turned(ms, 5_000));
                    (indicated_m, turned(ms, 5_000 + apart * FRAME_MS))
                });
                for feet in found.iter().flatten() {
                    assert!(
                        (feet - 3_000.0).abs() < 2.0,
                        "{from} to {to}, {apart}: {feet}"
                    );
                }
                let gap = found.split(Option::is_some).map(<[_]>::len).max();
                assert!(gap.unwrap() <= 4, "{from} to {to}, {apart}: {gap:?}");
            }
        }
    }

    /// A knob of a tenth of an inch a second, in clicks, for five seconds, whose
    /// clicks come a frame late. 0.5 inHg are 460 ft here, by the table.
    #[test]
    fn no_step_comes_of_a_knob_that_is_turned_on() {
        let clicks = |ms: i64| (ms.clamp(4_000, 9_000) - 4_000) / 100;
        let found = found(|ms| {
            let indicated_ft = 2_980.0 + 9.2 * clicks(ms - FRAME_MS) as f64;
            (indicated_ft * FOOT_M, 29.9 + 0.01 * clicks(ms) as f64)
        });
        for feet in found {
            assert!((feet.unwrap() - 3_000.0).abs() < 2.0, "{feet:?}");
        }
    }

    /// Repositioned by 1,000 ft: the altimeter is believed after a moment.
    #[test]
    fn a_jump_that_no_setting_explains_is_believed_later() {
        let found = found(|ms| {
            let higher_m = if ms < 5_000 { 0.0 } else { 304.8 };
            (reads(29.9) + higher_m, 29.9)
        });
        let held = found.iter().filter(|found| found.is_none()).count();
        assert!((4..=6).contains(&held), "{held} frames");
        assert!((found.last().unwrap().unwrap() - 4_000.0).abs() < 1.0);
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
        // It stops: the altimeter is used instead.
        let used = (200..300).find(|n| {
            let now = at(n * FRAME_MS);
            altitude.indicated(914.0, 29.92 * INHG_PA, now).is_some()
        });
        assert_eq!(used, Some(211));
    }
}
