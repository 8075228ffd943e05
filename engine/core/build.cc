#include "engine/core/build.h"

#include "engine/base/errors.h"

namespace truestep {

const Integrator& choose_integrator(const IntegratorChoice& choice, std::string_view fallback,
                                    const ForceField& field) {
  const std::string_view name = choice.name.empty() ? fallback : std::string_view(choice.name);
  std::string allowed;
  for (const Integrator& m : integrators()) {
    if (!refusal(m, field)) allowed += (allowed.empty() ? "" : ", ") + std::string(m.name);
  }
  const Integrator* method = find_integrator(name);
  const std::string why = method ? refusal(*method, field).value_or("") : "no integrator has this name";
  if (!why.empty()) {
    throw Error("scene_invalid", "integrator " + std::string(name) + ": " + why,
                {{"/integrator", method ? "unsuitable_integrator" : "unknown_integrator", why,
                  '"' + std::string(name) + '"', allowed, "", ""}});
  }
  return *method;
}

}  // namespace truestep
