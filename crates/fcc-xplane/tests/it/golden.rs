//! Datagrams written out byte by byte from the documented layouts, compared
//! with parsers and builders.

use fcc_xplane::protocol::beacon::{self, Host, Role};
use fcc_xplane::protocol::data::{self, Row};
use fcc_xplane::protocol::{Kind, Malformed, PathError, cmnd, dref, rpos, rref};

#[rustfmt::skip]
const RREF_11: [u8; 29] = [
    b'R', b'R', b'E', b'F', b',',
    0x07, 0x00, 0x00, 0x00,  0x00, 0x00, 0xc8, 0x42, // 7: 100.0
    0x00, 0x00, 0x00, 0x00,  0x00, 0x00, 0x00, 0xbf, // 0: -0.5
    0xff, 0xff, 0xff, 0xff,  0x00, 0x00, 0x80, 0x3f, // -1: 1.0
];

#[rustfmt::skip]
const RPOS_4: [u8; 69] = [
    b'R', b'P', b'O', b'S', b'4',
    0, 0, 0, 0, 0, 0x80, 0x5e, 0xc0, // longitude -122.0
    0, 0, 0, 0, 0, 0xc0, 0x47, 0x40, // latitude 47.5
    0, 0, 0, 0, 0, 0x40, 0x8f, 0x40, // elevation 1000.0
    0x00, 0x00, 0x16, 0x44,          // height 600.0
    0x00, 0x00, 0x20, 0x40,          // pitch 2.5
    0x00, 0x00, 0x87, 0x43,          // true heading 270.0
    0x00, 0x00, 0xf0, 0xc1,          // roll -30.0
    0x00, 0x00, 0x48, 0xc2,          // east -50.0
    0x00, 0x00, 0x80, 0x3f,          // up 1.0
    0x00, 0x00, 0x80, 0x40,          // south 4.0
    0x00, 0x00, 0x00, 0x3e,          // P 0.125
    0x00, 0x00, 0x80, 0xbe,          // Q -0.25
    0x00, 0x00, 0x00, 0x3f,          // R 0.5
];

#[rustfmt::skip]
const DATA_11: [u8; 77] = [
    b'D', b'A', b'T', b'A', b'*',
    0x11, 0x00, 0x00, 0x00, // row 17
    0x00, 0x00, 0x20, 0x40, 0x00, 0x00, 0xf0, 0xc1, // 2.5, -30.0
    0x00, 0x00, 0x87, 0x43, 0x00, 0x00, 0x84, 0x43, // 270.0, 264.0
    0x00, 0xc0, 0x79, 0xc4, 0x00, 0xc0, 0x79, 0xc4, // -999.0 twice
    0x00, 0xc0, 0x79, 0xc4, 0x00, 0x00, 0xc0, 0x7f, // -999.0, NaN
    0x03, 0x00, 0x00, 0x00, // row 3
    0x00, 0x00, 0xc8, 0x42, 0x00, 0x00, 0xc8, 0x42, // 100.0 in every column
    0x00, 0x00, 0xc8, 0x42, 0x00, 0x00, 0xc8, 0x42,
    0x00, 0x00, 0xc8, 0x42, 0x00, 0x00, 0xc8, 0x42,
    0x00, 0x00, 0xc8, 0x42, 0x00, 0x00, 0xc8, 0x42,
];

#[rustfmt::skip]
const BECN: [u8; 26] = [
    b'B', b'E', b'C', b'N', 0x00,
    0x01, 0x02,             // 1.2
    0x01, 0x00, 0x00, 0x00, // X-Plane
    0x2d, 0xc3, 0x01, 0x00, // 115501
    0x01, 0x00, 0x00, 0x00, // master
    0x68, 0xbf,             // port 49000
    b'f', b'l', b'y', 0x00, 0x00,
];

/// The same datagram with another fifth byte: version 9/10, 11/12, any.
fn with_fifth<const N: usize>(mut datagram: [u8; N], fifth: u8) -> [u8; N] {
    datagram[4] = fifth;
    datagram
}

#[test]
fn the_fifth_byte_is_ignored() {
    for fifth in [b'@', b'*', b'O', b',', b'4', 0, 0xff] {
        assert!(data::parse(&with_fifth(DATA_11, fifth)).is_ok());
        assert!(rref::parse(&with_fifth(RREF_11, fifth)).is_ok());
        assert!(rpos::parse(&with_fifth(RPOS_4, fifth)).is_ok());
        assert!(beacon::parse(&with_fifth(BECN, fifth)).is_ok());
    }
    assert_eq!(Kind::of(b"DATA@"), Some(Kind::Data));
    assert_eq!(Kind::of(b"DATA"), None);
    assert_eq!(Kind::of(b"DATB@"), None);
    assert_eq!(Kind::of(b"data@"), None);
}

#[test]
fn values_are_read_in_whatever_order_they_come() {
    let pairs: Vec<_> = rref::parse(&RREF_11).unwrap().collect();
    assert_eq!(pairs, [(7, 100.0), (0, -0.5), (-1, 1.0)]);
}

