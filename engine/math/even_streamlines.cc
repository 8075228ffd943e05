#include "engine/math/even_streamlines.h"

namespace truestep {

namespace {
using Point = std::array<double, 2>;

double apart_by(const Point& p, const Point& q) {
  const double x = p[0] - q[0], y = p[1] - q[1];
  return std::sqrt(x * x + y * y);
}

// Points of lines, sorted into squares as wide as lines are apart.
class Near {
 public:
  Near(const PlaneField& field, double apart)
      : apart_(apart),
        columns_(static_cast<size_t>(static_cast<double>(field.nx) / apart) + 1),
        rows_(static_cast<size_t>(static_cast<double>(field.ny) / apart) + 1),
        points_(columns_ * rows_) {}
  void add(const Point& p) { points_[column(p) + columns_ * row(p)].push_back(p); }
  bool any_within(const Point& p, double distance) const {
    const size_t i = column(p), j = row(p);
    for (size_t y = j > 0 ? j - 1 : 0; y <= std::min(j + 1, rows_ - 1); ++y) {
      for (size_t x = i > 0 ? i - 1 : 0; x <= std::min(i + 1, columns_ - 1); ++x) {
        for (const Point& q : points_[x + columns_ * y]) {
          if (apart_by(p, q) < distance) return true;
        }
      }
    }
    return false;
  }

 private:
  size_t column(const Point& p) const { return square(p[0], columns_); }
  size_t row(const Point& p) const { return square(p[1], rows_); }
  size_t square(double x, size_t n) const {
    return std::min(static_cast<size_t>(std::max(0.0, x / apart_)), n - 1);
  }
  double apart_;
  size_t columns_, rows_;
  std::vector<std::vector<Point>> points_;
};
}  // namespace

std::vector<std::vector<Point>> even_streamlines(const PlaneField& field, size_t count) {
  constexpr double kStep = 0.5, kApart = 0.5;
  const double first = -field.margin, width = static_cast<double>(field.nx - 1) - 2 * first,
               height = static_cast<double>(field.ny - 1) - 2 * first;
  const double spacing = std::sqrt(width * height / static_cast<double>(count));
  const double apart = std::max(1.0, kApart * spacing);
  const auto columns = static_cast<size_t>(std::max(1.0, std::round(width / spacing)));
  const size_t rows = (count + columns - 1) / columns, most = 2 * (field.nx + field.ny);
  // How far behind itself a line does not look.
  const auto own = static_cast<size_t>(2 * apart / kStep);
  Near near(field, apart);
  std::vector<std::vector<Point>> out;
  for (size_t k = 0; k < count; ++k) {
    const size_t column = k % columns, row = k / columns;
    const double x = first + (static_cast<double>(column) + 0.5) / static_cast<double>(columns) * width;
    const double y = first + (static_cast<double>(row) + 0.5) / static_cast<double>(rows) * height;
    if (near.any_within({x, y}, apart)) continue;
    std::vector<Point> added;
    for (const double h : {kStep, -kStep}) {
      std::vector<Point> line = streamline(field, x, y, h, most);
      Near itself(field, apart);
      size_t n = 1;
      for (; n < line.size(); ++n) {
        if (n > own) itself.add(line[n - own - 1]);
        const bool round = n > own && apart_by(line[n], {x, y}) < kStep;
        if (round) {
          line[n++] = {x, y};
          break;
        }
        if (near.any_within(line[n], 0.5 * apart)) break;
        // A line that comes back beside its beginning ends there; one that closes may come all the way.
        if (itself.any_within(line[n], 0.25 * apart) && apart_by(line[n], {x, y}) > apart) break;
      }
      line.resize(n);
      const bool closed = n > 1 && line.back() == Point{x, y};
      added.insert(added.end(), line.begin(), line.end());
      if (line.size() > 1) out.push_back(std::move(line));
      if (closed) break;
    }
    for (const Point& p : added) near.add(p);
  }
  return out;
}

}  // namespace truestep
