//! Moves each control of an aircraft that stands still, a little and then fully to each side,
//! and compares what is measured, and what a person sees, with what was commanded.

use std::sync::mpsc::Receiver;
use std::time::Duration;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{ActuatorFault, Tick, Time};
use fcc_core::units::KNOT_MPS;
use fcc_linux::servo::Drives as Control;
use fcc_runtime::StopHandle;
use fcc_timer::{ManualTimer, Timer};
use serde::Serialize;

use super::assemble::Assembly;
use super::fly::{FlyError, refuse_if_taken, release_by};
use super::host::Host;
use crate::config::{ActuatorEntry, Config};

/// The first deflection, so that linkage that binds is seen before the full one.
const SMALL: f64 = 0.3;
/// How long a deflection is held before it is judged, and the centre between two, s: a servo
/// takes 0.2 s, X-Plane's answer a few frames.
const HELD_S: f64 = 1.0;
/// How long a plant may take until it answers, and how long it is watched first, s.
const ANSWERS_S: f64 = 10.0;
const WATCHED_S: f64 = 1.0;
/// What has not been read for longer is not measured: fixes may come once a second.
const MAX_AGE: Duration = Duration::from_millis(1_500);
/// The ground speed of an aircraft that moves, m/s: several times the noise of a fix. Where it is
/// not measured, an airspeed of this share of the stalling speed, which wind alone may reach.
const MOVES_MPS: f64 = 2.0;
const MOVES_OF_STALL: f64 = 0.7;
/// A movement of this share of the commanded one is one: a linkage may be shorter.
const FOLLOWS: f64 = 0.5;

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

impl Verdict {
    /// Of a share of the commanded movement.
    fn of(share: f64) -> Self {
        if share >= FOLLOWS {
            Self::Ok
        } else if share <= -FOLLOWS {
            Self::Reversed
        } else {
            Self::NoEffect
        }
    }
}

/// A control that was moved to one side.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Movement {
    /// What was moved.
    pub control: &'static str,
    /// The small and the full deflection.
    pub commanded: [f64; 2],
    /// By how much it was measured to move with each.
    pub read_back: [Option<f64>; 2],
    /// What a person said of the full one.
    pub seen: Option<Verdict>,
    /// What became of it.
    pub verdict: Verdict,
}

/// Why not all controls were moved.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum Unchecked {
    /// It could not begin.
    #[error(transparent)]
    NotBegun(#[from] FlyError),
    /// It flies, or rolls.
    #[error("the aircraft moves ({0:.0} kt): controls are checked standing still")]
    Moves(f64),
    /// No reading arrives.
    #[error("nothing arrives from the sensors: `fccd run` says what each one lacks")]
    Silent,
    /// An actuator, by its name, does not take the outputs.
    #[error("{0}: {1}")]
    Actuator(String, ActuatorFault),
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

/// Moves the controls that a configuration drives, the throttle only if `throttle`. Messages and
/// questions are passed to `say`. A person's answers arrive by `answers`, `None` to end; without
/// them only measured positions count. The controls are centred and released in any case. The
/// built-in aircraft's time is simulated, unless servos are moved as well.
pub fn check_controls(
    mut assembly: Assembly,
    config: &Config,
    throttle: bool,
    host: &mut dyn Host,
    answers: Option<&Receiver<Option<Verdict>>>,
    say: &mut dyn FnMut(String),
) -> Checked {
    let authority = assembly.authority.clone();
    let mut movements = Vec::new();
    let ended = Check::begin(&mut assembly, config, host, say).and_then(|mut check| {
        check.watch()?;
        let controls = controls(config, throttle);
        if controls.is_empty() {
            return Err(Unchecked::NoControls);
        }
        for control in controls {
            check.each_side(control, answers, &mut movements)?;
        }
        Ok(())
    });
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

/// Those that servos drive, but for the landing gear, on which the aircraft stands; other
/// actuators take the three surfaces and the throttle.
fn controls(config: &Config, throttle: bool) -> Vec<Control> {
    use Control::{Aileron, Elevator, Rudder, Throttle};
    let usual = [Elevator, Aileron, Rudder, Throttle];
    let mut controls = Vec::new();
    for actuator in config.actuators() {
        let drives = match actuator {
            ActuatorEntry::Servos(section) => section.channels.iter().map(|c| c.drives).collect(),
            ActuatorEntry::Simulator(_) | ActuatorEntry::ServoBoard(_) => usual.to_vec(),
        };
        for one in drives {
            let is_checked = one != Control::Gear && (throttle || one != Throttle);
            if is_checked && !controls.contains(&one) {
                controls.push(one);
            }
        }
    }
    controls
}

/// For users.
const fn name(control: Control) -> &'static str {
    match control {
        Control::Elevator => "elevator",
        Control::Aileron => "aileron",
        Control::Rudder => "rudder",
        Control::NoseWheel => "nose wheel",
        Control::Flaps => "flaps",
        Control::LeftBrake => "left brake",
        Control::RightBrake => "right brake",
        Control::Throttle => "throttle",
        Control::Gear => "gear",
    }
}

/// What it does with a positive deflection, and with a negative one if there is one.
const fn does(control: Control) -> &'static [&'static str] {
    match control {
        Control::Elevator => &["its trailing edge go UP", "its trailing edge go DOWN"],
        Control::Aileron => &[
            "the RIGHT one go UP, the left one down",
            "the RIGHT one go DOWN, the left one up",
        ],
        Control::Rudder => &["its trailing edge go RIGHT", "its trailing edge go LEFT"],
        Control::NoseWheel => &["it turn to the RIGHT", "it turn to the LEFT"],
        Control::Flaps | Control::Gear => &["they go DOWN"],
        Control::LeftBrake | Control::RightBrake => &["it brake"],
        Control::Throttle => &["it go towards FULL"],
    }
}

