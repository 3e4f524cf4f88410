//! The loop's state transitions: their causes and their effects.

use fcc_core::framework::{AfterRelease, Cause, Controller, EventKind, Flags, Input, State, Tick};

use crate::commands::StateRequest;
use crate::machine::{Machine, ReleaseReport};
use crate::report::Ending;
use crate::switch::SwitchEdge;

impl<C: Controller> Machine<C> {
    /// Decides the state of this tick. Inputs that end control are processed
    /// before those that engage, so that the safer of two commands wins.
    pub(crate) fn decide(&mut self, tick: &Tick, command: StateRequest) {
        let before = self.state;
        if !before.holds_control() && !self.actuators.are_released() {
            self.release(tick, ReleaseReport::OnSuccess);
        }
        let measurements = &self.measurements;
        let mut release_now = Flags::NONE;
        if before.holds_control() {
            release_now = self.controller.must_release(tick, measurements);
            self.record.faults = self.controller.faults(tick, measurements) | release_now;
        }
        if before != State::Engaged {
            self.record.engage_inhibits = self.controller.engage_inhibits(tick, measurements);
        }
        let taken_over = self.controller.is_taken_over(tick, measurements);
        let switch = self.controller.switch(measurements);
        let edge = self.switch.watch(switch, tick.woke);
        let switch_forbids = self.command_needs_switch && self.switch.is_off();

        if self.stop.is_set() {
            self.telemetry.events.push(tick, EventKind::StopRequested);
            self.stop_for(Ending::StopFlag, tick);
        } else if self.load.is_too_long(tick) {
            let kind = EventKind::StoppedByOverload;
            self.telemetry.events.push(tick, kind);
            self.stop_for(Ending::Overloaded, tick);
        } else if command == StateRequest::Stop {
            self.stop_by_command(tick);
        }
        // Before the switch: what loads a flight may switch it off, too.
        if self.state.holds_control() && !release_now.is_empty() {
            self.release_at_once(release_now, tick);
        }
        let is_taken_over = self.state.holds_control() && !taken_over.is_empty();
        if is_taken_over {
            let conditions = taken_over;
            let kind = EventKind::ReleasedAtOnce { conditions };
            self.telemetry.events.push(tick, kind);
        }
        if edge == Some(SwitchEdge::Off) || switch_forbids || is_taken_over {
            self.release_by(Input::SwitchedOff, tick);
            if self.state == State::Stopped {
                self.end_by(Ending::SwitchedOff);
            }
        }
        if command == StateRequest::Disengage {
            self.release_by(Input::Disengage, tick);
        }
        let faults = self.record.faults;
        if self.state == State::Engaged && !faults.is_empty() {
            self.fail(Cause::Faults(faults), tick);
        }
        if self.state == State::Engaged && self.overruns.are_too_many() {
            self.fail(Cause::Overrun, tick);
        }
        let lost_control = before.holds_control() && self.state != before;

        self.recover_or_go_on(tick);
        if matches!(self.state, State::Failsafe(_))
            && tick.scheduled.since(self.failsafe_since) >= self.failsafe_hold
        {
            self.end_failsafe(tick);
        }
        self.follow_release(tick);
        if command == StateRequest::Engage && switch_forbids {
            let kind = EventKind::EngageRefusedBySwitch;
            self.telemetry.events.push(tick, kind);
        } else if command == StateRequest::Engage || edge == Some(SwitchEdge::On) {
            self.attempt_to_engage(tick, lost_control);
        }
        let is_free = matches!(self.state, State::Standby | State::Failsafe(_));
        if edge == Some(SwitchEdge::OnUnseen) && is_free {
            self.telemetry
                .events
                .push(tick, EventKind::SwitchedOnUnseen);
        }
    }

    /// Ends a failsafe whose cause is over, or lets it go on longer than configured.
    fn recover_or_go_on(&mut self, tick: &Tick) {
        let State::Failsafe(cause) = self.state else {
            return;
        };
        let (controller, overruns) = (&self.controller, &self.overruns);
        let (is_over, goes_on) = match cause {
            Cause::Faults(_) => (!overruns.are_too_many(), controller.failsafe_goes_on()),
            Cause::Overrun => (
                overruns.are_over(tick),
                !overruns.is_long() && controller.is_unattended(),
            ),
            Cause::InvalidOutput => (false, false),
        };
        if is_over && controller.has_recovered() {
            if cause == Cause::Overrun {
                self.overruns.recover(tick);
            }
            self.apply_input(Input::Recovered, tick);
        } else if goes_on && !self.failsafe_hold.is_zero() {
            self.failsafe_since = tick.scheduled;
        }
    }

