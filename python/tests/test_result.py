"""Contents and methods of results."""

from __future__ import annotations

import io
import pickle
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import csv

import sidc


@pytest.fixture(scope="module")
def pendulum(root: Path) -> tuple[dict[str, np.ndarray], sidc.Result]:
    """A pendulum on a cart under a force: coupled equations, an input."""
    data = csv(root / "models/data/pendulum.csv")
    return data, sidc.read(root / "models/pendulum.sid").identify(data)


def test_attributes_are_those_of_the_document(decay: dict[str, np.ndarray]) -> None:
    result = sidc.Model("state x\ndx ~ poly(x; 3)\n").identify(decay, holdout=0.25)
    assert result.passes is True
    assert result.verdict is not None
    assert (result.verdict.law, result.verdict.run.status) == ("passes", "follows")
    assert result.verdict.prediction.signals[0].signal == "x"
    (equation,) = result.equations
    assert (equation.target, equation["target"], equation.status) == ("dx", "dx", "pass")
    assert equation.coefficients == pytest.approx({"x": -0.5})
    assert equation.terms[0].unit is None
    assert (result.doubts, result.failed, result.unknowns) == ([], [], [])
    with pytest.raises(AttributeError, match="Equation has no targets; it has target, terms"):
        equation.targets  # noqa: B018
    assert str(result).startswith("dx = -0.5*x\n\nlaw: passes")
    assert pickle.loads(pickle.dumps(result)).to_json() == result.to_json()


def test_doubts_and_failures_are_told() -> None:
    t = np.arange(50) * 0.1
    rng = np.random.default_rng(1)
    result = sidc.Model("state x\ndx ~ poly(x; 2)\n").identify({"t": t, "x": rng.normal(size=50)})
    assert not result.passes
    assert result.doubts
    assert all(doubt.target == "dx" and doubt.code and doubt.text for doubt in result.doubts)
    stopped = sidc.Model("state x\ndx ~ poly(x; 2)\n").identify({"t": t, "x": rng.normal(size=50)}, time_limit=0)
    assert not stopped.passes
    assert {doubt.code for doubt in stopped.doubts} == {"time-limit"}


def test_unknown_constants_have_values(root: Path) -> None:
    data = csv(root / "models/data/michaelis_menten.csv")
    result = sidc.read(root / "models/michaelis_menten_unknown.sid").identify(data)
    (constant,) = result.unknowns
    assert constant.name == "K"
    assert constant.value == pytest.approx(0.3, rel=1e-3)
    assert result.function()(0.0, [0.3]) == pytest.approx([0.6 - 1.5 / 2], rel=1e-3)
    elsewhere = pickle.loads(pickle.dumps(result.function()))
    assert elsewhere(0.0, [0.3]) == result.function()(0.0, [0.3])


def test_functions_are_those_of_the_exported_code(pendulum: tuple[dict[str, np.ndarray], sidc.Result]) -> None:
    _, result = pendulum
    function = result.function()
    assert (function.states, function.inputs) == (["y", "dy", "theta", "dtheta"], ["F"])
    code: dict[str, Any] = {}
    exec(result.export("python"), code)
    points = np.random.default_rng(0).normal(size=(4, 6))
    force = np.linspace(-1, 1, 6)
    for point, u in zip(points.T, force):
        np.testing.assert_allclose(function(0.0, point, u), code["derivatives"](0.0, point, u), rtol=1e-12)
        np.testing.assert_allclose(function.jacobian(0.0, point, [u]), code["jacobian"](0.0, point, u), rtol=1e-9, atol=1e-12)
    together = function(0.0, points, force[None])
    assert together.shape == (4, 6)
    np.testing.assert_array_equal(together[:, 2], function(0.0, points[:, 2], force[2]))
    assert function.jacobian(0.0, points, force[None]).shape == (6, 4, 4)
    for y, u in ((points[:3, 0], 0.0), (points[:, 0], None), (points, force[None, :2])):
        with pytest.raises(ValueError, match="of shape|numbers of points"):
            function(0.0, y, u)


