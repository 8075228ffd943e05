// Writes into the folder given by -o: result.json, result.csv, result.svg, and for sweeps rows.jsonl with one
// finished case per line. A sweep whose folder holds rows.jsonl of the same request continues from there.
#include "server/cli/study.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>

#include "engine/base/errors.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/studies/refinement/refinement.h"
#include "engine/studies/study.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"
#include "server/cli/progress.h"

namespace truestep {

namespace json = boost::json;
namespace fs = std::filesystem;

namespace {

struct StudyOptions {
  std::string kind, scene, output, refine, progress = "auto";
  std::vector<std::string> set;
  int threads = 0;
  bool json = false;
};

std::atomic<bool> g_cancelled{false};

void write_file(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw Error("io", "cannot write " + path.string());
}

// name=value with a JSON value, or plain text when it is not JSON.
void apply_settings(const std::vector<std::string>& settings, json::object& request) {
  for (const std::string& s : settings) {
    const size_t equals = s.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error("bad_request", "--set takes name=value, not " + s);
    const std::string value = s.substr(equals + 1);
    json::value parsed;
    try {
      parsed = parse_json(value);
    } catch (const Error&) {
      parsed = json::string(value);
    }
    request[s.substr(0, equals)] = std::move(parsed);
  }
}

// The rows of an interrupted study, if its folder belongs to the same request.
std::vector<json::object> earlier_rows(const fs::path& folder, const std::string& request) {
  std::vector<json::object> rows;
  std::ifstream before(folder / "request.json", std::ios::binary);
  const std::string known{std::istreambuf_iterator<char>(before), std::istreambuf_iterator<char>()};
  if (known != request) return rows;
  std::ifstream file(folder / "rows.jsonl", std::ios::binary);
  for (std::string line; std::getline(file, line);) {
    try {
      json::value v = parse_json(line);
      if (v.is_object()) rows.push_back(std::move(v.as_object()));
    } catch (const Error&) {
      break;  // the line being written when the run ended
    }
  }
  return rows;
}

void print_table(const StudyResult& result) {
  std::vector<size_t> widths;
  std::vector<std::vector<std::string>> lines(1);
  for (const auto& c : result.table.columns)
    lines[0].push_back(c.unit.size() > 1 || c.unit == "s" ? c.name + " (" + c.unit + ")" : c.name);
  for (const auto& row : result.table.rows) {
    auto& line = lines.emplace_back();
    for (const auto& cell : row) {
      std::ostringstream text;
      text.precision(4);
      if (const auto* d = std::get_if<double>(&cell)) text << *d;
      if (const auto* s = std::get_if<std::string>(&cell)) text << *s;
      line.push_back(text.str());
    }
  }
  for (const auto& line : lines) {
    widths.resize(std::max(widths.size(), line.size()));
    for (size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  }
  for (const auto& line : lines) {
    std::string out;
    for (size_t i = 0; i < line.size(); ++i)
      out += line[i] + std::string(widths[i] + 2 - line[i].size(), ' ');
    out.erase(out.find_last_not_of(' ') + 1);
    std::cout << out << '\n';
  }
}

int study(const StudyOptions& o) {
  std::string kind = o.kind;
  std::replace(kind.begin(), kind.end(), '-', '_');
  json::object document{{"kind", kind}, {"scene", load_scene_document(o.scene)}};
  apply_settings(o.set, document);
  if (!o.refine.empty()) document["refine"] = o.refine;
  const StudyRequest request = read_study_request(document);

  const fs::path folder = o.output;
  std::ofstream rows;
  const std::string text = write_json(document);
  const ThreadArena arena(o.threads > 0 ? o.threads : static_cast<int>(std::thread::hardware_concurrency()));
  Progress bar(o.progress == "none"    ? Progress::Style::none
               : o.progress == "plain" ? Progress::Style::plain
                                       : Progress::Style::automatic,
               1000);
  StudyContext context{
      .arena = arena, .cancelled = g_cancelled, .progress = [&bar](double fraction, const std::string& note) {
        bar.update(static_cast<uint64_t>(1000 * fraction), note);
      }};
  if (!o.output.empty()) {
    fs::create_directories(folder);
    context.finished_rows = earlier_rows(folder, text);
    write_file(folder / "request.json", text);
    if (kind == "sweep") {
      std::string kept;
      for (const json::object& row : context.finished_rows) kept += write_json(row) + '\n';
      write_file(folder / "rows.jsonl", kept);
      rows.open(folder / "rows.jsonl", std::ios::binary | std::ios::app);
      context.row_finished = [&rows](const json::object& row) { rows << write_json(row) << std::endl; };
    }
  }
  std::signal(SIGINT, [](int) { g_cancelled = true; });
  const StudyResult result = run_study(request, context);
  bar.finish();

  const json::object out = result_json(result);
  if (!o.output.empty()) {
    write_file(folder / "result.json", write_json(out) + '\n');
    write_file(folder / "result.csv", result_csv(result.table));
    write_file(folder / "result.svg", result_svg(result.plot));
  }
  if (o.json) {
    std::cout << write_json(out) << '\n';
  } else {
    print_table(result);
    for (const auto& [key, value] : result.summary)
      std::cout << std::string(key) << ": " << write_json(value) << '\n';
  }
  return kExitOk;
}

}  // namespace

void add_study_command(Arguments app, int& exit_code) {
  auto options = std::make_shared<StudyOptions>();
  Arguments c = app.add_subcommand(
      "study", "measures a scene: work-precision, convergence, stability, cross-check, sweep");
  std::vector<std::string> kinds;
  for (const StudyKind& k : study_kinds()) {
    kinds.emplace_back(k.name);
    std::replace(kinds.back().begin(), kinds.back().end(), '_', '-');
  }
  c.add_option("kind", options->kind, "which study").required().one_of(kinds);
  c.add_option("scene", options->scene, "scene file, gallery name, or - for standard input").required();
  c.add_option("-o,--output", options->output, "folder for result.json, result.csv and result.svg");
  c.add_option("--set", options->set,
               "a parameter of the study, e.g. --set integrators='[\"rk4\"]' --set horizon=2");
  c.add_option("--refine", options->refine,
               "convergence and work-precision: what is refined, time, space or both")
      .one_of(refine_names());
  c.add_option("--threads", options->threads, "threads of a sweep (default: all)").in_range(1, 1024);
  c.add_flag("--json", options->json, "the result as one JSON object on standard output");
  c.add_option("--progress", options->progress, "progress on standard error")
      .one_of({"auto", "plain", "none"});
  c.callback([options, &exit_code] { exit_code = study(*options); });
}

}  // namespace truestep
