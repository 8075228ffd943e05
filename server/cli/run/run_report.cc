#include "server/cli/run/run_report.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace truestep {

bool is_terminal(int descriptor) {
  const char* plain = std::getenv("NO_COLOR");
  return isatty(descriptor) == 1 && !(plain && *plain);
}

std::string RunReport::coloured(const char* colour, const std::string& text) const {
  return terminal_ ? std::string("\033[") + colour + 'm' + text + "\033[0m" : text;
}

void RunReport::head(const Session& session, double wall_seconds) {
  out_ << "steps   " << session.step_index() << "\ntime    " << session.time() << " s\nwall    "
       << wall_seconds << " s\nhash    " << hex64(session.hash()) << '\n';
}

void RunReport::values(const Observables& values) {
  size_t width = 0;
  if (terminal_) {
    for (const Observation& v : values.rows()) width = std::max(width, v.name.size());
    width = std::min<size_t>(width, 40);
  }
  for (const Observation& v : values.rows()) {
    out_ << v.name << std::string(width > v.name.size() ? width - v.name.size() : 0, ' ') << " = "
         << (terminal_ && v.value >= 0 ? " " : "") << v.value << ' ' << v.unit << '\n';
  }
}

void RunReport::chosen(std::string_view method) {
  out_ << "chosen  " << method << '\n';
}

void RunReport::verdicts(const std::vector<Verdict>& verdicts, Reach reach) {
  for (const Verdict& v : verdicts) {
    out_ << (reach == Reach::cut_short ? "-       "
             : v.met                   ? coloured("32", "ok      ")
                                       : coloured("31", "MISSED  "));
    out_ << v.expected.quantity << " = ";
    if (v.measured)
      out_ << *v.measured;
    else
      out_ << "(no such quantity)";
    if (v.drift_scale == 0.0) out_ << " (absolute: it starts at 0)";
    if (v.expected.min) out_ << ", at least " << *v.expected.min;
    if (v.expected.max) out_ << ", at most " << *v.expected.max;
    if (v.expected.equals) out_ << ", expected " << *v.expected.equals << " +- " << v.expected.tolerance;
    if (reach == Reach::cut_short) out_ << ": not judged: " << kNotJudged;
    out_ << '\n';
  }
}

}  // namespace truestep
