"""The 63 systems of ODEBench (d'Ascoli et al., ICLR 2024; github.com/sdascoli/odeformer, MIT): laws, constants, starts.

A law is a set of terms with coefficients. Constants inside terms have names; the program is not told their values.
"""

# What a user would write for each class of systems. S stands for the states; the part before the bar declares constants.
LIBRARIES = {
    "cubic": "| poly(S; 3)",
    "quartic": "| poly(S; 4)",
    "quintic": "| poly(S; 5)",
    "logarithm": "| poly(S; 2) + <log(x0), x0*log(x0), x0^2*log(x0)>",
    "exponential": "| poly(S; 2) + <sin(x0), cos(x0), exp(x0), exp(-x0)>",
    "trigonometric 1": "| poly(S; 2) + <sin(x0), cos(x0), sin(x0)*cos(x0), sin(x0)^2, x0*sin(x0), x0*cos(x0)>",
    "trigonometric": "| poly(S; 2) + <sin(x0), sin(x1), cos(x0), cos(x1)> + <x0, x1> * <sin(x0), sin(x1), cos(x0), cos(x1)>"
    " + <sin(x0), sin(x1)> * <cos(x0), cos(x1)> + <sin(x0)*sin(x1), cos(x0)*cos(x1), sin(x0)^2, sin(x1)^2>",
    "quadratic drag": "| poly(S; 2) + <sin(x0), cos(x0), abs(x1), x0*abs(x1), x1*abs(x1)>",
    "pendulum pairs": "| poly(S; 2) + <sin(x0), sin(x1), cos(x0), cos(x1), sin(x0 - x1), cos(x0 - x1)>",
    "glider": "| poly(S; 2) + <1, 1/x0> * <sin(x1), cos(x1)> + <1/x0>",
    "shear flow": "| poly(S; 2) + <sin(x0), cos(x0)> * <1, sin(x1), cos(x1), sin(x1)^2, cos(x1)^2, cos(x1)/sin(x1)>"
    " - <sin(x0)*sin(x1)^2>",
    "logistic function": "unknown a, b | poly(S; 2) + <1/(1 + exp(a - b*x0))>",
    "powers": "unknown n in 0.2..5 | poly(S; 2) + <(1 - x0)*x0^n, x0*(1 - x0)^n>",
    "saturation": "unknown K in 0.01..1000 | poly(S; 2) + <x0/(K + x0)>",
    "Hill": "unknown K in 0.01..1000; unknown n in 1..8 | poly(S; 2) + <x0^n/(K^n + x0^n)>",
    "inhibition": "unknown K in 0.01..100 | poly(S; 2) + <1, x0, x1, x0*x1> / <K^2 + x0^2>",
    "rivalry": "unknown a, b | poly(S; 2) + <1/(1 + exp(a*x0 - b)), 1/(1 + exp(a*x1 - b))>",
    "adaptation": "unknown a, b, c | poly(S; 2) + <1/(1 + exp(a*x2 + b*x1 - c)), 1/(1 + exp(a*x0 + b*x3 - c))>",
    "enzymes": "unknown K in 0.01..100; unknown L in 0.01..100; unknown M in 0.01..100 | poly(S; 2) + <x1/(K + x1), x0*x1/(L + x1), x0*x1/(M + x0)>",
}


def system(number, library, laws, starts, **constants):
    return {"number": number, "library": library, "laws": laws, "starts": starts, "constants": constants}


def lorenz(number, a, b, c):
    laws = [{"x0": -a, "x1": a}, {"x0": b, "x1": -1, "x0*x2": -1}, {"x0*x1": 1, "x2": -c}]
    return system(number, "cubic", laws, [(2.3, 8.1, 12.4), (10.0, 20.0, 30.0)])


def roessler(number, a):
    laws = [{"x1": -5, "x2": -5}, {"x0": 5, "x1": 5 * a}, {"1": 1, "x0*x2": 5, "x2": -28.5}]
    return system(number, "cubic", laws, [(2.3, 1.1, 0.8), (-0.1, 4.1, -2.1)])


