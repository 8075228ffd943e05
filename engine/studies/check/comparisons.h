// What comparing the runs of a scene test needs beside SceneCheck itself.
#pragma once
#include <optional>
#include <string>

#include "engine/studies/check/trial.h"

namespace truestep {

inline constexpr const char* kSame = "same";
inline constexpr const char* kAgree = "agree";

/// Whether runs that differ in this name alone must end with the same bits, without being told.
bool keeps_bits(const std::string& axis);
/// Of a result's quantity.
std::optional<double> measured(const TrialResult& r, const std::string& quantity);
std::string number(double x);

}  // namespace truestep
