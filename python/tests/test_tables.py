"""All kinds of tables give the same data."""

from __future__ import annotations

import datetime
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from scipy.integrate import solve_ivp

import sidc
from sidc import _tables

MODEL = "state x\ndx ~ poly(x; 2)\n"


class OnlyStream:
    """A table that offers only the Arrow C stream."""

    def __init__(self, table: Any) -> None:
        self._table = table

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self._table.__arrow_c_stream__(requested_schema)


class OnlyInterchange:
    """A table that offers only the interchange protocol."""

    def __init__(self, table: Any) -> None:
        self._table = table

    def __dataframe__(self, nan_as_null: bool = False, allow_copy: bool = True) -> Any:
        return self._table.__dataframe__(nan_as_null, allow_copy)


class NotYetComputed:
    """Like a Dask collection: `compute` gives its table."""

    columns = ["t", "x"]

    def __init__(self, table: Any) -> None:
        self._table = table

    def compute(self) -> Any:
        return self._table


TABLES = {
    "dict of lists": lambda d: {name: list(values) for name, values in d.items()},
    "structured array": lambda d: np.rec.fromarrays(list(d.values()), names=list(d)),
    "pandas": pd.DataFrame,
    "pandas, time as index": lambda d: pd.DataFrame(d).set_index("t"),
    "pandas, nullable": lambda d: pd.DataFrame(d).convert_dtypes(),
    "pandas on arrow": lambda d: pd.DataFrame(d).convert_dtypes(dtype_backend="pyarrow"),
    "polars": pl.DataFrame,
    "polars, lazy": lambda d: pl.DataFrame(d).lazy(),
    "pyarrow": pa.table,
    "pyarrow, in chunks": lambda d: pa.concat_tables([pa.table(d).slice(0, 20), pa.table(d).slice(20)]),
    "record batch": lambda d: pa.table(d).to_batches()[0],
    "arrow stream": lambda d: OnlyStream(pa.table(d)),
    "interchange": lambda d: OnlyInterchange(pa.table(d)),
    "dask": lambda d: NotYetComputed(pd.DataFrame(d)),
    "views": lambda d: {name: np.repeat(values, 2)[::2] for name, values in d.items()},
}


@pytest.mark.parametrize("make", TABLES.values(), ids=list(TABLES))
def test_every_kind_of_table_is_read(make: Any, decay: dict[str, np.ndarray]) -> None:
    expected = sidc.Model(MODEL).identify(decay).to_json()
    assert sidc.Model(MODEL).identify(make(decay)).to_json() == expected


def test_float64_is_not_copied_on_the_way(decay: dict[str, np.ndarray]) -> None:
    sources = [(decay, decay.get)]
    sources += [(table, lambda name, of=table: of[name].to_numpy()) for table in (pa.table(decay), pl.DataFrame(decay))]
    for table, source in sources:
        found, others = _tables.columns(table)
        assert others == []
        for name, values in found:
            assert np.shares_memory(values, source(name))
            np.testing.assert_array_equal(values, decay[name])


def test_dates_count_in_seconds_from_the_first(decay: dict[str, np.ndarray]) -> None:
    start = pd.Timestamp("2024-02-29 23:59:58.5")
    naive = pd.DatetimeIndex(start + pd.to_timedelta(decay["t"], unit="s").round("ms"))
    frame = pd.DataFrame({"x": decay["x"]}, index=naive)
    objects = [start.to_pydatetime() + datetime.timedelta(milliseconds=round(1e3 * t)) for t in decay["t"]]
    tables: list[Any] = [
        frame,
        frame.tz_localize("Europe/Berlin"),
        frame.rename_axis("t").reset_index(),
        pl.DataFrame({"t": naive.to_numpy(), "x": decay["x"]}),
        pa.table({"t": naive.to_numpy(), "x": decay["x"]}),
        {"t": np.array(objects, dtype=object), "x": decay["x"]},
        {"t": naive.to_numpy() - naive.to_numpy()[0], "x": decay["x"]},
    ]
    for table in tables:
        numbers = dict(_tables.columns(table)[0])
        np.testing.assert_allclose(numbers["t"], decay["t"], atol=1e-9)
        assert sidc.Model(MODEL).identify(table).passes


def test_missing_values_are_nan() -> None:
    nan = float("nan")
    expected = [1.0, nan, 3.0]
    tables: list[Any] = [
        {"n": [1, None, 3]},
        {"n": np.ma.masked_array([1, 2, 3], mask=[False, True, False])},
        pd.DataFrame({"n": pd.array([1, None, 3], dtype="Int64")}),
        pd.DataFrame({"n": pd.array([1, None, 3], dtype="int32[pyarrow]")}),
        pl.DataFrame({"n": [1, None, 3]}),
        pa.table({"n": [1, None, 3]}),
        pa.table({"n": pa.array([True, None, True])}),
    ]
    for table in tables[:-1]:
        np.testing.assert_array_equal(dict(_tables.columns(table)[0])["n"], expected)
    np.testing.assert_array_equal(dict(_tables.columns(tables[-1])[0])["n"], [1.0, nan, 1.0])


def test_an_index_without_meaning_is_no_time(decay: dict[str, np.ndarray]) -> None:
    frame = pd.DataFrame({"x": decay["x"]})
    assert [name for name, _ in _tables.columns(frame)[0]] == ["x"]
    assert [name for name, _ in _tables.columns(frame[frame.x < 1])[0]] == ["x"]
    named = frame.set_index(pd.Index(decay["t"], name="seconds"))
    assert [name for name, _ in _tables.columns(named)[0]] == ["seconds", "t", "x"]
    # A column named t is the time, whatever the index.
    both = pd.DataFrame(decay, index=decay["t"] + 5.0)
    numbers = dict(_tables.columns(both)[0])
    np.testing.assert_array_equal(numbers["t"], decay["t"])


