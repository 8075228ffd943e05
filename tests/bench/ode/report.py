"""What work_precision.py makes of its points: times at equal error, goals, plots, tables and the page in docs/."""
import json
import math
import shutil
import subprocess
from dataclasses import dataclass

from ode import python_peers

TITLES = {"kepler": "Kepler's orbit, e = 0.6, 100 periods", "pleiades": "Pleiades, seven stars, t = 3",
          "arenstorf": "Arenstorf's orbit, one period", "hires": "HIRES, 8 stiff reactions",
          "rober": "ROBER, Robertson's reaction to t = 1e11", "vdpol": "Van der Pol, epsilon = 1e-6, t = 2",
          "beam": "BEAM, 40 stiff segments, t = 5", "chain_1e6": "Hanging chain, 1,000 masses, k = 1e6 N/m, 10 s",
          "chain_1e8": "Hanging chain, 1,000 masses, k = 1e8 N/m, 10 s"}
ERRORS = {"hires": "largest relative error of a component at the end", "rober": "largest relative error of a component at the end",
          "beam": "largest error of 8 components at the end"}
SIDES = ("odeint", "CVODE", "scipy", "REBOUND")
DECADES = (2, 4, 6, 8, 10, 12)
MOST_OURS = 3


@dataclass
class At:
    """Least time of a side at an error, and with which solver."""
    seconds: float
    solver: str


def time_at(curve, error):
    """Least time at which the curve reaches the error; it runs from coarse to fine."""
    best = math.inf
    for k, point in enumerate(curve):
        seconds, e = point["seconds"], point["error"]
        if e > error:
            continue
        if k and curve[k - 1]["error"] > error:
            before = curve[k - 1]
            w = math.log(before["error"] / error) / math.log(before["error"] / max(e, 1e-300))
            seconds = before["seconds"] ** (1 - w) * seconds ** w
        best = min(best, seconds)
    return best


def best_by_side(curves, error, only=None):
    """{side: At} of the sides that reach the error; `only`: names of solvers."""
    best = {}
    for name, curve in curves.items():
        seconds = time_at(curve, error)
        side = curve[0]["side"]
        if (only is None or name in only) and seconds < best.get(side, At(math.inf, "")).seconds:
            best[side] = At(seconds, name)
    return best


def plot(problem, curves):
    """As ode_runner draws it: the best few of ours as lines, every peer dashed."""
    wins = {}
    for digits in (2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12):
        times = {n: time_at(c, 10.0 ** -digits) for n, c in curves.items() if c[0]["side"] == "ours"}
        for place, name in enumerate(sorted((n for n in times if times[n] < math.inf), key=times.get)[:MOST_OURS]):
            wins[name] = wins.get(name, 0) + (10, 3, 1)[place]
    chosen = sorted(wins, key=wins.get, reverse=True)[:MOST_OURS]
    names = chosen + [n for n, c in curves.items() if c[0]["side"] != "ours"]
    series = []
    for name in names:
        points = [p for p in curves[name] if 0 < p["error"] < 1]
        mine = name in chosen
        series.append({"name": f"Truestep {name}" if mine else name, "style": "line" if mine else "dashed",
                       "x": [p["error"] for p in points], "y": [p["seconds"] for p in points]})
    return {"title": TITLES[problem], "x_label": ERRORS.get(problem, "relative error at the end"),
            "y_label": "CPU time of one thread in s", "series": [s for s in series if s["x"]]}


def long_runs(build):
    """{name of the picture: plot} of the energy error over long times."""
    curves = json.loads(subprocess.run([build / "bin/bench_ode_long_run", "--series"], check=True, text=True,
                                       stdout=subprocess.PIPE).stdout)
    rebound = python_peers.rebound_solar(curves["planets"], curves["solar"][0]["x"])
    curves["solar"].append({"name": "REBOUND IAS15", **rebound})

    def drawn(series):
        peers = ("odeint", "REBOUND", "rk4")
        out = []
        for s in series:
            # An error of exactly 0 would fall off a logarithmic axis; above a tenth the orbit is another one.
            points = [(x, max(y, 1e-17)) for x, y in zip(s["x"], s["y"]) if y < 0.1]
            out.append({"name": s["name"], "style": "dashed" if s["name"].startswith(peers) else "line",
                        "x": [x for x, _ in points], "y": [y for _, y in points]})
        return out
    return {"long_run": {"title": "Kepler's orbit, e = 0.2, 240 force evaluations a period",
                         "x_label": "time in periods", "y_label": "largest relative energy error",
                         "series": drawn(curves["kepler"])},
            "long_run_solar": {"title": "Outer solar system", "x_label": "time in days",
                               "y_label": "largest relative energy error", "series": drawn(curves["solar"])}}


