// Small simulations in JavaScript for the mock server: enough motion to draw, drag and test against.
// Every one has step(dt), topology() and fields() in the terms of stream.proto.

/** Points joined by distance constraints, position-based (Mueller et al. 2007, 3.3), with wind and a sphere. */
export class Cloth {
  constructor(n, { size = 2, iterations = 12 } = {}) {
    Object.assign(this, { n, size, iterations, system: "cloth", drags: new Map() });
    this.reset();
  }

  reset() {
    const { n, size } = this;
    this.x = new Float32Array(n * n * 3);
    this.v = new Float32Array(n * n * 3);
    this.w = new Float32Array(n * n).fill(1);
    for (let j = 0; j < n; ++j) {
      for (let i = 0; i < n; ++i) {
        const k = 3 * (j * n + i);
        this.x[k] = (i / (n - 1) - 0.5) * size;
        this.x[k + 1] = 2.3;
        this.x[k + 2] = (j / (n - 1) - 0.15) * size;
      }
    }
    this.w[0] = this.w[n - 1] = 0;
    const pairs = [];
    const kinds = [];
    const add = (a, b, kind) => (pairs.push(a, b), kinds.push(kind));
    for (let j = 0; j < n; ++j) {
      for (let i = 0; i < n; ++i) {
        const k = j * n + i;
        if (i + 1 < n) add(k, k + 1, 0);
        if (j + 1 < n) add(k, k + n, 0);
        if (i + 1 < n && j + 1 < n) add(k, k + n + 1, 1), add(k + 1, k + n, 1);
      }
    }
    this.pairs = Uint32Array.from(pairs);
    this.kinds = Uint8Array.from(kinds);
    this.rest = Float32Array.from({ length: kinds.length }, (_, s) => this.distance(pairs[2 * s], pairs[2 * s + 1]));
    this.time = 0;
    this.drags.clear();
  }

  distance(a, b) {
    const { x } = this;
    return Math.hypot(x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]);
  }

  step(dt) {
    const { x, v, w, pairs, rest } = this;
    const old = x.slice();
    this.time += dt;
    const wind = 2.2 * Math.sin(1.7 * this.time) + 1;
    for (let k = 0; k < w.length; ++k) {
      if (w[k] === 0) continue;
      v[3 * k + 1] -= 9.81 * dt;
      v[3 * k + 2] += wind * dt;
      for (let c = 0; c < 3; ++c) x[3 * k + c] += v[3 * k + c] * dt;
    }
    for (const [k, target] of this.drags) for (let c = 0; c < 3; ++c) x[3 * k + c] += 0.5 * (target[c] - x[3 * k + c]);
    for (let it = 0; it < this.iterations; ++it) {
      for (let s = 0; s < rest.length; ++s) {
        const a = pairs[2 * s];
        const b = pairs[2 * s + 1];
        const sum = w[a] + w[b];
        if (sum === 0) continue;
        const length = this.distance(a, b);
        const lambda = (length - rest[s]) / (length * sum);
        for (let c = 0; c < 3; ++c) {
          const d = x[3 * b + c] - x[3 * a + c];
          x[3 * a + c] += w[a] * lambda * d;
          x[3 * b + c] -= w[b] * lambda * d;
        }
      }
    }
    for (let k = 0; k < w.length; ++k) {
      const d = [x[3 * k], x[3 * k + 1] - 0.6, x[3 * k + 2] - 0.2];
      const r = Math.hypot(...d);
      if (w[k] && r < 0.53) for (let c = 0; c < 3; ++c) x[3 * k + c] += (d[c] / r) * (0.53 - r);
      if (x[3 * k + 1] < 0.01) x[3 * k + 1] = 0.01;
      for (let c = 0; c < 3; ++c) v[3 * k + c] = w[k] ? ((x[3 * k + c] - old[3 * k + c]) / dt) * 0.998 : 0;
    }
  }

  command(body) {
    if (body.type === "drag") this.drags.set(body.index, body.target);
    else if (body.type === "release") this.drags.delete(body.index);
    else if (body.type === "pin") this.w[body.index] = 0;
    else if (body.type === "unpin") this.w[body.index] = 1;
  }

  topology() {
    const { n } = this;
    const triangles = [];
    for (let j = 0; j + 1 < n; ++j) {
      for (let i = 0; i + 1 < n; ++i) {
        const k = j * n + i;
        triangles.push(k, k + n, k + 1, k + 1, k + n, k + n + 1);
      }
    }
    return {
      systems: [
        {
          system: this.system,
          lines: new Uint8Array(this.pairs.buffer),
          triangles: new Uint8Array(Uint32Array.from(triangles).buffer),
          lineKind: this.kinds,
          pointRadius: 0,
        },
      ],
      shapes: [
        { kind: "plane", position: [0, 0, 0], orientation: [1, 0, 0, 0], size: [0, 1, 0], id: "ground" },
        { kind: "sphere", position: [0, 0.6, 0.2], orientation: [1, 0, 0, 0], size: [0.5], id: "ball" },
      ],
    };
  }

  energies() {
    const { x, v, w } = this;
    let kinetic = 0;
    let potential = 0;
    const m = 1 / w.length;
    for (let k = 0; k < w.length; ++k) {
      kinetic += 0.5 * m * (v[3 * k] ** 2 + v[3 * k + 1] ** 2 + v[3 * k + 2] ** 2);
      potential += m * 9.81 * x[3 * k + 1];
    }
    return { kinetic, potential };
  }

  positions() {
    return this.x;
  }
  velocities() {
    return this.v;
  }
}

