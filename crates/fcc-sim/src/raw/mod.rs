//! Raw sensors: what an accelerometer, a gyroscope, a magnetometer, a barometer,
//! a pitot tube and satellite navigation give of a true motion, with bias,
//! drift, scale, misalignment, the engine's vibration, noise, resolution,
//! clipping, delay and jitter.
//!
//! Every sensor takes its samples at its own rate. A reading is the mean of
//! those that arrived since the last reading, as a driver makes it of a queue,
//! and its time is the mean of their arrivals: the delay is unknown to it.

mod channel;
mod sets;

use core::f64::consts::TAU;
use core::time::Duration;

use channel::{Arrived, Channel, Engine};
pub use channel::{AxisErrors, RawSensor, TrueErrors};
use fcc_core::flight::atmosphere::{
    SEA_LEVEL_PRESSURE_PA, SEA_LEVEL_TEMPERATURE_K, pressure_altitude_m, pressure_pa,
};
use fcc_core::flight::orientation::{EulerAngles, earth_to_body, quaternion_from_euler};
use fcc_core::flight::{
    Attitude, BodyRates, GnssFix, MagneticField, Measurements, Position, SpecificForce, Velocity,
};
use fcc_core::framework::{Reading, Time};
use fcc_core::schema;
use libm::{cos, round, sqrt};
pub use sets::RawSensorSet;

use crate::gauss::Stream;
use crate::local_earth::LocalEarth;

schema! {
    /// The truth that raw sensors measure, at one moment. By default it stands on
    /// the ground in the standard atmosphere at sea level (ISO 2533).
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct RawTruth {
        /// Simulated time, s, of up to four months.
        #[field(1, range = 0.0..=1e7)]
        pub time_s: f64,
        /// Pitch and roll.
        #[field(2)]
        pub attitude: Attitude,
        /// True heading, rad.
        #[field(3, range = -TAU..=TAU)]
        pub heading_rad: f64,
        /// Turn rates.
        #[field(4)]
        pub rates: BodyRates,
        /// Specific force where the sensors are.
        #[field(5, column = "specific_force_*")]
        pub specific_force: SpecificForce,
        /// Static pressure, Pa: from below the Dead Sea to 20 km.
        #[field(6, range = 5_000.0..=110_000.0)]
        pub static_pressure_pa: f64,
        /// Total minus static pressure, Pa; at the speed of sound 90 kPa.
        #[field(7, range = -10_000.0..=100_000.0)]
        pub differential_pressure_pa: f64,
        /// Temperature of the undisturbed air, K.
        #[field(8, range = 150.0..=350.0)]
        pub air_temperature_k: f64,
        /// Where it is.
        #[field(9)]
        pub position: Position,
        /// Over the ground.
        #[field(10)]
        pub velocity: Velocity,
        /// Above the ground, m.
        #[field(11, range = -1_000.0..=20_000.0)]
        pub height_m: f64,
        /// Throttle after the engine's lag.
        #[field(12, range = 0.0..=1.0)]
        pub throttle: f64,
    }
}

impl Default for RawTruth {
    fn default() -> Self {
        Self {
            time_s: 0.0,
            attitude: Attitude::default(),
            heading_rad: 0.0,
            rates: BodyRates::default(),
            specific_force: SpecificForce::default(),
            static_pressure_pa: SEA_LEVEL_PRESSURE_PA,
            differential_pressure_pa: 0.0,
            air_temperature_k: SEA_LEVEL_TEMPERATURE_K,
            position: Position::default(),
            velocity: Velocity::default(),
            height_m: 0.0,
            throttle: 0.0,
        }
    }
}

/// The raw sensors of one aircraft at work.
#[derive(Clone, Debug)]
pub struct RawSensors {
    now_s: f64,
    engine: Engine,
    earth: LocalEarth,
    /// North, east and down, µT.
    field_ut: [f64; 3],
    accuracies: [f64; 2],
    barometer_resolution_pa: f64,
    /// Beyond it the rangefinder gives nothing.
    longest_range_m: f64,
    accelerometer: Channel<3>,
    gyroscope: Channel<3>,
    magnetometer: Channel<3>,
    barometer: Channel<1>,
    pitot: Channel<1>,
    thermometer: Option<Channel<1>>,
    gnss: Channel<6>,
    rangefinder: Option<Channel<1>>,
}

