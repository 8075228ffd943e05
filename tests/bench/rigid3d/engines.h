// The engines that alternate on a scene: ours, Rapier3d from its library, Bullet if installed.
#pragma once
#include <memory>

#include "tests/bench/rigid3d/scenes.h"
#include "tests/bench/sleep.h"

namespace truestep::bench {

inline constexpr double kSpaceDt = 1.0 / 60;

struct SpaceEngine {
  virtual ~SpaceEngine() = default;
  virtual void step() = 0;
  virtual SpaceState state(size_t body) const = 0;
  virtual bool asleep(size_t body) const = 0;
};

struct OursSettings {
  int threads = 1;
  Sleep sleep = Sleep::never;
  enum class Numbers { f32, f64 } numbers = Numbers::f32;
};
std::unique_ptr<SpaceEngine> make_ours(const SpaceScene& scene, const OursSettings& settings = {});

/// The peer of peers/rapier3d; null if the library at `path` does not exist or is a different one.
class RapierLibrary {
 public:
  static std::unique_ptr<RapierLibrary> open(const char* path);
  std::unique_ptr<SpaceEngine> make(const SpaceScene& scene, Sleep sleep = Sleep::never) const;

  void* (*create)(const double*) = nullptr;
  void (*body)(void*, int, const double*, const double*, const double*, int, int, int, double, double, double,
               const double*) = nullptr;
  void (*ball)(void*, int, int, const double*, const double*) = nullptr;
  void (*step)(void*, double) = nullptr;
  void (*motion)(void*, int, double*) = nullptr;
  int (*asleep)(void*, int) = nullptr;
};

/// Null if Bullet is not installed.
std::unique_ptr<SpaceEngine> make_bullet(const SpaceScene& scene, Sleep sleep = Sleep::never);

}  // namespace truestep::bench
