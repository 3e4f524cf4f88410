//! Moves each control of an aircraft that stands still, a little and then fully to each side,
//! and compares what the plant measures, and what a person sees, with what was commanded.

mod control;

use std::io;
use std::time::Duration;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{ActuatorFault, PlantId, Tick, Time};
use fcc_core::units::KNOT_MPS;
use fcc_runtime::StopHandle;
use fcc_timer::{ManualTimer, Timer, TimerError};
use serde::Serialize;

use super::assemble::Assembly;
use super::fly::release_by;
use super::host::Host;
use crate::config::Config;
use control::Control;

/// The first deflection, so that linkage that binds is seen before the full one.
const SMALL: f64 = 0.3;
/// How long a deflection is held before it is judged, and the centre between two, s: a servo
/// takes 0.2 s, X-Plane's answer a few frames.
const HELD_S: f64 = 1.0;
/// How long a plant may take until it answers, and how long it is watched first, s.
const CONNECTS_S: f64 = 10.0;
const WATCHED_S: f64 = 1.0;
/// What has not been read for longer is not measured: fixes may come once a second.
const MAX_AGE: Duration = Duration::from_millis(1_500);
/// The ground speed of an aircraft that moves, m/s: several times the noise of a fix. Where it is
/// not measured, an airspeed of this share of the stalling speed, which wind alone may reach.
const MOVES_MPS: f64 = 2.0;
const MOVES_OF_STALL: f64 = 0.7;
/// Sea level, kg/m³ (ISO 2533).
const AIR_DENSITY: f64 = 1.225;
/// A movement of this share of the commanded one is one: a linkage may be shorter.
const FOLLOWS: f64 = 0.5;

/// What a person saw.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Seen {
    /// It went where it was asked about.
    Yes,
    /// It went the other way.
    OtherWay,
    /// It did not move, or another control did.
    No,
}

/// What a person answers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reply {
    /// To the question.
    Seen(Seen),
    /// The check is to end.
    Quit,
}

/// A person beside the aircraft.
pub trait Onlooker {
    /// Asks what the person sees.
    fn ask(&mut self, question: &str);
    /// The answer, once it is there. Does not wait.
    fn reply(&mut self) -> Option<Reply>;
}

/// What became of a movement; the worst last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The control moved as it should.
    Ok,
    /// Nothing measures it, and nobody said what it did.
    Unconfirmed,
    /// It did not move.
    NoEffect,
    /// It moved the other way.
    Reversed,
}

/// A control that was moved to one side.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Movement {
    /// The control.
    pub control: &'static str,
    /// The small and the full deflection.
    pub commanded: [f64; 2],
    /// By how much it was measured to move with each.
    pub read_back: [Option<f64>; 2],
    /// What a person saw of the full one.
    pub seen: Option<Seen>,
    /// What became of it.
    pub verdict: Verdict,
}

impl Movement {
    fn new(control: &Control, side: f64, read_back: [Option<f64>; 2], seen: Option<Seen>) -> Self {
        let commanded = [side * SMALL, side];
        let measured = read_back.into_iter().zip(commanded);
        let measured = measured.filter_map(|(moved, by)| Some(judged(moved? / by)));
        let seen_as = seen.map(|seen| match seen {
            Seen::Yes => Verdict::Ok,
            Seen::OtherWay => Verdict::Reversed,
            Seen::No => Verdict::NoEffect,
        });
        let verdict = measured.chain(seen_as).max();
        Self {
            control: control.name,
            commanded,
            read_back,
            seen,
            verdict: verdict.unwrap_or(Verdict::Unconfirmed),
        }
    }
}

/// What a share of the commanded movement says.
fn judged(share: f64) -> Verdict {
    if share >= FOLLOWS {
        Verdict::Ok
    } else if share <= -FOLLOWS {
        Verdict::Reversed
    } else {
        Verdict::NoEffect
    }
}