impl RawSensors {
    /// The sensors of one aircraft, whose constant errors are drawn by the seed,
    /// from this truth on, in a magnetic field of the earth in µT, north, east
    /// and down.
    pub fn new(set: &RawSensorSet, seed: u64, start: &RawTruth, field_ut: [f64; 3]) -> Self {
        fn channel<const N: usize>(
            sensor: &RawSensor<N>,
            seed: u64,
            stream: Stream,
            start_s: f64,
        ) -> Channel<N> {
            Channel::new(sensor, seed, stream, start_s)
        }
        let start_s = start.time_s;
        let [north, .., velocity] = &set.gnss.errors;
        let position_m = sqrt(north.white * north.white + north.drift * north.drift);
        let mut sensors = Self {
            now_s: start_s,
            engine: Engine::default(),
            earth: LocalEarth::new(start.position.latitude_rad, start.position.longitude_rad),
            field_ut,
            accuracies: [position_m, velocity.white],
            barometer_resolution_pa: set.barometer_resolution_pa,
            longest_range_m: set
                .rangefinder
                .map_or(0.0, |RawSensor { errors: [of], .. }| of.limit),
            accelerometer: channel(&set.accelerometer, seed, Stream::Accelerometer, start_s),
            gyroscope: channel(&set.gyroscope, seed, Stream::Gyroscope, start_s),
            magnetometer: channel(&set.magnetometer, seed, Stream::Magnetometer, start_s),
            barometer: channel(&set.barometer, seed, Stream::Barometer, start_s),
            pitot: channel(&set.pitot, seed, Stream::Pitot, start_s),
            thermometer: set
                .thermometer
                .map(|sensor| channel(&sensor, seed, Stream::Thermometer, start_s)),
            gnss: channel(&set.gnss, seed, Stream::Gnss, start_s),
            rangefinder: set
                .rangefinder
                .map(|sensor| channel(&sensor, seed, Stream::Rangefinder, start_s)),
        };
        sensors.each(start, &Begin);
        sensors
    }

    /// The constant errors that were drawn: of the accelerometer, the gyroscope
    /// and the magnetometer.
    pub fn true_errors(&self) -> [TrueErrors<3>; 3] {
        [&self.accelerometer, &self.gyroscope, &self.magnetometer].map(Channel::true_errors)
    }

    /// The same of the pitot tube.
    pub fn pitot_errors(&self) -> TrueErrors<1> {
        self.pitot.true_errors()
    }

    /// Another magnetic field, north, east and down, µT, from here on.
    pub(crate) const fn set_field_ut(&mut self, field_ut: [f64; 3]) {
        self.field_ut = field_ut;
    }

    /// Takes the samples from the last truth to this one.
    pub fn step(&mut self, truth: &RawTruth) {
        /// Revolutions per s of a propeller of fixed pitch, in flight: 700 per
        /// minute idling, 2,700 at full throttle.
        const IDLE_HZ: f64 = 700.0 / 60.0;
        const FULL_HZ: f64 = 2_700.0 / 60.0;
        let turning_hz = IDLE_HZ + truth.throttle * (FULL_HZ - IDLE_HZ);
        let before = self.engine.now;
        self.engine = Engine {
            before,
            now: before + turning_hz * (truth.time_s - self.now_s),
            throttle: truth.throttle,
        };
        self.now_s = truth.time_s;
        self.each(truth, &Step(self.engine));
    }

