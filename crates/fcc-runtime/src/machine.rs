//! The loop without its thread: one call, one tick.

use std::time::Duration;

use fcc_core::framework::{
    AfterRelease, Cause, Controller, EventKind, Flags, Input, LoopCommand, Record, RecordOf,
    StageTimes, State, Tick, Time,
};
use fcc_timer::{Expiry, Timer, TimerError, TimingStats, Wake, usage};
use rtrb::{Consumer, RingBuffer};

use crate::actuators::Actuators;
use crate::commands;
use crate::config::{LoopConfig, Parts};
use crate::heartbeat::Heartbeat;
use crate::link::{CommandSender, Link, MessageReceiver, StopHandle};
use crate::overload::Load;
use crate::overruns::Overruns;
use crate::panics;
use crate::report::{Ending, LoopReport};
use crate::sensors::Sensors;
use crate::stopwatch::Stopwatch;
use crate::switch::EngageSwitch;
use crate::telemetry_producer::{EVENT_SLOTS, TelemetryProducer};

/// The loop without its thread.
///
/// [`Loop`](crate::Loop) runs one on a real clock. Hold one yourself to run in
/// lockstep with a simulated plant: on a timer that never waits, each
/// [`step`](Self::step) is a tick of the same code. Dropping a machine
/// releases the actuators.
pub struct Machine<C: Controller> {
    pub(crate) timer: Box<dyn Timer>,
    pub(crate) period_s: f64,
    pub(crate) sensors: Sensors<C::Measurements>,
    /// It may be large, and the machine is moved to its thread.
    pub(crate) controller: Box<C>,
    pub(crate) actuators: Actuators<C::Outputs>,

    pub(crate) switch_off: AfterRelease,
    pub(crate) command_needs_switch: bool,
    pub(crate) failsafe_hold: Duration,
    pub(crate) after_failsafe: AfterRelease,

    pub(crate) commands: Consumer<LoopCommand<C::Command>>,
    pub(crate) telemetry: TelemetryProducer<C>,
    pub(crate) stop: StopHandle,
    heartbeat: Heartbeat,

    pub(crate) state: State,
    pub(crate) switch: EngageSwitch,
    /// The controller's mode in the last tick.
    pub(crate) mode: u8,
    /// The conditions reported last.
    pub(crate) conditions: Flags,
    pub(crate) measurements: C::Measurements,
    pub(crate) failsafe_since: Time,
    /// When a release began that is being prepared.
    pub(crate) stopping_since: Time,
    /// What that release follows; a commanded stop if there is none.
    pub(crate) release_by: Option<Input>,
    pub(crate) record: RecordOf<C>,
    pub(crate) overruns: Overruns,
    pub(crate) load: Load,

    pub(crate) timing: TimingStats,
    pub(crate) ticks: u64,
    pub(crate) failsafes: u64,
    pub(crate) last_failsafe: Option<Cause>,
    pub(crate) ending: Option<Ending>,
    cpu_at_start_ns: i64,
    faults_at_start: Option<u64>,
}

impl<C: Controller> Machine<C> {
    /// Assembles the parts, in [`State::Standby`]. All the loop's memory is
    /// allocated here.
    ///
    /// # Errors
    /// When the timer's period cannot be kept statistics of.
    pub fn new(parts: Parts<C>, config: &LoopConfig) -> Result<(Self, Link<C>), TimerError> {
        let (commands_in, commands) = RingBuffer::new(config.commands_capacity.max(1));
        let (messages, messages_out) =
            RingBuffer::new(config.messages_capacity.max(1).saturating_add(EVENT_SLOTS));
        let stop = StopHandle::default();
        let heartbeat = Heartbeat::default();
        let link = Link {
            commands: CommandSender::new(commands_in),
            messages: MessageReceiver::new(messages_out),
            stop: stop.clone(),
            heartbeat: heartbeat.clone(),
        };
        let period = parts.timer.period();
        let mode = parts.controller.mode();
        let machine = Self {
            timer: parts.timer,
            period_s: period.as_secs_f64(),
            sensors: Sensors::new(parts.sensors),
            controller: Box::new(parts.controller),
            actuators: Actuators::new(parts.actuators),
            switch_off: config.switch_off,
            command_needs_switch: config.command_needs_switch,
            failsafe_hold: config.failsafe_hold,
            after_failsafe: config.after_failsafe,
            commands,
            telemetry: TelemetryProducer::new(messages),
            stop,
            heartbeat,
            state: State::Standby,
            switch: EngageSwitch::new(config.switch_max_age),
            mode,
            conditions: Flags::NONE,
            measurements: C::Measurements::default(),
            failsafe_since: Time::NEVER,
            stopping_since: Time::NEVER,
            release_by: None,
            record: Record::new(Tick::default(), State::Standby),
            overruns: Overruns::new(config.budget, period),
            load: Load::new(config.overload, period),
            timing: TimingStats::new(period)?,
            ticks: 0,
            failsafes: 0,
            last_failsafe: None,
            ending: None,
            cpu_at_start_ns: 0,
            faults_at_start: None,
        };
        Ok((machine, link))
    }

