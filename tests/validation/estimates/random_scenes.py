"""Estimates of a step's time against what random scenes take.

    python3 random_scenes.py ESTIMATES [--scenes N] [--first SEED] [--family NAME] [--seconds S] [--worst N]

ESTIMATES is the program built from main.cc beside this file. For each family of scenes a line: how many ran, and the quantiles of
estimated / measured CPU seconds of a step, from counts alone and once the systems are built, and of all that was run; then the worst scenes. A scene belongs to
a family and a seed. Judged by a person: time depends on the machine.
"""
import argparse
import json
import math
import random
import subprocess


def spread(r, low, high):
    return low * (high / low) ** r.random()


def whole(r, low, high):
    return round(spread(r, low, high))


def scene(system, r, dt=None, **more):
    return {"schema_version": "1.0", "time": {"dt": dt or r.choice([1 / 240, 1 / 60, 1 / 60, 1 / 30]), "duration": 2}, "systems": [system], **more}


def mpm(r):
    plane = r.random() < 0.6
    cell = spread(r, 0.008, 0.06) if plane else spread(r, 0.03, 0.1)
    body = {"shape": r.choice(["box", "ball"]), "center": [0.5, r.uniform(0.3, 0.7), 0 if plane else 0.5],
            "half_extents": [r.uniform(0.05, 0.4) for _ in range(3)], "radius": r.uniform(0.05, 0.25),
            "velocity": [r.uniform(-2, 2), r.uniform(-5, 0), 0], "material": r.choice(["fluid", "corotated", "neo_hookean", "snow", "sand", "foam"]),
            "density": spread(r, 100, 3000), "youngs_modulus": spread(r, 1e3, 1e7), "bulk_modulus": spread(r, 1e3, 1e7)}
    system = {"type": "mpm", "id": "m", "dimension": 2 if plane else 3, "cell": cell, "bodies": [body], "particles_per_axis": r.choice([2, 2, 3]),
              "splines": r.choice(["quadratic", "quadratic", "cubic"]), "precision": r.choice(["f32", "f64"])}
    if r.random() < 0.25:
        system["integration"] = "implicit"
    return scene(system, r, r.choice([1e-5, 1e-4, 1e-3, 1 / 240, 1 / 60, 1 / 30]))


def sph(r):
    plane = r.random() < 0.5
    spacing = spread(r, 0.01, 0.04) if plane else spread(r, 0.03, 0.07)
    box = [r.uniform(0.15, 0.5) for _ in range(3)]
    system = {"type": "sph", "id": "s", "dimension": 2 if plane else 3, "spacing": spacing,
              "bodies": [{"half_extents": box, "center": [box[0], box[1], 0 if plane else box[2]], "velocity": [r.uniform(-1, 1), r.uniform(-3, 0), 0]}],
              "solver": r.choice(["dfsph", "dfsph", "wcsph", "pbf"]), "precision": r.choice(["f32", "f64"])}
    if r.random() < 0.2:
        system["viscosity"] = spread(r, 1e-4, 1)
        system["viscosity_step"] = r.choice(["explicit", "implicit", "weiler2018"])
    if r.random() < 0.2:
        system["surface_tension"] = spread(r, 0.01, 1)
    if r.random() < 0.2:
        system["support"] = r.choice([2, 2.5, 3])
    return scene(system, r, r.choice([1e-4, 1e-3, 1 / 240, 1 / 60, 1 / 30]))


def heat(r):
    axes = r.choice([1, 2, 2, 3])
    cells = [whole(r, 8, {1: 2000, 2: 160, 3: 40}[axes]) for _ in range(axes)]
    system = {"type": "heat", "id": "h", "cells": cells, "size": [spread(r, 0.1, 2) for _ in cells], "diffusivity": spread(r, 1e-6, 0.1),
              "initial": "exp(-20*((x-0.5)^2))"}
    method = r.choice(["", "", "rk4", "explicit_euler", "implicit_euler", "crank_nicolson", "bdf2", "rkc2", "dormand_prince", "radau5"])
    if method:
        system["integrator"] = method
    if r.random() < 0.3:
        system["source"] = "sin(3*x)*t"
    return scene(system, r, spread(r, 1e-4, 0.1))


def wave(r):
    axes = r.choice([1, 2, 2, 3])
    cells = [whole(r, 8, {1: 2000, 2: 160, 3: 40}[axes]) for _ in range(axes)]
    return scene({"type": "wave", "id": "w", "cells": cells, "speed": spread(r, 0.1, 10), "initial": "exp(-20*((x-0.5)^2))"}, r, spread(r, 1e-4, 0.03))


