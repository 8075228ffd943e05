// What `run` says at its end, for people: plain where programs read it, aligned and in colours on a terminal.
#pragma once
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "engine/session/expectation.h"
#include "engine/session/session.h"

namespace truestep {

/// Whether the run reached the end, to which the scene's expectations refer.
enum class Reach : uint8_t { whole, cut_short };
constexpr const char* kNotJudged = "ended before the duration";

/// Whether a person sees what is written there; the variable NO_COLOR (no-color.org) says no for colours'
/// sake.
bool is_terminal(int descriptor);

class RunReport {
 public:
  RunReport(std::ostream& out, bool terminal) : out_(out), terminal_(terminal) {}
  void head(const Session& session, double wall_seconds);
  /// "name = value unit", one a line; on a terminal the signs of equality stand below each other.
  void values(const Observables& values);
  void chosen(std::string_view method);
  void verdicts(const std::vector<Verdict>& verdicts, Reach reach);

 private:
  /// The text, in a colour of the terminal's ("32" is green) where there is one.
  std::string coloured(const char* colour, const std::string& text) const;

  std::ostream& out_;
  bool terminal_;
};

}  // namespace truestep
