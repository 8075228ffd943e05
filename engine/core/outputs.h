// What a kind of system gives out, in words: its rows, its fields and its observables, for the descriptions
// that people and programs read. Parts in angle brackets stand for names of the scene's own
// ("joint.<id>.force").
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
  std::string_view rows;  ///< what row k is: what a probe's or a command's index counts
  std::vector<FieldOutput> fields;
  std::vector<OutputInfo> observables;
};

}  // namespace truestep
