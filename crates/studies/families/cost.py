"""Processor time that an unknown constant costs: prints two tables.

    python3 crates/studies/families/cost.py [target/release/sidc] [--draws 3] [--large]

Each figure is the time of one identification with an unknown constant, divided by that with its true value in the model: for the random laws
of table.py with libraries of seven or ten terms, and for large libraries with one unknown. Needs Python 3.9, numpy, scipy.
"""
import argparse
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from table import FAMILIES, TIMES, draw


def seconds(program, model, columns, header):
    """Processor seconds of one identification."""
    with tempfile.TemporaryDirectory() as scratch:
        source, data = (Path(scratch) / n for n in ("m.sid", "d.csv"))
        np.savetxt(data, np.column_stack(columns), "%.16g", ",", header=header, comments="")
        source.write_text(model)
        before = os.times()
        subprocess.run([program, "identify", "-q", source, data], capture_output=True)
        after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def small(program, draws):
    print("| noise | median s without | median s with | ratio: median, 90 %, largest |\n|---|---|---|---|")
    for level in (0, 0.01, 0.05):
        without, with_unknown = [], []
        for family in FAMILIES:
            for order in (1, 2):
                for seed in range(draws):
                    k, _, x, u = draw(family, order, seed)
                    rng = np.random.default_rng([seed, order, int(1000 * level)])
                    read = x + level * np.std(x) * rng.standard_normal(len(x))
                    motion = ", dx, dx^2, x*dx" if order == 2 else ""
                    head = f"state x : order {order}\ninput u : linear\n"
                    library = f"{'d' * order}x ~ <1, x, x^2, x^3, u{motion}, {FAMILIES[family][0]}>\n"
                    known = f"let k = {k!r}\n{head}{library}"
                    sought = f"unknown k in 0.02..50\n{head}{library}"
                    columns, header = [TIMES, read, u], "t,x,u"
                    without.append(seconds(program, known, columns, header))
                    with_unknown.append(seconds(program, sought, columns, header))
        ratios = np.array(with_unknown) / np.array(without)
        a, b, c = np.quantile(ratios, [0.5, 0.9, 1])
        print(f"| {100 * level:g} % | {np.median(without):.2f} | {np.median(with_unknown):.2f} | {a:.1f}, {b:.1f}, {c:.1f} |", flush=True)


LARGE = [
    ("tanh(dx/k)", "poly(x, dx, u; 4) * <1, tanh(dx/k)> * <1, sin x, cos x, exp(-x^2), sin dx, cos dx, exp(-x)>"),
    ("tanh(dx/k)", "poly(x, dx, u; 6) * <1, tanh(dx/k)> * <1, sin x, cos x, exp(-x^2), sin dx, cos dx, exp(-x), x*sin x, dx*cos x, u*sin x, u*cos x, abs(x)>"),
    ("sin(k*t)", "poly(x, dx, u; 4) * <1, sin(k*t)> * <1, sin x, cos x, exp(-x^2), sin dx, cos dx, exp(-x)>"),
    ("sin(k*t)", "poly(x, dx, u; 6) * <1, sin(k*t)> * <1, sin x, cos x, exp(-x^2), sin dx, cos dx, exp(-x), x*sin x, dx*cos x, u*sin x, u*cos x, abs(x)>"),
]


def large(program):
    times = np.arange(0, 50, 0.05)
    push = lambda t: 1.5 * np.sin(0.63 * t) + np.sin(1.47 * t + 1) + 0.7 * np.sin(2.77 * t + 2)
    terms = {"tanh(dx/k)": (0.4, lambda x, v, t: np.tanh(v / 0.4)), "sin(k*t)": (0.83, lambda x, v, t: np.sin(0.83 * t))}
    print("| term | library | s without | s with | ratio |\n|---|---|---|---|---|")
    for term, library in LARGE:
        k, f = terms[term]
        rates = lambda t, z: [z[1], -1.3 * z[0] - 0.2 * z[1] - 1.1 * f(z[0], z[1], t) + push(t)]
        run = solve_ivp(rates, (0, 50), [1.0, 0.0], t_eval=times, max_step=0.05, rtol=1e-11, atol=1e-12)
        head = "state x : order 2\ninput u : linear\n"
        columns, header = [times, run.y[0], push(times)], "t,x,u"
        without = seconds(program, f"let k = {k}\n{head}ddx ~ {library}\n", columns, header)
        sought = seconds(program, f"unknown k in 0.05..20\n{head}ddx ~ {library}\n", columns, header)
        print(f"| `{term}` | `{library[:16]} ...` | {without:.1f} | {sought:.1f} | {sought / without:.1f} |", flush=True)


def main():
    p = argparse.ArgumentParser()
    p.add_argument("program", nargs="?", default="target/release/sidc")
    p.add_argument("--draws", type=int, default=3)
    p.add_argument("--large", action="store_true")
    a = p.parse_args()
    large(a.program) if a.large else small(a.program, a.draws)


if __name__ == "__main__":
    main()
