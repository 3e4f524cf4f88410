//! The multicopter: its configuration, and how it is opened.

use std::time::Duration;

use fcc_core::framework::{Controller as _, RecordOf, State, Switch};
use fcc_multicopter::{
    Airframe, Gains, GroundContact, Limits, Mode, Multicopter, MulticopterConfig,
};
use fcc_sim::multirotor::Frame;
use fcc_sim::{Channels, MultirotorConfig, MultirotorSimulation, SimConfig, Wind};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::ardrone::{ArDrone, ArDroneKeys};
use super::multicopter_plan::{PlanItem, of_file, tour};
use super::multicopter_score::Score;
use super::{Opened, Sections, Vehicle, Wishes};
use crate::config::{
    GustsChoice, LoopSection, RealtimeSection, RecordingSection, TelemetrySection,
};
use crate::flight::Observer;
use crate::flight::truth_recorder::{TruthReceiver, tap};

/// A configuration file of a multicopter, in metres.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct MulticopterFile {
    /// `multicopter`.
    pub vehicle: String,
    /// Rate and timer.
    #[serde(rename = "loop")]
    pub tick: LoopSection,
    /// What is requested from the kernel.
    pub realtime: RealtimeSection,
    /// Where flights are recorded.
    pub recording: RecordingSection,
    /// Live telemetry, and commands.
    pub telemetry: TelemetrySection,
    /// The rotors and the body.
    pub airframe: AirframeKeys,
    /// What is not exceeded.
    pub limits: LimitKeys,
    /// What is known of the sensors.
    pub sensors: SensorKeys,
    /// The built-in multicopter.
    #[serde(rename = "built-in")]
    pub built_in: BuiltInKeys,
    /// Clients of the AR.Drone.
    pub ardrone: ArDroneKeys,
    /// What is flown.
    pub plan: Vec<PlanItem>,
}

/// `[airframe]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct AirframeKeys {
    /// 4, 6 or 8, on a circle, alternately turning.
    pub rotors: usize,
    /// From the centre to a rotor.
    pub arm_m: f64,
    /// Ready to fly.
    pub mass_kg: f64,
    /// About the axes forward, right and down.
    pub inertia_kgm2: [f64; 3],
    /// Of one rotor at full speed.
    pub rotor_thrust_n: f64,
    /// Torque over thrust of a rotor.
    pub torque_ratio_m: f64,
    /// Time constant of a motor.
    pub motor_lag_ms: f64,
    /// Thrust over speed: 0 linear, 1 by the square.
    pub thrust_curve: f64,
}

/// `[limits]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct LimitKeys {
    /// Over the ground.
    pub speed_mps: f64,
    /// Upwards.
    pub climb_mps: f64,
    /// Downwards.
    pub sink_mps: f64,
    /// At touchdown.
    pub touchdown_mps: f64,
    /// Of the path.
    pub acceleration_mps2: f64,
    /// Of the thrust.
    pub tilt_deg: f64,
    /// Of the nose.
    pub yaw_rate_dps: f64,
    /// How far inside of a corner a waypoint is passed.
    pub rounding_m: f64,
    /// The lowest height of the way home.
    pub return_height_m: f64,
}

/// `[sensors]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorKeys {
    /// The age of measurements when they arrive.
    pub latency_ms: f64,
    /// An attitude older than this is lost; a position five times as old.
    pub max_age_ms: u64,
    /// Positive east.
    pub magnetic_variation_deg: f64,
}

/// `[built-in]`.
#[derive(Clone, PartialEq, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct BuiltInKeys {
    /// Where the wind comes from.
    pub wind_from_deg: f64,
    /// Steady wind.
    pub wind_mps: f64,
    /// Turbulence.
    pub gusts: GustsChoice,
    /// Whether the sensors are noisy.
    pub noise: bool,
    /// The delay of the sensors.
    pub delay_ms: u16,
    /// The same seed gives the same flight.
    pub seed: u64,
    /// The number of a rotor whose motor stops, from 1; 0 for none.
    pub rotor_stops: usize,
    /// When it stops, from the start.
    pub rotor_stops_at_s: f64,
    /// Where it begins.
    pub latitude_deg: f64,
    /// See `latitude_deg`.
    pub longitude_deg: f64,
}

