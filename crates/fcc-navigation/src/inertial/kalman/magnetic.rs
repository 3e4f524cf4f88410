//! The magnetic field: the heading, and what is known of the field itself.

use libm::{atan2, hypot};
use nalgebra::{SMatrix, Vector3};

use super::filter::Filter;
use super::motion::turn;
use super::noise::variances;
use super::parameters as p;
use super::receiver::UNKNOWN_HEADING;
use super::states::{ATTITUDE, BODY_FIELD, EARTH_FIELD, RATE_BIAS, STATES};
use super::update::{Corrects, Measurement};
use crate::inertial::ObservationKind;
use fcc_core::framework::Time;

/// A heading as certain as this is compared with the field, rad.
const CERTAIN_HEADING: f64 = 0.1;
/// A field that is refused for long is another one: variances, µT².
const OTHER_FIELD: f64 = 100.0;
/// A field whose strength differs by less than this share may be that of the earth.
const SAME_STRENGTH: f64 = 0.15;
/// The wind shows at least this share of the angle that the field shows, and across it at
/// most this share of that.
const LEAST_SHOWN: f64 = 0.3;
const MOST_ACROSS: f64 = 0.6;
/// And the heading may be wrong, rad².
const DOUBTED_HEADING: f64 = 0.07;

impl Filter {
    /// A magnetic field in body axes, taken `after_s` after the time of the
    /// state. `model` is the earth's field here, if it is known.
    pub(super) fn magnetic_field(
        &mut self,
        taken: Time,
        field: [f64; 3],
        after_s: f64,
        model: Option<[f64; 3]>,
    ) {
        // As it was at the time of the state.
        let measured = turn(self.rates * after_s) * Vector3::from(field);
        let strength = measured.norm();
        if strength <= 0.0 {
            return;
        }
        self.settle();
        if self.tracks.field.used.is_never() {
            if strength > p::STRONGEST_FIELD {
                return;
            }
            self.begin_with_field(measured, model.map(Vector3::from));
            self.tracks.field.judged(taken, true);
            return;
        }
        let since_s = self.tracks.field.since_tried_s(taken);
        let measurement = self.field_measurement(measured, since_s);
        let kind = ObservationKind::MagneticField;
        let corrects = if self.turns_by_field {
            Corrects::All
        } else {
            Corrects::Heading
        };
        if self.fuse(kind, taken, &measurement, p::FIELD_GATE, corrects) {
            return;
        }
        let turned = self.turned_about_vertical(measured);
        if !self.is_compared
            && self.tracks.field.refused_s(taken) >= p::TREND_REFUSED_S
            && self.wind_shows_turned(turned)
        {
            self.doubt_heading(turned);
            return;
        }
        if self.stands() {
            // Standing still, gyroscopes keep the heading: nothing has to be done.
            self.tracks.field.refused_since = taken;
        }
        if self.tracks.field.refused_s(taken) >= p::FIELD_REFUSED_S {
            self.doubt_field();
            self.tracks.field.refused_since = taken;
        }
    }

    /// By how much a field is turned about the vertical from where it is expected, rad; nothing
    /// if it is not as strong as the earth's.
    fn turned_about_vertical(&self, measured: Vector3<f64>) -> f64 {
        let (is, expected) = (
            self.rotation() * (measured - self.body_field),
            self.earth_field,
        );
        if (is.norm() - expected.norm()).abs() > SAME_STRENGTH * expected.norm() {
            return 0.0;
        }
        let across = expected.x * is.y - expected.y * is.x;
        atan2(across, expected.xy().dot(&is.xy()))
    }

    /// Whether the wind has changed as it seems to if the nose points elsewhere than is
    /// believed, by an angle: an aircraft flies ahead, wherever it believes that to be.
    fn wind_shows_turned(&self, angle_rad: f64) -> bool {
        let nose = self.rotation().column(0).xy();
        let through_air = (self.motion.velocity.xy() - self.mean_wind).norm();
        let points = turn(Vector3::new(0.0, 0.0, -angle_rad)) * nose.push(0.0);
        let expected = (points.xy() - nose) * through_air;
        let changed = self.wind - self.mean_wind;
        // A wrong horizon turns the field as well: the wind may show less of it.
        let along = changed.dot(&expected.try_normalize(1e-6).unwrap_or_default());
        let across = libm::sqrt((changed.norm_squared() - along * along).max(0.0));
        self.flies()
            && along > p::WIND_CHANGED.max(LEAST_SHOWN * expected.norm())
            && across < MOST_ACROSS * along
    }

    /// The heading is off by an angle, which field and wind show: gyroscopes have turned it.
    fn doubt_heading(&mut self, angle_rad: f64) {
        let variance = angle_rad * angle_rad;
        self.add_variance(ATTITUDE + 2, 1, variance);
        self.add_variance(RATE_BIAS, 3, p::TREND_RATE * variance);
        self.wind = self.mean_wind;
        self.forget_wind();
    }

