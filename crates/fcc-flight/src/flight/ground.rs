//! A simulated flight that ends on the ground.

use std::fmt;

use fcc_sim::{Truth, TruthHandle};
use fcc_telemetry::units::{M_FT, MPS_KT};
use serde::Serialize;

/// The impact of a simulated aircraft on the ground, or where its wheels touched it and were
/// not to, by its truth.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Impact {
    /// Simulated time.
    pub time_s: f64,
    /// Of the aircraft, above mean sea level: that of the ground, or on its wheels.
    pub altitude_ft: f64,
    /// From where the flight began.
    pub north_m: f64,
    /// From where the flight began.
    pub east_m: f64,
    /// Downwards.
    pub sink_rate_fpm: f64,
    /// Indicated.
    pub airspeed_kt: f64,
    /// Nose above the horizon.
    pub pitch_deg: f64,
    /// Right wing down.
    pub bank_deg: f64,
    /// True heading.
    pub heading_deg: f64,
}

impl From<&Truth> for Impact {
    fn from(truth: &Truth) -> Self {
        Self {
            time_s: truth.time_s,
            altitude_ft: truth.altitude_m * M_FT,
            north_m: truth.north_m,
            east_m: truth.east_m,
            sink_rate_fpm: 60.0 * truth.velocity.down_mps * M_FT,
            airspeed_kt: truth.indicated_airspeed_mps * MPS_KT,
            pitch_deg: truth.pitch_rad.to_degrees(),
            bank_deg: truth.roll_rad.to_degrees(),
            heading_deg: truth.heading_rad.to_degrees(),
        }
    }
}

impl fmt::Display for Impact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the aircraft hit the ground {:.1} s after the start, at {:.0} ft, {:.0} m north and \
             {:.0} m east of it: sinking {:.0} ft/min, airspeed {:.0} kt, pitch {:.0} deg, bank \
             {:.0} deg, heading {:.0} deg",
            self.time_s,
            self.altitude_ft,
            self.north_m,
            self.east_m,
            self.sink_rate_fpm,
            self.airspeed_kt,
            self.pitch_deg,
            self.bank_deg,
            self.heading_deg
        )
    }
}

/// Looks for the impact of a simulated aircraft.
#[derive(Default)]
pub(super) struct GroundWatch {
    truth: Option<TruthHandle>,
    touched: Option<Impact>,
    pub(super) impact: Option<Impact>,
}

impl GroundWatch {
    /// Of an aircraft with a truth; none of it is known for another.
    pub(super) fn new(truth: Option<TruthHandle>) -> Self {
        Self {
            truth,
            touched: None,
            impact: None,
        }
    }

    /// Its wheels touch the ground where they are not to: that counts as an impact.
    pub(super) fn touch(&mut self) {
        let truth = self.truth.as_ref().map(TruthHandle::get);
        self.touched = self.touched.or(truth.map(|truth| Impact::from(&truth)));
    }

    /// The impact, once.
    pub(super) fn hits(&mut self) -> Option<Impact> {
        if self.impact.is_some() {
            return None;
        }
        let hard = self.truth.as_ref().and_then(TruthHandle::impact);
        let hard = hard.map(|truth| Impact::from(&truth));
        self.impact = hard.or(self.touched);
        self.impact
    }
}
