"""Solvers that are called from Python: scipy's solve_ivp with vectorised right-hand sides, and REBOUND's IAS15 (package
rebound, GPL, run as it is). Python's own calls dominate scipy's times on small systems; that is what its users get. The
numbers of the problems come from ode_runner, so that no value is written down twice."""
import math
import time

import numpy as np
import rebound
from scipy.integrate import solve_ivp
from scipy.linalg import solve_banded
from scipy.sparse import bmat, diags, identity

MASSES = np.arange(1.0, 8.0)
MOON = 0.012277471


def kepler(t, y):
    r2 = y[0] * y[0] + y[1] * y[1]
    w = -1 / (r2 * math.sqrt(r2))
    return [y[2], y[3], w * y[0], w * y[1]]


def pleiades(t, y):
    x, z = y[:7], y[7:14]
    dx, dz = x[None] - x[:, None], z[None] - z[:, None]
    r2 = dx * dx + dz * dz
    np.fill_diagonal(r2, 1)
    w = MASSES[None] / (r2 * np.sqrt(r2))
    np.fill_diagonal(w, 0)
    return np.concatenate([y[14:], (w * dx).sum(1), (w * dz).sum(1)])


def arenstorf(t, y):
    p, q, y2 = y[0] + MOON, y[0] - (1 - MOON), y[1] * y[1]
    r1, r2 = p * p + y2, q * q + y2
    d1, d2 = (1 - MOON) / (r1 * math.sqrt(r1)), MOON / (r2 * math.sqrt(r2))
    return [y[2], y[3], y[0] + 2 * y[3] - d1 * p - d2 * q, y[1] - 2 * y[2] - (d1 + d2) * y[1]]


def hires(t, y):
    reaction = 280 * y[5] * y[7]
    bound = reaction - 1.81 * y[6]
    return [-1.71 * y[0] + .43 * y[1] + 8.32 * y[2] + .0007, 1.71 * y[0] - 8.75 * y[1],
            -10.03 * y[2] + .43 * y[3] + .035 * y[4], 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3],
            -1.745 * y[4] + .43 * y[5] + .43 * y[6],
            -reaction + .69 * y[3] + 1.71 * y[4] - .43 * y[5] + .69 * y[6], bound, -bound]


def rober(t, y):
    a, c = -.04 * y[0] + 1e4 * y[1] * y[2], 3e7 * y[1] * y[1]
    return [a, -a - c, c]


def vdpol(t, y):
    return [y[1], ((1 - y[0] * y[0]) * y[1] - y[0]) * 1e6]


def beam(t, y):
    """theta'' = C v + D w with C w = D v + theta'^2, both tridiagonal."""
    n = 40
    x, speed = y[:n], y[n:]
    gap = np.diff(x)
    s, c = np.sin(gap), np.cos(gap)
    below, above = np.concatenate([[-x[0]], x[:-1]]), np.concatenate([x[1:], [x[-1]]])
    pull = 1.5 * math.sin(t) ** 2 if t <= math.pi else 0.0
    f = n ** 4 * (below - 2 * x + above) + n ** 2 * pull * (np.cos(x) + np.sin(x))
    diagonal = np.full(n, 2.0)
    diagonal[0], diagonal[-1] = 1, 3
    right = speed * speed
    right[:-1] += s * f[1:]
    right[1:] -= s * f[:-1]
    w = solve_banded((1, 1), np.vstack([np.concatenate([[0], -c]), diagonal, np.concatenate([-c, [0]])]), right,
                     overwrite_ab=True, check_finite=False)
    a = diagonal * f
    a[1:] -= c * f[:-1] + s * w[:-1]
    a[:-1] += s * w[1:] - c * f[1:]
    return np.concatenate([speed, a])


def chain(k, c, n=1000):
    """Right-hand side on displacement and velocity beside one another, and the constant Jacobian."""
    links = diags([np.ones(n - 1), np.append(np.full(n - 1, -2.0), -1.0), np.ones(n - 1)], [-1, 0, 1])
    halves = bmat([[None, identity(n)], [k * links, c * links]]).tocsc()
    order = np.arange(2 * n).reshape(2, n).T.ravel()  # of the halves, as they stand in the pairs

    def rate(t, y):
        x, v = y[0::2], y[1::2]
        left = k * (x - np.concatenate([[0], x[:-1]])) + c * (v - np.concatenate([[0], v[:-1]]))
        d = np.empty_like(y)
        d[0::2] = v
        d[1::2] = np.concatenate([left[1:], [0]]) - left - 9.81
        return d

    return rate, halves[order][:, order].tocsc(), order


RATES = {f.__name__: f for f in (kepler, pleiades, arenstorf, hires, rober, vdpol, beam)}
# Tolerances 10^-from ... 10^-to; the coarse ones of LSODA and RK45 stray, the fine ones last minutes.
SCIPY = {"kepler": {"RK45": (5, 8), "DOP853": (4, 13), "LSODA": (5, 13)},
         "pleiades": {"RK45": (3, 9), "DOP853": (3, 12), "LSODA": (3, 12)},
         "arenstorf": {"RK45": (4, 9), "DOP853": (4, 12), "LSODA": (5, 12)},
         "hires": {"Radau": (2, 11), "BDF": (3, 8), "LSODA": (3, 12)},
         "rober": {"Radau": (2, 11), "BDF": (3, 8), "LSODA": (3, 12)},
         "vdpol": {"Radau": (2, 10), "BDF": (3, 7), "LSODA": (3, 12)},
         "beam": {"Radau": (2, 5), "LSODA": (4, 7)},
         "chain_1e6": {"LSODA": (3, 7), "Radau": (3, 6)},
         "chain_1e8": {"LSODA": (3, 6), "Radau": (3, 6)}}


