"""`Identifier` uses the array shapes of PySINDy and the conventions of scikit-learn."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pandas as pd
import pytest
from conftest import lorenz_rates
from sklearn.base import clone
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer
from sklearn.utils.estimator_checks import check_estimator

import sidc

Record = tuple[np.ndarray, np.ndarray]


def test_lorenz_as_pysindy_shows_it(lorenz: Record, capsys: pytest.CaptureFixture[str]) -> None:
    t, X = lorenz
    model = sidc.Identifier(library="poly(x, y, z; 2)").fit(X, t=t[1] - t[0])
    model.print()
    assert capsys.readouterr().out.splitlines() == [
        "(x)' = -10.000 x + 10.000 y",
        "(y)' = 28.000 x + -1.000 y + -1.000 x*z",
        "(z)' = -2.667 z + 1.000 x*y",
    ]
    rates = model.predict(X)
    np.testing.assert_allclose(rates, np.transpose(lorenz_rates(0.0, X.T)), rtol=1e-4, atol=1e-3)
    assert model.score(X, t=t) > 0.999
    assert model.coefficients().shape == (3, 10)
    names = model.get_feature_names()
    assert model.coefficients()[1, names.index("x*z")] == pytest.approx(-1, abs=1e-4)
    np.testing.assert_allclose(model.simulate(X[0], t[:200]), X[:200], atol=1e-2)
    assert model.result_.passes


def test_several_trajectories(lorenz: Record) -> None:
    t, X = lorenz
    parts, times = [X[:600], X[900:1500]], [t[:600], t[900:1500]]
    model = sidc.Identifier("poly(x, y, z; 2)").fit(parts, t=times)
    predicted = model.predict(parts)
    assert [rates.shape for rates in predicted] == [(600, 3), (600, 3)]
    assert model.score(parts, t=times) > 0.999
    # The same with a step, and with times in PySINDy's position.
    assert model.fit(parts, t=0.005).score(parts, t=0.005) > 0.999
    assert model.fit(parts, times).score(parts, times) > 0.999
    assert model.fit(X, t).score(X, t) > 0.999
    with pytest.raises(ValueError, match="t has 1 trajectories, and X has 2"):
        model.fit(parts, t=[t])
    with pytest.raises(ValueError, match="t has 2000 rows, and X has 600"):
        model.fit(X[:600], t=t)


def test_inputs_are_named_after_the_states() -> None:
    t = np.arange(800) * 0.01
    u = np.sin(3 * t)
    x = np.zeros(800)
    for k in range(799):
        # dx = -2 x + 5 u by the trapezoidal rule, with steps much smaller than the sampling interval.
        fine = np.linspace(t[k], t[k + 1], 101)
        value = x[k]
        for a, b in zip(fine, fine[1:]):
            value = (value * (1 - (b - a)) + 5 * (b - a) / 2 * (np.sin(3 * a) + np.sin(3 * b))) / (1 + (b - a))
        x[k + 1] = value
    model = sidc.Identifier("poly(level, valve; 2)").fit(x[:, None], t=0.01, u=u)
    assert (model.feature_names_in_, model.input_names_in_) == (["level"], ["valve"])
    assert model.result_.equations[0].coefficients == pytest.approx({"level": -2, "valve": 5}, rel=1e-3)
    assert model.predict([[1.0]], u=[[1.0]])[0, 0] == pytest.approx(3, rel=1e-2)
    np.testing.assert_allclose(model.simulate([0.0], t, u=u)[:, 0], x, atol=1e-3)
    np.testing.assert_allclose(model.simulate([0.0], t, u=lambda time: np.sin(3 * time))[:, 0], x, atol=1e-3)


def test_discrete_time() -> None:
    x = [0.3]
    for _ in range(80):
        x.append(3.9 * x[-1] * (1 - x[-1]))
    model = sidc.Identifier("poly(x; 3)", discrete_time=True).fit(np.array(x))
    assert model.result_.equations[0].coefficients == pytest.approx({"x": 3.9, "x^2": -3.9})
    assert model.predict([[0.5]])[0, 0] == pytest.approx(0.975)
    assert model.score(np.array(x)) == pytest.approx(1)
    np.testing.assert_allclose(model.simulate([0.3], 10)[:, 0], x[:10], atol=1e-6)


def test_measured_derivatives_are_used(lorenz: Record) -> None:
    _, X = lorenz
    rows = np.random.default_rng(0).permutation(len(X))[:200]
    rates = np.transpose(lorenz_rates(0.0, X[rows].T))
    # Rows may be in any order, because nothing is differentiated.
    model = sidc.Identifier("poly(x, y, z; 2)").fit(X[rows], x_dot=rates)
    assert model.score(X[rows], x_dot=rates) == pytest.approx(1)
    # As targets, like in scikit-learn.
    assert model.fit(X[rows], rates).score(X[rows], rates) == pytest.approx(1)
    with pytest.raises(ValueError, match=r"x_dot has the shape \(200, 2\), and X has \(200, 3\)"):
        model.fit(X[rows], x_dot=rates[:, :2])


def test_names() -> None:
    t = np.arange(100) * 0.1
    X = np.column_stack([np.cos(t), -np.sin(t)])
    fit = lambda *given, **options: sidc.Identifier(*given, **options).fit(X, t=0.1)  # noqa: E731
    assert fit().feature_names_in_ == ["x0", "x1"]
    assert fit("poly(q, sin(p), p, pi*q; 1)").feature_names_in_ == ["q", "p"]
    assert fit("<1e-3*q, 2.5e3*p>").feature_names_in_ == ["q", "p"]
    assert fit("<sin q, cos p> + poly(q, p; 1)").feature_names_in_ == ["q", "p"]
    assert fit(feature_names=["a", "b"]).feature_names_in_ == ["a", "b"]
    frame = pd.DataFrame(X, columns=["p", "q"])
    assert sidc.Identifier("poly(q, p; 1)").fit(frame, t=0.1).feature_names_in_ == ["p", "q"]
    with pytest.raises(ValueError, match="X has 2 columns, and their names would be p: give feature_names"):
        fit("poly(p; 2)")
    with pytest.raises(AttributeError, match="not fitted yet"):
        sidc.Identifier().predict(X)


def test_parameters_as_scikit_learn_has_them() -> None:
    model = sidc.Identifier("poly(x; 2)", noise={"x": 0.1})
    assert model.get_params() == {
        "library": "poly(x; 2)",
        "feature_names": None,
        "input_names": None,
        "noise": {"x": 0.1},
        "method": "auto",
        "discrete_time": False,
        "t_default": 1.0,
    }
    assert repr(model) == "Identifier(library='poly(x; 2)', noise={'x': 0.1})"
    copy = clone(model)
    assert copy is not model
    assert copy.get_params() == model.get_params()
    assert model.set_params(method="weak").method == "weak"
    with pytest.raises(ValueError, match="Identifier has no parameter degree; it has library"):
        model.set_params(degree=3)


def test_fitted_identifiers_are_kept(lorenz: Record) -> None:
    t, X = lorenz
    model = sidc.Identifier("poly(x, y, z; 2)").fit(X, t=t)
    again = pickle.loads(pickle.dumps(model))
    np.testing.assert_array_equal(again.predict(X[:3]), model.predict(X[:3]))


def test_model_selection_of_scikit_learn(lorenz: Record) -> None:
    t, X = lorenz
    splits = TimeSeriesSplit(n_splits=2)
    scores = cross_val_score(sidc.Identifier("poly(x, y, z; 2)", t_default=0.005), X, cv=splits)
    assert min(scores) > 0.999
    # A fold from the middle leaves a gap, which the times show.
    folds = cross_val_score(sidc.Identifier("poly(x, y, z; 2)", t_default=0.005), X, params={"t": t}, cv=3)
    assert min(folds) > 0.999
    libraries = ["poly(x, y, z; 1)", "poly(x, y, z; 2)"]
    search = GridSearchCV(sidc.Identifier(t_default=0.005), {"library": libraries}, cv=splits).fit(X)
    assert search.best_params_ == {"library": libraries[1]}
    thousandths: Any = FunctionTransformer(lambda values: values / 10)
    pipeline = make_pipeline(thousandths, sidc.Identifier("poly(x, y, z; 2)"))
    pipeline.fit(X, identifier__t=0.005)
    assert pipeline.predict(X[:5]).shape == (5, 3)
    assert pipeline[-1].result_.equations[1].coefficients["x*z"] == pytest.approx(-10, abs=1e-2)


class OfStates(sidc.Identifier):
    """Ignores targets: those in scikit-learn's checks are not derivatives of X."""

    def fit(self, X: Any, y: Any = None) -> OfStates:  # type: ignore[override]
        super().fit(X)
        return self

    def score(self, X: Any, y: Any = None) -> float:  # type: ignore[override]
        return super().score(X)


