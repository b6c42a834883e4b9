"""Writes and runs the notebooks in this folder: `python make.py`. Their text is kept here, so that it can be read and reviewed.

Each part is text, or code if it starts with `>`. Needs nbclient, ipykernel, matplotlib.
"""

from __future__ import annotations

from pathlib import Path

import nbclient
import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

TEN_MINUTES = [
    "# Ten minutes\n\nA mass on a hardening spring is recorded: position and force, nothing else. What is its law?",
    ">import numpy as np\nfrom scipy.integrate import solve_ivp\n\nimport sidc",
    "The plant, which we pretend not to know: a Duffing oscillator with a force that is read every hundredth of a second.",
    ">t = np.arange(0, 30, 0.01)\n"
    "force = 0.9 * np.sin(1.1 * t) + 0.5 * np.sin(2.7 * t + 1)\n\n\n"
    "def plant(time, state):\n"
    "    x, v = state\n"
    "    return v, -x - 0.6 * x**3 - 0.15 * v + np.interp(time, t, force)\n\n\n"
    "x = solve_ivp(plant, (0, 30), (0.5, 0), t_eval=t, rtol=1e-9, atol=1e-9).y[0]\n"
    "readings = x + 0.005 * np.random.default_rng(1).normal(size=len(t))\n"
    'data = {"t": t, "x": readings, "F": force}',
    "## A first model\n\n`sidc.new` guesses one from names and shapes. Its comments say what was guessed.",
    ">print(sidc.new(data).text)",
    "We know better what may matter, and write it down: the state is of second order, `F` acts on it, and forces may be polynomials of position and speed.",
    '>model = sidc.Model("""\nstate x : order 2\ninput F : linear\n\nddx ~ poly(x, dx; 3) + <F>\n""")\n'
    'model.candidates("ddx"), model.terms("ddx")',
    "## Equations\n\nThe last quarter of the record is held out: no equation is found from it.",
    ">result = model.identify(data, holdout=0.25, horizon=0.5)\nresult",
    "## Is it good enough?\n\n`plot` runs the equations freely along the record.",
    ">result.plot()",
    "Half a second ahead, on data that were not used, in the unit of the signal:",
    ">signal = result.verdict.prediction.signals[0]\nsignal.signal, signal.error.quantile_90, signal.no_change.quantile_90",
    "## Use them\n\nIn SymPy, in SciPy, in C.",
    ">result.to_sympy()[0]",
    ">f = result.function()\nsolution = solve_ivp(f, (0, 5), [0.5, 0.0], jac=f.jacobian, args=(lambda time: np.interp(time, t, force),), method=\"Radau\", rtol=1e-6)\n"
    "np.interp(5, t, x) - solution.y[0, -1]",
    '>print(result.export("c")[:700])',
]

PENDULUM = [
    "# A pendulum on a cart, from positions\n\nTwo encoders and the command at 100 Hz: positions of cart and rod, and a force that jumps. Speeds and accelerations were never measured.",
    ">from pathlib import Path\n\nimport pandas as pd\n\nimport sidc\n\n"
    'models = next(folder / "models" for folder in Path.cwd().resolve().parents if (folder / "models/pendulum.sid").exists())\n'
    'frame = pd.read_csv(models / "data/pendulum_positions.csv", comment="#")\nframe.head(3)',
    "The two bodies are joined, so each acceleration may stand in the other's equation. That keeps the equations short.",
    '>model = sidc.read(models / "pendulum_positions.sid")\nprint(model.text[model.text.index("system"):])',
    ">result = model.identify(frame)\nresult",
    "All seven terms of the plant, and nothing else. Every coefficient has an interval:",
    ">pd.DataFrame(\n    [(e.target, t.term, t.coefficient, (t.interval[1] - t.interval[0]) / 2, t.mark) for e in result.equations for t in e.terms],\n"
    '    columns=["target", "term", "coefficient", "±, 95 %", "mark"],\n)',
    "A mistake in a model is shown at its place:",
    ">try:\n    sidc.Model(model.text.replace(\"dtheta; 2\", \"dthta; 2\"))\nexcept sidc.Error as error:\n    print(error)",
    ">result.plot()",
]

