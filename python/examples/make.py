"""Writes the notebooks of this folder anew and runs them: `python make.py`. Their text stands here, so that it can be read and reviewed.

Each part is text, or code behind `>`. Needs nbclient, ipykernel, matplotlib.
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

NOTEBOOKS = {"ten_minutes": TEN_MINUTES, "pendulum": PENDULUM}


def notebook(parts: list[str]) -> nbformat.NotebookNode:
    """The cells, not run."""
    made = new_notebook(metadata={"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}})
    for place, part in enumerate(parts):
        cell = new_code_cell(part[1:]) if part.startswith(">") else new_markdown_cell(part)
        cell["id"] = f"cell-{place}"
        made.cells.append(cell)
    return made


def run(name: str, folder: Path) -> nbformat.NotebookNode:
    """A notebook with its outputs; raises what a cell raises."""
    made = notebook(NOTEBOOKS[name])
    nbclient.NotebookClient(made, timeout=120, resources={"metadata": {"path": str(folder)}}, record_timing=False).execute()
    made.metadata.pop("language_info", None)
    return made


if __name__ == "__main__":
    here = Path(__file__).resolve().parent
    for name in NOTEBOOKS:
        nbformat.write(run(name, here), here / f"{name}.ipynb")
