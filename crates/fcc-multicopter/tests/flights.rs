//! Flights of the built-in multicopter in lockstep, judged by its truth.
//!
//! Gains and limits were chosen with the seeds below 100; these are others.

use std::time::Duration;

use fcc_core::framework::{AfterRelease, LoopCommand, State};
use fcc_multicopter::{
    Airframe, Command, GoTo, Item, Mode, Multicopter, MulticopterConfig, Waypoint,
};
use fcc_runtime::{Link, LoopConfig, Machine, Parts};
use fcc_sim::multirotor::{Frame, MultirotorConfig, MultirotorSimulation};
use fcc_sim::{Severity, Truth, TruthHandle, Wind};
use fcc_timer::ManualTimer;
use nalgebra::Vector3;

const RATE_HZ: f64 = 400.0;

/// A flight in lockstep.
struct Flight {
    machine: Machine<Multicopter>,
    link: Link<Multicopter>,
    truth: TruthHandle,
    ground_m: f64,
}

/// With typical noise, sensors that are 10 ms late, and 8 m/s with moderate turbulence: 3 m/s
/// (one sigma) at 10 m.
fn windy(seed: u64) -> MultirotorConfig {
    let mut simulated = MultirotorConfig::default();
    simulated.world.wind = Wind {
        from_rad: seed as f64,
        speed_mps: 8.0,
    };
    simulated.world.gusts = Some(Severity::Moderate);
    simulated.world.seed = seed;
    simulated
}

impl Flight {
    fn of(config: MulticopterConfig, simulated: &MultirotorConfig) -> Self {
        let simulation = MultirotorSimulation::new(simulated).unwrap();
        let period = Duration::from_secs_f64(config.period_s);
        let parts = Parts {
            timer: Box::new(ManualTimer::new(period).unwrap()),
            sensors: vec![Box::new(simulation.sensor)],
            controller: Multicopter::new(config).unwrap(),
            actuators: vec![Box::new(simulation.actuator)],
        };
        let loop_config = LoopConfig {
            failsafe_hold: Duration::from_secs(1),
            after_failsafe: AfterRelease::Stop,
            ..LoopConfig::default()
        };
        let ground_m = simulation.truth.get().altitude_m;
        let (mut machine, link) = Machine::new(parts, &loop_config).unwrap();
        machine.start().unwrap();
        Self {
            machine,
            link,
            truth: simulation.truth,
            ground_m,
        }
    }

    fn new(plan: &'static [Item], simulated: &MultirotorConfig) -> Self {
        let config = MulticopterConfig {
            plan,
            ..MulticopterConfig::default()
        };
        Self::of(config, simulated)
    }

    /// A tick; the truth after it.
    fn tick(&mut self) -> Truth {
        self.machine.step();
        while self.link.messages.receive().is_some() {}
        assert!(
            self.truth.impact().is_none(),
            "crashed: {:?}",
            self.truth.impact()
        );
        self.truth.get()
    }

    /// Flies for so long, and gives each truth with what is flown.
    fn during(&mut self, seconds: f64, mut look: impl FnMut(&Truth, &Machine<Multicopter>)) {
        let period_s = self.machine.record().tick.dt_s;
        let period_s = if period_s > 0.0 {
            period_s
        } else {
            1.0 / RATE_HZ
        };
        for _ in 0..(seconds / period_s).round() as u64 {
            let truth = self.tick();
            look(&truth, &self.machine);
        }
    }

    fn until(&mut self, mode: Mode, within_s: f64) -> f64 {
        for number in 0..(within_s * RATE_HZ) as u64 {
            self.tick();
            if self.machine.record().setpoints.mode == mode {
                return number as f64 / RATE_HZ;
            }
        }
        panic!(
            "no {mode:?} within {within_s} s: {:?}",
            self.machine.record().setpoints
        );
    }

    fn send(&mut self, command: Command) {
        self.link
            .commands
            .send(LoopCommand::Controller(command))
            .unwrap();
    }

    /// North, east and up of home.
    fn place(&self, truth: &Truth) -> Vector3<f64> {
        Vector3::new(
            truth.north_m,
            truth.east_m,
            truth.altitude_m - self.ground_m,
        )
    }
}

fn rms(of: &[f64]) -> f64 {
    (of.iter().map(|one| one * one).sum::<f64>() / of.len() as f64).sqrt()
}

/// Largest deviation and RMS of height and of place from a point, in 60 s.
fn hover(
    seed: u64,
    config: MulticopterConfig,
    simulated: &MultirotorConfig,
) -> (f64, f64, f64, f64) {
    let _ = seed;
    let mut flight = Flight::of(config, simulated);
    flight.until(Mode::Hover, 20.0);
    flight.during(10.0, |_, _| ());
    let (mut heights, mut places) = (Vec::new(), Vec::new());
    let (ground_m, home) = (flight.ground_m, flight.machine.record().setpoints);
    flight.during(60.0, |truth, _| {
        heights.push(truth.altitude_m - ground_m - home.height_m);
        places.push((truth.north_m - home.north_m).hypot(truth.east_m - home.east_m));
    });
    let largest = |of: &[f64]| of.iter().fold(0.0_f64, |most, one| most.max(one.abs()));
    (
        largest(&heights),
        rms(&heights),
        largest(&places),
        rms(&places),
    )
}

static HOVER: [Item; 2] = [Item::TakeOff(10.0), Item::Hover(1e9)];

#[test]
fn tune_hover() {
    for seed in [1, 2, 3] {
        let config = MulticopterConfig {
            plan: &HOVER,
            ..MulticopterConfig::default()
        };
        println!("{seed}: {:?}", hover(seed, config, &windy(seed)));
        let mut quiet = windy(seed);
        quiet.world.sensors.noise = Default::default();
        println!("{seed} no noise: {:?}", hover(seed, config, &quiet));
    }
}

#[test]
fn tune_step() {
    for seed in [1, 2, 3] {
        let mut flight = Flight::new(&HOVER, &windy(seed));
        flight.until(Mode::Hover, 20.0);
        flight.during(5.0, |_, _| ());
        flight.send(Command::GoTo(GoTo {
            north_m: 5.0,
            east_m: 0.0,
            height_m: 10.0,
            heading_rad: None,
        }));
        let (mut within, mut beyond, mut time) = (0.0, 0.0_f64, 0.0);
        flight.during(8.0, |truth, _| {
            time += 1.0 / RATE_HZ;
            if (truth.north_m - 5.0).abs() > 0.3 {
                within = time;
            }
            beyond = beyond.max(truth.north_m - 5.0);
        });
        println!("step {seed}: within {within} beyond {beyond}");
    }
}

#[test]
fn tune_landing() {
    static PLAN: [Item; 2] = [Item::TakeOff(10.0), Item::Land];
    for seed in 1..6 {
        let mut flight = Flight::new(&PLAN, &windy(seed));
        flight.until(Mode::Land, 20.0);
        let mut sink = 0.0_f64;
        let mut touch = 0.0;
        let mut time = 0.0;
        for _ in 0..16_000 {
            let truth = flight.tick();
            let r = flight.machine.record();
            time += 1.0 / RATE_HZ;
            if truth.altitude_m - flight.ground_m < 0.02 && touch == 0.0 {
                touch = time;
                sink = truth.velocity.down_mps;
            }
            if r.setpoints.mode == Mode::Idle {
                break;
            }
        }
        let truth = flight.truth.get();
        println!(
            "land {seed}: at {:?} touch {touch} sink {sink} off after {time} {:?}",
            flight.place(&truth),
            flight.machine.record().estimate.ground
        );
    }
}
