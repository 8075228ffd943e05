#include "engine/integrators/table/integrators.h"

#include <vector>

#include "engine/base/errors.h"
#include "engine/base/text/nearest_name.h"
#include "engine/integrators/table/rows.h"

namespace truestep {

std::span<const Integrator> integrators() {
  static const std::vector<Integrator> kTable = [] {
    std::vector<Integrator> all;
    for (const auto rows : {classical_rows(), composition_rows(), runge_kutta_rows(), second_order_rows(),
                            implicit_rows(), descent_rows(), stiff_rows(), cvode_rows()}) {
      all.insert(all.end(), rows.begin(), rows.end());
    }
    return all;
  }();
  return kTable;
}

const Integrator* find_integrator(std::string_view name) {
  for (const Integrator& m : integrators()) {
    if (m.name == name) return &m;
  }
  return nullptr;
}

const Integrator& choose_integrator(const IntegratorChoice& choice, std::string_view fallback,
                                    const ForceField& field) {
  const std::string_view name = choice.name.empty() ? fallback : std::string_view(choice.name);
  const Integrator* method = find_integrator(name);
  const std::string why = method ? refusal(*method, field).value_or("") : "no integrator has this name";
  if (why.empty()) return *method;
  // Only now: what others need of the field is as expensive to find out as the field is large.
  std::string allowed;
  std::vector<std::string> fitting;
  for (const Integrator& m : integrators()) {
    if (refusal(m, field)) continue;
    allowed += (allowed.empty() ? "" : ", ") + std::string(m.name);
    fitting.emplace_back(m.name);
  }
  throw Error("scene_invalid", "integrator " + std::string(name) + ": " + why,
              {"/integrator", method ? "unsuitable_integrator" : "unknown_integrator", why,
               '"' + std::string(name) + '"', allowed, method ? "" : nearest_name(name, fitting), ""});
}

}  // namespace truestep