def scipy_solvers(case):
    """Of a problem as ode_runner describes it: [{name, side, from, to, run: digits -> (seconds, end, evaluations)}]."""
    name, start = case["name"], np.array(case["start"])
    options, order = {}, None
    if name.startswith("chain"):
        rate, jacobian, order = chain(case["k"], case["c"])
        start = start[order]
        options = {"LSODA": {"lband": 3, "uband": 3}, "Radau": {"jac": jacobian}}
    else:
        rate = RATES[name]

    def run(method, digits):
        before = time.thread_time()
        s = solve_ivp(rate, (0, case["t_end"]), start, method=method, rtol=10.0 ** -digits,
                      atol=10.0 ** -digits * case["absolute_scale"], **options.get(method, {}))
        seconds = time.thread_time() - before
        if not s.success:
            return seconds, None, s.nfev
        end = s.y[:, -1]
        if order is not None:
            straight = np.empty_like(end)
            straight[order] = end
            end = straight
        return seconds, end.tolist(), s.nfev

    return [{"name": f"scipy {method}", "side": "scipy", "from": a, "to": b,
             "run": lambda digits, method=method: run(method, digits)} for method, (a, b) in SCIPY[name].items()]


def ias15(simulation, epsilon):
    simulation.integrator = "ias15"
    settings = simulation.ri_ias15 if hasattr(simulation, "ri_ias15") else simulation.integrator
    settings.epsilon = epsilon


def rebound_kepler(y):
    simulation = rebound.Simulation()
    simulation.add(m=1)
    simulation.add(m=0, x=y[0], y=y[1], vx=y[2], vy=y[3])

    def end(p):
        return [p[1].x - p[0].x, p[1].y - p[0].y, p[1].vx - p[0].vx, p[1].vy - p[0].vy]
    return simulation, end


def rebound_pleiades(y):
    simulation = rebound.Simulation()
    for i in range(7):
        simulation.add(m=i + 1.0, x=y[i], y=y[7 + i], vx=y[14 + i], vy=y[21 + i])

    def end(p):
        return [getattr(q, name) for name in ("x", "y", "vx", "vy") for q in p]
    return simulation, end


def rebound_arenstorf(y):
    """In the frame at rest: earth and moon circle, the satellite has no mass."""
    simulation = rebound.Simulation()
    simulation.add(m=1 - MOON, x=-MOON, vy=-MOON)
    simulation.add(m=MOON, x=1 - MOON, vy=1 - MOON)
    simulation.add(m=0, x=y[0], y=y[1], vx=y[2] - y[1], vy=y[3] + y[0])

    def end(p):
        c, s = math.cos(simulation.t), math.sin(simulation.t)
        x, z = c * p[2].x + s * p[2].y, c * p[2].y - s * p[2].x
        return [x, z, c * p[2].vx + s * p[2].vy + z, c * p[2].vy - s * p[2].vx - x]
    return simulation, end


REBOUND = {"kepler": rebound_kepler, "pleiades": rebound_pleiades, "arenstorf": rebound_arenstorf}


def rebound_solvers(case):
    """IAS15 with its accuracy parameter epsilon at 10^-digits, the fastest of what fits into 20 ms."""
    if case["name"] not in REBOUND:
        return []

    def run(digits):
        best, spent = math.inf, 0.0
        while spent < 0.02:
            simulation, end = REBOUND[case["name"]](case["start"])
            ias15(simulation, 10.0 ** -digits)
            before = time.thread_time()
            simulation.integrate(case["t_end"], exact_finish_time=1)
            seconds = time.thread_time() - before
            best, spent = min(best, seconds), spent + seconds
        return best, end(simulation.particles), None

    return [{"name": "REBOUND IAS15", "side": "REBOUND", "from": 3, "to": 12, "run": run}]


def rebound_solar(case, days):
    """{x, y}: the largest relative energy error of IAS15 on the outer solar system within each interval that ends at one
    of the given days."""
    g, masses, start = case["g"], case["masses"], case["start"]
    simulation = rebound.Simulation()
    simulation.G = g
    n = len(masses)
    for i, mass in enumerate(masses):
        x, v = start[3 * i:3 * i + 3], start[3 * (n + i):3 * (n + i) + 3]
        simulation.add(m=mass, x=x[0], y=x[1], z=x[2], vx=v[0], vy=v[1], vz=v[2])
    ias15(simulation, 1e-9)

    def energy():
        total = np.longdouble(0)
        at = [np.array([p.x, p.y, p.z], dtype=np.longdouble) for p in simulation.particles]
        for i, p in enumerate(simulation.particles):
            speed = np.array([p.vx, p.vy, p.vz], dtype=np.longdouble)
            total += np.longdouble(masses[i]) / 2 * (speed @ speed)
            for j in range(i + 1, n):
                d = at[j] - at[i]
                total -= np.longdouble(g) * masses[i] * masses[j] / np.sqrt(d @ d)
        return total

    before, begin, y = energy(), 0.0, []
    for end in days:
        worst = 0.0
        for k in range(1, 21):
            simulation.integrate(begin + (end - begin) * k / 20, exact_finish_time=1)
            worst = max(worst, float(abs(energy() / before - 1)))
        y.append(worst)
        begin = end
    return {"x": days, "y": y}
