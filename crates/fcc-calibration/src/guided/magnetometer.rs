//! A magnetometer, turned through all directions.

use libm::sqrt;

use super::place::Place;
use super::readings::Arrived;
use super::rest::Rest;
use super::sphere::{CELLS, SpreadSamples, middle_of};
use super::{Collect, EarthField, Found, Next, Quality, Refusal, Values, norm};
use crate::fit::{UNKNOWNS, fit_strength};
use crate::{Axes, AxesCalibration, DipFit, constant_dip};
use fcc_core::units::GRAVITY_MPS2;
use fcc_navigation::inertial::{GeodeticPosition, earth_field_ut};

/// Cells of the sphere that are needed.
const NEEDED: usize = 30;
/// The largest error that is left, of the strength.
const LARGEST_RESIDUAL_SHARE: f64 = 0.03;
/// By how much the strength may differ from the earth's: the tolerance of a
/// sensor's scale, and that of steel in a building.
const STRENGTH_SHARE: f64 = 0.25;
/// The earth's field is 22 to 67 µT; in the middle of it, until it is known.
const USUAL_UT: f64 = 45.0;
/// The accelerometer shows down while it is turned slowly: its strength differs
/// from gravity by less than so much.
const SLOW_SHARE: f64 = 0.05;
/// An alignment that leaves more is none, rad: 4°.
const LARGEST_DIP_RAD: f64 = 0.07;
/// So many readings of one axis that are equal to the last bit, while another
/// axis changes by this share of the strength: it is at the end of its range.
const EQUAL_READINGS: u32 = 20;
const CHANGED_SHARE: f64 = 0.1;

/// Collects the field in all directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    earth: EarthField,
    /// By the model, where the receiver is.
    model_ut: Option<f64>,
    /// From what the accelerometer gives to body axes.
    accelerometer: Option<AxesCalibration>,
    down: Option<[f64; 3]>,
    samples: SpreadSamples,
    clipping: Clipping,
}

impl Sphere {
    pub(super) fn new(earth: EarthField, accelerometer: Option<&Axes>) -> Self {
        let known_ut = match earth {
            EarthField::Strength(strength_ut) => Some(strength_ut),
            EarthField::InYear(_) | EarthField::Unknown => None,
        };
        Self {
            earth,
            model_ut: known_ut,
            accelerometer: accelerometer.map(AxesCalibration::new),
            down: None,
            samples: SpreadSamples::new(known_ut.unwrap_or(USUAL_UT)),
            clipping: Clipping::default(),
        }
    }

    pub(super) const fn covered(&self) -> &[bool; CELLS] {
        self.samples.covered()
    }

    fn count(&self) -> usize {
        self.covered().iter().filter(|covered| **covered).count()
    }

    /// The alignment with the accelerometer, if that was there.
    fn dip(&self, calibration: &AxesCalibration) -> Option<DipFit> {
        let mut pairs = [([0.0; 3], [0.0; 3]); 256];
        let mut count = 0;
        for (pair, (down, field)) in pairs.iter_mut().zip(self.samples.pairs()) {
            *pair = (down, calibration.applied(field));
            count += 1;
        }
        let fit = constant_dip(pairs.get(..count)?.iter().copied())?;
        (fit.residual_rad <= LARGEST_DIP_RAD).then_some(fit)
    }
}

impl Collect for Sphere {
    fn take(&mut self, arrived: &Arrived, _: &Rest) {
        if let (Some(fix), EarthField::InYear(year)) = (&arrived.gnss, self.earth) {
            let place = GeodeticPosition {
                latitude_rad: fix.position.latitude_rad,
                longitude_rad: fix.position.longitude_rad,
                altitude_m: fix.position.altitude_m,
            };
            self.model_ut = earth_field_ut(place, year).map(norm);
        }
        if let (Some(force), Some(calibration)) = (arrived.force, &self.accelerometer) {
            let force = calibration.applied(force);
            let is_slow = (norm(force) / GRAVITY_MPS2 - 1.0).abs() <= SLOW_SHARE;
            self.down = is_slow.then_some(force.map(|part| -part));
        }
        if let Some(field) = arrived.field {
            self.clipping.take(field);
            self.samples.take((field, self.down));
        }
    }

    fn progress(&self) -> f64 {
        (self.count() as f64 / NEEDED as f64).min(1.0)
    }

    fn is_complete(&self) -> bool {
        self.count() >= NEEDED
    }

    fn next(&self) -> Next {
        let open = self.covered().iter().position(|covered| !covered);
        match open {
            Some(cell) if !self.is_complete() => Next::Turn(Place::closest(middle_of(cell))),
            _ => Next::Done,
        }
    }

    fn finish(&self) -> Result<Found, Refusal> {
        if let Some(axis) = self.clipping.axis {
            return Err(Refusal::Saturated { axis });
        }
        if !self.is_complete() {
            return Err(Refusal::ended(0, self.count(), NEEDED));
        }
        let samples = self.samples.samples();
        let measured_ut = self.samples.sphere().map_or(0.0, |(_, radius)| radius);
        if let Some(expected) = self.model_ut
            && (measured_ut / expected - 1.0).abs() > STRENGTH_SHARE
        {
            return Err(Refusal::Strength {
                measured: measured_ut,
                expected,
            });
        }
        let strength_ut = self.model_ut.unwrap_or(measured_ut);
        let fit = fit_strength(samples, strength_ut)?;
        let free = samples.len().saturating_sub(UNKNOWNS).max(1) as f64;
        let residual_ut = fit.residual * sqrt(samples.len() as f64 / free);
        let dip = self.dip(&AxesCalibration::new(&fit.axes));
        Ok(Found {
            values: Values::Magnetometer {
                axes: fit.axes,
                mounting: dip.map(|fit| fit.rotation.mounting()),
                strength_ut,
                is_of_model: self.model_ut.is_some(),
            },
            quality: Quality::within(residual_ut, LARGEST_RESIDUAL_SHARE * strength_ut)?,
            sigma: fit.bias_sigma.into_iter().fold(0.0, f64::max),
        })
    }
}

/// Finds an axis that is at the end of its range: it does not change while
/// others do.
#[derive(Clone, Copy, Debug, Default)]
struct Clipping {
    last: [f64; 3],
    /// How often each axis was equal in a row, and the field at the first.
    equal: [(u32, [f64; 3]); 3],
    axis: Option<usize>,
}

impl Clipping {
    fn take(&mut self, field: [f64; 3]) {
        let axes = self.equal.iter_mut().zip(field.into_iter().zip(self.last));
        for (axis, ((count, first), (now, before))) in axes.enumerate() {
            if now != before {
                (*count, *first) = (0, field);
                continue;
            }
            *count += 1;
            let changed = norm(super::difference(field, *first));
            if *count >= EQUAL_READINGS && changed > CHANGED_SHARE * USUAL_UT {
                self.axis = Some(axis);
            }
        }
        self.last = field;
    }
}
