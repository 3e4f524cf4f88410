//! Watches a flight and prints a line each second:
//!
//! ```text
//! cargo run -p fcc-live --features flight --example watch -- fccd [SECONDS]
//! ```

#![expect(clippy::print_stdout, reason = "a program that prints")]

use std::error::Error;
use std::thread::sleep;
use std::time::{Duration, Instant};

use fcc_live::Watcher;
use fcc_telemetry::Instance;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let instance: Instance = words.next().as_deref().unwrap_or("fccd").parse()?;
    let seconds: f64 = words.next().map_or(Ok(f64::INFINITY), |s| s.parse())?;

    let mut watcher = Watcher::open(&instance)?;
    let began = Instant::now();
    let (mut seen, mut gaps, mut last) = (0_u64, 0_u64, None);
    while began.elapsed().as_secs_f64() < seconds && watcher.is_alive() {
        let line = Instant::now() + Duration::from_secs(1);
        // Ten times a second suffices to miss no record.
        while Instant::now() < line && began.elapsed().as_secs_f64() < seconds {
            while let Some(record) = watcher.next_record()? {
                let tick = record.tick;
                if last.is_some_and(|last| tick.number != last + 1 + tick.missed) {
                    gaps += 1;
                }
                last = Some(tick.number);
                seen += 1;
            }
            while let Some(event) = watcher.next_event()? {
                println!("tick {}: {}", event.tick, event.text);
            }
            sleep(Duration::from_millis(100));
        }
        println!("{seen} records, {gaps} gaps");
    }
    Ok(())
}
