//! The pipe to the release helper: any lines; held is what the last takeover
//! says, unless a later line frees it.
#![no_main]

use fcc_flight::release::held_after;

libfuzzer_sys::fuzz_target!(|text: &str| {
    let Some((number, plant)) = held_after(text.lines()) else {
        return;
    };
    let plant = plant.to_string();
    let takes = |line: &&str| {
        let given = line.strip_prefix("held ").and_then(|given| given.split_once(' '));
        given.is_some_and(|(given, of)| given.parse() == Ok(number) && of == plant)
    };
    let frees = |line: &str| {
        let freed = line.strip_prefix("free ").and_then(|freed| freed.parse::<u64>().ok());
        freed.is_some_and(|freed| freed >= number)
    };
    let lines: Vec<&str> = text.lines().collect();
    let last = lines.iter().rposition(takes).expect("a line says it");
    assert!(!lines.into_iter().skip(last).any(frees));
});
