"""Partitions on Dask workers, one of which dies."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import dask
import dask.dataframe as dd
import numpy as np
import pandas as pd
import pytest
from distributed import Client, LocalCluster
from scipy.integrate import solve_ivp
from scipy.stats import chi2
from test_parts import MODEL, coefficients
from test_parts import noisy as noisy

import sidc
import sidc.dask
from sidc._fleet import chi_squared_tail


@pytest.fixture(scope="module")
def client() -> Any:
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    with cluster, Client(cluster) as client:
        yield client


def test_a_frame_gives_the_answer_of_its_parts(client: Any, noisy: dict[str, np.ndarray]) -> None:
    frame = pd.DataFrame(noisy)
    partitions = dd.from_pandas(frame, npartitions=9)
    model = sidc.Model(MODEL)
    found = sidc.dask.identify(model, partitions, look_at=20_000)
    parts = [partitions.get_partition(k).compute() for k in range(9)]
    expected = model.identify_parts(parts, look_at=20_000)
    own, others = coefficients(found), coefficients(expected)
    assert own.keys() == others.keys() and found.verdict == expected.verdict
    np.testing.assert_allclose(list(own.values()), [others[term] for term in own], rtol=1e-10)
    tested = sidc.dask.identify(model, partitions, look_at=20_000, holdout=0.2)
    assert [e.evidence.rows for e in tested.equations] == [20_000 - 9 * 444] * 3
    assert tested.verdict is not None and tested.verdict.prediction.on == "held-out"


@dask.delayed
def dies_once(table: pd.DataFrame, left: Path) -> pd.DataFrame:
    """A partition that kills the first worker that gets it."""
    if not left.exists():
        left.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return table


def test_a_killed_worker_is_replaced(client: Any, noisy: dict[str, np.ndarray], tmp_path: Path) -> None:
    frame = pd.DataFrame(noisy)
    thirds = [frame.iloc[k::3].sort_index() for k in range(3)]
    whole = [dask.delayed(part) for part in thirds]
    deadly = [whole[0], dies_once(whole[1], tmp_path / "left"), whole[2]]
    model = sidc.Model(MODEL)
    found = sidc.dask.identify(model, deadly)
    assert (tmp_path / "left").exists()
    assert found.to_json() == sidc.dask.identify(model, whole).to_json()


def test_faults_of_a_partition_are_those_of_the_table(client: Any) -> None:
    partitions = dd.from_pandas(pd.DataFrame({"t": np.arange(99.0)}), npartitions=2)
    with pytest.raises(sidc.Error, match="run 1 lacks a column"):
        sidc.dask.identify(sidc.Model(MODEL), partitions)
    with pytest.raises(ValueError, match="no partitions"):
        sidc.dask.identify(sidc.Model(MODEL), [])


def swing(length: float, seed: int) -> dict[str, np.ndarray]:
    """A pendulum of this length with friction, with its angle read to 5 mrad."""
    t = np.arange(0, 8, 0.02)
    start = 1.5 + 0.1 * (seed % 5)
    motion = solve_ivp(lambda _, s: (s[1], -9.81 / length * np.sin(s[0]) - 0.2 * s[1]), (0, 8), (start, 0), t_eval=t, rtol=1e-9, atol=1e-9)
    return {"t": t, "x": motion.y[0] + 0.005 * np.random.default_rng(seed).normal(size=len(t))}


PENDULUM = "state x : order 2, noise 0.005\nddx ~ <sin x, cos x> + poly(x, dx; 2)\n"


def test_one_law_for_a_fleet(client: Any) -> None:
    fleet = sidc.dask.identify_fleet(sidc.Model(PENDULUM), [swing(1.0, seed) for seed in range(12)], group=4)
    assert fleet.passes, str(fleet)
    values = {term.term: term for term in fleet.terms}
    assert values.keys() == {"sin(x)", "dx"}
    for name, truth in (("sin(x)", -9.81), ("dx", -0.2)):
        assert abs(values[name].coefficient - truth) < 4 * values[name].standard_error < 0.01 * abs(truth)
        assert values[name].groups == 3 and values[name].p > 1e-3
    assert fleet.model.text.endswith("ddx ~ <dx, sin(x)>\n")
    # Simulation and export use the pooled coefficients.
    assert fleet.result.equations[0].coefficients == {name: term.coefficient for name, term in values.items()}
    assert str(fleet).startswith("ddx = -0.")


def test_a_fleet_of_two_kinds_is_no_fleet(client: Any) -> None:
    records = [swing(1.0 if seed < 4 else 1.1, seed) for seed in range(8)]
    fleet = sidc.dask.identify_fleet(sidc.Model(PENDULUM), records, group=4)
    assert not fleet.passes
    assert [term.term for term in fleet.differing] == ["sin(x)"]
    assert "sin(x) of ddx differs between the groups" in str(fleet)


def test_a_law_for_each_record(client: Any, tmp_path: Path) -> None:
    pd.DataFrame(swing(2.0, 1)).to_parquet(tmp_path / "long.parquet")
    records = [swing(1.0, 0), tmp_path / "long.parquet", {"t": np.arange(9.0)}]
    short, long, none = sidc.dask.identify_each(sidc.Model(PENDULUM), records)
    assert isinstance(short, sidc.Result) and isinstance(long, sidc.Result)
    assert short.equations[0].coefficients["sin(x)"] == pytest.approx(-9.81, rel=0.01)
    assert long.equations[0].coefficients["sin(x)"] == pytest.approx(-4.905, rel=0.01)
    assert isinstance(none, sidc.Error) and "run 1 lacks a column for the state x" in str(none)
    with pytest.raises(ValueError, match="no group of records has an answer"):
        sidc.dask.identify_fleet(sidc.Model(PENDULUM), [records[2]])


def test_the_tail_of_chi_squared() -> None:
    for free in (1, 2, 7, 120):
        for q in (0.1, 1.0, 10.0, 130.0):
            assert chi_squared_tail(q, free) == pytest.approx(chi2.sf(q, free), rel=0.2, abs=2e-3)
