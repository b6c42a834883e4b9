"""Shared by the tests: the checkout, the program, records of known systems."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def program() -> Path:
    """The program `sidc` of this checkout: $SIDC, else the newest build."""
    given = os.environ.get("SIDC")
    built = [path for path in (ROOT / "target/release/sidc", ROOT / "target/debug/sidc") if path.exists()]
    if given is None and not built:
        subprocess.run(["cargo", "build", "--quiet", "--package", "sidc-cli"], cwd=ROOT, check=True)
        built = [ROOT / "target/debug/sidc"]
    return Path(given) if given else max(built, key=lambda path: path.stat().st_mtime)


@pytest.fixture
def decay() -> dict[str, np.ndarray]:
    """dx = -0.5 x, without noise."""
    t = np.arange(60) * 0.1
    return {"t": t, "x": 2.0 * np.exp(-0.5 * t)}


@pytest.fixture(scope="session")
def lorenz() -> tuple[np.ndarray, np.ndarray]:
    """Times and states of the Lorenz system, (M,) and (M, 3)."""
    from scipy.integrate import solve_ivp

    t = np.arange(2000) * 0.005
    solution = solve_ivp(lorenz_rates, (t[0], t[-1]), [-8.0, 8.0, 27.0], t_eval=t, rtol=1e-10, atol=1e-10)
    return t, solution.y.T


def lorenz_rates(t: float, state: np.ndarray) -> list[float]:
    x, y, z = state
    return [10 * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z]


def csv(path: Path) -> dict[str, np.ndarray]:
    """A table of the gallery."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    cells = [[float(cell) if cell.strip() else np.nan for cell in line.split(",")] for line in lines[1:]]
    return dict(zip([name.strip() for name in lines[0].split(",")], np.array(cells).T))
