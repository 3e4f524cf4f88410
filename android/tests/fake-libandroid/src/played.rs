//! Sensors and queues, and the events that are due.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::Deserialize;

/// `ASensorEvent`, as `android/sensor.h` has it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    version: i32,
    sensor: i32,
    of_type: i32,
    reserved0: i32,
    timestamp: i64,
    data: [f32; 16],
    flags: u32,
    reserved1: [i32; 3],
}

/// How a sensor is played.
#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(clippy::struct_excessive_bools, reason = "each is another fault")]
pub(crate) struct Played {
    /// Whether the phone has it.
    is_there: bool,
    /// Whether it refuses to be enabled.
    refuses: bool,
    /// As fast as it can.
    min_delay_us: i32,
    /// Events in a second; as many as it is asked for without.
    rate_hz: Option<f64>,
    /// None by itself: it is fed.
    is_fed: bool,
    /// Nothing comes any more.
    is_stalled: bool,
    values: Vec<f32>,
    /// `ASENSOR_STATUS_...`, behind three values.
    status: Option<i8>,
    /// From the measured event to the app.
    latency_us: u64,
    /// It may come later by this, evenly distributed.
    jitter_us: u64,
    /// So often, for so long, nothing is measured.
    gap_ms: Option<[u64; 2]>,
    /// Its clock is ahead of `CLOCK_MONOTONIC` by this.
    ahead_ns: i64,
}

impl Default for Played {
    fn default() -> Self {
        Self {
            is_there: true,
            refuses: false,
            min_delay_us: 2_500,
            rate_hz: None,
            is_fed: false,
            is_stalled: false,
            values: Vec::new(),
            status: None,
            latency_us: 3_000,
            jitter_us: 0,
            gap_ms: None,
            ahead_ns: 0,
        }
    }
}

/// An event from a test.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Fed {
    stamp_ns: i64,
    values: Vec<f32>,
}

/// A sensor that a queue has enabled.
struct Enabled {
    period_ns: u64,
    /// When its next event is measured.
    next_ns: u64,
    /// Of the generator of its jitter.
    seed: u64,
}

struct Queue {
    looper: usize,
    package: String,
    enabled: BTreeMap<i32, Enabled>,
    /// With the times at which they arrive.
    under_way: VecDeque<(u64, Event)>,
}

#[derive(Default)]
struct State {
    sensors: BTreeMap<(String, i32), Played>,
    queues: BTreeMap<usize, Queue>,
    last_queue: usize,
}

/// All that is played in this process.
pub(crate) struct World {
    state: Mutex<Option<State>>,
    changed: Condvar,
}

/// All that is played in this process.
pub(crate) static PLAYED: World = World {
    state: Mutex::new(None),
    changed: Condvar::new(),
};

/// `CLOCK_MONOTONIC`, ns.
fn now_ns() -> u64 {
    let mut now = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: there is room for the time.
    #[allow(unsafe_code, reason = "a clock of the operating system")]
    unsafe {
        libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut now);
    }
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

impl State {
    fn sensor(&self, package: &str, of_type: i32) -> Played {
        let given = self.sensors.get(&(package.to_owned(), of_type)).cloned();
        given.unwrap_or_else(|| Played {
            is_fed: std::env::var_os("FAKE_LIBANDROID_PORT").is_some(),
            ..Played::default()
        })
    }

    /// Lets everything be measured that is due; when the next event arrives.
    fn play(&mut self, queue: usize, now_ns: u64) -> Option<u64> {
        let mut queue_state = self.queues.remove(&queue)?;
        let mut due_ns = None;
        let Queue {
            package,
            enabled,
            under_way,
            ..
        } = &mut queue_state;
        for (of_type, enabled) in enabled {
            let played = self.sensor(package, *of_type);
            if played.is_fed {
                continue;
            }
            let period_ns = match played.rate_hz {
                Some(rate_hz) => (1e9 / rate_hz) as u64,
                None => enabled.period_ns.max(played.min_delay_us as u64 * 1_000),
            };
            while enabled.next_ns + played.latency_us * 1_000 <= now_ns {
                let taken_ns = enabled.next_ns;
                enabled.next_ns += period_ns.max(1);
                let is_in_gap = played.gap_ms.is_some_and(|[every_ms, lasts_ms]| {
                    taken_ns / 1_000_000 % every_ms.max(1) < lasts_ms
                });
                if played.is_stalled || is_in_gap {
                    continue;
                }
                // A multiplicative generator: Park and Miller (1988).
                enabled.seed = enabled.seed * 48_271 % 2_147_483_647;
                let jitter_ns = enabled.seed % (played.jitter_us * 1_000 + 1);
                let stamp_ns = (taken_ns as i64).wrapping_add(played.ahead_ns);
                let event = Event::new(*of_type, stamp_ns, &played.values, played.status);
                let arrives_ns = taken_ns + played.latency_us * 1_000 + jitter_ns;
                // None overtakes another.
                let last_ns = under_way.back().map_or(0, |(at, _)| *at);
                under_way.push_back((arrives_ns.max(last_ns), event));
            }
            let next_ns = enabled.next_ns + played.latency_us * 1_000;
            due_ns = Some(due_ns.map_or(next_ns, |due: u64| due.min(next_ns)));
        }
        if let Some((arrives_ns, _)) = under_way.front() {
            due_ns = Some(due_ns.map_or(*arrives_ns, |due| due.min(*arrives_ns)));
        }
        self.queues.insert(queue, queue_state);
        due_ns
    }
}

