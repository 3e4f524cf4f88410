//! Raw sensors in the hands of a simulated person, who calibrates them: for
//! learning without hardware, and for tests.
//!
//! The sensors are those of the flights with the same seed: what is found here is
//! true there.

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use fcc_core::flight::atmosphere::differential_pressure_pa;
use fcc_core::flight::orientation::{
    EulerAngles, earth_to_body, euler_from_quaternion, product, quaternion_from_euler,
};
use fcc_core::flight::{Attitude, BodyRates, Measurements, SpecificForce};
use fcc_core::framework::{Sensor, SensorFault, Tick};
use libm::{acos, cos, floor, sin, sqrt};

use crate::atmosphere::Air;
use crate::config::SimConfig;
use crate::local_earth::LocalEarth;
use crate::raw::{RawSensors, RawTruth};
use crate::units::STANDARD_GRAVITY_MPS2;

/// What the person does with the sensors.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HandlingTask {
    /// Leaves them alone, for 15 s.
    LeaveAlone,
    /// Leaves them alone for 12 s, then turns them by half and quarter turns about
    /// each of their axes, and lays them down after each.
    TurnOver,
    /// Holds them with each face up, and with six edges up.
    Places,
    /// Turns them through all directions, for 100 s.
    Tumble,
    /// Leaves the aircraft level, then raises its nose by 30°, for 20 s in all.
    LevelAndNoseUp,
}

/// What the person does wrong.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HandlingFault {
    /// Ends after a third of it.
    EndsEarly,
    /// Does not keep still, in a gusty wind.
    Restless,
    /// Has a magnet on the table.
    Magnet,
    /// Turns them over about their x axis alone.
    OneAxis,
}

/// How long an attitude is held, and how long it takes to turn to the next, s.
const HELD_S: f64 = 4.0;
const TURNING_S: f64 = 2.0;
const TUMBLING_S: f64 = 100.0;
const ALONE_S: f64 = 15.0;
/// Before the first turn.
const BEFORE_TURNS_S: f64 = 12.0;
/// What a hand adds to each turn, rad: its axis and its end are not exact.
const UNTIDY_RAD: f64 = 0.08;
/// The longest step of the motion, s.
const STEP_S: f64 = 0.005;
/// Rates are differences over this span, s.
const DIFFERENCE_S: f64 = 1e-3;
/// The tremor of a hand that moves: 8 to 12 Hz; its size is assumed.
const TREMOR_HZ: f64 = 9.0;
const TREMOR_MPS2: f64 = 0.2;
/// A restless person moves them for 0.4 s in every 1.5 s.
const RESTLESS_S: (f64, f64) = (0.4, 1.5);
const RESTLESS_MPS2: f64 = 3.0;
const GUST_MPS: f64 = 6.0;
/// The field of a magnet of 1 A·m² beside it at a distance r in m is 0.1 µT / r³
/// (µ0 / 4π, of a dipole; Jackson, *Classical Electrodynamics*, section 5.6).
const DIPOLE_UT_M3: f64 = 0.1;

/// Raw sensors in hands, as a loop's sensor.
#[derive(Clone, Debug)]
pub struct HandledSensors {
    sensors: RawSensors,
    task: HandlingTask,
    fault: Option<HandlingFault>,
    start: RawTruth,
    field_ut: [f64; 3],
    time_s: f64,
}

impl HandledSensors {
    /// The sensors of an aircraft; none if it has none.
    pub fn new(
        config: &SimConfig,
        task: HandlingTask,
        fault: Option<HandlingFault>,
    ) -> Option<Self> {
        let set = config.raw_sensors.as_ref()?;
        let earth = LocalEarth::new(config.latitude_rad, config.longitude_rad);
        let air = Air::at(config.ground_m);
        let start = RawTruth {
            static_pressure_pa: air.pressure_pa,
            air_temperature_k: air.temperature_k,
            position: earth.position(0.0, 0.0, config.ground_m),
            ..RawTruth::default()
        };
        let field_ut = config.magnetic_field_ut();
        let mut this = Self {
            sensors: RawSensors::new(set, config.seed, &start, field_ut),
            task,
            fault,
            start,
            field_ut,
            time_s: 0.0,
        };
        let start = this.truth(0.0);
        this.sensors = RawSensors::new(set, config.seed, &start, field_ut);
        Some(this)
    }

    /// After so many seconds the person has finished, or given up.
    pub fn length_s(&self) -> f64 {
        let whole_s = match self.task {
            HandlingTask::LeaveAlone => ALONE_S,
            HandlingTask::TurnOver => BEFORE_TURNS_S + TURNS.len() as f64 * (HELD_S + TURNING_S),
            HandlingTask::Places => PLACES.len() as f64 * (HELD_S + TURNING_S),
            HandlingTask::Tumble => TUMBLING_S,
            HandlingTask::LevelAndNoseUp => 20.0,
        };
        if self.fault == Some(HandlingFault::EndsEarly) {
            whole_s / 3.0
        } else {
            whole_s
        }
    }

