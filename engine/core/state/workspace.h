// Scratch memory of a session. It may be discarded between any two steps without changing a bit: its contents
// are either rewritten before they are read, or a cache of something the state determines.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <typeinfo>
#include <vector>

#include "engine/core/state/state.h"

namespace truestep {

class Workspace {
 public:
  /// n elements under `key` with unspecified contents; the memory is reused from step to step. Spans
  /// obtained earlier under other keys stay valid.
  std::span<double> doubles(std::string_view key, size_t n) { return object<Buffer>(key).get(n); }

  /// The object of type T under `key`, default-constructed at first use. A key belongs to one type.
  template <class T>
  T& object(std::string_view key) {
    for (Slot& s : slots_) {
      if (s.key == key && *s.type == typeid(T)) return *static_cast<T*>(s.object.get());
    }
    slots_.push_back({std::string(key), &typeid(T), std::make_shared<T>()});
    return *static_cast<T*>(slots_.back().object.get());
  }

  /// Forgets everything.
  void clear() { slots_.clear(); }

 private:
  struct Buffer {
    std::vector<double, CacheLineAllocator<double>> data;
    std::span<double> get(size_t n) {
      if (data.size() < n) data.resize(n);
      return {data.data(), n};
    }
  };
  struct Slot {
    std::string key;
    const std::type_info* type;
    std::shared_ptr<void> object;
  };
  std::vector<Slot> slots_;
};

}  // namespace truestep
