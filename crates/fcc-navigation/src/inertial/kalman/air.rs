//! Static pressure and airspeed.

use libm::sqrt;
use nalgebra::{SMatrix, SVector, Vector2, Vector3};

use super::filter::Filter;
use super::noise::Noise;
use super::parameters as p;
use super::states::{ATTITUDE, BAROMETER_BIAS, POSITION, STATES, VELOCITY, WIND};
use super::update::{Corrects, Measurement};
use crate::inertial::ObservationKind;
use fcc_core::flight::atmosphere::{SEA_LEVEL_DENSITY_KGPM3, density_ratio, pressure_altitude_m};
use fcc_core::framework::Time;

/// With a slower motion through the air than this its direction says nothing,
/// m/s.
const SLOW: f64 = 4.0;

impl Filter {
    /// A static pressure, taken `after_s` after the time of the state.
    pub(super) fn static_pressure(&mut self, taken: Time, pressure_pa: f64, after_s: f64) {
        let measured = pressure_altitude_m(pressure_pa);
        if !measured.is_finite() {
            return;
        }
        self.settle();
        let expected = self.motion.place.altitude_m - self.motion.velocity.z * after_s;
        if self.tracks.barometer.used.is_never() {
            if self.motion.is_located {
                self.barometer_bias = measured - expected;
                self.take_barometer_bias_from_altitude();
            } else {
                self.motion.place.altitude_m += measured - expected;
                self.reset_covariance(POSITION + 2, 1, p::BAROMETER.variance());
            }
            self.tracks.barometer.judged(taken, true);
            return;
        }
        let difference = measured - expected - self.barometer_bias;
        let mut jacobian = SMatrix::<f64, 1, STATES>::zeros();
        jacobian[POSITION + 2] = -1.0;
        jacobian[BAROMETER_BIAS] = 1.0;
        let since_s = self.tracks.barometer.since_tried_s(taken);
        let measurement = scalar(difference, jacobian, p::BAROMETER, since_s);
        let kind = ObservationKind::StaticPressure;
        if self.fuse(kind, taken, &measurement, p::GATE, Corrects::All) {
            return;
        }
        if self.tracks.barometer.refused_s(taken) >= p::BAROMETER_REFUSED_S {
            if self.has_receiver() {
                self.barometer_bias += difference;
                self.take_barometer_bias_from_altitude();
            } else {
                self.motion.place.altitude_m += difference;
                self.reset_covariance(POSITION + 2, 1, p::BAROMETER.variance());
            }
            self.tracks.barometer.judged(taken, true);
        }
    }

    /// A differential pressure, as the equivalent airspeed that it is of
    /// (incompressible; below 100 m/s to 1 %).
    pub(super) fn differential_pressure(&mut self, taken: Time, pressure_pa: f64, after_s: f64) {
        let equivalent_mps = sqrt(2.0 * pressure_pa.max(0.0) / SEA_LEVEL_DENSITY_KGPM3);
        let kind = ObservationKind::DifferentialPressure;
        self.airspeed(kind, taken, equivalent_mps, after_s);
    }

    /// An equivalent airspeed, taken `after_s` after the time of the state.
    pub(super) fn airspeed(
        &mut self,
        kind: ObservationKind,
        taken: Time,
        equivalent_mps: f64,
        after_s: f64,
    ) {
        self.tracks.airspeed_heard = taken;
        if equivalent_mps < p::LEAST_AIRSPEED {
            return;
        }
        self.settle();
        let density = density_ratio(self.motion.place.altitude_m + self.barometer_bias);
        let measured = equivalent_mps / sqrt(density);
        let offset = p::DIFFERENTIAL_PRESSURE_PA
            / (SEA_LEVEL_DENSITY_KGPM3 * sqrt(density) * equivalent_mps);
        let noise = p::AIRSPEED.plus(p::AIRSPEED_SHARE * measured).plus(offset);
        if self.tracks.airspeed.used.is_never() {
            self.begin_with_air(measured);
        }
        let air = self.through_the_air();
        if air.norm() < SLOW {
            if self.has_receiver() {
                return;
            }
            self.take_velocity_from_airspeed(measured);
            self.tracks.airspeed.judged(taken, true);
            return;
        }
        let along = air.normalize();
        let difference = measured - air.norm() - along.dot(&self.acceleration) * after_s;
        let mut jacobian = SMatrix::<f64, 1, STATES>::zeros();
        for axis in 0..3 {
            jacobian[VELOCITY + axis] = along[axis];
        }
        jacobian[WIND] = -along.x;
        jacobian[WIND + 1] = -along.y;
        let since_s = self.tracks.airspeed.since_tried_s(taken);
        let measurement = scalar(difference, jacobian, noise, since_s);
        if self.fuse(kind, taken, &measurement, p::GATE, Corrects::All) {
            self.air_from_ahead(measured, since_s);
        } else if self.tracks.airspeed.refused_s(taken) >= p::AIRSPEED_REFUSED_S {
            if self.has_receiver() {
                self.add_variance(WIND, 2, p::WIND * p::WIND);
            } else {
                self.take_velocity_from_airspeed(measured);
            }
            self.tracks.airspeed.refused_since = taken;
        }
    }

