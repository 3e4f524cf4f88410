//! `[loop]`, `[realtime]`, `[engage]` and `[failsafe]`: the loop's part of the
//! configuration.

use std::time::Duration;

use fcc_core::framework::AfterRelease;
use fcc_fixed_wing::{AutopilotConfig, FailsafeConfig, FailsafeEnd, StickTakeover};
use fcc_timer::{CpuRequest, EarlyWake, RealtimeRequest, Strictness, Timer, TimerError, TimerKind};
use serde::{Deserialize, Serialize};

use super::{CpuChoice, EarlyWakeChoice};

/// `[loop]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct LoopSection {
    /// Ticks per second.
    pub rate_hz: f64,
    /// Which timer wakes the loop.
    #[serde(with = "super::as_text")]
    pub timer: TimerKind,
    /// Waking before the deadline, to begin on time.
    pub early_wake: EarlyWakeSection,
}

impl Default for LoopSection {
    fn default() -> Self {
        Self {
            rate_hz: 40.0,
            timer: TimerKind::Timerfd,
            early_wake: EarlyWakeSection::default(),
        }
    }
}

/// The minimum capacity of a ring, ticks.
const FEWEST_TICKS: usize = 256;

impl LoopSection {
    /// The capacity of a ring: the ticks of this many seconds, at most `most`.
    /// All of it is allocated at the start.
    pub(crate) fn ticks_in(&self, seconds: f64, most: usize) -> usize {
        let ticks = (seconds * self.rate_hz).ceil() as usize;
        ticks.min(most).max(FEWEST_TICKS)
    }

    /// The timer that wakes the loop, not yet started.
    ///
    /// # Errors
    /// When the operating system refuses, or a value is out of range.
    pub fn build_timer(&self) -> Result<Box<dyn Timer>, TimerError> {
        if self.early_wake.enabled == EarlyWakeChoice::Off {
            return self.timer.build(self.period());
        }
        let early = EarlyWake::from(&self.early_wake);
        self.timer.build_early(self.period(), &early)
    }

    /// Time between ticks, to the nanosecond.
    pub fn period(&self) -> Duration {
        Duration::from_secs_f64(1.0 / self.rate_hz)
    }
}

/// `[loop.early_wake]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct EarlyWakeSection {
    /// Whether the timer wakes before the deadline and spins the rest.
    pub enabled: EarlyWakeChoice,
    /// The shortest margin.
    pub min_us: f64,
    /// The longest margin.
    pub max_us: f64,
    /// Added to the measured margin.
    pub guard_us: f64,
    /// The share of wake-ups that is to be before the deadline.
    pub quantile: f64,
    /// The largest share of a core that may be spent spinning.
    pub cpu_cap_percent: f64,
}

impl Default for EarlyWakeSection {
    fn default() -> Self {
        let early = EarlyWake::default();
        Self {
            enabled: EarlyWakeChoice::Auto,
            min_us: early.min.as_secs_f64() * 1e6,
            max_us: early.max.as_secs_f64() * 1e6,
            guard_us: early.guard.as_secs_f64() * 1e6,
            quantile: early.quantile,
            cpu_cap_percent: 100.0 * early.cpu_cap,
        }
    }
}

impl From<&EarlyWakeSection> for EarlyWake {
    fn from(section: &EarlyWakeSection) -> Self {
        let time = |us: f64| Duration::from_secs_f64(us * 1e-6);
        Self {
            min: time(section.min_us),
            max: time(section.max_us),
            quantile: section.quantile,
            guard: time(section.guard_us),
            cpu_cap: section.cpu_cap_percent / 100.0,
        }
    }
}

/// `[realtime]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct RealtimeSection {
    /// `SCHED_FIFO` priority of the loop's thread; 0 leaves it to the ordinary
    /// scheduler.
    pub priority: u8,
    /// The CPU that the loop's thread is bound to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu: Option<CpuChoice>,
    /// The permitted wake-up latency of CPUs from idle states.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu_dma_latency_us: Option<u32>,
    /// Whether to keep the process' memory from being paged out.
    pub lock_memory: bool,
    /// How much stack to touch before the first tick: navigation by raw readings that tries
    /// another filter takes some 340 KiB.
    pub stack_prefault_kib: u32,
    /// By how much the kernel may delay a wake-up to save power.
    pub timer_slack_ns: u64,
    /// Whether a denied request ends the program at once.
    pub strict: bool,
}

impl Default for RealtimeSection {
    fn default() -> Self {
        Self {
            priority: 80,
            cpu: None,
            cpu_dma_latency_us: None,
            lock_memory: true,
            stack_prefault_kib: 384,
            timer_slack_ns: 1,
            strict: false,
        }
    }
}

