"""Fits the saturating coil by one-step predictions: prints C, R, L0, s, i0 with standard errors, and the residuals of the steps.

    python3 crates/studies/rigs/rlc_one_step.py rlc_nonlinear_train.csv

The residual of a step is not undone in later ones, so the errors of this record are not those of sensors: they stay in the circuit. Needs Python 3.9,
numpy, scipy.
"""
import sys

import numpy as np
from scipy.optimize import least_squares

STEP = 5e-7
rows = np.genfromtxt(sys.argv[1], delimiter=",", names=True)[:7500]
v, i, e = rows["V_C"], rows["I_L"], rows["V_IN"]


def follow(p):
    """Both states one sample later, with the input held, by two Runge-Kutta steps."""
    c, r, l0, s, i0 = p * [270e-9, 3, 50e-6, 5, 5]
    rates = lambda v, i: (i / c, (e[:-1] - v - r * i) / (l0 * (0.9 * (0.5 - np.arctan(s * (abs(i) - i0)) / np.pi) + 0.1)))
    x, y, h = v[:-1], i[:-1], STEP / 2
    for _ in range(2):
        a = rates(x, y)
        b = rates(x + h / 2 * a[0], y + h / 2 * a[1])
        c2 = rates(x + h / 2 * b[0], y + h / 2 * b[1])
        d = rates(x + h * c2[0], y + h * c2[1])
        x, y = (z + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4) for z, k1, k2, k3, k4 in zip((x, y), a, b, c2, d))
    return x, y


def left(p):
    x, y = follow(p)
    return np.r_[v[1:] - x, i[1:] - y]


fit = least_squares(left, np.array([1, 1, 1, 0.8, 1.0]))
errors = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)) * np.mean(fit.fun**2))
for name, unit, x, error in zip(("C", "R", "L0", "s", "i0"), (270, 3, 50, 5, 5), fit.x, errors):
    print(f"{name} = {unit * x:.4g} ± {unit * error:.2g}")
for name, rest in zip("vi", np.split(fit.fun, 2)):
    print(f"{name}: steps leave {np.std(rest):.2g}, half of them less than {np.median(abs(rest)):.2g}, the worst {max(abs(rest)):.2g}; correlation of neighbours {np.corrcoef(rest[1:], rest[:-1])[0, 1]:.2f}")
