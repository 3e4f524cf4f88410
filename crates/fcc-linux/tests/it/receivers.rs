//! What RC receivers say, as other programs decode it.

use fcc_core::flight::PilotControls;
use fcc_core::framework::Switch;
use fcc_linux::serial::{
    Crsf, Frames, Pilot, Protocol, RcChannel, RcChannels, RcValues, ReceiverFrame, Sbus, position,
    pulse_us,
};

fn found<P: Protocol>(bytes: &[u8]) -> Vec<P::Frame> {
    let mut found = Vec::new();
    Frames::<P>::default().push(bytes, |frame| found.push(frame));
    found
}

fn sbus(bytes: &[u8; 25]) -> ([u16; 16], bool, bool) {
    match found::<Sbus>(bytes)[..] {
        [
            ReceiverFrame::Channels {
                channels,
                is_lost,
                is_failsafe,
            },
        ] => (channels, is_lost, is_failsafe),
        ref other => panic!("{other:?}"),
    }
}

/// The vector of the crate `sbus` (its `parse_tester.rs`), whose flags are those
/// of channels 17 and 18.
#[test]
fn channels_of_sbus_are_those_of_another_decoder() {
    let frame = [
        0x0f, 0xe0, 0x03, 0x1f, 0x58, 0xc0, 0x07, 0x16, 0xb0, 0x80, 0x05, 0x2c, 0x60, 0x01, 0x0b,
        0xf8, 0xc0, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x03, 0x00,
    ];
    let channels = [
        992, 992, 352, 992, 352, 352, 352, 352, 352, 352, 992, 992, 0, 0, 0, 0,
    ];
    assert_eq!(sbus(&frame), (channels, false, false));
}

/// A frame with random content, as the library of zendes (github.com/zendes/SBUS)
/// decodes it: 0x85 has flags of a kind that no receiver sets, so its last nibble
/// is taken with each of lost frame and failsafe.
#[test]
fn sbus_tells_a_lost_frame_and_failsafe() {
    let frame = |flags: u8| {
        [
            0x0f, 0x1a, 0x28, 0xa2, 0x95, 0x7c, 0x07, 0xea, 0x05, 0xf6, 0xce, 0xbf, 0x61, 0xad,
            0x79, 0x3f, 0x2d, 0xb7, 0xca, 0xfa, 0x62, 0x87, 0x0d, flags, 0x00,
        ]
    };
    let channels = [
        0x01a, 0x445, 0x256, 0x3be, 0x6a0, 0x40b, 0x3bd, 0x5fe, 0x561, 0x735, 0x4fd, 0x396, 0x4ab,
        0x5f5, 0x1d8, 0x06c,
    ];
    assert_eq!(sbus(&frame(0x01)), (channels, false, false));
    assert_eq!(sbus(&frame(0x04)), (channels, true, false));
    assert_eq!(sbus(&frame(0x0c)), (channels, true, true));
    let mut frames = Frames::<Sbus>::default();
    frames.push(&frame(0x85), |frame| panic!("{frame:?}"));
    assert_eq!(frames.damaged(), 1);
}

/// Channels whose bits look like the beginning of a frame: bytes 1 and 25 of the
/// stream are header and end, too. Silence tells.
#[test]
fn silence_on_the_line_tells_where_a_frame_of_sbus_begins() {
    let mut frame = [0; 25];
    (frame[0], frame[1]) = (0x0f, 0x0f);
    let twice = [frame, frame].concat();
    let mut frames = Frames::<Sbus>::default();
    // Switched on within a frame.
    frames.push(&frame[1..], |frame| panic!("{frame:?}"));
    frames.restart();
    let mut found = Vec::new();
    frames.push(&twice, |frame| found.push(frame));
    let channels = core::array::from_fn(|channel| if channel == 0 { 0x0f } else { 0 });
    let expected = ReceiverFrame::Channels {
        channels,
        is_lost: false,
        is_failsafe: false,
    };
    assert_eq!(found, [expected, expected]);
}

/// A capture of a Crossfire receiver in Betaflight's `rx_crsf_unittest.cc`, with the
/// address that receivers have used since. Channels 0 to 3 are 189, 993, 978, 983,
/// and 999, 1501, 1492, 1495 µs there, rounded to whole ones.
const CAPTURED: [u8; 26] = [
    0xc8, 0x18, 0x16, 0xbd, 0x08, 0x9f, 0xf4, 0xae, 0xf7, 0xbd, 0xef, 0x7d, 0xef, 0xfb, 0xad, 0xfd,
    0x45, 0x2b, 0x5a, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x6c,
];

#[test]
fn channels_of_crsf_are_those_of_betaflight() {
    let [
        ReceiverFrame::Channels {
            channels,
            is_lost: false,
            is_failsafe: false,
        },
    ] = found::<Crsf>(&CAPTURED)[..]
    else {
        panic!("channels");
    };
    assert_eq!(channels[..4], [189, 993, 978, 983]);
    for (channel, us) in channels.iter().zip([999.0, 1_501.0, 1_492.0, 1_495.0]) {
        assert!((pulse_us(*channel) - us).abs() < 1.0, "{channel}");
    }
}

#[test]
fn a_damaged_frame_of_crsf_is_counted_and_gives_nothing() {
    for at in 3..26 {
        let mut frame = CAPTURED;
        frame[at] ^= 0x40;
        let mut frames = Frames::<Crsf>::default();
        frames.push(&frame, |frame| panic!("{frame:?}"));
        assert_eq!(frames.damaged(), 1, "byte {at}");
    }
}

