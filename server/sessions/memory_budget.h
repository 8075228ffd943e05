// What the service may use of memory, shared by all that uses much: sessions with their past, snapshots,
// studies, bodies that are read. Whoever wants some leases it before allocating, by its estimate.
#pragma once
#include <mutex>
#include <string>

namespace truestep {

class MemoryBudget {
 public:
  explicit MemoryBudget(double bytes) : limit_(bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  /// Given back when it goes.
  class Lease {
   public:
    Lease() = default;
    Lease(Lease&& other) noexcept;
    Lease& operator=(Lease&& other) noexcept;
    ~Lease();
    double bytes() const { return bytes_; }
    /// False, and nothing changed, when there is no room for more.
    bool resize(double bytes);
    /// The same or Error "quota_exceeded", naming `what`.
    void require(double bytes, const std::string& what);
    /// Counts what is there already, room or not.
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
