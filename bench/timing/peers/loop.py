"""A periodic loop in Python: sleeps to absolute deadlines, logs when it woke.

Arguments: rate in Hz, seconds to run. Prints what the other peers print.
"""

import array
import ctypes
import gc
import json
import os
import sys
import time

rate_hz, seconds = int(sys.argv[1]), float(sys.argv[2])
period_ns = 1_000_000_000 // rate_hz

MCL_CURRENT_AND_FUTURE = 3
ctypes.CDLL(None).mlockall(MCL_CURRENT_AND_FUTURE)
gc.disable()
room = int(rate_hz * seconds * 2) + 1_000
ticks = array.array("q", bytes(8 * room))

monotonic_ns, sleep = time.monotonic_ns, time.sleep
count = 0
origin = monotonic_ns()
deadline = origin + period_ns
ends = origin + int(seconds * 1e9)
cpu = time.process_time_ns()
now = origin
while now < ends and count < room:
    now = monotonic_ns()
    if now < deadline:
        sleep((deadline - now) / 1e9)
        now = monotonic_ns()
    ticks[count] = now
    count += 1
    # Keeps its phase, and skips what it missed.
    deadline += max(1, (now - deadline) // period_ns + 1) * period_ns
cpu = time.process_time_ns() - cpu

names = {os.SCHED_OTHER: "SCHED_OTHER", os.SCHED_FIFO: "SCHED_FIFO", os.SCHED_RR: "SCHED_RR"}
json.dump(
    {
        "policy": names.get(os.sched_getscheduler(0), "unknown"),
        "priority": os.sched_getparam(0).sched_priority,
        "origin_ns": origin,
        "cpu_ns": cpu,
        "ticks_ns": ticks[:count].tolist(),
    },
    sys.stdout,
)