    /// Writes what arrived since the last time; `now` is that of the last step
    /// on the loop's clock. Readings without a new sample are unchanged.
    pub fn read(&mut self, now: Time, into: &mut Measurements) {
        let now_s = self.now_s;
        let when = |at_s: f64| now - Duration::try_from_secs_f64(now_s - at_s).unwrap_or_default();
        if let Some(Arrived { values, at_s }) = self.accelerometer.take() {
            let [x_mps2, y_mps2, z_mps2] = values;
            let force = SpecificForce {
                x_mps2,
                y_mps2,
                z_mps2,
            };
            into.raw_specific_force = Reading::new(force, when(at_s));
        }
        if let Some(Arrived { values, at_s }) = self.gyroscope.take() {
            let [roll_radps, pitch_radps, yaw_radps] = values;
            let rates = BodyRates {
                roll_radps,
                pitch_radps,
                yaw_radps,
            };
            into.raw_body_rates = Reading::new(rates, when(at_s));
        }
        if let Some(Arrived { values, at_s }) = self.magnetometer.take() {
            let [x_ut, y_ut, z_ut] = values;
            into.magnetic_field = Reading::new(MagneticField { x_ut, y_ut, z_ut }, when(at_s));
        }
        if let Some(Arrived { values, at_s }) = self.barometer.take() {
            let [altitude_m] = values;
            let step_pa = self.barometer_resolution_pa;
            let shown_pa = step_pa * round(pressure_pa(altitude_m) / step_pa);
            into.static_pressure_pa = Reading::new(shown_pa, when(at_s));
        }
        let scalar = |channel: Option<&mut Channel<1>>| {
            let Arrived { values, at_s } = channel?.take()?;
            let [value] = values;
            Some(Reading::new(value, when(at_s)))
        };
        if let Some(reading) = scalar(Some(&mut self.pitot)) {
            into.differential_pressure_pa = reading;
        }
        if let Some(reading) = scalar(self.thermometer.as_mut()) {
            into.air_temperature_k = reading;
        }
        if let Some(reading) = scalar(self.rangefinder.as_mut())
            && reading.value < self.longest_range_m
        {
            into.range_m = reading;
        }
        if let Some(Arrived { values, at_s }) = self.gnss.take() {
            let [north_m, east_m, up_m, north_mps, east_mps, down_mps] = values;
            let [position_m, speed_accuracy_mps] = self.accuracies;
            let fix = GnssFix {
                position: self.earth.position(north_m, east_m, up_m),
                velocity: Velocity {
                    north_mps,
                    east_mps,
                    down_mps,
                },
                horizontal_accuracy_m: position_m,
                vertical_accuracy_m: position_m,
                speed_accuracy_mps,
            };
            into.gnss = Reading::new(fix, when(at_s));
        }
    }

    /// Does the same with each sensor and the truth that it measures.
    fn each(&mut self, truth: &RawTruth, act: &impl Act) {
        let (attitude, now_s) = (truth.attitude, truth.time_s);
        let orientation = quaternion_from_euler(EulerAngles {
            roll_rad: attitude.roll_rad,
            pitch_rad: attitude.pitch_rad,
            heading_rad: truth.heading_rad,
        });
        let (f, r, v) = (truth.specific_force, truth.rates, truth.velocity);
        act.on(
            &mut self.accelerometer,
            now_s,
            [f.x_mps2, f.y_mps2, f.z_mps2],
        );
        act.on(
            &mut self.gyroscope,
            now_s,
            [r.roll_radps, r.pitch_radps, r.yaw_radps],
        );
        let field = earth_to_body(orientation, self.field_ut);
        act.on(&mut self.magnetometer, now_s, field);
        let altitude_m = pressure_altitude_m(truth.static_pressure_pa);
        act.on(&mut self.barometer, now_s, [altitude_m]);
        act.on(&mut self.pitot, now_s, [truth.differential_pressure_pa]);
        if let Some(thermometer) = &mut self.thermometer {
            act.on(thermometer, now_s, [truth.air_temperature_k]);
        }
        let (north_m, east_m) = self.earth.north_east_m(&truth.position);
        let position = [north_m, east_m, truth.position.altitude_m];
        let [a, b, c] = position;
        act.on(
            &mut self.gnss,
            now_s,
            [a, b, c, v.north_mps, v.east_mps, v.down_mps],
        );
        if let Some(rangefinder) = &mut self.rangefinder {
            // Beyond the horizontal it sees no ground.
            let down = (cos(attitude.pitch_rad) * cos(attitude.roll_rad)).max(1e-3);
            act.on(rangefinder, now_s, [truth.height_m.max(0.0) / down]);
        }
    }
}

/// What is done with a sensor.
trait Act {
    fn on<const N: usize>(&self, channel: &mut Channel<N>, now_s: f64, truth: [f64; N]);
}

struct Begin;

impl Act for Begin {
    fn on<const N: usize>(&self, channel: &mut Channel<N>, _: f64, truth: [f64; N]) {
        channel.begin(truth);
    }
}

struct Step(Engine);

impl Act for Step {
    fn on<const N: usize>(&self, channel: &mut Channel<N>, now_s: f64, truth: [f64; N]) {
        channel.step(now_s, truth, &self.0);
    }
}
