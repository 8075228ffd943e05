// Curves through keys. All smooth kinds are cubics between keys, in Hermite's form
//   v(u) = (2u^3 - 3u^2 + 1) v0 + (u^3 - 2u^2 + u) h m0 + (3u^2 - 2u^3) v1 + (u^3 - u^2) h m1,
//   u = (t - t0) / h,
// and differ in the slopes m at the keys: catmull_rom (Catmull, Rom 1974) takes those of the parabola through
// a key and its neighbours, so that quadratics are reproduced for any spacing; natural solves for a
// continuous second derivative that vanishes at both ends; monotone (Fritsch, Butland 1984) never leaves the
// range of the two keys around it; hermite takes given slopes. bezier also moves the handles in time, by
// fractions of the interval: t(s) and v(s) are Bezier cubics, and t(s) = t is solved for s. Built once;
// sampling does not allocate.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace truestep::animation {

enum class Interpolation : uint8_t { step, linear, catmull_rom, hermite, bezier, natural, monotone };
/// The curve before the first and after the last key.
enum class Extend : uint8_t { clamp, loop, ping_pong };

/// A time mapped into the range of the keys; `direction` is -1 where ping-pong runs backwards, 0 where the
/// time was clamped.
struct KeyTime {
  double t = 0;
  double direction = 1;
};
KeyTime within(double t, double first, double last, Extend extend);

/// The last frame time (frame / rate, exactly) at or before t (s) at `rate` frames per second; t itself if
/// the rate is 0. A time within 1e-9 frames of a frame counts as that frame.
double frame_time(double t, double rate);

/// Input of a curve: n keys of `width` numbers each.
struct Keys {
  size_t width = 1;
  std::span<const double> times;            ///< s, n of them, ascending
  std::span<const double> values;           ///< n x width
  std::span<const double> slopes_in = {};   ///< n x width, 1/s; for hermite and bezier, or empty
  std::span<const double> slopes_out = {};  ///< the same; empty: as slopes_in
  std::span<const double> handles = {};  ///< n x 2, bezier: fractions (before, after) in [0, 1]; empty: 1/3
  Interpolation interpolation = Interpolation::catmull_rom;
  Extend extend = Extend::clamp;
};

class KeyCurve {
 public:
  KeyCurve() = default;
  /// Slopes missing for hermite or bezier are those of catmull_rom. Loops whose first and last values agree
  /// are closed smoothly by catmull_rom.
  explicit KeyCurve(const Keys& keys);

  size_t width() const { return width_; }
  size_t keys() const { return times_.size(); }
  double first() const { return times_.front(); }
  double last() const { return times_.back(); }
  /// `width` values at t (s), and their rates (1/s) where `rate` is not null.
  void sample(double t, double* value, double* rate = nullptr) const;

 private:
  void parabola_slopes();
  void natural_slopes();
  void monotone_slopes();
  size_t segment(double t) const;

  size_t width_ = 1;
  Interpolation interpolation_ = Interpolation::step;
  Extend extend_ = Extend::clamp;
  std::vector<double> times_, values_, in_, out_, handles_;
};

/// The four weights of uniform Catmull-Rom at u in [0, 1], for v[-1], v[0], v[1], v[2].
struct FourWeights {
  double w[4];
};
FourWeights catmull_rom_weights(double u);

/// s in [0, 1] with 3 s (1-s)^2 a + 3 s^2 (1-s) b + s^3 = x, for a, b in [0, 1]: the parameter at which a
/// Bezier cubic has the time x.
double bezier_parameter(double x, double a, double b);

}  // namespace truestep::animation
