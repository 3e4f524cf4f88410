//! A panel: one quantity over time.

use std::time::Duration;

use fcc_core::framework::schema::{Kind, Value, unit};
use fcc_core::framework::{Record, State, Time};
use fcc_telemetry::schema::{Column, spaced};
use fcc_telemetry::units::Shown;
use serde::Serialize;

use crate::trace::Trace;
use crate::turns::Turns;

/// A reading older than this is not drawn: the line ends where the sensor
/// stopped.
const OLDEST: Duration = Duration::from_secs(1);

/// One quantity over time: as measured, as estimated, as desired.
#[derive(Clone, Debug)]
pub struct Panel {
    quantity: String,
    /// The unit in the plots.
    shown_in: &'static str,
    pub(crate) height_px: f64,
    pub(crate) scale: Scale,
    pub(crate) curves: Vec<Curve>,
    /// Display units per unit of the record.
    factor: f64,
    /// Whether it is an angle that wraps after a full turn.
    wraps: bool,
    /// Whether the set point is followed in failsafe, too.
    in_failsafe: bool,
    labels: Vec<String>,
}

fn labels(column: &Column) -> Vec<String> {
    match column.kind {
        Kind::Bool => vec!["no".to_owned(), "yes".to_owned()],
        Kind::Code(of) => of.variants.iter().map(|one| spaced(one.name)).collect(),
        _ => Vec::new(),
    }
}

/// Range of a value.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct ValueRange {
    /// Name.
    pub quantity: String,
    /// `measured`, `estimated`, `desired` or `commanded`.
    pub role: &'static str,
    /// Its unit; empty for none.
    pub unit: &'static str,
    /// Smallest value.
    pub lowest: f64,
    /// Largest value.
    pub highest: f64,
    /// Last value.
    pub last: f64,
}

/// The vertical axis of a panel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Scale {
    /// Around the values, at least this long.
    Around(f64),
    /// Around the values, the same for all such panels of a plot.
    Together(f64),
    /// From 0 to 100.
    Percent,
    /// Around directions, with the labels of a compass.
    Compass,
}

/// How a line is drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Ink {
    /// Thin and pale, behind the others.
    Measured,
    /// Solid.
    Actual,
    /// Thin and dashed.
    Desired,
}

/// One line of a panel.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) ink: Ink,
    pub(crate) name: &'static str,
    pub(crate) trace: Trace,
    role: Role,
    /// Place of the value in the record.
    value: usize,
    turns: Turns,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Role {
    Estimated,
    /// With the place of its time, if it has one.
    Measured(Option<usize>),
    Desired,
    Output,
}

impl Role {
    /// Whether the other curves are drawn in the turn of this one.
    const fn leads(self) -> bool {
        matches!(self, Self::Estimated | Self::Measured(_))
    }
}

impl Panel {
    pub(super) fn of(
        name: &'static str,
        column: Option<&Column>,
        units: &[Shown],
        curves: Vec<Curve>,
    ) -> Self {
        let labels = column.map_or_else(Vec::new, labels);
        let shown = column.map(|column| Shown::of(column, units));
        let (shown_in, factor) = shown.map_or(("", 1.0), |shown| (shown.unit, shown.scale));
        let range = column.and_then(|column| column.range);
        let span = range.map(|(from, to)| (to - from) * factor);
        Self {
            quantity: unit::of(name).quantity.replace('_', " "),
            shown_in,
            height_px: match labels.len() {
                0 => 120.0,
                count => 16.0 * count as f64 + 8.0,
            },
            scale: match (shown_in, range) {
                ("%", Some((0.0, _))) => Scale::Percent,
                _ => Scale::Around(span.filter(|s| s.is_finite()).map_or(1e-3, |s| s / 10.0)),
            },
            curves,
            factor,
            wraps: shown_in == "°" && span.is_some_and(|span| (span - 360.0).abs() < 1e-9),
            in_failsafe: false,
            labels,
        }
    }

    /// Of finished curves.
    #[cfg(feature = "flight")]
    pub(crate) fn drawn(title: &str, curves: Vec<Curve>) -> Self {
        Self::of("", None, &[], curves).called(title)
    }

    /// The names of its values 0, 1, 2, ...; none of numbers.
    pub(crate) fn labels(&self) -> &[String] {
        &self.labels
    }

    /// The quantity and its unit.
    pub(crate) fn title(&self) -> String {
        match self.shown_in {
            "" => self.quantity.clone(),
            unit => format!("{}, {unit}", self.quantity),
        }
    }

    /// The ranges of its lines.
    pub(crate) fn ranges(&self) -> impl Iterator<Item = ValueRange> {
        let curves = self.curves.iter().filter(|_| self.labels.is_empty());
        curves.filter_map(|curve| {
            let (lowest, highest) = curve.trace.extent()?;
            Some(ValueRange {
                quantity: self.quantity.clone(),
                role: curve.name,
                unit: self.shown_in,
                lowest,
                highest,
                last: curve.trace.last()?,
            })
        })
    }

