#include "engine/systems/molecular/neighbour_list.h"

#include <algorithm>
#include <cstring>

#include "engine/kernels/molecular/near_rows.h"

namespace truestep::molecular {
namespace {

/// Owner of the two points that only fix the grid's extent.
constexpr uint32_t kNobody = UINT32_MAX;
constexpr double kFar = 1e30;  // m
/// Spare room for images and neighbours beyond the first list, so that later ones do not allocate.
constexpr double kRoom = 1.5;

template <class V>
void make_room(V& v, size_t n) {
  if (v.capacity() < n) v.reserve(static_cast<size_t>(kRoom * static_cast<double>(n)) + 64);
}

}  // namespace

void NeighbourList::update(const ListSetting& setting, std::span<const double> reference, const Cell& cell,
                           const ThreadArena& arena) {
  if (reference.size() == reference_.size() && cell == cell_ && setting.reach == reach_ &&
      std::memcmp(reference.data(), reference_.data(), reference.size_bytes()) == 0) {
    return;
  }
  reference_.assign(reference.begin(), reference.end());
  cell_ = cell, reach_ = setting.reach;
  add_images(setting, reference, cell);
  sort(setting, arena);
  const size_t n = centres_.size();
  ranges_.resize(n);
  blocks_.resize((n + kBlock - 1) / kBlock);
  arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) { find(setting, begin, end); });
}

void NeighbourList::add_images(const ListSetting& setting, std::span<const double> reference,
                               const Cell& cell) {
  const size_t n = reference.size() / 3;
  points_.clear(), offsets_.clear(), atoms_.clear();
  make_room(points_, 3 * n), make_room(offsets_, 3 * n), make_room(atoms_, n);
  const auto add = [&](uint32_t atom, const Vec3& at, const Vec3& offset) {
    points_.insert(points_.end(), {at.x, at.y, at.z});
    offsets_.insert(offsets_.end(), {offset.x, offset.y, offset.z});
    atoms_.push_back(atom);
  };
  for (size_t i = 0; i < n; ++i) {
    const Vec3 x = load3(reference.data(), i), m = cell.image(x);
    const Vec3 offset{-m.x * cell.edges.x, -m.y * cell.edges.y, -m.z * cell.edges.z};
    add(static_cast<uint32_t>(i), x + offset, offset);
  }
  if (cell.sides == Sides::open) return;
  const Vec3 margin{setting.reach, setting.reach, setting.reach};
  const Vec3 low = cell.low - margin, high = cell.low + cell.edges + margin;
  // Shifts along an axis that bring a position into the margin.
  const auto shifts = [](double at, double edge, double from, double to, double out[3]) {
    int count = 0;
    out[count++] = 0;
    if (at + edge < to) out[count++] = edge;
    if (at - edge > from) out[count++] = -edge;
    return count;
  };
  for (size_t i = 0; i < n; ++i) {
    const Vec3 at = load3<double>(points_.data(), i), own = load3<double>(offsets_.data(), i);
    double sx[3], sy[3], sz[3];
    const int nx = shifts(at.x, cell.edges.x, low.x, high.x, sx);
    const int ny = shifts(at.y, cell.edges.y, low.y, high.y, sy);
    const int nz = shifts(at.z, cell.edges.z, low.z, high.z, sz);
    for (int k = 1; k < nx * ny * nz; ++k) {
      const Vec3 shift{sx[k % nx], sy[k / nx % ny], sz[k / (nx * ny)]};
      add(static_cast<uint32_t>(i), at + shift, own + shift);
    }
  }
  // Keeps the grid's cells the same at every rebuild.
  add(kNobody, low, {}), add(kNobody, high, {});
}