    fn through_the_air(&self) -> Vector3<f64> {
        self.motion.velocity - self.wind.push(0.0)
    }

    /// The first airspeed.
    fn begin_with_air(&mut self, measured: f64) {
        self.forget_wind();
        if !self.has_receiver() {
            self.take_velocity_from_airspeed(measured);
        }
    }

    /// Nothing is known of the wind.
    pub(super) fn forget_wind(&mut self) {
        self.wind = Vector2::zeros();
        self.reset_covariance(WIND, 2, p::WIND * p::WIND);
    }

    /// Turns the attitude about down.
    pub(super) fn turn_heading(&mut self, angle_rad: f64) {
        let turn = super::motion::turn(Vector3::new(0.0, 0.0, angle_rad));
        self.motion.attitude = turn * self.motion.attitude;
    }

    /// Without a receiver: the velocity is that of the wind and of the airspeed
    /// along the nose, and as uncertain as both.
    fn take_velocity_from_airspeed(&mut self, measured: f64) {
        let along = self.rotation().column(0) * measured;
        self.motion.velocity = self.wind.push(0.0) + along;
        let by_attitude = -along.cross_matrix();
        let mut rows = by_attitude * self.covariance.fixed_rows::<3>(ATTITUDE);
        let mut horizontal = rows.fixed_rows_mut::<2>(0);
        horizontal += self.covariance.fixed_rows::<2>(WIND);
        let mut variance = rows.fixed_columns::<3>(ATTITUDE) * by_attitude.transpose();
        let mut horizontal = variance.fixed_columns_mut::<2>(0);
        horizontal += rows.fixed_columns::<2>(WIND);
        rows.fixed_columns_mut::<3>(VELOCITY).copy_from(&variance);
        self.covariance
            .fixed_rows_mut::<3>(VELOCITY)
            .copy_from(&rows);
        self.covariance
            .fixed_columns_mut::<3>(VELOCITY)
            .copy_from(&rows.transpose());
        let across = p::ATTACK_SHARE * measured;
        self.add_variance(VELOCITY, 3, across * across + p::ATTACK.variance());
    }

    /// The air comes from ahead: its velocity across the nose and from below is
    /// small. In a turn this is the centripetal acceleration, which the
    /// accelerometers have to be freed of: rates times airspeed.
    fn air_from_ahead(&mut self, measured: f64, since_s: f64) {
        let air = self.through_the_air();
        let to_body = self.rotation().transpose();
        let in_body = to_body * air;
        let by_attitude = to_body * air.cross_matrix();
        let mut jacobian = SMatrix::<f64, 2, STATES>::zeros();
        for row in 0..2 {
            for axis in 0..3 {
                jacobian[(row, ATTITUDE + axis)] = by_attitude[(row + 1, axis)];
                jacobian[(row, VELOCITY + axis)] = to_body[(row + 1, axis)];
            }
            for axis in 0..2 {
                jacobian[(row, WIND + axis)] = -to_body[(row + 1, axis)];
            }
        }
        let sideslip = p::SIDESLIP.plus(p::SIDESLIP_SHARE * measured);
        let attack = p::ATTACK.plus(p::ATTACK_SHARE * measured);
        let measurement = Measurement {
            difference: -SVector::<f64, 2>::new(in_body.y, in_body.z),
            jacobian,
            variance: SVector::<f64, 2>::new(sideslip.variance(), attack.variance()),
            excess: SVector::<f64, 2>::new(sideslip.excess(since_s), attack.excess(since_s)),
        };
        if self.distance(&measurement) <= p::GATE {
            self.correct(&measurement, Corrects::All);
        }
    }
}

fn scalar(
    difference: f64,
    jacobian: SMatrix<f64, 1, STATES>,
    noise: Noise,
    since_s: f64,
) -> Measurement<1> {
    Measurement {
        difference: SVector::<f64, 1>::new(difference),
        jacobian,
        variance: SVector::<f64, 1>::new(noise.variance()),
        excess: SVector::<f64, 1>::new(noise.excess(since_s)),
    }
}
