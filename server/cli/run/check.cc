#include "server/cli/run/check.h"

#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <regex>
#include <thread>

#include "engine/base/hash.h"
#include "engine/scene/json/json_write.h"
#include "server/cli/exit_codes.h"
#include "server/cli/run/checked_files.h"

namespace truestep {

namespace json = boost::json;

namespace {

struct CheckOptions {
  std::vector<std::string> paths;
  std::string filter;
  int jobs = 0;
  bool json = false, list = false;
};

/// "drop.json: dt = 0.01: energy.drift = 0.3, wanted at most 0.01: detail"
std::string sentence(const std::string& path, const CheckFinding& f) {
  std::string out = path + ": ";
  if (!f.variation.empty()) out += f.variation + ": ";
  out += f.quantity;
  if (f.measured) out += " = " + write_json(json::value(*f.measured));
  if (!f.wanted.empty()) out += ", wanted " + f.wanted;
  if (!f.detail.empty()) out += ": " + f.detail;
  return out;
}

json::object describe(const CheckFinding& f) {
  const bool known = f.measured && std::isfinite(*f.measured);
  return {{"variation", f.variation},
          {"quantity", f.quantity},
          {"measured", known ? json::value(*f.measured) : json::value(nullptr)},
          {"wanted", f.wanted},
          {"detail", f.detail}};
}

/// What each run of a scene measured.
json::array describe_runs(const SceneCheck& check) {
  json::array out;
  for (size_t i = 0; i < check.size(); ++i) {
    const TrialResult& r = check.result(i);
    json::object measured;
    for (const Verdict& v : r.verdicts) {
      const bool known = v.measured && std::isfinite(*v.measured);
      measured[v.expected.quantity] = known ? json::value(*v.measured) : json::value(nullptr);
    }
    out.push_back(json::object{{"variation", check.variation(i)},
                               {"steps", r.steps},
                               {"state_hash", hex64(r.hash)},
                               {"measured", std::move(measured)}});
  }
  return out;
}

std::string issues_of(const Error& e) {
  std::string out = e.what();
  for (const Issue& i : e.issues()) out += "; " + i.pointer + ": " + i.message;
  return out;
}

void list_files(const std::vector<CheckedFile>& files, std::ostream& out) {
  for (const CheckedFile& f : files) {
    out << f.path;
    if (f.check) {
      out << ": " << f.check->size() << (f.check->size() == 1 ? " run" : " runs");
      if (!f.check->why().empty()) out << ": " << f.check->why();
    }
    out << '\n';
  }
}

/// What came of each file, told as it goes; the exit code.
int report(const std::vector<CheckedFile>& files, double wall, const CheckOptions& options) {
  size_t failed = 0, invalid = 0, runs = 0;
  json::array scenes;
  for (const CheckedFile& f : files) {
    json::array findings;
    const auto fail = [&](const std::string& line) {
      if (!options.json) std::cout << line << '\n';
    };
    if (f.error) {
      ++invalid;
      fail(f.path + ": " + issues_of(*f.error));
      findings.push_back(json::object{{"quantity", f.error->code()}, {"detail", issues_of(*f.error)}});
    } else {
      runs += f.check->size();
      for (const CheckFinding& finding : f.check->findings()) {
        fail(sentence(f.path, finding));
        findings.push_back(describe(finding));
      }
      failed += !findings.empty();
    }
    json::object row{{"file", f.path}, {"passed", findings.empty()}, {"cpu_seconds", f.cpu_seconds}};
    if (f.check) row["runs"] = describe_runs(*f.check);
    row["findings"] = std::move(findings);
    scenes.push_back(std::move(row));
  }
  const size_t bad = failed + invalid;
  if (options.json) {
    std::cout << write_json(json::object{{"passed", files.size() - bad},
                                         {"failed", bad},
                                         {"runs", runs},
                                         {"wall_seconds", wall},
                                         {"scenes", std::move(scenes)}})
              << '\n';
  } else {
    std::cout << files.size() - bad << " passed, " << bad << " failed (" << runs << " runs, "
              << std::round(10 * wall) / 10 << " s)\n";
  }
  return invalid ? kExitInvalidScene : failed ? kExitMissed : kExitOk;
}

std::regex expression(const std::string& text) try {
  return std::regex(text);
} catch (const std::regex_error&) {
  throw Error("bad_request", "--filter: this is not a regular expression: " + text);
}

int check(const CheckOptions& options) {
  std::vector<CheckedFile> files;
  const std::regex wanted = expression(options.filter);
  for (const std::string& path : scene_files(options.paths)) {
    if (std::regex_search(path, wanted)) files.push_back(read_checked(path));
  }
  if (files.empty()) throw Error("not_found", "no scene matches " + options.filter);
  if (options.list) {
    list_files(files, std::cout);
    return kExitOk;
  }
  const int threads = options.jobs > 0 ? options.jobs : static_cast<int>(std::thread::hardware_concurrency());
  const auto start = std::chrono::steady_clock::now();
  if (!run_all(files, threads)) return kExitInterrupted;
  return report(files, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                options);
}

}  // namespace

void add_check_command(Arguments app, int& exit_code) {
  auto o = std::make_shared<CheckOptions>();
  Arguments c = app.add_subcommand(
      "check", "runs scenes, varied as their \"test\" says, and compares them with what they expect");
  c.add_option("paths", o->paths, "scene files, and folders with such").required();
  c.add_option("-R,--filter", o->filter, "only files whose path matches this regular expression");
  c.add_option("-j,--jobs", o->jobs, "runs at a time (default: one per core)").in_range(1, 1024);
  c.add_flag("--json", o->json, "the result as one JSON object on standard output");
  c.add_flag("--list", o->list, "lists the files and their numbers of runs instead");
  c.callback([o, &exit_code] { exit_code = check(*o); });
}

}  // namespace truestep
