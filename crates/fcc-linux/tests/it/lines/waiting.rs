//! What receivers are said to wait for, and what mends it: within 15 s.

use std::io::Write;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Instant;

use fcc_core::framework::Time;
use fcc_device::{NO_FIX, SLOW_FIXES};
use fcc_linux::gpsd::Gpsd;
use fcc_linux::{Source, monotonic};

use super::gpsd::{TPV, assert_near, settings};
use super::speaking::{line, receiver_with};
use crate::lines::watched::AT_MOST;

/// A sentence with its checksum, the exclusive or of what is between `$` and `*`.
fn sentence(text: &str) -> String {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${text}*{sum:02X}\r\n")
}

/// What is said of a receiver that sends sentences every `period_s` for 15 s; a `#`
/// is the second of the minute. None if it gave a fix.
fn said_of(texts: &[&str], period_s: usize) -> Option<&'static str> {
    let (mut device, path, _open) = line();
    let now_s = Arc::new(AtomicI64::new(0));
    let clock = now_s.clone();
    let now = move || Time::from_nanos(clock.load(Ordering::Relaxed) * 1_000_000_000);
    let mut receiver = receiver_with(path, now);
    let mut fixes = 0;
    for second in (0..15).step_by(period_s) {
        now_s.store(second, Ordering::Relaxed);
        for text in texts {
            let text = text.replace('#', &format!("{second:02}"));
            device.write_all(sentence(&text).as_bytes()).unwrap();
            fixes += usize::from(receiver.read().unwrap().is_some());
        }
    }
    assert_eq!(fixes > 0, receiver.waits_for().is_none());
    receiver.waits_for()
}

const GGA: &str = "GNGGA,1015#.00,4500.0,N,00800.0,E,4,18,0.6,500.0,M,47.0,M,1.0,0000";
const RMC: &str = "GNRMC,1015#.00,A,4500.0,N,00800.0,E,97.19,0.0,271126,,,R";
const VTG: &str = "GNVTG,0.0,T,,M,97.19,N,180.0,K,R";

#[test]
fn what_is_missing_in_the_sentences_is_said() {
    assert_eq!(said_of(&[GGA, RMC], 1), None);
    let three = "GNGSA,A,3,01,02,03,04,,,,,,,,,1.9,0.9,1.0,1";
    assert_eq!(said_of(&[GGA, RMC, three], 1), None);
    for (texts, period_s, expected) in [
        (&[GGA, VTG][..], 1, "GGA arrives and no RMC"),
        (&[GGA], 1, "GGA arrives and no RMC"),
        (&[RMC, VTG], 1, "RMC arrives and no GGA"),
        (&[VTG], 1, "sentences arrive, and neither GGA nor RMC"),
        (
            &["GNGLL,4500.0,N,00800.0,E,1015#.00,A,R"],
            1,
            "sentences arrive, and neither",
        ),
        (
            &[
                GGA,
                "GNRMC,1015#.50,A,4500.0,N,00800.0,E,97.19,0.0,271126,,,R",
            ],
            1,
            "GGA and RMC never have the same time",
        ),
        (
            &[GGA, "GNRMC,1015#.00,A,4500.0,N,00800.0,E,,,271126,,,R"],
            1,
            "GGA has a place, and RMC no valid speed",
        ),
        (&[GGA, RMC], 2, SLOW_FIXES),
        (&[RMC, GGA], 5, SLOW_FIXES),
    ] {
        let said = said_of(texts, period_s).unwrap();
        assert!(said.starts_with(expected), "{texts:?}: {said}");
    }
}

