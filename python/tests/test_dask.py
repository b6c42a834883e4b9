"""Partitions on the workers of Dask, one of which dies."""

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
from test_parts import MODEL, coefficients
from test_parts import noisy as noisy

import sidc
import sidc.dask


@pytest.fixture(scope="module")
def client() -> Any:
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    with cluster, Client(cluster) as client:
        yield client


def test_a_frame_gives_the_answer_of_its_parts(client: Any, noisy: dict[str, np.ndarray]) -> None:
    frame = pd.DataFrame(noisy)
    partitions = dd.from_pandas(frame, npartitions=9)
    model = sidc.Model(MODEL)
    found = sidc.dask.identify(model, partitions, look_at=20_000, holdout=0.2)
    parts = [partitions.get_partition(k).compute() for k in range(9)]
    expected = model.identify_parts(parts, look_at=20_000, holdout=0.2)
    own, others = coefficients(found), coefficients(expected)
    assert own.keys() == others.keys() and found.verdict == expected.verdict
    np.testing.assert_allclose(list(own.values()), [others[term] for term in own], rtol=1e-10)
    assert [e.evidence.rows for e in found.equations] == [e.evidence.rows for e in expected.equations]


@dask.delayed
def dies_once(table: pd.DataFrame, left: Path) -> pd.DataFrame:
    """A partition whose first worker is killed while it has it."""
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
