//! The filter's parameters: one set for every aircraft, and for a hand.
//!
//! Each follows from the physics of a sensor of the consumer class (the
//! datasheets of ICM-42688-P, BMI270, MPU-6050, BMP388, NEO-M8/M9 and phones'
//! magnetometers give the orders of magnitude) or of motion. Most errors are not
//! white: they are a standard deviation and a correlation time
//! ([`Noise`](super::noise::Noise)).

use super::noise::Noise;

/// White noise of gyroscopes, rad/√s: 0.03 °/√s. Datasheets say 0.003 to
/// 0.005 °/s/√Hz at rest; vibration and the time stamps of real recordings add
/// more than that.
pub(super) const RATE_NOISE: f64 = 5e-4;
/// Error of a gyroscope's scale and of its axes, a share of the rate (datasheets
/// say 0.4 to 3 % of scale and 1 to 2 % across axes, uncalibrated), and how far
/// something turns before it turns about another axis, rad.
pub(super) const RATE_SCALE: f64 = 0.01;
pub(super) const ONE_WAY_RAD: f64 = 1.0;
/// Rates without gyroscopes, rad/s, and their correlation time, s.
pub(super) const UNKNOWN_RATE: f64 = 0.5;
pub(super) const UNKNOWN_RATE_S: f64 = 0.3;
/// What turned before may turn on for this time, s.
pub(super) const TURNING_S: f64 = 3.0;
/// Rates by the magnetic field and a coordinated turn, rad/s, and the correlation time
/// of their errors, s: sideslip and rolling, about the direction of the field.
pub(super) const FIELD_RATE: f64 = 0.1;
pub(super) const FIELD_RATE_S: f64 = 0.5;
/// White noise of accelerometers, m/s/√s: 100 to 200 µg/√Hz at rest, vibration
/// adds the rest.
pub(super) const FORCE_NOISE: f64 = 0.02;
/// Error of an accelerometer's scale and axes, of what differs from gravity, and
/// how long that lasts, s.
pub(super) const FORCE_SCALE: f64 = 0.01;
pub(super) const FORCE_SCALE_S: f64 = 0.2;
/// Acceleration without accelerometers, m/s², and its correlation time, s.
pub(super) const UNKNOWN_FORCE: f64 = 2.0;
pub(super) const UNKNOWN_FORCE_S: f64 = 2.0;

/// Bias of gyroscopes when they are switched on, rad/s (1.1 °/s), and its random
/// walk, rad/s/√s: some 0.1 °/s in ten minutes of warming up.
pub(super) const RATE_BIAS: f64 = 0.02;
pub(super) const RATE_BIAS_WALK: f64 = 5e-5;
/// What adds to the square of that walk while something accelerates of which nothing else
/// measures the velocity, rad/s/√s a m/s²: accelerations bias a gyroscope, by 0.1 °/s a g
/// (linear acceleration sensitivity in the product specification of the MPU-6050, revision
/// 3.4, section 6.1). That lasts for 20 s: 1.8·10⁻⁴ · √(2 / 20 s). With a receiver or an
/// airspeed an accelerometer at the end of its range would be taken for such a bias.
pub(super) const RATE_BIAS_WALK_BY_ACCELERATION: f64 = 5.6e-5;
/// Bias of accelerometers, m/s² (5 mg, calibrated), and its random walk, m/s²/√s.
pub(super) const FORCE_BIAS: f64 = 0.05;
pub(super) const FORCE_BIAS_WALK: f64 = 5e-4;
/// What adds to that walk downwards while something begins to fly, m/s²/√s: an engine that
/// shakes an accelerometer moves its mean (vibration rectification, in the data sheets of the
/// ADXL355 and others), so what was learned with an idle engine does not hold in a take-off.
/// While it accelerates forward, what the bias is off by would be taken for pitch. With this
/// a bias of 1 m/s² leaves less than 1° of pitch; with more, or in all of a flight, one
/// forward would tip it further.
pub(super) const SHAKEN_BIAS_WALK: f64 = 0.03;
/// For so long after it was slow, s: the take-off run of a light aircraft, some 20 s, and its
/// acceleration to the speed of climb.
pub(super) const BEGINS_S: f64 = 60.0;
/// Corrections of a bias are summed over this time, s, and beyond three standard deviations
/// (this is the square) their sum is a drift. Chosen on flights of JSBSim: without a fault,
/// in turbulence 5, the square is at most 2 (two of them).
pub(super) const DRIFT_S: f64 = 15.0;
pub(super) const SUM_GATE: f64 = 9.0;
/// By how much the variance grows in that time, as a multiple of the square of the sum.
pub(super) const DRIFT_GAIN: f64 = 3.0;
/// How uncertain a bias becomes by that at most, rad/s, m/s².
pub(super) const LARGEST_RATE_BIAS: f64 = 0.1;
pub(super) const LARGEST_FORCE_BIAS: f64 = 5.0;
/// Innovations of the velocity are summed over this time, s, and beyond as many standard
/// deviations their sum goes in one direction.
pub(super) const TREND_S: f64 = 1.0;
/// If those that are refused go on in it, the filter doubts itself after this time, s, and
/// while the heading is more certain than this, rad (10°): with a wrong one an acceleration
/// forward is one sideways.
pub(super) const TREND_REFUSED_S: f64 = 0.4;
pub(super) const TREND_HEADING: f64 = 0.17;
/// The variance of the gyroscopes' bias then, as a multiple of the tilt's, 1/s²: what has
/// tipped the horizon did it within some 2 s.
pub(super) const TREND_RATE: f64 = 0.3;
/// The random walk of pressure altitude against altitude, m/√s: weather and the
/// static port, 2 m in ten minutes.
pub(super) const BAROMETER_WALK: f64 = 0.08;
/// Pressure altitude, m.
pub(super) const BAROMETER: Noise = Noise::new(1.0, 0.5);