def shallow(r):
    axes = r.choice([1, 2, 2])
    cells = [whole(r, 16, 3000 if axes == 1 else 250) for _ in range(axes)]
    size = [spread(r, 1, 1000) for _ in cells]
    deep = spread(r, 0.05, 10)
    return scene({"type": "heightfield_wave", "id": "w", "cells": cells, "size": size, "bed": "%g" % -deep,
                  "surface": "%g*exp(-%g*(x-%g)^2)" % (deep * r.uniform(0.05, 0.6), 30 / size[0] ** 2, size[0] / 2)},
                 r, spread(r, 1e-3, 0.2), gravity=[0, 0, -9.81])


def fem(r):
    plane = r.random() < 0.4
    if plane:
        shape = {"quad": {"corners": [[0, 0, 0], [2, 0, 0], [2, 0.5, 0], [0, 0.5, 0]], "cells_x": whole(r, 4, 60), "cells_y": whole(r, 2, 20)}}
        element = r.choice(["auto", "tri3", "tri6", "quad4", "quad9"])
    else:
        shape = {"block": {"size": [2, 0.5, 0.5], "cells_x": whole(r, 4, 24), "cells_y": whole(r, 2, 6), "cells_z": whole(r, 2, 6)}}
        element = r.choice(["auto", "tet4", "tet10", "hex8", "hex27"])
    system = {"type": "fem", "id": "f", **shape, "element": element, "youngs_modulus": spread(r, 1e4, 1e9), "density": spread(r, 100, 8000),
              "material": r.choice(["linear", "corotated", "st_venant_kirchhoff", "neo_hookean", "stable_neo_hookean"]), "pinned": ["x0"]}
    method = r.choice(["", "", "implicit_euler", "newmark", "velocity_verlet", "bdf2", "vertex_block_descent"])
    if method:
        system["integrator"] = method
    if r.random() < 0.1:
        system["motion"] = "quasi_static"
        system.pop("integrator", None)
    return scene(system, r, r.choice([1e-5, 1e-4, 1e-3, 1 / 240, 1 / 60]))


def rope(r, name, x):
    return {"type": "mass_spring", "id": name, "rope": {"from": [x, 1, 0], "to": [x + 1, 1, 0], "links": whole(r, 2, 60)},
            "mass": spread(r, 0.001, 0.1), "stiffness": spread(r, 10, 1e6), "pinned": ["first"]}


