//! Serial lines: any bytes, cut anywhere. The first byte chooses the protocol,
//! the second where the rest is cut; what is found does not depend on that, and a
//! fix is on the earth.
#![no_main]

use core::f64::consts::{FRAC_PI_2, PI};

use fcc_core::flight::GnssFix;
use fcc_core::framework::Time;
use fcc_linux::serial::{
    Crsf, Epoch, Epochs, Frames, Nmea, Protocol, ReceiverFrame, Sbus, Ubx, UbxMessage,
};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let [kind, cut, bytes @ ..] = input else {
        return;
    };
    let cut = usize::from(*cut);
    match kind % 4 {
        0 => found::<Ubx>(bytes, cut).into_iter().for_each(|message| match message {
            UbxMessage::NavPvt(pvt) => _ = pvt.usable(),
            UbxMessage::Configured(_) => {}
        }),
        1 => {
            let mut epochs = Epochs::default();
            let sentences = found::<Nmea>(bytes, cut).into_iter();
            sentences.for_each(|sentence| {
                if let Epoch::Complete(fix) = epochs.take(sentence, Time::from_nanos(0)) {
                    check(&fix.value);
                }
            });
        }
        2 => found::<Sbus>(bytes, cut).iter().for_each(in_range),
        _ => found::<Crsf>(bytes, cut).iter().for_each(in_range),
    }
});

fn found<P: Protocol<Frame: PartialEq + core::fmt::Debug>>(bytes: &[u8], cut: usize) -> Vec<P::Frame> {
    let (first, second) = bytes.split_at(cut.min(bytes.len()));
    let (mut cut, mut whole) = (Vec::new(), Vec::new());
    let mut frames = Frames::<P>::default();
    frames.push(first, |frame| cut.push(frame));
    frames.push(second, |frame| cut.push(frame));
    Frames::<P>::default().push(bytes, |frame| whole.push(frame));
    assert_eq!(cut, whole);
    whole
}

fn check(fix: &GnssFix) {
    assert!(fix.position.latitude_rad.abs() <= FRAC_PI_2);
    assert!(fix.position.longitude_rad.abs() <= PI);
    let velocity = fix.velocity;
    let numbers = [fix.position.altitude_m, velocity.north_mps, velocity.east_mps, velocity.down_mps];
    assert!(numbers.iter().all(|number| number.is_finite()));
}

fn in_range(frame: &ReceiverFrame) {
    if let ReceiverFrame::Channels { channels, .. } = frame {
        assert!(channels.iter().all(|channel| *channel < 2_048));
    }
}
