"""Systems whose laws are all given but for their constants: prints the table of docs/hidden.md, "Given laws in draws".

    python3 crates/studies/given/table.py [target/release/sidc] [--draws 10] [--level 0 0.01 0.05] [--only sir]

Each draw has its own constants, a factor of up to three about a usual value, and its own start and noise; every constant is sought over two decades. Tanks that
would run empty are drawn again.
An answer is right if every constant is within 2 % (at 0 %: 1e-4) or four of its standard errors. The wrong law of each system, which lacks a term, should be
doubted. Needs Python 3.9, numpy.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from identified import identified
from integration import runge_kutta


def level_of(t):
    """A stepwise input, read at the samples and held until the next."""
    return [0.2, 1.0, 0.5, 1.4, 0.0, 0.8, 0.3, 1.2][int(t + 1e-9) % 8]


# Constants with their usual values, start, samples, their step (s), what is read, states, inputs, laws; `wrong`: laws that replace theirs.
SYSTEMS = {
    "logistic growth": dict(
        constants=dict(r=1.0, K=4.0), start=lambda c, g: [0.1 * c["K"]], rows=200, step=lambda c: 0.05 / c["r"], read="x", states="x",
        laws={"dx": "r*x*(1 - x/K)"}, wrong={"dx": "r*x - x/K"}),
    "Michaelis and Menten": dict(
        constants=dict(V=2.0, K=0.7), start=lambda c, g: [4 * c["K"]], rows=200, step=lambda c: 0.03 * c["K"] / c["V"] * 2, read="s", states="s",
        laws={"ds": "-V*s/(K + s)"}, wrong={"ds": "-V*s/(K + 1)"}),
    "Lotka and Volterra": dict(
        constants=dict(a=1.0, b=0.4, c=0.1, d=0.4), start=lambda c, g: [2 * c["d"] / c["c"], 1.5 * c["a"] / c["b"]], rows=400,
        step=lambda c: 0.08 / np.sqrt(c["a"] * c["d"]), read="x, y", states="x, y",
        laws={"dx": "a*x - b*x*y", "dy": "c*x*y - d*y"}, wrong={"dy": "c*x*x - d*y"}),
    "predators unseen": dict(
        constants=dict(a=1.0, c=0.1, d=0.4), start=lambda c, g: [2 * c["d"] / c["c"], 1.5 * c["a"]], rows=400,
        step=lambda c: 0.05 / np.sqrt(c["a"] * c["d"]), read="x", states="x, y", laws={"dx": "a*x - x*y", "dy": "c*x*y - d*y"},
        wrong={"dy": "c*x*x - d*y"}),
    "epidemic, infected alone": dict(
        spread=1.5, constants=dict(beta=0.6, gamma=0.1), start=lambda c, g: [0.99, 0.01], rows=300, step=lambda c: 0.2 / c["beta"], read="I", states="S, I",
        laws={"dS": "-beta*S*I", "dI": "beta*S*I - gamma*I"}, wrong={"dS": "-beta*S*I + gamma"}),
    "Van der Pol": dict(
        constants=dict(mu=1.5, w=1.0), start=lambda c, g: [1.0, 0.0], rows=600, step=lambda c: 0.03 / c["w"], read="x", states="x : order 2",
        laws={"ddx": "mu*(1 - x^2)*dx - w^2*x"}, wrong={"ddx": "mu*(1 - x^2)*x - w^2*x"}),
    "pendulum with drag": dict(
        constants=dict(l=0.7, c=0.2, k=0.1), start=lambda c, g: [2.0, 0.0], rows=600, step=lambda c: 0.02 * np.sqrt(c["l"] / 0.7), read="q",
        states="q : order 2", laws={"ddq": "-9.81/l*sin(q) - c*dq - k*dq*abs(dq)"}, wrong={"ddq": "-9.81/l*sin(q) - c*dq*q - k*dq*abs(dq)"}),
    "Duffing, forced": dict(
        constants=dict(d=0.2, a=1.0, b=1.0), start=lambda c, g: [0.5, 0.0], rows=800, step=lambda c: 0.04, read="x", states="x : order 2", inputs="u",
        laws={"ddx": "-d*dx - a*x - b*x^3 + u"}, wrong={"ddx": "-d*dx - a*x + u"}),
    "two tanks, lower one read": dict(
        constants=dict(k=0.5, a=0.8, b=0.4), start=lambda c, g: [0.5, 0.5], rows=600, step=lambda c: 0.05, read="h", states="g, h", inputs="u", levels=True,
        laws={"dg": "k*u - a*sqrt(abs(g))", "dh": "a*sqrt(abs(g)) - b*sqrt(abs(h))"}, wrong={"dh": "a*sqrt(abs(g)) - b*h"}),
    "heater with a lag": dict(
        constants=dict(tau=2.0, g=0.6, a=0.2, T0=20.0), start=lambda c, g: [0.0, c["T0"]], rows=600, step=lambda c: 0.1, read="T", states="H, T",
        inputs="u", laws={"dH": "(u - H)/tau", "dT": "g*H - a*sqrt(T)*(T - T0)/4"},
        wrong={"dT": "g*H - a*T0"}),
    "motor, angle alone": dict(
        constants=dict(L=0.05, R=1.0, k=0.3, J=0.02, f=0.02), start=lambda c, g: [0.0, 0.0, 0.0], rows=800, step=lambda c: 0.01, read="q",
        states="i | q : order 2", inputs="u", laws={"di": "(u - R*i - k*dq)/L", "ddq": "(k*i - f*dq)/J"}, wrong={"di": "(u - R*i - k*dq^2)/L"},
        known=dict(k=0.3, R=1.0)),
    "bioreactor": dict(
        constants=dict(m=0.5, K=0.3, Y=0.5, D=0.1), start=lambda c, g: [0.1, 2.0], rows=300, step=lambda c: 0.06 / c["m"] * 0.5, read="X, S",
        states="X, S", laws={"dX": "m*S/(K + S)*X - D*X", "dS": "D*(2 - S) - m*S/(K + S)*X/Y"}, wrong={"dS": "D*2 - m*S/(K + S)*X/Y"}),
    "Lorenz": dict(
        constants=dict(s=10.0, r=28.0, b=2.7), start=lambda c, g: [1.0, 1.0, c["r"] - 1], rows=600, step=lambda c: 0.01, read="x, y, z",
        states="x, y, z", laws={"dx": "s*(y - x)", "dy": "x*(r - z) - y", "dz": "x*y - b*z"}, wrong={"dz": "x*y - b*z^2"}, spread=1.3),
    "FitzHugh and Nagumo, voltage alone": dict(
        constants=dict(e=0.08, a=0.7, b=0.8), start=lambda c, g: [-1.0, 1.0], rows=1000, step=lambda c: 0.1, read="v", states="v, w",
        laws={"dv": "v - v^3/3 - w + 0.5", "dw": "e*(v + a - b*w)"}, wrong={"dw": "e*(v + a - b*w*v)"}, spread=1.2),
}


def rates(system, constants):
    names = [n.split(":")[0].strip() for n in system["states"].replace("|", ",").split(",")]
    second = {n for part in system["states"].split("|") if "order 2" in part for n in [part.split(":")[0].strip()]}
    order = [s for n in names for s in ([n, "d" + n] if n in second else [n])]
    code = {target: compile(law.replace("^", "**"), target, "eval") for target, law in system["laws"].items()}
    scope = dict(constants, sin=np.sin, sqrt=np.sqrt, abs=abs)

    def f(u, z):
        at = dict(zip(order, z), u=u, **scope)
        return np.array([at["d" + s] if "d" + s in order else eval(code["d" + s], {}, at) for s in order])

    return order, f


def record(system, constants, rng):
    order, f = rates(system, constants)
    step, z = system["step"](constants), np.array(system["start"](constants, rng), float)
    parts, rows = 8, []
    for k in range(system["rows"]):
        rows.append(z)
        u, h = level_of(k * step), step / parts
        for _ in range(parts):
            z = runge_kutta(lambda _, z: f(u, z), 0, z, h)
    return order, np.arange(system["rows"]) * step, np.array(rows)


def model(system, laws, sought):
    read = {n.strip() for n in system["read"].split(",")}
    lines = []
    for part in system["states"].split("|"):
        names, _, attributes = part.partition(":")
        for name in (n.strip() for n in names.split(",")):
            own = [a for a in (attributes.strip(), "" if name in read else "hidden") if a]
            lines.append(f"state {name}" + (" : " + ", ".join(own) if own else ""))
    if "inputs" in system:
        lines.append("input u : hold")
    for name, usual in system["constants"].items():
        lines.append(f"unknown {name} in {usual / 10:g}..{usual * 10:g}" if name in sought else f"let {name} = {system['known'][name]}")
    return "\n".join(lines + [f"{t} = {law}" for t, law in laws.items()]) + "\n"


def identify(program, text, columns):
    found, seconds, said = identified(program, text, columns)
    codes = sorted({r["code"] for e in found["equations"] + found.get("failed", []) for r in e["reasons"]})
    return found, codes, bool(found["equations"]) and not codes, seconds, said


def draw(program, name, seed, level):
    system = SYSTEMS[name]
    rng = np.random.default_rng([seed, *name.encode()])
    spread = system.get("spread", 3.0)
    known = system.get("known", {})
    while True:
        true = {k: known.get(k, v * spread ** rng.uniform(-1, 1)) for k, v in system["constants"].items()}
        order, times, states = record(system, true, rng)
        if not system.get("levels") or states.min() >= 0:
            break
    columns = {"t": times}
    for signal in (n.strip() for n in system["read"].split(",")):
        clean = states[:, order.index(signal)]
        columns[signal] = clean + level * np.std(clean) * rng.standard_normal(len(clean))
    if "inputs" in system:
        columns["u"] = np.array([level_of(t) for t in times])
    sought = [k for k in true if k not in known]
    found, codes, passed, seconds, said = identify(program, model(system, system["laws"], sought), columns)
    values = {u["name"]: (u["value"], u.get("standard_error")) for u in found.get("unknowns", [])}
    near, held = [], 0
    for k in sought:
        value, error = values.get(k, (np.inf, None))
        off = abs(value - true[k])
        near.append(off <= max(1e-4 if level == 0 else 0.02 * abs(true[k]), 4 * (error or 0)))
        held += error is not None and off <= 1.96 * error
    _, _, wrong, _, _ = identify(program, model(system, {**system["laws"], **system["wrong"]}, sought), columns)
    right = all(near)
    shown = {k: (round(v, 5), values.get(k)) for k, v in true.items()}
    return dict(right=right, passed=right and passed, held=held, sought=len(sought), wrong=wrong or passed and not right, seconds=seconds,
                said=f"{name} seed {seed} {100 * level:g} %: {shown} {codes} {said.strip()[:200]}", wrong_passes=wrong)


def main():
    p = argparse.ArgumentParser()
    p.add_argument("program", nargs="?", default="target/release/sidc")
    p.add_argument("--draws", type=int, default=10)
    p.add_argument("--level", type=float, nargs="*", default=[0, 0.01, 0.05])
    p.add_argument("--only", nargs="*", default=list(SYSTEMS))
    a = p.parse_args()
    print("| system | noise | right | of these, passed | in their intervals | wrong and passed | median seconds |\n|---|---|---|---|---|---|---|")
    missed = []
    for name in a.only:
        for level in a.level:
            runs = [draw(a.program, name, s, level) for s in range(a.draws)]
            count = lambda key: sum(r[key] for r in runs)
            print(f"| {name} | {100 * level:g} % | {count('right')} of {len(runs)} | {count('passed')} | {100 * count('held') / count('sought'):.0f} % | "
                  f"{count('wrong')} | {np.median([r['seconds'] for r in runs]):.1f} |", flush=True)
            missed += [r["said"] for r in runs if not r["passed"]]
            missed += [f"wrong law passes: {r['said']}" for r in runs if r["wrong_passes"]]
    print("\n".join(missed))


if __name__ == "__main__":
    main()