def attachment(r):
    a = rope(r, "a", 0)
    kind = r.choice(["mass_spring", "rigid3d", "fem", "xpbd"])
    if kind == "mass_spring":
        b = {**rope(r, "b", 1.2), "pinned": []}
    elif kind == "rigid3d":
        b = {"type": "rigid3d", "id": "b", "bodies": [{"type": "box", "position": [1.5, 1, 0], "half_extents": [0.2, 0.2, 0.2], "mass": spread(r, 0.1, 1000)}]}
    elif kind == "fem":
        b = {"type": "fem", "id": "b", "block": {"origin": [1.2, 0.8, 0], "size": [0.4, 0.4, 0.4], "cells_x": 3, "cells_y": 3, "cells_z": 3},
             "youngs_modulus": spread(r, 1e4, 1e7)}
    else:
        b = {"type": "xpbd", "id": "b", "cloth_grid": {"origin": [1.2, 1, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": 8, "ny": 8}, "mass": 0.01}
    c = {"type": "attachment", "id": "c", "a": "a", "b": "b", "a_points": [-1], "b_points": [0], "link": r.choice(["spring", "rigid"])}
    if c["link"] == "spring":
        c["stiffness"] = spread(r, 10, 1e7)
        c["damping"] = r.choice([0, 1])
    return {"schema_version": "1.0", "time": {"dt": r.choice([1 / 240, 1 / 60, 1 / 30]), "duration": 2}, "systems": [a, b], "couplings": [c]}


def contact(r):
    n = whole(r, 6, 40)
    cloth = {"cloth_grid": {"origin": [-0.5, 0, -0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1], "nx": n, "ny": n}, "mass": spread(r, 1e-4, 0.1),
             "thickness": 0.02, "pinned": ["corners"], "stiffness": spread(r, 100, 1e5), "type": r.choice(["xpbd", "mass_spring"]), "id": "a"}
    balls = [{"type": "sphere", "radius": 0.1, "position": [r.uniform(-0.3, 0.3), 0.3 + 0.25 * k, r.uniform(-0.3, 0.3)], "mass": spread(r, 0.1, 10)}
             for k in range(whole(r, 1, 10))]
    return {"schema_version": "1.0", "time": {"dt": r.choice([1 / 240, 1 / 60, 1 / 30]), "duration": 2},
            "systems": [cloth, {"type": "rigid3d", "id": "b", "bodies": balls}], "couplings": [{"type": "contact", "id": "c", "a": "a", "b": "b"}]}


def flow(r, **more):
    plane = r.random() < 0.7
    cells = [whole(r, 16, 128 if plane else 32) for _ in range(2 if plane else 3)]
    still = ["0"] * len(cells)
    return {"type": "grid_fluid", "id": "g", "cells": cells, "viscosity": spread(r, 1e-4, 0.1),
            "sides": {"y_max": {"kind": "wall", "velocity": ["1"] + still[1:]}}, **more}


def steady_flow(r):
    n = whole(r, 12, 72)
    return scene({"type": "grid_fluid", "id": "g", "cells": [n, whole(r, 12, 72)], "viscosity": 1 / spread(r, 1, 2000), "stepping": "steady",
                  "sides": {"y_max": {"kind": "wall", "velocity": ["1", "0"]}}}, r)


def moving_flow(r):
    system = flow(r, advection=r.choice(["central", "semi_lagrangian", "maccormack", "bfecc"]))
    if r.random() < 0.3:
        system["obstacles"] = [{"center": [0.5, 0.5, 0.5 if len(system["cells"]) == 3 else 0], "radius": 0.15}]
    if r.random() < 0.3:
        system["scalar"] = {"initial": "y", "diffusivity": 1e-4}
    return scene(system, r)


def liquid(r):
    plane = r.random() < 0.6
    n = whole(r, 16, 96) if plane else whole(r, 10, 28)
    return scene({"type": "grid_fluid", "id": "g", "cells": [n] * (2 if plane else 3), "advection": r.choice(["flip", "apic"]),
                  "bodies": [{"shape": "box", "center": [0.3, 0.3, 0 if plane else 0.5], "half_extents": [0.25, 0.28, 0.4]}]}, r)


FAMILIES = {f.__name__: f for f in (mpm, sph, heat, wave, shallow, fem, attachment, contact, steady_flow, moving_flow, liquid)}


def quantiles(ratios):
    ordered = sorted(ratios)
    at = lambda q: ordered[min(len(ordered) - 1, int(q * len(ordered)))]
    return "%8.2g %8.2g %8.2g %8.2g %8.2g" % (ordered[0], at(0.1), at(0.5), at(0.9), ordered[-1])


def main():
    options = argparse.ArgumentParser()
    options.add_argument("program")
    options.add_argument("--scenes", type=int, default=30)
    options.add_argument("--first", type=int, default=0)
    options.add_argument("--family", default="")
    options.add_argument("--seconds", type=float, default=0.3)
    options.add_argument("--worst", type=int, default=0)
    options.add_argument("--print", action="store_true", help="prints the scenes instead")
    given = options.parse_args()
    families = {n: f for n, f in FAMILIES.items() if n.startswith(given.family)}
    documents = [(n, seed, f(random.Random("%s %d" % (n, seed)))) for n, f in families.items() for seed in range(given.first, given.first + given.scenes)]
    if given.print:
        for _, _, d in documents:
            print(json.dumps(d))
        return
    program = subprocess.Popen([given.program, "--read", "--seconds", str(given.seconds)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, text=True)
    rows, missing = {n: [] for n in families}, dict.fromkeys(families, 0)
    for name, seed, document in documents:
        program.stdin.write(json.dumps(document) + "\n")
        program.stdin.flush()
        figures = json.loads(program.stdout.readline())
        if figures:
            rows[name].append((seed, figures))
        else:
            missing[name] += 1
    program.stdin.close()
    program.wait()
    print("estimated / measured seconds of a step: smallest, a tenth, median, nine tenths, largest")
    within = total = 0
    for name, found in rows.items():
        if not found:
            continue
        for key in ("estimated_seconds", "built_seconds"):
            ratios = [f[key] / f["seconds"] for _, f in found]
            near = sum(1 / 3 <= q <= 3 for q in ratios)
            print("%-12s %-9s %3d ran, %2d refused or failed: %s, within a factor of 3: %3.0f %%" %
                  (name, "counts" if key[0] == "e" else "built", len(found), missing[name], quantiles(ratios), 100 * near / len(ratios)))
        within, total = within + near, total + len(found)
        long = [(f["estimated_start_seconds"] + f["steps"] * f["built_seconds"]) / (f["start_seconds"] + f["steps"] * f["seconds"])
                for _, f in found if f["start_seconds"] + f["steps"] * f["seconds"] > 0.1]
        if long:
            print("    from the start, %d that take longer than 0.1 s: %s, %d beyond a factor of 3" %
                  (len(long), quantiles(long), sum(not 1 / 3 <= q <= 3 for q in long)))
        begins = [f["start_seconds"] for _, f in found]
        short = sum(f["start_seconds"] > 0.1 and f["estimated_start_seconds"] < f["start_seconds"] / 3 for _, f in found)
        print("    started in %.3g s at most; %d take longer than 0.1 s and three times their estimate" % (max(begins), short))
        off = sorted(found, key=lambda row: -abs(math.log(row[1]["built_seconds"] / row[1]["seconds"])))
        for seed, f in off[:given.worst]:
            print("    %s %d: counts %.3g s, built %.3g s, measured %.3g s (%d steps)" %
                  (name, seed, f["estimated_seconds"], f["built_seconds"], f["seconds"], f["steps"]))
    print("all: %d of %d within a factor of 3" % (within, total))


if __name__ == "__main__":
    main()
