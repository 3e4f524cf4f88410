"""Modes of small motion from textbook equations, for tests/it/modes.rs.

The small-perturbation equations of Roskam (Airplane Flight Dynamics and
Automatic Flight Controls I, 1995, ch. 5) in his units, with the tables of his
airplane A (a Cessna 182 in cruise) and of Nelson's Navion (Flight Stability
and Automatic Control, 1998, table B.1). Needs numpy; knows nothing of fcc-sim.
"""

import numpy as np

G = 32.174  # ft/s²

ROSKAM_A = {
    "q": 49.6, "S": 174.0, "c": 4.9, "b": 36.0, "W": 2650.0, "V": 220.1,
    "Ixx": 948.0, "Iyy": 1346.0, "Izz": 1967.0,
    "CL1": 0.307, "CD1": 0.032, "CTx1": 0.032, "CTxu": -0.096, "CDa": 0.121,
    "CLa": 4.41, "CLad": 1.7, "CLq": 3.9, "Cma": -0.613, "Cmad": -7.27, "Cmq": -12.4,
    "Cyb": -0.393, "Cyp": -0.075, "Cyr": 0.214,
    "Clb": -0.0923, "Clp": -0.484, "Clr": 0.0798,
    "Cnb": 0.0587, "Cnp": -0.0278, "Cnr": -0.0937,
}  # fmt: skip
NAVION = {
    "q": 36.8, "S": 184.0, "c": 5.7, "b": 33.4, "W": 2750.0, "V": 176.0,
    "Ixx": 1048.0, "Iyy": 3000.0, "Izz": 3530.0,
    "CL1": 0.41, "CD1": 0.05, "CTx1": 0.0, "CTxu": 0.0, "CDa": 0.33,
    "CLa": 4.44, "CLad": 0.0, "CLq": 3.8, "Cma": -0.683, "Cmad": -4.36, "Cmq": -9.96,
    "Cyb": -0.564, "Cyp": 0.0, "Cyr": 0.0,
    "Clb": -0.074, "Clp": -0.41, "Clr": 0.107,
    "Cnb": 0.071, "Cnp": -0.0575, "Cnr": -0.125,
}  # fmt: skip


def longitudinal(a):
    """Eigenvalues of u, alpha, q, theta."""
    k, m, v = a["q"] * a["S"], a["W"] / G, a["V"]
    turn = k * a["c"] ** 2 / (2 * a["Iyy"] * v)
    left = np.eye(4)
    left[1, 1] = v + k * a["c"] * a["CLad"] / (2 * m * v)
    left[2, 1] = -turn * a["Cmad"]
    x_u = k * (-2 * a["CD1"] + a["CTxu"] + 2 * a["CTx1"]) / (m * v)
    right = np.array([
        [x_u, -k * (a["CDa"] - a["CL1"]) / m, 0, -G],
        [-2 * k * a["CL1"] / (m * v), -k * (a["CLa"] + a["CD1"]) / m,
         v - k * a["c"] * a["CLq"] / (2 * m * v), 0],
        [0, k * a["c"] * a["Cma"] / a["Iyy"], turn * a["Cmq"], 0],
        [0, 0, 1, 0],
    ])  # fmt: skip
    return np.linalg.eigvals(np.linalg.solve(left, right))


def lateral(a):
    """Eigenvalues of beta, p, r, phi."""
    k, m, v, b = a["q"] * a["S"], a["W"] / G, a["V"], a["b"]
    rate = b / (2 * v)
    matrix = np.array([
        [k * a["Cyb"] / (m * v), k * a["Cyp"] * rate / (m * v),
         k * a["Cyr"] * rate / (m * v) - 1, G / v],
        [k * b * a["Clb"] / a["Ixx"], k * b * a["Clp"] * rate / a["Ixx"],
         k * b * a["Clr"] * rate / a["Ixx"], 0],
        [k * b * a["Cnb"] / a["Izz"], k * b * a["Cnp"] * rate / a["Izz"],
         k * b * a["Cnr"] * rate / a["Izz"], 0],
        [0, 1, 0, 0],
    ])  # fmt: skip
    return np.linalg.eigvals(matrix)


for name, aircraft in (("airplane A", ROSKAM_A), ("Navion", NAVION)):
    for root in (*longitudinal(aircraft), *lateral(aircraft)):
        if root.imag >= 0:
            frequency = abs(root)
            print(f"{name:10}  {root:20.5f}  {frequency:8.4f} rad/s  {-root.real / frequency:7.4f}")
