//! gpsd: what its lines say, and the requirements of a sensor with a stand-in for it.

use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use fcc_conformance::{SensorBench, VanishingSource, sensor_conformance};
use fcc_core::flight::{GnssFix, Measurements};
use fcc_core::framework::{Sensor, Time};
use fcc_linux::gpsd::{Gpsd, GpsdSettings, Report};
use fcc_linux::{DeviceThread, Source, monotonic};

use super::PATIENCE;
use crate::lines::watched::{AT_MOST, Watched};

/// Written by gpsd 3.22 for the sentences below.
pub(super) const TPV: &str = r#"{"class":"TPV","device":"/dev/pts/1","mode":3,"time":"2026-11-22T10:11:07.000Z","ept":0.005,"lat":42.950000000,"lon":-87.880000000,"altHAE":186.0000,"altMSL":220.4000,"alt":220.4000,"epv":23.000,"track":166.5000,"magtrack":162.4673,"magvar":-4.0,"speed":52.861,"climb":0.000,"epc":46.00,"geoidSep":-34.400,"eph":13.300,"sep":22.800}"#;

fn fix(line: &str) -> Option<GnssFix> {
    match Report::read(line.as_bytes()).unwrap() {
        Report::Fix { fix, .. } => fix.ok(),
        other => panic!("{other:?}"),
    }
}

