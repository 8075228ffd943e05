// The loops over pairs of bodies, and of bodies with nodes, which take all the time. Included inside a
// namespace after one of lanes_*.h, once per kind of processor, so nothing in here may have a name outside of
// it. Formulas: ../softening.h, ../far_sums.h.
//
// 1/sqrt(x) is taken from multiplications alone: processors' own estimates differ from maker to maker, and
// roots and quotients are slow. The first guess halves and negates the exponent in the number's bits; with e
// = 1 - x y^2 the root is
//   y (1 - e)^(-1/2) = y (1 + e/2 + 3/8 e^2 + 5/16 e^3 + 35/128 e^4 + ...).
// One pass leaves 5e-7, the size of floats' own rounding; doubles take a second one, which leaves two units
// of the last place.

inline Floats inverse_root(Floats x) {
  const auto c = [](float a) { return Floats::all(a); };
  const Floats y = halved_exponent(x, 0x5f375a86u), e = nmadd(x * y, y, c(1));
  const Floats e2 = e * e, high = madd(e, c(35.0f / 128), c(5.0f / 16)), low = madd(e, c(3.0f / 8), c(0.5f));
  return madd(y * e, madd(e2, high, low), y);
}

inline Doubles inverse_root(Doubles x) {
  const auto c = [](double a) { return Doubles::all(a); };
  Doubles y = halved_exponent(x, 0x5fe6eb50c7b537a9ull), e = nmadd(x * y, y, c(1));
  const Doubles e2 = e * e, high = madd(e, c(35.0 / 128), c(5.0 / 16)), low = madd(e, c(3.0 / 8), c(0.5));
  y = madd(y * e, madd(e2, high, low), y);
  // 5e-7 now, so that the square of e is the last term that counts.
  e = nmadd(x * y, y, c(1));
  return madd(y * e, madd(e, c(3.0 / 8), c(0.5)), y);
}

// --- laws: w(r^2), and p in `inverse`

template <class L>
struct Plummer {
  L eps2;
  explicit Plummer(const LawNumbers& n) : eps2(L::all(static_cast<typename L::Number>(n.eps * n.eps))) {}
  L operator()(L r2, L& inverse) const {
    inverse = inverse_root(r2 + eps2);
    return inverse * inverse * inverse;
  }
};

template <class L>
struct Newton {
  L tiny;
  explicit Newton(const LawNumbers& n) : tiny(L::all(static_cast<typename L::Number>(n.tiny))) {}
  L operator()(L r2, L& inverse) const {
    inverse = where_above(r2, tiny, inverse_root(r2 + tiny), L::all(0));
    return inverse * inverse * inverse;
  }
};

template <class L>
struct Spline {
  L h, per_h, tiny;
  explicit Spline(const LawNumbers& n)
      : h(L::all(static_cast<typename L::Number>(kSplineSupport * n.eps))),
        per_h(L::all(static_cast<typename L::Number>(1 / (kSplineSupport * n.eps)))),
        tiny(L::all(static_cast<typename L::Number>(n.tiny))) {}
  L operator()(L r2, L& inverse) const {
    const auto c = [](double a) { return L::all(static_cast<typename L::Number>(a)); };
    const L newton = inverse_root(r2 + tiny), u = r2 * newton * per_h, u2 = u * u;
    // Inner half: u < 1/2. The outer one's 1/u is v.
    const L inner_w = madd(u2, madd(u, c(32), c(-38.4)), c(32.0 / 3));
    const L inner_p = nmadd(u2, madd(u2, madd(u, c(6.4), c(-9.6)), c(16.0 / 3)), c(2.8));
    const L v = h * newton;
    const L outer_w =
        nmadd(v * v * v, c(1.0 / 15), madd(u, madd(u, nmadd(u, c(32.0 / 3), c(38.4)), c(-48)), c(64.0 / 3)));
    const L outer_p = nmadd(u2, madd(u, madd(u, nmadd(u, c(32.0 / 15), c(9.6)), c(-16)), c(32.0 / 3)),
                            nmadd(v, c(1.0 / 15), c(3.2)));
    inverse = where_above(u, c(1), newton, where_above(c(0.5), u, inner_p, outer_p) * per_h);
    return where_above(u, c(1), newton * newton * newton,
                       where_above(c(0.5), u, inner_w, outer_w) * per_h * per_h * per_h);
  }
};

