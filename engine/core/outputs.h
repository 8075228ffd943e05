// Descriptions of what a kind of system outputs: its rows, its fields and its observables, for people and
// programs. Parts in angle brackets stand for names from the scene ("joint.<id>.force").
#pragma once
#include <string_view>
#include <vector>

namespace truestep {

struct OutputInfo {
  std::string_view name;
  std::string_view unit;  ///< SI
  std::string_view sentence;
};

/// A field has one value, or one of `width` components, per row.
struct FieldOutput {
  std::string_view name;
  std::string_view unit;
  unsigned width = 1;
  std::string_view sentence;
};

struct Outputs {
  std::string_view rows;  ///< what row k is: the index of a probe or command counts these
  std::vector<FieldOutput> fields;
  std::vector<OutputInfo> observables;
};

}  // namespace truestep
