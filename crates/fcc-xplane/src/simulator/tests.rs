use super::*;

const SILENT_AFTER: Duration = Duration::from_millis(500);

/// A clock and our time, fed at 40 Hz.
#[derive(Clone)]
struct Bench {
    clock: SimulatorClock,
    now: Time,
    time_s: f64,
}

impl Bench {
    const TICK: Duration = Duration::from_millis(25);

    fn new() -> Self {
        Self {
            clock: SimulatorClock::new(SILENT_AFTER),
            now: Time::from_nanos(1_000_000_000),
            time_s: 100.0,
        }
    }

    fn receive(&mut self, report: SimulatorReport) -> SimulatorState {
        self.now = self.now + Self::TICK;
        self.clock.begin();
        self.clock.receive(self.now, report);
        self.clock.state(self.now)
    }

    /// Runs ticks in which the simulator's time runs at this pace.
    fn fly(&mut self, ticks: u32, pace: f64) -> SimulatorState {
        let mut state = SimulatorState::Silent;
        for _ in 0..ticks {
            self.time_s += 0.025 * pace;
            state = self.receive(SimulatorReport {
                time_s: Some(self.time_s),
                ..SimulatorReport::default()
            });
        }
        state
    }
}

#[test]
fn nothing_received_is_silence_and_the_first_report_ends_it() {
    let mut bench = Bench::new();
    assert_eq!(bench.clock.state(bench.now), SimulatorState::Silent);
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
    let later = bench.now + SILENT_AFTER;
    assert_eq!(bench.clock.state(later), SimulatorState::Running);
    let later = later + Duration::from_nanos(1);
    assert_eq!(bench.clock.state(later), SimulatorState::Silent);
}

#[test]
fn paused_is_not_stalled_and_continuing_is_not_slow() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    let time_s = Some(bench.time_s);
    let still = |paused| SimulatorReport {
        time_s,
        paused: Some(paused),
        ..SimulatorReport::default()
    };
    for _ in 0..400 {
        assert_eq!(bench.receive(still(true)), SimulatorState::Paused);
    }
    assert_eq!(bench.receive(still(false)), SimulatorState::Running);
    assert_eq!(bench.fly(200, 1.0), SimulatorState::Running);
}

#[test]
fn a_stopped_clock_is_stalled_after_a_quarter_of_a_second() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    // A quarter of a second short of a second is slow before it is stalled.
    assert_eq!(bench.fly(10, 0.0), SimulatorState::Slow);
    assert_eq!(bench.fly(1, 0.0), SimulatorState::Stalled);
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
}

#[test]
fn time_at_eight_tenths_is_slow_and_recovers() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    assert_eq!(bench.fly(120, 0.8), SimulatorState::Slow);
    assert_eq!(bench.fly(120, 0.93), SimulatorState::Slow, "hysteresis");
    assert_eq!(bench.fly(160, 1.0), SimulatorState::Running);
    assert_eq!(bench.fly(160, 0.93), SimulatorState::Running, "hysteresis");
}

#[test]
fn accelerated_time_is_neither_slow_nor_a_jump() {
    let mut bench = Bench::new();
    assert_eq!(bench.fly(400, 2.0), SimulatorState::Running);
    assert_eq!(bench.fly(400, 16.0), SimulatorState::Fast);
    assert_eq!(bench.fly(400, 2.0), SimulatorState::Running);
}

/// Ticks with this frame period, in which the simulator's time runs at this pace.
fn frames(bench: &mut Bench, ticks: u32, period_s: f64, pace: f64) -> SimulatorState {
    let mut state = SimulatorState::Silent;
    for _ in 0..ticks {
        bench.time_s += 0.025 * pace;
        state = bench.receive(SimulatorReport {
            time_s: Some(bench.time_s),
            frame_period_s: Some(period_s),
            ..SimulatorReport::default()
        });
    }
    state
}

#[test]
fn frames_longer_than_a_twentieth_of_a_second_are_slow_from_a_smaller_loss_on() {
    use SimulatorState::{Running, Slow};
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    assert_eq!(frames(&mut bench, 160, 0.049, 0.93), Running);
    bench.fly(160, 1.0);
    assert_eq!(frames(&mut bench, 160, 0.051, 0.97), Running);
    assert_eq!(frames(&mut bench, 160, 0.051, 0.93), Slow);
    assert_eq!(frames(&mut bench, 160, 0.048, 1.0), Slow, "hysteresis");
    assert_eq!(frames(&mut bench, 1, 0.030, 1.0), Running);
}

