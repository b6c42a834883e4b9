"""Systems with a state that nothing reads and whose law is sought: prints the table of docs/hidden.md, "Laws of hidden states in draws".

    python3 crates/studies/hidden/table.py [target/release/sidc] [--draws 10] [--level 0.001 0.01 0.05] [--only lorenz]

Each draw has its own start and noise. An answer is exact if its laws have the terms of a system that gives the same readings, and no others: a
hidden state is known up to its scale and, where the library allows it, an offset. Needs Python 3.9, numpy.
"""
import argparse
import re
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from identified import identified
from integration import runge_kutta


def lorenz(t, s):
    x, y, z = s
    return [10 * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z]


def fitzhugh_nagumo(t, s):
    v, w = s
    return [v - v**3 / 3 - w + 0.5, 0.08 * (v + 0.7 - 0.8 * w)]


def chain(t, s):
    """Two tanks in a row, the upper one unread, behind a pump that is switched."""
    x, h = s
    return [0.5 * h - 0.3 * x - 0.05 * x**2, 2 * pump(t) - 0.8 * h]


def pump(t):
    return 1 + np.sin(0.9 * t) + 0.5 * np.sin(2.3 * t)


def relaxing(t, s):
    """A spring with a Maxwell element: the force in the dashpot is unread."""
    x, v, f = s
    return [v, -4 * x - x**3 - 0.2 * v - 2 * f + 3 * np.sin(1.3 * t) + 2 * np.sin(0.55 * t), 1.5 * v - 0.7 * f]


def rossler(t, s):
    x, y, z = s
    return [-y - z, x + 0.2 * y, 0.2 + z * (x - 5.7)]


def predation(t, s):
    a, b = s
    return [0.9 * a - 0.5 * a * b, -0.7 * b + 0.3 * a * b]


# Rates, starts, step s, samples, readings, model, and the terms of each law; several where others give the same readings with as few terms.
SYSTEMS = {
    "lorenz": dict(
        rates=lorenz, start=lambda r: [8 * r.normal(), 8 * r.normal(), 25 + 5 * r.normal()], settle=2.0, step=0.01, rows=1500, read={"x": 0, "y": 1},
        model="state x, y\nstate z : hidden\ndx, dy, dz ~ poly(x, y, z; 2)\n",
        laws=[{"dx": "x y", "dy": "y x*z", "dz": "1 z x*y"}, {"dx": "x y", "dy": "x y x*z", "dz": "z x*y"}]),
    "fitzhugh_nagumo": dict(
        rates=fitzhugh_nagumo, start=lambda r: [r.normal(), 0.5 * r.normal()], settle=0.0, step=0.1, rows=2000, read={"v": 0},
        model="state v\nstate w : hidden\ndv ~ poly(v, w; 3)\ndw ~ poly(v, w; 2)\n",
        laws=[{"dv": "v v^3 w", "dw": "1 v w"}, {"dv": "1 v v^3 w", "dw": "v w"}]),
    "tanks": dict(
        rates=chain, start=lambda r: [abs(r.normal()) + 1, abs(r.normal()) + 1], settle=0.0, step=0.05, rows=1500, read={"x": 0},
        inputs={"u": lambda t: pump(t)}, model="state x\nstate h : hidden\ninput u\ndx ~ poly(x, h; 2)\ndh ~ poly(u, h; 2)\n",
        laws=[{"dx": "x x^2 h", "dh": "u h"}]),
    "maxwell": dict(
        rates=relaxing, start=lambda r: [r.normal(), r.normal(), 0], settle=0.0, step=0.05, rows=2000, read={"x": 0},
        inputs={"u": lambda t: 3 * np.sin(1.3 * t) + 2 * np.sin(0.55 * t)},
        model="state x : order 2\nstate f : hidden\ninput u\nddx ~ <x, x^2, x^3, dx, dx^2, x*dx, f, u>\ndf ~ <1, x, dx, f>\n",
        laws=[{"ddx": "x x^3 dx f u", "df": "dx f"}, {"ddx": "x x^3 dx f u", "df": "x f"}]),
    "predation": dict(
        rates=predation, start=lambda r: [2 + r.uniform(), 1 + r.uniform()], settle=0.0, step=0.05, rows=1500, read={"a": 0},
        model="state a\nstate b : hidden\nda, db ~ poly(a, b; 2)\n", laws=[{"da": "a a*b", "db": "b a*b"}]),
    "rossler": dict(
        rates=rossler, start=lambda r: [5 + r.normal(), r.normal(), 0.1], settle=5.0, step=0.02, rows=2000, read={"x": 0, "y": 1},
        model="state x, y\nstate z : hidden\ndx, dy, dz ~ poly(x, y, z; 2)\n", laws=[{"dx": "y z", "dy": "x y", "dz": "1 z x*z"}]),
}


def record(system, rng):
    steps, h = 10, system["step"] / 10
    z, t, states = np.array(system["start"](rng), float), -system["settle"], []
    while t < -h / 2:
        z, t = runge_kutta(system["rates"], t, z, h), t + h
    for k in range(system["rows"]):
        states.append(z)
        for i in range(steps):
            z = runge_kutta(system["rates"], k * system["step"] + i * h, z, h)
    return np.array(states)


def plain(text):
    return re.sub(r"[\s*]|\^1", "", text)


def identify(program, name, seed, level):
    system = SYSTEMS[name]
    rng = np.random.default_rng([seed, *name.encode()])
    states = record(system, rng)
    times = np.arange(system["rows"]) * system["step"]
    columns = {"t": times}
    for signal, place in system["read"].items():
        clean = states[:, place]
        columns[signal] = clean + level * np.std(clean) * rng.standard_normal(len(clean))
    for signal, value in system.get("inputs", {}).items():
        columns[signal] = value(times)
    found, seconds, _ = identified(program, system["model"], columns)
    got = {e["target"]: {plain(t["term"]) for t in e["terms"]} for e in found["equations"]}
    exact = any(got == {target: {plain(t) for t in law.split()} for target, law in laws.items()} for laws in system["laws"])
    codes = sorted({r["code"] for e in found["equations"] for r in e["reasons"]})
    passed = bool(found["equations"]) and not codes and not found.get("failed")
    return {"exact": exact, "passed": exact and passed, "wrong": passed and not exact, "seconds": seconds,
            "said": f"{name} seed {seed}: {({k: sorted(v) for k, v in got.items()})} {codes}"}


def main():
    p = argparse.ArgumentParser()
    p.add_argument("program", nargs="?", default="target/release/sidc")
    p.add_argument("--draws", type=int, default=10)
    p.add_argument("--level", type=float, nargs="*", default=[0.001, 0.01, 0.05])
    p.add_argument("--only", nargs="*", default=list(SYSTEMS))
    a = p.parse_args()
    print("| system | noise | exact | of these, passed | wrong and passed | median seconds |\n|---|---|---|---|---|---|")
    missed = []
    for name in a.only:
        for level in a.level:
            runs = [identify(a.program, name, s, level) for s in range(a.draws)]
            count = lambda key: sum(r[key] for r in runs)
            print(f"| {name} | {100 * level:g} % | {count('exact')} of {len(runs)} | {count('passed')} | {count('wrong')} | "
                  f"{np.median([r['seconds'] for r in runs]):.1f} |", flush=True)
            missed += [f"{100 * level:g} % {r['said']}" for r in runs if not r["exact"]]
    print("\n".join(missed))


if __name__ == "__main__":
    main()
