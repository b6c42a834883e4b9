"""How the cost of a table in parts grows: time and memory of `Model.identify_parts` from 10^4 to 10^7 rows of ten columns, compared with reading.

    python crates/studies/scale/growth.py [--most 1e7]

The Lorenz system is forced along a motion of sines, so that every row is exact, and its rates have errors of 0.001. Each line comes from a
separate process. Needs pip's sidc and pyarrow.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import sidc

MODEL = "state x, y, z\ninput u, v, w\ndx, dy, dz ~ poly(x, y, z, u, v, w; 2)\n"
TRUTH = {"dx": {"x": -10, "y": 10, "u": 1}, "dy": {"x": 28, "y": -1, "x*z": -1, "v": 1}, "dz": {"z": -8 / 3, "x*y": 1, "w": 1}}
GROUP = 1 << 20


def rows(first: int, count: int) -> pa.Table:
    t = (first + np.arange(count)) * 0.001
    sines = [(8.0, 1.3, 3.0, 3.1), (7.0, 0.7, 2.0, 2.3), (9.0, 0.31, 4.0, 1.7)]
    x, y, z = (a * np.sin(p * t) + b * np.cos(q * t) for a, p, b, q in sines)
    slopes = [a * p * np.cos(p * t) - b * q * np.sin(q * t) for a, p, b, q in sines]
    laws = [10 * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z]
    u, v, w = (slope - law for slope, law in zip(slopes, laws))
    error = np.random.default_rng(first).normal(scale=1e-3, size=(3, count))
    dx, dy, dz = (slope + e for slope, e in zip(slopes, error))
    return pa.table({"t": t, "x": x, "y": y, "z": z, "dx": dx, "dy": dy, "dz": dz, "u": u, "v": v, "w": w})


def write(path: Path, count: int) -> None:
    with pq.ParquetWriter(path, rows(0, 1).schema, use_dictionary=False) as file:
        for first in range(0, count, GROUP):
            file.write_table(rows(first, min(GROUP, count - first)))


def read(path: Path) -> dict[str, float]:
    for batch in pq.ParquetFile(path).iter_batches(batch_size=1 << 17):
        [column.to_numpy() for column in batch.columns]
    return {}


def identify(path: Path) -> dict[str, float]:
    found = sidc.Model(MODEL).identify_parts(path, holdout=0.1)
    terms = {(e.target, term.term): term.coefficient for e in found.equations for term in e.terms}
    exact = {(target, term): a for target, law in TRUTH.items() for term, a in law.items()}
    assert terms.keys() == exact.keys(), found
    return {"passes": found.passes, "error": max(abs(terms[key] / a - 1) for key, a in exact.items())}


def measured(work: str, path: Path) -> dict[str, float]:
    done = subprocess.run([sys.executable, __file__, work, str(path)], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("work", nargs="?", choices=["read", "identify"])
    arguments.add_argument("path", nargs="?", type=Path)
    arguments.add_argument("--most", type=float, default=1e7)
    given = arguments.parse_args()
    if given.work:
        begun = time.perf_counter()
        said = {"read": read, "identify": identify}[given.work](given.path)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(json.dumps(said | {"seconds": time.perf_counter() - begun, "memory": memory}))
        return
    print("| rows | file | reading alone | identified | ratio | memory | worst coefficient | law |\n|---|---|---|---|---|---|---|---|")
    count = 10_000
    while count <= given.most:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "lorenz.parquet"
            write(path, count)
            alone, found = measured("read", path), measured("identify", path)
            law = "passes" if found["passes"] else "doubted"
            print(
                f"| {count:,} | {path.stat().st_size / 1e6:.1f} MB | {alone['seconds']:.2f} s | {found['seconds']:.2f} s "
                f"| {found['seconds'] / alone['seconds']:.1f} | {found['memory']:.0f} MB | {found['error']:.1e} | {law} |",
                flush=True,
            )
        count *= 10


if __name__ == "__main__":
    main()