pub(super) fn assert_near(found: f64, expected: f64, within: f64) {
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

/// 10:11:07 is 36,667 s after midnight.
#[test]
fn the_receivers_time_is_that_of_the_day() {
    let time_s = |line: &str| match Report::read(line.as_bytes()).unwrap() {
        Report::Fix { time_s, .. } => time_s,
        other => panic!("{other:?}"),
    };
    assert_eq!(time_s(TPV), Some(36_667.0));
    for unusable in ["", "2026-11-22", "T10:11Z", "2026-11-22T10:11:nanZ"] {
        let line = TPV.replace("2026-11-22T10:11:07.000Z", unusable);
        assert_eq!(time_s(&line), None, "{unusable}");
    }
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
        (r#""track":166.5000,"#, "", "52.9 m/s, and no direction"),
    ] {
        assert!(TPV.contains(change), "{change}");
        assert_eq!(fix(&TPV.replacen(change, to, 1)), None, "{why}");
    }
    assert!(fix(&TPV.replace(r#""mode":3"#, r#""mode":3,"status":3"#)).is_some());
}

#[test]
fn a_position_that_is_not_on_the_earth_is_said_to_be_impossible() {
    let said = "the position of its fix is impossible, with a latitude beyond 90°";
    for (change, to) in [
        (r#""lat":42.95"#, r#""lat":90.01"#),
        (r#""lat":42.950000000"#, r#""lat":1e308"#),
        (r#""lon":-87.88"#, r#""lon":-180.01"#),
    ] {
        assert!(TPV.contains(change), "{change}");
        let line = format!("{}\n", TPV.replacen(change, to, 1));
        let found = error_of(&line, None);
        assert!(found.starts_with(said), "{found}");
        // Another receiver's.
        let found = error_of(&line, Some("/dev/ttyACM0"));
        assert!(found.starts_with("reading: "), "{found}");
    }
    let searching = TPV.replace(r#""mode":3"#, r#""mode":1"#);
    assert_eq!(fix(&searching.replace("42.95", "90.01")), None, "no fix");
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

pub(super) fn settings(port: u16) -> GpsdSettings {
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

/// [`TPV`] at another time, later each time.
fn later_tpv() -> String {
    static SENT: AtomicU32 = AtomicU32::new(0);
    let later_ms = 200 * SENT.fetch_add(1, Ordering::Relaxed);
    let time = format!(
        "T10:{:02}:{:02}.{:03}Z",
        later_ms / 60_000,
        later_ms / 1_000 % 60,
        later_ms % 1_000
    );
    TPV.replace("T10:11:07.000Z", &time)
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
            let line = format!("{}\r\n", later_tpv());
            stream.write_all(line.as_bytes()).unwrap();
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
                let name = format!("{}: ", settings.address);
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
            "{\"class\":\"VERSION\",\"proto_major\":4}\n\
             {\"class\":\"DEVICES\",\"devices\":[]}\n",
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
        "cannot open localhost:1: Connection refused (os error 111); nothing listens \
         there: start it, and check the address"
    );
}

/// gpsd's buffer for the reports of an epoch is four times 10,240 bytes.
#[test]
fn what_sends_more_than_gpsd_can_is_none() {
    let no_gpsd = "this is no gpsd: check `address`, `ss -tlnp` on its machine shows what \
                   listens at which port";
    assert_eq!(
        error_of(&"x".repeat(40_961), None),
        format!(
            "it sends more than 40960 bytes without the end of a line, the most of gpsd: {no_gpsd}"
        )
    );
    assert_eq!(
        error_of(&"{\"class\":\"SKY\"}\n".repeat(1_001), None),
        format!(
            "it sends more than 1000 reports or 1000000 bytes in a second, and gpsd does not: \
             {no_gpsd}"
        )
    );
}

/// It is not read at once again, although it gave a fix: the pauses become longer.
#[test]
fn a_server_that_sends_without_end_is_left_alone_for_longer_and_longer() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let of = settings(listener.local_addr().unwrap().port());
    let pause = Duration::from_millis(10);
    let thread = DeviceThread::new("gpsd").pauses(pause, Duration::from_secs(20));
    let status = thread.status();
    let _sensor = thread.start(move || Gpsd::open(&of, monotonic)).unwrap();
    let flood = "{\"class\":\"SKY\"}\n".repeat(1_000);
    let accepted = [(); 5].map(|()| {
        let (mut stream, _) = listener.accept().unwrap();
        let accepted = Instant::now();
        // Until it is closed.
        let _ = stream.write_all(format!("{}\n", later_tpv()).as_bytes());
        while stream.write_all(flood.as_bytes()).is_ok() {}
        accepted
    });
    let passed = accepted[4].duration_since(accepted[0]);
    assert!(passed >= pause * (1 + 2 + 4 + 8), "{passed:?}");
    let begun = Instant::now();
    let said = || status.trouble().unwrap_or_default();
    while !said().contains("this is no gpsd") && begun.elapsed() < AT_MOST {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(said().contains("this is no gpsd"), "{status:?}");
}

#[test]
fn a_long_text_of_another_program_is_cut() {
    let says = format!(
        "{{\"class\":\"ERROR\",\"message\":\"{}\"}}\n",
        "E".repeat(5_000)
    );
    assert_eq!(
        error_of(&says, None),
        format!("it reports: {}", "E".repeat(200))
    );
}

/// Indoors a receiver reports for hours that it has no fix: after a while that is said, and
/// no longer that gpsd was not there.
#[test]
fn a_receiver_without_a_fix_is_no_fault() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    let thread = DeviceThread::new("gpsd").silent_after(Duration::from_millis(300));
    let status = thread.status();
    let of = settings(port);
    let _sensor = thread.start(move || Gpsd::open(&of, monotonic)).unwrap();
    let until = |expected: &dyn Fn() -> bool| {
        let begun = Instant::now();
        while !expected() && begun.elapsed() < AT_MOST {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(expected(), "{status:?}");
    };
    until(&|| {
        status
            .trouble()
            .is_some_and(|said| said.contains("nothing listens"))
    });
    let listener = TcpListener::bind(("127.0.0.1", port)).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    let searching = TPV.replace(r#""mode":3"#, r#""mode":1"#);
    stream
        .write_all(format!("{searching}\n").as_bytes())
        .unwrap();
    until(&|| {
        status
            .waits_for()
            .is_some_and(|said| said.contains("no three-dimensional fix"))
    });
    assert_eq!(status.trouble(), None);
    stream.write_all(format!("{TPV}\n").as_bytes()).unwrap();
    until(&|| status.waits_for().is_none());
    assert_eq!(status.trouble(), None);
    // It hangs, and repeats what it knew last.
    stream.write_all(format!("{TPV}\n").as_bytes()).unwrap();
    until(&|| {
        status
            .waits_for()
            .is_some_and(|said| said.contains("repeat a time"))
    });
}

/// Of a receiver that it cannot read, gpsd may still send other reports.
#[test]
fn satellites_without_a_position_are_said_within_15_s() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let of = settings(listener.local_addr().unwrap().port());
    let mut gpsd = Gpsd::open(&of, monotonic).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(15) {
        stream.write_all(b"{\"class\":\"SKY\"}\n").unwrap();
        std::thread::sleep(Duration::from_millis(100));
        match gpsd.read() {
            Ok(fix) => assert!(fix.is_none()),
            Err(error) => {
                assert!(error.to_string().contains("no position (`TPV`)"), "{error}");
                return;
            }
        }
    }
    panic!("no error");
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
