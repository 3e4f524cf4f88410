//! Airspeed from the forces on the aircraft and its motion.

use libm::exp;

use super::airframe::AirframePrior;
use super::force_sample::{ForceSample, MIN_AIRSPEED_MPS};
use super::scalar_update::{add_variance, squared, update};
use super::wind::Wind;
use fcc_core::blocks::limit_abs;

mod learned;
mod over_ground;

/// Parasite and induced drag over weight at V₀, of a lift over drag of 9 there:
/// light aircraft cruise at 8 to 12 (Roskam and Lan 1997, table 5.1 has others).
const PARASITE_DRAG_RATIO: f64 = 0.09;
const INDUCED_DRAG_RATIO: f64 = 0.02;
/// The angle of attack above that of zero lift, for 1 g at V₀, rad (3.8°).
const LIFT_ANGLE_RAD: f64 = 0.067;

/// Standard deviations: of the axial model over weight, of the lift model in
/// rad, of an airspeed sensor in m/s.
const AXIAL_SD: f64 = 0.02;
const LIFT_SD_RAD: f64 = 0.017_5;
const SENSOR_SD_MPS: f64 = 0.514;
/// The correlation time of both models' errors, s: they depend on airspeed, power and load.
const MODEL_S: f64 = 5.0;
/// The lift's, in multiples, while it determines the climb rate over long times.
const LIFT_BY_ITSELF: f64 = 3.0;
/// That of an airspeed whose models were wrong for some seconds, m/s.
const RESTORED_SD_MPS: f64 = 2.0;
/// That of one which the sensor had before it stepped, m/s.
const KNOWN_SD_MPS: f64 = 1.0;
/// The time in which a change of thrust that the model does not explain counts as a
/// lasting offset, s, and its weights in the noise of a correction and of the comparison of
/// two airspeeds.
const THRUST_SETTLES_S: f64 = 5.0;
const THRUST_NOISE: f64 = 3.0;
/// Beyond these innovations the force is not explained by airspeed: an engine
/// that stops, or a wind that rises (weight; rad).
const ENGINE_CHANGE: f64 = 0.05;
const UPDRAUGHT_RAD: f64 = 0.026;
/// Beyond this difference from the force by the remembered model, in weights,
/// that is no longer the aircraft's: its engine has failed.
const NO_LONGER_THE_SAME: f64 = 0.08;
const UPDRAUGHT_SHARE: f64 = 0.2;
/// The correlation time of vertical gusts, s: 533 m at 65 m/s (MIL-F-8785C,
/// 3.7.3, above 2,000 ft).
const GUST_S: f64 = 8.0;
/// Random walks, per √s: of the airspeed in m/s, in upsets too, of the offset, of the thrust
/// ratio, of the zero of the angle of attack in rad.
const AIRSPEED_WALK_MPS: f64 = 0.2;
const UPSET_WALK_MPS: f64 = 2.0;
const OFFSET_WALK: f64 = 0.000_5;
const THRUST_WALK: f64 = 0.003;
const ANGLE_WALK_RAD: f64 = 0.000_87;
/// The share of the gusts' variance that acts along the path.
const GUSTS_ALONG: f64 = 0.3;
/// What the integrated acceleration lacks at first: 1° of pitch and 10 mg together; and
/// its random walk, per √s, m/s².
const BIAS_SD_MPS2: f64 = 0.2;
const BIAS_WALK_MPS2: f64 = 0.002;

/// The state: indicated airspeed V in m/s, vertical wind w in m/s, offset of
/// the axial force, thrust ratio, angle of attack of zero lift in rad, angle of
/// attack for 1 g in rad, and what the integrated acceleration lacks, in m/s²: the biases
/// of the attitude and of the accelerometers.
const N: usize = 7;
type State = super::scalar_update::State<N>;
/// The four of them that are models of forces.
type Models = [f64; 4];