/// By TBS' specification: uplink RSSI twice, quality, signal to noise, and more;
/// the checksums by `crcmod` of Python, `Crc(0x1d5, initCrc=0, rev=False)`.
#[test]
fn link_statistics_tell_the_quality_of_the_link() {
    for (quality_percent, checksum) in [(100, CRC_100), (0, CRC_0)] {
        let frame = [
            0xc8,
            0x0c,
            0x14,
            0x10,
            0x10,
            quality_percent,
            0x0a,
            0x00,
            0x02,
            0x03,
            0x20,
            0x64,
            0x0a,
            checksum,
        ];
        assert_eq!(
            found::<Crsf>(&frame),
            [ReceiverFrame::Link { quality_percent }]
        );
    }
}

const CRC_100: u8 = 0x03;
const CRC_0: u8 = 0x01;

/// 172, 992 and 1811 are 988, 1500 and 2012 µs in TBS' specification.
#[test]
fn the_ends_of_travel_are_full_deflection() {
    assert!((pulse_us(172) - 988.0).abs() < 1.0 && (pulse_us(1811) - 2_012.0).abs() < 1.0);
    assert_eq!((pulse_us(992), position(992)), (1_500.0, 0.0));
    assert!((position(172) + 1.0).abs() < 2e-3 && (position(1811) - 1.0).abs() < 2e-3);
    assert_eq!((position(0), position(2_047)), (-1.0, 1.0));
}

const STICKS: RcChannels = RcChannels {
    switch: RcChannel {
        number: 5,
        is_reversed: false,
    },
    on_above_us: 1_700.0,
    controls: Some([
        RcChannel {
            number: 2,
            is_reversed: true,
        },
        RcChannel {
            number: 1,
            is_reversed: false,
        },
        RcChannel {
            number: 4,
            is_reversed: false,
        },
    ]),
};

/// Roll full right, pitch full to one side, yaw in the middle; the switch.
fn frame(switch: u16, is_lost: bool, is_failsafe: bool) -> ReceiverFrame {
    let mut channels = [992; 16];
    (channels[0], channels[1], channels[4]) = (2_000, 2_000, switch);
    ReceiverFrame::Channels {
        channels,
        is_lost,
        is_failsafe,
    }
}

const ON: u16 = 1_811;
const OFF: u16 = 172;

#[test]
fn a_switch_changes_after_three_frames() {
    let mut pilot = Pilot::new(STICKS);
    let mut after = |switch| pilot.take(&frame(switch, false, false)).unwrap().switch;
    assert_eq!(
        [OFF, OFF, OFF].map(&mut after),
        [None, None, Some(Switch::Off)]
    );
    assert_eq!([ON, OFF, ON, ON].map(&mut after), [Some(Switch::Off); 4]);
    assert_eq!([ON, OFF, OFF].map(&mut after), [Some(Switch::On); 3]);
    assert_eq!(after(OFF), Some(Switch::Off));
    // The middle position of three.
    assert_eq!([ON, ON, ON, 992, 992, 992].map(after)[5], Some(Switch::Off));
}

#[test]
fn sticks_have_the_signs_that_are_set() {
    let values = Pilot::new(STICKS).take(&frame(OFF, false, false)).unwrap();
    let expected = PilotControls {
        pitch: -1.0,
        roll: 1.0,
        yaw: 0.0,
    };
    assert_eq!(values.controls, Some(expected));
    let unused = RcChannels {
        controls: None,
        ..STICKS
    };
    let values = Pilot::new(unused).take(&frame(OFF, false, false)).unwrap();
    assert_eq!(values.controls, None);
}

#[test]
fn a_reversed_switch_is_on_at_the_other_end() {
    let switch = RcChannel {
        is_reversed: true,
        ..STICKS.switch
    };
    let mut pilot = Pilot::new(RcChannels { switch, ..STICKS });
    let mut after = |switch| pilot.take(&frame(switch, false, false)).unwrap().switch;
    assert_eq!([OFF, OFF, OFF].map(&mut after)[2], Some(Switch::On));
    assert_eq!([ON, ON, ON].map(after)[2], Some(Switch::Off));
}

/// At once; and when the transmitter is back, until the pilot has switched it off and
/// on: a flight that went to standby must not engage because of a radio link.
#[test]
fn a_lost_transmitter_is_a_switch_that_is_off() {
    let lost = RcValues {
        switch: Some(Switch::Off),
        controls: None,
    };
    let link = |quality_percent| ReceiverFrame::Link { quality_percent };
    for (is_lost, back) in [
        (frame(ON, false, true), frame(ON, false, false)),
        (frame(ON, true, true), frame(ON, false, false)),
        (link(0), link(90)),
    ] {
        let mut pilot = Pilot::new(STICKS);
        for _ in 0..3 {
            pilot.take(&frame(ON, false, false));
        }
        assert_eq!(pilot.take(&is_lost), Some(lost));
        if matches!(is_lost, ReceiverFrame::Link { .. }) {
            // The receiver may go on sending what it is set to.
            assert_eq!(pilot.take(&frame(ON, false, false)), Some(lost));
        }
        pilot.take(&back);
        let mut after = |switch| pilot.take(&frame(switch, false, false)).unwrap();
        assert!(after(ON).controls.is_some());
        for switch in [[ON; 4], [OFF; 4]].concat() {
            assert_eq!(after(switch).switch, Some(Switch::Off));
        }
        assert_eq!([ON; 3].map(after)[2].switch, Some(Switch::On));
    }
}

#[test]
fn a_frame_that_repeats_the_last_channels_says_nothing() {
    let mut pilot = Pilot::new(STICKS);
    assert_eq!(pilot.take(&frame(ON, true, false)), None);
    assert_eq!(
        pilot.take(&ReceiverFrame::Link {
            quality_percent: 80
        }),
        None
    );
}
