"""Unusual tables: masks, dates, reordered frames, parts without rows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

import sidc
import sidc.dask

DECAY = sidc.Model("state x\ndx ~ poly(x; 2)\n")


def decay() -> tuple[Any, Any]:
    t = np.arange(200) * 0.05
    return t, 2 * np.exp(-0.5 * t)


@pytest.mark.parametrize("unit", ["ns", "us", "ms"])
def test_masked_dates_are_dates(unit: str) -> None:
    t, x = decay()
    dates = (np.datetime64("2026-11-25T12:00", unit) + (t * 1e3).astype("timedelta64[ms]")).astype(f"datetime64[{unit}]")
    mask = np.zeros(200, bool)
    mask[50] = True
    (term,) = DECAY.identify({"t": np.ma.masked_array(dates, mask=mask), "x": x}).equations[0].terms
    assert term.term == "x" and abs(term.coefficient + 0.5) < 1e-4


def lorenz_like() -> tuple[Any, Any]:
    """A spiral of two states: da = -0.1 a + b, db = -a."""
    t = np.arange(400) * 0.05
    w = np.sqrt(1 - 0.0025)
    a = np.exp(-0.05 * t) * np.sin(w * t)
    b = np.exp(-0.05 * t) * (w * np.cos(w * t) + 0.05 * np.sin(w * t))
    return t, np.stack([a, b], axis=1)


@pytest.mark.parametrize("times", ["index", "ms", "span", "frame"])
def test_times_of_every_kind_are_seconds(times: str) -> None:
    t, x = lorenz_like()
    stamps = pd.DatetimeIndex(np.datetime64("2026-01-01") + (t * 1e9).round().astype("timedelta64[ns]"))
    given = {"index": stamps, "ms": stamps.values.astype("datetime64[ms]"), "span": (t * 1e3).round().astype("timedelta64[ms]")}
    model = sidc.Identifier("poly(a, b; 2)", feature_names=["a", "b"])
    if times == "frame":
        model.fit(pd.DataFrame(x, columns=["a", "b"], index=stamps))
    else:
        model.fit(x, t=given[times])
    found = dict(zip(model.get_feature_names(), model.coefficients()[0]))
    assert abs(found["a"] + 0.1) < 1e-3 and abs(found["b"] - 1) < 1e-3


def test_masked_rows_are_missing() -> None:
    t, x = lorenz_like()
    spoilt = np.ma.masked_array(x, mask=np.zeros_like(x, bool))
    spoilt[100:103, 0] = 1e6
    spoilt[100:103, 0] = np.ma.masked
    model = sidc.Identifier("poly(a, b; 2)").fit(spoilt, t=t)
    assert abs(dict(zip(model.get_feature_names(), model.coefficients()[0]))["b"] - 1) < 1e-2


def test_columns_in_another_order_are_refused() -> None:
    t, x = lorenz_like()
    frame = pd.DataFrame(x, columns=["a", "b"])
    model = sidc.Identifier("poly(a, b; 2)", noise=np.float32(1e-6), feature_names=frame.columns).fit(frame, t=t)
    assert model.predict(frame).shape == x.shape
    with pytest.raises(ValueError, match="X has the columns b, a, and was fitted with a, b"):
        model.predict(frame[["b", "a"]])


def test_what_is_no_measurement_is_refused() -> None:
    from scipy.sparse import csr_matrix
    from sklearn.exceptions import NotFittedError

    _, x = lorenz_like()
    for call in (lambda model: model.predict(x), lambda model: model.print(), lambda model: model.simulate(x[0], np.arange(3.0))):
        with pytest.raises(NotFittedError, match="call fit first"):
            call(sidc.Identifier())
    with pytest.raises(ValueError, match="Complex data not supported"):
        sidc.Identifier().fit(x + 1j)
    with pytest.raises(TypeError, match="sparse"):
        sidc.Identifier().fit(csr_matrix(x))


def test_parts_without_rows_change_nothing() -> None:
    t, x = decay()
    model = sidc.Model("state x\ndata { dx = none }\ndx ~ poly(x; 2)\n")
    table = pd.DataFrame({"t": t, "x": x})
    parts = [table[:100], table[:0], table[100:]]
    whole = model.identify_parts([table[:100], table[100:]])
    assert model.identify_parts(parts).to_json() == whole.to_json()
    import dask.dataframe as dd

    both = pd.concat([table] * 2, ignore_index=True)
    frame = dd.from_pandas(both.assign(row=np.arange(400)), npartitions=4)
    filtered = frame[frame.row >= 200]
    assert sidc.dask.identify(model, filtered).equations[0].terms[0].term == "x"
    with pytest.raises(ValueError, match="every partition is empty"):
        sidc.dask.identify(model, frame[frame.row < 0])
