"""Figures with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ._runs import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def measured_against_simulated(runs: Sequence[Run]) -> Figure:
    """A column of axes for each run, a row for each signal that is simulated and measured."""
    import matplotlib.pyplot as plt

    signals = list(dict.fromkeys(score.signal for run in runs for score in run.scores))
    rows, columns = max(len(signals), 1), max(len(runs), 1)
    size = (max(6.4, 4.0 * columns), 1.2 + 1.8 * rows)
    figure, all_axes = plt.subplots(rows, columns, sharex="col", squeeze=False, figsize=size, layout="constrained")
    for run, column in zip(runs, all_axes.T):
        fits = {score.signal: score.fit for score in run.scores}
        for signal, axes in zip(signals, column):
            if signal in run.measured:
                axes.plot(run["t"], run.measured[signal], ".", markersize=3, color="0.6", label="measured")
            axes.plot(run["t"], run[signal], linewidth=1.2, color="C3", label="simulated")
            axes.set_ylabel(signal)
            if signal in fits:
                axes.set_title(f"fit {fits[signal]:.4g} %", fontsize="small", loc="right")
        if len(runs) > 1:
            column[0].set_title(run.name, fontsize="small", loc="left")
        column[-1].set_xlabel("t")
    all_axes[0, 0].legend(fontsize="small")
    if "inline" in plt.get_backend():
        # A notebook cell shows the returned figure, and again any figure that is open.
        plt.close(figure)
    return figure