def test_several_tables_are_runs(decay: dict[str, np.ndarray]) -> None:
    other = {"t": decay["t"][:30], "x": 0.5 * decay["x"][:30]}
    result = sidc.Model(MODEL).identify([decay, pd.DataFrame(other)])
    assert result.document.settings.data == ["run 1", "run 2"]
    simulated = result.simulate([decay, other])
    assert [len(run["t"]) for run in simulated] == [60, 30]
    assert simulated[1].name == "run 2"


def test_what_is_held_out(decay: dict[str, np.ndarray]) -> None:
    model = sidc.Model(MODEL)
    other = {"t": decay["t"], "x": 0.5 * decay["x"]}
    cases = [
        (0.25, ["25%"]),
        ((4.0, None), ["4.."]),
        ([(None, 1.0), (4.0, 5.0)], ["..1", "4..5"]),
        (other, ["run 2"]),
        ([other, 0.5], ["50%", "run 2"]),
    ]
    for holdout, said in cases:
        document = model.identify(decay, holdout=holdout).document
        assert sorted(document.settings.holdout) == sorted(said)
        assert any(run.held_out for run in document.validation.runs)
    # A table that is also among the data is read only once.
    assert model.identify([decay, other], holdout=other).document.settings.data == ["run 1"]
    for wrong in (0, 1.5, -0.1, float("nan")):
        with pytest.raises(ValueError, match="between 0 and 1"):
            model.identify(decay, holdout=wrong)


def test_what_is_no_table_is_refused(decay: dict[str, np.ndarray]) -> None:
    model = sidc.Model(MODEL)
    for wrong in (3.5, np.zeros((4, 2)), None):
        with pytest.raises(TypeError, match="a table is a dict of arrays, a frame"):
            model.identify(wrong)
    with pytest.raises(ValueError, match=r"not the shape \(4, 2\)"):
        model.identify({"x": np.zeros((4, 2))})
    with pytest.raises(sidc.Error, match="the array x has 2 values, but the first array has 60") as raised:
        model.identify({"t": decay["t"], "x": decay["x"][:2]})
    assert raised.value.codes == ["ragged-row"]
    far = np.where(decay["t"] > 1, np.inf, decay["x"])
    with pytest.raises(sidc.Error, match="inf"):
        model.identify({"t": decay["t"], "x": far})
    # As in a file, columns that the model does not read may contain anything.
    assert model.identify({**decay, "spare": far}).passes
    for empty in ({}, {"t": [], "x": []}, pd.DataFrame()):
        with pytest.raises(sidc.Error, match="run 1 has no values"):
            model.identify(empty)


def test_columns_of_words_are_left_out_and_named_in_errors(decay: dict[str, np.ndarray]) -> None:
    model = sidc.Model(MODEL)
    named = {**decay, "operator": ["Ada"] * 60}
    assert model.identify(pd.DataFrame(named)).passes
    words = {"t": decay["t"], "x": ["high"] * 60}
    with pytest.raises(sidc.Error, match="note: the column x of run 1 holds no numbers") as raised:
        model.identify(words)
    assert raised.value.codes == ["missing-signal"]


def test_signals_of_different_rates() -> None:
    def plant(t: float, s: np.ndarray) -> list[float]:
        return [s[1] - 0.1 * s[0], -2 * np.sin(s[0]) - 0.3 * s[1] + 2 * np.interp(t, t_u, u)]

    t_x, t_y, t_u = np.arange(0, 20, 0.02), np.arange(0.007, 20, 0.05), np.arange(0, 20.1, 0.1)
    u = np.sin(1.3 * t_u)
    course = solve_ivp(plant, (0, 20), (1, 0), dense_output=True, rtol=1e-9, atol=1e-9, max_step=0.05).sol
    random = np.random.default_rng(0)
    x = pd.DataFrame({"t": t_x, "x": course(t_x)[0] + 0.005 * random.normal(size=len(t_x))})
    y = pd.DataFrame({"t": t_y, "y": course(t_y)[1] + 0.005 * random.normal(size=len(t_y))})
    table = x.merge(y, on="t", how="outer").merge(pd.DataFrame({"t": t_u, "u": u}), on="t", how="outer").sort_values("t")
    model = sidc.Model("state x, y : noise 0.005\ninput u : linear\ndx ~ poly(x, y; 2)\ndy ~ <sin x, cos x, u> + poly(x, y; 2)\n")
    found = model.identify(table)
    assert found.passes, found
    expected = {"dx": {"x": -0.1, "y": 1}, "dy": {"y": -0.3, "u": 2, "sin(x)": -2}}
    for equation in found.equations:
        assert equation.coefficients == pytest.approx(expected[equation.target], rel=0.02)


def test_arrays_may_start_anywhere(decay: dict[str, np.ndarray]) -> None:
    def shifted(values: np.ndarray) -> np.ndarray:
        return np.frombuffer(b"." + values.tobytes(), np.uint8)[1:].view(np.float64)

    moved = {name: shifted(values) for name, values in decay.items()}
    assert not moved["x"].flags.aligned
    model = sidc.Model("state x\ndx ~ poly(x; 2)\n")
    found = model.identify(moved)
    assert found.to_json() == model.identify(decay).to_json()
    rates = found.function()(0.0, shifted(np.array([2.0])))
    np.testing.assert_allclose(rates, [-1.0], rtol=1e-6)