#[test]
fn a_full_datagram_of_183_values_is_read_whole() {
    let mut datagram = b"RREFO".to_vec();
    for index in 0..183_i32 {
        datagram.extend(index.to_le_bytes());
        datagram.extend([0, 0, 0x80, 0x3f]);
    }
    assert_eq!(datagram.len(), 1_469);
    assert_eq!(rref::parse(&datagram).unwrap().count(), 183);
}

#[test]
fn a_position_is_read_in_double_precision() {
    let reply = rpos::parse(&RPOS_4).unwrap();
    let expected = rpos::Rpos {
        longitude_deg: -122.0,
        latitude_deg: 47.5,
        elevation_m: 1_000.0,
        height_m: 600.0,
        pitch_deg: 2.5,
        true_heading_deg: 270.0,
        roll_deg: -30.0,
        east_mps: -50.0,
        up_mps: 1.0,
        south_mps: 4.0,
        roll_radps: 0.125,
        pitch_radps: -0.25,
        yaw_radps: 0.5,
    };
    assert_eq!(reply, expected);
}

#[test]
fn a_position_that_is_not_on_earth_is_refused() {
    let mut reply = RPOS_4;
    reply[20] = 0x50; // latitude 4·47.5…
    assert_eq!(rpos::parse(&reply), Err(Malformed::Field));
    let mut reply = RPOS_4;
    reply[11..13].copy_from_slice(&[0xf0, 0x7f]); // longitude infinite
    assert_eq!(rpos::parse(&reply), Err(Malformed::Field));
    let mut reply = RPOS_4;
    reply[65..69].copy_from_slice(&[0, 0, 0xc0, 0x7f]); // R not a number
    assert_eq!(rpos::parse(&reply), Err(Malformed::Field));
}

#[test]
fn rows_are_read_with_what_is_not_there_left_out() {
    let rows: Vec<_> = data::parse(&DATA_11).unwrap().collect();
    let attitude = Row {
        index: 17,
        columns: [
            Some(2.5),
            Some(-30.0),
            Some(270.0),
            Some(264.0),
            None,
            None,
            None,
            None,
        ],
    };
    let speeds = Row {
        index: 3,
        columns: [Some(100.0); 8],
    };
    assert_eq!(rows, [attitude, speeds]);
    // One row a datagram, and none.
    assert_eq!(data::parse(&DATA_11[..41]).unwrap().count(), 1);
    assert_eq!(data::parse(&DATA_11[..5]).unwrap().count(), 0);
}

#[test]
fn a_beacon_gives_port_and_version() {
    let beacon = beacon::parse(&BECN).unwrap();
    assert_eq!(beacon.minor, 2);
    assert_eq!(beacon.host, Host::XPlane);
    assert_eq!(beacon.version, 115_501);
    assert_eq!(beacon.role, Role::Master);
    assert_eq!(beacon.port, 49_000);
    assert_eq!(beacon.name, b"fly");
    assert!(beacon.is_flyable());
    // The name may fill the rest without a NUL, or be empty.
    assert_eq!(beacon::parse(&BECN[..23]).unwrap().name, b"fl");
    assert_eq!(beacon::parse(&BECN[..21]).unwrap().name, b"");
}

#[test]
fn a_beacon_with_any_one_wrong_field_is_refused() {
    // (byte, value): major, minor, host, version, role, port
    for (byte, value) in [
        (5, 2),
        (6, 0),
        (7, 3),
        (14, 0x80),
        (13, 0),
        (15, 4),
        (18, 1),
    ] {
        let mut datagram = BECN;
        datagram[byte] = value;
        assert_eq!(beacon::parse(&datagram), Err(Malformed::Field), "{byte}");
    }
    let mut datagram = BECN;
    datagram[19..21].copy_from_slice(&[0, 0]);
    assert_eq!(beacon::parse(&datagram), Err(Malformed::Field));
    let mut plane_maker = BECN;
    plane_maker[7] = 2;
    assert!(!beacon::parse(&plane_maker).unwrap().is_flyable());
    let mut visual = BECN;
    visual[15] = 2;
    assert!(!beacon::parse(&visual).unwrap().is_flyable());
}

/// Cut at every length: read only where a whole number of entries is left.
#[test]
fn cut_datagrams_are_refused() {
    for cut in 0..RREF_11.len() {
        let whole = cut >= 5 && (cut - 5) % 8 == 0;
        assert_eq!(rref::parse(&RREF_11[..cut]).is_ok(), whole, "RREF {cut}");
    }
    for cut in 0..RPOS_4.len() {
        assert!(rpos::parse(&RPOS_4[..cut]).is_err(), "RPOS {cut}");
    }
    for cut in 0..DATA_11.len() {
        let whole = cut >= 5 && (cut - 5) % 36 == 0;
        assert_eq!(data::parse(&DATA_11[..cut]).is_ok(), whole, "DATA {cut}");
    }
    for cut in 0..21 {
        assert!(beacon::parse(&BECN[..cut]).is_err(), "BECN {cut}");
    }
}