// --- all pairs, in doubles

inline double sum(Doubles a) {
  double t[8];
  a.store(t);
  return ((t[0] + t[4]) + (t[2] + t[6])) + ((t[1] + t[5]) + (t[3] + t[7]));
}

struct Row {
  Doubles x, y, z, mu, ax = Doubles::all(0), ay = Doubles::all(0), az = Doubles::all(0);
  Row(const PairColumns& c, size_t i)
      : x(Doubles::all(c.x[i])),
        y(Doubles::all(c.y[i])),
        z(Doubles::all(c.z[i])),
        mu(Doubles::all(c.mu[i])) {}
  void add_to(const PairColumns& c, size_t i) const {
    c.ax[i] += sum(ax), c.ay[i] += sum(ay), c.az[i] += sum(az);
  }
};

/// Every body of [i0, i1) with every one of [j0, j1), for both: two rows against lanes; the rows' sums stay
/// in registers.
template <class Law>
void cross_pairs(const PairColumns& c, const LawNumbers& numbers, size_t i0, size_t i1, size_t j0,
                 size_t j1) {
  const Law law(numbers);
  Doubles unused;
  const auto add = [](double* to, Doubles pb, Doubles pd, Doubles qb, Doubles qd) {
    nmadd(qb, qd, nmadd(pb, pd, Doubles::load(to))).store(to);
  };
  for (size_t i = i0; i < i1; i += 2) {
    Row p(c, i), q(c, i + 1);
    for (size_t j = j0; j < j1; j += 8) {
      const Doubles x = Doubles::load(c.x + j), y = Doubles::load(c.y + j), z = Doubles::load(c.z + j),
                    mu = Doubles::load(c.mu + j);
      const Doubles px = x - p.x, py = y - p.y, pz = z - p.z, qx = x - q.x, qy = y - q.y, qz = z - q.z;
      const Doubles pw = law(madd(px, px, madd(py, py, pz * pz)), unused),
                    qw = law(madd(qx, qx, madd(qy, qy, qz * qz)), unused);
      const Doubles pf = pw * mu, qf = qw * mu, pb = pw * p.mu, qb = qw * q.mu;
      p.ax = madd(pf, px, p.ax), p.ay = madd(pf, py, p.ay), p.az = madd(pf, pz, p.az);
      q.ax = madd(qf, qx, q.ax), q.ay = madd(qf, qy, q.ay), q.az = madd(qf, qz, q.az);
      add(c.ax + j, pb, px, qb, qx), add(c.ay + j, pb, py, qb, qy), add(c.az + j, pb, pz, qb, qz);
    }
    p.add_to(c, i), q.add_to(c, i + 1);
  }
}

/// The pairs within [i0, i1), each twice.
template <class Law>
void own_pairs(const PairColumns& c, const LawNumbers& numbers, size_t i0, size_t i1) {
  const Law law(numbers);
  Doubles unused;
  for (size_t i = i0; i < i1; ++i) {
    Row p(c, i);
    for (size_t j = i0; j < i1; j += 8) {
      const Doubles x = Doubles::load(c.x + j) - p.x, y = Doubles::load(c.y + j) - p.y,
                    z = Doubles::load(c.z + j) - p.z;
      const Doubles f = law(madd(x, x, madd(y, y, z * z)), unused) * Doubles::load(c.mu + j);
      p.ax = madd(f, x, p.ax), p.ay = madd(f, y, p.ay), p.az = madd(f, z, p.az);
    }
    p.add_to(c, i);
  }
}

