"""Identification with the interface of PySINDy and the conventions of scikit-learn."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from . import _sidc, _tables
from ._model import Model
from ._result import Result

if TYPE_CHECKING:
    from numpy import float64
    from numpy.typing import ArrayLike, NDArray

_NAME = re.compile(r"(?<!\w)[^\W\d]\w*(?!\w)(?!\s*\()")


class Identifier:
    """First-order equations dx/dt = f(x, u) for a measured state, in the manner of `pysindy.SINDy`.

    Args:
        library: the candidate terms of every equation, in the language of models; by default polynomials of degree 2.
        feature_names: names of the columns of X; by default those of a frame, else the names in `library` in order of appearance,
            else x0, x1, …
        input_names: names of the columns of u; by default the remaining names in `library`, else u0, u1, …
        noise: standard deviation of the measurements by name, as for `Model.identify`; a number applies to all columns.
        method: as for `Model.identify`.
        discrete_time: the equations give the next sample instead of the derivative.
        t_default: the time between samples if `fit` gets no times.

    After `fit`, `result_` is the `Result` with all evidence, and `model_` the model that was used.
    """

    _estimator_type = "regressor"

    result_: Result
    model_: Model

    def __init__(
        self,
        library: str | None = None,
        *,
        feature_names: Sequence[str] | None = None,
        input_names: Sequence[str] | None = None,
        noise: float | Mapping[str, float] | None = None,
        method: str = "auto",
        discrete_time: bool = False,
        t_default: float = 1.0,
    ) -> None:
        self.library = library
        self.feature_names = feature_names
        self.input_names = input_names
        self.noise = noise
        self.method = method
        self.discrete_time = discrete_time
        self.t_default = t_default

    def fit(self, X: Any, y: Any = None, *, t: Any = None, u: Any = None, x_dot: Any = None) -> Identifier:
        """Finds the equations.

        Args:
            X: measurements (M, n), or a list of such arrays, one for each trajectory.
            t: the time between samples, their times (M,), or a list of these. As in PySINDy, they may be the second argument; but as in
                scikit-learn, a single column with as many values as a single state has is its derivative there.
            u: inputs (M, m), or a list of them.
            x_dot, y: measured derivatives (M, n), or a list of them.
        """
        t, x_dot = _times_or_rates(X, y, t, x_dot)
        trials = list(_trials(X, t, u, x_dot, self.t_default))
        states, inputs = self._names(X, trials[0])
        tables = [trial.table(states, inputs, self.discrete_time) for trial in trials]
        self.model_ = Model(_model_text(self.library, states, inputs, self.discrete_time))
        noise = self.noise if self.noise is None or isinstance(self.noise, Mapping) else dict.fromkeys(states, float(self.noise))
        self.result_ = self.model_.identify(tables, noise=noise, method=self.method)
        self.columns_ = _columns_of(X)
        self.feature_names_in_ = states
        self.input_names_in_ = inputs
        self.n_features_in_ = len(states)
        return self

    def predict(self, X: Any, u: Any = None, *, t: Any = None) -> Any:
        """The derivatives, or in discrete time the next samples, at each row: (M, n). A list gives a list."""
        self._check_columns(X)
        rates = self._rates(list(_trials(X, t, u, None, self.t_default)))
        return rates if _are_several(X) else rates[0]

    def simulate(self, x0: ArrayLike, t: Any, u: ArrayLike | Callable[[float], Any] | None = None) -> NDArray[float64]:
        """The states (T, n) from `x0` on at the times `t`, or in discrete time for this many samples; NaN after a run has ended.

        `u` has a row for each time, or is a function of time.
        """
        import numpy as np

        self._check_fitted()
        if np.ndim(t) == 0 and not self.discrete_time:
            raise ValueError("t is an array of times; a number of samples serves discrete time alone")
        times = np.arange(int(t), dtype=np.float64) if np.ndim(t) == 0 else np.asarray(t, dtype=np.float64)
        table = {_tables.TIME: times}
        if u is not None:
            each = np.array([u(time) for time in times]) if callable(u) else np.asarray(u, dtype=np.float64)
            table.update(zip(self.input_names_in_, _tables.matrix(each).T))
        start = dict(zip(self.feature_names_in_, np.ravel(np.asarray(x0, dtype=np.float64))))
        run = self.result_.simulate(table, start=start)
        states = np.full((len(times), self.n_features_in_), np.nan)
        for place, name in enumerate(self.feature_names_in_):
            states[: len(run[name]), place] = run[name]
        return states

    def score(self, X: Any, y: Any = None, *, t: Any = None, u: Any = None, x_dot: Any = None) -> float:
        """R² of the derivatives that the equations give at the rows of X, averaged over the states.

        They are compared with `x_dot` (or `y`), else with central differences of X; in discrete time with the next samples.
        """
        import numpy as np

        self._check_columns(X)
        t, x_dot = _times_or_rates(X, y, t, x_dot)
        true, found = [], []
        trials = list(_trials(X, t, u, x_dot, self.t_default))
        for trial, rates in zip(trials, self._rates(trials)):
            if trial.x_dot is not None:
                true.append(trial.x_dot)
            elif self.discrete_time:
                true.append(trial.x[1:])
                rates = rates[:-1]
            else:
                true.append(np.gradient(trial.x, trial.t, axis=0))
            found.append(rates)
        actual, given = np.concatenate(true), np.concatenate(found)
        error = np.sum((actual - given) ** 2, axis=0)
        spread = np.sum((actual - actual.mean(axis=0)) ** 2, axis=0)
        return float(np.mean(1.0 - error / spread))

    def get_feature_names(self) -> list[str]:
        """The candidate terms, in the order of the columns of `coefficients`."""
        self._check_fitted()
        terms = (self.model_.terms(target) for target in self.model_.targets)
        return list(dict.fromkeys(term for own in terms for term in own))

    def coefficients(self) -> NDArray[float64]:
        """The coefficient of each candidate term in each equation: (n, terms)."""
        import numpy as np

        columns = {term: place for place, term in enumerate(self.get_feature_names())}
        matrix = np.zeros((self.n_features_in_, len(columns)))
        rows = {target: place for place, target in enumerate(self.model_.targets)}
        for equation in self.result_.equations:
            for term, value in equation.coefficients.items():
                matrix[rows[equation.target], columns[term]] = value
        return matrix

    def equations(self, precision: int = 3) -> list[str]:
        """The right side of each equation as text."""
        self._check_fitted()
        found = {e.target: e for e in self.result_.equations}
        sides = []
        for target in self.model_.targets:
            terms = found[target].terms if target in found else []
            each = [f"{term.coefficient:.{precision}f} {term.term}" for term in terms]
            sides.append(" + ".join(each) or f"{0:.{precision}f}")
        return sides

    def print(self, precision: int = 3) -> None:
        """Prints the equations as PySINDy does."""
        sides = self.equations(precision)
        for name, side in zip(self.feature_names_in_, sides):
            print(f"({name})[k+1] = {side}" if self.discrete_time else f"({name})' = {side}")

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """The arguments of the constructor."""
        return {name: getattr(self, name) for name in _defaults(type(self))}

    def set_params(self, **params: Any) -> Identifier:
        """Sets arguments of the constructor."""
        known = self.get_params()
        for name, value in params.items():
            if name not in known:
                raise ValueError(f"Identifier has no parameter {name}; it has {', '.join(known)}")
            setattr(self, name, value)
        return self

    def __sklearn_is_fitted__(self) -> bool:
        return hasattr(self, "result_")

    def __sklearn_tags__(self) -> Any:
        from sklearn.utils import InputTags, RegressorTags, Tags, TargetTags

        target = TargetTags(required=False, multi_output=True)
        # NaN marks a missing reading.
        given = InputTags(allow_nan=True)
        return Tags(estimator_type="regressor", target_tags=target, regressor_tags=RegressorTags(), input_tags=given)

    def __repr__(self) -> str:
        defaults = _defaults(type(self))
        given = ((name, value) for name, value in self.get_params().items() if value != defaults[name])
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in given)})"

    def _repr_html_(self) -> str | None:
        return self.result_._repr_html_() if self.__sklearn_is_fitted__() else None

    def _check_fitted(self) -> None:
        if not self.__sklearn_is_fitted__():
            raise _not_fitted()("this Identifier is not fitted yet: call fit first")

    def _check_columns(self, X: Any) -> None:
        """Checks that a frame has the fitted columns in the same order, since columns are taken by position."""
        self._check_fitted()
        columns = _columns_of(X)
        if columns and self.columns_ and columns != self.columns_:
            raise ValueError(f"X has the columns {', '.join(columns)}, and was fitted with {', '.join(self.columns_)}")
        for x in X if _are_several(X) else [X]:
            features = _tables.matrix(x).shape[1]
            if features != self.n_features_in_:
                kind = type(self).__name__
                # scikit-learn's wording, which programs look for.
                text = f"X has {features} features, but {kind} is expecting {self.n_features_in_} features as input"
                raise ValueError(f"{text}. Reshape your data: rows are samples, columns are states")

    def _rates(self, trials: Sequence[_Trial]) -> list[NDArray[float64]]:
        """The values that the equations give at each row of each trajectory."""
        self._check_fitted()
        if self.result_.failed:
            missing = ", ".join(entry["target"] for entry in self.result_.failed)
            raise ValueError(f"no equation was found for {missing}; result_.failed says why")
        function = self.result_.function()
        # Only the columns of u that the equations mention.
        given = [self.input_names_in_.index(name) for name in function.inputs]
        inputs = (trial.u.T[given] if given and trial.u is not None else None for trial in trials)
        return [function(trial.t, trial.x.T, u).T for trial, u in zip(trials, inputs)]

    def _names(self, X: Any, trial: _Trial) -> tuple[list[str], list[str]]:
        """Names of the columns of X and of u."""
        n, m = trial.x.shape[1], 0 if trial.u is None else trial.u.shape[1]
        columns = _columns_of(X) or []
        written = [name for name in _names_in(self.library or "") if name not in columns]
        given, named = (None if names is None else [str(name) for name in names] for names in (self.feature_names, self.input_names))
        states = given or columns or written[:n] or [f"x{k}" for k in range(n)]
        others = [name for name in written if name not in states]
        inputs = list(named or others[:m] or [f"u{k}" for k in range(m)])
        for names, count, what, option in ((states, n, "X", "feature_names"), (inputs, m, "u", "input_names")):
            if len(names) != count:
                raise ValueError(f"{what} has {count} columns, and their names would be {', '.join(names)}: give {option}")
        return states, inputs


def _defaults(kind: type[Identifier]) -> dict[str, Any]:
    """The arguments of the constructor with their defaults."""
    # Loaded here, because it is half of the import time of the package.
    import inspect

    parameters = inspect.signature(kind).parameters
    return {name: parameter.default for name, parameter in parameters.items()}


def _not_fitted() -> type[Exception]:
    """scikit-learn's own exception, if it is installed."""
    try:
        from sklearn.exceptions import NotFittedError
    except ImportError:
        return AttributeError
    kind: type[Exception] = NotFittedError
    return kind


