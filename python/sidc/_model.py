"""Models of systems, and the search for their equations."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _sidc
from ._data import Measured
from ._options import LOOK_AT, PROOFS, Noise, Span, search_options
from ._progress import Progress, over_parts
from ._result import Result

if TYPE_CHECKING:
    from ._parts import Gathered, Reducer


class Model:
    """A checked model: variables, equations to find, libraries of candidate terms (docs/language.md).

    Raises `Error` with every fault of the text. `name` stands for the text in messages and in the result document; `read` gives the text
    of an included file by its path.
    """

    def __init__(self, text: str, name: str = "model.sid", *, read: Callable[[str], str] | None = None) -> None:
        self._native = _sidc.Model(text, name, read)
        self._name = name

    @property
    def text(self) -> str:
        """The model as it was written, with included files inlined."""
        return self._native.text()

    @property
    def targets(self) -> list[str]:
        """The derivatives, next values and outputs that have an equation, in the model's order."""
        return self._native.targets()

    def candidates(self, target: str) -> int | None:
        """The number of candidate terms of an equation; None if that equation is not searched for."""
        return self._native.candidates(target)

    def terms(self, target: str) -> list[str]:
        """The candidate terms of an equation. There may be millions: see `candidates`."""
        return self._native.candidate_terms(target) or []

    def with_terms(self, libraries: Mapping[str, Sequence[str]]) -> Model:
        """The model with the libraries of the given targets replaced by these terms, spelled as they are printed."""
        return Model(self._native.with_terms([(target, list(terms)) for target, terms in libraries.items()]), self._name)

    @property
    def warnings(self) -> str:
        """The warnings about the model, as the program prints them."""
        return self._native.warnings()

    def identify(
        self,
        data: Any,
        *,
        holdout: Any = None,
        noise: Mapping[str, Noise] | None = None,
        params: Mapping[str, float | Sequence[float]] | None = None,
        window: Span | None = None,
        horizon: float | None = None,
        good: float | Mapping[str, float] | None = None,
        method: str = "auto",
        solver: str | None = None,
        samples: int | None = None,
        seed: int = 0,
        robust: bool = False,
        path: bool = False,
        prove_sparsest: bool | float = False,
        verify: bool = False,
        memory_limit: int | None = None,
        time_limit: float | None = None,
        progress: bool | None = None,
    ) -> Result:
        """Finds the equations.

        `data` is a table, or a list of tables for several runs: a dict of arrays of equal length, a pandas, polars, pyarrow or dask frame,
        or anything with the Arrow C stream. Columns have the names that the model reads; NaN marks a missing value. Times are in seconds:
        a column, a numeric index, or dates, which count in seconds from the first.

        The options are those of `sidc identify`:

        Args:
            holdout: held-out rows, on which the equations found from the others are run: the last part of every record (0.25), times (a, b)
                with None for an open end, a separate table, or a list of these.
            noise: standard deviation of a signal's measurement in the model's units, by name; a pair (floor, share) for noise that grows
                with the signal.
            params: values of the parameters that the model declares: one for all runs, or one per run.
            window: the range of times (a, b) to use.
            horizon: how far ahead predictions are compared with the data, in seconds (samples in discrete time).
            good: the error within which 90 % of these predictions must stay, as a fraction of each signal's spread, or by name in the
                signal's unit.
            method: `auto`, `joint` (trajectory and equations together), `regression` (of derivatives) or `weak` (of integrals).
            solver: the sparse solver.
            samples, seed: use this many random rows; the others test the result.
            robust: rejects outliers.
            path: adds the answers for larger tolerances.
            prove_sparsest: searches for the fewest terms that fit, with a proof, for this many seconds in total (True: 60).
            verify: checks every equation and its certificate again, by independent code in 106-bit arithmetic.
            memory_limit: largest number of bytes that the values of one library may take.
            time_limit: seconds after which the search ends with what it has, and a doubt that says so.
            progress: a tqdm bar; by default shown at a terminal or in a notebook, after a second.

        Raises `Error` for data that the model cannot read, with all faults, and for options that name something unknown.
        An equation with doubts is returned too: see `Result.passes`.
        """
        options = search_options(
            noise=noise, window=window, horizon=horizon, good=good, method=method, solver=solver, samples=samples, seed=seed,
            robust=robust, path=path, prove_sparsest=bool(prove_sparsest), verify=verify, memory_limit=memory_limit,
        )  # fmt: skip
        proofs = PROOFS if prove_sparsest is True else float(prove_sparsest)
        measured = Measured.of(data, params)
        measured.hold_out(options, holdout)
        with Progress(self.targets, progress) as bar, measured.explained():
            found = self._native.identify(measured.native, options, time_limit, proofs, bar.heard)
        return Result(found, measured)

    def identify_parts(
        self,
        parts: Any,
        *,
        look_at: int = LOOK_AT,
        holdout: float | None = None,
        noise: Mapping[str, Noise] | None = None,
        params: Mapping[str, float] | None = None,
        horizon: float | None = None,
        good: float | Mapping[str, float] | None = None,
        time_limit: float | None = None,
        progress: bool | None = None,
    ) -> Result:
        """Finds the equations of a table larger than memory, by regression, in one pass over its parts.

        `parts` is the path of a Parquet file, read by pyarrow, or the parts of the table as a sequence of tables. Terms, doubts,
        predictions and runs come from at most `look_at` rows, in up to 32 stretches of the table; coefficients and standard errors come
        from all rows. If all rows disagree with these rows, that is the doubt `rows-differ`.

        Args:
            holdout: the held-out fraction of these rows, at the end of each stretch.
            time_limit: seconds for the search, after all parts are read.

        The other options are those of `identify`. Derivatives that are not measured are estimated within each part. Hidden states,
        unknown constants, constraints and libraries of more than 400 terms need all rows at once and raise `Error`.
        """
        from ._parts import Parts, gather

        options, reducer = self._reducer(look_at, holdout, noise, params, horizon, good)
        source = Parts.of(parts)
        gathered = gather(reducer, over_parts(source.tables, source.count, progress))
        return self._identify_gathered(gathered, options, params, time_limit, progress)

    def _reducer(
        self,
        look_at: int,
        holdout: float | None,
        noise: Mapping[str, Noise] | None,
        params: Mapping[str, float] | None,
        horizon: float | None,
        good: float | Mapping[str, float] | None,
    ) -> tuple[_sidc.Options, Reducer]:
        # Loaded here, because it is most of the import time of the package.
        from ._parts import Reducer

        reducer = Reducer.of(self.text, self._name, look_at, holdout, noise, params)
        return reducer.options(horizon, good), reducer

    def _identify_gathered(
        self,
        gathered: Gathered,
        options: _sidc.Options,
        params: Mapping[str, float] | None,
        time_limit: float | None,
        progress: bool | None,
    ) -> Result:
        if gathered.reduced is None:
            raise ValueError("no parts: give the path of a Parquet file, or tables one after another")
        measured = gathered.looked_at(options, params)
        with Progress(self.targets, progress) as bar, measured.explained():
            found = self._native.identify_reduced(gathered.reduced, measured.native, options, time_limit, bar.heard)
        return Result(found, measured)

    def __repr__(self) -> str:
        return f"<sidc.Model {self._name}: {', '.join(self.targets)}>"

    def __str__(self) -> str:
        return self.text

    def __reduce__(self) -> tuple[type[Model], tuple[str, str]]:
        return Model, (self.text, self._name)


def read(path: str | os.PathLike[str]) -> Model:
    """The model in a file, with the files that it includes."""
    folder, name = os.path.split(os.fspath(path))

    def beside(file: str) -> str:
        with open(os.path.join(folder, file), encoding="utf-8") as text:
            return text.read()

    return Model(beside(name), name, read=beside)


def new(data: Any) -> Model:
    """A first model for a table, guessed from names and shapes: states with their orders, inputs, a library to start from.

    Comments in its `text` say what was guessed; edit it. Nothing is identified.
    """
    measured = Measured.of(data)
    with measured.explained():
        return Model(measured.native.draft())
