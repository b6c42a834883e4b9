"""Files as tables: what other packages write is read to the last digit, by the module and by the program."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet as pq
import pytest
import scipy.io
from conftest import csv

import sidc

FILES = re.compile(r'    "files": \[.*?\n    \],\n', re.DOTALL)
"""The names and SHA-256 of the files that were read: arrays have none."""


@pytest.fixture
def lorenz(root: Path) -> dict[str, Any]:
    return {name: np.asarray(values) for name, values in csv(root / "models/data/lorenz.csv").items()}


def npz(path: Path, table: dict[str, Any]) -> None:
    np.savez_compressed(path, **table)


def mat(path: Path, table: dict[str, Any]) -> None:
    scipy.io.savemat(path, {"rig": table, "Ts": 0.01}, do_compression=True)


def parquet(path: Path, table: dict[str, Any]) -> None:
    pq.write_table(pa.table(table), path, row_group_size=300)


def of_polars(path: Path, table: dict[str, Any]) -> None:
    pl.DataFrame(table).write_parquet(path)


def of_pandas(path: Path, table: dict[str, Any]) -> None:
    pd.DataFrame(table).to_parquet(path, compression="gzip")


def text(path: Path, table: dict[str, Any]) -> None:
    pd.DataFrame(table).to_csv(path, index=False, sep=";", decimal=",")


def feather(path: Path, table: dict[str, Any]) -> None:
    pyarrow.feather.write_feather(pa.table(table), path)


def arrow_of_polars(path: Path, table: dict[str, Any]) -> None:
    pl.DataFrame(table).write_ipc(path, compression="zstd")


def mat73(open_file: Any, table: dict[str, Any]) -> None:
    """Like MATLAB's `save -v7.3`: HDF5 after a block of 512 bytes, with rows and columns exchanged."""
    path = open_file.name
    with h5py.File(path, "w", userblock_size=512) as file:
        rig = file.create_group("rig")
        rig.attrs["MATLAB_class"] = np.bytes_("struct")
        for name, values in table.items():
            field = rig.create_dataset(name, data=np.asarray(values)[None, :])
            field.attrs["MATLAB_class"] = np.bytes_("double")
        note = file.create_dataset("note", data=np.frombuffer("a rig".encode("utf-16-le"), np.uint16)[:, None])
        note.attrs["MATLAB_class"] = np.bytes_("char")
        file.create_dataset("Ts", data=[[0.01]]).attrs["MATLAB_class"] = np.bytes_("double")
        file.create_group("#refs#")
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


WRITERS = [mat73, feather, arrow_of_polars, npz, mat, parquet, of_polars, of_pandas, text]


@pytest.mark.parametrize("write", WRITERS, ids=[write.__name__ for write in WRITERS])
def test_a_file_is_the_table_that_was_written(write: Any, lorenz: dict[str, Any], root: Path, tmp_path: Path) -> None:
    # A record is named after its file; this file has the default name of a table.
    path = tmp_path / "run 1"
    with open(path, "wb") as file:
        write(file, lorenz)
    model = sidc.read(root / "models/lorenz.sid")
    from_file = model.identify(path).to_json()
    assert '"name": "run 1"' in from_file
    assert FILES.sub("", from_file) == model.identify(lorenz).to_json()