/// The frame period that X-Plane shows is smoothed, here over 0.5 s.
#[test]
fn a_single_freeze_is_not_slow() {
    for freeze_ticks in [3, 5, 9, 15, 19, 40, 160] {
        let mut bench = Bench::new();
        bench.fly(80, 1.0);
        let mut smoothed_s = f64::from(freeze_ticks) * 0.025;
        bench.now = bench.now + freeze_ticks * Bench::TICK;
        for tick in 0..240 {
            let state = frames(&mut bench, 1, smoothed_s, 1.0);
            let running = SimulatorState::Running;
            assert_eq!(state, running, "tick {tick} after {freeze_ticks}");
            smoothed_s += (0.017 - smoothed_s) * 0.05;
        }
    }
}

/// X-Plane makes no step longer than a twentieth of a second.
#[test]
fn three_frames_a_second_are_slow_also_without_a_frame_period() {
    for before in [1.0, 0.5] {
        let mut bench = Bench::new();
        bench.fly(120, before);
        for frame in 0..30 {
            bench.now = bench.now + 12 * Bench::TICK;
            bench.time_s += 0.05;
            let state = bench.receive(SimulatorReport {
                time_s: Some(bench.time_s),
                ..SimulatorReport::default()
            });
            let expected = if before < 1.0 || frame >= 4 {
                SimulatorState::Slow
            } else {
                state
            };
            assert_eq!(state, expected, "frame {frame} after a pace of {before}");
            // A position without a time, a tick after its frame.
            let state = bench.receive(SimulatorReport::default());
            assert_ne!(state, SimulatorState::Stalled);
        }
    }
}

#[test]
fn a_loaded_flight_is_a_jump_for_one_tick() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    bench.time_s = 0.0;
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Jumped);
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
    bench.time_s += 1.1;
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Jumped);
    assert_eq!(bench.fly(200, 1.0), SimulatorState::Running);
}

#[test]
fn a_datagram_overtaken_by_less_than_a_second_is_late() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    let (now, time_s) = (bench.now, bench.time_s);
    assert!(bench.clock.is_late(now, time_s - 0.01, false));
    assert!(bench.clock.is_late(now, time_s - 0.99, false));
    assert!(
        !bench.clock.is_late(now, time_s, false),
        "the same frame again"
    );
    assert!(!bench.clock.is_late(now, time_s + 0.01, false));
    // A flight loaded within its first second and paused there must not count
    // as late for ever.
    let later = now + LATE;
    assert!(!bench.clock.is_late(later, time_s - 0.5, false));
}

/// What was on its way when the silence began may arrive first after it.
#[test]
fn an_overtaken_datagram_after_a_silence_is_late_and_no_jump() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    let time_s = bench.time_s;
    bench.now = bench.now + Duration::from_millis(1_200);
    assert!(bench.clock.is_late(bench.now, time_s - 0.05, false));
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
    // A flight loaded in the silence, less than a second back, and paused.
    let time_s = bench.time_s - 0.5;
    bench.now = bench.now + Duration::from_secs(10);
    for _ in 0..16 {
        assert!(bench.clock.is_late(bench.now, time_s, false));
        bench.now = bench.now + Bench::TICK;
    }
    assert!(!bench.clock.is_late(bench.now, time_s, false));
    bench.time_s = time_s;
    assert_eq!(bench.fly(1, 0.0), SimulatorState::Jumped);
}

/// One that was overtaken by more than a second is dropped, too, and so are all
/// that arrive with it.
#[test]
fn a_jump_back_is_believed_with_a_second_time_that_continues_it() {
    for back_s in [1.2, 3.0, 100.0] {
        let mut bench = Bench::new();
        bench.fly(80, 1.0);
        for _ in 0..3 {
            let time_s = bench.time_s - back_s;
            assert!(bench.clock.is_late(bench.now, time_s, false));
            assert!(bench.clock.is_late(bench.now, time_s + 0.01, false));
            assert_eq!(bench.fly(100, 1.0), SimulatorState::Running);
        }
        // The flight loaded there is paused, or runs; or another is loaded.
        for runs_s in [0.0, 0.025] {
            let mut bench = bench.clone();
            let time_s = bench.time_s - back_s;
            assert!(bench.clock.is_late(bench.now, time_s, false));
            let later = bench.now + Bench::TICK;
            assert!(bench.clock.is_late(later, time_s - 2.0, false));
            let later = later + Bench::TICK;
            assert!(!bench.clock.is_late(later, time_s - 2.0 + runs_s, false));
        }
    }
}

