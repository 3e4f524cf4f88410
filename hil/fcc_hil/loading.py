"""The loading of an aircraft of JSBSim: its weight, its fuel and its centre of gravity."""

from __future__ import annotations

from dataclasses import dataclass

import jsbsim


@dataclass(frozen=True)
class Loading:
    """A loading; the crew and what it carries are one mass."""

    weight_lb: float
    """In all."""
    fuel_lb: float
    """In all tanks, the same in each."""
    aft_in: float = 0.0
    """How far the centre of gravity lies behind that of the file's own loading."""

    def apply(self, fdm: jsbsim.FGFDMExec) -> None:
        """Load an aircraft before its trim. Raises ValueError if it is heavier without a crew."""
        fdm.run_ic()
        aim_x_in = fdm["inertia/cg-x-in"] + self.aft_in
        tanks = _count(fdm, "contents-lbs")
        for i in range(tanks):
            fdm[f"propulsion/tank[{i}]/contents-lbs"] = self.fuel_lb / tanks
        for i in range(_count(fdm, "pointmass-weight-lbs")):
            fdm[f"inertia/pointmass-weight-lbs[{i}]"] = 0.0
        fdm.run_ic()
        bare_lb, bare_x_in = fdm["inertia/weight-lbs"], fdm["inertia/cg-x-in"]
        crew_lb = self.weight_lb - bare_lb
        if crew_lb <= 0.0:
            raise ValueError(
                f"loading: the aircraft weighs {bare_lb:.0f} lb with {self.fuel_lb:.0f} lb of fuel "
                f"and no crew: {self.weight_lb:.0f} lb is too little"
            )
        fdm["inertia/pointmass-weight-lbs"] = crew_lb
        fdm["inertia/pointmass-location-Y-inches"] = 0.0
        fdm["inertia/pointmass-location-X-inches"] = (
            aim_x_in * self.weight_lb - bare_x_in * bare_lb
        ) / crew_lb


def _count(fdm: jsbsim.FGFDMExec, name: str) -> int:
    return str(fdm.query_property_catalog(name)).count(f"/{name}")