def goals(every):
    """(sentence, measured least ratio or None, wanted ratio, where)."""
    def least(problems, peer, errors, only=None):
        found = []
        for problem in problems:
            for error in errors:
                curves = every.get(problem, {})
                theirs, mine = best_by_side(curves, error, only).get(peer), best_by_side(curves, error).get("ours")
                if mine and theirs:
                    found.append((theirs.seconds / mine.seconds, f"{problem} at {error:.1e}".replace(".0e", "e")))
        return min(found, default=(None, "not reached by both"))

    def decades(first, last):
        return [10.0 ** -d for d in range(first, last + 1)]

    # Near 1e-12 errors are rounding; how far IAS15 gets differs by a factor of a few from run to run of its epsilon.
    ias15 = every.get("kepler", {}).get("REBOUND IAS15", [])
    finest = [min((p["error"] for p in ias15), default=1e-12)]
    smooth, small = ("kepler", "pleiades", "arenstorf"), ("vdpol", "rober", "hires")
    rows = [("non-stiff, against odeint's best, 1e-4 to 1e-8", 1, smooth, "odeint", decades(4, 8)),
            ("the same from 1e-9 to 1e-12, as far as odeint gets", 1, smooth, "odeint", decades(9, 12)),
            ("Kepler at the least error that IAS15 reaches, against it", 2.5, ("kepler",), "REBOUND", finest),
            ("Kepler from 1e-8 to 1e-11, against IAS15", 2.5, ("kepler",), "REBOUND", decades(8, 11)),
            ("small stiff, against rosenbrock4, 1e-4 to 1e-8", 1, small, "odeint", decades(4, 8)),
            ("small stiff, against CVODE, 1e-2 to 1e-12", 1, small, "CVODE", decades(2, 12)),
            ("BEAM, against CVODE, 1e-2 to 1e-8", 1, ("beam",), "CVODE", decades(2, 8)),
            ("chain k = 1e6 at 1e-6, against odeint dopri5", 3, ("chain_1e6",), "odeint", [1e-6], {"odeint dopri5"}),
            ("chain k = 1e8 at 1e-4, against CVODE's band solver", 5, ("chain_1e8",), "CVODE", [1e-4])]
    return [(text, *least(*asked), wanted) for text, wanted, *asked in rows]


def short(seconds):
    ms = 1e3 * seconds
    return f"{ms:.3f}" if ms < 1 else f"{ms:.2f}" if ms < 10 else f"{ms:.1f}" if ms < 100 else f"{ms:.0f}"


def page(facts, every):
    """The measured part of the page, in Markdown."""
    v = facts["versions"]
    lines = [f"Measured on {facts['date']} on {facts['machine']}; load average {facts['load_before']:.1f} before and "
             f"{facts['load_after']:.1f} after. Boost.odeint {v['Boost']}, SUNDIALS CVODE {v['SUNDIALS']}, scipy {v['scipy']} "
             f"(numpy {v['numpy']}, Python {v['Python']}), REBOUND {v['REBOUND']}; compiled by gcc {v['gcc']}.", "",
             "| goal | wanted | measured (least of the range) | at | met |", "| --- | --- | --- | --- | --- |"]
    for text, ratio, where, wanted in goals(every):
        measured = "-" if ratio is None else f"{ratio:.2f}x"
        met = "-" if ratio is None else "yes" if ratio >= wanted else "**no**"
        lines.append(f"| {text} | {wanted}x | {measured} | {where} | {met} |")
    for problem, curves in every.items():
        sides = [s for s in SIDES if any(c[0]["side"] == s for c in curves.values())]
        lines += ["", f"### {TITLES[problem]}", "", f"![{TITLES[problem]}](work_precision/{problem}.svg)", "",
                  "| error | Truestep, ms | " + " | ".join(f"{s}, ms (ratio)" for s in sides) + " |",
                  "| --- " * (2 + len(sides)) + "|"]
        for digits in DECADES:
            best = best_by_side(curves, 10.0 ** -digits)
            if not best:
                continue
            mine = best.get("ours")
            cells = [f"{short(mine.seconds)} {mine.solver}" if mine else "not reached"]
            for side in sides:
                theirs = best.get(side)
                ratio = f" ({theirs.seconds / mine.seconds:.2f}x)" if mine and theirs else ""
                cells.append(f"{short(theirs.seconds)} {theirs.solver.removeprefix(side + ' ')}{ratio}" if theirs else "not reached")
            lines.append(f"| 1e-{digits} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def renew_docs(docs, out):
    """Copies the pictures and puts the measured part between the page's markers."""
    pictures = docs / "work_precision"
    pictures.mkdir(exist_ok=True)
    for svg in out.glob("*.svg"):
        shutil.copy(svg, pictures / svg.name)
    text = (docs / "work_precision.md").read_text()
    before, rest = text.split("<!-- measured -->\n")
    after = rest.split("<!-- end of measured -->")[1]
    (docs / "work_precision.md").write_text(before + "<!-- measured -->\n" + (out / "measured.md").read_text() +
                                            "<!-- end of measured -->" + after)
