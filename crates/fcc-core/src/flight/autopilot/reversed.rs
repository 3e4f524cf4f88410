//! Ailerons or an elevator that move the aircraft the wrong way, as by a servo's direction that
//! is set wrongly, or exchanged: found in the first seconds after engaging, and then left alone.

use super::Autopilot;
use super::degraded::flown_otherwise;
use super::degraded::otherwise::{REVERSED_AILERONS, REVERSED_BOTH, REVERSED_ELEVATOR};
use super::jammed::{BANK_OFF_RAD, LEAST_STALL_RATIO, PITCH_OFF_RAD};
use super::upset::{FOLLOWS, is_steady};
use crate::flight::Surfaces;
use crate::flight::control::{ReversedSurface, Schedule, SurfaceResponse};
use crate::flight::navigation::Estimate;
use crate::framework::Time;

/// A surface is watched for so long after engaging, s. One that acts the wrong way has thrown
/// the aircraft by then (JSBSim: within 0.5 to 8 s); later, a wing that stalls, ice or a wake
/// could be taken for it.
const WATCHED_S: f64 = 10.0;
/// In a trial both surfaces are centred. The rate of an aircraft that they turned falls to this
/// share of what it was within so long, s: a servo may lag by 0.3 s. One that something else
/// turns is turned on, or faster, by the second share.
const FALLS_TO: f64 = 0.5;
const TRIAL_S: f64 = 0.8;
const TURNS_ON: f64 = 1.5;
/// An elevator turns the nose at first faster than its load turns the path, by this factor
/// (JSBSim's c172p: 3 rad/s for a full one).
const ELEVATOR_TURNS: f64 = 4.7;

/// What both surfaces are centred for: whether the ailerons were found first, the rate at its
/// beginning, rad/s, and for how long, s.
#[derive(Clone, Copy, Debug)]
struct Trial {
    is_aileron: bool,
    is_both: bool,
    rate_radps: f64,
    lasted_s: f64,
}

/// Which surfaces move the aircraft the wrong way.
#[derive(Clone, Debug)]
pub(super) struct Reversed {
    aileron: ReversedSurface,
    elevator: ReversedSurface,
    /// Where the surfaces stood at engaging; none if that was no steady flight.
    standing: Option<Surfaces>,
    watched_s: f64,
    /// What the one that is still used does not answer, after the other was found.
    other: SurfaceResponse,
    trial: Option<Trial>,
    /// Where they stay.
    aileron_stays: Option<f64>,
    elevator_stays: Option<f64>,
}

impl Reversed {
    pub(super) const fn new() -> Self {
        Self {
            aileron: ReversedSurface::new(),
            elevator: ReversedSurface::new(),
            standing: None,
            watched_s: 0.0,
            other: SurfaceResponse::new(),
            trial: None,
            aileron_stays: None,
            elevator_stays: None,
        }
    }

    pub(super) const fn is_aileron(&self) -> bool {
        self.aileron_stays.is_some()
    }

    /// Whether one of them is left alone, and the other used.
    const fn is_one_left(&self) -> bool {
        self.aileron_stays.is_some() != self.elevator_stays.is_some()
    }

    /// What was seen so far begins anew.
    const fn forget(&mut self) {
        self.aileron = ReversedSurface::new();
        self.elevator = ReversedSurface::new();
        self.trial = None;
    }

    /// Whether it is over: `Some(true)` if the rate fell when both surfaces were centred.
    fn judge(&mut self, dt_s: f64) -> Option<bool> {
        let trial = self.trial.as_mut()?;
        trial.lasted_s += dt_s;
        let tried = if trial.is_aileron {
            &self.aileron
        } else {
            &self.elevator
        };
        let share = tried.against_radps() / trial.rate_radps;
        if share < FALLS_TO {
            Some(true)
        } else {
            (share > TURNS_ON || trial.lasted_s > TRIAL_S).then_some(false)
        }
    }

    /// Begins a trial if a surface that is used seems to act the wrong way.
    fn suspect(&mut self, gust_load: f64) {
        let (aileron, elevator) = (&self.aileron, &self.elevator);
        let is_aileron = self.aileron_stays.is_none() && aileron.seems_reversed(gust_load);
        let is_elevator = self.elevator_stays.is_none() && elevator.seems_reversed(gust_load);
        if !is_aileron && !is_elevator {
            return;
        }
        let (tried, other) = if is_aileron {
            (aileron, elevator)
        } else {
            (elevator, aileron)
        };
        self.trial = Some(Trial {
            is_aileron,
            is_both: other.is_suspect(),
            rate_radps: tried.against_radps(),
            lasted_s: 0.0,
        });
    }
}

impl Autopilot {
    /// Begins to watch the surfaces' directions, from where they stand.
    pub(super) fn begin_watching_directions(&mut self, standing: &Surfaces) {
        let is_steady = is_steady(self.navigation.estimate());
        self.jammed.reversed = Reversed {
            standing: is_steady.then_some(*standing),
            ..Reversed::new()
        };
    }

