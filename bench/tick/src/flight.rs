//! A whole loop that flies a simulated X-Plane over loopback.

use std::time::Duration;

use fcc_core::framework::State;
use fcc_fixed_wing::{Autopilot, AutopilotConfig};
use fcc_runtime::{Link, LoopConfig, Machine, Parts};
use fcc_timer::{Expiry, ManualTimer, Timer, TimerError};
use fcc_xplane::XPlane;
use nix::time::{ClockId, clock_gettime};

use crate::PERIOD;
use crate::support::{FakeXPlane, SWITCH};

/// The autopilot engages after navigation has settled for a second.
const TICKS_TO_SETTLE: u32 = 80;

/// The whole loop, engaged, and the simulator on the other side of its socket.
/// Nothing waits: each call to the simulator sends a frame, and then a tick is
/// due.
pub struct Flight {
    pub(crate) simulator: FakeXPlane,
    pub(crate) machine: Machine<Autopilot>,
    link: Link<Autopilot>,
}

impl Flight {
    /// Engaged, with warm caches.
    ///
    /// # Panics
    /// When it cannot be assembled or does not engage.
    pub fn engaged() -> Self {
        let simulator = FakeXPlane::new();
        let (sensor, actuator) = XPlane::open(&simulator.config()).expect("no sockets");
        let parts = Parts {
            timer: Box::new(Unwaiting(ManualTimer::new(PERIOD).expect("a fair period"))),
            sensors: vec![Box::new(sensor)],
            controller: Autopilot::new(AutopilotConfig {
                // The simulator's values are constant, which must not be a
                // fault here.
                frozen_after: Duration::ZERO,
                ..AutopilotConfig::default()
            }),
            actuators: vec![Box::new(actuator)],
        };
        let (mut machine, link) =
            Machine::new(parts, &LoopConfig::default()).expect("a fair period");
        machine.start().expect("nothing to refuse");
        let mut flight = Self {
            simulator,
            machine,
            link,
        };
        for _ in 0..TICKS_TO_SETTLE {
            flight.frame();
            flight.tick();
        }
        flight.simulator.set(SWITCH, 1.0);
        for _ in 0..TICKS_TO_SETTLE {
            flight.frame();
            flight.tick();
        }
        assert_eq!(flight.machine.state(), State::Engaged, "does not engage");
        flight
    }

    /// Between two ticks: the simulator reads datagrams and sends a frame, and
    /// the loop's messages are fetched.
    pub fn frame(&mut self) {
        self.simulator.writes.clear();
        self.simulator.live(PERIOD.as_secs_f32());
        while self.link.messages.receive().is_some() {}
    }

    /// A tick, from its wake-up to its record in the ring.
    #[inline(never)]
    pub fn tick(&mut self) -> State {
        self.machine.step()
    }

    /// The loop.
    pub const fn machine(&self) -> &Machine<Autopilot> {
        &self.machine
    }
}

/// Ticks without waiting, but reads the kernel's clock for the time of each
/// stage, as a timer that waits does; the ticks' times are computed.
struct Unwaiting(ManualTimer);

impl Timer for Unwaiting {
    fn start(&mut self) -> Result<(), TimerError> {
        self.0.start()
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        self.0.wait()
    }

    fn period(&self) -> Duration {
        self.0.period()
    }

    fn now_ns(&self) -> i64 {
        // Read and not used: only its cost matters.
        let _ = std::hint::black_box(clock_gettime(ClockId::CLOCK_MONOTONIC));
        self.0.now_ns()
    }

    fn name(&self) -> &'static str {
        "unwaiting"
    }
}
