"""A minimal flight control computer, to test the stand-in and `fly`.

It implements the protocol from the layouts, independently of the package. It holds the captured
state: wings level, heading, altitude. This is enough to test that commands reach the aircraft and
values return.

    python fake_daemon.py PORT [--exit-after S | --never-engage | --keep-overrides | --mute]
"""

from __future__ import annotations

import argparse
import json
import signal
import socket
import struct
import time

SIM = "sim/flightmodel/position/"
SWITCH = "sim/cockpit2/switches/generic_lights_switch[56]"
READ = [
    SIM + "theta",
    SIM + "phi",
    SIM + "mag_psi",
    SIM + "Qrad",
    SIM + "Prad",
    SIM + "vh_ind_fpm",
    "sim/cockpit2/gauges/indicators/altitude_ft_pilot",
    SWITCH,
]
OVERRIDES = [
    "sim/operation/override/override_joystick",
    "sim/operation/override/override_throttles",
]
YOKE = ["sim/joystick/yoke_pitch_ratio", "sim/joystick/yoke_roll_ratio"]


class Link:
    def __init__(self, port: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.simulator = ("127.0.0.1", port)
        self.socket.setblocking(False)
        self.values: dict[str, float] = {}

    def subscribe(self, frequency_hz: int) -> None:
        for index, path in enumerate(READ):
            packed = struct.pack("<ii400s", frequency_hz, index, path.encode())
            self.socket.sendto(b"RREF\0" + packed, self.simulator)

    def receive(self) -> None:
        try:
            while True:
                datagram = self.socket.recv(2048)
                if datagram[:4] == b"RREF" and len(datagram) % 8 == 5:
                    for index, value in struct.iter_unpack("<if", datagram[5:]):
                        self.values[READ[index]] = value
        except (BlockingIOError, ConnectionError):
            return

    def write(self, path: str, value: float) -> None:
        datagram = b"DREF\0" + struct.pack("<f500s", value, path.encode())
        self.socket.sendto(datagram, self.simulator)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("port", type=int)
    parser.add_argument("--exit-after", type=float)
    parser.add_argument("--never-engage", action="store_true")
    parser.add_argument("--keep-overrides", action="store_true")
    parser.add_argument("--mute", action="store_true")
    options, _ = parser.parse_known_args()

    stopped = False

    def stop(*_: object) -> None:
        nonlocal stopped
        stopped = True

    signal.signal(signal.SIGTERM, stop)
    link = Link(options.port)
    engaged = False
    heading_deg = altitude_ft = 0.0
    ticks, began_s = 0, time.monotonic()
    subscribe_s = 0.0
    while not stopped:
        ticks += 1
        time.sleep(max(0.0, began_s + ticks * 0.025 - time.monotonic()))
        if not options.mute and time.monotonic() > subscribe_s:
            subscribe_s = time.monotonic() + 1.0
            link.subscribe(40)
        link.receive()
        v = link.values
        if len(v) < len(READ):
            continue
        if options.exit_after is not None and ticks * 0.025 > options.exit_after:
            return 3
        on = v[SWITCH] > 0.5 and not options.never_engage
        if on and not engaged:
            heading_deg, altitude_ft = v[READ[2]], v[READ[6]]
            link.write(OVERRIDES[0], 1.0)
        if engaged and not on and not options.keep_overrides:
            release(link)
        engaged = on
        if engaged:
            turn = (heading_deg - v[READ[2]] + 180.0) % 360.0 - 180.0
            roll_error = max(-20.0, min(20.0, turn)) - v[READ[1]]
            climb = max(-500.0, min(500.0, 10.0 * (altitude_ft - v[READ[6]]))) - v[READ[5]]
            link.write(YOKE[0], 0.0002 * climb - 0.3 * v[READ[3]])
            link.write(YOKE[1], 0.015 * roll_error - 0.1 * v[READ[4]])
    if not options.keep_overrides:
        release(link)
    print(json.dumps({"timing": {"rate_hz": 40.0, "ticks": ticks, "missed": 0}}))
    return 0


def release(link: Link) -> None:
    for path in YOKE:
        link.write(path, 0.0)
    for path in OVERRIDES:
        link.write(path, 0.0)


if __name__ == "__main__":
    raise SystemExit(main())
