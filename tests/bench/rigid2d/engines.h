// The engines in the plane that alternate on a scene: ours, Rapier2d and Box2D v3 from their libraries, Box2D
// 2.4 if installed.
#pragma once
#include <memory>

#include "tests/bench/rigid2d/scenes.h"
#include "tests/bench/sleep.h"

namespace truestep::bench {

struct FlatEngine {
  virtual ~FlatEngine() = default;
  virtual void step() = 0;
  virtual FlatState look(size_t body) const = 0;
  virtual bool asleep(size_t body) const = 0;
};

std::unique_ptr<FlatEngine> make_ours(const FlatScene& scene, Sleep sleep = Sleep::never);
/// Null if Box2D 2.4 is not installed.
std::unique_ptr<FlatEngine> make_box2d(const FlatScene& scene, Sleep sleep = Sleep::never);

/// A peer of peers/rapier2d or peers/box2d3.
struct FlatLibrary {
  std::string name;
  void* (*create)(double, double) = nullptr;
  int (*body)(void*, int, const double*, int) = nullptr;
  void (*shape)(void*, int, const double*, int, const double*, double, double, int) = nullptr;
  void (*revolute)(void*, int, int, double, double, double, double, double, double) = nullptr;
  void (*step)(void*, double) = nullptr;
  void (*motion)(void*, int, double*) = nullptr;
  int (*asleep)(void*, int) = nullptr;

  /// False if the library does not exist or is a different one.
  bool open(const char* path);
  std::unique_ptr<FlatEngine> make(const FlatScene& scene, Sleep sleep = Sleep::never) const;
};
/// Those of NAME=PATH that can be opened; the others are reported on stderr.
std::vector<FlatLibrary> open_flat_libraries(const std::vector<char*>& arguments);

}  // namespace truestep::bench
