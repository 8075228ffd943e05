// Helpers of picture tests: pixels, a list with one sphere, the code of an error.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep::test {

using Pixels = std::vector<uint8_t>;

struct Rgb {
  int r, g, b;
};

inline Rgb at(const Pixels& rgba, int width, int x, int y) {
  const size_t i = 4 * (static_cast<size_t>(y) * width + x);
  return {rgba[i], rgba[i + 1], rgba[i + 2]};
}
inline int brightness(const Rgb& c) {
  return c.r + c.g + c.b;
}

inline DrawList one_sphere(Color color) {
  DrawList list;
  DrawPoints set;
  set.positions = {0, 0, 0};
  set.radius = 0.5f;
  set.color = color;
  list.points.push_back(set);
  list.camera = DrawCamera{{0, 0, 4}, {0, 0, 0}, {}, 30};
  return list;
}

inline std::string code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.code();
  }
  return "";
}

}  // namespace truestep::test
