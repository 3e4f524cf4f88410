//! The simulator's side of the socket, with time stamps.

use std::error::Error;
use std::io::{self, IoSliceMut};
use std::os::fd::{AsFd as _, AsRawFd as _};
use std::thread;
use std::time::{Duration, Instant};

use bench_tick::FakeXPlane;
use nix::errno::Errno;
use nix::sys::socket::{
    ControlMessageOwned, MsgFlags, SockaddrIn, recvmsg, setsockopt, sockopt::ReceiveTimestampns,
};
use nix::sys::time::TimeValLike as _;
use nix::time::{ClockId, clock_gettime};

/// The engage switch.
const SWITCH: &str = "sim/cockpit2/switches/generic_lights_switch[56]";
/// Interval of reading between two frames. It does not affect the times, which
/// the kernel stamps.
const LOOK_EVERY: Duration = Duration::from_millis(2);
/// Longer than any write.
const BUFFER_BYTES: usize = 2_048;

/// The times at the simulator's side, ns on `CLOCK_MONOTONIC`, ascending.
pub(crate) struct Times {
    /// When each frame was sent.
    pub(crate) frames_ns: Vec<i64>,
    /// When each write of a control arrived.
    pub(crate) writes_ns: Vec<i64>,
}

/// The simulator's side.
pub(crate) struct Wire {
    simulator: FakeXPlane,
    frame: Duration,
    next_frame: Instant,
    frames_ns: Vec<i64>,
    writes_ns: Vec<i64>,
}

impl Wire {
    pub(crate) fn open(frames_hz: u32) -> Result<Self, Box<dyn Error>> {
        let mut simulator = FakeXPlane::new();
        // Its values are constant: rates and a bank would contradict them.
        for name in ["phi", "Prad", "Qrad", "Rrad"] {
            simulator.set(&format!("sim/flightmodel/position/{name}"), 0.0);
        }
        setsockopt(&simulator.socket.as_fd(), ReceiveTimestampns, &true)?;
        Ok(Self {
            simulator,
            frame: Duration::from_secs(1) / frames_hz.max(1),
            next_frame: Instant::now(),
            frames_ns: Vec::new(),
            writes_ns: Vec::new(),
        })
    }

    pub(crate) fn port(&self) -> io::Result<u16> {
        self.simulator.socket.local_addr().map(|at| at.port())
    }

    /// Switches the engage switch on.
    pub(crate) fn engage(&mut self) {
        self.simulator.set(SWITCH, 1.0);
    }

    /// Sends frames and reads datagrams, until `end`.
    pub(crate) fn live_until(&mut self, end: Instant) -> Result<(), Box<dyn Error>> {
        while Instant::now() < end {
            self.take_all()?;
            if Instant::now() >= self.next_frame {
                self.next_frame += self.frame;
                self.frames_ns.push(now_ns(ClockId::CLOCK_MONOTONIC)?);
                self.simulator.send_next_frame(self.frame.as_secs_f32());
            }
            let left = self.next_frame.saturating_duration_since(Instant::now());
            thread::sleep(left.min(LOOK_EVERY));
        }
        Ok(())
    }

    fn take_all(&mut self) -> Result<(), Box<dyn Error>> {
        // The kernel stamps with the wall clock; its offset to the monotonic
        // clock is read each time, because the wall clock may be set.
        let offset_ns = now_ns(ClockId::CLOCK_REALTIME)? - now_ns(ClockId::CLOCK_MONOTONIC)?;
        loop {
            let mut buffer = [0; BUFFER_BYTES];
            let mut space = nix::cmsg_space!(nix::sys::time::TimeSpec);
            let mut slices = [IoSliceMut::new(&mut buffer)];
            let socket = self.simulator.socket.as_raw_fd();
            let message = recvmsg::<SockaddrIn>(
                socket,
                &mut slices,
                Some(&mut space),
                MsgFlags::MSG_DONTWAIT,
            );
            let message = match message {
                Ok(message) => message,
                Err(Errno::EAGAIN) => return Ok(()),
                Err(errno) => return Err(errno.into()),
            };
            let (length, from) = (message.bytes, message.address.ok_or("no sender")?);
            let stamp = message.cmsgs()?.find_map(|control| match control {
                ControlMessageOwned::ScmTimestampns(stamp) => Some(stamp.num_nanoseconds()),
                _ => None,
            });
            let datagram = buffer.get(..length).ok_or("longer than its buffer")?;
            if datagram.starts_with(b"DREF") {
                self.writes_ns
                    .push(stamp.ok_or("no time stamp")? - offset_ns);
            }
            self.simulator
                .take(datagram, std::net::SocketAddrV4::from(from).into());
        }
    }

    pub(crate) fn times(self) -> Times {
        Times {
            frames_ns: self.frames_ns,
            writes_ns: self.writes_ns,
        }
    }
}

fn now_ns(clock: ClockId) -> nix::Result<i64> {
    Ok(clock_gettime(clock)?.num_nanoseconds())
}