SYSTEMS = [
    system(1, "cubic", [{"1": 0.7 / 2.31, "x0": -1 / (1.2 * 2.31)}], [(10,), (3.54,)]),
    system(2, "cubic", [{"x0": 0.23}], [(4.78,), (0.87,)]),
    system(3, "cubic", [{"x0": 0.79, "x0^2": -0.79 / 74.3}], [(7.3,), (21,)]),
    system(4, "logistic function", [{"1": -0.5, "1/(1 + exp(a - b*x0))": 1}], [(0.8,), (0.02,)], a=0.5, b=1 / 0.96),
    system(5, "cubic", [{"1": 9.81, "x0^2": -0.0021175}], [(0.5,), (73,)]),
    system(6, "cubic", [{"x0": 2.1, "x0^2": -0.5}], [(0.13,), (2.24,)]),
    system(7, "logarithm", [{"x0*log(x0)": 0.032, "x0": 0.032 * 0.8285518175661482}], [(1.73,), (9.5,)]),
    system(8, "cubic", [{"x0": -0.14, "x0^2": 0.14 / 4.4 + 0.14 / 130, "x0^3": -0.14 / 572}], [(6.123,), (2.1,)]),
    system(9, "cubic", [{"1": 0.32, "x0": -0.6}], [(0.14,), (0.55,)]),
    system(10, "powers", [{"(1 - x0)*x0^n": 0.2, "x0*(1 - x0)^n": -0.8}], [(0.83,), (0.34,)], n=1.2),
    system(11, "cubic", [{"x0^3": -1}], [(3.4,), (1.6,)]),
    system(12, "cubic", [{"x0": 1.8, "x0^2": -0.1107}], [(11,), (1.3,)]),
    system(13, "trigonometric 1", [{"sin(x0)*cos(x0)": 0.0981 * 9.7, "sin(x0)": -0.0981}], [(3.1,), (2.4,)]),
    system(14, "Hill", [{"x0": 0.78, "x0^2": -0.78 / 81, "x0^n/(K^n + x0^n)": -0.9}], [(2.76,), (23.3,)], K=21.2, n=2),
    system(15, "Hill", [{"x0": 0.4, "x0^2": -0.4 / 95, "x0^n/(K^n + x0^n)": -1}], [(44.3,), (4.5,)], K=1, n=2),
    system(16, "quintic", [{"x0": 0.1, "x0^3": 0.04, "x0^5": -0.001}], [(0.94,), (1.65,)]),
    system(17, "cubic", [{"x0": 0.4, "x0^2": -0.004, "1": -0.3}], [(14.3,), (34.2,)]),
    system(18, "saturation", [{"x0": 0.4, "x0^2": -0.004, "x0/(K + x0)": -0.24}], [(21.1,), (44.1,)], K=50),
    system(19, "saturation", [{"x0": 1, "x0^2": -1, "x0/(K + x0)": -0.08}], [(0.13,), (0.03,)], K=0.8),
    system(20, "Hill", [{"1": 0.1, "x0": -0.55, "x0^n/(K^n + x0^n)": 1}], [(0.002,), (0.25,)], K=1, n=2),
    system(21, "exponential", [{"1": 1.2, "x0": -0.2, "exp(-x0)": -1}], [(0,), (0.8,)]),
    system(22, "Hill", [{"1": 1.4, "x0": -0.89, "x0^n/(K^n + x0^n)": 0.4}], [(3.1,), (6.3,)], K=123**0.2, n=5),
    system(23, "trigonometric 1", [{"1": 0.21, "sin(x0)": -1}], [(-2.74,), (1.65,)]),
    system(24, "cubic", [{"x1": 1}, {"x0": -2.1}], [(0.4, -0.03), (0.0, 0.2)]),
    system(25, "cubic", [{"x1": 1}, {"x0": -4.5, "x1": -0.43}], [(0.12, 0.043), (0.0, -0.3)]),
    system(26, "cubic", [{"x0": 3, "x0^2": -1, "x0*x1": -2}, {"x1": 2, "x0*x1": -1, "x1^2": -1}], [(5.0, 4.3), (2.3, 3.6)]),
    system(27, "cubic", [{"x0": 1.84, "x0*x1": -1.45}, {"x1": -3, "x0*x1": 1.62}], [(8.3, 3.4), (0.4, 0.65)]),
    system(28, "trigonometric", [{"x1": 1}, {"sin(x0)": -0.9}], [(-1.9, 0), (0.3, 0.8)]),
    system(29, "cubic", [{"x0*x1": 0.65}, {"x1^2": 1, "x0^2": -1}], [(3.2, 1.4), (1.3, 0.2)]),
    system(30, "quartic", [{"x0*x1": 1, "x0^2*x1": -1.61}, {"x0*x1": 1, "x0*x1^2": -1.61}], [(0.3, 0.04), (0.1, 0.21)]),
    system(31, "cubic", [{"x0*x1": -0.4}, {"x0*x1": 0.4, "x1": -0.314}], [(7.2, 0.98), (20, 12.4)]),
    system(32, "cubic", [{"x1": 1}, {"x1": -0.18, "x0": 1, "x0^3": -1}], [(-1.8, -1.8), (5.8, 0)]),
    system(33, "glider", [{"sin(x1)": -1, "x0^2": -0.08}, {"x0": 1, "cos(x1)/x0": -1}], [(5.0, 0.7), (9.81, -0.8)]),
    system(34, "trigonometric", [{"x1": 1}, {"sin(x0)*cos(x0)": 1, "sin(x0)": -0.93}], [(2.1, 0), (-1.2, -0.2)]),
    system(35, "shear flow", [{"cos(x0)*cos(x1)/sin(x1)": 1}, {"sin(x0)": 4.2, "sin(x0)*cos(x1)^2": -3.2}], [(1.13, -0.3), (2.4, 1.7)]),
    system(36, "trigonometric", [{"x1": 1}, {"sin(x0)": -1, "x1": -1, "x1*cos(x0)": -0.07}], [(0.45, 0.9), (1.34, -0.8)]),
    system(37, "cubic", [{"x1": 1}, {"x0": -1, "x1": 0.43, "x0^2*x1": -0.43}], [(2.2, 0), (0.1, 3.2)]),
    system(38, "cubic", [{"x1": 3.37, "x0^3": -3.37 / 3, "x0": 3.37}, {"x0": -1 / 3.37}], [(0.7, 0), (-1.1, -0.7)]),
    system(39, "cubic", [{"x0": -1, "x1": 2.4, "x0^2*x1": 1}, {"1": 0.07, "x0": -2.4, "x0^2*x1": -1}], [(0.4, 0.31), (0.2, -0.7)]),
    system(40, "cubic", [{"x1": 1}, {"x0": -1, "x1": 0.886, "x0^2*x1": -0.886}], [(0.63, -0.03), (0.2, 0.2)]),
    system(
        41, "cubic",
        [{"x1": 0.0153, "x0": -1.0153, "x0^2*x1": 15.3, "x0^3": -15.3}, {"1": 0.3, "x0": -1}],
        [(0.8, 0.3), (0.02, 1.2)],
    ),
    system(
        42, "inhibition",
        [{"1": 8.9, "x0": -1, "x0*x1/(K^2 + x0^2)": -4}, {"x0": 1.4, "x0*x1/(K^2 + x0^2)": -1.4}],
        [(0.2, 0.35), (3.0, 7.8)], K=1,
    ),
    system(43, "trigonometric", [{"x1": 1}, {"1": 1.67, "sin(x0)": -1, "x1": -0.64}], [(1.47, -0.2), (-1.9, 0.03)]),
    system(44, "quadratic drag", [{"x1": 1}, {"1": 1.67, "sin(x0)": -1, "x1*abs(x1)": -0.64}], [(1.47, -0.2), (-1.9, 0.03)]),
    system(45, "cubic", [{"1": 0.5, "x0": -0.5, "x0*x1^2": -1}, {"x0*x1^2": 1, "x1": -0.02}], [(1.4, 0.2), (0.32, 0.64)]),
    system(
        46, "pendulum pairs",
        [{"sin(x0 - x1)": 0.33, "sin(x0)": -1}, {"sin(x0 - x1)": -0.33, "sin(x1)": -1}],
        [(0.54, -0.1), (0.43, 1.21)],
    ),
    system(
        47, "rivalry",
        [{"x0": -1, "1/(1 + exp(a*x1 - b))": 1}, {"x1": -1, "1/(1 + exp(a*x0 - b))": 1}],
        [(0.65, 0.59), (3.2, 10.3)], a=4.89, b=1.4,
    ),
    system(
        48, "inhibition",
        [{"1": 18.3, "x0": -1, "x0*x1/(K^2 + x0^2)": -1 / 0.48}, {"1": 11.23, "x0*x1/(K^2 + x0^2)": -1 / 0.48}],
        [(0.1, 30.4), (13.2, 5.21)], K=0.48**-0.5,
    ),
    system(49, "cubic", [{"1": 1, "x0": -4.03, "x0^2*x1": 3.1}, {"x0": 3.03, "x0^2*x1": -3.1}], [(0.7, -1.4), (2.1, 1.3)]),
    system(50, "cubic", [{"1": 0.24, "x0": -1, "x0^2*x1": 1}, {"1": 1.43, "x0^2*x1": -1}], [(0.14, 0.6), (1.5, 0.9)]),
    system(
        51, "trigonometric",
        [{"1": 1.432, "sin(x1)*cos(x0)": 1}, {"1": 0.972, "sin(x1)*cos(x0)": 1}],
        [(2.2, 0.67), (0.03, -0.12)],
    ),
    system(
        52, "cubic",
        [{"x0": -0.1, "x1": 0.1}, {"x0*x2": 0.21, "x1": -0.21}, {"1": 0.34 * 4.1, "x2": -0.34, "x0*x1": -0.34 * 3.1}],
        [(1.3, 1.1, 0.89), (0.89, 1.3, 1.1)],
    ),
    system(
        53, "enzymes",
        [
            {"1": 0.1, "x0": -0.05, "x0*x1/(M + x0)": -0.4},
            {"x2": 0.06, "x1*x2": 0.6, "x1/(K + x1)": -0.2, "x0*x1/(L + x1)": -7.95},
            {"x2": -0.06, "x1*x2": -0.6, "x1/(K + x1)": 0.2, "x0*x1/(L + x1)": 7.95},
        ],
        [(0.005, 0.26, 2.15), (0.248, 0.0973, 0.0027)], K=0.1, L=2.0, M=0.1,
    ),
    lorenz(54, 5.1, 12, 1.67),
    lorenz(55, 10, 99.96, 8 / 3),
    lorenz(56, 10, 28, 8 / 3),
    roessler(57, -0.2),
    roessler(58, 0.1),
    roessler(59, 0.2),
    system(
        60, "quartic",
        [
            {"x0*x2": 1, "x0": -0.7, "x1": -3.5},
            {"x0": 3.5, "x1*x2": 1, "x1": -0.7},
            {"1": 0.65, "x2": 0.95, "x2^3": -1 / 3, "x0^2": -1, "x1^2": -1, "x0^2*x2": -0.25, "x1^2*x2": -0.25, "x0^3*x2": 0.1},
        ],
        [(0.1, 0.05, 0.05), (-0.3, 0.2, 0.1)],
    ),
    system(61, "cubic", [{"x0": 5, "x1*x2": -1}, {"x1": -10, "x0*x2": 1}, {"x2": -3.8, "x0*x1": 1 / 3}], [(15, -15, -15), (8, 14, -10)]),
    system(
        62, "adaptation",
        [
            {"x0": -1, "1/(1 + exp(a*x2 + b*x1 - c))": 1},
            {"x0": 1, "x1": -1},
            {"x2": -1, "1/(1 + exp(a*x0 + b*x3 - c))": 1},
            {"x2": 1, "x3": -1},
        ],
        [(2.25, -0.5, -1.13, 0.4), (0.342, -0.431, -0.86, 0.041)], a=0.89, b=0.4, c=1.4,
    ),
    system(
        63, "cubic",
        [{"x0*x2": -0.28}, {"x0*x2": 0.28, "x1": -0.47}, {"x1": 0.47, "x2": -0.3}, {"x2": 0.3}],
        [(0.6, 0.3, 0.09, 0.01), (0.4, 0.3, 0.25, 0.05)],
    ),
]
