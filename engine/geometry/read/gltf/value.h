// Values of a glTF document together with their location, so that every fault names its JSON pointer.
#pragma once
#include <boost/json.hpp>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "engine/geometry/read/gltf.h"

namespace truestep::gltf {

inline constexpr double kMostValue = 1e12;

[[noreturn]] inline void fail(const std::string& where, const std::string& why) {
  throw GltfFault(where + ": " + why);
}

/// One value of the document, or the location of a missing one.
class Value {
 public:
  Value(const boost::json::value* v, std::string where) : v_(v), where_(std::move(where)) {}
  const std::string& where() const { return where_; }
  bool there() const { return v_ != nullptr; }
  Value member(std::string_view name) const {
    const std::string at = where_ + "/" + std::string(name);
    if (!v_) return {nullptr, at};
    const auto* o = v_->if_object();
    if (!o) fail(where_, "is not an object");
    return {o->if_contains(name), at};
  }
  size_t size() const {
    if (!v_) return 0;
    const auto* a = v_->if_array();
    if (!a) fail(where_, "is not an array");
    return a->size();
  }
  Value operator[](size_t k) const {
    const std::string at = where_ + "/" + std::to_string(k);
    if (k >= size()) fail(at, "is missing");
    return {&v_->get_array()[k], at};
  }
  double number() const {
    if (!v_) fail(where_, "is missing");
    double x = 0;
    if (v_->is_double()) {
      x = v_->get_double();
    } else if (v_->is_int64()) {
      x = static_cast<double>(v_->get_int64());
    } else if (v_->is_uint64()) {
      x = static_cast<double>(v_->get_uint64());
    } else {
      fail(where_, "is not a number");
    }
    if (!(std::abs(x) <= kMostValue)) fail(where_, "is not finite or too large");
    return x;
  }
  double number_or(double otherwise) const { return v_ ? number() : otherwise; }
  /// False without a value.
  bool flag() const {
    if (!v_) return false;
    if (!v_->is_bool()) fail(where_, "is neither true nor false");
    return v_->get_bool();
  }
  /// An integer from 0 to below `count`.
  size_t index(size_t count, const char* what) const {
    const double x = number();
    if (!(x >= 0 && x < static_cast<double>(count)) || x != std::floor(x)) {
      fail(where_, "there is no " + std::string(what) + " " +
                       (x == std::floor(x) ? std::to_string(static_cast<int64_t>(x)) : std::to_string(x)));
    }
    return static_cast<size_t>(x);
  }
  std::string text_or(const std::string& otherwise) const {
    if (!v_) return otherwise;
    const auto* s = v_->if_string();
    if (!s) fail(where_, "is not a string");
    return std::string(*s);
  }

 private:
  const boost::json::value* v_;
  std::string where_;
};

}  // namespace truestep::gltf
