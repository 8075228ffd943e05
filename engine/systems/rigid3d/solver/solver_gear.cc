#include "engine/systems/rigid3d/solver/solver_gear.h"

namespace truestep::rigid3d {
namespace {

/// J and p of one end of a joint in a lane: sign -1 for a, 1 for b.
template <class T>
void load_end(const JointGroup<T>& g, const JointDrive<T>& d, int lane, T sign, T factor,
              typename GearRow<T>::End& end) {
  const bool first = sign < 0;
  end.slot = first ? g.a[lane] : g.b[lane];
  const T root = first ? g.root_a[lane] : g.root_b[lane];
  for (int e = 0; e < 6; ++e) end.j[e] = end.p[e] = 0;
  for (int q = 0; q < 6; ++q) {
    const T share = d.share[q][lane] * sign * factor;
    for (int e = 0; e < 3; ++e) {
      const T linear = q < 3 ? root * g.now[q][e][lane] : T(0);
      const T turn = first ? g.ja[q][e][lane] : g.jb[q][e][lane];
      end.p[e] += share * linear, end.p[3 + e] += share * turn;
      if (q == d.row) end.j[e] = sign * factor * linear, end.j[3 + e] = sign * factor * turn;
    }
  }
}

template <class T>
T product(const T a[6], const T b[6]) {
  T sum = 0;
  for (int e = 0; e < 6; ++e) sum += a[e] * b[e];
  return sum;
}

}  // namespace

template <class T>
void prepare_gear(GearRow<T>& gear, std::span<const JointGroup<T>> groups,
                  std::span<const JointDrive<T>> drives, uint32_t end) {
  gear.gap = gear.error, gear.drift = 0;
  for (int m = 0; m < 2; ++m) {
    const auto& [group, drive, lane] = gear.mesh[m];
    const JointGroup<T>& g = groups[group];
    const JointDrive<T>& d = drives[drive];
    const T factor = m == 0 ? T(1) : gear.ratio;
    load_end(g, d, lane, T(-1), factor, gear.end[2 * m]);
    load_end(g, d, lane, T(1), factor, gear.end[2 * m + 1]);
    gear.gap += factor * (g.gap[d.row][lane] - d.start[lane]);
    gear.drift += factor * g.drift[d.row][lane];
  }
  // A body held by both joints gets both.
  T k = 0;
  for (const auto& i : gear.end) {
    for (const auto& j : gear.end) {
      if (i.slot == j.slot && i.slot != end) k += product(i.j, j.p);
    }
  }
  gear.inverse_k = k > 0 ? 1 / k : 0;
}

template <class T>
void apply_gear(const GearRow<T>& gear, Record8<T>* records, uint32_t end, T times) {
  for (const auto& i : gear.end) {
    if (i.slot == end) continue;
    for (int e = 0; e < 6; ++e) records[i.slot].x[e] += times * gear.impulse * i.p[e];
  }
}

template <ContactSolve kind, class T>
void solve_gear(GearRow<T>& gear, Record8<T>* v, uint32_t end, const JointPass<T>& pass) {
  T speed = gear.drift;
  for (const auto& i : gear.end) {
    if (i.slot != end) speed += product(i.j, v[i.slot].x);
  }
  T change = -gear.inverse_k * speed;
  if constexpr (kind == ContactSolve::bias) {
    change = -gear.inverse_k * pass.mass_scale * (speed + pass.bias_rate * gear.gap) -
             pass.impulse_scale * gear.impulse;
  }
  gear.impulse += change;
  for (const auto& i : gear.end) {
    if (i.slot == end) continue;
    for (int e = 0; e < 6; ++e) v[i.slot].x[e] += change * i.p[e];
  }
}

template void prepare_gear<float>(GearRow<float>&, std::span<const JointGroup<float>>,
                                  std::span<const JointDrive<float>>, uint32_t);
template void apply_gear<float>(const GearRow<float>&, Record8<float>*, uint32_t, float);
template void solve_gear<ContactSolve::bias, float>(GearRow<float>&, Record8<float>*, uint32_t,
                                                    const JointPass<float>&);
template void solve_gear<ContactSolve::relax, float>(GearRow<float>&, Record8<float>*, uint32_t,
                                                     const JointPass<float>&);
template void prepare_gear<double>(GearRow<double>&, std::span<const JointGroup<double>>,
                                   std::span<const JointDrive<double>>, uint32_t);
template void apply_gear<double>(const GearRow<double>&, Record8<double>*, uint32_t, double);
template void solve_gear<ContactSolve::bias, double>(GearRow<double>&, Record8<double>*, uint32_t,
                                                     const JointPass<double>&);
template void solve_gear<ContactSolve::relax, double>(GearRow<double>&, Record8<double>*, uint32_t,
                                                      const JointPass<double>&);

}  // namespace truestep::rigid3d