    /// Compares how the aircraft turns with what it was commanded to do, after engaging.
    pub(super) fn watch_directions(
        &mut self,
        now: Time,
        estimate: &Estimate,
        schedule: Schedule,
        dt_s: f64,
    ) {
        let reversed = &self.jammed.reversed;
        let Some(standing) = reversed.standing else {
            return;
        };
        if reversed.watched_s > WATCHED_S && reversed.trial.is_none() {
            return;
        }
        let least_mps = LEAST_STALL_RATIO * self.config.envelope.stall_airspeed_mps;
        let says_nothing = !self.config.finds_jammed_controls
            || self.is_on_runway()
            || self.is_not_followed()
            || estimate.airspeed_mps < least_mps;
        if says_nothing {
            self.jammed.reversed.forget();
            return;
        }
        let (sent, rates) = (&self.last, estimate.body_rates);
        let [roll, pitch] = self.expected_radps(estimate, schedule);
        let is_moved = self.is_moved_by_another(now);
        let reversed = &mut self.jammed.reversed;
        reversed.watched_s += dt_s;
        let (aileron, elevator) = (&mut reversed.aileron, &mut reversed.elevator);
        aileron.step(sent.aileron, roll, rates.roll_radps, dt_s);
        elevator.step(
            sent.elevator,
            ELEVATOR_TURNS * pitch,
            rates.pitch_radps,
            dt_s,
        );
        if reversed.is_one_left() {
            let (command, full_radps, rate_radps, is_off) = if reversed.is_aileron() {
                let off_rad = self.setpoints.pitch_rad - estimate.pitch_rad;
                let is_off = off_rad.abs() > PITCH_OFF_RAD;
                (sent.elevator, pitch, rates.pitch_radps, is_off)
            } else {
                let off_rad = self.setpoints.roll_rad - estimate.roll_rad;
                let is_off = off_rad.abs() > BANK_OFF_RAD;
                (sent.aileron, roll, rates.roll_radps, is_off)
            };
            let other = &mut reversed.other;
            let gusts = estimate.gust_load;
            if other.step(command, full_radps, rate_radps, gusts, dt_s) > 1.0 && is_off {
                self.leave_both(&standing);
                return;
            }
        }
        if reversed.trial.is_none() {
            reversed.suspect(estimate.gust_load);
            return;
        }
        match reversed.judge(dt_s) {
            Some(true) if is_moved => reversed.forget(),
            Some(true) => self.leave_reversed(&standing),
            Some(false) => reversed.forget(),
            None => {}
        }
    }

    /// Whether a surface that is measured stands elsewhere than in the middle, as in a trial:
    /// somebody else moves it.
    fn is_moved_by_another(&self, now: Time) -> bool {
        let stand = self.accepted.surfaces.fresh(now, self.config.max_age);
        stand.is_some_and(|at| at.aileron.abs().max(at.elevator.abs()) > FOLLOWS)
    }

    /// Leaves both alone, where one acted the wrong way and the other does not act: they are
    /// exchanged.
    fn leave_both(&mut self, standing: &Surfaces) {
        let jammed = &mut self.jammed;
        jammed.reversed.aileron_stays = Some(0.0);
        jammed.reversed.elevator_stays = Some(0.0);
        jammed.reversed.forget();
        jammed.flies_without(Some(0.0), Some(0.0), standing);
        self.news = Some(flown_otherwise(REVERSED_BOTH));
    }

    /// Leaves alone what the trial has found. A single one stays where the aircraft was trimmed
    /// with it, on the other side; which is that of two that may be exchanged is not known.
    fn leave_reversed(&mut self, standing: &Surfaces) {
        let jammed = &mut self.jammed;
        let reversed = &mut jammed.reversed;
        let Some(trial) = reversed.trial.take() else {
            return;
        };
        let has_other = if trial.is_aileron {
            reversed.elevator_stays.is_some()
        } else {
            reversed.aileron_stays.is_some()
        };
        if trial.is_both && !has_other {
            self.leave_both(standing);
            return;
        }
        let (aileron, elevator, item) = if trial.is_aileron {
            (Some(-standing.aileron), None, REVERSED_AILERONS)
        } else {
            (None, Some(-standing.elevator), REVERSED_ELEVATOR)
        };
        reversed.aileron_stays = aileron.or(reversed.aileron_stays);
        reversed.elevator_stays = elevator.or(reversed.elevator_stays);
        // The other one shows only now whether it is exchanged with it.
        reversed.watched_s = 0.0;
        reversed.forget();
        let (aileron, elevator) = (reversed.aileron_stays, reversed.elevator_stays);
        jammed.flies_without(aileron, elevator, standing);
        self.news = Some(flown_otherwise(item));
    }

    /// The outputs with the surfaces that act the wrong way where they stay.
    pub(super) fn around_reversed(&self, outputs: Surfaces) -> Surfaces {
        let reversed = &self.jammed.reversed;
        let centred = reversed.trial.map(|_| 0.0);
        Surfaces {
            aileron: reversed
                .aileron_stays
                .or(centred)
                .unwrap_or(outputs.aileron),
            elevator: reversed
                .elevator_stays
                .or(centred)
                .unwrap_or(outputs.elevator),
            ..outputs
        }
    }
}