@pytest.mark.parametrize("write", [mat73, npz, mat, feather, arrow_of_polars])
def test_the_program_reads_it_too(write: Any, lorenz: dict[str, Any], root: Path, program: Path, tmp_path: Path) -> None:
    with open(tmp_path / "rig", "wb") as file:
        write(file, lorenz)
    command = [program, "identify", root / "models/lorenz.sid", "rig", "-o", "result.json"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert ("not read as columns: Ts (one number, 0.01)" in done.stderr) == (write in (mat, mat73))
    result = sidc.read(root / "models/lorenz.sid").identify(tmp_path / "rig")
    assert result.to_json() == (tmp_path / "result.json").read_text(encoding="utf-8")
    assert "data, the same here" in str(result.report())


def test_dates_and_runs(tmp_path: Path) -> None:
    k = np.arange(400)
    t = (k % 200) * 0.05
    x = np.exp(-0.5 * t) * np.where(k < 200, 2.0, 3.0)
    start = pd.Timestamp("2026-11-25 12:00", tz="UTC")
    clock = start + pd.to_timedelta(t, unit="s")
    frame = pd.DataFrame({"clock": clock, "well": np.where(k < 200, "A1", "A2"), "x": x})
    frame.to_parquet(tmp_path / "wells.parquet")
    model = sidc.Model('state x\ndata {\n  t = "clock"\n  run = "well"\n}\ndx ~ poly(x; 3)\n')
    result = model.identify(tmp_path / "wells.parquet")
    (term,) = result.equations[0].terms
    assert term.term == "x" and abs(term.coefficient + 0.5) < 1e-4


def test_matrices_of_matlab_are_columns(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "rig.mat", "w") as file:
        file["t"] = np.arange(50.0)[None, :] * 0.1
        file["y"] = np.stack([np.exp(-0.3 * np.arange(50)), np.zeros(50)])
        file["gain"] = np.ones((3, 4))
    result = sidc.Model("state y_1\ndy_1 ~ <y_1>\n").identify(tmp_path / "rig.mat")
    assert abs(result.equations[0].terms[0].coefficient + 3) < 1e-3
    with pytest.raises(sidc.Error, match="not read as columns: gain"):
        sidc.Model("state gain\ndgain ~ <gain>\n").identify(tmp_path / "rig.mat")
    (tmp_path / "cut.mat").write_bytes((tmp_path / "rig.mat").read_bytes()[:3000])
    (tmp_path / "cut.arrow").write_bytes(b"ARROW1" + bytes(40))
    for name in ("cut.mat", "cut.arrow"):
        with pytest.raises(sidc.Error) as refused:
            sidc.Model("state y_1\ndy_1 ~ <y_1>\n").identify(tmp_path / name)
        assert refused.value.codes == ["damaged-file"]


def test_what_a_file_loses_is_a_warning(root: Path, tmp_path: Path) -> None:
    log = (root / "crates/formats/tests/data/pendulum.ulg").read_bytes()
    (tmp_path / "cut.ulg").write_bytes(log[:20_000])
    with pytest.warns(UserWarning, match="cut.ulg: not read as columns: what follows byte 19979, in the middle of a message") as told:
        sidc.new(tmp_path / "cut.ulg")
    assert told[0].filename == __file__


def test_a_file_that_is_none_says_why(tmp_path: Path) -> None:
    model = sidc.Model("state x\ndx ~ poly(x; 2)\n")
    with pytest.raises(FileNotFoundError):
        model.identify(tmp_path / "nowhere.npz")
    np.save(tmp_path / "nameless.npy", np.zeros((5, 2)))
    with pytest.raises(sidc.Error, match="save each signal under its name"):
        model.identify(tmp_path / "nameless.npy")
    np.savez(tmp_path / "x.npz", t=np.arange(9.0), y=np.arange(9.0), x=np.float64(3))
    with pytest.raises(sidc.Error, match=r"not read as columns: x \(one number, 3\)"):
        model.identify(tmp_path / "x.npz")
    pq.write_table(pa.table({"t": np.arange(9.0), "x": np.arange(9.0)}), tmp_path / "packed.parquet", compression="brotli")
    with pytest.raises(sidc.Error, match="packed.parquet is a Parquet file compressed by Brotli, which is not read"):
        model.identify(tmp_path / "packed.parquet")
    whole = tmp_path / "cut.parquet"
    pq.write_table(pa.table({"t": np.arange(99.0), "x": np.arange(99.0)}), whole)
    whole.write_bytes(whole.read_bytes()[:-40])
    with pytest.raises(sidc.Error) as refused:
        model.identify(whole)
    assert refused.value.codes == ["damaged-file"]
