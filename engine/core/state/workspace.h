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
  Workspace(const Workspace&);
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(const Workspace&);
  Workspace& operator=(Workspace&&) noexcept;
  ~Workspace();

  /// n elements under `key` with unspecified contents; the memory is reused from step to step. Spans
  /// obtained earlier under other keys stay valid.
  std::span<double> doubles(std::string_view key, size_t n);

  /// The object of type T under `key`, default-constructed at first use. A key belongs to one type.
  template <class T>
  T& object(std::string_view key) {
    if (void* found = find(key, typeid(T))) return *static_cast<T*>(found);
    return *static_cast<T*>(keep(key, typeid(T), std::make_shared<T>()));
  }

  /// Forgets everything.
  void clear();

 private:
  /// Null: nothing of this type is kept under `key`.
  void* find(std::string_view key, const std::type_info& type);
  void* keep(std::string_view key, const std::type_info& type, std::shared_ptr<void> object);

  struct Slot {
    std::string key;
    const std::type_info* type;
    std::shared_ptr<void> object;
  };
  std::vector<Slot> slots_;
};

}  // namespace truestep
