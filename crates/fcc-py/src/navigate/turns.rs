//! Whether the field of the magnetometer turns as the gyroscope says, or as it would with
//! rates in another unit, or with other axes.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::kind::{Kind, Series};
use super::mounting::Mounting;
use super::plausible::{CLEARLY, WINDOW_S};

/// Turns are compared in at least so many windows; axes in more, because there are many.
const LEAST_WINDOWS: usize = 3;
const LEAST_FOR_AXES: usize = 10;
/// Axes are wrong if the field is then that far from where it should be, as a share of it.
const WRONG: f64 = 0.1;

/// What is wrong with rates or axes, if the field says so.
pub(super) fn turns(
    gyroscope: (&Kind, &Series),
    magnetometer: (&Kind, &Series),
    mounting: &Mounting,
) -> Option<String> {
    let turns = windows(gyroscope, magnetometer, mounting);
    in_degrees(&turns).or_else(|| other_axes(&turns))
}

/// The field at the begin and at the end of some seconds, and what the rates between them
/// make of a vector that does not turn with the body.
struct Turn {
    begin: Vector3<f64>,
    end: Vector3<f64>,
    given: Rotation3<f64>,
    reversed: Rotation3<f64>,
    degrees: Rotation3<f64>,
}

fn windows(
    gyroscope: (&Kind, &Series),
    magnetometer: (&Kind, &Series),
    mounting: &Mounting,
) -> Vec<Turn> {
    let mut rates = mounting.possible(gyroscope).peekable();
    let mut turns: Vec<Turn> = Vec::new();
    let mut open: Option<(f64, f64, Turn)> = None;
    for (time_s, field) in mounting.possible(magnetometer) {
        if let Some((begin_s, until_s, turn)) = &mut open {
            while let Some((at_s, rate)) = rates.next_if(|(at_s, _)| *at_s <= time_s) {
                let by = rate * (at_s - *until_s).max(0.0);
                *until_s = until_s.max(at_s);
                turn.given = Rotation3::new(-by) * turn.given;
                turn.reversed = Rotation3::new(by) * turn.reversed;
                turn.degrees = Rotation3::new(-by.map(f64::to_radians)) * turn.degrees;
            }
            if time_s - *begin_s < WINDOW_S {
                continue;
            }
        }
        let next = Turn {
            begin: field,
            end: field,
            given: Rotation3::identity(),
            reversed: Rotation3::identity(),
            degrees: Rotation3::identity(),
        };
        if let Some((.., turn)) = open.replace((time_s, time_s, next)) {
            turns.push(Turn { end: field, ..turn });
        }
    }
    turns
}

/// Whether the field turns by the rates if these are in °/s, and neither by them as they are
/// nor not at all.
fn in_degrees(turns: &[Turn]) -> Option<String> {
    let left = |by: fn(&Turn) -> Vector3<f64>| -> f64 {
        turns
            .iter()
            .map(|turn| (turn.end - by(turn)).norm_squared())
            .sum()
    };
    let given = left(|turn| turn.given * turn.begin);
    let degrees = left(|turn| turn.degrees * turn.begin);
    let still = left(|turn| turn.begin);
    (turns.len() >= LEAST_WINDOWS && given.min(still) > CLEARLY * degrees).then(|| {
        "gyroscope: the field of the magnetometer turns as if rates were in °/s: they are in \
         rad/s; are they in °/s?"
            .to_owned()
    })
}

/// Whether the field turns by the rates with the axes of one of both exchanged or reversed,
/// and not with those that were given.
fn other_axes(turns: &[Turn]) -> Option<String> {
    if turns.len() < LEAST_FOR_AXES {
        return None;
    }
    let given = left(turns, &Matrix3::identity(), |turn| &turn.given);
    let field: f64 = turns.iter().map(|turn| turn.begin.norm_squared()).sum();
    if given < WRONG * WRONG * field {
        return None;
    }
    let mut best = (given / CLEARLY, None);
    for axes in signed_permutations() {
        // Rates in other axes turn what is in other axes; of the other hand they turn it back.
        let of_rates = -axes.transpose();
        for (left, words) in [
            (
                left(turns, &axes, |turn| &turn.given),
                ("magnetometer", axes),
            ),
            (
                left(turns, &axes, |turn| &turn.reversed),
                ("gyroscope", of_rates),
            ),
        ] {
            if left < best.0 {
                best = (left, Some(words));
            }
        }
    }
    let (sensor, axes) = best.1?;
    Some(format!(
        "{sensor}: the field turns as the rates say if its axes are {}, and not as they are \
         given: give x, y, z forward, right, down",
        in_words(&axes)
    ))
}

/// What rates leave of how the field turns, with these axes of it and whatever adds to it in
/// the body, as a sum of squares.
fn left(turns: &[Turn], axes: &Matrix3<f64>, by: fn(&Turn) -> &Rotation3<f64>) -> f64 {
    let mut squares = 0.0;
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for turn in turns {
        let by = by(turn).matrix();
        let apart = axes * turn.end - by * (axes * turn.begin);
        let of_body = Matrix3::identity() - by;
        squares += apart.norm_squared();
        normal += of_body.transpose() * of_body;
        right += of_body.transpose() * apart;
    }
    // What does not turn is not told from the field.
    let smallest = 1e-3 * normal.trace();
    let of_body = normal
        .pseudo_inverse(smallest)
        .map(|inverse| inverse * right);
    squares - of_body.map_or(0.0, |of_body| of_body.dot(&right))
}

/// The axes in each order with each sign.
fn signed_permutations() -> impl Iterator<Item = Matrix3<f64>> {
    const ORDERS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [1, 0, 2],
        [2, 1, 0],
        [0, 2, 1],
        [1, 2, 0],
        [2, 0, 1],
    ];
    ORDERS.into_iter().flat_map(|order| {
        (0..8_u8).map(move |signs| {
            Matrix3::from_fn(|row, column| match order.get(row) {
                Some(of_row) if *of_row == column => 1.0 - 2.0 * f64::from(signs >> row & 1),
                _ => 0.0,
            })
        })
    })
}

/// Such as "y, -x, z".
fn in_words(axes: &Matrix3<f64>) -> String {
    let each = axes.row_iter().map(|row| {
        let parts = row.iter().zip(["x", "y", "z"]);
        parts
            .filter(|(sign, _)| **sign != 0.0)
            .map(|(sign, axis)| {
                if *sign < 0.0 {
                    format!("-{axis}")
                } else {
                    axis.to_owned()
                }
            })
            .collect::<String>()
    });
    each.collect::<Vec<_>>().join(", ")
}
