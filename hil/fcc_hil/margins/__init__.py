"""Gain and phase margins of the autopilot with JSBSim's aircraft, measured in flight."""

from .measure import AXES, Condition, Margins, airspeeds_kt, measure, measure_all

__all__ = ["AXES", "Condition", "Margins", "airspeeds_kt", "measure", "measure_all"]
