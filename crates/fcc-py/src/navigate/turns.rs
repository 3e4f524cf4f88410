//! Whether a vector that is fixed in the earth, the magnetic field or gravity, turns as the
//! gyroscope says, or as it would with rates in another unit, or with other axes.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::plausible::{CLEARLY, WINDOW_S};

/// Turns are compared in at least so many windows; axes in more, because there are many.
const LEAST_WINDOWS: usize = 3;
const LEAST_FOR_AXES: usize = 10;
/// Axes are wrong if the vector is then that far from where it should be, as a share of it.
const WRONG: f64 = 0.1;

/// The vector at the begin and at the end of some seconds, and what the rates between them
/// make of one that does not turn with the body.
pub(super) struct Turn {
    pub(super) begin: Vector3<f64>,
    pub(super) end: Vector3<f64>,
    given: Rotation3<f64>,
    reversed: Rotation3<f64>,
    degrees: Rotation3<f64>,
}

pub(super) fn windows(rates: &[(f64, Vector3<f64>)], vectors: &[(f64, Vector3<f64>)]) -> Vec<Turn> {
    let mut rates = rates.iter().peekable();
    let mut turns: Vec<Turn> = Vec::new();
    let mut open: Option<(f64, f64, Turn)> = None;
    for (time_s, vector) in vectors {
        if let Some((begin_s, until_s, turn)) = &mut open {
            while let Some((at_s, rate)) = rates.next_if(|(at_s, _)| at_s <= time_s) {
                let by = rate * (at_s - *until_s).max(0.0);
                *until_s = until_s.max(*at_s);
                turn.given = Rotation3::new(-by) * turn.given;
                turn.reversed = Rotation3::new(by) * turn.reversed;
                turn.degrees = Rotation3::new(-by.map(f64::to_radians)) * turn.degrees;
            }
            if time_s - *begin_s < WINDOW_S {
                continue;
            }
        }
        let next = Turn {
            begin: *vector,
            end: *vector,
            given: Rotation3::identity(),
            reversed: Rotation3::identity(),
            degrees: Rotation3::identity(),
        };
        if let Some((.., turn)) = open.replace((*time_s, *time_s, next)) {
            turns.push(Turn {
                end: *vector,
                ..turn
            });
        }
    }
    turns
}

/// Whether the vector turns by the rates if these are in °/s, and neither by them as they are
/// nor not at all.
pub(super) fn are_in_degrees(turns: &[Turn]) -> bool {
    let left = |by: fn(&Turn) -> Vector3<f64>| -> f64 {
        turns
            .iter()
            .map(|turn| (turn.end - by(turn)).norm_squared())
            .sum()
    };
    let given = left(|turn| turn.given * turn.begin);
    let degrees = left(|turn| turn.degrees * turn.begin);
    let still = left(|turn| turn.begin);
    turns.len() >= LEAST_WINDOWS && given.min(still) > CLEARLY * degrees
}

/// By which rates a vector turns.
#[derive(Clone, Copy)]
pub(super) struct Relation {
    /// The rates by which it turns, in its own axes, from those that are given. Whoever
    /// reverses all three axes of the vector changes nothing here: dv/dt = -ω × v is linear
    /// in it. With its handedness reversed they are those of the other sign, so this is of
    /// the left hand if, and only if, the gyroscope is.
    pub(super) rates: Matrix3<f64>,
    /// No other rates explain its turns nearly as well.
    pub(super) is_only_one: bool,
}

impl Relation {
    /// That of turns which it takes to see one: none if there are too few of them, or if no
    /// axes explain them.
    pub(super) fn of(turns: &[Turn]) -> Option<Self> {
        if turns.len() < LEAST_FOR_AXES {
            return None;
        }
        let strength: f64 = turns.iter().map(|turn| turn.begin.norm_squared()).sum();
        let given = left(turns, Matrix3::identity(), false);
        let is_given = given < WRONG * WRONG * strength;
        let mut best = (given, Matrix3::identity());
        let mut others = Vec::new();
        // Proper rotations: of both hands because rates are reversed, too.
        for axes in signed_permutations().filter(|axes| axes.determinant() > 0.0) {
            for is_reversed in [false, true] {
                let found = left(turns, axes, is_reversed);
                others.push(found);
                if !is_given && found < best.0 {
                    best = (found, if is_reversed { -axes } else { axes });
                }
            }
        }
        if !is_given && given < CLEARLY * best.0 {
            return None;
        }
        let as_good = others.iter().filter(|left| **left < CLEARLY * best.0);
        Some(Self {
            rates: best.1,
            is_only_one: as_good.count() < 2,
        })
    }

    pub(super) fn is_as_given(&self) -> bool {
        self.rates == Matrix3::identity()
    }
}

/// What rates in these axes leave of how the vector turns, with whatever adds to it in the
/// body, as a sum of squares.
fn left(turns: &[Turn], axes: Matrix3<f64>, is_reversed: bool) -> f64 {
    let mut squares = 0.0;
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for turn in turns {
        let by = if is_reversed {
            turn.reversed
        } else {
            turn.given
        };
        // The same vector in axes in which the rates are as given.
        let by = axes * by.matrix() * axes.transpose();
        let apart = turn.end - by * turn.begin;
        let of_body = Matrix3::identity() - by;
        squares += apart.norm_squared();
        normal += of_body.transpose() * of_body;
        right += of_body.transpose() * apart;
    }
    // What does not turn is not told from the vector.
    let smallest = 1e-3 * normal.trace();
    let inverse = normal.pseudo_inverse(smallest);
    let of_body = inverse.map_or_else(|_| Vector3::zeros(), |inverse| inverse * right);
    squares - of_body.dot(&right)
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
pub(super) fn in_words(axes: &Matrix3<f64>) -> String {
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
