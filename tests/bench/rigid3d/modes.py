"""Modes of what stands: the contact solver's substep as a linear map, and how fast its modes grow or decay.

    python3 tests/bench/rigid3d/modes.py wall 6 | tower 20 | pyramid 4  [--share 0.2] [--damping 30]
                                         [--tilt-share 0.2] [--tilt-damping 30] [--normal-only]

Unit cubes on one another, every contact a patch that sticks: six rows (n, two tangents, turns about them) in
one block. The state is (positions, velocities, impulses that the next substep starts from). A substep:
velocities take up gravity's moments of the tilted bodies and the impulses; a push over all blocks in turn,
softened in the rows n and both tilts; positions; a relaxation over all blocks. Substeps go there, back,
there, back, there, as in a step. Prints the largest growth rates (1/s) with their frequencies (rad/s); modes
that slide as a whole are neutral and left out. docs/standing.md says what comes out. Needs numpy.
"""
import argparse

import numpy as np

GRAVITY, SUBSTEP, SUBSTEPS = 9.81, 1 / 300, 5
NORMAL_ROWS, TANGENT_ROWS = [0, 4, 5], [1, 2, 3]


def tower(n):
    return [(0, 0, 0.5 + k) for k in range(n)], [(k - 1, k, (0, 0, k)) for k in range(n)]


def courses(n, deep, gap):
    """Course k has n - k bodies along x (and along y where `deep`), each on two (four) of the one below."""
    at, places, contacts = {}, [], []
    for k in range(n):
        for i in range(n - k):
            for j in range(n - k if deep else 1):
                middle = (n - k - 1) / 2
                at[k, i, j] = len(places)
                places.append(((i - middle) * gap, (j - middle) * gap if deep else 0, 0.5 + k))
                below = [(k - 1, i + a, j + b) for a in (0, 1) for b in ((0, 1) if deep else (0,))] if k else []
                b = at[k, i, j]
                if not below:
                    contacts.append((-1, b, (places[b][0], places[b][1], 0)))
                for key in below:
                    a = at[key]
                    contacts.append((a, b, tuple((np.array(places[a]) + places[b])[:2] / 2) + (k,)))
    return places, contacts


def soft(share, damping):
    """bias_rate h and impulse_scale of soft_constraint.h."""
    hw = 2 * np.pi * share
    b = 2 * damping + hw
    return hw / b, 1 / (1 + hw * b)


def cross_matrix(r):
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])


