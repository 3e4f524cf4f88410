//! The requirements of a sensor, for a device that a thread reads: a stand-in,
//! which the test plugs in and pulls out.

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_conformance::{SensorBench, Ticks, VanishingSource, sensor_conformance};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, Time};
use fcc_linux::{DeviceError, DeviceSensor, DeviceThread, RawValues, Sample, Source};
use nix::errno::Errno;

/// What the device shows: a sample, or that it is gone.
enum Shown {
    Sample(Sample<RawValues>),
    Gone,
}

/// The one end of a cable: what is sent, and when it was read.
struct Plug {
    shown: Sender<Shown>,
    read: Receiver<()>,
}

/// The other end, in the device's thread.
struct Socket {
    shown: Receiver<Shown>,
    read: Sender<()>,
}

fn cable() -> (Plug, Socket) {
    let ((shown, showing), (read, reading)) = (mpsc::channel(), mpsc::channel());
    let plug = Plug {
        shown,
        read: reading,
    };
    let socket = Socket {
        shown: showing,
        read,
    };
    (plug, socket)
}

impl Source for Socket {
    type Value = RawValues;

    /// Says that the sample before was handed over.
    fn read(&mut self) -> Result<Option<Sample<RawValues>>, DeviceError> {
        let _ = self.read.send(());
        match self.shown.recv_timeout(Duration::from_millis(100)) {
            Ok(Shown::Sample(sample)) => Ok(Some(sample)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Ok(Shown::Gone) | Err(RecvTimeoutError::Disconnected) => Err(DeviceError::Io {
                device: "the stand-in".into(),
                doing: "reading",
                source: Errno::EREMOTEIO.into(),
            }),
        }
    }
}

/// The sensor, and the device's other end, if it is plugged in.
struct Bench {
    sensor: DeviceSensor<RawValues>,
    plug: Option<Plug>,
    board: Arc<Mutex<Option<Socket>>>,
    now: Ticks,
}

impl Bench {
    /// Waits until the thread has handed everything over.
    fn settle(&self) {
        if let Some(plug) = &self.plug {
            plug.read.recv().unwrap();
        }
    }

    fn plug_in(&mut self) {
        let (plug, socket) = cable();
        *self.board.lock().unwrap() = Some(socket);
        self.plug = Some(plug);
        self.settle();
    }
}

impl SensorBench for Bench {
    type Measurements = Measurements;

    fn new() -> Self {
        let board: Arc<Mutex<Option<Socket>>> = Arc::default();
        let there = Arc::clone(&board);
        let open = move || {
            there.lock().unwrap().take().ok_or(DeviceError::Open {
                device: "the stand-in".into(),
                source: Errno::ENOENT.into(),
            })
        };
        let pause = Duration::from_millis(1);
        let sensor = DeviceThread::new("stand-in")
            .pauses(pause, pause)
            .start(open)
            .unwrap();
        let mut bench = Self {
            sensor,
            plug: None,
            board,
            now: Ticks::default(),
        };
        bench.plug_in();
        bench
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.sensor
    }

    /// Three samples, the last one a moment before the next tick.
    fn provide(&mut self) {
        let woke = self.now.next_tick().woke;
        for before_ms in [10, 5, 1] {
            let taken = woke - Duration::from_millis(before_ms);
            let Some(plug) = &self.plug else { return };
            let value = RawValues {
                specific_force_mps2: Some([0.0, 0.0, -9.8]),
                rates_radps: Some([0.0; 3]),
                ..RawValues::NONE
            };
            plug.shown
                .send(Shown::Sample(Sample::new(taken, value)))
                .unwrap();
            self.settle();
        }
    }

    fn taken(measured: &Measurements) -> Vec<Time> {
        vec![
            measured.raw_specific_force.taken,
            measured.raw_body_rates.taken,
        ]
    }
}

impl VanishingSource for Bench {
    fn vanish(&mut self) {
        if let Some(plug) = self.plug.take() {
            plug.shown.send(Shown::Gone).unwrap();
            // Until the thread has closed its end.
            while plug.read.recv().is_ok() {}
        }
    }

    fn come_back(&mut self) {
        self.plug_in();
    }
}

sensor_conformance!(device: Bench, vanishes);
