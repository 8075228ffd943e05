// Pairs of points solved together with everything tied to them: links with an implicitly solved side, and
// springs too stiff for impulses at both ends of a substep.
#include <algorithm>
#include <cmath>

#include "engine/couplings/attachment/attachment.h"
#include "engine/couplings/attachment/links.h"
#include "engine/couplings/sides.h"

namespace truestep::attachment {

namespace {

/// rad, tolerance of directions at the substep's end.
constexpr double kSameDirection = 1e-6;

}  // namespace

// Forces typically last for many steps: both sides include the last step's forces in their own, nonlinear
// step, and the linear response (answered_pairs.h) only has to cover what has changed since.
void Attachment::give_last(const CoupledStates& s, double h, Points& a, Points& b,
                           const std::vector<Live>& live) const {
  double* last = pair_forces(s.own);
  if (!last) return;
  for (const Live& p : live) {
    Vec3 force = lasting(last, p.pair);
    if (p.rest > 0) {
      const Vec3 r = separation(a, p.a, b, p.b);
      force = turned(force, r, r + approach(a, p.a, b, p.b) * h);
    }
    pass_on(last, p.pair, force);
    exchange_impulse(a, p.a, p.wa, b, p.b, p.wb, force * h);
  }
}

// The equation for a pair at r and u without its impulse J, in the direction n at its end; r' = r + h W J and
// u' = u + W J.
//   link    |r'| = L: n.(W J) = (L - n.r) / h, J along n
//   spring  J = -h f(r', u') with f = K r' - k L n + c (u'.n) n, K = k n n^T + k (1 - L / |r'|) (1 - n n^T),
//           the second part only when stretched. With B = h (h K + c n n^T) and J = sqrt(B) y
//           (1 + sqrt(B) W sqrt(B)) y = -h sqrt(B)^-1 f(r, u)
void Attachment::ask(AnsweredPair& q, double rest, const Vec3& r, const Vec3& u, double h) const {
  const Vec3 ends = r + q.change * h;
  q.n = rest == 0 ? Vec3{} : normalized(ends);
  if (def_.link == AttachmentDef::Link::rigid) {
    q.along = 1, q.across = rest == 0 ? 1 : 0;
    q.right = (rest == 0 ? -r : q.n * (rest - dot(r, q.n))) / h;
    return;
  }
  const double k = def_.stiffness, c = def_.damping;
  q.give = 1, q.along = std::sqrt(h * (h * k + c));
  if (rest == 0) {
    q.across = q.along;
    q.right = (r * k + u * c) * (-h / q.along);
    return;
  }
  const double across = std::sqrt(k * std::max(0.0, 1 - rest / std::max(norm(ends), rest)));
  q.across = h * across;
  q.right =
      q.n * (-h / q.along * (k * (dot(r, q.n) - rest) + c * dot(u, q.n))) - (r - q.n * dot(r, q.n)) * across;
}

// Newton's method for the directions at the end: together with the responses of both sides, a step of
// implicit Euler on the two systems as one.
void Attachment::solve_pairs(const CoupledStates& s, const StepInput& in, const std::vector<Live>& live,
                             Exchange& sum) const {
  if (live.empty()) return;
  Points a(s.a, a_), b(s.b, b_);
  double* last = pair_forces(s.own);
  auto& pairs = in.workspace.object<std::vector<AnsweredPair>>("attachment.answered");
  auto& free = in.workspace.object<std::vector<FreePair>>("attachment.free");
  pairs.clear(), free.clear();
  for (const Live& p : live) {
    pairs.push_back({.a = p.a, .b = p.b, .wa = p.wa, .wb = p.wb});
    if (last) pairs.back().given = load3(last, 2 * p.pair) * in.h;
  }
  answered_.answer_given(s, in, pairs);
  for (const AnsweredPair& p : pairs) {
    free.push_back({separation(a, p.a, b, p.b) - p.change * in.h, approach(a, p.a, b, p.b) - p.change});
  }
  for (int solution = 0; solution < kMostSolutions; ++solution) {
    double turn = 0;
    for (size_t i = 0; i < pairs.size(); ++i) {
      const Vec3 n = pairs[i].n;
      ask(pairs[i], live[i].rest, free[i].r, free[i].u, in.h);
      turn = std::max(turn, norm(pairs[i].n - n));
    }
    if (solution > 0 && turn <= kSameDirection) break;
    answered_.solve(s, in, pairs);
  }
  answered_.move(s, in, pairs);
  for (size_t i = 0; i < pairs.size(); ++i) {
    const AnsweredPair& p = pairs[i];
    const Vec3 u = approach(a, p.a, b, p.b);
    const double u2 = live[i].rest == 0 ? norm2(u) : dot(u, p.n) * dot(u, p.n);
    sum.add(p.impulse, def_.link == AttachmentDef::Link::spring ? in.h * def_.damping * u2 : 0);
    if (last) store3(last, 2 * live[i].pair, p.impulse / in.h);
  }
  if (def_.link == AttachmentDef::Link::rigid) close_lengths(s, in, live, pairs, sum);
}

// Removes the length errors left by rounding and by the last rotation of the links.
void Attachment::close_lengths(const CoupledStates& s, const StepInput& in, const std::vector<Live>& live,
                               std::vector<AnsweredPair>& pairs, Exchange& sum) const {
  Points a(s.a, a_), b(s.b, b_);
  for (int solution = 0; solution < kMostSolutions; ++solution) {
    double worst = 0;
    for (size_t i = 0; i < pairs.size(); ++i) {
      AnsweredPair& p = pairs[i];
      const Vec3 r = separation(a, p.a, b, p.b);
      p.given = {}, p.change = {};
      ask(p, live[i].rest, r, {}, in.h);
      worst = std::max(worst, norm(p.right) * in.h / std::max(live[i].rest, 1.0));
    }
    if (worst <= kLengthTolerance) break;
    answered_.solve(s, in, pairs);
    answered_.move(s, in, pairs);
    for (const AnsweredPair& p : pairs) sum.add(p.impulse, 0);
  }
}

}  // namespace truestep::attachment
