use fcc_linux::serial::RcChannel;

use crate::config::{Config, DeviceEntry};

/// Each error without the name of the text.
fn lines(text: &str) -> Vec<String> {
    let error = Config::parse(text, "test").unwrap_err().to_string();
    error.lines().map(str::to_owned).collect()
}

#[test]
fn an_error_of_servos_is_reported_with_its_line_and_what_to_do() {
    let begin = "[built-in]\n[[actuator]]\nkind = \"servos\"\n";
    let servo = "[[actuator.channel]]\ndrives = \"rudder\"\noutput = 1\n";
    for (keys, expected) in [
        (
            format!("pwm = \"/p\"\nrate_hz = 500\n{servo}"),
            "test:5: actuator[0].rate_hz: is 500: choose 40 to 333",
        ),
        (
            format!("pwm = \"/p\"\n{servo}min_us = 100\n"),
            "test:8: actuator[0].channel[0].min_us: is 100: choose 500 to 2500",
        ),
        (
            format!("pwm = \"/p\"\n{servo}failsafe = 2\n"),
            "test:8: actuator[0].channel[0].failsafe: a failsafe position of 2 is out of range: \
             choose -1 to 1",
        ),
        (
            format!(
                "pwm = \"/p\"\n{}trim = 0.1\n",
                servo.replace("rudder", "left-brake")
            ),
            "test:8: actuator[0].channel[0].trim: what is 0 to 1, as a throttle, has no trim: set \
             min_us and max_us",
        ),
        (
            format!("pwm = \"/p\"\n{servo}{servo}"),
            "test:10: actuator[0].channel[1].output: is 1, as that of another channel: give each \
             its own",
        ),
        (
            format!("pwm = \"/p\"\nheartbeat = {{ line = 70000 }}\n{servo}"),
            "test:5: actuator[0].heartbeat.line: is 70000: choose 0 to 1023",
        ),
        (
            format!("pca9685 = \"/dev/i2c-1\"\npwm = \"/p\"\n{servo}"),
            "test:5: actuator[0].pwm: is given together with pca9685: keep one",
        ),
    ] {
        // The simulator drives the surfaces that these servos do not.
        let keys = format!("{keys}[[actuator]]\nkind = \"simulator\"\n");
        assert_eq!(lines(&format!("{begin}{keys}")), [expected]);
    }
    let [none] = &lines(&format!("{begin}pwm = \"/p\"\n"))[..] else {
        panic!("one line");
    };
    assert!(none.contains("actuator[0].channel: is missing"), "{none}");
    let nowhere = lines(&format!("{begin}{servo}"));
    assert!(
        nowhere[0].contains("actuator[0].pwm: is missing"),
        "{nowhere:?}"
    );
    let kind = lines(&format!(
        "{begin}pwm = \"/p\"\n{}",
        servo.replace("rudder", "rudde")
    ));
    assert!(
        kind[0].starts_with("test:6: actuator[0].channel[0].drives: "),
        "{kind:?}"
    );
}

#[test]
fn servos_that_cannot_fly_an_aircraft_are_refused() {
    let servos = |surfaces: &[&str]| {
        let channels = surfaces.iter().enumerate().map(|(output, drives)| {
            format!("[[actuator.channel]]\ndrives = \"{drives}\"\noutput = {output}\n")
        });
        let channels: String = channels.collect();
        format!("[[actuator]]\nkind = \"servos\"\npwm = \"/p\"\n{channels}")
    };
    let begin = "[[sensor]]\nkind = \"x-plane\"\n";
    let lacks = |surfaces: &[&str]| lines(&format!("{begin}{}", servos(surfaces)));
    assert_eq!(
        lacks(&["aileron", "throttle"]),
        [
            "test:6: actuator[0].channel: has no servo that drives the elevator, without which \
             nothing can be flown: add [[actuator.channel]] with drives = \"elevator\" and its \
             output"
        ]
    );
    let [elevator, aileron] = &lacks(&["rudder", "throttle"])[..] else {
        panic!("two lines");
    };
    assert!(elevator.contains("drives the elevator"), "{elevator}");
    assert!(aileron.contains("drives the aileron"), "{aileron}");
    for complete in [
        servos(&["elevator", "aileron"]),
        servos(&["elevator"]) + &servos(&["aileron"]).replace("/p", "/q"),
        servos(&["throttle"]) + "[[actuator]]\nkind = \"simulator\"\n[built-in]\n",
    ] {
        Config::parse(&format!("{begin}{complete}"), "test").unwrap();
    }
}