/** Balls or drops that fall, bounce off the ground and the walls of a box, and are thrown up again. */
export class Fountain {
  constructor(count, { radius = 0.03, spread = 1 } = {}) {
    Object.assign(this, { count, radius, spread, system: "drops" });
    this.reset();
  }

  reset() {
    this.x = new Float32Array(this.count * 3);
    this.v = new Float32Array(this.count * 3);
    this.seed = 1;
    for (let k = 0; k < this.count; ++k) {
      this.launch(k);
      const t = 1.4 * this.random();
      this.move(k, t);
    }
  }

  random() {
    this.seed = (Math.imul(this.seed, 1664525) + 1013904223) >>> 0;
    return this.seed / 2 ** 32;
  }

  launch(k) {
    const angle = 2 * Math.PI * this.random();
    const tilt = 1.3 * Math.sqrt(this.random()) * this.spread;
    this.x.set([0, 0.2, 0], 3 * k);
    this.v.set([tilt * Math.cos(angle), 6 + 1.2 * this.random(), tilt * Math.sin(angle)], 3 * k);
  }

  move(k, dt) {
    const { x, v } = this;
    v[3 * k + 1] -= 9.81 * dt;
    for (let c = 0; c < 3; ++c) x[3 * k + c] += v[3 * k + c] * dt;
  }

  step(dt) {
    const { x, v, radius } = this;
    for (let k = 0; k < this.count; ++k) {
      this.move(k, dt);
      if (x[3 * k + 1] < radius) {
        x[3 * k + 1] = radius;
        v[3 * k + 1] *= -0.45;
        v[3 * k] *= 0.9;
        v[3 * k + 2] *= 0.9;
        if (Math.abs(v[3 * k + 1]) < 0.25) this.launch(k);
      }
      for (const c of [0, 2]) {
        if (Math.abs(x[3 * k + c]) > 2) {
          x[3 * k + c] = 2 * Math.sign(x[3 * k + c]);
          v[3 * k + c] *= -0.5;
        }
      }
    }
  }

  command() {}

  topology() {
    return {
      systems: [{ system: this.system, pointRadius: this.radius }],
      shapes: [
        { kind: "plane", position: [0, 0, 0], orientation: [1, 0, 0, 0], size: [0, 1, 0], id: "ground" },
        { kind: "box", position: [0, 0.5, 0], orientation: [1, 0, 0, 0], size: [2, 0.5, 2], id: "tank", container: true },
      ],
    };
  }

  energies() {
    const { x, v } = this;
    let kinetic = 0;
    let potential = 0;
    for (let k = 0; k < this.count; ++k) {
      kinetic += (0.5 * (v[3 * k] ** 2 + v[3 * k + 1] ** 2 + v[3 * k + 2] ** 2)) / this.count;
      potential += (9.81 * x[3 * k + 1]) / this.count;
    }
    return { kinetic, potential };
  }

  positions() {
    return this.x;
  }
  velocities() {
    return this.v;
  }
}

export const gallery = [
  {
    name: "hanging-cloth",
    title: "Cloth over a ball",
    teaches: "Structural and shear springs carry different loads; pinned corners, wind and a collider.",
    tags: ["cloth", "springs"],
    camera: { eye: [3.4, 2.4, 4.2], target: [0, 1.2, 0.3] },
    make: () => new Cloth(26),
  },
  {
    name: "fountain",
    title: "Fountain in a tank",
    teaches: "Emitters, lifetimes and restitution: why drops that bounce lose more than half of their height.",
    tags: ["particles"],
    camera: { eye: [4, 2.6, 5], target: [0, 1, 0] },
    make: () => new Fountain(4000),
  },
  {
    name: "bouncing-balls",
    title: "Bouncing balls",
    teaches: "Restitution 0.45 on a plane; the energy falls in steps.",
    tags: ["particles", "collision"],
    make: () => new Fountain(40, { radius: 0.14, spread: 2 }),
  },
  {
    name: "hundred-thousand",
    title: "A hundred thousand drops",
    teaches: "What one frame of 1.2 MB costs on the way to the screen.",
    tags: ["particles", "large"],
    camera: { eye: [4, 2.6, 5], target: [0, 1, 0] },
    make: () => new Fountain(100000, { radius: 0.012 }),
  },
  {
    name: "large-cloth",
    title: "Cloth, 100 x 100",
    teaches: "Ten thousand points and sixty thousand springs.",
    tags: ["cloth", "large"],
    camera: { eye: [3.4, 2.4, 4.2], target: [0, 1.2, 0.3] },
    make: () => new Cloth(100, { iterations: 2 }),
  },
];
