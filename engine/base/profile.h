// Where a step's time goes: seconds and calls per named pass. Not part of any state, never hashed.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace truestep {

/// Time spent per pass, in the order in which the passes first ran.
class Profile {
 public:
  struct Row {
    std::string name;
    double seconds = 0;
    uint64_t calls = 0;
  };
  void add(std::string_view name, double seconds);
  const std::vector<Row>& rows() const { return rows_; }

 private:
  std::vector<Row> rows_;
};

/// Adds its own lifetime to a pass; with a null profile it costs one branch.
class ProfileScope {
 public:
  ProfileScope(Profile* profile, std::string_view name) : profile_(profile), name_(name) {
    if (profile_) start_ = std::chrono::steady_clock::now();
  }
  ~ProfileScope() {
    if (profile_) end();
  }
  ProfileScope(const ProfileScope&) = delete;
  ProfileScope& operator=(const ProfileScope&) = delete;

 private:
  void end();

  Profile* profile_;
  std::string_view name_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace truestep
