// Eight doubles and sixteen floats side by side, as two halves each of a math/wide.h type. Included inside a
// namespace of its own; the same names and bits as lanes_avx512.h.
template <class T>
struct Halves {
  using Number = T;
  Wide<T> low, high;
  static constexpr int kHalf = Wide<T>::kLanes;
  using Raw = typename Wide<T>::Raw;
  typedef std::conditional_t<sizeof(T) == 8, uint64_t, uint32_t> Unsigned;
  typedef Unsigned Bits __attribute__((vector_size(32)));

  static Halves all(T s) { return {Wide<T>::all(s), Wide<T>::all(s)}; }
  static Halves load(const T* p) {
    Halves r;
    __builtin_memcpy(&r.low, p, 32), __builtin_memcpy(&r.high, p + kHalf, 32);
    return r;
  }
  void store(T* p) const { __builtin_memcpy(p, &low, 32), __builtin_memcpy(p + kHalf, &high, 32); }
  friend Halves operator+(Halves a, Halves b) { return {a.low + b.low, a.high + b.high}; }
  friend Halves operator-(Halves a, Halves b) { return {a.low - b.low, a.high - b.high}; }
  friend Halves operator*(Halves a, Halves b) { return {a.low * b.low, a.high * b.high}; }
  friend Halves madd(Halves a, Halves b, Halves c) {
    return {madd(a.low, b.low, c.low), madd(a.high, b.high, c.high)};
  }
  friend Halves nmadd(Halves a, Halves b, Halves c) {
    return {nmadd(a.low, b.low, c.low), nmadd(a.high, b.high, c.high)};
  }
  /// x > y ? a : b.
  friend Halves where_above(Halves x, Halves y, Halves a, Halves b) {
    return {select(x.low > y.low, a.low, b.low), select(x.high > y.high, a.high, b.high)};
  }
  /// magic - bits / 2.
  friend Halves halved_exponent(Halves a, Unsigned magic) {
    return {{(Raw)(magic - ((Bits)a.low.v >> 1))}, {(Raw)(magic - ((Bits)a.high.v >> 1))}};
  }
};
using Doubles = Halves<double>;
using Floats = Halves<float>;
