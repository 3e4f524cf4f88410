//! The check's own connection to X-Plane: subscriptions, writes, commands.

use std::collections::VecDeque;
use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use fcc_xplane::XPlaneConfig;
use fcc_xplane::protocol::{cmnd, dref, rref};

use crate::watched::Watched;

/// Requested rate: X-Plane sends at most once a frame.
const RATE_HZ: u16 = 200;
/// The index of the first dataref; the daemon's are far below.
const FIRST_INDEX: i32 = 30_000;
/// After this long without a datagram, and for values that have never come,
/// everything is requested again.
const AGAIN_AFTER: Duration = Duration::from_secs(1);
/// Datagrams kept: three minutes at 100 frames a second.
const KEPT: usize = 18_000;
const LARGEST: usize = 2_048;

/// A frame's values come in several datagrams: right after a replay some are
/// still of it.
const AFTER_A_REPLAY: Duration = Duration::from_millis(150);

/// One datagram, and what was known after it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) at: Instant,
    pub(crate) from: SocketAddr,
    values: [Option<f32>; Watched::COUNT],
}

impl Sample {
    /// With these values.
    #[cfg(test)]
    pub(crate) fn of(at: Instant, known: &[(Watched, f32)]) -> Self {
        let mut values = [None; Watched::COUNT];
        for (what, value) in known {
            if let Some(slot) = values.get_mut(what.place()) {
                *slot = Some(*value);
            }
        }
        Self {
            at,
            from: (Ipv4Addr::LOCALHOST, 0).into(),
            values,
        }
    }

    /// A value in X-Plane's unit; none before it arrived.
    pub(crate) fn get(&self, what: Watched) -> Option<f64> {
        let value = self.values.get(what.place()).copied().flatten();
        value.map(f64::from)
    }

    /// The same as a number: NaN before it arrived, which is within no limit.
    pub(crate) fn number(&self, what: Watched) -> f64 {
        self.get(what).unwrap_or(f64::NAN)
    }

    /// Whether either override is set.
    pub(crate) fn is_overridden(&self) -> bool {
        self.number(Watched::OverrideJoystick) >= 0.5
            || self.number(Watched::OverrideThrottles) >= 0.5
    }

    /// Whether both overrides are set.
    pub(crate) fn is_held(&self) -> bool {
        self.number(Watched::OverrideJoystick) >= 0.5
            && self.number(Watched::OverrideThrottles) >= 0.5
    }
}

/// Those of the flight: not those of a replay, which shows an earlier time.
pub(crate) fn flown<'a>(
    samples: impl Iterator<Item = &'a Sample>,
) -> impl Iterator<Item = &'a Sample> {
    let mut replayed: Option<Instant> = None;
    samples.filter(move |sample| {
        if sample.number(Watched::InReplay) >= 0.5 {
            replayed = Some(sample.at);
        }
        replayed.is_none_or(|at| sample.at.saturating_duration_since(at) > AFTER_A_REPLAY)
    })
}

/// A client of X-Plane.
#[derive(Debug)]
pub(crate) struct Link {
    socket: UdpSocket,
    simulator: SocketAddr,
    engage_switch: String,
    /// Where replies are expected to come from.
    reply_port: u16,
    engines: u8,
    samples: VecDeque<Sample>,
    requested: Instant,
}

impl Link {
    /// Subscribes from `local_port`, 0 for any that is free.
    pub(crate) fn open(
        simulator: SocketAddr,
        x_plane: &XPlaneConfig,
        local_port: u16,
    ) -> io::Result<Self> {
        let any: IpAddr = if simulator.is_ipv4() {
            Ipv4Addr::UNSPECIFIED.into()
        } else {
            Ipv6Addr::UNSPECIFIED.into()
        };
        let link = Self {
            socket: UdpSocket::bind((any, local_port))?,
            simulator,
            engage_switch: x_plane.engage_switch.clone(),
            reply_port: x_plane.reply_port,
            engines: x_plane.engines,
            samples: VecDeque::with_capacity(KEPT),
            requested: Instant::now(),
        };
        link.let_replies_in();
        link.subscribe(RATE_HZ, |_| true);
        Ok(link)
    }

    pub(crate) const fn simulator(&self) -> SocketAddr {
        self.simulator
    }

    /// The name of a watched dataref.
    pub(crate) fn path(&self, what: Watched) -> &str {
        what.path(&self.engage_switch)
    }

    /// A further connection to the same X-Plane.
    pub(crate) fn another(&self) -> io::Result<Self> {
        let x_plane = XPlaneConfig {
            engage_switch: self.engage_switch.clone(),
            reply_port: self.reply_port,
            ..XPlaneConfig::default()
        };
        Self::open(self.simulator, &x_plane, 0)
    }

    /// Ends a subscription that does not exist, at the port that replies come
    /// from: a firewall on this side lets in only what comes from an address
    /// that was written to.
    fn let_replies_in(&self) {
        let mut request = [0; rref::REQUEST_BYTES];
        let to = SocketAddr::new(self.simulator.ip(), self.reply_port);
        let path = self.path(Watched::Paused);
        let index = FIRST_INDEX - 1;
        if self.reply_port != 0
            && !to.ip().is_loopback()
            && rref::request(&mut request, 0, index, path).is_ok()
        {
            let _ = self.socket.send_to(&request, to);
        }
    }

