//! Locked memory, in a process of its own: it concerns all threads.
#![cfg(test)]

use std::fs;

use fcc_timer::RealtimeRequest;

#[test]
fn memory_reported_as_locked_is_resident() {
    let request = RealtimeRequest {
        lock_memory: true,
        ..RealtimeRequest::default()
    };
    let granted = request.apply().unwrap();
    assert_eq!(granted.memory_locked, granted.denied.is_empty());
    if granted.memory_locked {
        // What is mapped later is locked as it is touched: no page of it
        // before, all of it after (`Locked` of `proc_pid_smaps(5)`).
        let mut later = vec![0_u8; 16 << 20];
        let address = later.as_ptr().addr();
        assert!(locked_kib(address) < 1024);
        later.fill(1);
        assert!(locked_kib(address) >= 16 << 10);
    }
}

/// How much of the mapping around an address is locked in memory.
fn locked_kib(address: usize) -> usize {
    let smaps = fs::read_to_string("/proc/self/smaps").unwrap();
    let mut inside = false;
    for line in smaps.lines() {
        let range = line
            .split_whitespace()
            .next()
            .and_then(|word| word.split_once('-'));
        if let Some((low, high)) = range
            && let (Ok(low), Ok(high)) = (
                usize::from_str_radix(low, 16),
                usize::from_str_radix(high, 16),
            )
        {
            inside = (low..high).contains(&address);
        } else if inside && let Some(locked) = line.strip_prefix("Locked:") {
            return locked.trim_end_matches("kB").trim().parse().unwrap();
        }
    }
    panic!("no mapping holds the address");
}
