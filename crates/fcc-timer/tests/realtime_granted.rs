//! Requests that the kernel may grant: what is reported is what the kernel says,
//! whether or not this user has the rights.
//!
//! A process of its own: what is locked and which policy is set is of the whole process.
#![cfg(test)]

use std::fs;
use std::sync::mpsc;
use std::thread;

use fcc_timer::usage::page_faults;
use fcc_timer::{CpuRequest, RealtimeGranted, RealtimeRequest};

/// What the calling thread has.
fn present() -> RealtimeGranted {
    RealtimeRequest::default().apply().unwrap()
}

/// The policy as `proc_pid_stat(5)` has it, field 41, and not by the code's way: 1 is
/// `SCHED_FIFO`, 0 is `SCHED_OTHER`.
fn policy_in_proc() -> u32 {
    let stat = fs::read_to_string("/proc/thread-self/stat").unwrap();
    let after_name = stat.rsplit(')').next().unwrap();
    after_name
        .split_whitespace()
        .nth(38)
        .unwrap()
        .parse()
        .unwrap()
}

#[test]
fn only_the_calling_thread_becomes_real_time() {
    let (ask, asked) = mpsc::channel::<()>();
    let bystander = thread::spawn(move || {
        asked.recv().unwrap();
        (present().policy, policy_in_proc())
    });
    thread::spawn(move || {
        let request = RealtimeRequest {
            priority: Some(10),
            ..RealtimeRequest::default()
        };
        let granted = request.apply().unwrap();
        if granted.denied.is_empty() {
            assert_eq!((granted.policy, granted.priority), ("SCHED_FIFO", 10));
            assert_eq!(policy_in_proc(), 1);
        } else {
            assert_eq!((granted.policy, granted.priority), ("SCHED_OTHER", 0));
            assert_eq!(policy_in_proc(), 0);
        }
        // One that was there, and one that this thread makes.
        ask.send(()).unwrap();
        assert_eq!(bystander.join().unwrap(), ("SCHED_OTHER", 0));
        let child = thread::spawn(|| (present().policy, policy_in_proc()));
        assert_eq!(child.join().unwrap(), ("SCHED_OTHER", 0));
    })
    .join()
    .unwrap();
}

#[test]
fn the_thread_stays_on_the_cpu_it_asked_for() {
    thread::spawn(|| {
        // The first of the list that the kernel gives: `0-3` or `2,5`.
        let status = fs::read_to_string("/proc/thread-self/status").unwrap();
        let cpu = status
            .lines()
            .find_map(|line| line.strip_prefix("Cpus_allowed_list:"))
            .and_then(|list| list.trim().split(['-', ',']).next())
            .unwrap()
            .parse()
            .unwrap();
        let request = RealtimeRequest {
            cpu: Some(CpuRequest::Number(cpu)),
            ..RealtimeRequest::default()
        };
        let granted = request.apply().unwrap();
        assert_eq!(granted.cpu, Some(cpu));
        assert_eq!(granted.denied, []);
        assert_eq!(nix::sched::sched_getcpu(), Ok(cpu));
    })
    .join()
    .unwrap();
}

/// Whichever it is: it is one of those allowed, or none, and the reason is told.
#[test]
fn the_best_cpu_is_chosen_with_a_reason() {
    thread::spawn(|| {
        let request = RealtimeRequest {
            cpu: Some(CpuRequest::Auto),
            ..RealtimeRequest::default()
        };
        let granted = request.apply().unwrap();
        assert_eq!(granted.denied, []);
        assert!(!granted.cpu_reason.is_empty());
        match granted.cpu {
            Some(cpu) => assert_eq!(nix::sched::sched_getcpu(), Ok(cpu)),
            None => assert!(granted.cpu_reason.starts_with("not bound: ")),
        }
    })
    .join()
    .unwrap();
}

/// The kernel's own word: what the device reads as, little while it is held.
#[test]
fn cpus_stay_awake_until_the_grants_are_dropped() {
    let device = "/dev/cpu_dma_latency";
    let request = RealtimeRequest {
        cpu_dma_latency_us: Some(12),
        ..RealtimeRequest::default()
    };
    let granted = request.apply().unwrap();
    let Some(limit) = &granted.cpu_latency else {
        // A machine without the device, or without the right to it, says so.
        let [denied] = granted.denied.as_slice() else {
            panic!("{:?}", granted.denied);
        };
        assert_eq!(denied.request, "CPUs awake within 12 µs");
        assert!(denied.reason.contains(device), "{denied}");
        return;
    };
    assert!(limit.us() <= 12);
    let in_force = || i32::from_ne_bytes(fs::read(device).unwrap().try_into().unwrap());
    let held_us = in_force();
    assert!(held_us <= 12, "{held_us}");
}

/// The kernel's smallest is 0.1 ms, and its default 0.7 ms and more (`sched_setattr(2)`,
/// Linux 6.12).
#[test]
fn without_fifo_the_slice_is_the_shortest_and_the_threads_own() {
    let Some(usual_ns) = present().slice_ns else {
        println!("not tested: this kernel does not say what a thread's slice is");
        return;
    };
    thread::spawn(|| {
        let request = RealtimeRequest {
            nice: Some(3),
            ..RealtimeRequest::default()
        };
        let granted = request.apply().unwrap();
        assert_eq!((granted.slice_ns, granted.nice), (Some(100_000), 3));
    })
    .join()
    .unwrap();
    assert!(usual_ns > 100_000);
    assert_eq!(present().slice_ns, Some(usual_ns));
}

#[test]
fn the_timer_slack_is_the_threads_own() {
    // The kernel's default, prctl(2).
    assert_eq!(present().timer_slack_ns, Some(50_000));
    thread::spawn(|| {
        let request = RealtimeRequest {
            timer_slack_ns: Some(1),
            ..RealtimeRequest::default()
        };
        assert_eq!(request.apply().unwrap().timer_slack_ns, Some(1));
    })
    .join()
    .unwrap();
    assert_eq!(present().timer_slack_ns, Some(50_000));
}

#[test]
fn a_prefaulted_stack_faults_no_more() {
    const BYTES: usize = 512 * 1024;

    /// Uses half of it, in frames larger than a page.
    #[inline(never)]
    fn use_stack(frames: usize) -> usize {
        const FRAME_BYTES: usize = 8 * 1024;
        let mut frame = [1_u8; FRAME_BYTES];
        std::hint::black_box(&mut frame);
        let below = if frames * FRAME_BYTES < BYTES / 2 {
            use_stack(frames + 1)
        } else {
            0
        };
        below + usize::from(std::hint::black_box(&frame)[FRAME_BYTES / 2])
    }

    thread::Builder::new()
        .stack_size(4 * BYTES)
        .spawn(|| {
            let request = RealtimeRequest {
                stack_prefault_bytes: BYTES,
                ..RealtimeRequest::default()
            };
            let granted = request.apply().unwrap();
            assert!(granted.stack_prefaulted, "{:?}", granted.denied);
            let before = page_faults();
            assert_eq!(use_stack(1), 32);
            assert_eq!(page_faults(), before);
        })
        .unwrap()
        .join()
        .unwrap();
}
