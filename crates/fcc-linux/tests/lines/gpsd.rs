//! gpsd: what its lines say, the requirements of a sensor with a stand-in for it,
//! and the real gpsd with gpsfake, which plays a receiver.

use std::fs;
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use fcc_conformance::{SensorBench, VanishingSource, sensor_conformance};
use fcc_core::flight::{GnssFix, Measurements};
use fcc_core::framework::{Sensor, Time};
use fcc_linux::gpsd::{Gpsd, GpsdSettings, Report};
use fcc_linux::{DeviceError, Source, monotonic};
use tempfile::TempDir;

use super::PATIENCE;
use crate::watched::{AT_MOST, Watched};

/// Written by gpsd 3.22 for the sentences below.
const TPV: &str = r#"{"class":"TPV","device":"/dev/pts/1","mode":3,"time":"2026-11-22T10:11:07.000Z","ept":0.005,"lat":42.950000000,"lon":-87.880000000,"altHAE":186.0000,"altMSL":220.4000,"alt":220.4000,"epv":23.000,"track":166.5000,"magtrack":162.4673,"magvar":-4.0,"speed":52.861,"climb":0.000,"epc":46.00,"geoidSep":-34.400,"eph":13.300,"sep":22.800}"#;

fn fix(line: &str) -> Option<GnssFix> {
    match Report::read(line.as_bytes()).unwrap() {
        Report::Fix { fix, .. } => fix,
        other => panic!("{other:?}"),
    }
}

fn assert_near(found: f64, expected: f64, within: f64) {
    assert!(
        (found - expected).abs() <= within,
        "{found}, not {expected}"
    );
}

