//! Whose axes are exchanged or reversed, as far as the sources tell.
//!
//! How a field turns tells the gyroscope from it up to a sign: reversed in all three axes it
//! turns alike. Where the receiver is, the earth's field points down or up, and gravity tells
//! where down is. Which of both is turned, a third one tells: gravity, where the body turns
//! without being accelerated (in flight the specific force does not turn: it points out of the
//! floor), or the receiver's velocities.

use fcc_core::flight::inertial::{KalmanConfig, Observation};
use fcc_core::units::GRAVITY_MPS2;
use nalgebra::{Matrix3, Vector3};

use super::sources::Sources;
use super::trials::{Axes, Flight};
use super::turns::{Relation, Turn, are_in_degrees, in_words, signed_permutations, windows};
use super::units::DOWNWARD_MPS2;

/// The force is gravity's while it is as strong, within this share.
const UNACCELERATED: f64 = 0.05;
/// It says something of turns if it has turned itself by this share of its strength (30°), as
/// a root mean square: that of what flies does not.
const TURNED: f64 = 0.5;
/// The earth's field points down or up by this share of it at least, and what is found of
/// that, is so much.
const STEEP: f64 = 0.3;
const SEEN: f64 = 0.3;

type Samples = Vec<(f64, Vector3<f64>)>;

/// What is wrong with axes, or with the unit of rates. A receiver that is wrong itself is not
/// asked.
pub(super) fn wrong(sources: &Sources, config: KalmanConfig) -> Option<String> {
    let samples = Inertial::of(sources);
    let fields = windows(&samples.rates, &samples.fields);
    if are_in_degrees(&fields) {
        return Some(
            "gyroscope: the field of the magnetometer turns as if rates were in °/s: they are in \
             rad/s; are they in °/s?"
                .to_owned(),
        );
    }
    let field = Relation::of(&fields);
    let flight = || {
        let is_right = sources.is_likely && !samples.is_upside_down();
        Flight::of(sources, config).filter(|_| is_right)
    };
    let force = gravity(windows(&samples.rates, &samples.forces)).filter(|force| force.is_only_one);
    let (why, suspects) = match (&field, &force) {
        (Some(field), _) if !field.is_as_given() => {
            if !field.is_only_one {
                return Some(
                    "gyroscope or magnetometer: the field turns as the rates say if the axes of \
                     one of both are others than are given, and turns around all three axes would \
                     tell which: give x, y, z forward, right, down"
                        .to_owned(),
                );
            }
            let why = "the field turns as the rates say";
            (
                why,
                of_field(&samples, field, force.as_ref(), config, flight()),
            )
        }
        (field, Some(force)) if !force.is_as_given() => {
            let why = "gravity turns as the rates say";
            (why, of_gravity(field.as_ref(), force))
        }
        // Of what hardly turns, what is added in the body may be as strong as the field.
        (Some(field), _)
            if field.is_only_one
                && samples.has_inclination(-Matrix3::identity(), field, config) == Some(true) =>
        {
            let why = "the field has the inclination of this place";
            (why, vec![axes("magnetometer", -Matrix3::identity())])
        }
        _ => {
            let why = "the receiver's velocities agree with the accelerometer and the gyroscope";
            (why, of_velocities(field.as_ref(), &flight()?))
        }
    };
    in_sentence(why, &suspects)
}

fn axes(sensor: &'static str, matrix: Matrix3<f64>) -> Axes {
    Axes { sensor, matrix }
}

/// Of a field that turns by other rates than are given.
fn of_field(
    samples: &Inertial,
    field: &Relation,
    force: Option<&Relation>,
    config: KalmanConfig,
    flight: Option<Flight<'_>>,
) -> Vec<Axes> {
    let gyroscope = axes("gyroscope", field.rates);
    if field.rates.determinant() < 0.0 {
        return vec![gyroscope];
    }
    let turned = field.rates.transpose();
    let magnetometer = [turned, -turned].into_iter();
    let magnetometer: Vec<Axes> = magnetometer
        .filter(|matrix| samples.has_inclination(*matrix, field, config) != Some(false))
        .map(|matrix| axes("magnetometer", matrix))
        .collect();
    let is_gyroscope = match (force, flight) {
        (Some(force), _) if force.is_as_given() => Some(false),
        (Some(force), _) if force.rates == field.rates => Some(true),
        (_, Some(flight)) => {
            let (given, other) = (flight.tried(None), flight.tried(Some(gyroscope)));
            if other.is_better_than(&given) {
                Some(true)
            } else {
                given.is_better_than(&other).then_some(false)
            }
        }
        _ => None,
    };
    match is_gyroscope {
        Some(true) => vec![gyroscope],
        Some(false) => magnetometer,
        None => std::iter::once(gyroscope).chain(magnetometer).collect(),
    }
}

/// Of a gravity that turns by other rates than are given.
fn of_gravity(field: Option<&Relation>, force: &Relation) -> Vec<Axes> {
    let gyroscope = axes("gyroscope", force.rates);
    if force.rates.determinant() < 0.0 {
        return vec![gyroscope];
    }
    let turned = force.rates.transpose();
    let accelerometer = [
        axes("accelerometer", turned),
        axes("accelerometer", -turned),
    ];
    let is_gyroscope_right = field.is_some_and(|field| field.is_only_one);
    let gyroscope = (!is_gyroscope_right).then_some(gyroscope);
    gyroscope.into_iter().chain(accelerometer).collect()
}