impl Default for MulticopterFile {
    fn default() -> Self {
        Self {
            vehicle: Multicopter::NAME.to_owned(),
            tick: LoopSection {
                rate_hz: 400.0,
                ..LoopSection::default()
            },
            realtime: RealtimeSection::default(),
            recording: RecordingSection::default(),
            telemetry: TelemetrySection::default(),
            airframe: AirframeKeys::default(),
            limits: LimitKeys::default(),
            sensors: SensorKeys::default(),
            built_in: BuiltInKeys::default(),
            ardrone: ArDroneKeys::default(),
            plan: tour(),
        }
    }
}

impl Default for AirframeKeys {
    fn default() -> Self {
        let airframe = Airframe::default();
        Self {
            rotors: 4,
            arm_m: 0.233,
            mass_kg: airframe.mass_kg,
            inertia_kgm2: airframe.inertia_kgm2.into(),
            rotor_thrust_n: airframe.rotor_thrust_n,
            torque_ratio_m: airframe.torque_ratio_m,
            motor_lag_ms: airframe.motor_lag_s * 1e3,
            thrust_curve: airframe.thrust_curve,
        }
    }
}

impl Default for LimitKeys {
    fn default() -> Self {
        let limits = Limits::default();
        Self {
            speed_mps: limits.speed_mps,
            climb_mps: limits.climb_mps,
            sink_mps: limits.sink_mps,
            touchdown_mps: limits.touchdown_mps,
            acceleration_mps2: limits.acceleration_mps2,
            tilt_deg: 45.0,
            yaw_rate_dps: 60.0,
            rounding_m: limits.rounding_m,
            return_height_m: limits.return_height_m,
        }
    }
}

impl Default for SensorKeys {
    fn default() -> Self {
        Self {
            latency_ms: 10.0,
            max_age_ms: 100,
            magnetic_variation_deg: 0.0,
        }
    }
}

impl Default for BuiltInKeys {
    fn default() -> Self {
        Self {
            wind_from_deg: 270.0,
            wind_mps: 5.0,
            gusts: GustsChoice::Light,
            noise: true,
            delay_ms: 10,
            seed: 1,
            rotor_stops: 0,
            rotor_stops_at_s: 15.0,
            latitude_deg: 47.0,
            longitude_deg: 8.0,
        }
    }
}

impl MulticopterFile {
    /// The first value that is out of its range.
    fn out_of_range(&self) -> Option<String> {
        let (airframe, limits, sensors, built_in) =
            (&self.airframe, &self.limits, &self.sensors, &self.built_in);
        let [roll, pitch, yaw] = airframe.inertia_kgm2;
        let ranges = [
            ("loop.rate_hz", self.tick.rate_hz, 20.0, 2_000.0),
            ("airframe.arm_m", airframe.arm_m, 0.02, 3.0),
            ("airframe.mass_kg", airframe.mass_kg, 0.02, 100.0),
            (
                "airframe.inertia_kgm2",
                roll.min(pitch).min(yaw),
                1e-6,
                100.0,
            ),
            (
                "airframe.rotor_thrust_n",
                airframe.rotor_thrust_n,
                0.05,
                1_000.0,
            ),
            (
                "airframe.torque_ratio_m",
                airframe.torque_ratio_m,
                1e-3,
                0.2,
            ),
            ("airframe.motor_lag_ms", airframe.motor_lag_ms, 1.0, 500.0),
            ("airframe.thrust_curve", airframe.thrust_curve, 0.0, 1.0),
            ("limits.speed_mps", limits.speed_mps, 0.5, 20.0),
            ("limits.climb_mps", limits.climb_mps, 0.3, 10.0),
            ("limits.sink_mps", limits.sink_mps, 0.3, 5.0),
            ("limits.touchdown_mps", limits.touchdown_mps, 0.35, 1.0),
            (
                "limits.acceleration_mps2",
                limits.acceleration_mps2,
                0.5,
                8.0,
            ),
            ("limits.tilt_deg", limits.tilt_deg, 10.0, 60.0),
            ("limits.yaw_rate_dps", limits.yaw_rate_dps, 5.0, 200.0),
            ("limits.rounding_m", limits.rounding_m, 0.05, 10.0),
            ("limits.return_height_m", limits.return_height_m, 2.0, 120.0),
            ("sensors.latency_ms", sensors.latency_ms, 0.0, 500.0),
            ("built-in.wind_mps", built_in.wind_mps, 0.0, 30.0),
            ("built-in.latitude_deg", built_in.latitude_deg, -80.0, 80.0),
            (
                "built-in.longitude_deg",
                built_in.longitude_deg,
                -180.0,
                180.0,
            ),
        ];
        let wrong = ranges
            .iter()
            .find(|(_, value, low, high)| !(low..=high).contains(&value));
        if !matches!(airframe.rotors, 4 | 6 | 8) {
            return Some(format!("airframe.rotors is {}: 4, 6 or 8", airframe.rotors));
        }
        wrong.map(|(key, value, low, high)| format!("{key} is {value}: from {low} to {high}"))
    }

