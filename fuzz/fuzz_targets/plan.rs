//! Files of plans, of both formats: any text is refused, or read and written again
//! as the same plan.
#![no_main]

use fcc_plan::{Format, read, write};

libfuzzer_sys::fuzz_target!(|text: &str| {
    let Ok(plan) = read(text) else {
        return;
    };
    let json = write(&plan, Format::QgcPlan).unwrap_or_default();
    assert_eq!(read(&json).as_ref(), Ok(&plan));
    if let Ok(text) = write(&plan, Format::QgcWpl) {
        assert_eq!(read(&text).as_ref(), Ok(&plan));
    }
});
