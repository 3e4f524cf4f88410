//! A tick as the screens show it, from its record.

use fcc_core::flight::Measurements;
use fcc_core::framework::{Controller, Flags, Reading, Readings as _, Time};
use fcc_fixed_wing::{Autopilot, flags};
use fcc_flight::flight::FlightTime;
use fcc_telemetry::{FlightRecord, ShownAltitude};
use serde::Serialize;

/// A tick.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Now {
    /// Since the loop's first tick.
    time_s: f64,
    tick: u64,
    /// `standby`, `engaged`, `failsafe` or `stopped`.
    state: String,
    /// Guidance's mode and progress.
    mode: String,
    /// How long it is engaged; none while it is not.
    engaged_for_s: Option<f64>,
    /// Why it cannot engage.
    engage_inhibits: Vec<&'static str>,
    faults: Vec<&'static str>,
    /// What was measured at least once.
    readings: Vec<ShownReading>,
    // Of these four none that is lost.
    roll_rad: Option<f64>,
    pitch_rad: Option<f64>,
    heading_rad: Option<f64>,
    airspeed_mps: Option<f64>,
    /// Above `altitude_reference`.
    altitude_m: Option<f64>,
    climb_rate_mps: f64,
    altitude_reference: &'static str,
    altimeter_setting_hpa: Option<f64>,
    /// Set points; none while it does not control.
    desired: Option<Desired>,
    lateness_us: f64,
    missed: u64,
    overruns: u64,
    records_dropped: u64,
}

/// A reading at the tick.
#[derive(Clone, Debug, Serialize)]
struct ShownReading {
    name: &'static str,
    /// Where in `sources` it is from.
    source: u8,
    age_ms: f64,
}

/// Set points.
#[derive(Clone, Debug, Serialize)]
struct Desired {
    heading_rad: f64,
    airspeed_mps: f64,
    /// Above the same as the altitude.
    altitude_m: f64,
}

impl Now {
    pub(crate) fn of(record: &FlightRecord, at: &FlightTime, missed: u64) -> Self {
        let measured = &record.measurements;
        let altitude = ShownAltitude::of(record);
        let desired = &record.setpoints;
        let state = record.state.state();
        let estimate = &record.estimate;
        // What no sensor measures, navigation knows from raw readings; before the first
        // of them its estimate is of zeros.
        let is_by_raw = !measured.raw_body_rates.is_never()
            && [estimate.roll_rad, estimate.pitch_rad, estimate.heading_rad] != [0.0; 3];
        // What is lost is shown as unknown: an old horizon is taken for that of now.
        let lost = if state.holds_control() {
            record.faults
        } else {
            record.engage_inhibits
        };
        let is_known = |flag| !lost.intersects(flag);
        let has_attitude =
            (!measured.attitude.is_never() || is_by_raw) && is_known(flags::ATTITUDE);
        let altitude_m = known(&measured.altitude_m)
            .or((!measured.static_pressure_pa.is_never()).then_some(estimate.altitude_m));
        let airspeed_mps = known(&measured.airspeed_mps)
            .or((!measured.differential_pressure_pa.is_never()).then_some(estimate.airspeed_mps));
        Self {
            time_s: at.time_s,
            tick: record.tick.number,
            state: state.to_string(),
            mode: desired.guidance.to_string(),
            engaged_for_s: at.engaged_at_s.map(|engaged_s| at.time_s - engaged_s),
            engage_inhibits: names(record.engage_inhibits),
            faults: names(record.faults),
            readings: readings(measured, record.tick.woke),
            roll_rad: has_attitude.then_some(estimate.roll_rad),
            pitch_rad: has_attitude.then_some(estimate.pitch_rad),
            heading_rad: known(&measured.heading_rad)
                .or(is_by_raw.then_some(estimate.heading_rad))
                .filter(|_| is_known(flags::HEADING)),
            airspeed_mps: airspeed_mps.filter(|_| is_known(flags::AIRSPEED)),
            altitude_m: altitude_m
                .map(|pressure_m| pressure_m - altitude.datum_m)
                .filter(|_| is_known(flags::ALTITUDE)),
            climb_rate_mps: estimate.climb_rate_mps,
            altitude_reference: altitude.reference,
            altimeter_setting_hpa: altitude.setting_hpa,
            desired: state.holds_control().then_some(Desired {
                heading_rad: desired.heading_rad,
                airspeed_mps: desired.airspeed_mps,
                altitude_m: desired.altitude_m - altitude.datum_m,
            }),
            lateness_us: record.tick.lateness().as_secs_f64() * 1e6,
            missed,
            overruns: record.overruns,
            records_dropped: record.records_dropped,
        }
    }
}

/// A value that was measured at least once.
fn known<T: Copy>(reading: &Reading<T>) -> Option<T> {
    (!reading.is_never()).then_some(reading.value)
}

fn readings(measured: &Measurements, now: Time) -> Vec<ShownReading> {
    let mut shown = Vec::new();
    let mut names = Measurements::NAMES.iter();
    measured.each_source(&mut |source, taken| {
        if let Some(name) = names.next()
            && !taken.is_never()
        {
            shown.push(ShownReading {
                name,
                source,
                age_ms: now.since(taken).as_secs_f64() * 1e3,
            });
        }
    });
    shown
}

fn names(flags: Flags) -> Vec<&'static str> {
    flags.iter().map(Autopilot::flag_name).collect()
}
