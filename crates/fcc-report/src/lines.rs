//! The lines of the plots, in the units that people fly by.

use std::time::Duration;

use fcc_core::framework::{Reading, State, Tick};

use super::trace::Trace;
use super::turns::Turns;
use fcc_telemetry::FlightRecord;
use fcc_telemetry::units::{M_FT, MPS_KT};

/// A reading older than this is not drawn: the line ends where the sensor fell
/// silent.
const OLDEST: Duration = Duration::from_secs(1);

/// What is desired, what is as the navigation estimates it, and what was
/// measured.
#[derive(Clone, Debug, Default)]
pub(super) struct Pair {
    pub(super) desired: Trace,
    pub(super) actual: Trace,
    pub(super) measured: Trace,
}

/// All lines of the plots over time.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines {
    /// Counted on through full turns, °.
    pub(super) heading_deg: Pair,
    pub(super) altitude_ft: Pair,
    pub(super) airspeed_kt: Pair,
    pub(super) pitch_deg: Pair,
    pub(super) bank_deg: Pair,
    /// 0..100.
    pub(super) throttle_percent: Trace,
    /// -1..1, like the two after it.
    pub(super) elevator: Trace,
    pub(super) aileron: Trace,
    pub(super) rudder: Trace,
    pub(super) lateness_us: Trace,
    headings: Turns,
    desired_headings: Turns,
}

impl Lines {
    pub(super) fn take(&mut self, record: &FlightRecord, time_s: f64) {
        let tick = &record.tick;
        let measured = &record.measurements;
        let estimate = &record.estimate;
        let attitude = fresh(&measured.attitude, tick);
        let desired = record
            .state
            .state()
            .holds_control()
            .then_some(record.setpoints);
        // In failsafe only the attitude is held: the rest is what was.
        let aimed = desired.filter(|_| record.state == State::Engaged);

        self.take_heading(record, time_s, aimed.map(|set| set.heading_rad));
        self.altitude_ft.push(
            time_s,
            aimed.map(|set| set.altitude_m * M_FT),
            estimate.altitude_m * M_FT,
            fresh(&measured.altitude_m, tick).map(|m| m * M_FT),
        );
        self.airspeed_kt.push(
            time_s,
            aimed.map(|set| set.airspeed_mps * MPS_KT),
            estimate.airspeed_mps * MPS_KT,
            fresh(&measured.airspeed_mps, tick).map(|mps| mps * MPS_KT),
        );
        self.pitch_deg.push(
            time_s,
            desired.map(|set| set.pitch_rad.to_degrees()),
            estimate.pitch_rad.to_degrees(),
            attitude.map(|attitude| attitude.pitch_rad.to_degrees()),
        );
        self.bank_deg.push(
            time_s,
            desired.map(|set| set.roll_rad.to_degrees()),
            estimate.roll_rad.to_degrees(),
            attitude.map(|attitude| attitude.roll_rad.to_degrees()),
        );
        let sent = record.sent.then_some(record.outputs);
        self.throttle_percent
            .push(time_s, sent.map(|outputs| 100.0 * outputs.throttle));
        self.elevator
            .push(time_s, sent.map(|outputs| outputs.elevator));
        self.aileron
            .push(time_s, sent.map(|outputs| outputs.aileron));
        self.rudder.push(time_s, sent.map(|outputs| outputs.rudder));
        self.lateness_us
            .push(time_s, Some(tick.lateness().as_secs_f64() * 1e6));
    }

    fn take_heading(&mut self, record: &FlightRecord, time_s: f64, desired_rad: Option<f64>) {
        let measured = fresh(&record.measurements.heading_rad, &record.tick)
            .filter(|heading_rad| heading_rad.is_finite());
        let heading = measured
            .map(|_| record.estimate.heading_rad.to_degrees())
            .filter(|heading_deg| heading_deg.is_finite())
            .map(|heading_deg| self.headings.count(heading_deg, heading_deg));
        let desired = desired_rad
            .filter(|desired_rad| desired_rad.is_finite())
            .map(|desired_rad| {
                let desired_deg = desired_rad.to_degrees();
                self.desired_headings
                    .count(desired_deg, heading.unwrap_or(desired_deg))
            });
        if desired.is_none() {
            self.desired_headings.forget();
        }
        // In the same turn as what is estimated from it.
        let measured = measured.zip(heading).map(|(heading_rad, heading_deg)| {
            Turns::default().count(heading_rad.to_degrees(), heading_deg)
        });
        let of = &mut self.heading_deg;
        of.push(time_s, desired, heading.unwrap_or(f64::NAN), measured);
    }

    /// Records are missing here: no line leads across.
    pub(super) fn cut(&mut self) {
        for pair in [
            &mut self.heading_deg,
            &mut self.altitude_ft,
            &mut self.airspeed_kt,
            &mut self.pitch_deg,
            &mut self.bank_deg,
        ] {
            pair.desired.cut();
            pair.actual.cut();
            pair.measured.cut();
        }
        for trace in [
            &mut self.throttle_percent,
            &mut self.elevator,
            &mut self.aileron,
            &mut self.rudder,
            &mut self.lateness_us,
        ] {
            trace.cut();
        }
        self.desired_headings.forget();
    }
}

impl Pair {
    /// What is estimated is drawn as long as something is measured.
    fn push(&mut self, time_s: f64, desired: Option<f64>, estimated: f64, measured: Option<f64>) {
        self.desired.push(time_s, desired);
        self.actual.push(time_s, measured.map(|_| estimated));
        self.measured.push(time_s, measured);
    }
}

fn fresh<T: Copy>(reading: &Reading<T>, tick: &Tick) -> Option<T> {
    reading.fresh(tick.woke, OLDEST)
}