    fn airframe(&self) -> Airframe {
        let keys = &self.airframe;
        Airframe {
            mass_kg: keys.mass_kg,
            inertia_kgm2: Vector3::from(keys.inertia_kgm2),
            rotor_thrust_n: keys.rotor_thrust_n,
            torque_ratio_m: keys.torque_ratio_m,
            motor_lag_s: keys.motor_lag_ms * 1e-3,
            thrust_curve: keys.thrust_curve,
            ..Airframe::default()
        }
        .with_ring(keys.rotors, keys.arm_m)
    }

    /// The core's; the plan stays in memory until the program ends.
    fn to_core(&self) -> MulticopterConfig {
        let keys = &self.limits;
        let flown = if self.ardrone.address.is_some() {
            &[]
        } else {
            self.plan.as_slice()
        };
        let plan: Vec<_> = flown.iter().map(|item| item.to_core()).collect();
        MulticopterConfig {
            airframe: self.airframe(),
            period_s: self.tick.period().as_secs_f64(),
            latency_s: self.sensors.latency_ms * 1e-3,
            limits: Limits {
                speed_mps: keys.speed_mps,
                climb_mps: keys.climb_mps,
                sink_mps: keys.sink_mps,
                touchdown_mps: keys.touchdown_mps,
                acceleration_mps2: keys.acceleration_mps2,
                tilt_rad: keys.tilt_deg.to_radians(),
                yaw_rate_radps: keys.yaw_rate_dps.to_radians(),
                rounding_m: keys.rounding_m,
                return_height_m: keys.return_height_m,
                ..Limits::default()
            },
            plan: plan.leak(),
            magnetic_variation_rad: self.sensors.magnetic_variation_deg.to_radians(),
            max_age: Duration::from_millis(self.sensors.max_age_ms),
        }
    }

    fn simulated(&self) -> MultirotorConfig {
        let keys = &self.built_in;
        let base = MultirotorConfig::default();
        let mut sensors = base.world.sensors;
        sensors.delay_ms = keys.delay_ms;
        if !keys.noise {
            sensors.noise = Channels::default();
        }
        let mut frame = Frame::ring(self.airframe.rotors, 0.225);
        let rotor = keys.rotor_stops.checked_sub(1);
        frame.stops = rotor.map(|rotor| (rotor, keys.rotor_stops_at_s));
        MultirotorConfig {
            frame,
            world: SimConfig {
                wind: Wind {
                    from_rad: keys.wind_from_deg.to_radians(),
                    speed_mps: keys.wind_mps,
                },
                gusts: keys.gusts.severity(),
                seed: keys.seed,
                latitude_rad: keys.latitude_deg.to_radians(),
                longitude_rad: keys.longitude_deg.to_radians(),
                magnetic_variation_rad: self.sensors.magnetic_variation_deg.to_radians(),
                sensors,
                ..base.world
            },
        }
    }
}

impl Vehicle for Multicopter {
    const NAME: &'static str = "multicopter";

    type Config = MulticopterFile;

