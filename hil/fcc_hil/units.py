"""Conversions between SI, used everywhere here, and other units."""

import math

FT_TO_M = 0.3048
KT_TO_MPS = 1852.0 / 3600.0
STANDARD_GRAVITY_MPS2 = 9.80665
PSF_TO_PA = 47.880258980336
INHG_TO_PA = 3386.389
RANKINE_TO_KELVIN = 5.0 / 9.0
CELSIUS_ZERO_K = 273.15
SEA_LEVEL_PRESSURE_PA = 101_325.0
SEA_LEVEL_DENSITY_KGPM3 = 1.225
DRY_AIR_GAS_CONSTANT = 287.053
STANDARD_INHG = SEA_LEVEL_PRESSURE_PA / INHG_TO_PA
_SEA_LEVEL_TEMPERATURE_K = 288.15
_LAPSE_KPM = 0.0065
_SEA_LEVEL_SOUND_MPS = 340.294


def pressure_altitude_m(pressure_pa: float) -> float:
    """Return the altitude of a pressure in the standard atmosphere, below 11 km (ICAO 7488)."""
    exponent = DRY_AIR_GAS_CONSTANT * _LAPSE_KPM / STANDARD_GRAVITY_MPS2
    ratio = math.pow(pressure_pa / SEA_LEVEL_PRESSURE_PA, exponent)
    return _SEA_LEVEL_TEMPERATURE_K / _LAPSE_KPM * (1.0 - ratio)


def impact_pressure_pa(calibrated_mps: float) -> float:
    """Return total minus static pressure of a calibrated airspeed (ICAO 7488: isentropic)."""
    mach = calibrated_mps / _SEA_LEVEL_SOUND_MPS
    return SEA_LEVEL_PRESSURE_PA * (math.pow(1.0 + 0.2 * mach * mach, 3.5) - 1.0)


def calibrated_airspeed_mps(impact_pa: float) -> float:
    """Return the calibrated airspeed of total minus static pressure; 0 if it is not positive."""
    ratio = max(0.0, impact_pa) / SEA_LEVEL_PRESSURE_PA + 1.0
    return _SEA_LEVEL_SOUND_MPS * math.sqrt(5.0 * (math.pow(ratio, 2.0 / 7.0) - 1.0))


def wrap_degrees(angle_deg: float) -> float:
    """Return the same angle in -180 <= angle < 180."""
    return (angle_deg + 180.0) % 360.0 - 180.0


def wrap_heading(heading_deg: float) -> float:
    """Return the same heading in 0 <= heading < 360."""
    wrapped = heading_deg % 360.0
    return 0.0 if wrapped >= 360.0 else wrapped


def wrap_heading_rad(heading_rad: float) -> float:
    """Return the same heading in 0 <= heading < 2 pi."""
    wrapped = heading_rad % math.tau
    return 0.0 if wrapped >= math.tau else wrapped
