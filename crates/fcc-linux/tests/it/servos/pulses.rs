//! Pulses, and the files of PWM that they are written to.

use fcc_linux::servo::{Drives, PulseOutputs, PwmOutput, ServoChannel, ServoError, SysfsPwm};

use super::pwm_folder::PwmFolder;
#[test]
fn pulses_are_within_their_ends() {
    let channel = ServoChannel {
        min_us: 1_100.0,
        centre_us: 1_480.0,
        max_us: 1_900.0,
        ..ServoChannel::new(Drives::Aileron)
    };
    for (position, us) in [
        (-1.0, 1_100.0),
        (-0.5, 1_290.0),
        (0.0, 1_480.0),
        (0.5, 1_690.0),
        (1.0, 1_900.0),
    ] {
        assert_eq!(channel.pulse_us(position), us);
    }
    for (position, us) in [(-9.0, 1_100.0), (9.0, 1_900.0), (f64::NAN, 1_480.0)] {
        assert_eq!(channel.pulse_us(position), us);
    }
    let reversed = ServoChannel {
        is_reversed: true,
        ..channel
    };
    assert_eq!(
        [-1.0, 0.0, 1.0].map(|at| reversed.pulse_us(at)),
        [1_900.0, 1_480.0, 1_100.0]
    );
    // A tenth of 420 us; the ends stay.
    let trimmed = ServoChannel {
        trim: 0.1,
        ..channel
    };
    assert_eq!(
        [0.0, 1.0].map(|at| trimmed.pulse_us(at)),
        [1_522.0, 1_900.0]
    );
    let throttle = ServoChannel::new(Drives::Throttle);
    assert_eq!(
        [0.0, 0.25, 1.0].map(|at| throttle.pulse_us(at)),
        [1_000.0, 1_250.0, 2_000.0]
    );
    let reversed = ServoChannel {
        is_reversed: true,
        ..throttle
    };
    assert_eq!(
        [0.0, 0.25, 1.0].map(|at| reversed.pulse_us(at)),
        [2_000.0, 1_750.0, 1_000.0]
    );
}

#[test]
fn an_impossible_channel_is_refused() {
    let channel = ServoChannel::new(Drives::Rudder);
    let pulses = ServoChannel {
        centre_us: 2_100.0,
        ..channel
    };
    assert!(matches!(pulses.validate(), Err(ServoError::Pulses { .. })));
    let failsafe = ServoChannel {
        failsafe: -0.1,
        ..ServoChannel::new(Drives::Throttle)
    };
    assert_eq!(
        failsafe.validate().unwrap_err().to_string(),
        "a failsafe position of -0.1 is out of range: choose 0 to 1"
    );
    for drives in [
        Drives::Throttle,
        Drives::Flaps,
        Drives::LeftBrake,
        Drives::RightBrake,
        Drives::Gear,
    ] {
        let trim = ServoChannel {
            trim: 0.1,
            ..ServoChannel::new(drives)
        };
        assert_eq!(trim.validate(), Err(ServoError::Trim));
    }
    let nose_wheel = ServoChannel {
        trim: 0.1,
        ..ServoChannel::new(Drives::NoseWheel)
    };
    assert_eq!(nose_wheel.validate(), Ok(()));
    assert_eq!(channel.validate(), Ok(()));
}

/// 50 Hz are 20,000,000 ns, 1.5 ms are 1,500,000 (the kernel's unit).
#[test]
fn pulses_are_written_to_the_files_of_pwm() {
    let folder = PwmFolder::new(2, "1000000");
    let mut pwm = SysfsPwm::open(&folder.outputs(2), 50.0).unwrap();
    assert_eq!(folder.has(0, "period"), "20000000");
    assert_eq!(folder.has(0, "enable"), "0");
    pwm.write(&[Some(1_500.0), None]).unwrap();
    assert_eq!(
        (folder.has(0, "duty_cycle"), folder.has(0, "enable")),
        ("1500000".into(), "1".into())
    );
    assert_eq!(folder.has(1, "enable"), "0");
    pwm.write(&[None, Some(900.0)]).unwrap();
    assert_eq!(folder.has(0, "enable"), "0");
    assert_eq!(
        (folder.has(1, "duty_cycle"), folder.has(1, "enable")),
        ("900000".into(), "1".into())
    );
}

/// Two daemons that write one servo, or two entries of a configuration.
#[test]
fn an_output_is_driven_by_one() {
    let folder = PwmFolder::new(2, "1000000");
    let outputs = folder.outputs(2);
    let mut first = SysfsPwm::open(&outputs[1..], 50.0).unwrap();
    first.write(&[Some(1_500.0)]).unwrap();
    let error = SysfsPwm::open(&outputs, 50.0).unwrap_err().to_string();
    assert!(
        error.contains("pwm1/period: another fccd on this machine has it"),
        "{error}"
    );
    assert_eq!(
        folder.has(1, "enable"),
        "1",
        "the other one's start wrote nothing"
    );
    drop(first);
    SysfsPwm::open(&outputs, 50.0).unwrap();
}

#[test]
fn a_pwm_that_is_not_there_is_an_error_with_its_path() {
    let missing = PwmOutput {
        chip: "/sys/class/pwm/pwmchip99".into(),
        number: 0,
    };
    let error = SysfsPwm::open(&[missing], 50.0).unwrap_err().to_string();
    assert!(
        error.starts_with("cannot open /sys/class/pwm/pwmchip99/export: No such file"),
        "{error}"
    );
}