/// Fields that are not known yet are empty. No sentence is damaged: reading it is
/// no error.
#[test]
fn a_receiver_that_was_just_switched_on_has_no_fix_and_is_not_damaged() {
    for texts in [
        // Before it knows the time, the place of one of them, and a fix in two dimensions.
        &["GNRMC,,V,,,,,,,,,,N,V", "GNGGA,,,,,,0,00,99.99,,,,,,"][..],
        &["GPRMC,,V,,,,,,,,,,N", "GPGGA,,,,,,0,,,,,,,,"],
        &[
            "GNRMC,1015#.00,V,,,,,,,271126,,,N",
            "GNGGA,1015#.00,,,,,0,00,99.99,,,,,,",
        ],
        &[
            "GNRMC,1015#.00,V,,,,,,,,,,N",
            "GNGGA,1015#.00,,,,,0,03,,,M,,M,,",
        ],
        &[
            "GNRMC,1015#.00,A,4500.0,N,00800.0,E,0.1,,271126,,,A",
            "GNGGA,1015#.00,4500.0,N,00800.0,E,1,03,9.9,,M,,M,,",
            "GNGST,,,,,,,,",
        ],
        &[
            "GNGST,1015#.00,,,,,5.0,6.0,",
            "GNRMC,1015#.00,A,4500.0,N,00800.0,E,0.1,,271126,,,A",
            "GNGGA,1015#.00,4500.0,N,00800.0,E,1,03,9.9,,,,,,",
        ],
        // A held altitude: GSA says that the fix has two dimensions.
        &["GNGSA,A,2,01,02,03,,,,,,,,,,9.9,9.9,1.0,1", RMC, GGA],
        &[RMC, GGA, "GNGSA,A,2,01,02,03,,,,,,,,,,9.9,9.9,1.0,1"],
    ] {
        assert_eq!(said_of(texts, 1), Some(NO_FIX), "{texts:?}");
    }
}

/// What gpsd is said to wait for after these reports, and the vertical speeds of its
/// fixes.
fn gpsd_says(reports: &[String]) -> (Vec<f64>, Option<&'static str>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let of = settings(listener.local_addr().unwrap().port());
    let mut gpsd = Gpsd::open(&of, monotonic).unwrap();
    let (mut stream, _) = listener.accept().unwrap();
    let mut climbs = Vec::new();
    for report in reports {
        stream.write_all(format!("{report}\n").as_bytes()).unwrap();
        let begun = Instant::now();
        let before = gpsd.waits_for();
        while begun.elapsed() < AT_MOST {
            let read = gpsd.read().unwrap();
            climbs.extend(read.map(|fix| fix.value.velocity.down_mps));
            if read.is_some() || gpsd.waits_for() != before || begun.elapsed().as_millis() > 300 {
                break;
            }
        }
    }
    (climbs, gpsd.waits_for())
}

/// At 10:11:07 and so many seconds, so much higher than 220.4 m.
fn later(tpv: &str, seconds: u32, higher_m: u32) -> String {
    tpv.replace("10:11:07", &format!("10:11:{:02}", 7 + seconds))
        .replace("220.4", &format!("{}.4", 220 + higher_m))
}

#[test]
fn a_report_of_gpsd_without_climb_is_used_and_without_speed_says_so() {
    let without = |member: &str| {
        assert!(TPV.contains(member), "{member}");
        TPV.replace(member, "")
    };
    let no_climb = without(r#""climb":0.000,"#);
    let each_second: Vec<_> = (0..3).map(|n| later(&no_climb, n, 2 * n)).collect();
    let (climbs, waits_for) = gpsd_says(&each_second);
    assert_eq!(climbs.len(), 2);
    for down_mps in climbs {
        assert_near(down_mps, -2.0, 1e-9);
    }
    assert_eq!(waits_for, None);
    let every_other: Vec<_> = (0..3).map(|n| later(&no_climb, 2 * n, 0)).collect();
    assert_eq!(gpsd_says(&every_other), (vec![], Some(SLOW_FIXES)));
    for (member, expected) in [
        (r#""speed":52.861,"#, "its fix has no speed"),
        (r#""track":166.5000,"#, "its fix has no speed, or no course"),
        (
            r#""altMSL":220.4000,"alt":220.4000,"#,
            "its fix has no altitude",
        ),
    ] {
        let (climbs, said) = gpsd_says(&[without(member)]);
        assert!(climbs.is_empty());
        assert!(said.unwrap().starts_with(expected), "{said:?}");
    }
    let flat = TPV.replace(r#""mode":3"#, r#""mode":2"#);
    assert_eq!(gpsd_says(&[flat]), (vec![], Some(NO_FIX)));
}