    fn subscribe(&self, rate_hz: u16, wanted: impl Fn(Watched) -> bool) {
        let mut request = [0; rref::REQUEST_BYTES];
        for (index, what) in (FIRST_INDEX..).zip(Watched::all()) {
            let path = what.path(&self.engage_switch);
            if wanted(what) && rref::request(&mut request, rate_hz, index, path).is_ok() {
                self.send(&request);
            }
        }
    }

    /// A datagram that cannot be sent is like one that is lost.
    fn send(&self, datagram: &[u8]) {
        let _ = self.socket.send_to(datagram, self.simulator);
    }

    /// Sets a dataref.
    pub(crate) fn write(&self, path: &str, value: f64) {
        let mut datagram = [0; dref::WRITE_BYTES];
        if dref::write(&mut datagram, value as f32, path).is_ok() {
            self.send(&datagram);
        }
    }

    /// Sets a control: the throttle of every engine.
    pub(crate) fn write_control(&self, what: Watched, value: f64) {
        let path = self.path(what);
        let Some(array) = path.strip_suffix("[0]") else {
            return self.write(path, value);
        };
        for engine in 0..self.engines {
            self.write(&format!("{array}[{engine}]"), value);
        }
    }

    /// Runs a command.
    pub(crate) fn command(&self, path: &str) {
        let mut datagram = [0; cmnd::COMMAND_BYTES];
        if let Ok(datagram) = cmnd::write(&mut datagram, path) {
            self.send(datagram);
        }
    }

    /// Receives for this long.
    pub(crate) fn poll(&mut self, duration: Duration) {
        let until = Instant::now() + duration;
        let mut datagram = [0; LARGEST];
        loop {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() || self.socket.set_read_timeout(Some(left)).is_err() {
                break;
            }
            // A refusal means that nobody listens there now; it may return.
            if let Ok((length, from)) = self.socket.recv_from(&mut datagram)
                && from.ip() == self.simulator.ip()
            {
                self.take(datagram.get(..length).unwrap_or_default(), from);
            }
        }
        self.request_again();
    }

    fn take(&mut self, datagram: &[u8], from: SocketAddr) {
        let Ok(pairs) = rref::parse(datagram) else {
            return;
        };
        let mut values = self
            .samples
            .back()
            .map_or([None; Watched::COUNT], |last| last.values);
        for (index, value) in pairs {
            let place = usize::try_from(index - FIRST_INDEX).ok();
            if let Some(slot) = place.and_then(|place| values.get_mut(place)) {
                *slot = Some(value);
            }
        }
        if self.samples.len() == KEPT {
            self.samples.pop_front();
        }
        self.samples.push_back(Sample {
            at: Instant::now(),
            from,
            values,
        });
    }

    fn request_again(&mut self) {
        if self.requested.elapsed() < AGAIN_AFTER {
            return;
        }
        self.requested = Instant::now();
        match self.latest().copied() {
            Some(last) if last.at.elapsed() < AGAIN_AFTER => {
                self.subscribe(RATE_HZ, |what| last.get(what).is_none());
            }
            _ => {
                self.let_replies_in();
                self.subscribe(RATE_HZ, |_| true);
            }
        }
    }

    /// What is known now.
    pub(crate) fn latest(&self) -> Option<&Sample> {
        self.samples.back()
    }

    /// A value now, NaN before it arrived.
    pub(crate) fn number(&self, what: Watched) -> f64 {
        self.latest().map_or(f64::NAN, |last| last.number(what))
    }

    /// Whether nothing has arrived for this long.
    pub(crate) fn is_silent_for(&self, duration: Duration) -> bool {
        self.latest()
            .is_none_or(|last| last.at.elapsed() >= duration)
    }

    /// The datagrams since a time, oldest first.
    pub(crate) fn since(&self, time: Instant) -> impl Iterator<Item = &Sample> + Clone {
        let first = self.samples.partition_point(|sample| sample.at < time);
        self.samples.range(first..)
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.subscribe(0, |_| true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_a_replay_and_right_after_it_are_not_of_the_flight() {
        let began = Instant::now();
        let samples: Vec<Sample> = [(0, 0.0), (20, 1.0), (40, 1.0), (60, 0.0), (400, 0.0)]
            .into_iter()
            .map(|(ms, in_replay)| {
                let at = began + Duration::from_millis(ms);
                Sample::of(at, &[(Watched::InReplay, in_replay)])
            })
            .collect();
        let times: Vec<u128> = flown(samples.iter())
            .map(|sample| (sample.at - began).as_millis())
            .collect();
        assert_eq!(times, [0, 400]);
    }

    #[test]
    fn without_the_dataref_all_samples_are_of_the_flight() {
        let samples = [Sample::of(Instant::now(), &[])];
        assert_eq!(flown(samples.iter()).count(), 1);
    }
}