def test_the_conventions_of_scikit_learn_hold() -> None:
    checks = check_estimator(OfStates(), on_skip=None, on_fail=None)
    # Most of its samples are random and follow no law, and nothing can be predicted without equations.
    wrong = [c for c in checks if c["status"] == "failed" and "no equation was found" not in str(c["exception"])]
    assert {c["check_name"] for c in wrong} == {
        # Targets are ignored here; `test_rows_that_do_not_fit_are_refused` covers them.
        "check_regressors_train",
        "check_supervised_y_no_nan",
        # One column is one state, as in PySINDy.
        "check_fit1d",
    }
    assert sum(c["status"] == "passed" for c in checks) >= 30


def test_rows_that_do_not_fit_are_refused(lorenz: Record) -> None:
    t, X = lorenz
    model = sidc.Identifier(library="poly(x, y, z; 2)").fit(X, t=t)
    with pytest.raises(ValueError, match="X has 2 features, but Identifier is expecting 3 features"):
        model.predict(X[:, :2])
    with pytest.raises(ValueError, match=r"0 sample\(s\) \(shape=\(0, 3\)\)"):
        sidc.Identifier().fit(X[:0], t=t[:0])
    with pytest.raises(ValueError, match="x_dot has 5 rows, and X has"):
        sidc.Identifier().fit(X, t=t, x_dot=X[:5])
    rates = np.gradient(X, t, axis=0)
    rates[7, 1] = np.inf
    with pytest.raises(sidc.Error, match="inf"):
        sidc.Identifier().fit(X, t=t, x_dot=rates)
    noise = np.random.default_rng(0).normal(size=(40, 2))
    with pytest.raises(ValueError, match="no equation was found for dx0, dx1; result_.failed says why"):
        sidc.Identifier(library="poly(x0, x1; 1)").fit(noise).predict(noise)
