// Sums over whole records of eight numbers, a register each: loops of fixed length are unrolled before they
// are vectorised, into eight sums of one. The same bits as such loops.
#pragma once
#include <cstring>

#include "engine/math/wide.h"

namespace truestep::records {

template <class T>
struct Register {
  typedef T Type __attribute__((vector_size(8 * sizeof(T))));
  Type value;
  explicit Register(const Record8<T>& r) { std::memcpy(&value, r.x, sizeof value); }
  void store(Record8<T>& r) const { std::memcpy(r.x, &value, sizeof value); }
};

/// to += by
template <class T>
void add(Record8<T>& to, const Record8<T>& by) {
  Register<T> a(to);
  a.value += Register<T>(by).value;
  a.store(to);
}
/// to *= by, number by number
template <class T>
void multiply(Record8<T>& to, const Record8<T>& by) {
  Register<T> a(to);
  a.value *= Register<T>(by).value;
  a.store(to);
}
/// to += t by
template <class T>
void add_times(Record8<T>& to, T t, const Record8<T>& by) {
  Register<T> a(to);
  a.value += t * Register<T>(by).value;
  a.store(to);
}
/// to += a - b
template <class T>
void add_difference(Record8<T>& to, const Record8<T>& a, const Record8<T>& b) {
  Register<T> sum(to);
  sum.value += Register<T>(a).value - Register<T>(b).value;
  sum.store(to);
}

}  // namespace truestep::records
