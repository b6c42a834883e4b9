"""Long work: Python's lock is free, Ctrl-C ends it at once, progress is reported, limits hold."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sidc
from sidc._progress import Progress

HEAVY = "state x, y, z : order 2\nddx, ddy, ddz ~ powers(x, y, z, dx, dy, dz, sin x, cos x, sin y, cos y, sin z; 2)\n"
"""177,147 candidates for each equation, which take seconds."""


def heavy_data() -> dict[str, np.ndarray]:
    t = np.arange(600) * 0.02
    noise = np.random.default_rng(0).normal(size=(3, 600))
    waves = {name: np.sin((1 + k) * t + k) + 0.3 * np.cos(2.7 * (k + 1) * t) for k, name in enumerate("xyz")}
    return {"t": t, **{name: wave + 0.01 * noise[k] for k, (name, wave) in enumerate(waves.items())}}


@pytest.mark.skipif(os.name == "nt", reason="signals are those of Unix")
def test_ctrl_c_ends_work_within_half_a_second() -> None:
    model, data = sidc.Model(HEAVY), heavy_data()
    sent: list[float] = []

    def interrupt() -> None:
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    for delay in (0.2, 1.0):
        timer = threading.Timer(delay, interrupt)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            model.identify(data, method="regression")
        assert time.monotonic() - sent[-1] < 0.5


@pytest.mark.skipif(os.name == "nt", reason="signals are those of Unix")
def test_ctrl_c_ends_reading_and_reducing_at_once(tmp_path: Path) -> None:
    model = sidc.Model("state x\ndx ~ poly(x; 3)\n")
    rows = "\n".join(f"{0.001 * k:.3f},{k % 997},{k % 331}" for k in range(1_000_000))
    path = tmp_path / "large.csv"
    path.write_text(f"t,x,dx\n{rows}\n")
    t = np.arange(2_000_000) * 1e-3
    part = {"t": t, "x": np.sin(t), "dx": np.cos(t)}

    def forever() -> Iterator[dict[str, np.ndarray]]:
        while True:
            yield part

    work: list[Callable[[], Any]] = [lambda: model.identify(path), lambda: model.identify_parts(forever())]
    for one in work:
        sent: list[float] = []

        def interrupt(sent: list[float] = sent) -> None:
            sent.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

        threading.Timer(0.1, interrupt).start()
        with pytest.raises(KeyboardInterrupt):
            one()
        assert time.monotonic() - sent[-1] < 0.5


def test_other_threads_go_on_meanwhile() -> None:
    model, data = sidc.Model(HEAVY), heavy_data()
    ticks = 0
    working = threading.Event()

    def count() -> None:
        nonlocal ticks
        while not working.wait(0.01):
            ticks += 1

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    model.identify(data, method="regression", time_limit=1.0)
    taken = time.monotonic() - began
    working.set()
    thread.join()
    # There would be a tick every hundredth of a second if the thread had a core to itself.
    assert ticks > 20 * taken


def test_the_time_limit_holds() -> None:
    began = time.monotonic()
    result = sidc.Model(HEAVY).identify(heavy_data(), method="regression", time_limit=0.5)
    assert time.monotonic() - began < 10
    assert not result.passes
    with pytest.raises(ValueError, match="time_limit is a number of seconds"):
        sidc.Model(HEAVY).identify(heavy_data(), time_limit=-1)


def test_proofs_have_a_time_of_their_own(decay: dict[str, np.ndarray]) -> None:
    data, model = heavy_data(), sidc.Model("state x, y, z : order 2\nddx, ddy, ddz ~ poly(x, y, z, dx, dy, dz; 3)\n")
    began = time.monotonic()
    cut = model.identify(data, method="regression", prove_sparsest=0.5)
    assert time.monotonic() - began < 20
    assert all(equation.evidence is not None and equation.evidence.sparsest is not None for equation in cut.equations)
    # The end of a proof does not end the search.
    assert "time-limit" not in {doubt.code for doubt in cut.doubts}
    whole = sidc.Model("state x\ndx ~ poly(x; 2)\n").identify(decay, prove_sparsest=True)
    assert whole.equations[0].evidence is not None


def test_numbers_without_meaning_are_refused(decay: dict[str, np.ndarray]) -> None:
    model = sidc.Model("state x\ndx ~ poly(x; 2)\n")
    nan, inf = float("nan"), float("inf")
    cases: list[tuple[str, list[object]]] = [
        ("horizon", [0, -1, nan, inf]),
        ("good", [0, nan, {"x": -1}]),
        ("noise", [{"x": 0}, {"x": -1}, {"x": nan}, {"x": inf}, {"x": (0, 0)}]),
        ("samples", [0, -1]),
        ("seed", [-1, 2**64]),
        ("memory_limit", [0, 2**64]),
        ("prove_sparsest", [-1.0, nan]),
    ]
    for name, values in cases:
        for value in values:
            with pytest.raises(ValueError, match=name):
                model.identify(decay, **{name: value})  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="no table"):
        model.identify([])


def test_progress_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    import tqdm.auto

    told: list[tuple[int, str]] = []

    class Bar:
        def __init__(self, total: int, **_: object) -> None:
            assert total == 3
            self.n = 0

        def set_description(self, text: str, refresh: bool) -> None:
            told.append((self.n, text))

        def refresh(self) -> None: ...

        def close(self) -> None:
            told.append((self.n, "closed"))

    monkeypatch.setattr(tqdm.auto, "tqdm", Bar)
    sidc.Model(HEAVY).identify(heavy_data(), method="regression", time_limit=1.5, progress=True)
    assert any(text.startswith("ddx: ") for _, text in told)
    assert told[-1][1] == "closed"


def test_nothing_is_shown_where_nobody_looks(decay: dict[str, np.ndarray]) -> None:
    assert Progress(["dx"], wanted=False).heard is None
    assert Progress(["dx"], wanted=None).heard is None or sys.stderr.isatty()


def test_import_is_light() -> None:
    """numpy and the frame packages are loaded only when they are used."""
    code = "import sys; import sidc; print([m for m in ('numpy', 'pandas', 'scipy', 'matplotlib', 'sympy') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