    /// The sensors, which know their true errors.
    pub fn sensors(&self) -> &RawSensors {
        &self.sensors
    }

    fn truth(&self, time_s: f64) -> RawTruth {
        let attitude = self.attitude(time_s);
        let euler = euler_from_quaternion(attitude);
        let later = self.attitude(time_s + DIFFERENCE_S);
        let [a, b, c, d] = attitude;
        let [_, x, y, z] = product([a, -b, -c, -d], later);
        let shaking_mps2 = self.shaking_mps2(time_s);
        let gravity = earth_to_body(attitude, [0.0, 0.0, -STANDARD_GRAVITY_MPS2]);
        let [fx, fy, fz] = gravity;
        let shake = |phase: f64| shaking_mps2 * sin(2.0 * PI * TREMOR_HZ * time_s + phase);
        let is_windy = self.fault == Some(HandlingFault::Restless);
        let gust_mps = if is_windy {
            GUST_MPS * sin(0.9 * time_s)
        } else {
            0.0
        };
        RawTruth {
            time_s,
            attitude: Attitude {
                roll_rad: euler.roll_rad,
                pitch_rad: euler.pitch_rad,
            },
            heading_rad: euler.heading_rad,
            rates: BodyRates {
                roll_radps: 2.0 * x / DIFFERENCE_S,
                pitch_radps: 2.0 * y / DIFFERENCE_S,
                yaw_radps: 2.0 * z / DIFFERENCE_S,
            },
            specific_force: SpecificForce {
                x_mps2: fx + shake(0.0),
                y_mps2: fy + shake(2.0),
                z_mps2: fz + shake(4.0),
            },
            differential_pressure_pa: differential_pressure_pa(gust_mps.max(0.0)),
            ..self.start
        }
    }

    /// The amplitude of what shakes it.
    fn shaking_mps2(&self, time_s: f64) -> f64 {
        let (moved_s, every_s) = RESTLESS_S;
        let since_s = time_s - every_s * floor(time_s / every_s);
        if self.fault == Some(HandlingFault::Restless) && since_s < moved_s {
            return RESTLESS_MPS2;
        }
        let (_, share) = self.stage(time_s);
        let is_turning = self.task == HandlingTask::Tumble || (share > 0.0 && share < 1.0);
        if is_turning { TREMOR_MPS2 } else { 0.0 }
    }

    /// Which attitude is held, and how far the turn to it has come.
    fn stage(&self, time_s: f64) -> (usize, f64) {
        let time_s = match self.task {
            HandlingTask::TurnOver if time_s < BEFORE_TURNS_S => return (0, 1.0),
            HandlingTask::TurnOver => time_s - BEFORE_TURNS_S,
            _ => time_s,
        };
        let each_s = TURNING_S + HELD_S;
        let number = floor(time_s / each_s);
        let share = (time_s - number * each_s) / TURNING_S;
        match self.task {
            HandlingTask::TurnOver => (number as usize + 1, share.min(1.0)),
            HandlingTask::Places | HandlingTask::LevelAndNoseUp => {
                (number as usize, share.min(1.0))
            }
            HandlingTask::LeaveAlone | HandlingTask::Tumble => (0, 1.0),
        }
    }

    fn attitude(&self, time_s: f64) -> [f64; 4] {
        if self.task == HandlingTask::Tumble {
            return of(0.9 * time_s, 1.4 * sin(0.23 * time_s), 0.11 * time_s);
        }
        let (number, share) = self.stage(time_s);
        // Slowly at the begin and the end.
        let share = share * share * (3.0 - 2.0 * share);
        if self.task == HandlingTask::TurnOver {
            return self.turned_over(number, share);
        }
        let pose = |number: usize| match self.task {
            HandlingTask::Places => PLACES.get(number).or(PLACES.last()).copied(),
            HandlingTask::LevelAndNoseUp if number > 1 => Some([0.0, PI / 6.0, 0.0]),
            _ => None,
        };
        let [from, to] = [number.saturating_sub(1), number]
            .map(pose)
            .map(|angles| angles.map_or([1.0, 0.0, 0.0, 0.0], |[a, b, c]| of(a, b, c)));
        between(from, to, share)
    }

    /// After so many turns over, of the last a share.
    fn turned_over(&self, count: usize, share: f64) -> [f64; 4] {
        let mut attitude = of(0.03, -0.05, 0.2);
        for (number, turn) in (1..=count).zip(TURNS) {
            let done = if number == count { share } else { 1.0 };
            let (axis, quarters) = match self.fault {
                Some(HandlingFault::OneAxis) => (0, turn.1),
                _ => turn,
            };
            let untidy = |of: f64| UNTIDY_RAD * sin(1.7 * number as f64 + 2.1 * of);
            let vector = [0, 1, 2].map(|of| {
                let turned = if of == axis {
                    quarters * FRAC_PI_2
                } else {
                    0.0
                };
                done * (turned + untidy(f64::from(of)))
            });
            attitude = product(attitude, about(vector));
        }
        attitude
    }