    fn sections(config: &MulticopterFile) -> Sections<'_> {
        Sections {
            tick: &config.tick,
            realtime: &config.realtime,
            recording: &config.recording,
            telemetry: &config.telemetry,
        }
    }

    fn apply(config: &mut MulticopterFile, wishes: &Wishes<'_>) -> Result<(), String> {
        let built_in = &mut config.built_in;
        built_in.seed = wishes.seed.unwrap_or(built_in.seed);
        built_in.gusts = wishes.gusts.unwrap_or(built_in.gusts);
        if let Some(file) = wishes.plan {
            let (home, plan) = of_file(file)?;
            (built_in.latitude_deg, built_in.longitude_deg) =
                (home.latitude_deg, home.longitude_deg);
            config.plan = plan;
        }
        let recording = &mut config.recording;
        if let Some(folder) = wishes.recordings {
            folder.clone_into(&mut recording.folder);
            recording.enabled = true;
        }
        recording.enabled &= !wishes.not_recorded;
        if let Some(instance) = wishes.instance {
            config.telemetry.instance = instance.clone();
        }
        Self::check(config).map(|_| ())
    }

    fn check(config: &MulticopterFile) -> Result<String, String> {
        if config.vehicle != Self::NAME {
            return Err(format!(
                "vehicle is {}: it must be {}",
                config.vehicle,
                Self::NAME
            ));
        }
        if let Some(wrong) = config.out_of_range() {
            return Err(wrong);
        }
        PlanItem::check(&config.plan)?;
        Self::controller(config)?;
        let core = config.to_core();
        let gains = Gains::of(&core.airframe, core.period_s, core.latency_s);
        let gains = gains.map_err(|refused| refused.to_string())?;
        Ok(format!(
            "flies the built-in multicopter of {} rotors at {} Hz by {}; control is delayed by \
             {:.0} ms, hovering takes {:.0} % of the thrust",
            config.airframe.rotors,
            config.tick.rate_hz,
            config.tick.timer,
            gains.delay_s * 1e3,
            100.0 * core.airframe.hover_share(),
        ))
    }

    fn controller(config: &MulticopterFile) -> Result<Self, String> {
        Self::new(&config.to_core()).map_err(|refused| refused.to_string())
    }

    fn open(config: &MulticopterFile) -> Result<Opened<Self>, String> {
        let simulation = MultirotorSimulation::new(&config.simulated());
        let simulation = simulation.map_err(|error| error.to_string())?;
        let (sensor, truth) = tap(simulation.sensor, config.tick.ticks_in(8.0, 1 << 16));
        Ok(Opened {
            sensors: vec![Box::new(sensor)],
            actuators: vec![Box::new(simulation.actuator)],
            truth,
            true_now: simulation.truth,
        })
    }

    fn commanders(config: &MulticopterFile) -> Result<Vec<Box<dyn Observer<Self>>>, String> {
        let variation_rad = config.sensors.magnetic_variation_deg.to_radians();
        let ardrone = config.ardrone.address;
        let ardrone = ardrone.map(|address| ArDrone::open(address, variation_rad));
        let ardrone = ardrone.transpose()?;
        Ok(ardrone.into_iter().map(|one| Box::new(one) as _).collect())
    }

    fn ends_at_rest(config: &MulticopterFile) -> bool {
        config.ardrone.address.is_none()
    }

    fn scorer(truth: TruthReceiver) -> Box<dyn Observer<Self>> {
        Box::new(Score::new(truth))
    }

    fn describe(record: &RecordOf<Self>) -> Option<String> {
        if record.measurements.position.is_never() {
            return None;
        }
        let (is, wanted) = (&record.estimate, &record.setpoints);
        let speed_mps = is.north_mps.hypot(is.east_mps);
        // Without the sign of a zero.
        let tenths = |value: f64| (value * 10.0).round() / 10.0 + 0.0;
        let (north_m, east_m) = (tenths(is.north_m), tenths(is.east_m));
        let (height_m, wanted_m) = (tenths(is.height_m), tenths(wanted.height_m));
        let place = format!("{north_m:6.1} m N {east_m:6.1} m E");
        Some(if record.state.state() == State::Engaged {
            let name = Self::mode_name(wanted.mode as u8);
            let item = match wanted.item {
                0 => String::new(),
                item => item.to_string(),
            };
            format!(
                "{name:<8} {item:>2} {place} {height_m:5.1}→{wanted_m:5.1} m {speed_mps:4.1} m/s"
            )
        } else {
            format!("{place} {height_m:5.1} m {speed_mps:4.1} m/s")
        })
    }

    fn switch_position(record: &RecordOf<Self>) -> Option<Switch> {
        let switch = &record.measurements.engage_switch;
        (!switch.is_never()).then_some(switch.value)
    }

    fn rests(record: &RecordOf<Self>) -> bool {
        let stands = record.estimate.ground == GroundContact::Landed;
        stands && record.setpoints.mode == Mode::Idle
    }
}
