"""How the time of a fleet grows: one law from N records by Dask with two workers, in groups of eight, by the joint method.

    python crates/studies/scale/fleet.py [--most 1000]

Each record has 400 noisy readings of the angle of a pendulum with friction. Needs pip's sidc with dask and scipy.
"""

from __future__ import annotations

import argparse
import os
import time

import numpy as np
from distributed import Client, LocalCluster
from scipy.integrate import solve_ivp

import sidc
import sidc.dask

MODEL = "state x : order 2, noise 0.005\nddx ~ <sin x, cos x> + poly(x, dx; 2)\n"
TRUTH = {"sin(x)": -9.81, "dx": -0.2}


def record(seed: int) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    t = np.arange(0, 8, 0.02)
    start = random.uniform(0.8, 2.0), random.uniform(-1, 1)
    motion = solve_ivp(lambda _, s: (s[1], -9.81 * np.sin(s[0]) - 0.2 * s[1]), (0, 8), start, t_eval=t, rtol=1e-9, atol=1e-9)
    return {"t": t, "x": motion.y[0] + 0.005 * random.normal(size=len(t))}


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--most", type=int, default=1000)
    given = arguments.parse_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    print("| records | seconds | a record | law | worst error, standard errors | doubts |\n|---|---|---|---|---|---|")
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster):
        count = 10
        while count <= given.most:
            records = [record(seed) for seed in range(count)]
            begun = time.perf_counter()
            fleet = sidc.dask.identify_fleet(sidc.Model(MODEL), records)
            seconds = time.perf_counter() - begun
            assert {term.term for term in fleet.terms} == TRUTH.keys(), fleet
            worst = max(abs(t.coefficient - TRUTH[t.term]) / t.standard_error for t in fleet.terms)
            law = "passes" if fleet.passes else "doubted"
            print(f"| {count} | {seconds:.1f} | {seconds / count:.3f} s | {law} | {worst:.1f} | {dict(fleet.doubts) or 'none'} |", flush=True)
            count *= 10


if __name__ == "__main__":
    main()