/// The example in `gpsd_json(5)`, of a version before 3.20. 0.091 m/s to 10.38° is
/// 0.0895 m/s north and 0.0164 m/s east.
#[test]
fn a_published_report_has_its_values() {
    let fix = fix(r#"{"class":"TPV","device":"/dev/pts/1","time":"2005-06-08T10:34:48.283Z","ept":0.005,"lat":46.498293369,"lon":7.567411672,"alt":1343.127,"eph":36.000,"epv":32.321,"track":10.3788,"speed":0.091,"climb":-0.085,"mode":3}"#).unwrap();
    assert_near(fix.position.latitude_rad.to_degrees(), 46.498_293_369, 1e-9);
    assert_near(fix.position.longitude_rad.to_degrees(), 7.567_411_672, 1e-9);
    assert_eq!(fix.position.altitude_m, 1_343.127);
    assert_near(fix.velocity.north_mps, 0.089_5, 5e-5);
    assert_near(fix.velocity.east_mps, 0.016_4, 5e-5);
    assert_eq!(fix.velocity.down_mps, 0.085);
    assert_eq!(fix.horizontal_accuracy_m, 36.0);
    assert_eq!(fix.vertical_accuracy_m, 32.321);
    assert_eq!(fix.speed_accuracy_mps, 0.0, "it does not say");
}

#[test]
fn velocities_and_errors_of_a_receiver_come_before_those_that_gpsd_computes() {
    let own = TPV.replace(
        r#""climb":0.000"#,
        r#""velN":1.0,"velE":-2.0,"velD":0.5,"climb":9.0,"eps":0.3"#,
    );
    let velocity = fix(&own).unwrap().velocity;
    let found = [velocity.north_mps, velocity.east_mps, velocity.down_mps];
    assert_eq!(found, [1.0, -2.0, 0.5]);
    assert_eq!(fix(&own).unwrap().speed_accuracy_mps, 0.3);
    let older = TPV.replace(r#""eph":13.300"#, r#""epx":15.319,"epy":17.054"#);
    assert_eq!(fix(&older).unwrap().horizontal_accuracy_m, 17.054);
}

#[test]
fn only_a_measured_three_dimensional_fix_is_one() {
    assert!(fix(TPV).is_some());
    for (change, to, why) in [
        (r#""mode":3"#, r#""mode":2"#, "two-dimensional"),
        (r#""mode":3"#, r#""mode":1"#, "none"),
        (r#""mode":3"#, r#""mode":3,"status":5"#, "dead reckoning"),
        (r#""mode":3"#, r#""mode":3,"status":8"#, "simulated"),
        (r#""lat":42.95"#, r#""lat":90.01"#, "beyond the pole"),
        (r#""climb":0.000,"#, "", "no vertical speed"),
        (r#""track":166.5000,"#, "", "52.9 m/s, and no direction"),
    ] {
        assert!(TPV.contains(change), "{change}");
        assert_eq!(fix(&TPV.replacen(change, to, 1)), None, "{why}");
    }
    assert!(fix(&TPV.replace(r#""mode":3"#, r#""mode":3,"status":3"#)).is_some());
}

#[test]
fn what_gpsd_does_not_write_is_refused() {
    for line in [
        "",
        "{}",
        "GET / HTTP/1.1",
        "[3]",
        r#"{"class":"TPV","lat":"x"}"#,
        r#"{"class":"TPV","lat":1e999}"#,
    ] {
        assert!(Report::read(line.as_bytes()).is_err(), "{line}");
    }
    let sky = r#"{"class":"SKY","device":"/dev/pts/1","nSat":0}"#;
    assert_eq!(Report::read(sky.as_bytes()), Ok(Report::Other));
}

fn settings(port: u16) -> GpsdSettings {
    GpsdSettings {
        address: format!("localhost:{port}"),
        device: None,
    }
}

/// A stand-in for gpsd, which may end and be started again.
struct Bench {
    watched: Watched<GnssFix>,
    port: u16,
    /// It listens, and is connected.
    gpsd: Option<(TcpListener, TcpStream)>,
}

impl Bench {
    fn start(&mut self) {
        let listener = TcpListener::bind(("127.0.0.1", self.port)).unwrap();
        self.listen(listener);
    }

    fn listen(&mut self, listener: TcpListener) {
        let (stream, _) = listener.accept().unwrap();
        self.gpsd = Some((listener, stream));
        self.watched.settle();
    }
}

impl SensorBench for Bench {
    type Measurements = Measurements;

    fn new() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let mut bench = Self {
            watched: Watched::new(move |clock| Gpsd::open(&settings(port), clock)),
            port,
            gpsd: None,
        };
        bench.listen(listener);
        bench
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.watched.sensor
    }

    fn provide(&mut self) {
        self.watched.next();
        if let Some((_, stream)) = &mut self.gpsd {
            stream.write_all(format!("{TPV}\r\n").as_bytes()).unwrap();
            self.watched.settle();
        }
    }

    fn taken(measured: &Measurements) -> Vec<Time> {
        vec![measured.gnss.taken]
    }
}

impl VanishingSource for Bench {
    const PATIENCE: usize = PATIENCE;

    fn vanish(&mut self) {
        self.gpsd = None;
    }

    fn come_back(&mut self) {
        self.start();
    }
}

sensor_conformance!(gpsd: Bench, vanishes);

/// Reads a stream that says this, until there is an error.
fn error_of(says: &str, device: Option<&str>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut settings = settings(listener.local_addr().unwrap().port());
    settings.device = device.map(str::to_owned);
    let mut gpsd = Gpsd::open(&settings, monotonic).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    stream.write_all(says.as_bytes()).unwrap();
    drop(stream);
    let begun = Instant::now();
    while begun.elapsed() < AT_MOST {
        match gpsd.read() {
            Ok(None) => {}
            Ok(Some(_)) => return "a fix".to_owned(),
            Err(error) => {
                let name = format!("gpsd at {}: ", settings.address);
                return error.to_string().replace(&name, "");
            }
        }
    }
    panic!("no error");
}

#[test]
fn what_is_wrong_is_said_with_what_to_do() {
    for (says, expected) in [
        ("", "reading: Connection reset by peer"),
        (
            "SSH-2.0-OpenSSH_9.2\r\n",
            "a line is not of gpsd's JSON: check that",
        ),
        (
            "{\"class\":\"VERSION\",\"proto_major\":4}\n",
            "it speaks version 4 of its protocol, not 3",
        ),
        (
            "{\"class\":\"ERROR\",\"message\":\"no\\u001b\"}\n",
            "it reports: no\\u{1b}",
        ),
    ] {
        let found = error_of(says, None);
        assert!(found.starts_with(expected), "{found}");
    }
    let missing = Gpsd::open(&settings(1), monotonic).unwrap_err().to_string();
    assert_eq!(
        missing,
        "cannot open gpsd at localhost:1: Connection refused (os error 111); nothing listens \
         there: start it, and check the address"
    );
}

#[test]
fn of_two_receivers_the_chosen_one_is_used() {
    let line = format!("{TPV}\n");
    assert_eq!(error_of(&line, None), "a fix");
    assert_eq!(error_of(&line, Some("/dev/pts/1")), "a fix");
    assert!(error_of(&line, Some("/dev/ttyACM0")).starts_with("reading: "));
}

/// Written by gpsd 3.22 for a receiver of gpsfake.
const DEVICES: &str = r#"{"class":"DEVICES","devices":[{"class":"DEVICE","path":"/dev/pts/1","driver":"NMEA0183","activated":"2026-11-23T06:17:13.357Z","flags":1,"native":0,"bps":4800,"parity":"N","stopbits":1,"cycle":1.00}]}"#;

#[test]
fn a_receiver_that_gpsd_does_not_have_is_named() {
    let has = |device| error_of(&format!("{DEVICES}\n{TPV}\n"), Some(device));
    assert_eq!(has("/dev/pts/1"), "a fix");
    let has = |says: &str| error_of(&format!("{says}\n"), Some("/dev/ttyACM0"));
    assert_eq!(
        has(DEVICES),
        "it has no receiver /dev/ttyACM0, but /dev/pts/1: choose `device` of these, or start it \
         with that one"
    );
    let none = has(r#"{"class":"DEVICES","devices":[]}"#);
    assert!(
        none.starts_with("it has no receiver /dev/ttyACM0, but none: "),
        "{none}"
    );
}

/// A second of a receiver: a sentence with its checksum, the exclusive or of what
/// is between `$` and `*`.
fn second(number: u32) -> String {
    let sentence = |text: String| {
        let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${text}*{sum:02X}\r\n")
    };
    [
        format!("GNRMC,1011{number:02}.00,A,4257.00000,N,08752.80000,W,102.754,166.50,221126,,,A"),
        format!("GNGGA,1011{number:02}.00,4257.00000,N,08752.80000,W,1,14,0.7,220.4,M,-34.4,M,,"),
        "GNGSA,A,3,01,02,03,04,05,06,07,08,09,10,11,12,1.2,0.7,1.0".to_owned(),
    ]
    .map(sentence)
    .concat()
}

/// gpsfake, with the gpsd that it starts.
struct Real {
    gpsfake: Child,
    port: u16,
    log: TempDir,
}

impl Real {
    fn start(port: u16) -> Self {
        let log = TempDir::new().unwrap();
        let path = log.path().join("receiver.nmea");
        let seconds: String = (0..60).map(second).collect();
        fs::write(&path, format!("# a receiver\n{seconds}")).unwrap();
        Self {
            gpsfake: Self::gpsfake(port, &path),
            port,
            log,
        }
    }

    /// gpsd ends with it, at SIGTERM.
    fn gpsfake(port: u16, log: &std::path::Path) -> Child {
        Command::new("gpsfake")
            .args(["--nowait", "--quiet", "--cycle", "0.02", "--port"])
            .arg(port.to_string())
            .arg(log)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("gpsd and gpsd-clients are installed: `make test-rust` does it")
    }

    fn end(&mut self) {
        let pid = nix::unistd::Pid::from_raw(self.gpsfake.id().cast_signed());
        let _ = nix::sys::signal::kill(pid, nix::sys::signal::Signal::SIGTERM);
        let _ = self.gpsfake.wait();
    }

    fn again(&mut self) {
        self.gpsfake = Self::gpsfake(self.port, &self.log.path().join("receiver.nmea"));
    }
}

impl Drop for Real {
    fn drop(&mut self) {
        self.end();
    }
}

/// Opens it until it is there, and reads until there is a fix.
fn fix_of(settings: &GpsdSettings) -> (Gpsd, GnssFix) {
    let begun = Instant::now();
    while begun.elapsed() < AT_MOST {
        let Ok(mut gpsd) = Gpsd::open(settings, monotonic) else {
            std::thread::sleep(std::time::Duration::from_millis(50));
            continue;
        };
        while let Ok(read) = gpsd.read() {
            if let Some(sample) = read {
                return (gpsd, sample.value);
            }
        }
    }
    panic!("no fix");
}

/// Position and altitude are those of the sentences, and 102.754 kt to 166.5° is
/// -51.40 and 12.34 m/s.
#[test]
fn the_real_gpsd_gives_the_fix_of_its_receiver_again_after_it_was_ended() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    let mut real = Real::start(port);
    for is_last in [false, true] {
        let (mut gpsd, fix) = fix_of(&settings(port));
        assert_near(fix.position.latitude_rad.to_degrees(), 42.95, 1e-8);
        assert_near(fix.position.longitude_rad.to_degrees(), -87.88, 1e-8);
        assert_eq!(fix.position.altitude_m, 220.4);
        assert_near(fix.velocity.north_mps, -51.40, 0.005);
        assert_near(fix.velocity.east_mps, 12.34, 0.005);
        assert_eq!(fix.velocity.down_mps, 0.0);
        real.end();
        let ended = loop {
            if let Err(error) = gpsd.read() {
                break error;
            }
        };
        assert!(matches!(ended, DeviceError::Io { .. }), "{ended}");
        assert!(matches!(
            Gpsd::open(&settings(port), monotonic),
            Err(DeviceError::Open { .. })
        ));
        if !is_last {
            real.again();
        }
    }
}