#[test]
fn one_message_is_not_taken_for_another() {
    assert_eq!(rref::parse(&DATA_11).unwrap_err(), Malformed::Tag);
    assert_eq!(data::parse(&RREF_11).unwrap_err(), Malformed::Tag);
    assert_eq!(rpos::parse(&RREF_11).unwrap_err(), Malformed::Tag);
    assert_eq!(beacon::parse(&RPOS_4).unwrap_err(), Malformed::Tag);
}

#[test]
fn a_subscription_is_413_bytes() {
    let mut request = [0xaa; rref::REQUEST_BYTES];
    rref::request(&mut request, 60, 258, "sim/time/paused").unwrap();
    let mut expected = [0_u8; 413];
    expected[..13].copy_from_slice(&[b'R', b'R', b'E', b'F', 0, 60, 0, 0, 0, 0x02, 0x01, 0, 0]);
    expected[13..28].copy_from_slice(b"sim/time/paused");
    assert_eq!(request, expected);
    rref::set_frequency(&mut request, 0);
    expected[5] = 0;
    assert_eq!(request, expected);
}

#[test]
fn a_position_request_spells_its_frequency() {
    for (hz, digits) in [
        (0, "0"),
        (7, "7"),
        (10, "10"),
        (60, "60"),
        (105, "105"),
        (65_535, "65535"),
    ] {
        let mut buffer = [0xaa; rpos::REQUEST_BYTES];
        let expected = format!("RPOS\0{digits}\0");
        assert_eq!(rpos::request(&mut buffer, hz), expected.as_bytes());
    }
}

#[test]
fn a_write_is_509_bytes() {
    let mut write = [0xaa; dref::WRITE_BYTES];
    dref::write(&mut write, 1.0, "sim/operation/override/override_joystick").unwrap();
    let mut expected = [0_u8; 509];
    expected[..9].copy_from_slice(&[b'D', b'R', b'E', b'F', 0, 0, 0, 0x80, 0x3f]);
    expected[9..49].copy_from_slice(b"sim/operation/override/override_joystick");
    assert_eq!(write, expected);
    dref::set_value(&mut write, -0.5);
    expected[5..9].copy_from_slice(&[0, 0, 0, 0xbf]);
    assert_eq!(write, expected);
}

#[test]
fn a_command_is_its_path_closed_by_nul() {
    let mut buffer = [0xaa; cmnd::COMMAND_BYTES];
    let sent = cmnd::write(&mut buffer, "sim/operation/pause_toggle").unwrap();
    assert_eq!(sent, b"CMND\0sim/operation/pause_toggle\0");
    assert_eq!(cmnd::write(&mut buffer, ""), Err(PathError::Empty));
    let longest = "a".repeat(499);
    assert_eq!(cmnd::write(&mut buffer, &longest).unwrap().len(), 505);
    assert!(cmnd::write(&mut buffer, &"a".repeat(500)).is_err());
}

#[test]
fn a_row_is_written_with_999_where_nothing_changes() {
    let mut columns = [None; 8];
    columns[0] = Some(2.5);
    columns[1] = Some(-30.0);
    columns[2] = Some(270.0);
    columns[3] = Some(264.0);
    let mut buffer = [0xaa; data::size(1)];
    let written = data::write(&mut buffer, &[Row { index: 17, columns }]).unwrap();
    let mut expected = with_fifth(DATA_11, 0);
    expected[37..41].copy_from_slice(&[0x00, 0xc0, 0x79, 0xc4]);
    assert_eq!(written, &expected[..41]);
    assert_eq!(
        data::write(&mut [0; 40], &[Row { index: 17, columns }]),
        None
    );
}

#[test]
fn a_path_that_cannot_be_sent_leaves_the_buffer_alone() {
    let mut request = [0xaa; rref::REQUEST_BYTES];
    let mut write = [0xaa; dref::WRITE_BYTES];
    for (path, error) in [("", PathError::Empty), ("sim/a b", PathError::NotPrintable)] {
        assert_eq!(rref::request(&mut request, 1, 0, path), Err(error));
        assert_eq!(dref::write(&mut write, 0.0, path), Err(error));
    }
    for (length, fits_request, fits_write) in [
        (399, true, true),
        (400, false, true),
        (499, false, true),
        (500, false, false),
    ] {
        let path = "a".repeat(length);
        assert_eq!(
            rref::request(&mut request, 1, 0, &path).is_ok(),
            fits_request
        );
        assert_eq!(dref::write(&mut write, 0.0, &path).is_ok(), fits_write);
        // The closing NUL is always there.
        assert_eq!((request[412], write[508]), (0, 0));
    }
    assert_eq!(
        dref::write(&mut write, 0.0, &"a".repeat(500)),
        Err(PathError::TooLong {
            length: 500,
            limit: 499
        })
    );
}
