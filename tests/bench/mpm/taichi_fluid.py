"""The peer's side of mpm.py: a cube of fluid (MLS-MPM, quadratic splines, p = E (J - 1)) in free fall on Taichi's CPU backend.

taichi_fluid.py FILE DIMENSION CELLS STEPS THREADS; FILE holds n x 3 floats, where the particles are. Prints one JSON line.
"""
import json
import resource
import sys
import time

import numpy
import taichi as ti

FILE, D, CELLS, STEPS, THREADS = sys.argv[1], *map(int, sys.argv[2:6])
ti.init(arch=ti.cpu, cpu_max_num_threads=THREADS, default_fp=ti.f32, log_level=ti.ERROR, offline_cache=False)
places = numpy.fromfile(FILE, numpy.float32).reshape(-1, 3)[:, :D]
N, DX = len(places), 1 / CELLS
H, MODULUS, VOLUME, GRAVITY, MARGIN = 2e-4 * 128 * DX, 400.0, (DX / 2) ** D, 9.8, 3

x = ti.Vector.field(D, ti.f32, N)
v = ti.Vector.field(D, ti.f32, N)
C = ti.Matrix.field(D, D, ti.f32, N)
J = ti.field(ti.f32, N)
momentum = ti.Vector.field(D, ti.f32, (CELLS,) * D)
mass = ti.field(ti.f32, (CELLS,) * D)


@ti.func
def splines(f):
    return [0.5 * (1.5 - f) ** 2, 0.75 - (f - 1) ** 2, 0.5 * (f - 0.5) ** 2]


@ti.kernel
def to_grid():
    for I in ti.grouped(mass):
        momentum[I] = ti.zero(momentum[I])
        mass[I] = 0.0
    for p in x:
        base = ti.cast(x[p] / DX - 0.5, ti.i32)
        f = x[p] / DX - base
        w = splines(f)
        A = VOLUME * C[p] - H * 4 / DX**2 * VOLUME * MODULUS * (J[p] - 1) * ti.Matrix.identity(ti.f32, D)
        for o in ti.static(ti.grouped(ti.ndrange(*((3,) * D)))):
            weight = 1.0
            for a in ti.static(range(D)):
                weight *= w[o[a]][a]
            momentum[base + o] += weight * (VOLUME * v[p] + A @ ((o - f) * DX))
            mass[base + o] += weight * VOLUME


@ti.kernel
def on_grid():
    for I in ti.grouped(mass):
        if mass[I] > 0:
            momentum[I] /= mass[I]
        momentum[I][1] -= H * GRAVITY
        for a in ti.static(range(D)):
            if I[a] < MARGIN and momentum[I][a] < 0:
                momentum[I][a] = 0
            if I[a] > CELLS - MARGIN and momentum[I][a] > 0:
                momentum[I][a] = 0


@ti.kernel
def from_grid():
    for p in x:
        base = ti.cast(x[p] / DX - 0.5, ti.i32)
        f = x[p] / DX - base
        w = splines(f)
        u = ti.zero(v[p])
        B = ti.zero(C[p])
        for o in ti.static(ti.grouped(ti.ndrange(*((3,) * D)))):
            weight = 1.0
            for a in ti.static(range(D)):
                weight *= w[o[a]][a]
            n = momentum[base + o]
            u += weight * n
            B += 4 / DX * weight * n.outer_product(o - f)
        v[p] = u
        x[p] += H * u
        J[p] *= 1 + H * B.trace()
        C[p] = B


def run(steps):
    for _ in range(steps):
        to_grid()
        on_grid()
        from_grid()
    ti.sync()


x.from_numpy(places)
J.fill(1.0)
run(20)
before = v.to_numpy()[:, 1].astype(float).mean()
cpu, wall = time.process_time(), time.perf_counter()
run(STEPS)
cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
fall = v.to_numpy()[:, 1].astype(float).mean() - before
print(json.dumps({"particles": N, "cpu": cpu, "wall": wall, "substeps": STEPS, "fall_error": fall + GRAVITY * H * STEPS,
                  "megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, "version": ".".join(map(str, ti.__version__))}))
