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
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  /// n elements under `key` with unspecified contents; the memory is reused from step to step. Spans
  /// obtained earlier under other keys stay valid.
  std::span<double> doubles(std::string_view key, size_t n);

  /// The object of type T under `key`, default-constructed at first use. A key belongs to one type.
  template <class T>
  T& object(std::string_view key) {
    if (void* there = find(key, typeid(T))) return *static_cast<T*>(there);
    return *static_cast<T*>(add(key, typeid(T), std::make_shared<T>()));
  }

  /// Forgets everything.
  void clear();

 private:
  struct Slot {
    std::string key;
    const std::type_info* type;
    std::shared_ptr<void> object;
  };
  void* find(std::string_view key, const std::type_info& type) const;
  void* add(std::string_view key, const std::type_info& type, std::shared_ptr<void> object);

  std::vector<Slot> slots_;
};

}  // namespace truestep
