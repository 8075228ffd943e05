// What is in a file of another program, read as scenes read it: counts and values by name, or why it is
// refused.
#pragma once
#include <map>
#include <string>
#include <string_view>

namespace truestep::testing_files {

struct MeasuredFile {
  std::map<std::string, double> numbers;
  std::map<std::string, std::string> words;  ///< lists of names
  std::string refused;                       ///< the reason; empty: it was read
};

/// By the name's ending; `use` is the key "as" of a scene.
MeasuredFile measure_file(std::string_view ending, std::string_view bytes, const std::string& use);

}  // namespace truestep::testing_files
