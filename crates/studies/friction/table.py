"""How often friction and thresholds are found from positions: random bodies, pushed to and fro.

    python3 crates/studies/friction/table.py --sidc target/release/sidc [--family friction] [--systems 40] [--levels 0,0.001,0.01,0.05]

friction:  ddx = b u - k x - c dx - F sign(dx), for every second body less S sign(dx) exp(-abs(dx)/vs), vs unknown.
threshold: ddx = b u - k x - c dx + F step(x - x0), x0 unknown.
play:      ddx = b u - c dx - K (max(x - gap, 0) + min(x + gap, 0)), gap unknown: a free body between two springs, as in a gear.

They are integrated from event to event, independently of the program. Noise of the positions is relative to their spread. A line for each
level: share of exact supports, share of true coefficients and constants in their 95 % intervals, exact answers that pass, others that do,
median seconds. Needs numpy.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np

ROWS, STEP, WITHIN = 1500, 0.01, 10
LIBRARY = "1, x, x^2, x^3, dx, dx*abs(dx), dx^3, u, u*x"
STRIBECK = "exp(-abs(dx)/vs)*sign(dx)"


class Friction:
    """Law, constants, and the acceleration on one side of rest."""

    def __init__(self, seed, random):
        self.law = {
            "x": -random.uniform(2.0, 15.0),
            "dx": -random.uniform(0.1, 1.5),
            "sign(dx)": -random.uniform(0.4, 2.0),
            "u": random.uniform(0.5, 2.0),
        }
        self.constants, strength = {}, 0.0
        if seed % 2:
            strength = random.uniform(0.5, 1.5) * abs(self.law["sign(dx)"])
            self.law[STRIBECK] = -strength
            self.constants["vs"] = random.uniform(0.1, 0.4)
        self.most = 3.0 * (abs(self.law["sign(dx)"]) + strength) / self.law["u"]
        special = f", sign(dx), {STRIBECK}" if self.constants else ", sign(dx)"
        unknown = "unknown vs in 0.02..2\n" if self.constants else ""
        self.model = f"{unknown}state x : order 2\ninput u : hold\nddx ~ <{LIBRARY}{special}>\n"

    def dry(self, v):
        vs = self.constants.get("vs", 1.0)
        return self.law["sign(dx)"] + self.law.get(STRIBECK, 0.0) * np.exp(-abs(v) / vs)

    def rate(self, x, v, u, side):
        law = self.law
        return law["x"] * x + law["dx"] * v + law["u"] * u + side * self.dry(v)

    def guard(self, x, v):
        return v

    def side(self, x, v, u):
        """1, -1, or 0 at rest."""
        if v != 0.0:
            return np.sign(v)
        force = self.rate(x, 0.0, u, 0.0)
        return np.sign(force) if abs(force) > abs(self.dry(0.0)) else 0.0

    def after(self, x, v):
        return x, 0.0


class Threshold:
    def __init__(self, seed, random):
        self.law = {
            "x": -random.uniform(2.0, 15.0),
            "dx": -random.uniform(0.2, 1.5),
            "step(x - x0)": random.choice([-1, 1]) * random.uniform(0.5, 3.0),
            "u": random.uniform(0.5, 2.0),
        }
        self.most = 4.0 / self.law["u"]
        spread = 4.0 / abs(self.law["x"])
        self.constants = {"x0": random.uniform(-0.5, 0.5) * spread}
        self.model = (
            f"unknown x0 in {-spread:.3g}..{spread:.3g}\nstate x : order 2\ninput u : hold\nddx ~ <{LIBRARY}, step(x - x0)>\n"
        )

    def rate(self, x, v, u, side):
        law = self.law
        return law["x"] * x + law["dx"] * v + law["u"] * u + 0.5 * (1.0 + side) * law["step(x - x0)"]

    def guard(self, x, v):
        return x - self.constants["x0"]

    def side(self, x, v, u):
        apart = self.guard(x, v)
        return np.sign(apart) if abs(apart) > 1e-13 else np.sign(v)

    def after(self, x, v):
        return self.constants["x0"], v


class Play:
    SPRINGS = "min(gap + x, 0) + max(x - gap, 0)"

    def __init__(self, seed, random):
        self.law = {
            self.SPRINGS: -random.uniform(20.0, 150.0),
            "dx": -random.uniform(0.2, 1.5),
            "u": random.uniform(0.5, 2.0),
        }
        self.most = 4.0 / self.law["u"]
        self.constants = {"gap": random.uniform(0.05, 0.25)}
        self.model = (
            "unknown gap in 0.01..1\nstate x : order 2\ninput u : hold\n"
            f"ddx ~ <{LIBRARY}, max(x - gap, 0) + min(x + gap, 0)>\n"
        )

    def rate(self, x, v, u, side):
        pushed = 0.0 if side > 0 else x - np.copysign(self.constants["gap"], x)
        return self.law[self.SPRINGS] * pushed + self.law["dx"] * v + self.law["u"] * u

    def guard(self, x, v):
        """Positive between the springs."""
        return self.constants["gap"] - abs(x)

    def side(self, x, v, u):
        apart = self.guard(x, v)
        return np.sign(apart) if abs(apart) > 1e-13 else -np.sign(x * v)

    def after(self, x, v):
        return np.copysign(self.constants["gap"], x), v


def force(body, random):
    out, k = np.zeros(ROWS), 0
    while k < ROWS:
        length = random.integers(15, 80)
        out[k : k + length] = round(random.uniform(-body.most, body.most), 2)
        k += length
    return out


def integrate(body, inputs):
    """Positions at the samples: classical Runge-Kutta between events found by bisection; at rest while friction suffices."""

    def step(x, v, h, side, u):
        a = v, body.rate(x, v, u, side)
        b = v + h / 2 * a[1], body.rate(x + h / 2 * a[0], v + h / 2 * a[1], u, side)
        c = v + h / 2 * b[1], body.rate(x + h / 2 * b[0], v + h / 2 * b[1], u, side)
        d = v + h * c[1], body.rate(x + h * c[0], v + h * c[1], u, side)
        return x + h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]), v + h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])

    x, v, out = 0.3, 0.0, [0.3]
    for u in inputs[:-1]:
        left = STEP
        while left > 1e-15:
            side = body.side(x, v, u)
            if side == 0.0:
                break
            h = min(left, STEP / WITHIN)
            to = step(x, v, h, side, u)
            if body.guard(*to) * side >= 0.0:
                (x, v), left = to, left - h
                continue
            low, high = 0.0, h
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if body.guard(*step(x, v, middle, side, u)) * side >= 0.0 else (low, middle)
            x, v = body.after(*step(x, v, low, side, u))
            left -= low
        out.append(x)
    return np.array(out)


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--sidc", default="target/release/sidc")
    options.add_argument("--family", choices=("friction", "threshold", "play"), default="friction")
    options.add_argument("--systems", type=int, default=40)
    options.add_argument("--levels", default="0,0.001,0.01,0.05")
    options = options.parse_args()
    family = {"friction": Friction, "threshold": Threshold, "play": Play}[options.family]
    print("| noise | exact | of these, numbers in their 95 % intervals | of these, passed | others that pass | median s |")
    print("|---|---|---|---|---|---|")
    for level in map(float, options.levels.split(",")):
        exact, inside, numbers, passed, wrong, times = 0, 0, 0, 0, 0, []
        for seed in range(options.systems):
            random = np.random.default_rng(seed)
            body = family(seed, random)
            inputs = force(body, random)
            path = integrate(body, inputs)
            with tempfile.TemporaryDirectory() as folder:
                folder = pathlib.Path(folder)
                read = path + level * path.std() * random.standard_normal(ROWS)
                table = np.column_stack([STEP * np.arange(ROWS), read, inputs])
                np.savetxt(folder / "data.csv", table, delimiter=",", header="t,x,u", comments="", fmt="%.12g")
                (folder / "model.sid").write_text(body.model)
                begun = time.time()
                command = [options.sidc, "identify", folder / "model.sid", folder / "data.csv", "-q", "-o", folder / "R.json"]
                done = subprocess.run(command, capture_output=True, text=True)
                times.append(time.time() - begun)
                found = json.loads((folder / "R.json").read_text())
            terms = [t for e in found["equations"] for t in e["terms"]]
            right = {t["term"] for t in terms} == set(body.law)
            exact += right
            passed += right and done.returncode == 0
            wrong += not right and done.returncode == 0
            if not right:
                continue
            values = [(t["coefficient"], t.get("standard_error"), body.law[t["term"]]) for t in terms]
            values += [(c["value"], c.get("standard_error"), body.constants[c["name"]]) for c in found.get("unknowns", [])]
            for value, error, truth in values:
                numbers += 1
                inside += abs(value - truth) <= 1.96 * (error or 1e-6 * abs(truth))
        share = 100 * inside / max(numbers, 1)
        print(
            f"| {100 * level:g} % | {exact} of {options.systems} | {share:.0f} % | {passed} | {wrong} | {np.median(times):.1f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
