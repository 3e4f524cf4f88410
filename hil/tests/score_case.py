"""Make `data/score_case.json`: a trace and its score, for other implementations to agree with.

    python tests/score_case.py

Three legs: one that settles, one that overshoots and passes north, and one whose
altitude never settles, so that every branch of the score is in it. Noise is seeded
and the samples are rounded before they are scored, so the file is exact.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from fcc_hil.pattern import Leg, SetPoints, TimedPattern
from fcc_hil.score import Samples, Trace, score

_DT_S = 0.05
_SEED = 20_121


def case() -> tuple[Trace, list[Leg]]:
    """Return the trace and its legs, engaged at 1.5 s on heading 200."""
    random = np.random.default_rng(_SEED)
    captured = SetPoints(heading_deg=200.0, altitude_ft=3_012.5, airspeed_kt=98.5)
    legs = TimedPattern(hold_s=2.0).legs(3, 1.5, captured)
    time_s = np.arange(round(legs[-1].end_s / _DT_S) + 20) * _DT_S

    heading = np.full_like(time_s, captured.heading_deg)
    altitude = np.full_like(time_s, captured.altitude_ft)
    for leg, damping, climb_tau_s in zip(legs, (1.0, 0.75, 0.9), (2.5, 3.0, 9.0), strict=True):
        t = np.maximum(0.0, time_s - leg.start_s)
        frequency = 0.45
        oscillation = np.cos(frequency * np.sqrt(1.001 - damping**2) * t)
        heading = np.where(
            time_s >= leg.start_s,
            leg.heading_deg - 90.0 * np.exp(-frequency * damping * t) * oscillation,
            heading,
        )
        climb = leg.altitude_ft - leg.altitude_from_ft
        altitude = np.where(
            time_s >= leg.start_s,
            leg.altitude_ft - climb * np.exp(-t / climb_tau_s) - 6.0 * np.sin(t) * np.exp(-t / 4.0),
            altitude,
        )

    def noisy(values: Samples, sigma: float, digits: int) -> Samples:
        rounded: Samples = np.round(values + random.normal(0.0, sigma, len(values)), digits)
        return rounded

    return (
        Trace(
            time_s=np.round(time_s, 3),
            heading_deg=noisy(heading, 0.05, 3) % 360.0,
            altitude_ft=noisy(altitude, 0.3, 2),
            airspeed_kt=noisy(captured.airspeed_kt + 1.5 * np.sin(time_s / 3.0), 0.2, 2),
            lateral_g=noisy(0.02 * np.cos(time_s / 5.0), 0.004, 4),
        ),
        legs,
    )


def main() -> None:
    """Write the file beside this script."""
    trace, legs = case()
    document = {
        "description": "A seeded trace and its score, as hil/fcc_hil/score.py defines it.",
        "trace": {name: values.tolist() for name, values in vars(trace).items()},
        "legs": [asdict(leg) for leg in legs],
        "expected": score(trace, legs),
    }
    path = Path(__file__).parent / "data" / "score_case.json"
    path.write_text(json.dumps(document, separators=(",", ":")) + "\n")


if __name__ == "__main__":
    main()
