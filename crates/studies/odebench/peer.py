"""PySINDy compared with docs/odebench.md: the same systems, starts, noise and libraries, except those with unknown constants.

    python3 crates/studies/odebench/peer.py [--level 0 0.01 0.05] [--draws 3]

Differences of order 6, and smoothed ones over 11, 31 and 61 samples, with STLSQ. For each run the best of these and of eleven thresholds is
taken, which a user could not know. Needs PySINDy 2.1, numpy, scipy, and sidc for the terms of the libraries (`sidc check --terms`).
"""
import argparse
import itertools
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pysindy

from systems import SYSTEMS
from table import FUNCTIONS, TIMES, fingerprint, model, motion, points

THRESHOLDS = [1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0]


def derivatives():
    yield pysindy.FiniteDifference(order=6)
    for window in (11, 31, 61):
        yield pysindy.SmoothedFiniteDifference(smoother_kws={"window_length": window, "polyorder": 3}, order=4)


def terms(program, system):
    """The candidates of a system's library, as sidc prints them."""
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "model.sid"
        path.write_text(model(system))
        run = subprocess.run([program, "check", path, "--terms"], capture_output=True, text=True, check=True)
    first = run.stdout.split("dx0 ~\n")[1].splitlines()
    return [line.strip() for line in itertools.takewhile(lambda l: l.startswith(" "), first)]


def library(all_terms, states):
    names = ", ".join(f"x{i}" for i in range(states))
    make = lambda t: eval(f"lambda {names}: ({t.replace('^', '**')}) + 0*x0", dict(FUNCTIONS))
    functions = [make(t) for t in all_terms]
    labels = [lambda *_, t=t: t for t in all_terms]
    return pysindy.CustomLibrary(library_functions=functions, function_names=labels, interaction_only=True)


def exact(system, all_terms, coefficients):
    at = points(system)
    prints = [fingerprint(t, at) for t in all_terms]
    for law, row in zip(system["laws"], coefficients):
        found = {p for p, c in zip(prints, row) if c != 0}
        if found != {fingerprint(t, at) for t in law}:
            return False
    return True


def main():
    p = argparse.ArgumentParser()
    p.add_argument("program", nargs="?", default="target/release/sidc")
    p.add_argument("--level", type=float, nargs="*", default=[0, 0.01, 0.05])
    p.add_argument("--draws", type=int, default=3)
    a = p.parse_args()
    warnings.simplefilter("ignore")
    counts = {level: [0, 0] for level in a.level}
    for system in SYSTEMS:
        clean = [motion(system, start) for start in system["starts"]]
        size = np.vstack(clean).std(0)
        known = not system["constants"]
        own = terms(a.program, system) if known else []
        for level in a.level:
            for draw in range(a.draws if level else 1):
                counts[level][1] += 1
                if not known:
                    continue
                rng = np.random.default_rng([system["number"], draw, int(1000 * level)])
                tables = [x + level * size * rng.standard_normal(x.shape) for x in clean]
                best = False
                for method, threshold in itertools.product(derivatives(), THRESHOLDS):
                    if best:
                        break
                    peer = pysindy.SINDy(
                        feature_library=library(own, clean[0].shape[1]),
                        differentiation_method=method,
                        optimizer=pysindy.STLSQ(threshold=threshold, alpha=1e-9),
                    )
                    try:
                        peer.fit(tables, t=[TIMES, TIMES])
                        best = best or exact(system, own, peer.coefficients())
                    except Exception as e:
                        print(system["number"], repr(e)[:200], file=sys.stderr)
                        break
                counts[level][0] += best
        print(system["number"], counts, flush=True)
    for level, (right, of) in counts.items():
        print(f"{100 * level:g} %: exact {right} of {of}")


if __name__ == "__main__":
    main()
