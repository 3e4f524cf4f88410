"""MAVLink stations that only take what they asked for, or measure the answers to commands."""

from __future__ import annotations

import contextlib
import random
import selectors
import socket
import time

from pymavlink.dialects.v20 import common

STREAMS = (30, 33, 74, 24, 62, 1, 2, 245, 42, 231, 436, 242, 437)
INTERVAL_US = 20_000
PATIENCE_S = 10.0
NAN = float("nan")
ACCEPTED = common.MAV_RESULT_ACCEPTED


class MavlinkStation:
    """A station on a UDP port of its own."""

    def __init__(self, system: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.mav = common.MAVLink(None, srcSystem=system, srcComponent=190)
        self.mav.robust_parsing = True
        self.link = f"udp:127.0.0.1:{self.socket.getsockname()[1]}"

    def begin(self) -> None:
        """Wait for the vehicle; what is there is of one before."""
        self.socket.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            while True:
                self.socket.recv(300)
        self.socket.settimeout(PATIENCE_S)
        _, self.address = self.socket.recvfrom(300)

    def long(self, number: int, *parameters: float) -> None:
        all_7 = [*parameters, *([0.0] * (7 - len(parameters)))]
        message = self.mav.command_long_encode(1, 1, number, 0, *all_7)
        self.socket.sendto(message.pack(self.mav), self.address)

    def answer(self, number: int, *parameters: float) -> tuple[int, float]:
        """Give a command; return its final result, and after how many seconds it is there."""
        began = time.monotonic()
        self.long(number, *parameters)
        while time.monotonic() < began + PATIENCE_S:
            for message in self.mav.parse_buffer(self.socket.recv(300)) or []:
                is_ack = message.get_type() == "COMMAND_ACK" and message.command == number
                if is_ack and message.result != common.MAV_RESULT_IN_PROGRESS:
                    return message.result, time.monotonic() - began
        raise AssertionError(f"command {number} has no answer")


def take_50_hz(stations: list[MavlinkStation], until: float) -> int:
    """Ask for every message at 50 Hz on each link; return how many frames came."""
    waiting = selectors.DefaultSelector()
    for station in stations:
        station.begin()
        for number in STREAMS:
            station.long(common.MAV_CMD_SET_MESSAGE_INTERVAL, number, INTERVAL_US)
        waiting.register(station.socket, selectors.EVENT_READ)
    buffer, frames = bytearray(300), 0
    while time.monotonic() < until:
        for key, _ in waiting.select(0.1):
            assert isinstance(key.fileobj, socket.socket)
            key.fileobj.recv_into(buffer)
            frames += 1
    return frames


def latencies_ms(station: MavlinkStation, count: int) -> dict[str, list[float]]:
    """Take control in flight, then give commands at random times; return how long each took."""
    station.begin()
    # A daemon that was just started does not engage yet.
    while station.answer(common.MAV_CMD_COMPONENT_ARM_DISARM, 1)[0] != ACCEPTED:
        time.sleep(0.2)
    chance = random.Random(1)
    found: dict[str, list[float]] = {"REQUEST_MESSAGE": [], "DO_REPOSITION": []}
    for n in range(count):
        commands = {
            "REQUEST_MESSAGE": (common.MAV_CMD_REQUEST_MESSAGE, 148.0),
            # To another place each time, above sea level.
            "DO_REPOSITION": (
                *(common.MAV_CMD_DO_REPOSITION, -1.0, 1.0, 0.0, NAN),
                *(45.0 + 1e-4 * n, 8.05, 900.0 + n % 10),
            ),
        }
        for name, (number, *parameters) in commands.items():
            time.sleep(chance.uniform(0.0, 0.05))
            result, seconds = station.answer(int(number), *parameters)
            assert result == ACCEPTED, f"{name}: {result}"
            found[name].append(1e3 * seconds)
    return found