def test_functions_drive_integrators(pendulum: tuple[dict[str, np.ndarray], sidc.Result]) -> None:
    from scipy.integrate import solve_ivp

    data, result = pendulum
    run = result.simulate(data)
    assert run.fault is None
    assert min(score.fit for score in run.scores) > 99.9

    def force(t: float) -> float:
        # Held between samples, as the model declares.
        return float(data["F"][np.searchsorted(data["t"], t, side="right") - 1])

    function = result.function()
    start = [data[name][0] for name in function.states]
    span = (data["t"][0], data["t"][40])
    step = data["t"][1] - data["t"][0]
    solution = solve_ivp(function, span, start, args=(force,), rtol=1e-9, atol=1e-9, max_step=step / 4, t_eval=data["t"][:40])
    np.testing.assert_allclose(solution.y[2], run["theta"][:40], atol=1e-4)
    stiff = solve_ivp(function, span, start, args=(0.0,), jac=function.jacobian, method="Radau", rtol=1e-8, vectorized=True)
    plain = solve_ivp(function, span, start, args=(0.0,), rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(stiff.y[:, -1], plain.y[:, -1], atol=1e-4)


def test_functions_of_time_are_taken_when_they_act() -> None:
    t = np.arange(600) * 0.02
    late = np.clip(t - 0.4, 0, None)
    x = (2 * np.sin(late) - np.cos(late) + np.exp(-2 * late)) / 5
    model = sidc.Model("state x\ninput u : linear, delay 0.4\ndx ~ poly(x, u; 2)\n")
    function = model.identify({"t": t, "x": x, "u": np.sin(t)}).function()
    acting = function(1.0, [0.0], np.sin(0.6))
    np.testing.assert_allclose(function(1.0, [0.0], np.sin), acting, rtol=1e-12)
    assert acting == pytest.approx(np.sin(0.6), rel=1e-2)


def test_sympy_has_the_equations_as_they_were_found(pendulum: tuple[dict[str, np.ndarray], sidc.Result]) -> None:
    import sympy

    _, result = pendulum
    equations = result.to_sympy()
    assert [str(equation.lhs) for equation in equations] == ["ddy", "ddtheta"]
    theta, force = sympy.Symbol("theta", real=True), sympy.Symbol("F", real=True)
    assert float(equations[0].rhs.coeff(force)) == pytest.approx(1.29032, abs=1e-5)
    assert float(equations[1].rhs.coeff(sympy.sin(theta))) == pytest.approx(-19.6, abs=1e-6)


def test_scores_are_predictions(decay: dict[str, np.ndarray]) -> None:
    result = sidc.Model("state x\ndx ~ poly(x; 2)\n").identify(decay)
    score = result.score(decay, horizon=1.0)
    (signal,) = score.signals
    assert (score.horizon, signal.signal, score.unavailable) == (1.0, "x", None)
    assert signal.error.rms < 1e-6 < signal.no_change.rms
    assert result.score(decay, horizon=100.0).unavailable.code == "no-horizon"


def test_runs_start_where_they_are_told(decay: dict[str, np.ndarray]) -> None:
    result = sidc.Model("state x\ndx ~ poly(x; 2)\n").identify(decay)
    run = result.simulate({"t": [0.0, 1.0, 2.0]}, start={"x": 4.0})
    np.testing.assert_allclose(run["x"], 4.0 * np.exp([0.0, -0.5, -1.0]), rtol=1e-6)
    assert run.scores == []
    with pytest.raises(sidc.Error, match="lacks a column"):
        result.simulate({"t": [0.0, 1.0, 2.0]})


def test_parameters_have_values() -> None:
    t = np.arange(200) * 0.02
    runs = [{"t": t, "x": 3 * np.exp(-t / tau)} for tau in (0.5, 1.0, 2.0)]
    model = sidc.Model("state x\nparam tau\ndx ~ poly(x; 2) * <1, 1/tau>\n")
    result = model.identify(runs, params={"tau": [0.5, 1.0, 2.0]})
    assert result.equations[0].coefficients == pytest.approx({"x/tau": -1})
    alone = result.simulate(runs[0], params={"tau": 0.5})
    np.testing.assert_allclose(alone["x"], runs[0]["x"], rtol=1e-4, atol=1e-6)
    function = result.function()
    assert function.inputs == ["tau"]
    assert function(0.0, [1.0], [0.5]) == pytest.approx([-2])


def test_notebooks_show_equations_verdict_and_coefficients(pendulum: tuple[dict[str, np.ndarray], sidc.Result]) -> None:
    _, result = pendulum
    page = result._repr_html_()
    assert page.startswith('<div class="sidc">')
    assert page.count("<math>") > 10
    for said in ("law: passes", "prediction: ", "run: follows", 'class="terms"'):
        assert said in page
    # The style affects nothing else: every rule is nested in that of the element.
    style = page[page.index("<style>") + 7 : page.index("</style>")]
    assert style.strip().startswith(".sidc {")
    assert style.count("{") == style.count("}")
    assert ":root" not in style
    latex = result._repr_latex_()
    assert latex.startswith("$$\\begin{aligned}")
    assert "\\ddot{\\theta} &=" in latex


def test_coefficients_have_bars() -> None:
    t = np.arange(400) * 0.02
    x = 2.0 * np.exp(-0.5 * t) + 0.01 * np.random.default_rng(3).normal(size=400)
    result = sidc.Model("state x\ndx ~ poly(x; 2)\n").identify({"t": t, "x": x})
    (term,) = result.equations[0].terms
    low, high = term.interval or (1.0, 0.0)
    assert low < -0.5 < high
    assert "<svg" in result._repr_html_()


def test_reports_and_plots(pendulum: tuple[dict[str, np.ndarray], sidc.Result], tmp_path: Path) -> None:
    data, result = pendulum
    page = result.report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == str(page)
    assert "Measured against simulated" in str(page)
    assert page._repr_html_().startswith('<iframe srcdoc="&lt;!DOCTYPE html&gt;')
    figure = result.plot()
    drawn = [axes for axes in figure.axes if len(axes.lines) == 2]
    assert [axes.get_ylabel() for axes in drawn][:2] == ["y", "dy"]
    again = sidc.Result.from_json(result.to_json())
    with pytest.raises(ValueError, match="has no data of its own"):
        again.plot()
    assert len(again.plot(data).axes) == len(figure.axes)


@pytest.mark.parametrize("target", ["text", "latex", "rust", "c", "python", "sympy", "matlab"])
def test_every_target_is_exported(target: str, pendulum: tuple[dict[str, np.ndarray], sidc.Result]) -> None:
    assert "theta" in pendulum[1].export(target)
    assert pendulum[1].export_bytes(target) == pendulum[1].export(target).encode()


def test_an_fmu_is_bytes(pendulum: tuple[dict[str, np.ndarray], sidc.Result]) -> None:
    with pytest.raises(sidc.Error, match="export_bytes"):
        pendulum[1].export("fmi")
    files = zipfile.ZipFile(io.BytesIO(pendulum[1].export_bytes("fmi")))
    assert "theta" in files.read("modelDescription.xml").decode()


def test_documents_that_are_none_are_refused() -> None:
    for text in ("", "{}", '{"sidc_result": 99}'):
        with pytest.raises(sidc.Error) as raised:
            sidc.Result.from_json(text)
        assert raised.value.kind == "document"
