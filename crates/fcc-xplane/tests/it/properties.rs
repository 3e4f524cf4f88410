//! Arbitrary datagrams: nothing panics, and only finite, plausible values are
//! measured.

use std::collections::VecDeque;
use std::net::Ipv4Addr;
use std::sync::Mutex;

use crate::support::{Scripted, Ticks};
use fcc_core::flight::Measurements;
use fcc_core::framework::Sensor;
use fcc_xplane::protocol::{Kind, beacon, data, rpos, rref};
use fcc_xplane::{DataRows, Input, RowsVersion, XPlane, XPlaneConfig};
use proptest::collection::vec;
use proptest::prelude::*;

/// Any bytes, often with one of the four tags in front and a length that fits.
fn datagrams() -> impl Strategy<Value = Vec<u8>> {
    let tag = prop_oneof![
        Just(b"DATA*".to_vec()),
        Just(b"RREF,".to_vec()),
        Just(b"RPOS4".to_vec()),
        Just(b"BECN\0".to_vec()),
        vec(any::<u8>(), 0..6),
    ];
    let length = prop_oneof![
        0..200_usize,
        (0..20_usize).prop_map(|pairs| pairs * 8),
        (0..8_usize).prop_map(|rows| rows * 36),
        Just(64_usize),
    ];
    (tag, length.prop_flat_map(|length| vec(any::<u8>(), length)))
        .prop_map(|(tag, body)| [tag, body].concat())
}

/// Values under small indices, as a faulty simulator might send them.
fn arbitrary_values() -> impl Strategy<Value = Vec<u8>> {
    let value = prop_oneof![any::<f32>(), -400.0..400.0_f32, Just(f32::NAN)];
    vec((-2..40_i32, value), 0..40).prop_map(|pairs| {
        let mut datagram = b"RREF,".to_vec();
        for (index, value) in pairs {
            datagram.extend(index.to_le_bytes());
            datagram.extend(value.to_le_bytes());
        }
        datagram
    })
}

/// Rows that are read, with any columns.
fn arbitrary_rows() -> impl Strategy<Value = Vec<u8>> {
    let value = prop_oneof![any::<f32>(), -400.0..400.0_f32, Just(-999.0)];
    vec((0..26_i32, vec(value, 8)), 0..12).prop_map(|rows| {
        let mut datagram = b"DATA@".to_vec();
        for (index, columns) in rows {
            datagram.extend(index.to_le_bytes());
            datagram.extend(columns.into_iter().flat_map(f32::to_le_bytes));
        }
        datagram
    })
}

fn assert_plausible(m: &Measurements) {
    let turn = core::f64::consts::TAU;
    let half = core::f64::consts::PI;
    let quarter = core::f64::consts::FRAC_PI_2;
    assert!((-quarter..=quarter).contains(&m.attitude.value.pitch_rad));
    assert!((-half..=half).contains(&m.attitude.value.roll_rad));
    assert!((0.0..turn).contains(&m.heading_rad.value));
    assert!((-quarter..=quarter).contains(&m.position.value.latitude_rad));
    assert!((-half..=half).contains(&m.position.value.longitude_rad));
    for value in [
        m.body_rates.value.roll_radps,
        m.body_rates.value.pitch_radps,
        m.body_rates.value.yaw_radps,
        m.specific_force.value.x_mps2,
        m.specific_force.value.y_mps2,
        m.specific_force.value.z_mps2,
        m.airspeed_mps.value,
        m.altitude_m.value,
        m.angle_of_attack_rad.value,
        m.position.value.altitude_m,
        m.velocity.value.north_mps,
        m.velocity.value.east_mps,
        m.velocity.value.down_mps,
        m.plant.value.time_s,
    ] {
        assert!(value.is_finite());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn parsers_accept_any_datagram_and_give_finite_values(datagram in datagrams()) {
        let kind = Kind::of(&datagram);
        if let Ok(pairs) = rref::parse(&datagram) {
            prop_assert_eq!(kind, Some(Kind::Rref));
            prop_assert!(pairs.clone().count() <= datagram.len() / 8);
            prop_assert!(pairs.into_iter().all(|(_, value)| value.is_finite()));
        }
        if let Ok(rows) = data::parse(&datagram) {
            prop_assert_eq!(kind, Some(Kind::Data));
            prop_assert_eq!(data::size(rows.clone().count()), datagram.len());
            for column in rows.flat_map(|row| row.columns).flatten() {
                prop_assert!(column.is_finite() && column.to_bits() != 0xc479_c000);
            }
        }
        if let Ok(reply) = rpos::parse(&datagram) {
            prop_assert!(reply.latitude_deg.abs() <= 90.0);
            prop_assert!(reply.longitude_deg.abs() <= 180.0);
            prop_assert!(reply.elevation_m.is_finite() && reply.yaw_radps.is_finite());
        }
        if let Ok(beacon) = beacon::parse(&datagram) {
            prop_assert!(beacon.port != 0 && !beacon.name.contains(&0));
        }
    }

    #[test]
    fn rows_are_unchanged_by_writing_and_parsing(
        rows in vec((any::<i32>(), prop::array::uniform8(prop::option::of(-400.0..400.0_f32))), 0..8)
    ) {
        let rows: Vec<_> = rows
            .into_iter()
            .map(|(index, columns)| data::Row { index, columns })
            .collect();
        let mut buffer = vec![0; data::size(rows.len())];
        let written = data::write(&mut buffer, &rows).unwrap();
        prop_assert_eq!(data::parse(written).unwrap().collect::<Vec<_>>(), rows);
    }

    #[test]
    fn a_sensor_accepts_any_datagram_and_measures_plausible_values(
        ticks in vec(vec(prop_oneof![datagrams(), arbitrary_values(), arbitrary_rows()], 0..4), 1..12),
        by_rows: bool,
        version in prop_oneof![
            Just(RowsVersion::XPlane9),
            Just(RowsVersion::XPlane10),
            Just(RowsVersion::XPlane12)
        ],
    ) {
        let config = XPlaneConfig {
            local_port: 49_005,
            input: if by_rows { Input::Data(DataRows::of(version)) } else { Input::Rref },
            ..XPlaneConfig::default()
        };
        let script: VecDeque<_> = ticks.iter().flatten().cloned().collect();
        let port = Scripted {
            from: (Ipv4Addr::LOCALHOST, 49_000).into(),
            datagrams: Mutex::new(script),
        };
        let (mut sensor, _actuator) =
            XPlane::over(&config, port, None).unwrap();
        let mut clock = Ticks::new();
        let mut measurements = Measurements::default();
        for _ in 0..ticks.len() {
            let _ = sensor.sample(&clock.next(), &mut measurements);
            assert_plausible(&measurements);
        }
    }
}