class _Trial:
    """One trajectory."""

    def __init__(self, x: Any, t: Any, u: Any, x_dot: Any, t_default: float) -> None:
        import numpy as np

        self.x = _tables.matrix(x)
        if 0 in self.x.shape:
            what = "feature(s)" if len(self.x) else "sample(s)"
            raise ValueError(f"Found array with 0 {what} (shape={self.x.shape}) while a minimum of 1 is required.")
        given = _tables.index_times(x) if t is None else t
        if given is None or np.ndim(given) == 0:
            step = t_default if given is None else float(given)
            given = step * np.arange(len(self.x))
        self.t: NDArray[float64] = _tables.times(given)
        self.u = None if u is None else _tables.matrix(u)
        self.x_dot = None if x_dot is None else _tables.matrix(x_dot)
        for values, name in ((self.t, "t"), (self.u, "u"), (self.x_dot, "x_dot")):
            if values is not None and len(values) != len(self.x):
                raise ValueError(f"{name} has {len(values)} rows, and X has {len(self.x)}")
        if self.x_dot is not None and self.x_dot.shape != self.x.shape:
            raise ValueError(f"x_dot has the shape {self.x_dot.shape}, and X has {self.x.shape}")

    def table(self, states: list[str], inputs: list[str], discrete: bool) -> dict[str, NDArray[float64]]:
        table = {} if discrete else {_tables.TIME: self.t}
        table.update(zip(states, self.x.T))
        if self.u is not None:
            table.update(zip(inputs, self.u.T))
        if self.x_dot is not None:
            table.update((f"d{name}", rate) for name, rate in zip(states, self.x_dot.T))
        return table


