#!/usr/bin/env python3
"""Identification from noisy data as a whole: two builds compared on the same files in one run.

    python3 benches/joint.py OTHER/sidc target/release/sidc          # some two minutes
    python3 benches/joint.py A B --only swings --repeats 3

In:  two `sidc` binaries; the cart-pendulum comes from `cargo run --release -p sidc-studies --bin plant`, Lorenz 96 from this file.
Out: one Markdown table: seconds of processor time and peak memory of each, their ratio, and whether both printed the same equations.
     The processor time of all threads is comparable even on a busy machine. Every case is run --repeats times; the smallest time counts.
"""

import argparse
import pathlib
import random
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
CART = """system cart_pendulum
state y, theta : order 2
input F : hold
ddy, ddtheta ~ powers(y, dy, ddy, ddtheta, sin theta, cos theta, F; 1) * powers(dtheta; 2)
"""
LORENZ96 = "system lorenz96\nstate a, b, c, d, e\nda, db, dc, dd, de ~ poly(a, b, c, d, e; 2)\n"


def cart(folder, force, start, level):
    """4,000 samples of two positions at 100 Hz, 192 terms per equation; noise relative to 0.3 m and 1 rad."""
    clean = folder / "clean.csv"
    plant = ["cargo", "run", "--quiet", "--release", "-p", "sidc-studies", "--bin", "plant", "--"]
    options = ["--seed", "7", "--force", force, "--rows", "4000", "--start", start, "--columns", "positions"]
    subprocess.run([*plant, *options, "-o", clean], cwd=ROOT, check=True)
    lines = [l for l in clean.read_text().splitlines() if not l.startswith("#")]
    normal = random.Random(1).gauss
    rows = [lines[0]]
    for line in lines[1:]:
        t, y, theta, command = line.split(",")
        rows.append(f"{t},{float(y) + normal(0, 0.3 * level)},{float(theta) + normal(0, level)},{command}")
    (folder / "data.csv").write_text("\n".join(rows) + "\n")
    (folder / "model.sid").write_text(CART)


def lorenz96(folder, samples):
    """Five states at 100 Hz, noise of 2 % of a spread of 3.6, 21 terms per equation."""
    n, h = 5, 0.01

    def rates(x):
        return [(x[(i + 1) % n] - x[i - 2]) * x[i - 1] - x[i] + 8 for i in range(n)]

    def after(x, k, s):
        return [a + s * b for a, b in zip(x, k)]

    chance = random.Random(1)
    x = [8 + chance.gauss(0, 1) for _ in range(n)]
    rows = ["t,a,b,c,d,e"]
    for k in range(samples):
        rows.append(",".join(f"{v:.9g}" for v in [k * h, *(v + chance.gauss(0, 0.072) for v in x)]))
        k1 = rates(x)
        k2 = rates(after(x, k1, h / 2))
        k3 = rates(after(x, k2, h / 2))
        k4 = rates(after(x, k3, h))
        x = [v + h / 6 * (a + 2 * b + 2 * c + d) for v, a, b, c, d in zip(x, k1, k2, k3, k4)]
    (folder / "data.csv").write_text("\n".join(rows) + "\n")
    (folder / "model.sid").write_text(LORENZ96)


CASES = {
    "swings, 0.1 %": lambda f: cart(f, "chirp", "0.2", 0.001),
    "swings, 1 %": lambda f: cart(f, "chirp", "0.2", 0.01),
    "swings, 5 %": lambda f: cart(f, "chirp", "0.2", 0.05),
    "small swings, 0.1 %": lambda f: cart(f, "gaussian", "0.55", 0.001),
    "small swings, 1 %": lambda f: cart(f, "gaussian", "0.55", 0.01),
    "Lorenz 96, 10⁵ samples": lambda f: lorenz96(f, 100_000),
}


def run(sidc, folder):
    """Processor time in s, peak memory in MB, equations."""
    command = [sidc, "identify", folder / "model.sid", folder / "data.csv"]
    code = "import resource,subprocess,sys; p=subprocess.run(sys.argv[1:]); u=resource.getrusage(resource.RUSAGE_CHILDREN); print(u.ru_utime+u.ru_stime,u.ru_maxrss,file=sys.stderr)"
    done = subprocess.run(["python3", "-c", code, *command], capture_output=True, text=True)
    seconds, kilobytes = map(float, done.stderr.split()[-2:])
    terms = re.findall(r"[*A-Za-z_^()0-9]*[A-Za-z][*A-Za-z_^()0-9]*", re.split(r"\nlaw:", done.stdout)[0])
    return seconds, kilobytes / 1000, terms


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("before")
    options.add_argument("now")
    options.add_argument("--only", default="")
    options.add_argument("--repeats", type=int, default=1)
    options = options.parse_args()
    print("| case | before (s) | now (s) | ratio | before (MB) | now (MB) | same terms |")
    print("|---|---:|---:|---:|---:|---:|---|")
    for name, make in CASES.items():
        if options.only not in name:
            continue
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            make(folder)
            best = lambda sidc: min((run(pathlib.Path(sidc).resolve(), folder) for _ in range(options.repeats)), key=lambda r: r[0])
            a, b = best(options.before), best(options.now)
        same = "yes" if a[2] == b[2] else "no"
        print(f"| {name} | {a[0]:.2f} | {b[0]:.2f} | {a[0] / b[0]:.1f} | {a[1]:.0f} | {b[1]:.0f} | {same} |", flush=True)


if __name__ == "__main__":
    main()
