//! Counts the system calls of a tick and the memory it touches: the loop of the
//! benchmark under `strace`, and then under valgrind's `lackey`, with marks
//! around each tick. The counts are the same on every run, except for the
//! addresses of memory.
#![allow(clippy::print_stdout, reason = "a program")]

use std::collections::{BTreeMap, HashSet};
use std::error::Error;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Command, Stdio};
use std::{env, fs};

use bench_tick::{Flight, marks};
use clap::Parser;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Size of a cache line, bytes: the same on all our boards.
const CACHE_LINE: u64 = 64;
/// Printed by the flight before it begins, in the stream of the trace.
const MARKS_AT: &str = "marks at ";
/// What `strace` prints when a mark is passed.
const MARK: &str = "getppid()";

/// Counts the system calls and the memory of a tick
#[derive(Parser)]
struct Cli {
    /// How many ticks are counted
    #[arg(long, default_value_t = 40)]
    ticks: u32,
    /// Fly and pass the marks: run by the tracers
    #[arg(long, hide = true)]
    fly: bool,
}

fn main() -> Outcome<()> {
    let cli = Cli::parse();
    if cli.fly {
        fly(cli.ticks);
        return Ok(());
    }
    let calls = system_calls(cli.ticks)?;
    let memory = memory(cli.ticks)?;
    let mean = |sum: u64| sum as f64 / f64::from(cli.ticks);
    println!("| of a tick, X-Plane over loopback | |\n|---|---:|");
    for (call, count) in &calls {
        println!("| system call `{call}` | {:.2} |", mean(*count));
    }
    println!("| system calls | {:.2} |", mean(calls.values().sum()));
    for (what, sum) in [
        ("instructions", memory.instructions),
        ("loads", memory.loads),
        ("bytes loaded", memory.loaded_bytes),
        ("stores", memory.stores),
        ("bytes stored", memory.stored_bytes),
        (
            "bytes of data in the cache lines touched",
            memory.data_lines * CACHE_LINE,
        ),
        (
            "bytes of code in the cache lines touched",
            memory.code_lines * CACHE_LINE,
        ),
    ] {
        println!("| {what} | {:.0} |", mean(sum));
    }
    Ok(())
}

fn fly(ticks: u32) {
    let mut flight = Flight::engaged();
    let (begin, end) = (marks::begin as *const (), marks::end as *const ());
    let words = format!("{MARKS_AT}{:x} {:x}\n", begin.addr(), end.addr());
    // In one write, or lines of the trace could get between.
    let _ = std::io::stderr().write_all(words.as_bytes());
    for _ in 0..ticks {
        flight.frame();
        marks::begin();
        flight.tick();
        marks::end();
    }
}

fn this_program(ticks: u32) -> Outcome<Vec<String>> {
    let program = env::current_exe()?.to_string_lossy().into_owned();
    Ok(vec![program, "--fly".into(), format!("--ticks={ticks}")])
}

/// System calls between the marks, by name.
fn system_calls(ticks: u32) -> Outcome<BTreeMap<String, u64>> {
    let folder = tempfile::tempdir()?;
    let trace = folder.path().join("trace");
    let status = Command::new("strace")
        .arg("-o")
        .arg(&trace)
        .args(this_program(ticks)?)
        .stderr(Stdio::null())
        .status()
        .map_err(|error| format!("strace does not start: {error}"))?;
    if !status.success() {
        return Err(format!("the loop under strace: {status}").into());
    }
    let mut counts = BTreeMap::new();
    let mut inside = false;
    for line in fs::read_to_string(trace)?.lines() {
        if line.starts_with(MARK) {
            inside = !inside;
        } else if inside && let Some((call, _)) = line.split_once('(') {
            *counts.entry(call.to_owned()).or_insert(0) += 1;
        }
    }
    Ok(counts)
}

/// Sums over all ticks.
#[derive(Default)]
struct Memory {
    instructions: u64,
    loads: u64,
    loaded_bytes: u64,
    stores: u64,
    stored_bytes: u64,
    data_lines: u64,
    code_lines: u64,
}

/// The memory accesses of the instructions between the marks. `lackey` writes a
/// line for each: `I  address,size`, and ` L`, ` S` or ` M` for load, store or
/// both.
fn memory(ticks: u32) -> Outcome<Memory> {
    let mut child = Command::new("valgrind")
        .args(["--tool=lackey", "--trace-mem=yes", "--log-fd=2"])
        .args(this_program(ticks)?)
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("valgrind does not start: {error}"))?;
    let trace = child.stderr.take().ok_or("no trace")?;
    let mut marks = None;
    let mut sum = Memory::default();
    let (mut data, mut code) = (HashSet::new(), HashSet::new());
    let mut inside = false;
    for line in BufReader::new(trace).lines() {
        let line = line?;
        if let Some(words) = line.strip_prefix(MARKS_AT) {
            marks = addresses(words);
        }
        let (Some((begin, end)), Some((kind, address, size))) = (marks, access(&line)) else {
            continue;
        };
        match kind {
            'I' if address == begin => {
                inside = true;
                (data, code) = Default::default();
            }
            'I' if address == end && inside => {
                inside = false;
                sum.data_lines += data.len() as u64;
                sum.code_lines += code.len() as u64;
            }
            _ => {}
        }
        if !inside {
            continue;
        }
        let lines = address / CACHE_LINE..=(address + size - 1) / CACHE_LINE;
        if kind == 'I' {
            sum.instructions += 1;
            code.extend(lines);
            continue;
        }
        data.extend(lines);
        if kind != 'S' {
            sum.loads += 1;
            sum.loaded_bytes += size;
        }
        if kind != 'L' {
            sum.stores += 1;
            sum.stored_bytes += size;
        }
    }
    Ok(sum)
}

/// The addresses of the two marks, in hexadecimal.
fn addresses(words: &str) -> Option<(u64, u64)> {
    let (begin, end) = words.split_once(' ')?;
    let number = |word: &str| u64::from_str_radix(word, 16).ok();
    Some((number(begin)?, number(end.trim())?))
}

/// Kind, address and size of a line of the trace; `None` of any other line.
fn access(line: &str) -> Option<(char, u64, u64)> {
    let (kind, rest) = line.trim_start().split_once(' ')?;
    let kind = kind.chars().next().filter(|_| kind.len() == 1)?;
    let (address, size) = rest.trim_start().split_once(',')?;
    let address = u64::from_str_radix(address, 16).ok()?;
    Some((kind, address, size.trim().parse().ok()?))
}