    /// The same with another name.
    #[must_use]
    pub fn called(mut self, quantity: &str) -> Self {
        quantity.clone_into(&mut self.quantity);
        self
    }

    /// The same in the record's own unit, a fraction of 1.
    #[must_use]
    pub fn unscaled(mut self) -> Self {
        (self.shown_in, self.factor) = ("", 1.0);
        self
    }

    /// The same with a height, px, and a vertical axis.
    #[must_use]
    pub fn sized(mut self, height_px: f64, scale: Scale) -> Self {
        (self.height_px, self.scale) = (height_px, scale);
        self
    }

    /// Draws the set point in failsafe, too.
    #[must_use]
    pub fn followed_in_failsafe(mut self) -> Self {
        self.in_failsafe = true;
        self
    }

    /// Takes a record's values.
    pub(crate) fn take(&mut self, values: &[Value], at: &Moment) {
        let (factor, wraps, in_failsafe) = (self.factor, self.wraps, self.in_failsafe);
        let number = |curve: &Curve| match values.get(curve.value) {
            Some(Value::Number(number)) => Some(number * factor).filter(|n| n.is_finite()),
            Some(Value::Bool(truth)) => Some(f64::from(u8::from(*truth))),
            Some(Value::Code(number)) => Some(f64::from(*number)),
            _ => None,
        };
        let measures = |curve: &Curve| matches!(curve.role, Role::Measured(_));
        let is_measured = |curve: &Curve| match curve.role {
            Role::Measured(Some(taken)) => at.is_fresh(values.get(taken)),
            _ => true,
        };
        // An estimate is drawn while all measurements are fresh.
        let mut measured = self.curves.iter().filter(|curve| measures(curve));
        let known = measured.all(|curve| is_measured(curve) && number(curve).is_some());
        let mut lead = None;
        // The leader is the last of its kind.
        let leader = self.curves.iter().rposition(|curve| curve.role.leads());
        let mut order: Vec<usize> = leader.into_iter().collect();
        order.extend((0..self.curves.len()).filter(|place| Some(*place) != leader));
        for place in order {
            let Some(curve) = self.curves.get_mut(place) else {
                continue;
            };
            let shown = match curve.role {
                Role::Measured(_) | Role::Estimated => known,
                Role::Desired => {
                    at.state == State::Engaged || (in_failsafe && at.state.holds_control())
                }
                Role::Output => at.sent,
            };
            let mut value = number(curve).filter(|_| shown);
            if wraps {
                let near = lead.or(value).unwrap_or_default();
                match (value, curve.role) {
                    (None, Role::Desired) => curve.turns.forget(),
                    // In the same turn as the estimate.
                    (Some(angle), Role::Measured(_)) if lead.is_some() => {
                        value = Some(Turns::default().count(angle, near));
                    }
                    (Some(angle), _) => value = Some(curve.turns.count(angle, near)),
                    (None, _) => {}
                }
            }
            if Some(place) == leader {
                lead = value;
            }
            curve.trace.push(at.time_s, value);
        }
    }

    /// Interrupts all lines: records are missing.
    pub(crate) fn cut(&mut self) {
        for curve in &mut self.curves {
            curve.trace.cut();
            if curve.role == Role::Desired {
                curve.turns.forget();
            }
        }
    }
}

/// State of the loop at a record.
pub(crate) struct Moment {
    time_s: f64,
    woke: Time,
    state: State,
    sent: bool,
}

impl Moment {
    pub(crate) fn of<M, E, S, O>(record: &Record<M, E, S, O>, time_s: f64) -> Self {
        Self {
            time_s,
            woke: record.tick.woke,
            state: record.state.state(),
            sent: record.sent,
        }
    }

    fn is_fresh(&self, taken: Option<&Value>) -> bool {
        match taken {
            Some(Value::Instant(ns)) => self.woke.since(Time::from_nanos(*ns)) <= OLDEST,
            _ => false,
        }
    }
}

impl Default for Curve {
    /// A line without a value.
    fn default() -> Self {
        Self::new(Ink::Actual, "", Role::Output, usize::MAX)
    }
}

impl Curve {
    /// A line whose values are not of a record.
    #[cfg(feature = "flight")]
    pub(crate) fn drawn(ink: Ink, name: &'static str) -> Self {
        Self::new(ink, name, Role::Output, usize::MAX)
    }

    pub(super) fn new(ink: Ink, name: &'static str, role: Role, value: usize) -> Self {
        Self {
            ink,
            name,
            trace: Trace::default(),
            role,
            value,
            turns: Turns::default(),
        }
    }
}
