"""How often the law of a bouncing ball and its coefficient of restitution are found from heights.

    python3 crates/studies/friction/bounces.py --sidc target/release/sidc [--balls 40] [--levels 0,0.002,0.005,0.01] [--rest]

ddy = -9.81, and dy -> -e dy where y falls below 0. A ball is dropped or thrown from 1 to 3 m, with e between 0.6 and 0.92, and read every 10 ms until
its flights take less than 0.25 s, or with --rest until it has lain on the floor for a second; closed forms, noise in metres. The library has 1, dy, y, dy*abs(dy). A line for each level: laws with the one term
that acts and e within 0.005, e in its 95 % interval, exact answers that pass, others that do, median seconds. Needs numpy.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np

G, STEP = 9.81, 0.01
MODEL = """state y : order 2
unknown e in 0.1 .. 1
ddy ~ <1, dy, y, dy*abs(dy)>
when y < 0 : dy -> -e*dy
"""


def heights(e, y, v, shortest):
    """Until the flights are short."""
    began, out = 0.0, []
    while True:
        t = STEP * len(out)
        flight = (v + np.sqrt(v * v + 2 * G * y)) / G
        while t >= began + flight:
            began, y, v = began + flight, 0.0, -e * (v - G * flight)
            flight = 2 * v / G
            if flight < shortest:
                return np.array(out)
        s = t - began
        out.append(y + v * s - G / 2 * s * s)


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--sidc", default="target/release/sidc")
    options.add_argument("--balls", type=int, default=40)
    options.add_argument("--levels", default="0,0.002,0.005,0.01")
    options.add_argument("--rest", action="store_true", help="records that end at rest")
    options = options.parse_args()
    print("| noise | exact | of these, e in its 95 % interval | of these, passed | others that pass | median s |")
    print("|---|---|---|---|---|---|")
    for level in map(float, options.levels.split(",")):
        exact, inside, passed, wrong, times = 0, 0, 0, 0, []
        random = np.random.default_rng(3)
        for _ in range(options.balls):
            e, y, v = random.uniform(0.6, 0.92), random.uniform(1.0, 3.0), random.uniform(-1.0, 2.0)
            path = heights(e, y, v, 1e-6 if options.rest else 0.25)
            if options.rest:
                path = np.concatenate([path, np.zeros(round(1 / STEP))])
            read = path + level * random.standard_normal(len(path))
            with tempfile.TemporaryDirectory() as folder:
                folder = pathlib.Path(folder)
                table = np.column_stack([STEP * np.arange(len(path)), read])
                np.savetxt(folder / "data.csv", table, delimiter=",", header="t,y", comments="", fmt="%.12g")
                (folder / "model.sid").write_text(MODEL)
                begun = time.time()
                command = [options.sidc, "identify", folder / "model.sid", folder / "data.csv", "-q", "-o", folder / "R.json"]
                done = subprocess.run(command, capture_output=True, text=True)
                times.append(time.time() - begun)
                found = json.loads((folder / "R.json").read_text())
            terms = [t["term"] for q in found["equations"] for t in q["terms"]]
            constant = next(iter(found.get("unknowns", [])), {"value": np.nan})
            right = terms == ["1"] and abs(constant["value"] - e) < 0.005
            low, high = constant.get("interval") or (np.nan, np.nan)
            exact += right
            inside += right and low - 1e-9 <= e <= high + 1e-9
            passed += right and done.returncode == 0
            wrong += not right and done.returncode == 0
        count = options.balls
        print(f"| {1000 * level:g} mm | {exact} of {count} | {inside} | {passed} | {wrong} | {np.median(times):.1f} |", flush=True)


if __name__ == "__main__":
    main()
