// Faults that were found, beside those that a test wants to be found.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene_test.h"

namespace truestep {

/// The faults that an error names; itself when it names none.
std::vector<Issue> faults_of(const Error& e);

std::string described(const Issue& i);
std::string described(const TestRefusal& r);

/// Whether a fault is the one that was wanted.
bool is_fault(const Issue& found, const TestRefusal& wanted);

/// The first fault that is not the one that was wanted.
std::optional<Issue> other_fault(const std::vector<Issue>& found, const TestRefusal& wanted);

/// What is wrong when exactly the faults `wanted` should have been found, in any order; empty: nothing.
std::string differing_faults(const std::vector<Issue>& found, const std::vector<TestRefusal>& wanted);

}  // namespace truestep