def _trials(X: Any, t: Any, u: Any, x_dot: Any, t_default: float) -> Iterator[_Trial]:
    if not _are_several(X):
        yield _Trial(X, t, u, x_dot, t_default)
        return
    # A single t applies to all trajectories.
    times = t if isinstance(t, (list, tuple)) else [t] * len(X)
    others = [values if values is not None else [None] * len(X) for values in (u, x_dot)]
    for name, values in (("t", times), ("u", others[0]), ("x_dot", others[1])):
        if len(values) != len(X):
            raise ValueError(f"{name} has {len(values)} trajectories, and X has {len(X)}")
    for x, one_t, one_u, one_dot in zip(X, times, *others):
        yield _Trial(x, one_t, one_u, one_dot, t_default)


def _model_text(library: str | None, states: list[str], inputs: list[str], discrete: bool) -> str:
    """A model of first-order equations with a common library."""
    targets = ", ".join(f"next {name}" if discrete else f"d{name}" for name in states)
    lines = [f"state {', '.join(states)}"]
    lines += [f"input {', '.join(inputs)}"] if inputs else []
    every = ", ".join(states + inputs)
    lines.append(f"{targets} ~ {library or f'poly({every}; 2)'}")
    return "\n".join(lines) + "\n"


def _names_in(library: str) -> list[str]:
    """Names of signals in a library, in order of appearance."""
    words = {*_sidc.Model.vocabulary(), "pi", _tables.TIME}
    return list(dict.fromkeys(name for name in _NAME.findall(library) if name not in words))


def _times_or_rates(X: Any, y: Any, t: Any, x_dot: Any) -> tuple[Any, Any]:
    """Separates times and derivatives: the second argument is times in PySINDy and targets in scikit-learn."""
    import numpy as np

    if y is None:
        return t, x_dot
    several = _are_several(X)
    first, rows = (X[0], y[0]) if several and not _is_number(y) else (X, y)
    if t is None and (_is_number(rows) or (np.ndim(rows) == 1 and _tables.matrix(first).shape[1] > 1)):
        return y, x_dot
    return t, y if x_dot is None else x_dot


def _is_number(value: Any) -> bool:
    import numpy as np

    return np.ndim(value) == 0


def _are_several(X: Any) -> bool:
    """Whether X is a list of trajectories; a list of lists of numbers is one trajectory, given by rows."""
    import numpy as np

    return isinstance(X, (list, tuple)) and len(X) > 0 and (hasattr(X[0], "shape") or np.ndim(X[0]) > 1)


def _columns_of(X: Any) -> list[str] | None:
    """The columns of a frame, or of the first of several frames."""
    first = X[0] if _are_several(X) else X
    return [str(name) for name in first.columns] if hasattr(first, "columns") else None
