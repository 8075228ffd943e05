// A system of class S, derived from Base, that answers for what it gives out from its table, S::outputs()
// (output_table.h). Its constructor calls show() when everything is known that decides on parts and fields.
#pragma once
#include <utility>

#include "engine/core/outputs/output_table.h"

namespace truestep {

template <class S, class Base>
class Tabled : public Base {
 public:
  void observe(const State& state, double t, Observables& out) const final {
    observables_.observe(S::outputs(), *this, state, t, out);
  }
  FieldView field(const State& state, size_t part, size_t field, std::vector<double>& scratch) const final {
    return shown_.field(*this, state, part, field, scratch);
  }

 protected:
  template <class... Args>
  explicit Tabled(Args&&... args) : Base(std::forward<Args>(args)...) {}
  void show() { this->set_parts(shown_.choose(S::outputs(), *this)); }

 private:
  ShownFields shown_;
  ShownObservables observables_;
};

}  // namespace truestep
