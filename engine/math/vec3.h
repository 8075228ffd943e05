// Three numbers with the operations that physics kernels need. SI units; no SIMD type of its own: loops
// over columns vectorise better without one.
#pragma once
#include <cmath>

namespace truestep {

template <class T>
struct Vec3T {
  T x = 0, y = 0, z = 0;

  constexpr Vec3T& operator+=(const Vec3T& b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
  constexpr Vec3T& operator-=(const Vec3T& b) {
    x -= b.x, y -= b.y, z -= b.z;
    return *this;
  }
  constexpr Vec3T& operator*=(T s) {
    x *= s, y *= s, z *= s;
    return *this;
  }
  friend constexpr Vec3T operator+(Vec3T a, const Vec3T& b) { return a += b; }
  friend constexpr Vec3T operator-(Vec3T a, const Vec3T& b) { return a -= b; }
  friend constexpr Vec3T operator-(const Vec3T& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3T operator*(Vec3T a, T s) { return a *= s; }
  friend constexpr Vec3T operator*(T s, Vec3T a) { return a *= s; }
  friend constexpr Vec3T operator/(const Vec3T& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vec3T&, const Vec3T&) = default;
};

using Vec3 = Vec3T<double>;
using Vec3f = Vec3T<float>;

template <class T>
constexpr T dot(const Vec3T<T>& a, const Vec3T<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3T<T> cross(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T norm2(const Vec3T<T>& a) {
  return dot(a, a);
}
template <class T>
T norm(const Vec3T<T>& a) {
  return std::sqrt(dot(a, a));
}
/// Unit vector, or `fallback` when |a| is zero or not finite.
template <class T>
Vec3T<T> normalized(const Vec3T<T>& a, const Vec3T<T>& fallback = {1, 0, 0}) {
  const T n = norm(a);
  return n > 0 && std::isfinite(n) ? a / n : fallback;
}
/// Row i of an n x 3 array.
template <class T>
constexpr Vec3T<T> load3(const T* p, size_t i) {
  return {p[3 * i], p[3 * i + 1], p[3 * i + 2]};
}
template <class T>
constexpr void store3(T* p, size_t i, const Vec3T<T>& v) {
  p[3 * i] = v.x, p[3 * i + 1] = v.y, p[3 * i + 2] = v.z;
}

}  // namespace truestep
