//! One method on a recorded flight.

use fcc_core::framework::{RecordOf, Time};
use fcc_fixed_wing::Autopilot;
use fcc_navigation::inertial::{Innovation, ObservationKind, RawNavigation, RawNavigationConfig};
use serde::Serialize;

use super::quantities::{self, ALL, HEADING, Values};
use crate::plots::{Curve, Ink, Panel, Plot, Scale};
use crate::turns::Turns;

/// What one method gave.
#[derive(Clone, Debug, Serialize)]
pub struct MethodResult {
    /// `kalman`.
    pub method: &'static str,
    /// Of each quantity how far it is from the others.
    pub differences: Vec<Difference>,
    /// Of each source.
    pub innovations: Vec<SourceConsistency>,
}

/// How far a quantity is from what was measured and from what was flown.
#[derive(Clone, Debug, Serialize)]
pub struct Difference {
    /// Its name.
    pub quantity: &'static str,
    /// The unit of the differences.
    pub unit: &'static str,
    /// Ticks in which a sensor measured it.
    pub ticks_from_measured: u64,
    /// The root of the mean square over these; `None` without any.
    pub rms_from_measured: Option<f64>,
    /// Ticks in which the loop had control.
    pub ticks_from_flown: u64,
    /// The root of the mean square over these; `None` without any.
    pub rms_from_flown: Option<f64>,
}

/// Whether a source's innovations are as large as the filter expects.
#[derive(Clone, Debug, Serialize)]
pub struct SourceConsistency {
    /// Its name.
    pub source: &'static str,
    /// Number of innovations.
    pub count: u64,
    /// How many of them the filter refused.
    pub refused: u64,
    /// RMS of the others, each axis over its standard deviation; 0 without any.
    pub rms_accepted: f64,
}

/// The bound of 95 %, in standard deviations.
const BOUND_SIGMAS: f64 = 1.96;

#[derive(Clone, Copy, Debug, Default)]
struct MeanSquare {
    sum: f64,
    count: u64,
}

impl MeanSquare {
    fn take(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1;
    }

    fn root(self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum / self.count as f64).sqrt())
    }
}

/// A method at work.
#[derive(Clone, Debug)]
pub(super) struct MethodRun {
    method: &'static str,
    navigation: RawNavigation,
    /// The instant of the last solution.
    last: Time,
    from_measured: [MeanSquare; ALL.len()],
    from_flown: [MeanSquare; ALL.len()],
    /// Flown, found, measured.
    curves: [[Curve; 3]; ALL.len()],
    turns: Turns,
    sources: Vec<Source>,
}

impl MethodRun {
    pub(super) fn new(config: RawNavigationConfig) -> Self {
        let curves = || {
            [
                Curve::drawn(Ink::Measured, "flown"),
                Curve::drawn(Ink::Actual, "by this method"),
                Curve::drawn(Ink::Desired, "measured"),
            ]
        };
        Self {
            method: "kalman",
            navigation: RawNavigation::new(config),
            last: Time::NEVER,
            from_measured: [MeanSquare::default(); ALL.len()],
            from_flown: [MeanSquare::default(); ALL.len()],
            curves: [(); ALL.len()].map(|()| curves()),
            turns: Turns::default(),
            sources: Vec::new(),
        }
    }

    pub(super) fn has_readings(&self) -> bool {
        !self.last.is_never()
    }

    pub(super) fn take(&mut self, record: &RecordOf<Autopilot>, time_s: f64) {
        let now = record.tick.woke;
        let of = *self.navigation.step(now, &record.measurements);
        let solution = *self.navigation.solution();
        let found = quantities::found(&of, &solution, now);
        if solution.time != self.last {
            self.last = solution.time;
            for innovation in self.navigation.innovations() {
                if let Some(source) = Source::of(&mut self.sources, innovation.kind) {
                    source.take(innovation, time_s);
                }
            }
        }
        let flown = quantities::flown(record);
        let measured = quantities::measured(&record.measurements, now);
        compare(&mut self.from_flown, &found, &flown);
        compare(&mut self.from_measured, &found, &measured);
        self.draw(time_s, flown, found, measured);
    }

    fn draw(&mut self, time_s: f64, mut flown: Values, mut found: Values, mut measured: Values) {
        // All headings in the turn of the one that was found.
        if let Some(heading) = found[HEADING] {
            let counted = self.turns.count(heading, heading);
            found[HEADING] = Some(counted);
            for other in [&mut flown[HEADING], &mut measured[HEADING]] {
                *other = other.map(|heading| Turns::default().count(heading, counted));
            }
        } else {
            (flown[HEADING], measured[HEADING]) = (None, None);
        }
        let values = flown.into_iter().zip(found).zip(measured);
        for ([a, b, c], ((flown, found), measured)) in self.curves.iter_mut().zip(values) {
            a.trace.push(time_s, flown);
            b.trace.push(time_s, found);
            c.trace.push(time_s, measured);
        }
    }

