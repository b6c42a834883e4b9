"""Types: the package passes mypy's strict checks, and the stubs match the compiled module."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from conftest import ROOT

import sidc


def run(*arguments: str, folder: Path) -> None:
    cache = {"MYPY_CACHE_DIR": str(ROOT / "target/mypy")}
    command = [sys.executable, "-m", *arguments]
    done = subprocess.run(command, cwd=folder, env={**os.environ, **cache}, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_typed(root: Path) -> None:
    assert (Path(sidc.__file__).parent / "py.typed").exists()
    run("mypy", "sidc", folder=root / "python")


def test_stubs_are_true(root: Path) -> None:
    config = str(root / "python/pyproject.toml")
    run("mypy.stubtest", "--mypy-config-file", config, "sidc._sidc", folder=root / "python/tests")