/// sum_j mu_j p(r_ij) over [j0, j1) from body `first` on.
template <class Law>
double row_potential(const PairColumns& c, const LawNumbers& numbers, size_t i, size_t first, size_t j0,
                     size_t j1) {
  const Law law(numbers);
  Doubles total = Doubles::all(0), p;
  const Row at(c, i);
  for (size_t j = j0; j < j1; j += 8) {
    const Doubles x = Doubles::load(c.x + j) - at.x, y = Doubles::load(c.y + j) - at.y,
                  z = Doubles::load(c.z + j) - at.z;
    law(madd(x, x, madd(y, y, z * z)), p);
    double mu[8];
    for (size_t k = 0; k < 8; ++k) mu[k] = j + k < first ? 0 : c.mu[j + k];
    total = madd(Doubles::load(mu), p, total);
  }
  return sum(total);
}

/// a = sum mu w d,  da/dt = sum mu w (u - 3 (d.u)/R^2 d), of the laws whose w is R^-3 (Makino & Aarseth 1992,
/// eqs. 1 and 2).
template <class Law>
JerkSums row_jerk(const MotionColumns& c, const LawNumbers& numbers, size_t i) {
  const Law law(numbers);
  const auto at = [i](const double* column) { return Doubles::all(column[i]); };
  const Doubles xi = at(c.x), yi = at(c.y), zi = at(c.z), ui = at(c.vx), vi = at(c.vy), wi = at(c.vz),
                zero = Doubles::all(0);
  Doubles ax = zero, ay = zero, az = zero, jx = zero, jy = zero, jz = zero, inverse;
  for (size_t j = 0; j < c.rows; j += 8) {
    const Doubles x = Doubles::load(c.x + j) - xi, y = Doubles::load(c.y + j) - yi,
                  z = Doubles::load(c.z + j) - zi;
    const Doubles u = Doubles::load(c.vx + j) - ui, v = Doubles::load(c.vy + j) - vi,
                  w = Doubles::load(c.vz + j) - wi;
    const Doubles f = law(madd(x, x, madd(y, y, z * z)), inverse) * Doubles::load(c.mu + j);
    const Doubles s = Doubles::all(3) * madd(x, u, madd(y, v, z * w)) * (inverse * inverse);
    ax = madd(f, x, ax), ay = madd(f, y, ay), az = madd(f, z, az);
    jx = madd(f, nmadd(s, x, u), jx), jy = madd(f, nmadd(s, y, v), jy), jz = madd(f, nmadd(s, z, w), jz);
  }
  return {{sum(ax), sum(ay), sum(az)}, {sum(jx), sum(jy), sum(jz)}};
}

// --- a group of the tree's bodies and its sources, in floats or doubles

template <class L>
struct Targets {
  L x, y, z, ax = L::all(0), ay = L::all(0), az = L::all(0), p = L::all(0);
  template <class G>
  Targets(const G& g, size_t at) : x(L::load(g.x + at)), y(L::load(g.y + at)), z(L::load(g.z + at)) {}
  template <class G>
  void add_to(const G& g, size_t at) const {
    (L::load(g.ax + at) + ax).store(g.ax + at), (L::load(g.ay + at) + ay).store(g.ay + at);
    (L::load(g.az + at) + az).store(g.az + at), (L::load(g.p + at) + p).store(g.p + at);
  }
};

template <Sums kSums, class L, class Law, class T>
inline void meet(Targets<L>& t, const BodySource<T>& b, const Law& law) {
  const L x = L::all(b.x) - t.x, y = L::all(b.y) - t.y, z = L::all(b.z) - t.z, m = L::all(b.m);
  L inverse;
  const L r2 = madd(x, x, madd(y, y, z * z)), f = law(r2, inverse) * m;
  t.ax = madd(f, x, t.ax), t.ay = madd(f, y, t.ay), t.az = madd(f, z, t.az);
  if constexpr (kSums == Sums::accelerations_and_potentials) {
    // The bodies of the group include themselves: subtracting that later would require knowing it to the last
    // digit.
    t.p = madd(where_above(r2, L::all(0), inverse, L::all(0)), m, t.p);
  }
}

