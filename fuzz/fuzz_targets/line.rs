//! The socket for commands of other users: any bytes, in parts of any size;
//! the line does not depend on them, and its answer is one line.
//!
//! The first byte is the size of the parts.
#![no_main]

use fcc_fixed_wing::Autopilot;
use fcc_flight::flight::{answer_as_received, command_of, line_of_parts};
use fcc_live::{InvalidCommand, PlantLimits, Verdict};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((part, bytes)) = input.split_first() else {
        return;
    };
    let line = line_of_parts(bytes, usize::from(*part));
    assert_eq!(line, line_of_parts(bytes, bytes.len()));
    let Some(Ok(line)) = line else {
        return;
    };
    assert!(line.len() < 512 && !line.contains('\n'));
    let _ = answer_as_received(Ok(&line));
    let refused = match command_of(&line) {
        Err(why) => Verdict::Refused(why.to_owned()),
        Ok(command) => match command.for_the_loop::<Autopilot>(&PlantLimits::new()) {
            Ok(parts) => {
                assert!((1..=6).contains(&parts.len()));
                return;
            }
            Err(InvalidCommand::Outside(outside)) => Verdict::Outside(outside),
            Err(invalid) => Verdict::Refused(invalid.to_string()),
        },
    };
    assert!(matches!(answer_as_received(Err(&refused)), Some(Err(_))));
});