    /// The field around the sensors, north, east and down.
    fn field_ut(&self, time_s: f64) -> [f64; 3] {
        if self.fault != Some(HandlingFault::Magnet) {
            return self.field_ut;
        }
        // The hand moves above the magnet, which points up.
        let place_m = [
            0.12 * sin(0.7 * time_s),
            0.12 * cos(0.5 * time_s),
            -0.18 + 0.05 * sin(0.3 * time_s),
        ];
        let [north_m, east_m, down_m] = place_m;
        let distance_m = sqrt(north_m * north_m + east_m * east_m + down_m * down_m);
        let strength_ut = DIPOLE_UT_M3 / (distance_m * distance_m * distance_m);
        let [north, east, down] = place_m.map(|part| part / distance_m);
        let [x, y, z] = self.field_ut;
        // 3 (m · r) r - m, with m up.
        [
            x - strength_ut * 3.0 * down * north,
            y - strength_ut * 3.0 * down * east,
            z - strength_ut * (3.0 * down * down - 1.0),
        ]
    }
}

impl Sensor<Measurements> for HandledSensors {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let mut left_s = tick.dt_s.clamp(0.0, 1.0);
        while left_s > 0.0 {
            let step_s = left_s.min(STEP_S);
            left_s -= step_s;
            self.time_s += step_s;
            let truth = self.truth(self.time_s);
            self.sensors.set_field_ut(self.field_ut(self.time_s));
            self.sensors.step(&truth);
        }
        self.sensors.read(tick.woke, into);
        Ok(())
    }

    fn name(&self) -> &'static str {
        "built-in aircraft"
    }
}

/// Roll, pitch and heading of each face and each of six edges up, tilted by some
/// degrees, as a hand does it.
const PLACES: [[f64; 3]; 12] = [
    [0.05, FRAC_PI_2 - 0.06, 0.0],
    [-0.04, -FRAC_PI_2 + 0.05, 0.3],
    [-FRAC_PI_2 + 0.04, 0.03, 0.6],
    [FRAC_PI_2 - 0.05, -0.04, 0.2],
    [PI - 0.06, 0.02, -0.3],
    [0.03, -0.05, 0.1],
    [-FRAC_PI_2 + 0.03, FRAC_PI_4 + 0.04, 0.4],
    [-FRAC_PI_2, -FRAC_PI_4 + 0.05, 0.0],
    [-3.0 * FRAC_PI_4 + 0.04, 0.02, -0.2],
    [3.0 * FRAC_PI_4 - 0.05, 0.04, 0.5],
    [PI - 0.03, FRAC_PI_4 - 0.04, 0.7],
    [0.02, FRAC_PI_4 + 0.03, 0.2],
];

/// The axis, x is 0, and the quarter turns about it.
const TURNS: [(u8, f64); 14] = [
    (0, 2.0),
    (1, 2.0),
    (0, 1.0),
    (0, 2.0),
    (2, 2.0),
    (2, 1.0),
    (1, 2.0),
    (2, -2.0),
    (1, -1.0),
    (0, -2.0),
    (1, 2.0),
    (0, -1.0),
    (2, 2.0),
    (2, 1.0),
];

/// The turn about a vector by its length, rad.
fn about([x, y, z]: [f64; 3]) -> [f64; 4] {
    let angle = sqrt(x * x + y * y + z * z);
    let part = if angle > 0.0 {
        sin(0.5 * angle) / angle
    } else {
        0.5
    };
    [cos(0.5 * angle), part * x, part * y, part * z]
}

fn of(roll_rad: f64, pitch_rad: f64, heading_rad: f64) -> [f64; 4] {
    quaternion_from_euler(EulerAngles {
        roll_rad,
        pitch_rad,
        heading_rad,
    })
}

/// The share of a turn from one attitude to another, about one axis (Shoemake
/// 1985).
fn between(from: [f64; 4], to: [f64; 4], share: f64) -> [f64; 4] {
    let cosine: f64 = from.iter().zip(to).map(|(one, other)| one * other).sum();
    // The shorter way.
    let sign = if cosine < 0.0 { -1.0 } else { 1.0 };
    let angle = acos((sign * cosine).clamp(-1.0, 1.0));
    let sine = sin(angle);
    if sine < 1e-9 {
        return to;
    }
    let (before, after) = (
        sin((1.0 - share) * angle) / sine,
        sign * sin(share * angle) / sine,
    );
    let mut found = from;
    for (part, to) in found.iter_mut().zip(to) {
        *part = before * *part + after * to;
    }
    found
}
