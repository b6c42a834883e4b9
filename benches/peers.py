#!/usr/bin/env python3
"""Our solvers compared with those on PyPI, on the same numbers, in one run.

    python3 benches/peers.py                        # the full table, some ten minutes
    python3 benches/peers.py --sizes 100 --draws 1  # a first look

In:  nothing except the repository. The problems come from `cargo run -p sidc-studies --bin solve_times -- export`: a pendulum on a cart,
     6,561 terms, ROWS random samples from 15 s without noise, for both of its equations. Peers run in a virtual environment that
     the script makes under target/peers, with the versions pinned below.
Out: one Markdown table per size on standard output, every single run in target/peers/results.json.

All solvers get the same: Φ and y from the same file, columns and y scaled to length one before the clock starts (for our solvers the clock
includes that; PySINDy's defaults get raw columns), --threads threads, --limit seconds. A run shorter than a second is repeated three
times, and the shortest counts. No solver is told the number of terms. Answers are judged in this file:

  exact     the columns with |a_j|‖φ_j‖ above 1e-6 of the largest are exactly the true ones
  error     the largest relative error of a true coefficient
  1-norm    ‖Da‖₁ over the smallest that any contender reached with a residual below 1e-6
  residual  ‖Φa − y‖/‖y‖
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time
import venv

ROOT = pathlib.Path(__file__).resolve().parent.parent
HOME = ROOT / "target" / "peers"
PINNED = [
    "numpy==2.4.6",
    "scipy==1.17.1",
    "scikit-learn==1.9.1",
    "cvxpy==1.9.3",
    "clarabel==0.11.1",
    "pysindy==2.1.0",
]
SUPPORT = 1e-6
FEASIBLE = 1e-6
# Time that a subprocess may need besides solving: imports, reading the numbers, scaling.
GRACE = 20.0
SHORT, REPEATS = 1.0, 3


# --- the peers: unit columns P and a unit target q in, coefficients of P out ------------------------------------------


def linprog(method):
    """min 1ᵀ(p + q) s.t. P(p − q) = y, p, q ≥ 0, with SciPy's default tolerances."""

    def solve(P, q):
        import numpy as np
        from scipy.optimize import linprog as run

        n = P.shape[1]
        result = run(
            np.ones(2 * n),
            A_eq=np.hstack([P, -P]),
            b_eq=q,
            bounds=(0, None),
            method=method,
        )
        x = result.x if result.x is not None else np.zeros(2 * n)
        return x[:n] - x[n:], result.message.split(".")[0].split("(")[0].strip()

    return solve


def cvxpy_clarabel(P, q):
    """min ‖x‖₁ s.t. P x = q, written plainly; modelling time counts, as it does for a user."""
    import cvxpy as cp
    import numpy as np

    x = cp.Variable(P.shape[1])
    problem = cp.Problem(cp.Minimize(cp.norm1(x)), [P @ x == q])
    problem.solve(solver=cp.CLARABEL)
    value = x.value if x.value is not None else np.zeros(P.shape[1])
    return value, problem.status


def pysindy_defaults(P, q):
    """STLSQ with PySINDy's defaults, threshold 0.1 and ridge 0.05, on raw columns: what an unprepared user gets."""
    import pysindy

    fit = pysindy.STLSQ()
    fit.fit(P, q)
    return fit.coef_.ravel(), "threshold 0.1"


def pysindy_ladder(P, q):
    """STLSQ without a ridge for twenty thresholds, 2⁻²⁰ to 2⁻¹: the sparsest answer that fits to 1e-6, else the best fit."""
    import numpy as np
    import pysindy

    best, rank = np.zeros(P.shape[1]), (2, np.inf)
    for k in range(20, 0, -1):
        fit = pysindy.STLSQ(threshold=0.5**k, alpha=1e-12)
        try:
            fit.fit(P, q)
        except Exception:  # a threshold that drops everything is an error in some versions
            continue
        x = fit.coef_.ravel()
        left = float(np.linalg.norm(P @ x - q))
        now = (0, np.count_nonzero(x)) if left <= FEASIBLE else (1, left)
        if now < rank:
            best, rank = x, now
    return best, "20 thresholds"


def sklearn_omp(P, q):
    """Stops at a residual of 1e-9, as ours does; `tol` is the squared norm."""
    from sklearn.linear_model import orthogonal_mp

    return orthogonal_mp(P, q, tol=1e-18), ""


def sklearn_lars(P, q):
    """The Lasso by least angle regression, down to a penalty of zero, where the Lasso is basis pursuit."""
    import numpy as np
    from sklearn.linear_model import lars_path

    alpha, _, x = lars_path(P, q, method="lasso", alpha_min=0.0, max_iter=4000, return_path=False)
    return x, "penalty 0" if np.ravel(alpha)[-1] < 1e-12 else f"penalty {np.ravel(alpha)[-1]:.0e}"


