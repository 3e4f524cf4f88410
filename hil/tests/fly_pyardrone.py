"""Flies an AR.Drone by the package pyardrone: the same as hil/node/fly.mjs. Argument: its address.

No pictures are sent: the thread that wants them ends.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from typing import Any

from pyardrone import ARDrone, at

EVERY_S = 0.03
NAMES = {2: "LANDED", 3: "FLYING", 4: "HOVERING", 6: "TRANS_TAKEOFF", 8: "TRANS_LANDING"}


def main(address: str) -> None:
    threading.excepthook = lambda _: None
    drone = ARDrone(host=address)
    drone.navdata_ready.wait(10.0)
    told: dict[str, list[Any]] = {"states": [], "forward": [], "headings": [], "heights": []}

    def demo() -> Any:
        return getattr(drone.navdata, "demo", None)

    def during(seconds: float, command: Any, phase: str = "") -> None:
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            step(command, phase)

    def step(command: Any, phase: str = "") -> None:
        command()
        time.sleep(EVERY_S)
        if (seen := demo()) is None:
            return
        state = NAMES[seen.ctrl_state >> 16]
        if told["states"][-1:] != [state]:
            told["states"].append(state)
        if phase == "forward":
            told["forward"].append([seen.theta / 1e3, seen.vx])
        if phase == "turns":
            told["headings"].append(seen.psi / 1e3)
        if phase == "hovers":
            told["heights"].append(seen.altitude / 1e3)

    while demo() is None:
        step(lambda: drone.send(at.CONFIG("general:navdata_demo", True)))
    while told["states"][-1:] != ["HOVERING"]:
        step(drone.takeoff)
    during(2.0, drone.hover, "hovers")
    during(2.0, lambda: drone.move(forward=0.5), "forward")
    during(3.0, drone.hover)
    during(2.0, lambda: drone.move(cw=0.5), "turns")
    during(1.0, drone.hover)
    while told["states"][-1:] != ["LANDED"]:
        step(drone.land)
    drone.close()
    print(json.dumps(told))


if __name__ == "__main__":
    main(sys.argv[1])