#[test]
fn an_error_of_a_line_is_reported_with_its_line_and_what_to_do() {
    let begin = "[built-in]\n[[sensor]]\nkind = ";
    for (keys, expected) in [
        (
            "\"gnss-serial\"\n",
            "test:2: sensor[0].path: is missing: give the serial line, such as \"/dev/ttyAMA0\"",
        ),
        (
            "\"gnss-serial\"\npath = \"/dev/ttyS0\"\nbaud = 10\n",
            "test:5: sensor[0].baud: is 10: choose 1200 to 4000000",
        ),
        (
            "\"gpsd\"\naddress = \"localhost\"\n",
            "test:4: sensor[0].address: is no address: give host and port, such as \
             \"localhost:2947\"",
        ),
        (
            "\"gpsd\"\naddress = \"gpsd://localhost:2947\"\n",
            "test:4: sensor[0].address: is no address: give host and port, such as \
             \"localhost:2947\"",
        ),
        (
            "\"gpsd\"\naddress = \"[::1]:2947\"\ndevice = \"\"\n",
            "test:5: sensor[0].device: is empty: leave it out to use all receivers of gpsd",
        ),
        (
            "\"gpio-switch\"\n",
            "test:2: sensor[0].line: is missing: give the line's number, `gpioinfo` lists them",
        ),
        (
            "\"gpio-switch\"\nline = 17\ndebounce_ms = 300\n",
            "test:5: sensor[0].debounce_ms: is 300: choose 0 to 200",
        ),
        (
            "\"rc-receiver\"\npath = \"/dev/ttyS0\"\nswitch_channel = 0\n",
            "test:5: sensor[0].switch_channel: is 0: choose 1 to 16, or -1 to -16",
        ),
        (
            "\"rc-receiver\"\npath = \"/dev/ttyS0\"\nroll_channel = 17\n",
            "test:5: sensor[0].roll_channel: is 17: choose -16 to 16",
        ),
    ] {
        assert_eq!(lines(&format!("{begin}{keys}")), [expected]);
    }
}

#[test]
fn a_negative_channel_is_reversed_and_without_one_no_stick_is_read() {
    let channels = |keys: &str| {
        let text = format!(
            "[built-in]\n[[sensor]]\nkind = \"rc-receiver\"\npath = \"/dev/ttyS0\"\n{keys}"
        );
        let config = Config::parse(&text, "test").unwrap();
        let Some(DeviceEntry::RcReceiver(section)) = config.sensor[0].device() else {
            panic!("an RC receiver");
        };
        section.channels()
    };
    let given = channels("switch_channel = -7\npitch_channel = -2\n");
    let channel = |number, is_reversed| RcChannel {
        number,
        is_reversed,
    };
    assert_eq!(given.switch, channel(7, true));
    let sticks = [channel(2, true), channel(1, false), channel(4, false)];
    assert_eq!(given.controls, Some(sticks));
    assert_eq!(channels("yaw_channel = 0\n").controls, None);
}

#[test]
fn servos_and_lines_are_restored_unchanged() {
    let text = "[built-in]\n[[sensor]]\nkind = \"gnss-serial\"\npath = \"/dev/ttyS0\"\n\
                [[sensor]]\nkind = \"gpsd\"\ndevice = \"/dev/ttyACM0\"\n\
                [[sensor]]\nkind = \"rc-receiver\"\npath = \"/dev/ttyS1\"\nprotocol = \"crsf\"\n\
                [[sensor]]\nkind = \"gpio-switch\"\nline = 17\npull = \"none\"\n\
                [[actuator]]\nkind = \"servos\"\npca9685 = \"/dev/i2c-1\"\n\
                [actuator.heartbeat]\nline = 22\n\
                [[actuator.channel]]\ndrives = \"aileron\"\noutput = 3\nslew_per_s = 2.5\n\
                [[actuator.channel]]\ndrives = \"elevator\"\noutput = 4\n\
                [[actuator.channel]]\ndrives = \"flaps\"\noutput = 5\nfailsafe = 0.3\n\
                [[actuator.channel]]\ndrives = \"right-brake\"\noutput = 6\n\
                [[actuator.channel]]\ndrives = \"nose-wheel\"\noutput = 7\ntrim = 0.05\n\
                [[actuator.channel]]\ndrives = \"gear\"\noutput = 8\n";
    let written = Config::parse(text, "test").unwrap().to_toml().unwrap();
    let again = Config::parse(&written, "again").unwrap();
    assert_eq!(again.to_toml().unwrap(), written);
}
