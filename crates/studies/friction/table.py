"""How often friction is found from positions: random bodies with dry or Stribeck friction, pushed back and forth.

    python3 crates/studies/friction/table.py --sidc target/release/sidc [--systems 40] [--levels 0,0.001,0.01,0.05]

Every body obeys ddx = b u - k x - c dx - F sign(dx), every second one with the additional term -S sign(dx) exp(-abs(dx)/vs), vs unknown. It
is integrated from event to event, independently of the program. Noise of the positions is relative to their spread. A line for each level:
share of exact supports, share of true coefficients in their intervals, passes with a wrong support, median seconds, and runs that stopped at
a standstill. Needs numpy.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np

ROWS, STEP, WITHIN = 1500, 0.01, 10


def body(seed):
    random = np.random.default_rng(seed)
    law = {
        "x": -random.uniform(2.0, 15.0),
        "dx": -random.uniform(0.1, 1.5),
        "sign(dx)": -random.uniform(0.4, 2.0),
        "u": random.uniform(0.5, 2.0),
    }
    stribeck = None
    if seed % 2:
        stribeck = (-random.uniform(0.5, 1.5) * abs(law["sign(dx)"]), random.uniform(0.1, 0.4))
    force, k = np.zeros(ROWS), 0
    most = 3.0 * (abs(law["sign(dx)"]) + (abs(stribeck[0]) if stribeck else 0.0)) / law["u"]
    while k < ROWS:
        length = random.integers(15, 80)
        force[k : k + length] = round(random.uniform(-most, most), 2)
        k += length
    return law, stribeck, force, random


def integrate(law, stribeck, force):
    """Positions and speeds at the samples: classical Runge-Kutta between events found by bisection; at rest while friction suffices."""

    def pull(x, v, u):
        return law["x"] * x + law["dx"] * v + law["u"] * u

    def dry(v):
        own = law["sign(dx)"]
        return own + (stribeck[0] * np.exp(-abs(v) / stribeck[1]) if stribeck else 0.0)

    def step(x, v, h, side, u):
        def rate(x, v):
            return v, pull(x, v, u) + side * dry(v)

        a = rate(x, v)
        b = rate(x + h / 2 * a[0], v + h / 2 * a[1])
        c = rate(x + h / 2 * b[0], v + h / 2 * b[1])
        d = rate(x + h * c[0], v + h * c[1])
        return x + h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]), v + h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])

    x, v, out = 0.3, 0.0, [(0.3, 0.0)]
    for u in force[:-1]:
        left = STEP
        while left > 1e-15:
            if v == 0.0:
                force_at_rest = pull(x, 0.0, u)
                if abs(force_at_rest) <= abs(dry(0.0)):
                    break
                side = np.sign(force_at_rest)
            else:
                side = np.sign(v)
            h = min(left, STEP / WITHIN)
            to_x, to_v = step(x, v, h, side, u)
            if to_v * side >= 0.0:
                x, v, left = to_x, to_v, left - h
                continue
            low, high = 0.0, h
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if step(x, v, middle, side, u)[1] * side >= 0.0 else (low, middle)
            x, v = step(x, v, low, side, u)[0], 0.0
            left -= low
        out.append((x, v))
    return np.array(out)


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--sidc", default="target/release/sidc")
    options.add_argument("--systems", type=int, default=40)
    options.add_argument("--levels", default="0,0.001,0.01,0.05")
    options = options.parse_args()
    print("| noise | exact | coefficients in their intervals | wrong passes | median s | stopped |")
    print("|---|---|---|---|---|---|")
    for level in map(float, options.levels.split(",")):
        exact, inside, coefficients, wrong, times, stopped = 0, 0, 0, 0, [], 0
        for seed in range(options.systems):
            law, stribeck, force, random = body(seed)
            path = integrate(law, stribeck, force)
            with tempfile.TemporaryDirectory() as folder:
                folder = pathlib.Path(folder)
                read = path[:, 0] + level * path[:, 0].std() * random.standard_normal(ROWS)
                table = np.column_stack([STEP * np.arange(ROWS), read, force])
                np.savetxt(folder / "data.csv", table, delimiter=",", header="t,x,u", comments="", fmt="%.12g")
                special = ", sign(dx)*exp(-abs(dx)/vs)" if stribeck else ""
                unknown = "unknown vs in 0.02..2\n" if stribeck else ""
                model = f"{unknown}state x : order 2\ninput u : hold\nddx ~ <1, x, x^2, x^3, dx, dx*abs(dx), dx^3, u, u*x, sign(dx){special}>\n"
                (folder / "model.sid").write_text(model)
                begun = time.time()
                command = [options.sidc, "identify", folder / "model.sid", folder / "data.csv", "-q", "-o", folder / "R.json"]
                done = subprocess.run(command, capture_output=True, text=True)
                times.append(time.time() - begun)
                found = json.loads((folder / "R.json").read_text())
                truth = dict(law)
                if stribeck:
                    truth["exp(-abs(dx)/vs)*sign(dx)"] = stribeck[0]
                terms = [t for e in found["equations"] for t in e["terms"]]
                right = {t["term"] for t in terms} == set(truth)
                exact += right
                wrong += done.returncode == 0 and not right
                if right:
                    for t in terms:
                        coefficients += 1
                        error = t.get("standard_error") or 1e-6 * abs(truth[t["term"]])
                        inside += abs(t["coefficient"] - truth[t["term"]]) <= 1.96 * error
                stopped += "step-too-small" in json.dumps(found)
        row = (exact, inside / max(coefficients, 1), wrong, np.median(times), stopped)
        print(f"| {100 * level:g} % | {row[0]} of {options.systems} | {100 * row[1]:.0f} % | {row[2]} | {row[3]:.1f} | {row[4]} |", flush=True)


if __name__ == "__main__":
    main()
