//! Which rotor does not turn, from what the rotors should do and what the body does.

use fcc_core::flight::MOST_ROTORS;
use nalgebra::{SVector, Vector2, Vector3};

use crate::airframe::{Airframe, Effectiveness};

type Shares = SVector<f64, MOST_ROTORS>;

/// The time constant of all figures, s: vibrations are shorter.
const SMOOTH_S: f64 = 0.04;
/// What lasts longer than this is the load or the wind, s.
const STEADY_S: f64 = 1.0;
/// A rotor is lost if so much of its moment is missing, so exactly about its axis (the cosine of
/// the angle to it; the next rotor of eight is 45° away), for so long, s.
const LOST: f64 = 0.7;
const MOST: f64 = 1.4;
const COS_ABOUT: f64 = 0.9;
const LASTS_S: f64 = 0.06;
/// One of eight does less harm, and its moment is less distinct.
const OF_EIGHT_S: f64 = 0.1;
/// Of one that gives less than this share its moment is not known.
const LEAST_SHARE: f64 = 0.15;
/// Less is nothing, rad/s².
const LEAST_RADPS2: f64 = 5.0;

/// Compares the angular acceleration about roll and pitch with that of the shares given.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct RotorWatch {
    lag_s: f64,
    lasts_s: f64,
    /// Given, as late as motors and sensors are; and smoothed like the rates.
    late: Shares,
    smooth: Shares,
    rates_radps: Vector3<f64>,
    steady: Vector2<f64>,
    suspect: Option<usize>,
    suspected_s: f64,
}

impl RotorWatch {
    pub(crate) fn new(airframe: &Airframe, latency_s: f64) -> Self {
        let count = airframe.rotors.iter().flatten().count();
        Self {
            lag_s: airframe.motor_lag_s + latency_s,
            lasts_s: if count > 6 { OF_EIGHT_S } else { LASTS_S },
            late: Shares::zeros(),
            smooth: Shares::zeros(),
            rates_radps: Vector3::zeros(),
            steady: Vector2::zeros(),
            suspect: None,
            suspected_s: 0.0,
        }
    }

    /// Takes the shares given in a tick and the measured turn rates; the rotor that is lost.
    pub(crate) fn step(
        &mut self,
        effectiveness: &Effectiveness,
        shares: &[f64; MOST_ROTORS],
        rates_radps: &Vector3<f64>,
        dt_s: f64,
    ) -> Option<usize> {
        // Rates less their smoothed ones, over its time, are the smoothed acceleration.
        let measured = (rates_radps - self.rates_radps).xy() / SMOOTH_S;
        let smooths = dt_s / (SMOOTH_S + dt_s);
        self.rates_radps += (rates_radps - self.rates_radps) * smooths;
        self.late += (Shares::from(*shares) - self.late) * (dt_s / (self.lag_s + dt_s));
        self.smooth += (self.late - self.smooth) * smooths;
        let about = effectiveness.fixed_rows::<2>(1);
        let off = measured - about * self.smooth - self.steady;
        let found = (off.norm() > LEAST_RADPS2)
            .then(|| (0..MOST_ROTORS).find(|rotor| self.explains(effectiveness, *rotor, &off)))
            .flatten();
        if found.is_none() {
            self.steady += off * (dt_s / STEADY_S);
        }
        let is_same = found.is_some() && found == self.suspect;
        self.suspected_s = if is_same {
            self.suspected_s + dt_s
        } else {
            0.0
        };
        self.suspect = found;
        found.filter(|_| self.suspected_s > self.lasts_s)
    }

    fn explains(&self, effectiveness: &Effectiveness, rotor: usize, off: &Vector2<f64>) -> bool {
        let share = self.smooth.get(rotor).copied().unwrap_or_default();
        let lacks = -effectiveness.fixed_view::<2, 1>(1, rotor) * share;
        let along = off.dot(&lacks);
        share > LEAST_SHARE
            && (LOST..=MOST).contains(&(along / lacks.norm_squared()))
            && along > COS_ABOUT * lacks.norm() * off.norm()
    }
}