    pub(super) fn result(&self) -> MethodResult {
        let sums = self.from_measured.iter().zip(&self.from_flown);
        let differences = ALL
            .iter()
            .zip(sums)
            .map(|(of, (measured, flown))| Difference {
                quantity: of.name,
                unit: of.unit,
                ticks_from_measured: measured.count,
                rms_from_measured: measured.root(),
                ticks_from_flown: flown.count,
                rms_from_flown: flown.root(),
            });
        MethodResult {
            method: self.method,
            differences: differences.collect(),
            innovations: self.sources.iter().map(Source::consistency).collect(),
        }
    }

    /// The panel of a quantity; none if the method does not find it.
    pub(super) fn panel(&self, at: usize) -> Option<Panel> {
        let (of, curves) = (ALL.get(at)?, self.curves.get(at)?);
        curves[1].trace.extent()?;
        let title = format!("{}, {}, by {}", of.name, of.unit, self.method);
        Some(Panel::drawn(&title, curves.to_vec()).sized(140.0, of.scale))
    }

    pub(super) fn innovation_plots(&self) -> impl Iterator<Item = Plot> {
        self.sources.iter().map(Source::plot)
    }
}

fn compare(sums: &mut [MeanSquare; ALL.len()], found: &Values, with: &Values) {
    for ((sum, of), (found, with)) in sums.iter_mut().zip(&ALL).zip(found.iter().zip(with)) {
        if let (Some(found), Some(with)) = (found, with) {
            let difference = found - with;
            sum.take(match of.unit {
                "°" => (difference + 180.0).rem_euclid(360.0) - 180.0,
                _ => difference,
            });
        }
    }
}

/// The innovations of one source.
#[derive(Clone, Debug)]
struct Source {
    kind: ObservationKind,
    count: u64,
    refused: u64,
    normalized: MeanSquare,
    /// Of each axis: the innovation, and the bounds below and above.
    curves: [[Curve; 3]; 3],
}

impl Source {
    fn of(all: &mut Vec<Self>, kind: ObservationKind) -> Option<&mut Self> {
        if !all.iter().any(|source| source.kind == kind) {
            let curves = || {
                [
                    Curve::drawn(Ink::Actual, "innovation"),
                    Curve::drawn(Ink::Desired, "bounds of 95 %"),
                    Curve::drawn(Ink::Desired, "bounds of 95 %"),
                ]
            };
            all.push(Self {
                kind,
                count: 0,
                refused: 0,
                normalized: MeanSquare::default(),
                curves: [curves(), curves(), curves()],
            });
        }
        all.iter_mut().find(|source| source.kind == kind)
    }

    fn take(&mut self, innovation: &Innovation, time_s: f64) {
        self.count += 1;
        self.refused += u64::from(!innovation.accepted);
        let axes = innovation.difference.into_iter().zip(innovation.sigma);
        for ((difference, sigma), [line, low, high]) in axes.zip(&mut self.curves) {
            if sigma > 0.0 {
                if innovation.accepted {
                    self.normalized.take(difference / sigma);
                }
                line.trace.push(time_s, Some(difference));
                low.trace.push(time_s, Some(-BOUND_SIGMAS * sigma));
                high.trace.push(time_s, Some(BOUND_SIGMAS * sigma));
            }
        }
    }

    fn consistency(&self) -> SourceConsistency {
        SourceConsistency {
            source: name(self.kind).0,
            count: self.count,
            refused: self.refused,
            rms_accepted: self.normalized.root().unwrap_or_default(),
        }
    }

    fn plot(&self) -> Plot {
        let (name, unit) = name(self.kind);
        let drawn = self.curves.iter().zip(["1", "2", "3"]);
        let drawn = drawn.filter(|([line, ..], _)| line.trace.extent().is_some());
        let panels = drawn.map(|(curves, axis)| {
            let title = format!("axis {axis}, {unit}");
            Panel::drawn(&title, curves.to_vec()).sized(100.0, Scale::Around(1e-3))
        });
        Plot {
            title: format!("Innovations: {name}"),
            caption: "What was measured less what the filter expected, refused ones included, and \
                      1.96 of its standard deviations on either side. Axes: north, east, down; of \
                      a magnetic field forward, right, down."
                .to_owned(),
            panels: panels.collect(),
        }
    }
}

/// A source's name, and the unit of its innovations.
const fn name(kind: ObservationKind) -> (&'static str, &'static str) {
    match kind {
        ObservationKind::Rates => ("rates", "rad/s"),
        ObservationKind::SpecificForce => ("specific force", "m/s²"),
        ObservationKind::MagneticField => ("magnetic field", "µT"),
        ObservationKind::StaticPressure => ("static pressure", "m"),
        ObservationKind::DifferentialPressure => ("differential pressure", "m/s"),
        ObservationKind::Airspeed => ("airspeed", "m/s"),
        ObservationKind::Position => ("position", "m"),
        ObservationKind::Velocity => ("velocity", "m/s"),
    }
}