template <Sums kSums, class Law>
inline void meet(Targets<Floats>& t, const NodeSource& n, const Law& law) {
  const auto c = [](float a) { return Floats::all(a); };
  const Floats x = c(n.x) - t.x, y = c(n.y) - t.y, z = c(n.z) - t.z, m = c(n.m);
  Floats inverse;
  const Floats cube = law(madd(x, x, madd(y, y, z * z)), inverse), square = inverse * inverse;
  const Floats sx = madd(c(n.s[0]), x, madd(c(n.s[1]), y, c(n.s[2]) * z)),
               sy = madd(c(n.s[1]), x, madd(c(n.s[3]), y, c(n.s[4]) * z)),
               sz = madd(c(n.s[2]), x, madd(c(n.s[4]), y, c(n.s[5]) * z));
  const Floats q = square * madd(sx, x, madd(sy, y, sz * z)), trace = c(n.s[6]);
  const Floats f = cube * madd(square, madd(c(2.5f), q, c(-n.s[6])), m), g = cube * square;
  t.ax = nmadd(g, sx, madd(f, x, t.ax)), t.ay = nmadd(g, sy, madd(f, y, t.ay)),
  t.az = nmadd(g, sz, madd(f, z, t.az));
  if constexpr (kSums == Sums::accelerations_and_potentials) {
    t.p = madd(inverse, madd(square, madd(c(0.5f), q, c(-1.0f / 3) * trace), m), t.p);
  }
}

/// Adds the contributions of `count` sources to every body of the group.
template <Sums kSums, class L, class Law, class T, class Source>
void meet_all(const GroupColumns<T>& g, const Source* sources, size_t count, const LawNumbers& numbers) {
  constexpr size_t kLanes = 64 / sizeof(T);
  const Law law(numbers);
  for (size_t at = 0; at < g.rows; at += kLanes) {
    Targets<L> t(g, at);
    for (size_t k = 0; k < count; ++k) meet<kSums>(t, sources[k], law);
    t.add_to(g, at);
  }
}

template <template <class> class Law>
constexpr DirectLoops direct_loops() {
  return {cross_pairs<Law<Doubles>>, own_pairs<Law<Doubles>>, row_potential<Law<Doubles>>,
          row_jerk<Law<Doubles>>};
}

template <class L, class T, template <class> class Law, class Source>
constexpr GroupLoop<T, Source> group_loop(Sums sums) {
  return sums == Sums::accelerations ? meet_all<Sums::accelerations, L, Law<L>, T, Source>
                                     : meet_all<Sums::accelerations_and_potentials, L, Law<L>, T, Source>;
}

template <template <class> class Law>
constexpr LawLoops law_loops() {
  using enum Sums;
  return {direct_loops<Law>(),
          {group_loop<Floats, float, Law, BodySource<float>>(accelerations),
           group_loop<Floats, float, Law, BodySource<float>>(accelerations_and_potentials)},
          {group_loop<Doubles, double, Law, BodySource<double>>(accelerations),
           group_loop<Doubles, double, Law, BodySource<double>>(accelerations_and_potentials)},
          {group_loop<Floats, float, Law, NodeSource>(accelerations),
           group_loop<Floats, float, Law, NodeSource>(accelerations_and_potentials)}};
}

// Included once in a namespace of its own for each width of registers.
// NOLINTNEXTLINE(misc-definitions-in-headers)
constexpr PairLoops kLoops{law_loops<Newton>(), law_loops<Plummer>(), law_loops<Spline>()};
