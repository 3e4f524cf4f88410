//! Where another configuration would have commanded otherwise.

use std::f64::consts::PI;
use std::fmt::Write as _;

use fcc_core::blocks::wrap_pi;
use fcc_telemetry::FlightRecord;
use fcc_telemetry::units::{M_FT, MPS_KT};
use serde::Serialize;

use super::profile::Profile;

/// Where another configuration would have commanded otherwise, had it seen
/// these measurements.
///
/// The aircraft did not react to it: small differences that flight would have
/// evened out add up in the integrators.
#[derive(Clone, Debug, Serialize)]
pub struct Deviation {
    /// Ticks in which both commanded something: what is compared.
    pub compared: u64,
    /// Ticks in which only the recorded flight commanded something.
    pub only_recorded: u64,
    /// Ticks in which only the other configuration would have.
    pub only_other: u64,
    /// Throttle, surfaces and set points.
    pub quantities: Vec<QuantityDeviation>,
    #[serde(skip)]
    began_ns: Option<i64>,
}

/// How far one quantity is from the recorded one.
#[derive(Clone, Debug, Serialize)]
pub struct QuantityDeviation {
    /// Its name.
    pub name: &'static str,
    /// The unit of what follows.
    pub unit: &'static str,
    /// Ticks in which it differs at all.
    pub differing: u64,
    /// The largest difference, other less recorded; 0 if there is none.
    pub largest: f64,
    /// When that was, s after the first tick; none if there is none.
    pub largest_at_s: Option<f64>,
    /// Root of the mean square of the difference over all ticks compared.
    pub rms: f64,
    #[serde(skip)]
    sum_of_squares: f64,
    #[serde(skip)]
    profile: Profile,
}

/// One thing that the autopilot commands or aims for.
pub struct Quantity {
    /// Its name.
    pub name: &'static str,
    /// Its unit, for people.
    pub unit: &'static str,
    /// That many of the unit in one of the record's.
    scale: f64,
    /// Whether it goes round: 359° and 1° are 2° apart.
    goes_round: bool,
    value: fn(&FlightRecord) -> f64,
}

const DEG: f64 = 180.0 / PI;

const fn quantity(
    name: &'static str,
    unit: &'static str,
    scale: f64,
    value: fn(&FlightRecord) -> f64,
) -> Quantity {
    Quantity {
        name,
        unit,
        scale,
        goes_round: false,
        value,
    }
}

impl Quantity {
    /// All there are: what is commanded, then what is aimed for.
    pub const ALL: [Self; 10] = [
        quantity("throttle", "%", 100.0, |r| r.outputs.throttle),
        quantity("elevator", "%", 100.0, |r| r.outputs.elevator),
        quantity("aileron", "%", 100.0, |r| r.outputs.aileron),
        quantity("rudder", "%", 100.0, |r| r.outputs.rudder),
        quantity("airspeed set point", "kt", MPS_KT, |r| {
            r.setpoints.airspeed_mps
        }),
        Self {
            goes_round: true,
            ..quantity("heading set point", "°", DEG, |r| r.setpoints.heading_rad)
        },
        quantity("altitude set point", "ft", M_FT, |r| r.setpoints.altitude_m),
        quantity("bank set point", "°", DEG, |r| r.setpoints.roll_rad),
        quantity("climb set point", "ft/min", M_FT * 60.0, |r| {
            r.setpoints.climb_rate_mps
        }),
        quantity("pitch set point", "°", DEG, |r| r.setpoints.pitch_rad),
    ];

    /// Its value in a record, in [`unit`](Self::unit)s.
    pub fn of(&self, record: &FlightRecord) -> f64 {
        (self.value)(record) * self.scale
    }

    fn difference(&self, recorded: &FlightRecord, other: &FlightRecord) -> f64 {
        let difference = (self.value)(other) - (self.value)(recorded);
        let difference = if self.goes_round {
            wrap_pi(difference)
        } else {
            difference
        };
        difference * self.scale
    }
}

impl Default for Deviation {
    fn default() -> Self {
        let quantities = Quantity::ALL.iter().map(|quantity| QuantityDeviation {
            name: quantity.name,
            unit: quantity.unit,
            differing: 0,
            largest: 0.0,
            largest_at_s: None,
            rms: 0.0,
            sum_of_squares: 0.0,
            profile: Profile::default(),
        });
        Self {
            compared: 0,
            only_recorded: 0,
            only_other: 0,
            quantities: quantities.collect(),
            began_ns: None,
        }
    }
}

impl Deviation {
    /// Compares one tick as recorded and as the other configuration has it.
    pub fn take(&mut self, recorded: &FlightRecord, other: &FlightRecord) {
        let at_ns = recorded.tick.scheduled.as_nanos();
        let began_ns = *self.began_ns.get_or_insert(at_ns);
        let at_s = at_ns.saturating_sub(began_ns) as f64 * 1e-9;
        let both = recorded.sent && other.sent;
        self.compared += u64::from(both);
        self.only_recorded += u64::from(recorded.sent && !other.sent);
        self.only_other += u64::from(!recorded.sent && other.sent);
        for (quantity, deviation) in Quantity::ALL.iter().zip(&mut self.quantities) {
            if both {
                let difference = quantity.difference(recorded, other);
                deviation.take(difference, at_s, self.compared);
            } else {
                deviation.profile.push(0.0);
            }
        }
    }

    /// For people.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "{:19} {:>8} {:>12} {:>12} {:>7} {:>9}  {}\n{}",
            "other - recorded",
            "ticks",
            "rms",
            "largest",
            "",
            "at",
            "size over the flight",
            "─".repeat(100)
        );
        for quantity in &self.quantities {
            let at = quantity
                .largest_at_s
                .map_or(String::new(), |at_s| format!("{at_s:.2} s"));
            let _ = write!(
                text,
                "\n{:19} {:>8} {:>12.5} {:>+12.5} {:7} {at:>9}  {}",
                quantity.name,
                quantity.differing,
                quantity.rms,
                quantity.largest,
                quantity.unit,
                quantity.profile.line(),
            );
        }
        let _ = write!(
            text,
            "\n\n{} ticks compared, in which both command the aircraft; only the recorded \
             flight did in {}, only the other configuration would have in {}.\n\
             The measurements are as recorded: the aircraft did not react to the other \
             configuration, so differences may add up that flight would have evened out.",
            self.compared, self.only_recorded, self.only_other
        );
        text
    }
}

impl QuantityDeviation {
    fn take(&mut self, difference: f64, at_s: f64, compared: u64) {
        let size = difference.abs();
        if size > 0.0 {
            self.differing += 1;
        }
        if size > self.largest.abs() {
            self.largest = difference;
            self.largest_at_s = Some(at_s);
        }
        self.sum_of_squares += difference * difference;
        self.rms = (self.sum_of_squares / compared as f64).sqrt();
        self.profile.push(size);
    }
}