/// Why not all controls were moved.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum Unchecked {
    /// The loop's timer failed.
    #[error("the loop's timer: {0}")]
    Timer(#[from] TimerError),
    /// The host program cannot begin.
    #[error(transparent)]
    Host(#[from] io::Error),
    /// Another program controls this plant.
    #[error("another fccd on this machine controls {0}: end that one first")]
    Taken(PlantId),
    /// It flies, or rolls.
    #[error("the aircraft moves, with {knots:.0} kt of {of}: controls are checked standing still")]
    Moves {
        /// How fast.
        knots: f64,
        /// Whether that is over the ground.
        of: &'static str,
    },
    /// An actuator does not take the outputs.
    #[error("{actuator}: {fault}")]
    Actuator {
        /// Which one.
        actuator: String,
        /// What is wrong.
        fault: ActuatorFault,
    },
    /// No reading arrives.
    #[error("nothing arrives from the sensors: is the simulator running, are they connected?")]
    Silent,
    /// No actuator is configured.
    #[error("the configuration drives no control that can be checked")]
    NoControls,
    /// The person, or a signal, ended it.
    #[error("ended before all controls were checked")]
    Ended,
}

/// What was found, and how the check ended.
pub struct Checked {
    /// In their order.
    pub movements: Vec<Movement>,
    /// Whether all controls were moved.
    pub ended: Result<(), Unchecked>,
    /// Whether the controls were released.
    pub released: bool,
}

/// Moves the controls of an assembly that a configuration drives, the throttle only if
/// `throttle`. Messages are passed to `say`; without an onlooker only measured positions count.
/// The controls are centred and released in any case. The built-in aircraft's time is not real.
pub fn check_controls(
    mut assembly: Assembly,
    config: &Config,
    throttle: bool,
    host: &mut dyn Host,
    onlooker: Option<&mut dyn Onlooker>,
    say: &mut dyn FnMut(String),
) -> Checked {
    let authority = assembly.authority.clone();
    let mut movements = Vec::new();
    let ended = (|| {
        host.prepare(authority.as_ref())?;
        let period = config.tick.period();
        let timer: Box<dyn Timer> = if config.built_in.is_some() {
            Box::new(ManualTimer::new(period)?)
        } else {
            config.tick.build_timer()?
        };
        let stop = StopHandle::default();
        host.attach(&stop)?;
        host.started();
        let mut check = Check {
            measured: vec![Measurements::default(); assembly.sensors.len()],
            assembly: &mut assembly,
            timer,
            stop,
            host: &mut *host,
            say: &mut *say,
            stall_mps: config.autopilot_config().envelope.stall_airspeed_mps,
            now: Time::NEVER,
            failing_s: 0.0,
        };
        check.run(&Control::of(config, throttle), onlooker, &mut movements)
    })();
    let sent = assembly.actuators.iter_mut().map(|one| one.release());
    // Each is tried, whatever becomes of the others.
    let sent = sent.fold(true, |all, release| all & release.is_ok());
    let released = release_by(authority.as_ref(), say, host);
    Checked {
        movements,
        ended,
        released: sent && released.is_over(),
    }
}

struct Check<'a> {
    assembly: &'a mut Assembly,
    /// Of each sensor.
    measured: Vec<Measurements>,
    timer: Box<dyn Timer>,
    stop: StopHandle,
    host: &'a mut dyn Host,
    say: &'a mut dyn FnMut(String),
    stall_mps: f64,
    now: Time,
    /// For how long an actuator has not taken outputs, s.
    failing_s: f64,
}