/// The outputs with this control there, all others centred.
const fn outputs(control: Control, at: f64) -> Surfaces {
    let mut to = Surfaces::IDLE;
    match control {
        Control::Elevator => to.elevator = at,
        Control::Aileron => to.aileron = at,
        Control::Rudder => to.rudder = at,
        Control::Throttle => to.throttle = at,
        Control::NoseWheel => to.nose_wheel = Some(at),
        Control::Flaps => to.flaps = Some(at),
        Control::LeftBrake => to.left_brake = Some(at),
        Control::RightBrake => to.right_brake = Some(at),
        Control::Gear => to.gear = Some(at),
    }
    to
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
    /// What was wrong in the last tick.
    fault: Option<Unchecked>,
}

impl<'a> Check<'a> {
    fn begin(
        assembly: &'a mut Assembly,
        config: &Config,
        host: &'a mut dyn Host,
        say: &'a mut dyn FnMut(String),
    ) -> Result<Self, Unchecked> {
        host.prepare(assembly.authority.as_ref())
            .map_err(FlyError::Host)?;
        let is_simulated = |entry: &ActuatorEntry| matches!(entry, ActuatorEntry::Simulator(_));
        let has_no_servo = config.actuators().iter().all(is_simulated);
        let mut timer: Box<dyn Timer> = if config.built_in.is_some() && has_no_servo {
            Box::new(ManualTimer::new(config.tick.period()).map_err(FlyError::Timer)?)
        } else {
            config.tick.build_timer().map_err(FlyError::Timer)?
        };
        let stop = StopHandle::default();
        host.attach(&stop).map_err(FlyError::Host)?;
        host.started();
        timer.start().map_err(FlyError::Timer)?;
        Ok(Self {
            measured: vec![Measurements::default(); assembly.sensors.len()],
            assembly,
            timer,
            stop,
            host,
            say,
            stall_mps: config.autopilot_config().envelope.stall_airspeed_mps,
            now: Time::NEVER,
            fault: None,
        })
    }

    /// Until the plant answers, and then for a time in which it has to stand still.
    fn watch(&mut self) -> Result<(), Unchecked> {
        let (mut waited_s, mut watched_s) = (0.0, 0.0);
        while watched_s < WATCHED_S {
            let passed_s = self.tick(None)?;
            let mut measured = self.measured.iter();
            let answers = measured.any(|from| *from != Measurements::default());
            waited_s += passed_s;
            watched_s += if answers { passed_s } else { 0.0 };
            if !answers && waited_s > ANSWERS_S {
                return Err(Unchecked::Silent);
            }
        }
        if self.speed().is_none() {
            (self.say)("nothing measures whether the aircraft moves: hold it".to_owned());
        }
        Ok(())
    }