PYSINDY_TOUR = [
    "# A tour for users of PySINDy\n\nThe Lorenz system with noisy states, then with a control, in the arrays that PySINDy takes. `pysindy` runs beside `sidc` wherever both have an answer.",
    ">import numpy as np\nimport pysindy as ps\nfrom scipy.integrate import solve_ivp\n\nimport sidc",
    '>def lorenz(t, state, u=lambda t: 0.0):\n    x, y, z = state\n    return 10 * (y - x) + u(t), x * (28 - z) - y, x * y - 8 / 3 * z\n\n\n'
    "t = np.arange(0, 8, 0.004)\n"
    "clean = solve_ivp(lorenz, (0, 8), (-8, 8, 27), t_eval=t, rtol=1e-10, atol=1e-10).y.T\n"
    "X = clean + 0.02 * clean.std(axis=0) * np.random.default_rng(0).normal(size=clean.shape)",
    "## Fit\n\nTwo per cent of noise. The threshold of STLSQ is yours to choose; sidc has none: a criterion selects the terms, and trajectory and equations are estimated together.",
    ">theirs = ps.SINDy(optimizer=ps.STLSQ(threshold=0.3))\ntheirs.fit(X, t=t, feature_names=[\"x\", \"y\", \"z\"])\ntheirs.print()",
    ">ours = sidc.Identifier(\"poly(x, y, z; 2)\")\nours.fit(X, t=t)\nours.print()",
    "The largest error of a coefficient, of those that the true system has:",
    '>truth = {("x", "x"): -10, ("x", "y"): 10, ("y", "x"): 28, ("y", "y"): -1, ("y", "x*z"): -1, ("z", "z"): -8 / 3, ("z", "x*y"): 1}\n\n\n'
    "def worst(model):\n"
    '    names = [name.replace(" ", "*") for name in model.get_feature_names()]\n'
    '    rows = dict(zip("xyz", model.coefficients()))\n'
    "    return max(abs(rows[state][names.index(term)] - value) for (state, term), value in truth.items())\n\n\n"
    "float(worst(theirs)), float(worst(ours))",
    "## How far to trust it\n\n`result_` is what sidc knows beyond coefficients: whether it is the law, how far ahead it predicts, and every reason for doubt.",
    ">result = ours.result_\nresult",
    ">for equation in result.equations:\n    for term in equation.terms:\n        print(equation.target, term.term, term.coefficient, term.interval)",
    "## Control\n\nInputs go to `fit(…, u=…)` in both.",
    '>def push(t):\n    return 20 * np.sin(3 * t)\n\n\n'
    'pushed = solve_ivp(lambda t, s: lorenz(t, s, push), (0, 8), (-8, 8, 27), t_eval=t, rtol=1e-10, atol=1e-10).y.T\n'
    'controlled = sidc.Identifier("poly(x, y, z; 2) + <u>")\n'
    "controlled.fit(pushed, t=t, u=push(t))\ncontrolled.print()",
    "## Further\n\nThe same with a model of its own, which knows that only products of the states matter in two of the equations, and its code in C.",
    '>model = sidc.Model("""\nstate x, y, z\n\ndx ~ <x, y, z>\ndy, dz ~ poly(x, y, z; 2)\n""")\n'
    'found = model.identify({"t": t, **dict(zip("xyz", X.T))}, noise=dict(zip("xyz", 0.02 * clean.std(axis=0))))\nprint(found)',
    '>print(found.export("c")[:400])',
]

FLEET = [
    "# A fleet with Dask\n\nForty pendulums of one make were recorded. Is one law enough for all? Two worker processes find out; on a cluster of machines the same lines do.",
    ">import numpy as np\nfrom distributed import Client, LocalCluster\nfrom scipy.integrate import solve_ivp\n\nimport sidc\nimport sidc.dask",
    '>def swing(length, seed):\n'
    "    random = np.random.default_rng(seed)\n"
    "    t = np.arange(0, 8, 0.02)\n"
    "    start = random.uniform(0.8, 2.0), random.uniform(-1, 1)\n\n"
    "    def plant(time, state):\n"
    "        return state[1], -9.81 / length * np.sin(state[0]) - 0.2 * state[1]\n\n"
    "    x = solve_ivp(plant, (0, 8), start, t_eval=t, rtol=1e-9, atol=1e-9).y[0]\n"
    '    return {"t": t, "x": x + 0.005 * random.normal(size=len(t))}\n\n\n'
    "records = [swing(1.0, seed) for seed in range(40)]",
    ">cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)\nclient = Client(cluster)",
    '>model = sidc.Model("state x : order 2, noise 0.005\\nddx ~ <sin x, cos x> + poly(x, dx; 2)\\n")\n'
    "fleet = sidc.dask.identify_fleet(model, records)\nprint(fleet)",
    "Groups of eight were identified by the joint method; the terms that most of them found are the law's. Each coefficient is the mean of the groups, and whether it differs between them was tested.",
    ">for term in fleet.terms:\n    print(term.term, term.coefficient, term.standard_error, term.p)",
    "Now ten of them are a tenth longer.",
    ">mixed = records[:30] + [swing(1.1, seed) for seed in range(30, 40)]\nprint(sidc.dask.identify_fleet(model, mixed))",
    "So each gets a law of its own.",
    ">each = sidc.dask.identify_each(model, mixed)\n"
    'stiffness = np.array([-result.equations[0].coefficients["sin(x)"] for result in each])\n'
    "stiffness[:30].mean(), stiffness[30:].mean(), 9.81, 9.81 / 1.1",
    ">client.close()\ncluster.close()",
]

NOTEBOOKS = {"ten_minutes": TEN_MINUTES, "pendulum": PENDULUM, "pysindy_tour": PYSINDY_TOUR, "fleet": FLEET}


def notebook(parts: list[str]) -> nbformat.NotebookNode:
    """The cells, not yet run."""
    made = new_notebook(metadata={"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}})
    for place, part in enumerate(parts):
        cell = new_code_cell(part[1:]) if part.startswith(">") else new_markdown_cell(part)
        cell["id"] = f"cell-{place}"
        made.cells.append(cell)
    return made


def run(name: str, folder: Path) -> nbformat.NotebookNode:
    """Runs a notebook. Raises what a cell raises."""
    made = notebook(NOTEBOOKS[name])
    nbclient.NotebookClient(made, timeout=120, resources={"metadata": {"path": str(folder)}}, record_timing=False).execute()
    made.metadata.pop("language_info", None)
    return made


if __name__ == "__main__":
    here = Path(__file__).resolve().parent
    for name in NOTEBOOKS:
        nbformat.write(run(name, here), here / f"{name}.ipynb")
