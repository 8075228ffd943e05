// The service's memory budget, shared by everything large: sessions with their history, snapshots, studies,
// request bodies. Memory is leased by estimate before it is allocated.
#pragma once
#include <mutex>
#include <string>

namespace truestep {

class MemoryBudget {
 public:
  explicit MemoryBudget(double bytes) : limit_(bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  /// Returned to the budget on destruction.
  class Lease {
   public:
    Lease() = default;
    Lease(Lease&& other) noexcept;
    Lease& operator=(Lease&& other) noexcept;
    ~Lease();
    double bytes() const { return bytes_; }
    /// Returns false and changes nothing when there is no room.
    bool resize(double bytes);
    /// Like resize, but throws Error "quota_exceeded" naming `what`.
    void require(double bytes, const std::string& what);
    /// Books memory that is already in use, whether or not there is room.
    void count(double bytes);

   private:
    friend class MemoryBudget;
    Lease(MemoryBudget& budget, double bytes) : budget_(&budget), bytes_(bytes) {}
    MemoryBudget* budget_ = nullptr;
    double bytes_ = 0;
  };

  /// Error "quota_exceeded", naming `what`, when there is no room.
  Lease lease(double bytes, const std::string& what);
  double used() const;
  double limit() const { return limit_; }

 private:
  bool take(double more);
  [[noreturn]] void refuse(double bytes, const std::string& what) const;
  const double limit_;
  mutable std::mutex mutex_;
  double used_ = 0;
};

}  // namespace truestep