class Structure:
    def __init__(self, places, contacts):
        places = np.array(places, float)
        bodies, self.contacts = len(places), len(contacts)
        mass = np.tile([1, 1, 1] + 3 * [np.sqrt(6)], bodies)  # 1 / sqrt(mass, moment)
        J = np.zeros((6 * self.contacts, 6 * bodies))
        n, t, u = np.eye(3)[[2, 0, 1]]
        for k, (a, b, c) in enumerate(contacts):
            for body, sign in ((a, -1), (b, 1)):
                if body < 0:
                    continue
                r = np.array(c) - places[body]
                for e, axis in enumerate((n, t, u)):
                    J[6 * k + e, 6 * body : 6 * body + 3] = sign * axis
                    J[6 * k + e, 6 * body + 3 : 6 * body + 6] = sign * np.cross(r, axis)
                    J[6 * k + 3 + e, 6 * body + 3 : 6 * body + 6] = sign * axis
        self.J = J * mass
        weight = np.zeros(6 * bodies)
        weight[2::6] = -GRAVITY
        loads = np.linalg.lstsq(self.J.T, -weight, rcond=None)[0]
        # A body that turns by theta takes its contacts along: moments (theta x r) x F.
        self.tilting = np.zeros((6 * bodies, 6 * bodies))
        for k, (a, b, c) in enumerate(contacts):
            force = loads[6 * k] * n + loads[6 * k + 1] * t + loads[6 * k + 2] * u
            for body, sign in ((a, -1), (b, 1)):
                if body >= 0:
                    rows = slice(6 * body + 3, 6 * body + 6)
                    moment = cross_matrix(force) @ cross_matrix(np.array(c) - places[body])
                    self.tilting[rows, rows] += 6 * sign * moment
        self.A = self.J @ self.J.T
        self.block_inverse = np.zeros_like(self.A)
        for k in range(self.contacts):
            rows = slice(6 * k, 6 * k + 6)
            self.block_inverse[rows, rows] = np.linalg.inv(self.A[rows, rows])
        place = np.repeat(self.colours(bodies, contacts), 6)
        before = place[None, :] < place[:, None]
        self.earlier = {"forth": np.where(before, self.A, 0), "back": np.where(before.T, self.A, 0)}

    @staticmethod
    def colours(bodies, contacts):
        """Place of every contact in a sweep: greedy colours, contacts with the ground last."""
        used, colour = [0] * bodies, {}
        listed = sorted(range(len(contacts)), key=lambda k: contacts[k][0] < 0)
        for k in listed:
            ends = [i for i in contacts[k][:2] if i >= 0]
            taken = 0
            for i in ends:
                taken |= used[i]
            c = 0
            while taken >> c & 1:
                c += 1
            colour[k] = c
            for i in ends:
                used[i] |= 1 << c
        place = np.empty(len(contacts), int)
        place[sorted(listed, key=lambda k: colour[k])] = np.arange(len(contacts))
        return place

    def substep(self, order, normal, tilt, normal_only):
        """Matrix of a substep; `normal_only`: friction does not answer what softness changes."""
        rows, columns = self.J.shape
        size = 2 * columns + rows
        x, v, l = np.split(np.eye(size), [columns, 2 * columns])
        v = v + SUBSTEP * self.tilting @ x + self.J.T @ l
        leak = np.array([normal[1], tilt[1], tilt[1]])
        solve, keep, bias = np.zeros((rows, rows)), np.zeros((rows, rows)), np.zeros(rows)
        bias[0::6], bias[4::6], bias[5::6] = normal[0] / SUBSTEP, tilt[0] / SUBSTEP, tilt[0] / SUBSTEP
        N, T = NORMAL_ROWS, TANGENT_ROWS
        for k in range(self.contacts):
            at = slice(6 * k, 6 * k + 6)
            P = self.block_inverse[at, at]
            follow = 0 if normal_only else P[np.ix_(T, N)] @ np.linalg.inv(P[np.ix_(N, N)])
            block, lost = P.copy(), np.zeros((6, 6))
            block[N] *= (1 - leak)[:, None]
            lost[np.ix_(N, N)] = np.diag(leak)
            if not normal_only:
                block[T] -= follow @ (leak[:, None] * P[N])
                lost[np.ix_(T, N)] = follow * leak
            solve[at, at], keep[at, at] = block, lost
        earlier, one = self.earlier[order], np.eye(rows)
        slip = self.J @ v + bias[:, None] * (self.J @ x)
        added = np.linalg.solve(one + solve @ earlier, -solve @ slip - keep @ l)
        v, l = v + self.J.T @ added, l + added
        x = x + SUBSTEP * v
        P = self.block_inverse
        added = np.linalg.solve(one + P @ earlier, -P @ (self.J @ v))
        return np.vstack([x, v + self.J.T @ added, l + added])

    def rates(self, normal, tilt, normal_only):
        forth, back = (self.substep(o, normal, tilt, normal_only) for o in ("forth", "back"))
        step = np.eye(forth.shape[0])
        for k in range(SUBSTEPS):
            step = (forth if k % 2 == 0 else back) @ step
        values = np.linalg.eigvals(step).astype(complex)
        rates = np.log(values + 1e-300) / (SUBSTEPS * SUBSTEP)
        rates = rates[(np.abs(rates) > 2e-4) & (rates.imag >= 0)]
        return rates[np.argsort(-rates.real)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("structure", choices=("tower", "wall", "pyramid"))
    parser.add_argument("count", type=int)
    for name, default in (("share", 0.2), ("damping", 30), ("tilt-share", 0.2), ("tilt-damping", 30)):
        parser.add_argument("--" + name, type=float, default=default)
    parser.add_argument("--normal-only", action="store_true")
    a = parser.parse_args()
    shape = tower(a.count) if a.structure == "tower" else courses(a.count, a.structure == "pyramid",
                                                                 1.05 if a.structure == "pyramid" else 1.01)
    normal, tilt = soft(a.share, a.damping), soft(a.tilt_share, a.tilt_damping)
    rates = Structure(*shape).rates(normal, tilt, a.normal_only)
    print(a.structure, a.count, " ".join(f"{r.real:+.3f}{'' if r.imag < 1e-6 else f'~{r.imag:.1f}'}" for r in rates[:8]))


if __name__ == "__main__":
    main()
