// Runs solvers on request, so that a script can alternate between them and solvers in other languages: one
// JSON object per line in, one per line out.
//   {"list": true}                                       -> {"problems": [{name, start ..., solvers: [...]}]}
//   {"versions": true}                                   -> {"Boost": "1.81.0", ...}
//   {"problem": p, "solver": s, "digits": d, "least": t} -> {"seconds", "error", "evaluations"};
//                                                           error null: gave up
//   {"judge": p, "end": [...]}                           -> {"error"}, of another program's result
//   {"plot": {title, x_label, y_label, series: [...]}}   -> {"svg": "..."}, drawn as the studies' plots are
// `seconds` is CPU time of the thread per run, repeated until at least `least` seconds have passed.
#include <sundials/sundials_version.h>

#include <algorithm>
#include <boost/json.hpp>
#include <boost/version.hpp>
#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>

#include "engine/studies/study_result.h"
#include "tests/bench/ode/problems.h"
#include "tests/bench/report.h"

namespace truestep::bench {
namespace {

namespace json = boost::json;

json::value number_or_null(double v) {
  return std::isfinite(v) ? json::value(v) : json::value(nullptr);
}

json::object list(const std::vector<Problem>& all) {
  json::array out;
  for (const Problem& p : all) {
    json::array solvers;
    for (const Solver& s : p.solvers) {
      solvers.push_back(json::object{{"name", s.name}, {"side", s.side}, {"from", s.from}, {"to", s.to}});
    }
    out.push_back(json::object{{"name", p.at.name},
                               {"start", json::array(p.at.start.begin(), p.at.start.end())},
                               {"t_end", p.at.t_end},
                               {"absolute_scale", p.at.absolute_scale},
                               {"k", p.at.stiffness},
                               {"c", p.at.damping},
                               {"solvers", std::move(solvers)}});
  }
  return {{"problems", std::move(out)}};
}

const Problem& find(const std::vector<Problem>& all, const json::value& name) {
  for (const Problem& p : all) {
    if (p.at.name == name.as_string()) return p;
  }
  throw std::invalid_argument("no such problem");
}

json::object run(const Problem& p, const json::object& request) {
  const auto named = [&](const Solver& s) { return s.name == request.at("solver").as_string(); };
  const Solver& solver = *std::find_if(p.solvers.begin(), p.solvers.end(), named);
  const double tolerance = std::pow(10.0, -request.at("digits").to_number<double>());
  const double least = request.at("least").to_number<double>(), start = thread_seconds();
  Outcome out;
  int runs = 0;
  do out = solver.run(tolerance), ++runs;
  while (thread_seconds() - start < least);
  const double seconds = (thread_seconds() - start) / runs;
  const double error = out.end.empty() ? HUGE_VAL : p.at.error(out.end.data());
  return {{"seconds", seconds}, {"error", number_or_null(error)}, {"evaluations", out.evaluations}};
}

json::object versions() {
  constexpr int kBoost = BOOST_VERSION;
  const auto text = [](int v) { return std::to_string(v); };
  return {{"Boost", text(kBoost / 100000) + '.' + text(kBoost / 100 % 1000) + '.' + text(kBoost % 100)},
          {"SUNDIALS", SUNDIALS_VERSION},
          {"gcc", __VERSION__}};
}

std::vector<double> numbers(const json::value& array) {
  std::vector<double> out;
  for (const json::value& v : array.as_array()) out.push_back(v.to_number<double>());
  return out;
}

json::object plot(const json::object& asked) {
  using Style = StudyPlot::Series::Style;
  StudyPlot drawn{.title = std::string(asked.at("title").as_string()),
                  .x_label = std::string(asked.at("x_label").as_string()),
                  .y_label = std::string(asked.at("y_label").as_string())};
  for (const json::value& v : asked.at("series").as_array()) {
    const json::object& s = v.as_object();
    drawn.series.push_back({.name = std::string(s.at("name").as_string()),
                            .x = numbers(s.at("x")),
                            .y = numbers(s.at("y")),
                            .style = s.at("style").as_string() == "dashed" ? Style::dashed_and_markers
                                                                           : Style::line_and_markers});
  }
  return {{"svg", result_svg(drawn)}};
}

}  // namespace
}  // namespace truestep::bench

int main() {
  using namespace truestep::bench;
  const auto all = problems();
  for (std::string line; std::getline(std::cin, line);) {
    const auto request = json::parse(line).as_object();
    json::object answer;
    if (request.contains("list")) {
      answer = list(all);
    } else if (request.contains("versions")) {
      answer = versions();
    } else if (request.contains("plot")) {
      answer = plot(request.at("plot").as_object());
    } else if (request.contains("judge")) {
      const double error = find(all, request.at("judge")).at.error(numbers(request.at("end")).data());
      answer = {{"error", number_or_null(error)}};
    } else {
      answer = run(find(all, request.at("problem")), request);
    }
    std::cout << answer << std::endl;
  }
}
