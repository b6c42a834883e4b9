"""The module gives the program's document byte for byte, except for what only the program knows."""

from __future__ import annotations

import pickle
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from conftest import csv

import sidc

FILES = re.compile(r'    "files": \[.*?\n    \],\n', re.DOTALL)
"""The names and SHA-256 of the files that were read: arrays have none."""

# Regression and joint estimates, inputs, discrete time, several runs, unknown constants, delays, held-out data.
CASES: list[tuple[str, list[str], dict[str, Any], list[str]]] = [
    ("lorenz", ["lorenz"], {}, []),
    ("duffing", ["duffing"], {"holdout": 0.25}, ["--holdout=25%"]),
    ("pendulum_positions", ["pendulum_positions"], {}, []),
    ("sir", ["sir_a", "sir_b"], {"horizon": 2.0, "good": 0.1}, ["--horizon", "2", "--good", "10%"]),
    ("logistic_map", ["logistic_map"], {}, []),
    ("michaelis_menten_unknown", ["michaelis_menten"], {}, []),
    ("van_der_pol", ["van_der_pol"], {"noise": {"x": (0.0, 0.01)}, "window": (None, 8.0)}, ["--noise", "x=1%", "--window=..8"]),
]


@pytest.mark.parametrize(("model", "data", "options", "arguments"), CASES, ids=[case[0] for case in CASES])
def test_the_document_is_that_of_the_program(
    model: str, data: list[str], options: dict[str, Any], arguments: list[str], root: Path, program: Path, tmp_path: Path
) -> None:
    tables = []
    for place, name in enumerate(data):
        source = root / "models/data" / f"{name}.csv"
        # A record is named after its file; here that is the default name of a table.
        shutil.copy(source, tmp_path / f"run {place + 1}")
        tables.append(csv(source))
    files = [f"run {place + 1}" for place in range(len(data))]
    written = tmp_path / "result.json"
    command = [program, "identify", root / "models" / f"{model}.sid", *files, "-o", written, *arguments]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode in (0, 3), done.stderr
    result = sidc.read(root / "models" / f"{model}.sid").identify(tables, **options)
    expected, removed = FILES.subn("", written.read_text(encoding="utf-8"))
    assert removed == 1
    assert result.to_json() == expected
    # The program prints the same answer, with the rows before it and the next step after it.
    assert str(result) in done.stdout


def test_a_document_of_the_program_is_read(root: Path, program: Path, tmp_path: Path) -> None:
    data = root / "models/data/lorenz.csv"
    written = tmp_path / "result.json"
    subprocess.run([program, "identify", root / "models/lorenz.sid", data, "-o", written], capture_output=True, check=True)
    result = sidc.Result.from_json(written.read_text(encoding="utf-8"))
    assert result.passes
    assert result.to_json() == written.read_text(encoding="utf-8")
    assert result.simulate(csv(data)).scores[0].fit > 99


def test_errors_are_those_of_the_program(program: Path, tmp_path: Path) -> None:
    text = "state theta : order 2\nddtheta ~ poly(dthta; 2)\nddphi ~ poly(theta; 2)\n"
    (tmp_path / "model.sid").write_text(text)
    done = subprocess.run([program, "check", "model.sid"], cwd=tmp_path, capture_output=True, text=True)
    with pytest.raises(sidc.Error) as raised:
        sidc.Model(text)
    assert str(raised.value) in done.stderr
    assert raised.value.kind == "model"
    assert set(raised.value.codes) == {"unknown-signal"}
    assert isinstance(raised.value, ValueError)


def test_names_that_are_not_there_are_refused(decay: dict[str, Any]) -> None:
    model = sidc.Model("state x\ndx ~ poly(x; 2)\n")
    cases = [
        ({"noise": {"y": 0.1}}, "unknown-noise", "measured: x, dx"),
        ({"method": "magic"}, "unknown-method", "there are auto, joint, regression, weak"),
        ({"solver": "magic"}, "unknown-solver", "homotopy"),
        ({"good": {"y": 0.1}}, "unknown-good", "predicted: x"),
    ]
    for options, code, text in cases:
        with pytest.raises(sidc.Error, match=text) as raised:
            model.identify(decay, **options)
        assert raised.value.codes == [code]
    result = model.identify(decay)
    with pytest.raises(sidc.Error, match="there are text, latex") as raised:
        result.export("cobol")
    assert raised.value.codes == ["unknown-target"]
    with pytest.raises(sidc.Error, match="state: x") as raised:
        result.simulate(decay, start={"y": 1.0})
    assert raised.value.codes == ["unknown-start"]


def test_a_draft_is_that_of_the_program(root: Path, program: Path, tmp_path: Path) -> None:
    shutil.copy(root / "models/data/duffing.csv", tmp_path / "run 1")
    done = subprocess.run([program, "new", "run 1"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert sidc.new(csv(root / "models/data/duffing.csv")).text == done.stdout


def test_a_model_is_read_with_the_files_it_includes(tmp_path: Path) -> None:
    (tmp_path / "rigs").mkdir()
    (tmp_path / "rigs" / "rig.sid").write_text("state x\nlet k = 2\n", encoding="utf-8")
    (tmp_path / "m.sid").write_text('include "rigs/rig.sid"\ndx ~ poly(x; k)\n', encoding="utf-8")
    model = sidc.read(tmp_path / "m.sid")
    assert model.terms("dx") == ["1", "x", "x^2"]
    assert pickle.loads(pickle.dumps(model)).terms("dx") == model.terms("dx")
    (tmp_path / "m.sid").write_text('include "rigs/gone.sid"\ndx ~ poly(x; 2)\n', encoding="utf-8")
    with pytest.raises(sidc.Error, match="rigs/gone.sid.*cannot be read"):
        sidc.read(tmp_path / "m.sid")
