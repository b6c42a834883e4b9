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


def seconds(work: Callable[[], Any]) -> float:
    began = time.monotonic()
    work()
    return time.monotonic() - began


def seconds_after_ctrl_c(work: Callable[[], Any], delay: float, told: Callable[[], None] = lambda: None) -> float:
    """From a Ctrl-C that comes `delay` seconds after the start to the end of the work. `told` is called with the Ctrl-C."""
    sent: list[float] = []

    def interrupt() -> None:
        told()
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(delay, interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        work()
    return time.monotonic() - sent[-1]


# Times are compared with those of the whole work, so that the tests hold on a busy machine.
@pytest.mark.skipif(os.name == "nt", reason="signals are those of Unix")
def test_ctrl_c_ends_work_at_once() -> None:
    # 6,561 candidates an equation: the whole takes some seconds.
    model = sidc.Model("state x, y, z : order 2\nddx, ddy, ddz ~ powers(x, y, z, dx, dy, dz, sin x, cos x; 2)\n")
    data = heavy_data()

    def work() -> sidc.Result:
        return model.identify(data, method="regression")

    whole = seconds(work)
    for part in (0.1, 0.4):
        assert seconds_after_ctrl_c(work, part * whole) < 0.3 * whole


@pytest.mark.skipif(os.name == "nt", reason="signals are those of Unix")
def test_ctrl_c_ends_reading_at_once(tmp_path: Path) -> None:
    model = sidc.Model("state x\ndx ~ poly(x; 3)\n")
    waves = [2.0 + np.sin(1e-5 * k) for k in range(1_000_000)]
    rows = "\n".join(f"{1e-5 * k:.5f},{x:.6f},{-x:.6f}" for k, x in enumerate(waves))
    path = tmp_path / "large.csv"
    path.write_text(f"t,x,dx\n{rows}\n")
    whole = seconds(lambda: model.identify(path))
    assert seconds_after_ctrl_c(lambda: model.identify(path), 0.1 * whole) < 0.5 * whole


@pytest.mark.skipif(os.name == "nt", reason="signals are those of Unix")
def test_ctrl_c_ends_reducing_at_once() -> None:
    model = sidc.Model("state x\ndx ~ poly(x; 3)\n")
    t = np.arange(200_000) * 1e-3
    part = {"t": t, "x": np.sin(t), "dx": np.cos(t)}
    read: list[int] = []
    read_then: list[int] = []

    def forever() -> Iterator[dict[str, np.ndarray]]:
        while True:
            read.append(1)
            yield part

    seconds_after_ctrl_c(lambda: model.identify_parts(forever()), 0.3, lambda: read_then.append(len(read)))
    assert len(read) <= read_then[0] + 2


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
    result = sidc.Model(HEAVY).identify(heavy_data(), method="regression", time_limit=0.5)
    assert not result.passes
    assert "time-limit" in {doubt.code for doubt in result.doubts}
    with pytest.raises(ValueError, match="time_limit is a number of seconds"):
        sidc.Model(HEAVY).identify(heavy_data(), time_limit=-1)


def test_proofs_have_a_time_of_their_own(decay: dict[str, np.ndarray]) -> None:
    data, model = heavy_data(), sidc.Model("state x, y, z : order 2\nddx, ddy, ddz ~ poly(x, y, z, dx, dy, dz; 3)\n")
    cut = model.identify(data, method="regression", prove_sparsest=0.5)
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