/// The field as a calibrated magnetometer shows it, µT, plus a share of its
/// strength: soft iron, and the field of a room.
pub(super) const FIELD: Noise = Noise::new(1.0, 10.0);
pub(super) const FIELD_SHARE: f64 = 0.05;
/// The same error lasts for this long at rest, s.
pub(super) const FIELD_AT_REST_S: f64 = 60.0;
/// ... and for this long in the air, s: no iron comes and goes there, and the
/// aircraft's own is a state.
pub(super) const FIELD_ALOFT_S: f64 = 2.0;
/// ... and for this long where the attitude follows it, s: without gyroscopes.
pub(super) const FIELD_ALONE_S: f64 = 0.1;
/// The aircraft's own field that calibration has left, µT, and its random walk,
/// µT/√s: currents.
pub(super) const BODY_FIELD: f64 = 2.0;
pub(super) const BODY_FIELD_WALK: f64 = 0.02;
/// The random walk of the earth's field, µT/√s, by moving over the earth.
pub(super) const EARTH_FIELD_WALK: f64 = 0.01;
/// The error of the World Magnetic Model: of each part, µT (its report: 0.15,
/// and magnetic rocks), and of the declination or of what is called north, rad.
pub(super) const MODEL_FIELD: f64 = 0.5;
pub(super) const DECLINATION: f64 = 0.009;
/// Anywhere on earth a field is at most this strong, µT.
pub(super) const STRONGEST_FIELD: f64 = 70.0;

/// A receiver's position, m, horizontal and vertical; its errors last.
pub(super) const POSITION_HORIZONTAL: Noise = Noise::new(1.5, 1.0);
pub(super) const POSITION_VERTICAL: Noise = Noise::new(3.0, 1.0);
/// A receiver's velocity, m/s.
pub(super) const VELOCITY_HORIZONTAL: Noise = Noise::new(0.3, 0.2);
pub(super) const VELOCITY_VERTICAL: Noise = Noise::new(0.5, 0.2);
/// That it scatters by more is learned while the horizon is more certain than this, rad (3°),
/// and nothing is rough.
pub(super) const SCATTER_TILT: f64 = 0.05;

/// By how much fixes are later than they say, s, its random walk, s/√s, and the most: a
/// receiver computes for 0.1 to 0.3 s, and a serial line takes its time.
pub(super) const LATENESS: f64 = 0.3;
pub(super) const LATENESS_WALK: f64 = 0.02;
pub(super) const LARGEST_LATENESS: f64 = 2.0;
/// It is not learned after a specific force above this, m/s², the mean of this time, s, for a
/// time, s: an accelerometer of 2 g may be at the end of its range.
pub(super) const LOAD_S: f64 = 0.1;
pub(super) const ROUGH: f64 = 16.0;
pub(super) const CALM_S: f64 = 2.0;
/// ... nor before something has been under way for this time, s: what stood seems to stand for
/// a moment longer.
pub(super) const UNDER_WAY_S: f64 = 5.0;

