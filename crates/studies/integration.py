"""A step of an integration, for the studies that draw their records. Needs numpy."""
import numpy as np


def runge_kutta(f, t, z, h):
    """z after a step h of dz/dt = f(t, z), by the classical method of order 4. It must not cross a bend or a jump of an input."""
    a = np.array(f(t, z))
    b = np.array(f(t + h / 2, z + h / 2 * a))
    c = np.array(f(t + h / 2, z + h / 2 * b))
    return z + h / 6 * (a + 2 * b + 2 * c + np.array(f(t + h, z + h * c)))