/// A network held all back for five seconds, and delivers each of them in a second,
/// beside what is new.
#[test]
fn old_times_that_run_beside_the_present_one_are_late() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    bench.now = bench.now + Duration::from_secs(5);
    bench.time_s += 5.0;
    for _ in 0..40 {
        assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
        // X-Plane sends 20 times a second.
        for _ in 0..2 {
            bench.now = bench.now + Bench::TICK;
            bench.time_s += 0.025;
            for behind_s in [5.0, 4.0, 3.0, 2.0, 1.0] {
                assert!(
                    bench
                        .clock
                        .is_late(bench.now, bench.time_s - behind_s, false)
                );
            }
        }
    }
}

/// A network holds all back and delivers it in two ticks.
#[test]
fn a_backlog_that_arrives_in_two_ticks_is_neither_a_jump_nor_fast() {
    for held_s in [1.5, 4.0, 10.0] {
        let mut bench = Bench::new();
        bench.fly(80, 1.0);
        bench.now = bench.now + Duration::from_secs_f64(held_s);
        for _ in 0..2 {
            bench.time_s += 0.5 * held_s;
            assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
        }
        for _ in 0..200 {
            assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
        }
        // Afterwards a jump is one.
        bench.time_s += 1.1;
        assert_eq!(bench.fly(1, 1.0), SimulatorState::Jumped);
    }
    // Set forward in the gap.
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    bench.now = bench.now + Duration::from_secs(2);
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
    bench.time_s += 6.0;
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Jumped);
}

#[test]
fn silence_in_between_is_neither_a_jump_nor_slow() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    bench.now = bench.now + Duration::from_secs(10);
    bench.time_s += 10.0;
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
    // Ten seconds in which the simulator's time did not advance.
    bench.now = bench.now + Duration::from_secs(10);
    assert_eq!(bench.fly(1, 1.0), SimulatorState::Running);
    assert_eq!(bench.fly(200, 1.0), SimulatorState::Running);
}

#[test]
fn a_tenth_of_the_datagrams_lost_changes_nothing() {
    let mut bench = Bench::new();
    for tick in 1..=800 {
        bench.time_s += 0.025;
        if tick % 10 == 0 {
            bench.now = bench.now + Bench::TICK;
            continue;
        }
        let time_s = Some(bench.time_s);
        let report = SimulatorReport {
            time_s,
            ..SimulatorReport::default()
        };
        assert_eq!(
            bench.receive(report),
            SimulatorState::Running,
            "tick {tick}"
        );
    }
}

/// X-Plane shows what was an hour ago, backwards, and then continues.
#[test]
fn a_replay_is_a_state_and_its_clock_is_no_jump() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    let live_s = bench.time_s;
    let replays = |bench: &mut Bench, time_s, replaying| {
        bench.receive(SimulatorReport {
            time_s: Some(time_s),
            replaying: Some(replaying),
            ..SimulatorReport::default()
        })
    };
    for tick in 0..400 {
        let shown_s = live_s - 50.0 - 0.05 * f64::from(tick);
        let state = replays(&mut bench, shown_s, true);
        assert_eq!(state, SimulatorState::Replaying);
    }
    let state = replays(&mut bench, live_s, false);
    assert_eq!(state, SimulatorState::Running);
    assert_eq!(bench.fly(200, 1.0), SimulatorState::Running);
}

#[test]
fn datagrams_that_waited_are_no_jump() {
    let mut bench = Bench::new();
    bench.fly(80, 1.0);
    // Two seconds of them, read in one tick; half of them were discarded.
    bench.now = bench.now + Duration::from_secs(2);
    bench.clock.begin();
    for frame in (0..40).chain([80]) {
        let time_s = Some(bench.time_s + 0.025 * f64::from(frame));
        let report = SimulatorReport {
            time_s,
            ..SimulatorReport::default()
        };
        bench.clock.receive(bench.now, report);
    }
    assert_eq!(bench.clock.state(bench.now), SimulatorState::Running);
}