    fn each_side(
        &mut self,
        control: Control,
        answers: Option<&Receiver<Option<Verdict>>>,
        movements: &mut Vec<Movement>,
    ) -> Result<(), Unchecked> {
        let name = name(control);
        for (does, side) in does(control).iter().zip([1.0, -1.0]) {
            let rest = self.held(control, 0.0)?;
            let (commanded, mut read_back) = ([side * SMALL, side], [None; 2]);
            for (moved, to) in read_back.iter_mut().zip(commanded) {
                let at = self.held(control, to)?;
                *moved = at.zip(rest).map(|(at, rest)| at - rest);
            }
            let measured = read_back.into_iter().zip(commanded);
            let measured = measured.filter_map(|(moved, to)| Some(Verdict::of(moved? / to)));
            let seen = match answers {
                Some(answers) => {
                    // An answer given before the question is none.
                    answers.try_iter().for_each(drop);
                    (self.say)(format!("{name}: did {does}? [y/o/n/q]"));
                    Some(self.answer(&outputs(control, side), answers)?)
                }
                None => None,
            };
            movements.push(Movement {
                control: name,
                commanded,
                read_back,
                seen,
                verdict: measured.chain(seen).max().unwrap_or(Verdict::Unconfirmed),
            });
        }
        self.held(control, 0.0).map(drop)
    }

    /// Holds a control there, and returns where it is measured to be then.
    fn held(&mut self, control: Control, at: f64) -> Result<Option<f64>, Unchecked> {
        let mut held_s = 0.0;
        while held_s < HELD_S {
            held_s += self.tick(Some(&outputs(control, at)))?;
        }
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        let mut measured = self.measured.iter();
        let stand = measured.find_map(|from| from.surfaces.fresh(self.now, MAX_AGE));
        Ok(stand.and_then(|stand| match control {
            Control::Elevator => Some(stand.elevator),
            Control::Aileron => Some(stand.aileron),
            Control::Rudder => Some(stand.rudder),
            Control::Throttle => Some(stand.throttle),
            _ => None,
        }))
    }

    /// Holds the outputs until a person has said what is seen of them.
    fn answer(
        &mut self,
        outputs: &Surfaces,
        answers: &Receiver<Option<Verdict>>,
    ) -> Result<Verdict, Unchecked> {
        loop {
            self.tick(Some(outputs))?;
            if let Ok(answer) = answers.try_recv() {
                return answer.ok_or(Unchecked::Ended);
            }
        }
    }

    /// One tick, and how long it took, s.
    fn tick(&mut self, outputs: Option<&Surfaces>) -> Result<f64, Unchecked> {
        let expiry = self.timer.wait().map_err(FlyError::Timer)?;
        let tick = Tick {
            number: expiry.number,
            scheduled: Time::from_nanos(expiry.scheduled_ns),
            woke: Time::from_nanos(expiry.woke_ns),
            missed: expiry.missed,
            dt_s: (expiry.missed + 1) as f64 * self.timer.period().as_secs_f64(),
        };
        self.now = tick.woke;
        for (sensor, into) in self.assembly.sensors.iter_mut().zip(&mut self.measured) {
            // A fault is seen by what does not arrive.
            let _ = sensor.sample(&tick, into);
        }
        self.host.poll(self.say);
        refuse_if_taken(self.host)?;
        if self.stop.is_set() {
            return Err(Unchecked::Ended);
        }
        if let Some((speed_mps, moves_mps)) = self.speed()
            && speed_mps > moves_mps
        {
            return Err(Unchecked::Moves(speed_mps / KNOT_MPS));
        }
        self.fault = None;
        for actuator in &mut self.assembly.actuators {
            match outputs.map_or(Ok(()), |outputs| actuator.apply(&tick, outputs)) {
                // What has no effect is what is looked for.
                Ok(()) | Err(ActuatorFault::Unconfirmed) => {}
                Err(fault) => {
                    self.fault = Some(Unchecked::Actuator(actuator.name().to_owned(), fault));
                }
            }
        }
        Ok(tick.dt_s)
    }

    /// The measured speed, and that of an aircraft that moves, m/s.
    fn speed(&self) -> Option<(f64, f64)> {
        let measured = || self.measured.iter();
        let over_ground = measured().find_map(|from| {
            let fix = from.gnss.fresh(self.now, MAX_AGE).map(|fix| fix.velocity);
            from.velocity.fresh(self.now, MAX_AGE).or(fix)
        });
        let over_ground = over_ground.map(|of| (of.north_mps.hypot(of.east_mps), MOVES_MPS));
        let airspeed = || measured().find_map(|from| from.airspeed_mps.fresh(self.now, MAX_AGE));
        over_ground.or_else(|| airspeed().map(|mps| (mps, MOVES_OF_STALL * self.stall_mps)))
    }
}
