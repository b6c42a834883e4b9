"""Ten of PySINDy's own examples (notebooks 1, 2 and 3 of its documentation), by PySINDy and sidc.Identifier on the same arrays.

    python crates/studies/pysindy/examples.py

Libraries, thresholds, times and starts are those of the notebooks, if they give them. Noise is added to the states, because measured
derivatives are rare. For each example: seconds, surplus and missing terms, the largest error of a true coefficient. Needs pip's sidc,
pysindy and scipy.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pysindy as ps
from scipy.integrate import solve_ivp

import sidc

Law = dict[str, dict[str, float]]


@dataclass
class Example:
    name: str
    law: Law
    X: list[np.ndarray]
    step: float
    degree: int
    threshold: float
    inputs: list[np.ndarray] | None = None
    discrete: bool = False
    states: list[str] = field(init=False)

    def __post_init__(self) -> None:
        self.states = list(self.law)


def canonical(term: str) -> tuple[str, ...]:
    """Identifies x y^2 with y^2*x."""
    return tuple(sorted(factor for factor in term.replace("*", " ").split() if factor != "1"))


def rates(law: Law, state: dict[str, float]) -> list[float]:
    def value(term: str) -> float:
        powers = [factor.partition("^") for factor in canonical(term)]
        return float(np.prod([state[name] ** int(power or 1) for name, _, power in powers]))

    return [sum(a * value(term) for term, a in terms.items()) for terms in law.values()]


def motion(law: Law, start: list[float], end: float, step: float, u: Callable[[float], dict[str, float]] = lambda t: {}) -> np.ndarray:
    t = np.arange(0, end, step)
    right = lambda time, s: rates(law, dict(zip(law, s)) | u(time))  # noqa: E731
    return solve_ivp(right, (0, end), start, t_eval=t, rtol=1e-12, atol=1e-12, method="LSODA").y.T


def noisy(X: np.ndarray, share: float, seed: int = 0) -> np.ndarray:
    return X + share * X.std(axis=0) * np.random.default_rng(seed).normal(size=X.shape)


def examples() -> list[Example]:
    linear2 = {"x": {"x": -0.1, "y": 2}, "y": {"x": -2, "y": -0.1}}
    cubic2 = {"x": {"x^3": -0.1, "y^3": 2}, "y": {"x^3": -2, "y^3": -0.1}}
    linear3 = {"x": {"x": -0.1, "y": 2}, "y": {"x": -2, "y": -0.1}, "z": {"z": -0.3}}
    lorenz = {"x": {"x": -10, "y": 10}, "y": {"x": 28, "y": -1, "x*z": -1}, "z": {"z": -8 / 3, "x*y": 1}}
    driven = {**lorenz, "x": {"x": -10, "y": 10, "u^2": 1}}
    mean_field = {"x": {"x": 0.1, "y": -1, "x*z": -0.1}, "y": {"x": 1, "y": 0.1, "y*z": -0.1}, "z": {"z": -10, "x^2": 10, "y^2": 10}}
    hopf = {"x": {"u*x": 1, "y": 1, "x^3": -1, "x*y^2": -1}, "y": {"x": -1, "u*y": 1, "x^2*y": -1, "y^3": -1}}
    logistic = {"x": {"u*x": 1, "u*x^2": -1}}
    duffing = {"x": {"y": 1}, "y": {"y": -0.2, "x": -0.05, "x^3": -1}}
    van_der_pol = {"x": {"y": 1}, "y": {"y": 0.5, "x^2*y": -0.5, "x": -1}}
    rossler = {"x": {"y": -1, "z": -1}, "y": {"x": 1, "y": 0.2}, "z": {"1": 0.2, "z": -5.7, "x*z": 1}}

    def push(t: float) -> dict[str, float]:
        return {"u": 5 * np.sin(2 * t)}

    def hopf_run(mu: float, start: list[float]) -> np.ndarray:
        return motion(hopf, start, 75, 0.05, lambda t: {"u": mu})

    hopf_runs = [(mu, start) for mu in (-0.15, -0.05, 0.05, 0.15, 0.35, 0.55) for start in ([2.0, 0.0], [0.1, 0.0])]
    maps = []
    random = np.random.default_rng(1)
    for r in (2.5, 2.75, 3, 3.25, 3.5, 3.75, 3.8, 3.85, 3.9, 3.95):
        x = [0.5]
        for _ in range(1000):
            # As in the notebook, noise acts on the population itself.
            x.append(float(np.clip(r * x[-1] * (1 - x[-1]) + 0.025 * random.normal(), 0.0, 1.0)))
        maps.append((r, np.array(x)[:, None]))
    pushes = np.array([[push(t)["u"]] for t in np.arange(0, 10, 0.001)])
    return [
        Example("linear, 2 states", linear2, [noisy(motion(linear2, [2, 0], 25, 0.01), 0.01)], 0.01, 5, 0.05),
        Example("cubic, 2 states", cubic2, [noisy(motion(cubic2, [2, 0], 25, 0.01), 0.01)], 0.01, 5, 0.05),
        Example("linear, 3 states", linear3, [noisy(motion(linear3, [2, 0, 1], 50, 0.01), 0.01)], 0.01, 2, 0.05),
        Example("Lorenz", lorenz, [noisy(motion(lorenz, [-8, 8, 27], 10, 0.002), 0.01)], 0.002, 2, 0.3),
        Example("Lorenz with control, clean", driven, [motion(driven, [-8, 8, 27], 10, 0.001, push)], 0.001, 2, 0.3, [pushes]),
        Example("mean field of a wake", mean_field, [noisy(motion(mean_field, [1e-3, 0, 0.1], 75, 0.01), 0.002)], 0.01, 2, 0.05),
        Example(
            "Hopf normal form, 12 runs", hopf, [noisy(hopf_run(mu, start), 0.005, k) for k, (mu, start) in enumerate(hopf_runs)], 0.05, 3,
            0.1, [np.full((1500, 1), mu) for mu, _ in hopf_runs],
        ),  # fmt: skip
        Example("logistic map, 10 runs", logistic, [x for _, x in maps], 1.0, 3, 0.1, [np.full(x.shape, r) for r, x in maps], True),
        Example("Duffing", duffing, [noisy(motion(duffing, [1, 0], 40, 0.01), 0.01)], 0.01, 3, 0.04),
        Example("Van der Pol", van_der_pol, [noisy(motion(van_der_pol, [2, 0], 30, 0.01), 0.01)], 0.01, 3, 0.05),
        Example("Rössler", rossler, [noisy(motion(rossler, [3, 5, 0], 50, 0.01), 0.01)], 0.01, 2, 0.05),
    ]


def theirs(e: Example) -> Any:
    several = len(e.X) > 1
    parts = {"optimizer": ps.STLSQ(threshold=e.threshold), "feature_library": ps.PolynomialLibrary(degree=e.degree)}
    model = ps.DiscreteSINDy(**parts) if e.discrete else ps.SINDy(**parts)
    u = None if e.inputs is None else (e.inputs if several else e.inputs[0])
    names = e.states + (["u"] if e.inputs else [])
    model.fit(e.X if several else e.X[0], t=1 if e.discrete else e.step, u=u, feature_names=names)
    return model


def ours(e: Example) -> Any:
    several = len(e.X) > 1
    names = ", ".join(e.states + (["u"] if e.inputs else []))
    model = sidc.Identifier(f"poly({names}; {e.degree})", feature_names=e.states, discrete_time=e.discrete)
    u = None if e.inputs is None else (e.inputs if several else e.inputs[0])
    model.fit(e.X if several else e.X[0], t=e.step, u=u)
    return model


def judged(e: Example, model: Any, seconds: float) -> str:
    names = [canonical(name) for name in model.get_feature_names()]
    more = fewer = 0
    worst = 0.0
    for state, row in zip(e.states, model.coefficients()):
        found = {name: a for name, a in zip(names, row) if a != 0}
        true = {canonical(term): a for term, a in e.law[state].items()}
        more += len(found.keys() - true.keys())
        fewer += len(true.keys() - found.keys())
        worst = max([worst, *(abs(found[term] / true[term] - 1) for term in found.keys() & true.keys())])
    terms = "exact" if more + fewer == 0 else f"{more} too many, {fewer} too few"
    return f"{seconds:.2f} s, {terms}, {100 * worst:.2g} %"


def main() -> None:
    print("| example | PySINDy 2.1 | sidc | its word |\n|---|---|---|---|")
    for e in examples():
        cells = []
        for fit in (theirs, ours):
            begun = time.perf_counter()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    model = fit(e)
                    cells.append(judged(e, model, time.perf_counter() - begun))
                except Exception as fault:  # noqa: BLE001 - any failure is a result of the comparison
                    cells.append(str(fault).splitlines()[0])
        result = model.result_
        word = "passes" if result.passes else "doubted: " + ", ".join(sorted({doubt.code for doubt in result.doubts}))
        print(f"| {e.name} | {cells[0]} | {cells[1]} | {word} |", flush=True)


if __name__ == "__main__":
    main()