/// Of a flight whose velocities other axes explain better. Forces upwards are known to be.
fn of_velocities(field: Option<&Relation>, flight: &Flight<'_>) -> Vec<Axes> {
    let is_level = |matrix: &Matrix3<f64>| matrix[(2, 2)] > 0.0;
    let accelerometer = signed_permutations().filter(is_level);
    let is_gyroscope_right = field.is_some_and(|field| field.is_only_one);
    // One axis or more reversed, or two exchanged.
    let gyroscope = signed_permutations()
        .filter(|matrix| *matrix == matrix.transpose() && !is_gyroscope_right)
        .filter(|matrix| matrix.trace() == 1.0 || matrix.abs().trace() == 3.0);
    let others = accelerometer
        .map(|matrix| axes("accelerometer", matrix))
        .chain(gyroscope.map(|matrix| axes("gyroscope", matrix)))
        .filter(|axes| axes.matrix != Matrix3::identity());
    let tried = flight.better(others);
    let Some((_, best)) = tried.first() else {
        return Vec::new();
    };
    let as_good = tried
        .iter()
        .filter(|(_, trial)| !best.is_better_than(trial));
    as_good.map(|(axes, _)| *axes).collect()
}

/// Samples of the inertial unit and of the magnetometer in the body's axes.
struct Inertial {
    rates: Samples,
    forces: Samples,
    fields: Samples,
}

impl Inertial {
    fn of(sources: &Sources) -> Self {
        let mut all = Self {
            rates: Vec::new(),
            forces: Vec::new(),
            fields: Vec::new(),
        };
        for event in &sources.events {
            let (samples, row) = match event.observation {
                Observation::Rates(row) => (&mut all.rates, row),
                Observation::SpecificForce(row) => (&mut all.forces, row),
                Observation::MagneticField(row) => (&mut all.fields, row),
                _ => continue,
            };
            samples.push((event.taken.as_nanos() as f64 * 1e-9, row.into()));
        }
        all
    }

    fn is_upside_down(&self) -> bool {
        let downward: f64 = self.forces.iter().map(|(_, force)| force.z).sum();
        downward > DOWNWARD_MPS2 * self.forces.len() as f64
    }

    /// Whether the field, in these of its axes and less what is of the body, points to that
    /// side of the horizon to which it does in this place, as the force says where up is; if
    /// both are known.
    fn has_inclination(
        &self,
        axes: Matrix3<f64>,
        field: &Relation,
        config: KalmanConfig,
    ) -> Option<bool> {
        let earth = Vector3::from(config.earth_field_ut?);
        let expected = earth.z / earth.norm();
        if self.is_upside_down() || expected.abs() < STEEP {
            return None;
        }
        let mut forces = self.forces.iter().peekable();
        let mut up = None;
        let mut downward = (0.0, 0.0);
        for (time_s, vector) in &self.fields {
            while let Some((_, force)) = forces.next_if(|(at_s, _)| at_s <= time_s) {
                up = force.try_normalize(1.0);
            }
            if let Some(up) = up {
                downward.0 -= up.dot(&(axes * (vector - field.of_body)));
                downward.1 += earth.norm();
            }
        }
        let found = downward.0 / downward.1 / expected;
        (found.abs() > SEEN).then_some(found > 0.0)
    }
}

/// How gravity turns, while the body is not accelerated and turns visibly.
fn gravity(turns: Vec<Turn>) -> Option<Relation> {
    let is_gravity =
        |force: &Vector3<f64>| (force.norm() - GRAVITY_MPS2).abs() < UNACCELERATED * GRAVITY_MPS2;
    let turns: Vec<Turn> = turns
        .into_iter()
        .filter(|turn| is_gravity(&turn.begin) && is_gravity(&turn.end))
        .collect();
    let squares = turns
        .iter()
        .map(|turn| (turn.end - turn.begin).norm_squared());
    let turned: f64 = squares.sum();
    let least = turns.len() as f64 * (TURNED * GRAVITY_MPS2).powi(2);
    (turned > least).then(|| Relation::of(&turns)).flatten()
}

/// Whose axes are which, or may be.
fn in_sentence(why: &str, suspects: &[Axes]) -> Option<String> {
    let given = "give x, y, z forward, right, down";
    if let [one] = suspects {
        return Some(format!(
            "{}: {why} if its axes are {}, and not as they are given: {given}",
            one.sensor,
            in_words(&one.matrix)
        ));
    }
    let mut sensors: Vec<&str> = suspects.iter().map(|one| one.sensor).collect();
    sensors.dedup();
    let each: Vec<String> = suspects
        .iter()
        .map(|one| format!("{} {}", one.sensor, in_words(&one.matrix)))
        .collect();
    (!each.is_empty()).then(|| {
        format!(
            "{}: {why} if axes are one of {}, and not as they are given; these samples do not \
             tell which: {given}",
            sensors.join(" or "),
            each.join("; ")
        )
    })
}