PEERS = {
    "HiGHS dual simplex (SciPy)": linprog("highs-ds"),
    "HiGHS interior point (SciPy)": linprog("highs-ipm"),
    "CVXPY + Clarabel": cvxpy_clarabel,
    "PySINDy STLSQ, defaults": pysindy_defaults,
    "PySINDy STLSQ, ladder": pysindy_ladder,
    "scikit-learn OMP": sklearn_omp,
    "scikit-learn Lasso-LARS": sklearn_lars,
}


# Solvers that take Φ and y in the units of the model.
RAW = {"PySINDy STLSQ, defaults"}


# --- a worker: one peer, one problem, one line of JSON ---------------------------------------------------------------


def read(folder):
    """Φ (rows × cols, column-major), y, and the true terms as {column: coefficient}."""
    import numpy as np

    header = json.loads((folder / "problem.json").read_text())
    numbers = np.fromfile(folder / "problem.f64", dtype="<f8")
    rows, cols = header["rows"], header["cols"]
    phi = numbers[: rows * cols].reshape((rows, cols), order="F")
    return phi, numbers[rows * cols :], {int(j): a for j, a in header["truth"]}


def work(name, folder):
    import warnings

    import numpy as np

    warnings.simplefilter("ignore")
    phi, y, _ = read(folder)
    raw = name in RAW
    norms = np.ones(phi.shape[1]) if raw else np.linalg.norm(phi, axis=0)
    size = 1.0 if raw else np.linalg.norm(y)
    P = np.ascontiguousarray(phi / np.where(norms > 0, norms, 1.0))
    q = y / size
    del phi
    PEERS[name](P[:20, :30].copy(), q[:20].copy())  # imports and caches, off the clock
    seconds = float("inf")
    for _ in range(REPEATS):
        start = time.perf_counter()
        x, note = PEERS[name](P, q)
        seconds = min(seconds, time.perf_counter() - start)
        if seconds >= SHORT:
            break
    a = np.where(norms > 0, np.asarray(x) * size / np.where(norms > 0, norms, 1.0), 0.0)
    found = [(int(j), float(a[j])) for j in np.flatnonzero(a)]
    print(json.dumps({"seconds": seconds, "status": note, "coefficients": found}))


# --- the referee -----------------------------------------------------------------------------------------------------


def run(command, limit, environment):
    """The last line that the command prints, as JSON; the reason if there is none."""
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=limit + GRACE, env=environment, cwd=ROOT
        )
    except subprocess.TimeoutExpired:
        return {"failed": f"> {limit:.0f} s"}
    lines = done.stdout.strip().splitlines()
    if done.returncode != 0 or not lines:
        last = (done.stderr.strip().splitlines() or ["no output"])[-1]
        return {"failed": "out of memory" if done.returncode == -9 else f"error: {last.split(':', 1)[-1].strip()[:48]}"}
    answer = json.loads(lines[-1])
    return {"failed": f"> {limit:.0f} s"} if answer["seconds"] > limit else answer


def judge(answer, phi, y, truth):
    """Adds exact, error, norm1 and residual to an answer with coefficients."""
    import numpy as np

    found = {int(j): a for j, a in answer.pop("coefficients")}
    norms = np.linalg.norm(phi, axis=0)
    shares = {j: abs(a) * norms[j] for j, a in found.items()}
    largest = max(shares.values(), default=0.0)
    support = {j for j, s in shares.items() if s > SUPPORT * largest}
    left = y.copy()
    for j, a in found.items():
        left -= a * phi[:, j]
    answer["terms"] = len(support)
    answer["exact"] = support == set(truth)
    answer["error"] = max(abs(found.get(j, 0.0) - a) / abs(a) for j, a in truth.items())
    answer["norm1"] = float(sum(shares.values()))
    answer["residual"] = float(np.linalg.norm(left) / np.linalg.norm(y))
    return answer


def problem(binary, rows, target, seed, contenders, limit, environment):
    """All contenders on one problem: {name: answer}."""
    folder = HOME / "problem"
    subprocess.run(
        [binary, "export", folder, str(rows), target, str(seed)], check=True, stdout=subprocess.DEVNULL
    )
    phi, y, truth = read(folder)
    answers = {}
    for name, command in contenders.items():
        answer = run(command(folder), limit, environment)
        if "coefficients" in answer:
            answer = judge(answer, phi, y, truth)
        answers[name] = answer
        told = answer.get("failed") or f"{answer['seconds']:.4g} s, {answer['terms']} terms"
        print(f"{rows} rows, {target}, draw {seed}: {name}: {told}", file=sys.stderr, flush=True)
    sizes = [a["norm1"] for a in answers.values() if a.get("residual", 1.0) < FEASIBLE]
    for a in answers.values():
        if "norm1" in a:
            a["over_best"] = a["norm1"] / min(sizes) if sizes else float("nan")
    return answers


