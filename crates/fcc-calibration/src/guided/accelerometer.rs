//! An accelerometer, held still in many positions.

use core::time::Duration;

use libm::sqrt;

use super::place::Place;
use super::readings::Arrived;
use super::rest::{Halves, Rest};
use super::{Collect, Found, Next, Quality, Refusal, Values};
use crate::fit::UNKNOWNS;
use crate::{FitError, fit_strength};
use fcc_core::units::GRAVITY_MPS2;

/// For how long each position is held.
const LENGTH: Duration = Duration::from_secs(2);
/// From the first half of it to the second, m/s²: a tilt of 0.6°.
const MOVED_MPS2: f64 = 0.1;
/// The largest error that is left, m/s²: 10 mg.
const LARGEST_RESIDUAL_MPS2: f64 = 0.1;
const FACES: usize = 6;
/// Of each two axes. One tells their misalignment, the other how well.
const EDGES_OF_A_PLANE: usize = 2;
const POSITIONS: usize = FACES + 3 * EDGES_OF_A_PLANE;

/// Collects the positions of an accelerometer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Positions {
    /// In the order of [`Place::ALL`].
    held: [Option<[f64; 3]>; Place::ALL.len()],
    present: Halves<3>,
    /// The position at present, if it is at rest in one.
    at: Option<Place>,
    interruptions: u32,
}

impl Positions {
    pub(super) fn new() -> Self {
        Self {
            held: [None; Place::ALL.len()],
            present: Halves::new(LENGTH),
            at: None,
            interruptions: 0,
        }
    }

    /// Whether each place was held.
    pub(super) fn held(&self) -> [bool; Place::ALL.len()] {
        self.held.map(|held| held.is_some())
    }

    /// Where the sensor's zero is, as far as opposite faces tell.
    fn centre(&self) -> [f64; 3] {
        let (faces, _) = self.held.split_at(FACES);
        let mut centre = [0.0; 3];
        let axes = centre.iter_mut().zip(faces.as_chunks::<2>().0).zip(0..);
        for ((centre, opposite), axis) in axes {
            if let [Some(one), Some(other)] = opposite {
                let of = |held: &[f64; 3]| held.iter().copied().nth(axis).unwrap_or_default();
                *centre = 0.5 * (of(one) + of(other));
            }
        }
        centre
    }

    fn place_of(&self, force: [f64; 3]) -> Option<Place> {
        let [x, y, z] = force;
        let [bx, by, bz] = self.centre();
        Place::of([x - bx, y - by, z - bz])
    }

    /// The places that are needed and were not held.
    fn missing(&self) -> impl Iterator<Item = Place> {
        let (faces, edges) = self.held.split_at(FACES);
        let (of_faces, of_edges) = Place::ALL.split_at(FACES);
        let open = |(held, place): (&Option<[f64; 3]>, &Place)| held.is_none().then_some(*place);
        let edges = edges.chunks(4).zip(of_edges.chunks(4));
        let edges = edges.flat_map(move |(held, places)| {
            let done = held.iter().flatten().count();
            let left = EDGES_OF_A_PLANE.saturating_sub(done);
            held.iter().zip(places).filter_map(open).take(left)
        });
        faces.iter().zip(of_faces).filter_map(open).chain(edges)
    }

    /// The present rest is over.
    fn end(&mut self) {
        self.present.clear();
        self.at = None;
    }
}

impl Collect for Positions {
    fn take(&mut self, arrived: &Arrived, rest: &Rest) {
        let Some(force) = arrived.force else { return };
        let at = rest.is_given().then(|| self.place_of(force)).flatten();
        if at.is_none() || at != self.at {
            let is_cut = self.present.has_begun() && !self.present.is_full();
            self.interruptions += u32::from(is_cut);
            self.end();
            self.at = at;
        }
        let Some(place) = at.filter(|_| !self.present.is_full()) else {
            return;
        };
        self.present.take(force, arrived.at);
        if self.present.is_full() {
            if self.present.change() > MOVED_MPS2 {
                self.interruptions += 1;
                self.end();
                return;
            }
            let mean = self.present.mean();
            for (held, of) in self.held.iter_mut().zip(Place::ALL) {
                if of == place {
                    *held = Some(mean);
                }
            }
        }
    }

    fn progress(&self) -> f64 {
        let left = self.missing().count() as f64;
        let is_new = self.at.is_some_and(|at| self.missing().any(|of| of == at));
        let present = if is_new { self.present.share() } else { 0.0 };
        (POSITIONS as f64 - left + present) / POSITIONS as f64
    }

    fn is_complete(&self) -> bool {
        self.missing().next().is_none()
    }

    fn next(&self) -> Next {
        let missing = |at: &Place| self.missing().any(|place| place == *at);
        match self.at.filter(missing) {
            Some(place) => Next::Hold(place),
            None => self.missing().next().map_or(Next::Done, Next::Place),
        }
    }

    fn finish(&self) -> Result<Found, Refusal> {
        let left = self.missing().count();
        if left > 0 {
            return Err(Refusal::ended(
                self.interruptions,
                POSITIONS - left,
                POSITIONS,
            ));
        }
        let mut samples = [[0.0; 3]; Place::ALL.len()];
        let mut count = 0;
        for (sample, held) in samples.iter_mut().zip(self.held.iter().flatten()) {
            *sample = *held;
            count += 1;
        }
        let (samples, _) = samples.split_at_checked(count).ok_or(FitError::NoFit)?;
        let fit = fit_strength(samples, GRAVITY_MPS2)?;
        // With so few samples, what the unknowns hide counts.
        let free = (count - UNKNOWNS) as f64;
        let residual = fit.residual * sqrt(count as f64 / free);
        Ok(Found {
            values: Values::Accelerometer(fit.axes),
            quality: Quality::within(residual, LARGEST_RESIDUAL_MPS2)?,
            sigma: fit.bias_sigma.into_iter().fold(0.0, f64::max),
        })
    }
}