/// An extended Kalman filter. The acceleration along the path is integrated;
/// two models of forces correct it, both with q = (V/V₀)²:
///
/// - along x, in weights: thrust·V₀/V - D₀ q + (A - K) n²/q + offset (the drag
///   polar with the lift's part along x; Stevens, Lewis and Johnson 2016, 2.3),
/// - of lift: the angle of attack α₀ + A n/q is the one between the body and a
///   path whose slope is the climb rate without vertical wind over the true
///   airspeed, in any attitude ([`Upward`](super::upward::Upward)).
///
/// What it does not know of the aircraft it learns while a sensor is believed.
#[derive(Clone, Copy, Debug)]
pub(super) struct AirspeedFilter {
    prior: AirframePrior,
    x: State,
    covariance: [State; N],
    /// The models as they were when the filter was copied.
    kept: State,
    is_copy: bool,
    /// How far the airspeed is from this one by each force alone, with the models as they were
    /// when the filter was copied, m/s; none where an engine has failed.
    axial_mps: Option<f64>,
    lift_mps: f64,
    pub(super) wind: Wind,
}

impl AirspeedFilter {
    /// A filter that begins at an airspeed with this standard deviation, m/s.
    pub(super) fn new(
        prior: AirframePrior,
        (airspeed_mps, sd_mps): (f64, f64),
        sample: &ForceSample,
    ) -> Self {
        let ([offset, thrust, zero_lift_rad, angle], sds) = match prior.learned {
            Some(learned) => learned::models(learned),
            None => Self::unlearned(prior, airspeed_mps, sample),
        };
        let x = [airspeed_mps, 0.0, offset, thrust, zero_lift_rad, angle, 0.0];
        let mut filter = Self {
            prior,
            x,
            covariance: [[0.0; N]; N],
            kept: x,
            is_copy: false,
            axial_mps: None,
            lift_mps: 0.0,
            wind: Wind::new(),
        };
        let [offset, thrust, zero_lift, angle] = sds;
        let sds = [sd_mps, 1.0, offset, thrust, zero_lift, angle, BIAS_SD_MPS2];
        add_variance(&mut filter.covariance, sds.map(squared));
        filter.learn_offset(sample);
        filter
    }

    /// The models of an aircraft of which nothing was learned, and their standard
    /// deviations.
    fn unlearned(
        prior: AirframePrior,
        airspeed_mps: f64,
        sample: &ForceSample,
    ) -> (Models, Models) {
        let q = squared(airspeed_mps / prior.reference_mps);
        let path = sample.climb_rate_mps * sample.sqrt_density / airspeed_mps;
        let zero_lift_rad =
            sample.upward.angle_of_attack_rad(path) - LIFT_ANGLE_RAD * sample.up / q;
        let thrust = prior.full_thrust_ratio;
        (
            [0.0, thrust, zero_lift_rad, LIFT_ANGLE_RAD],
            [0.0, 0.5 * thrust, 0.052, 0.25 * LIFT_ANGLE_RAD],
        )
    }

    pub(super) const fn airspeed_mps(&self) -> f64 {
        self.x[0]
    }

    pub(super) const fn vertical_wind_mps(&self) -> f64 {
        self.x[1]
    }

    /// The climb rate by pitch and lift, m/s, without vertical wind.
    pub(super) fn climb_rate_mps(&self, sample: &ForceSample) -> f64 {
        let alpha = self.x[4] + self.x[5] * sample.up * squared(self.slower());
        self.at_mps() / sample.sqrt_density * sample.upward.sin_path(alpha)
    }

    /// Standard deviation of the airspeed, m/s.
    pub(super) fn sd_mps(&self) -> f64 {
        libm::sqrt(self.covariance[0][0].max(0.0))
    }

    /// Sets the airspeed.
    pub(super) const fn adopt(&mut self, airspeed_mps: f64) {
        self.x[0] = airspeed_mps;
    }

    /// Sets the airspeed to one that was right a moment ago.
    pub(super) fn adopt_known(&mut self, airspeed_mps: f64) {
        self.x[0] = airspeed_mps;
        for [with_airspeed, ..] in &mut self.covariance {
            *with_airspeed = 0.0;
        }
        self.covariance[0] = [0.0; N];
        self.covariance[0][0] = squared(KNOWN_SD_MPS);
    }

    /// Takes the models that it remembers, without vertical wind: what was
    /// learned since came from an altimeter that is doubted.
    pub(super) fn restore_models(&mut self) {
        let [.., offset, thrust, zero, angle, bias] = self.kept;
        self.x = [self.x[0], 0.0, offset, thrust, zero, angle, bias];
        self.covariance[0][0] += squared(RESTORED_SD_MPS);
    }