    fn attempt_to_engage(&mut self, tick: &Tick, lost_control: bool) {
        if matches!(self.state, State::Engaged | State::Stopped) {
            return;
        }
        let engage_inhibits = self.record.engage_inhibits;
        let is_refused =
            lost_control || self.overruns.are_too_many() || !engage_inhibits.is_empty();
        if is_refused || !self.actuators.are_ready(tick, &mut self.telemetry.events) {
            let kind = EventKind::EngageRefused { engage_inhibits };
            self.telemetry.events.push(tick, kind);
        } else {
            self.apply_input(Input::Engage, tick);
        }
    }

    /// Enters failsafe.
    pub(crate) fn fail(&mut self, cause: Cause, tick: &Tick) {
        self.apply_input(Input::Fault(cause), tick);
    }

    /// Leaves failsafe: its time is over, or there are no safe outputs to send.
    pub(crate) fn end_failsafe(&mut self, tick: &Tick) {
        match self.after_failsafe {
            AfterRelease::Standby => self.apply_input(Input::FailsafeEnded, tick),
            AfterRelease::Stop => self.stop_for(Ending::FailsafeEnded, tick),
        }
    }

    /// Gives control back without a failsafe; what follows is what follows a
    /// failsafe.
    fn release_at_once(&mut self, conditions: Flags, tick: &Tick) {
        let kind = EventKind::ReleasedAtOnce { conditions };
        self.telemetry.events.push(tick, kind);
        match self.after_failsafe {
            AfterRelease::Standby => self.apply_input(Input::ReleaseNow, tick),
            AfterRelease::Stop => self.stop_for(Ending::ReleasedAtOnce, tick),
        }
    }

    pub(crate) fn stop_for(&mut self, ending: Ending, tick: &Tick) {
        self.end_by(ending);
        self.apply_input(Input::Stop, tick);
    }

    /// Applies an input to the transition table, and performs the actions of the
    /// transition.
    pub(crate) fn apply_input(&mut self, input: Input, tick: &Tick) {
        let from = self.state;
        let to = from.after(input, self.switch_off);
        if to == from {
            return;
        }
        self.enter(to, tick);
        match to {
            State::Engaged => {
                self.record.engage_inhibits = Flags::NONE;
                if input == Input::Recovered {
                    self.controller.recover(tick, &self.measurements);
                } else {
                    self.controller.engage(tick, &self.measurements);
                }
            }
            State::Failsafe(cause) => {
                self.failsafe_since = tick.scheduled;
                self.failsafes += 1;
                self.last_failsafe = Some(cause);
            }
            State::Standby | State::Stopped => {
                self.release(tick, ReleaseReport::Always);
                if from.holds_control() {
                    self.controller.disengage();
                }
            }
        }
    }

    /// Ends the loop from outside a tick's decisions. Does not call the
    /// controller: it may be the part that panicked.
    pub(crate) fn stop_with(&mut self, ending: Ending) {
        let at = self.record.tick;
        match ending {
            Ending::Panicked(_) => self.telemetry.events.push(&at, EventKind::Panicked),
            Ending::TimerFailed(_) => self.telemetry.events.push(&at, EventKind::TimerFailed),
            _ => {}
        }
        self.end_by(ending);
        self.enter(self.state.after(Input::Stop, self.switch_off), &at);
        self.release(&at, ReleaseReport::Always);
    }

    /// Keeps the first reason to end, except that a later panic replaces it.
    pub(crate) fn end_by(&mut self, ending: Ending) {
        let keep = match &self.ending {
            None => false,
            Some(Ending::Panicked(_)) => true,
            Some(_) => !matches!(ending, Ending::Panicked(_)),
        };
        if !keep {
            self.ending = Some(ending);
        }
    }

    fn enter(&mut self, to: State, at: &Tick) {
        if self.state != to {
            let kind = EventKind::StateChanged {
                from: self.state,
                to,
            };
            self.telemetry.events.push(at, kind);
            self.state = to;
        }
    }

    /// Requests every actuator to give control back.
    pub(crate) fn release(&mut self, at: &Tick, report: ReleaseReport) {
        let panic = self.actuators.release(at, &mut self.telemetry.events).err();
        let ok = self.actuators.are_released();
        if ok || report == ReleaseReport::Always {
            self.telemetry.events.push(at, EventKind::Released { ok });
        }
        if let Some(message) = panic {
            self.telemetry.events.push(at, EventKind::Panicked);
            self.end_by(Ending::Panicked(message));
            self.enter(State::Stopped, at);
        }
    }
}
