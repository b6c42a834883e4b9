"""The cost of the Python package: import, overhead over the program, calls of the right side, and Lorenz compared with PySINDy.

    cargo build --release -p sidc-cli -p sidc-python && pip install './python[test]' && python benches/python.py

In: the program at target/release/sidc. Out: lines of figures; each is the smallest of several. Programs are compared by processor time,
because the machine may be shared.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

import sidc

PROGRAM = Path(__file__).resolve().parents[1] / "target/release/sidc"
MODEL = "state x, y, z\ndx, dy, dz ~ poly(x, y, z; 3)\n"


def lorenz(rows: int) -> tuple[np.ndarray, np.ndarray]:
    def rates(_: float, s: np.ndarray) -> list[float]:
        return [10 * (s[1] - s[0]), s[0] * (28 - s[2]) - s[1], s[0] * s[1] - 8 / 3 * s[2]]

    t = np.arange(rows) * 0.002
    return t, solve_ivp(rates, (0, t[-1]), [-8.0, 8.0, 27.0], t_eval=t, rtol=1e-10, atol=1e-10).y.T


def least(work: Callable[[], object], who: int = resource.RUSAGE_SELF, times: int = 5) -> float:
    """Seconds of processor time, the smallest of several runs."""

    def used() -> float:
        usage = resource.getrusage(who)
        return usage.ru_utime + usage.ru_stime

    def once() -> float:
        before = used()
        work()
        return used() - before

    return min(once() for _ in range(times))


def imported() -> float:
    """Milliseconds of `import sidc`, without the start of the interpreter."""
    command = [sys.executable, "-X", "importtime", "-c", "import sidc"]
    lines = (subprocess.run(command, capture_output=True, text=True, check=True).stderr for _ in range(5))
    totals = [line.split("|")[1] for text in lines for line in text.splitlines() if line.endswith("| sidc")]
    return min(int(total) for total in totals) / 1e3


def overhead(rows: int = 100_000) -> tuple[float, float]:
    """Processor seconds of the module and of the program on the same rows."""
    t, states = lorenz(rows)
    table = dict(zip("txyz", (t, *states.T.copy())))
    model = sidc.Model(MODEL)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        (path / "m.sid").write_text(MODEL)
        np.savetxt(path / "d.csv", np.column_stack((t, states)), "%.17g", ",", header="t,x,y,z", comments="")
        command = [PROGRAM, "identify", "m.sid", "d.csv", "-o", "r.json"]
        program = lambda: subprocess.run(command, cwd=path, capture_output=True, check=False)  # noqa: E731
        return least(lambda: model.identify(table)), least(program, resource.RUSAGE_CHILDREN)


def beside_pysindy(noise: float, rows: int = 10_000) -> tuple[float, float]:
    """Processor seconds of both on the same rows; the noise is relative to each signal's spread."""
    import pysindy as ps

    t, states = lorenz(rows)
    states = states + noise * states.std(axis=0) * np.random.default_rng(1).normal(size=states.shape)
    ours = sidc.Identifier("poly(x, y, z; 2)")
    theirs = ps.SINDy(optimizer=ps.STLSQ(threshold=0.1))
    return least(lambda: ours.fit(states, t=t)), least(lambda: theirs.fit(states, t=t))


def calls(count: int = 20_000) -> tuple[float, float]:
    """Microseconds per call of the right side at one point: compiled, and as exported Python."""
    t, states = lorenz(1000)
    result = sidc.Identifier("poly(x, y, z; 2)").fit(states, t=t).result_
    code: dict[str, Callable[..., object]] = {}
    exec(result.export("python"), code)

    def each(function: Callable[..., object]) -> float:
        began = time.perf_counter()
        for _ in range(count):
            function(0.0, states[0])
        return 1e6 * (time.perf_counter() - began) / count

    return each(result.function()), each(code["derivatives"])


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    print(f"import: {imported():.0f} ms")
    module, program = overhead()
    print(f"100,000 rows: module {module:.2f} s, program {program:.2f} s, {100 * (module / program - 1):+.0f} %")
    for noise in (0.0, 0.001, 0.05):
        ours, theirs = beside_pysindy(noise)
        print(f"Lorenz, 10,000 rows, noise {noise:.1%}: sidc {ours:.3f} s, PySINDy {theirs:.3f} s, ratio {ours / theirs:.1f}")
    compiled, exported = calls()
    print(f"a call of the right side: {compiled:.1f} us, exported Python {exported:.1f} us")