    /// Starts the timer; to be called once, on the thread that will step.
    ///
    /// # Errors
    /// The timer's error.
    pub fn start(&mut self) -> Result<(), TimerError> {
        self.cpu_at_start_ns = usage::thread_cpu_ns();
        self.timer.start()?;
        self.heartbeat.begin();
        Ok(())
    }

    /// Counts the page faults of the calling thread from here on; without this,
    /// as in lockstep, none are counted.
    pub(crate) fn count_page_faults(&mut self) {
        self.faults_at_start = Some(usage::page_faults().all());
    }

    /// Page faults since they have been counted.
    fn page_faults(&self) -> Option<u64> {
        let before = self.faults_at_start?;
        Some(usage::page_faults().all().saturating_sub(before))
    }

    /// Waits for the timer and performs one tick; returns the state after it.
    /// A timer that fails or ends stops the machine.
    pub fn step(&mut self) -> State {
        if self.state == State::Stopped {
            return self.state;
        }
        loop {
            match panics::caught(|| self.wait()) {
                Ok(Ok(Some(expiry))) => return self.tick(expiry),
                Ok(Ok(None)) => continue,
                Ok(Err(TimerError::Ended)) => self.stop_with(Ending::TimerEnded),
                Ok(Err(error)) => self.stop_with(Ending::TimerFailed(error)),
                Err(message) => self.stop_with(Ending::Panicked(message)),
            }
            return self.state;
        }
    }

    /// Waits for the deadline, or returns `None` after a warm-up before it.
    fn wait(&mut self) -> Result<Option<Expiry>, TimerError> {
        self.timer.relieve(self.load.relief())?;
        match self.timer.wait_or_warm_up()? {
            Wake::Deadline(expiry) => Ok(Some(expiry)),
            Wake::WarmUp(expiry) => {
                let tick = self.tick_of(&expiry);
                self.warm_up(&tick);
                Ok(None)
            }
        }
    }

    /// Runs the code of the coming tick without effect, in the tick's command, so
    /// that it finds its code and data in the caches.
    fn warm_up(&self, tick: &Tick) {
        self.sensors.warm_up(tick);
        self.controller.warm_up(tick, &self.measurements);
        if self.state.holds_control() {
            self.actuators.warm_up(tick, &self.record.outputs);
        }
    }

    fn tick_of(&self, expiry: &Expiry) -> Tick {
        Tick {
            number: expiry.number,
            scheduled: Time::from_nanos(expiry.scheduled_ns),
            woke: Time::from_nanos(expiry.woke_ns),
            missed: expiry.missed,
            dt_s: self.period_s * (expiry.missed + 1) as f64,
        }
    }

    /// Performs the tick of a deadline; returns the state after it. Allocates
    /// nothing and never waits, except in a tick in which a part panics.
    ///
    /// A panic in a part stops the machine and releases the actuators; it does
    /// not leave this call.
    pub fn tick(&mut self, expiry: Expiry) -> State {
        self.perform(expiry, None)
    }

    /// Repeats a recorded tick with the recorded stage times, so that its
    /// overruns are those of the recording.
    pub fn tick_again(&mut self, expiry: Expiry, stages: StageTimes) -> State {
        self.perform(expiry, Some(stages))
    }

    fn perform(&mut self, expiry: Expiry, recorded: Option<StageTimes>) -> State {
        if self.state == State::Stopped {
            return self.state;
        }
        self.heartbeat.beat();
        let tick = self.tick_of(&expiry);
        self.record = Record::new(tick, self.state);
        self.overruns.begin(&tick, &mut self.telemetry.events);
        if recorded.is_none() {
            self.load.take(&tick, &expiry, &mut self.telemetry.events);
        }
        if let Err(message) = panics::caught(|| self.run_stages(&tick)) {
            self.stop_with(Ending::Panicked(message));
        }
        if let Some(stages) = recorded {
            self.record.stages = stages;
        }
        self.overruns
            .end(&tick, &self.record.stages, &mut self.telemetry.events);
        self.ticks += 1;
        self.timing.record(&expiry);
        self.record.early_wake_ns = expiry.early_wake_ns;
        self.send_record();
        self.state
    }

