// Unit quaternions in 32 bits each: the largest component is left out, the other three are integers.
//   q ~ -q, so the omitted one is made positive: sqrt(1 - a^2 - b^2 - c^2), with |a|, |b|, |c| <= 1 / sqrt(2)
//   bits 30-31: index of the omitted one (w x y z = 0 1 2 3)
//   bits 20-29, 10-19, 0-9: the others in that order, k = 511 + round(a * 511 sqrt(2)), 0 ... 1022
// The quantum is 1 / (511 sqrt(2)); 0 is exact. An error of half a quantum in all three is worst when all
// four components are equal; the rotation between q and its decoded form is then 4 sqrt(3) half quanta,
// 4.80e-3 rad or 0.275 degrees. (The "smallest three" packing common in network games.)
#pragma once
#include <cstddef>
#include <cstdint>

namespace truestep {

/// Largest rotation (rad) between a unit quaternion and its packed form.
inline constexpr double kQuaternionPackingError = 4.8e-3;

/// Packs `count` quaternions w x y z, normalising them; false when one is zero or not finite, and then `out`
/// is meaningless.
bool pack_quaternions(const float* wxyz, size_t count, uint32_t* out);

}  // namespace truestep
