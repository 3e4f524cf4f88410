//! The layout of the stored state of a flight, and which states can be those of
//! a flight.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use fcc_core::flight::{AltitudeReference, Position, Surfaces};
use fcc_fixed_wing::Resume;
use fcc_guidance::route::TookOff;
use fcc_guidance::{Mode, Progress, Targets};
use fcc_telemetry::units::{COMMANDED_ALTIMETER_SETTING_PA, COMMANDED_HEADING_RAD};
use serde::{Deserialize, Serialize};

use super::boot_clock::BootInstant;
use super::saved::{Saved, SavedCommands, SavedPlan, SavedSwitch};

/// The stored state of a flight as named numbers.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Page {
    boot: String,
    boottime_ns: u64,
    config: u32,
    switch_on: bool,
    /// Not in the files of earlier versions, which knew one sensor.
    #[serde(default)]
    switch_source: u8,
    #[serde(rename = "take_ups")]
    recoveries: u32,
    mode: String,
    /// Of a plan or a pattern; not in the files of earlier versions.
    #[serde(default)]
    item: u32,
    elapsed_s: f64,
    airspeed_mps: f64,
    heading_rad: f64,
    altitude_m: f64,
    #[serde(default)]
    altimeter_setting_pa: Option<f64>,
    /// The number of what the altitude refers to.
    #[serde(default)]
    altitude_reference: u8,
    throttle: f64,
    elevator: f64,
    aileron: f64,
    rudder: f64,
    /// Of the flight plan; not in the files of earlier versions.
    #[serde(default)]
    plan_hash: u64,
    #[serde(default)]
    plan_uploaded_unix_s: u64,
    /// Commanded; not in the files of earlier versions.
    #[serde(default)]
    go_to: Option<[f64; 3]>,
    #[serde(default)]
    promised_s: Option<f64>,
    /// Latitude, longitude and course, rad, and elevation, m, of where it took off; not
    /// in the files of earlier versions.
    #[serde(default)]
    took_off: Option<[f64; 4]>,
}

/// The pressure altitudes that a flight can have captured, m: those that can be
/// commanded, by the lowest and the highest altimeter setting.
const CAPTURED_ALTITUDE_M: RangeInclusive<f64> = -1_500.0..=21_000.0;
/// True course of a runway, rad.
const COURSE_RAD: RangeInclusive<f64> = -PI..=PI;
/// No flight has lasted longer, s: 3 years.
const LONGEST_S: f64 = 1e8;
/// What a commander can promise, s.
const PROMISED_S: RangeInclusive<f64> = 0.0..=3_600.0;
/// None has been faster, m/s.
const FASTEST_MPS: f64 = 1_000.0;

impl Page {
    /// Of a state.
    pub(super) fn of(saved: &Saved) -> Self {
        let Resume {
            progress, surfaces, ..
        } = saved.resume;
        let targets = progress.captured;
        let from = saved.resume.took_off;
        Self {
            boot: saved.at.boot.clone(),
            boottime_ns: saved.at.ns,
            config: saved.config,
            switch_on: saved.switch.on,
            switch_source: saved.switch.source,
            recoveries: saved.recoveries,
            mode: progress.mode.to_string(),
            item: progress.item,
            elapsed_s: progress.elapsed_s,
            airspeed_mps: targets.airspeed_mps,
            heading_rad: targets.heading_rad,
            altitude_m: targets.altitude_m,
            altimeter_setting_pa: saved.resume.altimeter_setting_pa,
            altitude_reference: saved.resume.altitude_reference as u8,
            throttle: surfaces.throttle,
            elevator: surfaces.elevator,
            aileron: surfaces.aileron,
            rudder: surfaces.rudder,
            plan_hash: saved.plan.hash,
            plan_uploaded_unix_s: saved.plan.uploaded_unix_s,
            go_to: (saved.commanded.go_to)
                .map(|to| [to.latitude_rad, to.longitude_rad, to.altitude_m]),
            promised_s: saved.commanded.promised_s,
            took_off: (from != TookOff::default()).then_some([
                from.latitude_rad,
                from.longitude_rad,
                from.course_rad,
                from.elevation_m,
            ]),
        }
    }

    /// The state; none if it cannot be that of a flight.
    pub(super) fn saved(self) -> Option<Saved> {
        let reference = AltitudeReference::from_number(self.altitude_reference);
        let surfaces = self.surfaces();
        let mode = Mode::ALL.into_iter().find(|mode| mode.name() == self.mode);
        let commanded = self.commanded();
        let took_off = self.took_off();
        if !self.can_be_flown() {
            return None;
        }
        Some(Saved {
            at: BootInstant {
                boot: self.boot,
                ns: self.boottime_ns,
            },
            config: self.config,
            switch: SavedSwitch {
                on: self.switch_on,
                source: self.switch_source,
            },
            recoveries: self.recoveries,
            plan: SavedPlan {
                hash: self.plan_hash,
                uploaded_unix_s: self.plan_uploaded_unix_s,
            },
            resume: Resume {
                progress: Progress {
                    mode: mode?,
                    item: self.item,
                    elapsed_s: self.elapsed_s,
                    captured: Targets {
                        airspeed_mps: self.airspeed_mps,
                        heading_rad: self.heading_rad,
                        altitude_m: self.altitude_m,
                    },
                },
                surfaces,
                altimeter_setting_pa: self.altimeter_setting_pa,
                altitude_reference: reference?,
                took_off,
            },
            commanded,
        })
    }

    /// Whether its numbers are those of a flight.
    fn can_be_flown(&self) -> bool {
        (0.0..=LONGEST_S).contains(&self.elapsed_s)
            && (0.0..=FASTEST_MPS).contains(&self.airspeed_mps)
            && COMMANDED_HEADING_RAD.contains(&self.heading_rad)
            && CAPTURED_ALTITUDE_M.contains(&self.altitude_m)
            && self
                .altimeter_setting_pa
                .is_none_or(|pa| COMMANDED_ALTIMETER_SETTING_PA.contains(&pa))
            && self
                .promised_s
                .is_none_or(|within_s| PROMISED_S.contains(&within_s))
            && (self.commanded().go_to)
                .is_none_or(|to| to.is_on_earth() && CAPTURED_ALTITUDE_M.contains(&to.altitude_m))
            && (self.took_off.is_none()
                || (self.took_off().known()).is_some_and(|from| {
                    COURSE_RAD.contains(&from.course_rad)
                        && CAPTURED_ALTITUDE_M.contains(&from.elevation_m)
                }))
            && self.surfaces().is_valid()
    }

    fn took_off(&self) -> TookOff {
        let [latitude_rad, longitude_rad, course_rad, elevation_m] =
            self.took_off.unwrap_or_default();
        TookOff {
            latitude_rad,
            longitude_rad,
            course_rad,
            elevation_m,
        }
    }

    fn commanded(&self) -> SavedCommands {
        let go_to = self.go_to;
        SavedCommands {
            go_to: go_to.map(|[latitude_rad, longitude_rad, altitude_m]| Position {
                latitude_rad,
                longitude_rad,
                altitude_m,
            }),
            promised_s: self.promised_s,
        }
    }

    const fn surfaces(&self) -> Surfaces {
        Surfaces {
            throttle: self.throttle,
            elevator: self.elevator,
            aileron: self.aileron,
            rudder: self.rudder,
            // It stays where it is, and is measured.
            ..Surfaces::IDLE
        }
    }
}