impl Check<'_> {
    fn run(
        &mut self,
        controls: &[Control],
        mut onlooker: Option<&mut dyn Onlooker>,
        movements: &mut Vec<Movement>,
    ) -> Result<(), Unchecked> {
        if controls.is_empty() {
            return Err(Unchecked::NoControls);
        }
        self.timer.start()?;
        self.watch()?;
        for control in controls {
            for (side, question) in control.sides() {
                let rest = self.held(control, 0.0)?;
                let mut read_back = [None; 2];
                for (moved, by) in read_back.iter_mut().zip([SMALL, 1.0]) {
                    let at = self.held(control, side * by)?;
                    *moved = at.zip(rest).map(|(at, rest)| at - rest);
                }
                let seen = match &mut onlooker {
                    Some(onlooker) => Some(self.seen(control, side, question, *onlooker)?),
                    None => None,
                };
                movements.push(Movement::new(control, side, read_back, seen));
            }
            self.held(control, 0.0)?;
        }
        Ok(())
    }

    /// Until the plant answers, and then for a time in which it has to stand still.
    fn watch(&mut self) -> Result<(), Unchecked> {
        let (mut waited_s, mut watched_s) = (0.0, 0.0);
        while watched_s < WATCHED_S {
            let passed_s = self.tick(None)?;
            let nothing = Measurements::default();
            let mut measured = self.measured.iter();
            let answers = self.measured.is_empty() || measured.any(|from| *from != nothing);
            waited_s += passed_s;
            watched_s += if answers { passed_s } else { 0.0 };
            if waited_s > CONNECTS_S && !answers {
                return Err(Unchecked::Silent);
            }
        }
        if self.speed().is_none() {
            (self.say)("nothing measures whether the aircraft moves: hold it".to_owned());
        }
        Ok(())
    }

    /// Holds a control there, all others centred, and returns where it is measured to be then.
    fn held(&mut self, control: &Control, at: f64) -> Result<Option<f64>, Unchecked> {
        let outputs = control.at(at);
        let mut held_s = 0.0;
        while held_s < HELD_S {
            held_s += self.tick(Some(&outputs))?;
        }
        let measured = self.measured.iter();
        let fresh = measured.filter_map(|from| from.surfaces.fresh(self.now, MAX_AGE));
        Ok(fresh.into_iter().find_map(|at| control.read(&at)))
    }

    /// Holds the full deflection until a person has said what is seen of it.
    fn seen(
        &mut self,
        control: &Control,
        side: f64,
        question: &str,
        onlooker: &mut dyn Onlooker,
    ) -> Result<Seen, Unchecked> {
        let outputs = control.at(side);
        onlooker.ask(question);
        loop {
            self.tick(Some(&outputs))?;
            match onlooker.reply() {
                Some(Reply::Seen(seen)) => return Ok(seen),
                Some(Reply::Quit) => return Err(Unchecked::Ended),
                None => {}
            }
        }
    }

    /// One tick, and how long it took, s.
    fn tick(&mut self, outputs: Option<&Surfaces>) -> Result<f64, Unchecked> {
        let expiry = self.timer.wait()?;
        let periods = (expiry.missed + 1) as f64;
        let tick = Tick {
            number: expiry.number,
            scheduled: Time::from_nanos(expiry.scheduled_ns),
            woke: Time::from_nanos(expiry.woke_ns),
            missed: expiry.missed,
            dt_s: periods * self.timer.period().as_secs_f64(),
        };
        self.now = tick.woke;
        for (sensor, into) in self.assembly.sensors.iter_mut().zip(&mut self.measured) {
            // A fault is seen by what does not arrive.
            let _ = sensor.sample(&tick, into);
        }
        self.host.poll(self.say);
        if let Some(plant) = self.host.taken_by_another() {
            return Err(Unchecked::Taken(plant));
        }
        if self.stop.is_set() {
            return Err(Unchecked::Ended);
        }
        match self.speed() {
            Some((speed_mps, limit_mps, of)) if speed_mps > limit_mps => {
                let knots = speed_mps / KNOT_MPS;
                return Err(Unchecked::Moves { knots, of });
            }
            _ => {}
        }
        if let Some(outputs) = outputs {
            self.apply(&tick, outputs)?;
        }
        Ok(tick.dt_s)
    }

    fn apply(&mut self, tick: &Tick, outputs: &Surfaces) -> Result<(), Unchecked> {
        let mut failed = None;
        for actuator in &mut self.assembly.actuators {
            match actuator.apply(tick, outputs) {
                // What has no effect is what is looked for.
                Ok(()) | Err(ActuatorFault::Unconfirmed) => {}
                Err(fault) => failed = Some((actuator.name().to_owned(), fault)),
            }
        }
        match failed {
            Some((actuator, fault)) if self.failing_s > HELD_S => {
                Err(Unchecked::Actuator { actuator, fault })
            }
            Some(_) => {
                self.failing_s += tick.dt_s;
                Ok(())
            }
            None => {
                self.failing_s = 0.0;
                Ok(())
            }
        }
    }

    /// The measured speed, that of an aircraft that moves, m/s, and of what it is.
    fn speed(&self) -> Option<(f64, f64, &'static str)> {
        let measured = || self.measured.iter();
        let mut over_ground = measured().filter_map(|from| {
            let fix = from.gnss.fresh(self.now, MAX_AGE).map(|fix| fix.velocity);
            from.velocity.fresh(self.now, MAX_AGE).or(fix)
        });
        if let Some(velocity) = over_ground.next() {
            let speed_mps = velocity.north_mps.hypot(velocity.east_mps);
            return Some((speed_mps, MOVES_MPS, "ground speed"));
        }
        let mut airspeed = measured().filter_map(|from| {
            let pressure_pa = from.differential_pressure_pa.fresh(self.now, MAX_AGE);
            let of_pressure = pressure_pa.map(|pa| (2.0 * pa.max(0.0) / AIR_DENSITY).sqrt());
            from.airspeed_mps.fresh(self.now, MAX_AGE).or(of_pressure)
        });
        let limit_mps = MOVES_OF_STALL * self.stall_mps;
        airspeed.next().map(|mps| (mps, limit_mps, "airspeed"))
    }
}
