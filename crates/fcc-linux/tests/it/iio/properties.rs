//! What the kernel's files say may be anything.

use fcc_linux::iio::{Matrix, ScanLayout, ScanType};
use proptest::prelude::*;

/// A type, its text, and its greatest number.
fn types() -> impl Strategy<Value = (ScanType, String, u32, bool)> {
    let storage = prop::sample::select(vec![8_u32, 16, 32, 64]);
    let parts = (storage, any::<bool>(), any::<bool>()).prop_flat_map(|(storage, big, signed)| {
        (1..=storage).prop_flat_map(move |bits| {
            (0..=storage - bits).prop_map(move |shift| (storage, big, signed, bits, shift))
        })
    });
    parts.prop_map(|(storage, big, signed, bits, shift)| {
        let (order, sign) = (
            if big { "be" } else { "le" },
            if signed { 's' } else { 'u' },
        );
        let text = format!("{order}:{sign}{bits}/{storage}>>{shift}");
        (text.parse().unwrap(), text, bits, signed)
    })
}

proptest! {
    #[test]
    fn a_number_has_no_more_than_its_bits(
        (stored, text, bits, signed) in types(),
        bytes in prop::array::uniform8(any::<u8>()),
    ) {
        let number = stored.decode(&bytes).unwrap();
        if bits < 64 {
            let half = 1_i128 << (bits - 1);
            let (least, most) = if signed { (-half, half - 1) } else { (0, 2 * half - 1) };
            prop_assert!((least..=most).contains(&number.into()), "{text}: {number}");
        }
        prop_assert_eq!(stored.decode(&bytes[..stored.bytes() - 1]), None);
    }

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,40}") {
        let _ = text.parse::<ScanType>();
        let _ = text.parse::<Matrix>();
    }

    #[test]
    fn elements_do_not_overlap(all in prop::collection::vec(types(), 1..12)) {
        let numbered = (0..).zip(&all).map(|(index, (stored, ..))| (index, 0, *stored));
        let layout = ScanLayout::new(numbered.collect());
        let sum: usize = all.iter().map(|(stored, ..)| stored.bytes()).sum();
        prop_assert!(layout.bytes() >= sum);
        let scan = vec![0xFF; layout.bytes()];
        for element in layout.elements() {
            prop_assert!(element.decode(&scan).is_some());
        }
    }
}
