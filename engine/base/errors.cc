#include "engine/base/errors.h"

#include <utility>

template class std::vector<truestep::Issue>;
template class std::vector<std::string>;

namespace truestep {

Error::Error(std::string code, const std::string& detail)
    : std::runtime_error(detail), code_(std::move(code)) {}
Error::Error(std::string code, const std::string& detail, std::vector<Issue> issues)
    : std::runtime_error(detail), code_(std::move(code)), issues_(std::move(issues)) {}
Error::Error(std::string code, const std::string& detail, Issue issue)
    : std::runtime_error(detail), code_(std::move(code)) {
  issues_.push_back(std::move(issue));
}
Error::Error(const Error&) = default;
Error& Error::operator=(const Error&) = default;
Error::~Error() = default;

Instability::Instability(std::string system, std::string quantity, long long index, const std::string& detail)
    : Error("instability", detail), system(std::move(system)), quantity(std::move(quantity)), index(index) {}
Instability::Instability(const Instability&) = default;
Instability& Instability::operator=(const Instability&) = default;
Instability::~Instability() = default;

}  // namespace truestep