    /// Whether it remembers models that were learned, not those it began with.
    pub(super) const fn is_copy(&self) -> bool {
        self.is_copy
    }

    /// A copy that remembers the models as they are now.
    pub(super) const fn kept(&self) -> Self {
        let mut copy = *self;
        copy.kept = self.x;
        copy.is_copy = true;
        copy
    }

    /// The offset of the axial force follows from a throttle that is known only
    /// now.
    pub(super) fn learn_offset(&mut self, sample: &ForceSample) {
        if let Some((thrust, _)) = sample.thrust.filter(|_| self.prior.learned.is_none()) {
            self.x[2] = 0.0;
            self.x[2] = sample.forward - self.axial_of(self.x, thrust, sample.up);
            self.kept[2] = self.x[2];
            self.covariance[2][2] += squared(0.05);
        }
    }

    /// Integrates an acceleration along the path, of indicated airspeed.
    pub(super) fn accelerate(&mut self, acceleration_mps2: f64, dt_s: f64) {
        self.x[0] += (acceleration_mps2 + self.x[6]) * dt_s;
    }

    /// The uncertainty of `dt_s` seconds, then the corrections by both models.
    pub(super) fn correct(&mut self, sample: &ForceSample, dt_s: f64) {
        self.predict(sample.gusts_mps, dt_s);
        self.correct_by_axial_force(sample, dt_s);
        self.correct_by_lift(sample, dt_s);
    }

    /// Corrects by a sensor's airspeed.
    pub(super) fn correct_by_sensor(&mut self, airspeed_mps: f64) {
        let by = airspeed_mps - self.x[0];
        update(
            &mut self.x,
            &mut self.covariance,
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            by,
            squared(SENSOR_SD_MPS),
        );
    }

    /// How far the airspeed is from this one by axial force and by lift, each alone and with
    /// the models as they were when the filter was copied, m/s. A force that says nothing says
    /// the sensor's `differs_mps`.
    pub(super) fn by_forces_mps(&self, differs_mps: f64) -> [f64; 2] {
        [self.axial_mps.unwrap_or(differs_mps), self.lift_mps]
    }

    /// `dt_s` seconds in an attitude for which the models do not hold.
    pub(super) fn without_models(&mut self, dt_s: f64) {
        self.covariance[0][0] += squared(UPSET_WALK_MPS) * dt_s;
    }

    fn predict(&mut self, gusts_mps: f64, dt_s: f64) {
        let fades = exp(-dt_s / GUST_S);
        let bias = self.covariance[6];
        for (with_airspeed, with_bias) in self.covariance[0].iter_mut().zip(bias) {
            *with_airspeed += with_bias * dt_s;
        }
        for [with_airspeed, .., with_bias] in &mut self.covariance {
            *with_airspeed += *with_bias * dt_s;
        }
        self.x[1] *= fades;
        self.covariance[1] = self.covariance[1].map(|p| p * fades);
        for [_, wind, ..] in &mut self.covariance {
            *wind *= fades;
        }
        let gusts = squared(gusts_mps);
        // A copy does not learn: what it would learn comes from itself.
        let walks = if self.is_copy { 0.0 } else { 1.0 };
        add_variance(
            &mut self.covariance,
            [
                (squared(AIRSPEED_WALK_MPS) + GUSTS_ALONG * 2.0 * gusts / GUST_S) * dt_s,
                (1.0 - fades * fades) * gusts,
                walks * squared(OFFSET_WALK) * dt_s,
                walks * squared(THRUST_WALK) * dt_s,
                walks * squared(ANGLE_WALK_RAD) * dt_s,
                0.0,
                squared(BIAS_WALK_MPS2) * dt_s,
            ],
        );
    }