    /// The stages of a tick: everything between the wake-up and the last actuator
    /// write.
    fn run_stages(&mut self, tick: &Tick) {
        let command = commands::read(
            &mut self.commands,
            &mut *self.controller,
            tick,
            &mut self.telemetry.events,
        );

        let mut stopwatch = Stopwatch::start(&*self.timer);
        self.sensors.sample(
            tick,
            &mut self.measurements,
            &mut *self.controller,
            &mut self.telemetry.events,
        );
        self.record.stages.sensors_ns = stopwatch.lap(&*self.timer);

        self.controller.estimate(tick, &self.measurements);
        for notice in self.controller.notices() {
            let kind = EventKind::Noticed(*notice);
            self.telemetry.events.push(tick, kind);
        }
        self.record.stages.estimate_ns = stopwatch.lap(&*self.timer);

        self.decide(tick, command);

        stopwatch.lap(&*self.timer);
        if let Some(outputs) = self.compute_outputs(tick, &mut stopwatch) {
            self.record.stages.control_ns = stopwatch.lap(&*self.timer);
            self.record.outputs = outputs;
            if !self.controller.withholds_outputs(tick, &self.measurements) {
                self.record.sent = true;
                self.actuators
                    .apply(tick, &outputs, &mut self.telemetry.events);
            }
            self.record.stages.actuators_ns = stopwatch.lap(&*self.timer);
        } else {
            stopwatch.lap(&*self.timer);
        }
        self.record.stages.total_ns = stopwatch.since(tick.woke.as_nanos());
        self.record.estimate = self.controller.estimated();
        self.record.setpoints = self.controller.setpoints();
        self.report_mode(tick);
        self.report_conditions(tick);
    }

    /// Computes the outputs for the present state; never returns invalid ones.
    fn compute_outputs(&mut self, tick: &Tick, stopwatch: &mut Stopwatch) -> Option<C::Outputs> {
        if self.state == State::Engaged {
            self.controller.guide(tick, &self.measurements);
            self.record.stages.guide_ns = stopwatch.lap(&*self.timer);
            let outputs = self.controller.control(tick, &self.measurements);
            if self.controller.outputs_are_valid(&outputs) {
                return Some(outputs);
            }
            self.fail(Cause::InvalidOutput, tick);
        }
        if let State::Failsafe(_) = self.state {
            let outputs = self.controller.failsafe(tick, &self.measurements);
            if self.controller.outputs_are_valid(&outputs) {
                return Some(outputs);
            }
            // There are no safe outputs to send, so control is released.
            self.end_failsafe(tick);
        }
        None
    }

    /// Completes this tick's record and sends it with the tick's events.
    fn send_record(&mut self) {
        self.record.state = self.state.into();
        self.record.measurements = self.measurements;
        self.record.sensor_faults = self.sensors.faults();
        self.record.actuator_faults = self.actuators.faults();
        self.record.records_dropped = self.telemetry.records_dropped();
        self.record.overruns = self.overruns.total();
        // A system call of 0.2 µs, after the last actuator write: in each tick,
        // so that a fault is in the record of the tick that caused it.
        self.record.page_faults = self.page_faults().unwrap_or(0);
        self.telemetry.send(&self.record);
    }

    /// The present state.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The record of the last tick.
    pub const fn record(&self) -> &RecordOf<C> {
        &self.record
    }

    /// What the loop runs.
    pub const fn controller(&self) -> &C {
        &self.controller
    }

    /// Ends the loop, if it has not ended, and returns its report.
    pub fn finish(mut self) -> LoopReport {
        let page_faults = self.page_faults();
        self.close();
        let cpu_ns = usage::thread_cpu_ns().saturating_sub(self.cpu_at_start_ns);
        LoopReport {
            ending: self.ending.take().unwrap_or(Ending::Finished),
            ticks: self.ticks,
            timer: self.timer.name(),
            timing: self.timing.summary(),
            failsafes: self.failsafes,
            last_failsafe: self.last_failsafe,
            released: self.actuators.are_released(),
            sensor_faults: self.sensors.faults(),
            actuator_faults: self.actuators.faults(),
            overruns: self.overruns.total(),
            unslept: self.load.unslept(),
            records_dropped: self.telemetry.records_dropped(),
            events_dropped: self.telemetry.events_dropped(),
            cpu_time: Duration::from_nanos(u64::try_from(cpu_ns).unwrap_or(0)),
            page_faults,
            granted: None,
        }
    }

    fn close(&mut self) {
        let at = self.record.tick;
        if self.state != State::Stopped {
            self.stop_with(Ending::Finished);
        } else if !self.actuators.are_released() {
            self.release(&at, ReleaseReport::OnSuccess);
        }
        self.telemetry.close(&at);
        self.heartbeat.end();
    }
}

impl<C: Controller> Drop for Machine<C> {
    fn drop(&mut self) {
        self.close();
    }
}

/// Which result of a release is reported.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ReleaseReport {
    Always,
    /// For repeated attempts: the failure was reported already.
    OnSuccess,
}
