//! The requirements of a sensor, for receivers that are pulled out and put back: on
//! lines, which are pseudo-terminals of the kernel, and by gpsd.

mod gpsd;
mod pty;
mod real_gpsd;
mod speaking;
mod waiting;
mod watched;

use std::sync::atomic::{AtomicU32, Ordering};

use fcc_conformance::{SensorBench, VanishingSource, sensor_conformance};
use fcc_core::flight::{GnssFix, Measurements};
use fcc_core::framework::{Sensor, Time};
use fcc_linux::serial::{
    GnssReceiver, GnssSettings, LineSettings, RcChannel, RcChannels, RcProtocol, RcReceiver,
    RcValues,
};
use pty::Line;

/// See the `PATIENCE` of each: 500 ms are silence, 20 ticks of 25 ms.
const PATIENCE: usize = 21;

/// Captured from a receiver of u-blox: see `satellites.rs`.
const NAV_PVT: [u8; 100] = [
    0xb5, 0x62, 0x01, 0x07, 0x5c, 0x00, 0x00, 0x26, 0x08, 0x18, 0xe2, 0x07, 0x04, 0x1a, 0x0f, 0x3b,
    0x1d, 0xf7, 0xe9, 0x03, 0x00, 0x00, 0xf5, 0x1a, 0xe6, 0x0b, 0x03, 0x43, 0xea, 0x0e, 0x40, 0x60,
    0x91, 0x08, 0x94, 0xfa, 0xe0, 0x1d, 0xd2, 0xf1, 0x04, 0x00, 0xad, 0x44, 0x04, 0x00, 0x27, 0x00,
    0x00, 0x00, 0x31, 0x00, 0x00, 0x00, 0xee, 0xff, 0xff, 0xff, 0x04, 0x00, 0x00, 0x00, 0xe2, 0xff,
    0xff, 0xff, 0x12, 0x00, 0x00, 0x00, 0xd5, 0x65, 0x92, 0x01, 0x20, 0x00, 0x00, 0x00, 0x53, 0xcc,
    0x2c, 0x00, 0xa2, 0x00, 0x00, 0x00, 0x12, 0x19, 0x26, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x57, 0x03,
];

/// The same of another epoch, later each time.
fn later_nav_pvt() -> Vec<u8> {
    static SENT: AtomicU32 = AtomicU32::new(0);
    nav_pvt_later_by(200 * SENT.fetch_add(1, Ordering::Relaxed))
}

fn nav_pvt_later_by(later_ms: u32) -> Vec<u8> {
    let mut message = NAV_PVT;
    let time_ms = u32::from_le_bytes(message[6..10].try_into().unwrap());
    message[6..10].copy_from_slice(&(time_ms + later_ms).to_le_bytes());
    // Fletcher's, as in 3.4 of the interface description.
    let sum = message[2..98].iter().fold([0_u8; 2], |[a, b], byte| {
        let a = a.wrapping_add(*byte);
        [a, b.wrapping_add(a)]
    });
    message[98..].copy_from_slice(&sum);
    message.to_vec()
}

/// A capture in Betaflight's tests: see `receivers.rs`.
const CRSF: [u8; 26] = [
    0xc8, 0x18, 0x16, 0xbd, 0x08, 0x9f, 0xf4, 0xae, 0xf7, 0xbd, 0xef, 0x7d, 0xef, 0xfb, 0xad, 0xfd,
    0x45, 0x2b, 0x5a, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x6c,
];

/// Of the crate `sbus`: see `receivers.rs`.
const SBUS: [u8; 25] = [
    0x0f, 0xe0, 0x03, 0x1f, 0x58, 0xc0, 0x07, 0x16, 0xb0, 0x80, 0x05, 0x2c, 0x60, 0x01, 0x0b, 0xf8,
    0xc0, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x00,
];

fn gnss() -> Line<GnssFix> {
    Line::new(|path, clock| {
        let line = LineSettings {
            path,
            baud: 38_400,
            has_even_parity: false,
        };
        let settings = GnssSettings {
            line,
            configures: true,
        };
        GnssReceiver::open(&settings, clock)
    })
}

fn rc(protocol: RcProtocol) -> Line<RcValues> {
    let channel = |number| RcChannel {
        number,
        is_reversed: false,
    };
    let channels = RcChannels {
        switch: channel(5),
        on_above_us: 1_700.0,
        controls: Some([channel(2), channel(1), channel(4)]),
    };
    Line::new(move |path, clock| RcReceiver::open(&protocol.line(path), protocol, channels, clock))
}

/// A bench of a line, and what its device sends.
macro_rules! bench {
    ($name:ident: $value:ty, $line:expr, $sends:expr, $taken:expr) => {
        struct $name(Line<$value>);

        impl SensorBench for $name {
            type Measurements = Measurements;

            fn new() -> Self {
                Self($line)
            }

            fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
                &mut self.0.watched.sensor
            }

            fn provide(&mut self) {
                self.0.send($sends);
            }

            fn taken(measured: &Measurements) -> Vec<Time> {
                $taken(measured)
            }
        }

        impl VanishingSource for $name {
            const PATIENCE: usize = PATIENCE;

            fn vanish(&mut self) {
                self.0.pull_out();
            }

            fn come_back(&mut self) {
                self.0.plug_in();
            }
        }
    };
}

fn pilots(measured: &Measurements) -> Vec<Time> {
    vec![measured.engage_switch.taken, measured.pilot_controls.taken]
}

bench!(Gnss: GnssFix, gnss(), &later_nav_pvt(), |measured: &Measurements| vec![measured.gnss.taken]);
// A switch is known after three frames.
bench!(SbusBench: RcValues, rc(RcProtocol::Sbus), &[SBUS; 3].concat(), pilots);
bench!(CrsfBench: RcValues, rc(RcProtocol::Crsf), &[CRSF; 3].concat(), pilots);

sensor_conformance!(gnss_receiver: Gnss, vanishes);
sensor_conformance!(sbus_receiver: SbusBench, vanishes);
sensor_conformance!(crsf_receiver: CrsfBench, vanishes);
