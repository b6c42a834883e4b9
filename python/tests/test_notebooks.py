"""The notebooks run, and those in the checkout are the ones that `make.py` writes."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import nbformat
import pytest


def maker(root: Path) -> Any:
    spec = importlib.util.spec_from_file_location("make", root / "python/examples/make.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["ten_minutes", "pendulum", "pysindy_tour", "fleet"])
def test_notebooks_run_and_are_kept(name: str, root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The notebook kernel chooses its own backend.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    folder = root / "python/examples"
    made = maker(root).run(name, folder)
    kept = nbformat.read(folder / f"{name}.ipynb", as_version=4)
    assert [cell.source for cell in kept.cells] == [cell.source for cell in made.cells]
    for cell in made.cells:
        kinds = {kind for output in cell.get("outputs", []) for kind in output.get("data", {})}
        if cell.source.endswith("\nresult"):
            assert {"text/html", "text/latex"} <= kinds
        if cell.source == "result.plot()":
            assert "image/png" in kinds