impl Event {
    fn new(of_type: i32, timestamp: i64, values: &[f32], status: Option<i8>) -> Self {
        let mut data = [0.0; 16];
        for (place, value) in data.iter_mut().zip(values) {
            *place = *value;
        }
        if let (Some(status), [_, _, _, fourth, ..]) = (status, &mut data) {
            *fourth = f32::from_ne_bytes([status as u8, 0, 0, 0]);
        }
        Self {
            version: size_of::<Self>() as i32,
            sensor: of_type,
            of_type,
            reserved0: 0,
            timestamp,
            data,
            flags: 0,
            reserved1: [0; 3],
        }
    }
}

impl World {
    fn lock(&self) -> MutexGuard<'_, Option<State>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<T>(&self, act: impl FnOnce(&mut State) -> T) -> T {
        let done = act(self.lock().get_or_insert_default());
        self.changed.notify_all();
        done
    }

    pub(crate) fn set(&self, package: &str, of_type: i32, sensor: Played) {
        self.with(|state| state.sensors.insert((package.to_owned(), of_type), sensor));
    }

    /// An event for all queues that have enabled the sensor.
    pub(crate) fn feed(&self, package: &str, of_type: i32, fed: &Fed) {
        let event = Event::new(of_type, fed.stamp_ns, &fed.values, None);
        self.with(|state| {
            for queue in state.queues.values_mut() {
                if queue.package == package && queue.enabled.contains_key(&of_type) {
                    queue.under_way.push_back((0, event));
                }
            }
        });
    }

    /// How a sensor is played, if the phone has it.
    pub(crate) fn sensor(&self, package: &str, of_type: i32) -> Option<Played> {
        let played = self.with(|state| state.sensor(package, of_type));
        played.is_there.then_some(played)
    }

    /// The number of a new queue: 1 or more.
    pub(crate) fn create_queue(&self, package: &str, looper: usize) -> usize {
        self.with(|state| {
            state.last_queue += 1;
            let queue = Queue {
                looper,
                package: package.to_owned(),
                enabled: BTreeMap::new(),
                under_way: VecDeque::new(),
            };
            state.queues.insert(state.last_queue, queue);
            state.last_queue
        })
    }

    pub(crate) fn destroy_queue(&self, queue: usize) -> bool {
        self.with(|state| state.queues.remove(&queue).is_some())
    }

    /// Enables a sensor, or sets its rate; false if it refuses.
    pub(crate) fn enable(&self, queue: usize, of_type: i32, period_us: u64) -> bool {
        self.with(|state| {
            let Some(package) = state.queues.get(&queue).map(|queue| queue.package.clone()) else {
                return false;
            };
            if state.sensor(&package, of_type).refuses {
                return false;
            }
            if let Some(queue) = state.queues.get_mut(&queue) {
                let enabled = queue.enabled.entry(of_type).or_insert_with(|| Enabled {
                    period_ns: 0,
                    next_ns: now_ns(),
                    seed: 1,
                });
                enabled.period_ns = period_us * 1_000;
            }
            true
        })
    }

    pub(crate) fn disable(&self, queue: usize, of_type: i32) -> bool {
        self.with(|state| {
            let queue = state.queues.get_mut(&queue);
            queue.is_some_and(|queue| queue.enabled.remove(&of_type).is_some())
        })
    }

    /// Waits until a queue of a looper has events; whether one has.
    pub(crate) fn wait(&self, looper: usize, at_most: Duration) -> bool {
        let until = Instant::now() + at_most;
        let mut guard = self.lock();
        loop {
            let state = guard.get_or_insert_default();
            let of_looper =
                |(number, queue): (&usize, &Queue)| (queue.looper == looper).then_some(*number);
            let queues: Vec<usize> = state.queues.iter().filter_map(of_looper).collect();
            let now_ns = now_ns();
            let due = queues.iter().filter_map(|queue| state.play(*queue, now_ns));
            let due_ns = due.min();
            let arrived = |queue: &usize| {
                let first = state
                    .queues
                    .get(queue)
                    .and_then(|queue| queue.under_way.front());
                first.is_some_and(|(arrives_ns, _)| *arrives_ns <= now_ns)
            };
            if queues.iter().any(arrived) {
                return true;
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return false;
            }
            let due = due_ns.map_or(left, |due| Duration::from_nanos(due.saturating_sub(now_ns)));
            let waited = self.changed.wait_timeout(guard, left.min(due));
            guard = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Takes events that have arrived.
    pub(crate) fn take(&self, queue: usize, most: usize) -> Vec<Event> {
        let mut guard = self.lock();
        let state = guard.get_or_insert_default();
        let now_ns = now_ns();
        state.play(queue, now_ns);
        let mut taken = Vec::new();
        if let Some(queue) = state.queues.get_mut(&queue) {
            while taken.len() < most && queue.under_way.front().is_some_and(|(at, _)| *at <= now_ns)
            {
                taken.extend(queue.under_way.pop_front().map(|(_, event)| event));
            }
        }
        taken
    }
}

impl Played {
    pub(crate) const fn min_delay_us(&self) -> i32 {
        self.min_delay_us
    }
}
