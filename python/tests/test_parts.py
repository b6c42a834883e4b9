"""Tables in parts: the result for all rows, from one pass over them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import lorenz_rates
from scipy.integrate import solve_ivp

import sidc
from sidc._parts import Reducer, gather

MODEL = """state x, y, z
dx, dy, dz ~ poly(x, y, z; 2)
"""


@pytest.fixture(scope="session")
def noisy() -> dict[str, np.ndarray]:
    """20,000 rows of the Lorenz system, with measured rates that have errors of 0.01."""
    t = np.arange(20_000) * 0.005
    states = solve_ivp(lorenz_rates, (t[0], t[-1]), [-8.0, 8.0, 27.0], t_eval=t, rtol=1e-9, atol=1e-9).y
    error = 0.01 * np.random.default_rng(3).normal(size=states.shape)
    rates = np.array([lorenz_rates(0.0, state) for state in states.T]).T + error
    return {"t": t} | dict(zip("xyz", states)) | {f"d{name}": rate for name, rate in zip("xyz", rates)}


def cut(table: dict[str, Any], lengths: list[int]) -> Iterator[dict[str, Any]]:
    ends = np.cumsum(lengths)
    return ({name: values[end - n : end] for name, values in table.items()} for n, end in zip(lengths, ends))


def coefficients(result: sidc.Result) -> dict[str, float]:
    return {f"{e.target} {term.term}": term.coefficient for e in result.equations for term in e.terms}


LENGTHS = [5000, 700, 6300, 4000, 3999, 1]


def test_the_coefficients_are_those_of_all_rows_in_memory(noisy: dict[str, np.ndarray]) -> None:
    table = noisy
    model = sidc.Model(MODEL)
    found = model.identify_parts(cut(table, LENGTHS), look_at=8000)
    rows = len(table["t"])
    assert [e.evidence.rows for e in found.equations] == [rows] * 3
    own = coefficients(found)
    in_memory = coefficients(model.identify(table, method="regression"))
    assert own.keys() == in_memory.keys()
    assert list(own) == ["dx x", "dx y", "dy x", "dy y", "dy x*z", "dz z", "dz x*y"]
    for term, value in own.items():
        assert abs(value - in_memory[term]) < 1e-10 * abs(value), term
    # Compared with NumPy's least squares on the rows.
    x, y, z = table["x"], table["y"], table["z"]
    expected = np.linalg.lstsq(np.stack([x, y, x * z], axis=1), table["dy"], rcond=None)[0]
    np.testing.assert_allclose([own["dy x"], own["dy y"], own["dy x*z"]], expected, rtol=1e-10)
    assert found.passes
    backwards = coefficients(model.identify_parts(list(cut(table, LENGTHS))[::-1], look_at=8000))
    np.testing.assert_allclose([backwards[term] for term in own], list(own.values()), rtol=1e-10)


def test_a_file_is_read_in_parts(noisy: dict[str, np.ndarray], tmp_path: Path) -> None:
    table = {name: values[:2000] for name, values in noisy.items()}
    pq.write_table(pa.table(table), tmp_path / "lorenz.parquet", row_group_size=300)
    model = sidc.Model(MODEL)
    assert model.identify_parts(tmp_path / "lorenz.parquet").to_json() == model.identify_parts([table]).to_json()


def test_what_is_looked_at_does_not_grow(noisy: dict[str, np.ndarray]) -> None:
    reducer = Reducer.of(MODEL, "model.sid", 3200, 0.25, None, None)
    for count in (1, 3, 40, 130):
        gathered = gather(reducer, cut(noisy, [20_000 // count] * count))
        looked_at = sum(len(used[0][1]) + len(held[0][1]) for used, held in gathered.stretches if held)
        assert 1600 <= looked_at <= 3200, count


def test_what_is_held_out_is_predicted_and_not_fitted(noisy: dict[str, np.ndarray]) -> None:
    table = noisy
    found = sidc.Model(MODEL).identify_parts(cut(table, [10_000, 10_000]), look_at=32_000, holdout=0.25)
    assert found.verdict is not None and found.verdict.prediction.on == "held-out"
    assert [e.evidence.rows for e in found.equations] == [20_000 - 2 * 2500] * 3


def test_rows_that_nobody_looked_at_are_heard(noisy: dict[str, np.ndarray]) -> None:
    table = dict(noisy)
    weaker = np.arange(len(table["t"])) >= 9000
    table["dx"] = np.where(weaker, 0.9, 1.0) * 10 * (table["y"] - table["x"])
    found = sidc.Model(MODEL).identify_parts([table], look_at=8000)
    assert not found.passes
    doubts = [doubt for doubt in found.doubts if doubt.code == "rows-differ"]
    assert {doubt.target for doubt in doubts} == {"dx"}
    assert any("on the rows looked at closely and" in doubt.text for doubt in doubts)


def test_what_needs_all_rows_at_once_is_said() -> None:
    table = {"t": np.arange(99.0), "x": np.cos(np.arange(99.0))}
    cases = [
        ("state x\nunknown k in 0.1 .. 1\ndx ~ <x, exp(-k*x)>\n", "unknown constants inside terms"),
        ("state x\nstate h : hidden\ndx ~ <x, h>\ndh = x - h\n", "the state h is hidden"),
        ("state x\ndx ~ powers(x; 500)\n", "501 terms; their factor is kept for at most 400"),
        ("state x\ndx ~ <x, x^2>\nconstrain coef(dx, x) < 0\n", "equations under constraints"),
    ]
    for text, why in cases:
        with pytest.raises(sidc.Error, match=why) as refused:
            sidc.Model(text).identify_parts([table])
        assert refused.value.codes == ["not-reducible"], text
    model = sidc.Model("state x\ndx ~ <x, x^2>\n")
    with pytest.raises(ValueError, match="no parts"):
        model.identify_parts([])
    with pytest.raises(TypeError, match="a table in memory is for `identify`"):
        model.identify_parts(table)
    with pytest.raises(ValueError, match="look_at: at least 32 rows, not 3"):
        model.identify_parts([table], look_at=3)
    with pytest.raises(sidc.Error, match="run 1 lacks a column for the state x"):
        model.identify_parts([{"t": np.arange(9.0)}])