    /// The field has changed, or the heading is wrong: either may be corrected
    /// from here on. Where a receiver gives the heading, the field may point
    /// anywhere; otherwise its direction is what north is.
    fn doubt_field(&mut self) {
        self.add_variance(BODY_FIELD, 3, OTHER_FIELD);
        self.add_variance(EARTH_FIELD + 2, 1, OTHER_FIELD);
        if self.has_receiver() && self.sigma(ATTITUDE + 2) < CERTAIN_HEADING {
            self.add_variance(EARTH_FIELD, 2, OTHER_FIELD);
            return;
        }
        let north = self
            .earth_field
            .xy()
            .try_normalize(1e-6)
            .unwrap_or_default();
        let along_north = north * north.transpose() * OTHER_FIELD;
        let mut horizontal = self
            .covariance
            .fixed_view_mut::<2, 2>(EARTH_FIELD, EARTH_FIELD);
        horizontal += along_north;
        self.add_variance(ATTITUDE + 2, 1, DOUBTED_HEADING);
    }

    /// The first field. Without a model its direction is called north.
    fn begin_with_field(&mut self, measured: Vector3<f64>, model: Option<Vector3<f64>>) {
        let in_earth = self.motion.attitude * measured;
        let horizontal = hypot(in_earth.x, in_earth.y);
        let declination = model.map_or(0.0, |field| atan2(field.y, field.x));
        if self.sigma(ATTITUDE + 2) > UNKNOWN_HEADING {
            self.turn_heading(declination - atan2(in_earth.y, in_earth.x));
        }
        self.reset_covariance(BODY_FIELD, 3, p::BODY_FIELD * p::BODY_FIELD);
        if let Some(model) = model {
            self.earth_field = model;
            self.reset_covariance(EARTH_FIELD, 3, p::MODEL_FIELD * p::MODEL_FIELD);
        } else {
            self.earth_field = Vector3::new(horizontal, 0.0, in_earth.z);
            self.reset_covariance(EARTH_FIELD, 3, measured.norm_squared());
            let east = p::DECLINATION * horizontal;
            self.reset_covariance(EARTH_FIELD + 1, 1, east * east);
        }
        // What the heading and the field were taken from, they are correlated by.
        let mut measurement = self.field_measurement(measured, f64::INFINITY);
        measurement.difference.fill(0.0);
        self.correct(&measurement, Corrects::Heading);
    }

    /// The field of a model, of a filter that began without it. A heading that a
    /// receiver gave is true already.
    pub(super) fn learn_earth_field(&mut self, model: [f64; 3]) {
        if self.tracks.field.used.is_never() {
            return;
        }
        self.settle();
        let model = Vector3::from(model);
        let (was, is) = (self.earth_field, model);
        if !self.has_receiver() {
            let angle_rad = atan2(is.y, is.x) - atan2(was.y, was.x);
            self.turn_heading(angle_rad);
            let turned = turn(Vector3::new(0.0, 0.0, angle_rad));
            self.motion.velocity = turned * self.motion.velocity;
            self.wind = (turned * self.wind.push(0.0)).xy();
        }
        self.earth_field = model;
        self.reset_covariance(EARTH_FIELD, 3, p::MODEL_FIELD * p::MODEL_FIELD);
    }

    fn field_measurement(&self, measured: Vector3<f64>, since_s: f64) -> Measurement<3> {
        let to_body = self.rotation().transpose();
        let expected = to_body * self.earth_field + self.body_field;
        let by_attitude = to_body * self.earth_field.cross_matrix();
        let mut jacobian = SMatrix::<f64, 3, STATES>::zeros();
        jacobian
            .fixed_columns_mut::<3>(ATTITUDE)
            .copy_from(&by_attitude);
        jacobian
            .fixed_columns_mut::<3>(EARTH_FIELD)
            .copy_from(&to_body);
        jacobian
            .fixed_columns_mut::<3>(BODY_FIELD)
            .fill_with_identity();
        let mut noise = p::FIELD.plus(p::FIELD_SHARE * self.earth_field.norm());
        // Iron nearby disturbs the field in the same way as long as nothing moves.
        if self.turns_by_field {
            noise.tau_s = p::FIELD_ALONE_S;
        } else if self.flies() {
            noise.tau_s = p::FIELD_ALOFT_S;
        } else if self.stands() {
            noise.tau_s = p::FIELD_AT_REST_S;
        }
        Measurement {
            difference: measured - expected,
            jacobian,
            variance: variances([noise; 3]),
            excess: Vector3::repeat(noise.excess(since_s)),
        }
    }
}
