//! Positions that the app's location service hands in.

use core::time::Duration;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use fcc_core::flight::{GnssFix, Position, Velocity};
use fcc_core::framework::Time;
use fcc_device::{DeviceError, Sample, Source, VerticalSpeed, WAIT, velocity_over_ground};

use crate::stamps::Clocks;

/// The name of its thread, and of its device in messages.
pub(crate) const POSITION: &str = "phone position";
/// Positions that may wait; they come about once a second.
const MOST_WAITING: usize = 16;
/// An older one is a place that the phone remembers.
const OLDEST: Duration = Duration::from_secs(5);

/// A position, as `android.location.Location` has it; what it does not know is none.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct PositionReport {
    /// When it was found, ns of `CLOCK_BOOTTIME` (`elapsedRealtimeNanos`).
    pub elapsed_realtime_ns: i64,
    /// WGS 84, -90 to 90.
    pub latitude_deg: f64,
    /// WGS 84, -180 to 180.
    pub longitude_deg: f64,
    /// Above mean sea level.
    pub altitude_m: f64,
    /// Over the ground.
    pub speed_mps: f64,
    /// Of the velocity, from true north; none while it stands.
    pub bearing_deg: Option<f64>,
    /// Radius with 68 % of the error.
    pub horizontal_accuracy_m: Option<f64>,
    /// 68 % of the altitude's error.
    pub vertical_accuracy_m: Option<f64>,
    /// 68 % of the speed's error.
    pub speed_accuracy_mps: Option<f64>,
}

/// The app's end.
#[derive(Clone, Debug)]
pub struct PositionSender(SyncSender<PositionReport>);

impl PositionSender {
    /// Hands a position in, without waiting.
    pub fn send(&self, report: PositionReport) {
        // If they wait nobody flies by them.
        let _ = self.0.try_send(report);
    }
}

/// The flight's end.
#[derive(Clone, Debug)]
pub(crate) struct Positions(Arc<Mutex<Receiver<PositionReport>>>);

/// Both ends.
pub(crate) fn positions() -> (PositionSender, Positions) {
    let (sender, receiver) = sync_channel(MOST_WAITING);
    (
        PositionSender(sender),
        Positions(Arc::new(Mutex::new(receiver))),
    )
}

/// Positions as a source of fixes.
pub(crate) struct PositionSource {
    positions: Positions,
    clocks: Clocks,
    vertical_speed: VerticalSpeed,
    newest: Time,
}

impl PositionSource {
    pub(crate) fn new(positions: Positions, clocks: Clocks) -> Self {
        Self {
            positions,
            clocks,
            vertical_speed: VerticalSpeed::default(),
            newest: Time::NEVER,
        }
    }

    fn fix(&mut self, report: &PositionReport) -> Result<Option<Sample<GnssFix>>, &'static str> {
        let now = self.clocks.now();
        let taken = now
            .boottime(report.elapsed_realtime_ns)
            .filter(|taken| *taken <= now.monotonic && now.monotonic.since(*taken) <= OLDEST)
            .ok_or("its time is of the future, or more than 5 s old")?;
        if taken <= self.newest {
            return Ok(None);
        }
        let is_place = report.latitude_deg.abs() <= 90.0
            && report.longitude_deg.abs() <= 180.0
            && report.altitude_m.is_finite()
            && report.speed_mps.is_finite();
        if !is_place {
            return Err("it is no place on earth, or its altitude or speed is missing");
        }
        let bearing_deg = report.bearing_deg.filter(|bearing| bearing.is_finite());
        let [north_mps, east_mps] = velocity_over_ground(report.speed_mps, bearing_deg)
            .ok_or("it moves, and has no bearing")?;
        self.newest = taken;
        let time_s = taken.as_nanos() as f64 * 1e-9;
        let down_mps = self.vertical_speed.down_mps(time_s, report.altitude_m);
        let accuracy = |known: Option<f64>| known.filter(|error| *error >= 0.0).unwrap_or(0.0);
        Ok(down_mps.map(|down_mps| {
            Sample::new(
                taken,
                GnssFix {
                    position: Position {
                        latitude_rad: report.latitude_deg.to_radians(),
                        longitude_rad: report.longitude_deg.to_radians(),
                        altitude_m: report.altitude_m,
                    },
                    velocity: Velocity {
                        north_mps,
                        east_mps,
                        down_mps,
                    },
                    horizontal_accuracy_m: accuracy(report.horizontal_accuracy_m),
                    vertical_accuracy_m: accuracy(report.vertical_accuracy_m),
                    speed_accuracy_mps: accuracy(report.speed_accuracy_mps),
                },
            )
        }))
    }
}

impl Source for PositionSource {
    type Value = GnssFix;

    fn read(&mut self) -> Result<Option<Sample<GnssFix>>, DeviceError> {
        let receiver = &self.positions.0;
        let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
        let received = receiver.recv_timeout(WAIT);
        drop(receiver);
        match received {
            Ok(report) => self.fix(&report).map_err(|what| DeviceError::Malformed {
                device: POSITION.to_owned(),
                what,
            }),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => {
                std::thread::sleep(WAIT);
                Ok(None)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fcc_device::Clock;

    use super::*;

    const S: i64 = 1_000_000_000;

    /// A phone that has slept for 100 s, at 50 s of the loop's clock.
    fn source() -> PositionSource {
        let clocks = Clocks {
            monotonic: Clock::new(|| Time::from_nanos(50 * S)),
            boottime: Clock::new(|| Time::from_nanos(150 * S)),
        };
        PositionSource::new(positions().1, clocks)
    }

    fn at(boottime_s: f64, altitude_m: f64) -> PositionReport {
        PositionReport {
            elapsed_realtime_ns: (boottime_s * 1e9) as i64,
            latitude_deg: 48.0,
            longitude_deg: 11.0,
            altitude_m,
            speed_mps: 30.0,
            bearing_deg: Some(90.0),
            horizontal_accuracy_m: Some(4.0),
            ..PositionReport::default()
        }
    }

    #[test]
    fn a_position_is_a_fix_at_its_time_on_the_loops_clock() {
        let mut source = source();
        // The first has no vertical speed.
        assert_eq!(source.fix(&at(148.0, 500.0)), Ok(None));
        let fix = source.fix(&at(149.0, 502.0)).unwrap().unwrap();
        assert_eq!(fix.taken, Time::from_nanos(49 * S));
        let velocity = fix.value.velocity;
        assert!(velocity.north_mps.abs() < 1e-9 && (velocity.east_mps - 30.0).abs() < 1e-9);
        assert_eq!(velocity.down_mps, -2.0);
        assert_eq!(fix.value.horizontal_accuracy_m, 4.0);
        assert_eq!(fix.value.vertical_accuracy_m, 0.0);
        // The same once more.
        assert_eq!(source.fix(&at(149.0, 502.0)), Ok(None));
    }

    #[test]
    fn what_is_no_position_of_now_is_refused() {
        let refused = |report: PositionReport| source().fix(&report).unwrap_err();
        assert!(refused(at(151.0, 500.0)).contains("future"));
        assert!(refused(at(144.0, 500.0)).contains("5 s old"));
        // A stamp of the loop's clock is one of long ago.
        assert!(refused(at(50.0, 500.0)).contains("5 s old"));
        let mut nowhere = at(149.0, 500.0);
        nowhere.latitude_deg = f64::NAN;
        assert!(refused(nowhere).contains("no place"));
        let mut aimless = at(149.0, 500.0);
        aimless.bearing_deg = None;
        assert!(refused(aimless).contains("bearing"));
    }
}
