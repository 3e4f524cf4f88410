//! The deviation of another configuration from the recorded one.

use std::fmt::Write as _;

use fcc_core::framework::Record;
use fcc_core::framework::schema::Schema;
use fcc_telemetry::Telemetry;
use serde::Serialize;

use crate::outputs::TickPair;
use crate::profile::Profile;
use crate::quantity::Quantity;

/// The deviation of another configuration, with the same measurements, from the
/// recorded one.
///
/// The plant did not react to it: small differences accumulate in the
/// integrators, without feedback.
#[derive(Clone, Debug, Serialize)]
pub struct Deviation {
    /// Compared ticks: both commanded something.
    pub compared: u64,
    /// Ticks in which only the recorded loop commanded something.
    pub only_recorded: u64,
    /// Ticks in which only the other configuration would have.
    pub only_other: u64,
    /// Outputs and set points.
    pub quantities: Vec<QuantityDeviation>,
    #[serde(skip)]
    compares: Vec<Quantity>,
    #[serde(skip)]
    tick: TickPair,
}

/// The deviation of one quantity.
#[derive(Clone, Debug, Serialize)]
pub struct QuantityDeviation {
    /// Name.
    pub name: String,
    /// Unit of the values below.
    pub unit: &'static str,
    /// Number of ticks in which it differs.
    pub differing: u64,
    /// The largest difference, other less recorded; 0 if there is none.
    pub largest: f64,
    /// Time of the largest difference, s after the first tick; `None` if there
    /// is none.
    pub largest_at_s: Option<f64>,
    /// Root of the mean square of the difference over all compared ticks in which both are
    /// numbers; NaN if there is none.
    pub rms: f64,
    #[serde(skip)]
    numbers: u64,
    #[serde(skip)]
    sum_of_squares: f64,
    #[serde(skip)]
    profile: Profile,
}

impl Deviation {
    /// No comparison yet, of this controller's records.
    pub fn of<C: Telemetry>() -> Self {
        let compares = Quantity::all::<C>();
        let quantities = compares.iter().map(|quantity| QuantityDeviation {
            name: quantity.name.clone(),
            unit: quantity.unit,
            differing: 0,
            largest: 0.0,
            largest_at_s: None,
            rms: f64::NAN,
            numbers: 0,
            sum_of_squares: 0.0,
            profile: Profile::default(),
        });
        Self {
            compared: 0,
            only_recorded: 0,
            only_other: 0,
            quantities: quantities.collect(),
            compares,
            tick: TickPair::default(),
        }
    }

    /// Compares one tick as recorded and with the other configuration.
    pub fn take<M: Schema, E: Schema, S: Schema, O: Schema>(
        &mut self,
        recorded: &Record<M, E, S, O>,
        other: &Record<M, E, S, O>,
    ) {
        let at_s = self.tick.take(recorded, other) as f64 * 1e-9;
        let both = recorded.sent && other.sent;
        self.compared += u64::from(both);
        self.only_recorded += u64::from(recorded.sent && !other.sent);
        self.only_other += u64::from(!recorded.sent && other.sent);
        for (quantity, deviation) in self.compares.iter().zip(&mut self.quantities) {
            if both {
                let is_in_one = quantity.is_in_one(&self.tick);
                deviation.differing += u64::from(is_in_one);
                deviation.take(quantity.difference(&self.tick), at_s);
            } else {
                deviation.profile.push(0.0);
            }
        }
    }

    /// Whether one commanded the plant, and the two never in the same tick.
    pub const fn is_of_nothing(&self) -> bool {
        self.compared == 0 && self.only_recorded + self.only_other > 0
    }

    /// The deviation as text, of what differs.
    pub fn to_text(&self) -> String {
        let differs = |quantity: &&QuantityDeviation| quantity.differing > 0;
        let differing = || self.quantities.iter().filter(differs);
        let width = differing().map(|quantity| quantity.name.len()).max();
        let width = width.unwrap_or(0).max(16);
        let mut text = String::new();
        if differing().next().is_some() {
            let _ = writeln!(
                text,
                "{:width$} {:>9} {:>9} {:6} {:>8}  over time\n{}",
                "other - recorded",
                "rms",
                "largest",
                "",
                "at",
                "─".repeat(width + 53)
            );
        }
        for quantity in differing() {
            let at = quantity
                .largest_at_s
                .map_or(String::new(), |at_s| format!("{at_s:.2} s"));
            let [rms, largest] = if quantity.numbers == 0 {
                ["-".to_owned(), "-".to_owned()]
            } else {
                let (rms, largest) = (quantity.rms, quantity.largest);
                [format!("{rms:.4}"), format!("{largest:+.4}")]
            };
            let _ = writeln!(
                text,
                "{:width$} {rms:>9} {largest:>9} {:6} {at:>8}  {}",
                quantity.name,
                quantity.unit,
                quantity.profile.line(),
            );
        }
        let same = self.quantities.len() - differing().count();
        let _ = write!(
            text,
            "{same} of {} outputs and set points do not differ",
            self.quantities.len()
        );
        let _ = write!(
            text,
            "\n\n{} ticks compared, in which both command the plant. Only the recorded loop did in \
             {},\nonly the other configuration would have in {}.\n\
             The measurements are as recorded: the plant did not react to the other\n\
             configuration, so differences may accumulate.",
            self.compared, self.only_recorded, self.only_other
        );
        if self.is_of_nothing() {
            text.push_str("\n\nnothing was compared: in no tick both command the plant");
        }
        text
    }
}

impl QuantityDeviation {
    /// Takes the next tick's difference; NaN where one is no number.
    fn take(&mut self, difference: f64, at_s: f64) {
        if difference.is_nan() {
            self.profile.push(0.0);
            return;
        }
        let size = difference.abs();
        if size > 0.0 {
            self.differing += 1;
        }
        if size > self.largest.abs() {
            self.largest = difference;
            self.largest_at_s = Some(at_s);
        }
        self.sum_of_squares += difference * difference;
        self.numbers += 1;
        self.rms = (self.sum_of_squares / self.numbers as f64).sqrt();
        self.profile.push(size);
    }
}