def table(title, runs, ours):
    """Medians of the times, and the worst of the other figures, over the runs of one size."""
    lines = [
        f"\n### {title}\n",
        "| solver | time (s) | ratio | exact | error | 1-norm | residual | says |",
        "|---|---:|---:|---:|---:|---:|---:|---|",
    ]

    def seconds(name):
        return [r[name].get("seconds", float("inf")) for r in runs]

    reference = statistics.median(seconds(ours))
    for name in runs[0]:
        done = [r[name] for r in runs if "exact" in r[name]]
        failed = [r[name]["failed"] for r in runs if "failed" in r[name]]
        exact = f"{sum(a['exact'] for a in done)}/{len(runs)}"
        if not done:
            lines.append(f"| {name} | {failed[0]} | | {exact} | | | | |")
            continue
        median = statistics.median(seconds(name))
        worst = [max(a[key] for a in done) for key in ("error", "over_best", "residual")]
        words = (a["status"].split("{")[0].strip() for a in done)
        notes = sorted({w for w in words if w})
        if any(a.get("proved") for a in done):
            notes.append(f"proved {sum(bool(a.get('proved')) for a in done)}/{len(runs)}")
        if failed:
            notes.append(f"{len(failed)} of {len(runs)}: {failed[0]}")
        shown = f"{median:.3g}" if median != float("inf") else failed[0]
        ratio = f"{median / reference:.3g}" if median != float("inf") else ""
        lines.append(
            f"| {name} | {shown} | {ratio} | {exact} | {worst[0]:.1e} | {worst[1]:.6f} | {worst[2]:.1e} | {'; '.join(notes)} |"
        )
    return "\n".join(lines)


def prepare():
    """Runs this script again inside target/peers/venv, which is created on the first run."""
    python = HOME / "venv" / "bin" / "python3"
    if pathlib.Path(sys.prefix) == HOME / "venv":
        return
    if not python.exists():
        print("making target/peers/venv …", file=sys.stderr)
        venv.create(HOME / "venv", with_pip=True)
    wanted = subprocess.run([python, "-m", "pip", "freeze"], capture_output=True, text=True)
    if not set(PINNED) <= set(wanted.stdout.splitlines()):
        subprocess.run([python, "-m", "pip", "install", "-q", *PINNED], check=True)
    os.execv(python, [str(python), __file__, *sys.argv[1:]])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default="100,375,1000", help="rows, by commas")
    parser.add_argument("--draws", type=int, default=2, help="draws of rows for each equation")
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for one contender on one problem")
    parser.add_argument("--threads", type=int, default=1, help="threads of BLAS and OpenMP")
    parser.add_argument("--only", default="", help="contenders whose name contains one of these, by commas; the default solver always")
    parser.add_argument("--work", nargs=2, metavar=("PEER", "DIR"), help=argparse.SUPPRESS)
    args = parser.parse_args()
    prepare()
    if args.work:
        work(args.work[0], pathlib.Path(args.work[1]))
        return
    build = ["cargo", "build", "--release", "--quiet", "-p", "sidc-studies", "--bin", "solve_times"]
    subprocess.run(build, check=True, cwd=ROOT)
    binary = str(ROOT / "target" / "release" / "solve_times")
    registered = [s["name"] for s in json.loads(subprocess.check_output([binary, "list"]))]
    ours = f"ours: {registered[0]} (default)"
    contenders = {}  # name: the command for the problem in a folder
    for name in registered:
        label = ours if name == registered[0] else f"ours: {name}"
        contenders[label] = lambda folder, name=name: [binary, "solve", str(folder), name]
    for name in PEERS:
        contenders[name] = lambda folder, name=name: [sys.executable, __file__, "--work", name, str(folder)]
    words = [w for w in args.only.lower().split(",") if w]
    if words:
        contenders = {n: c for n, c in contenders.items() if n == ours or any(w in n.lower() for w in words)}
    environment = dict(os.environ)
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
        environment[variable] = str(args.threads)
    everything = []
    for rows in (int(r) for r in args.sizes.split(",")):
        runs = []
        for seed in range(args.draws):
            for target in ("cart", "pendulum"):
                answers = problem(binary, rows, target, seed, contenders, args.limit, environment)
                runs.append(answers)
                everything.append({"rows": rows, "target": target, "seed": seed, "answers": answers})
        what = f"{rows} × 6,561: both equations of the cart-pendulum, draws of each: {args.draws}"
        print(table(what, runs, ours), flush=True)
    (HOME / "results.json").write_text(json.dumps(everything, indent=1))


if __name__ == "__main__":
    main()