/// Airspeed, m/s: the tube's place, and gusts that are shorter than the wind's
/// walk; a share of the airspeed (calibration), and the sensor's own noise and
/// offset, Pa, which at a low airspeed are most of it.
pub(super) const AIRSPEED: Noise = Noise::new(0.7, 1.0);
pub(super) const AIRSPEED_SHARE: f64 = 0.03;
pub(super) const DIFFERENTIAL_PRESSURE_PA: f64 = 10.0;
/// The air comes from ahead: across the nose, and from below it, each a part
/// that does not depend on the airspeed, m/s, and a share of it (rad). The angle
/// of attack lasts longer than a sideslip.
pub(super) const SIDESLIP: Noise = Noise::new(0.7, 1.0);
pub(super) const SIDESLIP_SHARE: f64 = 0.06;
pub(super) const ATTACK: Noise = Noise::new(1.0, 5.0);
pub(super) const ATTACK_SHARE: f64 = 0.12;
/// Below this airspeed, m/s, nothing flies, and the sensor shows its offset.
pub(super) const LEAST_AIRSPEED: f64 = 7.0;
/// Wind of which nothing is known, each axis, m/s, and how uncertain it becomes at most.
pub(super) const WIND: f64 = 7.0;
pub(super) const LARGEST_WIND: f64 = 10.0;
/// Severe turbulence, m/s, and its scale length, m (MIL-F-8785C: 1,750 ft above 2,000 ft):
/// for some seconds it is a random walk of σ √(2 V/L) at the airspeed V, 1.8 m/s/√s at
/// 55 m/s. If the wind were steadier, gusts from the side would be taken for turns of the
/// nose.
pub(super) const TURBULENCE: f64 = 4.0;
pub(super) const TURBULENCE_LENGTH_M: f64 = 533.0;

/// A heading that is off changes the wind within this time, s, by this speed, m/s.
pub(super) const MEAN_WIND_S: f64 = 10.0;
pub(super) const WIND_CHANGED: f64 = 5.0;

/// A velocity over the ground that is off by more than this, m/s (40 kt), and by as many
/// standard deviations of the wind, is the receiver's error where airspeed and compass agreed
/// within this time, s, if it changed by more than that at once, and faster than this, m/s². It
/// is for as long as that lasts, with its position, which is not used for this time after it, s.
pub(super) const OTHER_WIND: f64 = 20.0;
pub(super) const OTHER_WINDS: f64 = 5.0;
pub(super) const AGREE_S: f64 = 1.0;
pub(super) const JUMP: f64 = 40.0;
pub(super) const CONTRADICTED_S: f64 = 1.5;

/// The velocity of something of which only the inertial sensors are known: a
/// hand's, m/s; the acceleration with which velocities end, m/s²: a hand turns
/// back within a second, an aircraft after half a minute.
pub(super) const HAND_VELOCITY: f64 = 0.7;
pub(super) const TYPICAL_ACCELERATION: f64 = 3.0;
/// The largest that it is believed to be, m/s.
pub(super) const LARGEST_VELOCITY: f64 = 40.0;
/// The time over which the velocity is averaged for that, s.
pub(super) const VELOCITY_S: f64 = 10.0;
/// Without a velocity for this long, s, nothing else is known of it.
pub(super) const UNAIDED_S: f64 = 3.0;

/// At rest: rates, rad/s, and velocity, m/s.
pub(super) const REST_RATE: Noise = Noise::new(0.002, 0.5);
pub(super) const REST_VELOCITY: Noise = Noise::new(0.05, 0.5);

/// The square of the number of standard deviations up to which an innovation is
/// believed.
pub(super) const GATE: f64 = 25.0;
/// The same of the magnetic field, whose disturbances are frequent and not large.
pub(super) const FIELD_GATE: f64 = 11.3;
/// How long a sensor is refused, s, before the filter doubts itself: a receiver,
/// a barometer, an airspeed sensor, a magnetometer.
pub(super) const RECEIVER_REFUSED_S: f64 = 3.0;
pub(super) const BAROMETER_REFUSED_S: f64 = 5.0;
pub(super) const AIRSPEED_REFUSED_S: f64 = 30.0;
pub(super) const FIELD_REFUSED_S: f64 = 20.0;