void NeighbourList::sort(const ListSetting& setting, const ThreadArena& arena) {
  const size_t n = reference_.size() / 3;
  grid_.reserve(points_.capacity() / 3);
  grid_.build(points_, setting.reach, arena);
  // Without atoms whose position is not finite, which have no neighbours.
  const size_t all = grid_.size();
  for (auto* column : {&px_, &py_, &pz_}) make_room(*column, all + 4), column->resize(all + 4);
  make_room(shift_, 3 * all), make_room(owner_, all), make_room(kinds_, all + 1);
  if (rows_.capacity() < 4 * all + 4) rows_.reserve(6 * all + 256);
  rows_.resize(4 * all + 4), shift_.resize(3 * all), owner_.resize(all), kinds_.resize(all + 1);
  make_room(centres_, n);
  centres_.clear();
  for (size_t row = 0; row < all; ++row) {
    const uint32_t point = grid_.point(row), atom = atoms_[point];
    const Vec3 at = grid_.position(row);
    px_[row] = at.x, py_[row] = at.y, pz_[row] = at.z;
    owner_[row] = atom;
    store3(shift_.data(), row, load3<double>(offsets_.data(), point));
    kinds_[row] = atom == kNobody ? 0 : setting.kinds[atom];
    rows_[4 * row + 3] = atom == kNobody ? 0 : setting.charges[atom];
    if (point < n) centres_.push_back(static_cast<uint32_t>(row));
  }
  kinds_[all] = 0;
  for (size_t k = 0; k < 4; ++k) rows_[4 * all + k] = k < 3 ? kFar : 0;
}

void NeighbourList::find(const ListSetting& setting, size_t begin, size_t end) {
  std::vector<uint32_t>& out = blocks_[begin / kBlock];
  const double reach2 = setting.reach * setting.reach;
  const PlaceColumns places{px_.data(), py_.data(), pz_.data()};
  const bool first = out.empty();
  const auto far = static_cast<uint32_t>(owner_.size());
  size_t used = 0;
  for (size_t k = begin; k < end; ++k) {
    const uint32_t row = centres_[k];
    const Vec3 at{px_[row], py_[row], pz_[row]};
    const size_t start = used;
    grid_.near(at, [&](size_t from, size_t to) {
      if (out.size() < used + (to - from) + 4) out.resize(2 * out.size() + (to - from) + 64);
      uint32_t* list = out.data();
      const size_t before = used;
      used = append_near(places, from, to, at, reach2, list, used);
      if (row < from || row >= to) return;
      // An atom is not its own neighbour.
      used = static_cast<size_t>(std::remove(list + before, list + used, row) - list);
    });
    used = start + keep_allowed(setting, owner_[row], out.data() + start, used - start);
    while ((used - start) % 4 != 0) out[used++] = far;
    ranges_[k] = {static_cast<uint32_t>(start), static_cast<uint32_t>(used - start)};
  }
  if (first) out.resize(static_cast<size_t>(kRoom * static_cast<double>(used)) + 1024);
}

size_t NeighbourList::keep_allowed(const ListSetting& setting, uint32_t atom, uint32_t* list,
                                   size_t count) const {
  const Exclusions& e = setting.exclusions;
  if (e.empty() || e.begin[atom] == e.begin[atom + 1]) return count;
  const uint32_t *from = e.partners.data() + e.begin[atom], *to = e.partners.data() + e.begin[atom + 1];
  return static_cast<size_t>(
      std::remove_if(list, list + count,
                     [&](uint32_t row) { return std::find(from, to, owner_[row]) != to; }) -
      list);
}

void NeighbourList::place(const double* x, const ThreadArena& arena) {
  arena.for_blocks(owner_.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const uint32_t atom = owner_[row];
      double* to = rows_.data() + 4 * row;
      if (atom == kNobody) {
        to[0] = to[1] = to[2] = kFar;
        continue;
      }
      const double* at = x + 3 * static_cast<size_t>(atom);
      for (size_t k = 0; k < 3; ++k) to[k] = at[k] + shift_[3 * row + k];
    }
  });
}

}  // namespace truestep::molecular
