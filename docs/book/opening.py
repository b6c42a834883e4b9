"""Draws docs/opening.svg: the data of the first example beside the equations that README shows for them.

In: models/data/pendulum.csv, README.md. Out: the picture, on standard output. From the root: python3 docs/book/opening.py > docs/opening.svg
"""

import csv
import html

WIDTH, HEIGHT = 920, 285
LEFT, RIGHT, TOP, TALL, GAP = 92, 400, 44, 62, 16
PANELS = [("y", "cart (m)", "#2a6fbb"), ("theta", "angle (rad)", "#b3541e"), ("F", "force (N)", "#3b7d3b")]


def read():
    with open("models/data/pendulum.csv") as table:
        rows = list(csv.DictReader(line for line in table if not line.startswith("#")))
    return {name: [float(row[name]) for row in rows] for name in ("t", "y", "theta", "F")}


def equations():
    lines = open("README.md").read().split("\n")
    return [line for line in lines if line.startswith(("ddy ", "ddtheta "))][:2]


def broken(line, most=43):
    """An equation in lines of at most `most` characters, cut before a sign."""
    name, right = (part.strip() for part in line.split(" = "))
    out, current = [], f"{name} ="
    for part in right.replace(" + ", "\n+ ").replace(" - ", "\n- ").split("\n"):
        if len(current) + len(part) + 1 > most:
            out.append(current)
            current = "   "
        current += " " + part
    return [*out, current]


def main():
    data = read()
    t, out = data["t"], []
    text = "font-family='system-ui, sans-serif' font-size='13' fill='#333'"
    for i, (name, label, colour) in enumerate(PANELS):
        top, values = TOP + i * (TALL + GAP), data[name]
        low, high = min(values), max(values)
        at = [
            f"{LEFT + (RIGHT - LEFT) * a / t[-1]:.1f},{top + TALL * (high - v) / (high - low):.1f}"
            for a, v in zip(t, values)
        ]
        out.append(f"<rect x='{LEFT}' y='{top}' width='{RIGHT - LEFT}' height='{TALL}' fill='#f6f7f9'/>")
        out.append(f"<polyline points='{' '.join(at)}' fill='none' stroke='{colour}' stroke-width='1.6'/>")
        out.append(f"<text x='{LEFT - 8}' y='{top + TALL / 2 + 4}' text-anchor='end' {text}>{label}</text>")
    bottom = TOP + 3 * TALL + 2 * GAP + 18
    out.append(f"<text x='{LEFT}' y='{bottom}' {text}>0</text>")
    out.append(f"<text x='{RIGHT}' y='{bottom}' text-anchor='end' {text}>{t[-1]:.0f} s</text>")
    bold = text.replace("'13'", "'15' font-weight='600'")
    out.append(f"<text x='{LEFT}' y='28' {bold}>what was measured</text>")
    out.append(f"<text x='520' y='28' {bold}>the law that sidc finds</text>")
    out.append("<path d='M 425 150 H 485 m -12 -9 l 12 9 l -12 9' fill='none' stroke='#666' stroke-width='2.5'/>")
    code = "font-family='ui-monospace, monospace' font-size='15' fill='#111' xml:space='preserve'"
    y = 74
    for equation in equations():
        for line in broken(equation):
            out.append(f"<text x='520' y='{y}' {code}>{html.escape(line)}</text>")
            y += 24
        y += 16
    for line in (
        "7 terms, picked from 6,561 candidates for each equation,",
        "exactly those of the simulated cart and pendulum",
    ):
        out.append(f"<text x='520' y='{y}' {text}>{line}</text>")
        y += 20
    head = f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' width='{WIDTH}' height='{HEIGHT}'>"
    print("\n".join([head, f"<rect width='{WIDTH}' height='{HEIGHT}' fill='#fff'/>", *out, "</svg>"]))


main()
