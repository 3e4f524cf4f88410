//! A status line each second.

use fcc_core::flight::Autopilot;
use fcc_core::framework::{Controller, State};
use fcc_flight::flight::{FlightTime, Observer};
use fcc_telemetry::FlightRecord;
use fcc_telemetry::units::{M_FT, MPS_KT};

use crate::output;

/// Prints a line for each second of the loop's time, on standard error.
#[derive(Default)]
pub(crate) struct StatusLine {
    printed_s: Option<f64>,
    worst_us: f64,
    missed: u64,
}

impl Observer for StatusLine {
    fn record(&mut self, record: &FlightRecord, at: &FlightTime) {
        self.worst_us = self
            .worst_us
            .max(record.tick.lateness().as_secs_f64() * 1e6);
        self.missed += record.tick.missed;
        // Slightly early, so that rounding of ticks does not skip a second.
        if self
            .printed_s
            .is_none_or(|last| at.time_s - last >= 1.0 - 1e-6)
        {
            self.printed_s = Some(at.time_s);
            output::message(self.line(record, at.time_s, at.engaged_at_s));
            self.worst_us = 0.0;
        }
    }
}

impl StatusLine {
    fn line(&self, record: &FlightRecord, now_s: f64, engaged_at_s: Option<f64>) -> String {
        let measured = &record.measurements;
        let timing = format!("late ≤{:6.1} µs  missed {}", self.worst_us, self.missed);
        if measured.airspeed_mps.is_never() {
            return format!(
                "{now_s:8.2} s  {:<8}  no aircraft yet  {timing}",
                record.state
            );
        }
        let heading = compass(measured.heading_rad.value);
        let altitude = measured.altitude_m.value * M_FT;
        let airspeed = measured.airspeed_mps.value * MPS_KT;
        // Plus zero, because a rounded -0 looks like an error.
        let bank = measured.attitude.value.roll_rad.to_degrees().round() + 0.0;
        let aims = &record.setpoints;
        match record.state.state() {
            State::Engaged => {
                let since = engaged_at_s.map_or(0.0, |at_s| now_s - at_s);
                format!(
                    "{now_s:8.2} s  engaged {since:5.0} s  {}  \
                     heading {heading:3.0}° → {:3.0}°  bank {bank:3.0}°  \
                     altitude {altitude:5.0} → {:5.0} ft  airspeed {airspeed:5.1} → {:5.1} kt  \
                     throttle {:3.0} %  {timing}",
                    aims.guidance,
                    compass(aims.heading_rad),
                    aims.altitude_m * M_FT,
                    aims.airspeed_mps * MPS_KT,
                    record.outputs.throttle * 100.0,
                )
            }
            state => {
                let mut line = format!(
                    "{now_s:8.2} s  {state:<13}  heading {heading:3.0}°  bank {bank:3.0}°  \
                     altitude {altitude:5.0} ft  airspeed {airspeed:5.1} kt  {timing}"
                );
                for (n, bit) in record.engage_inhibits.iter().enumerate() {
                    line.push_str(if n == 0 { "  not ready: " } else { ", " });
                    line.push_str(Autopilot::flag_name(bit));
                }
                line
            }
        }
    }
}

/// Whole degrees, 0 to 359, as on a compass card.
fn compass(heading_rad: f64) -> f64 {
    heading_rad.to_degrees().round().rem_euclid(360.0)
}