impl From<&RealtimeSection> for RealtimeRequest {
    fn from(section: &RealtimeSection) -> Self {
        Self {
            priority: (section.priority > 0).then_some(section.priority),
            nice: None,
            cpu: section.cpu.map(CpuRequest::from),
            cpu_dma_latency_us: section.cpu_dma_latency_us,
            lock_memory: section.lock_memory,
            stack_prefault_bytes: section.stack_prefault_kib as usize * 1_024,
            timer_slack_ns: (section.timer_slack_ns > 0).then_some(section.timer_slack_ns),
            strictness: if section.strict {
                Strictness::Strict
            } else {
                Strictness::Warn
            },
        }
    }
}

/// What follows a release: standby, or the end of the program.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Then {
    /// Release the controls and stay in standby.
    #[default]
    Standby,
    /// Release the controls and end the program.
    Stop,
}

impl From<Then> for AfterRelease {
    fn from(then: Then) -> Self {
        match then {
            Then::Standby => Self::Standby,
            Then::Stop => Self::Stop,
        }
    }
}

/// `[engage]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct EngageSection {
    /// The effect of switching off.
    pub switch_off: Then,
    /// A command engages only while the engage switch, if there is one, is on.
    pub command_needs_switch: bool,
    /// The pilot's controls end the engagement beyond this deflection of any axis
    /// from where it rests, of full deflection; without it, they never do.
    pub stick_takeover: Option<f64>,
    /// How long they must be beyond it.
    pub stick_takeover_s: f64,
    /// Engage beyond 60° of bank or pitch or in a spin, and recover from it first.
    pub permit_upset: bool,
}

impl Default for EngageSection {
    fn default() -> Self {
        Self {
            switch_off: Then::Standby,
            command_needs_switch: true,
            stick_takeover: None,
            stick_takeover_s: 0.2,
            permit_upset: false,
        }
    }
}

impl EngageSection {
    /// When the pilot's controls end the engagement.
    pub(super) fn takeover(&self) -> Option<StickTakeover> {
        let after = Duration::from_secs_f64(self.stick_takeover_s);
        let threshold = self.stick_takeover?;
        Some(StickTakeover { threshold, after })
    }
}

/// `[release]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReleaseSection {
    /// How long at most the aircraft is levelled and trimmed before a release
    /// that can wait.
    pub level_and_trim_s: f64,
}

impl Default for ReleaseSection {
    fn default() -> Self {
        let core = AutopilotConfig::default();
        Self {
            level_and_trim_s: core.level_and_trim.as_secs_f64(),
        }
    }
}

/// `[failsafe]`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct FailsafeSection {
    /// Readings older than this count as a loss of their sensor.
    pub sensor_max_age_ms: u64,
    /// If nothing at all arrives from a simulator, it is waited for as long as
    /// this; it may have stopped for a moment, and the aircraft with it.
    pub all_silent_s: f64,
    /// Readings that stay the same to the last bit for this long while the
    /// aircraft moves count as a loss of their sensor; 0 for never.
    pub sensor_frozen_s: f64,
    /// How long wings are held level before the controls are released.
    pub hold_s: f64,
    /// What follows after that.
    pub then: Then,
    /// How long at most is flown without a quantity.
    pub degraded_s: f64,
    /// What was flown before is continued when all has been good for so long.
    pub recover_s: f64,
    /// What ends a failsafe.
    pub end: End,
}

/// What ends a failsafe in which nothing sound can be held.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// Release the controls.
    #[default]
    Release,
    /// Glide in a gentle turn with idle throttle.
    Glide,
}

impl From<&FailsafeSection> for FailsafeConfig {
    fn from(section: &FailsafeSection) -> Self {
        Self {
            end: match section.end {
                End::Release => FailsafeEnd::Release,
                End::Glide => FailsafeEnd::Glide,
            },
            hold: Duration::from_secs_f64(section.hold_s),
            degraded: Duration::from_secs_f64(section.degraded_s),
            recovered_after: Duration::from_secs_f64(section.recover_s),
            ..Self::default()
        }
    }
}

impl Default for FailsafeSection {
    fn default() -> Self {
        Self {
            sensor_max_age_ms: 250,
            all_silent_s: 30.0,
            sensor_frozen_s: 2.0,
            hold_s: 5.0,
            then: Then::Standby,
            degraded_s: 600.0,
            recover_s: 2.0,
            end: End::Release,
        }
    }
}