    fn correct_by_axial_force(&mut self, sample: &ForceSample, dt_s: f64) {
        let Some((thrust, unknown)) = sample.thrust else {
            self.axial_mps = None;
            return;
        };
        let slower = self.slower();
        let induced = squared(sample.up * slower);
        let unexplained = squared(self.x[3] * unknown);
        self.covariance[2][2] += unexplained * dt_s / THRUST_SETTLES_S;
        let drag = 2.0 * (PARASITE_DRAG_RATIO / squared(slower));
        let per_mps = -(self.x[3] * thrust * slower
            + drag
            + 2.0 * (self.x[5] - INDUCED_DRAG_RATIO) * induced)
            / self.at_mps();
        let per_mps = per_mps.min(-1e-3);
        let kept = sample.forward - self.axial_of(self.kept, thrust, sample.up);
        let is_explained = kept.abs() < NO_LONGER_THE_SAME;
        self.axial_mps = is_explained.then_some(kept / per_mps);
        let by = sample.forward - self.axial_of(self.x, thrust, sample.up);
        if by.abs() > ENGINE_CHANGE {
            let (place, per_force) = self.changed_by_engine(by, thrust * slower);
            if let Some(own) = self
                .covariance
                .get_mut(place)
                .and_then(|row| row.get_mut(place))
            {
                *own += squared(by * per_force) * dt_s;
            }
        }
        update(
            &mut self.x,
            &mut self.covariance,
            [per_mps, 0.0, 1.0, thrust * slower, 0.0, induced, 0.0],
            by,
            correlated(squared(AXIAL_SD) + THRUST_NOISE * unexplained, dt_s),
        );
    }

    /// The place in the state of what has changed with a difference of force, in weights, and
    /// its change per force: an engine that fails loses its thrust at every airspeed alike, so
    /// the thrust ratio, as far as that stays between none and 1.5 times the expected one.
    fn changed_by_engine(&self, by: f64, per_ratio: f64) -> (usize, f64) {
        let per_force = 1.0 / per_ratio.max(1e-3);
        let ratio = self.x[3] + by * per_force;
        let is_thrust = (-0.02..1.5 * self.prior.full_thrust_ratio).contains(&ratio);
        if is_thrust { (3, per_force) } else { (2, 1.0) }
    }

    /// Force along x over weight, with the models of `by` and the present
    /// airspeed.
    fn axial_of(&self, by: State, thrust: f64, load: f64) -> f64 {
        let [_, _, offset, ratio, _, angle, _] = by;
        let slower = self.slower();
        offset + ratio * thrust * slower - PARASITE_DRAG_RATIO / squared(slower)
            + (angle - INDUCED_DRAG_RATIO) * squared(load * slower)
    }

    fn correct_by_lift(&mut self, sample: &ForceSample, dt_s: f64) {
        let true_mps = self.at_mps() / sample.sqrt_density;
        let lift = sample.up * squared(self.slower());
        let upward = sample.upward;
        let share = upward.share;
        // In the scale of pitch: with the wings level a difference of pitch.
        let differs = |[_, wind, _, _, zero, angle, _]: State| {
            let along = upward.angle_of_attack_rad((sample.climb_rate_mps - wind) / true_mps);
            share * (along - zero - angle * lift)
        };
        let path = limit_abs((sample.climb_rate_mps - self.x[1]) / true_mps, 0.5);
        let per_mps = -(path + 2.0 * share * self.x[5] * lift) / self.at_mps();
        // A horizontal wind that changes and a vertical one look alike to the
        // filter. The vote is without one, so that it is for a sensor which
        // explains the lift by itself.
        let by_kept = differs([0.0, 0.0, 0.0, 0.0, self.kept[4], self.kept[5], 0.0]);
        self.lift_mps = by_kept / per_mps.min(-1e-3);
        let by = differs(self.x);
        if by.abs() > UPDRAUGHT_RAD {
            self.covariance[1][1] += UPDRAUGHT_SHARE * squared(by * true_mps);
        }
        let sd_rad = if sample.climbs_by_lift {
            LIFT_BY_ITSELF * LIFT_SD_RAD
        } else {
            LIFT_SD_RAD
        };
        update(
            &mut self.x,
            &mut self.covariance,
            [per_mps, -1.0 / true_mps, 0.0, 0.0, share, share * lift, 0.0],
            by,
            correlated(squared(sd_rad), dt_s),
        );
    }

    fn at_mps(&self) -> f64 {
        self.x[0].max(MIN_AIRSPEED_MPS)
    }

    /// V₀ over V.
    fn slower(&self) -> f64 {
        self.prior.reference_mps / self.at_mps()
    }
}

/// The variance of one of the samples, `dt_s` apart, whose error of this variance is the same
/// over [`MODEL_S`].
fn correlated(variance: f64, dt_s: f64) -> f64 {
    variance * (2.0 * MODEL_S / dt_s).max(1.0)
}

#[cfg(test)]
mod tests;
