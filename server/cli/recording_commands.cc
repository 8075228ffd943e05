#include "server/cli/recording_commands.h"

#include <boost/json.hpp>
#include <iostream>

#include "engine/scene/json/json_write.h"
#include "engine/sinks/recording/diff.h"
#include "engine/sinks/recording/export/export.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"

namespace truestep {

namespace json = boost::json;

namespace {

struct RecordingOptions {
  std::string file, other, output, format = "csv";
  std::vector<std::string> systems;
  uint64_t every = 1;
  double tolerance = 0;
  bool json = false;
};

RecordingReader open_recording(
    const std::string& path, std::shared_ptr<RecordingThread> thread = std::make_shared<RecordingThread>()) {
  require_file(path);
  return RecordingReader(std::move(thread), path);
}

json::object describe(RecordingReader& reader) {
  const RecordingInfo& info = reader.info();
  json::array systems;
  for (const RecordedPart& s : info.layout.parts) {
    json::array fields;
    for (const RecordedField& f : s.fields) {
      constexpr const char* kNames[] = {"f32", "f64", "u32"};
      fields.push_back(json::object{{"name", f.name},
                                    {"unit", f.unit},
                                    {"width", f.width},
                                    {"type", kNames[static_cast<size_t>(f.precision)]}});
    }
    systems.push_back(
        json::object{{"id", s.id}, {"type", s.type}, {"rows", s.max_rows}, {"fields", std::move(fields)}});
  }
  json::array observables;
  for (const RecordedObservable& o : info.layout.observables)
    observables.push_back(json::object{{"name", o.name}, {"unit", o.unit}});
  json::object out{{"finalized", info.completion == RecordingCompletion::kFinalized},
                   {"frames", info.frames},
                   {"dt", info.layout.dt},
                   {"seed", info.layout.seed},
                   {"build", info.layout.build},
                   {"systems", std::move(systems)},
                   {"observables", std::move(observables)}};
  if (info.frames > 0) {
    out["first_step"] = reader.read_clock(0).step;
    const RecordedClock last = reader.read_clock(info.frames - 1);
    out["last_step"] = last.step;
    out["last_time"] = last.time;
  }
  return out;
}

int info(const RecordingOptions& o) {
  RecordingReader reader = open_recording(o.file);
  const json::object d = describe(reader);
  if (o.json) {
    std::cout << write_json(d) << '\n';
    return kExitOk;
  }
  std::cout << "frames  " << reader.info().frames
            << (d.at("finalized").as_bool() ? "" : " (the recording was not finished)") << '\n';
  if (d.contains("last_time")) {
    std::cout << "steps   " << d.at("first_step").as_int64() << " to " << d.at("last_step").as_int64() << ", "
              << d.at("last_time").as_double() << " s\n";
  }
  std::cout << "build   " << reader.info().layout.build << '\n';
  for (const RecordedPart& s : reader.info().layout.parts) {
    std::cout << s.id << " (" << s.type << ", up to " << s.max_rows << " rows):";
    for (const RecordedField& f : s.fields) std::cout << ' ' << f.name << '[' << f.width << "] " << f.unit;
    std::cout << '\n';
  }
  for (const RecordedObservable& ob : reader.info().layout.observables)
    std::cout << ob.name << ' ' << ob.unit << '\n';
  return kExitOk;
}

int export_files(const RecordingOptions& o) {
  RecordingReader reader = open_recording(o.file);
  ExportOptions e;
  e.format = export_format(o.format);
  e.output = o.output;
  e.systems = o.systems;
  e.every = o.every;
  for (const std::string& path : export_recording(reader, e)) std::cout << path << '\n';
  return kExitOk;
}

int diff(const RecordingOptions& o) {
  const auto thread = std::make_shared<RecordingThread>();
  RecordingReader a = open_recording(o.file, thread), b = open_recording(o.other, thread);
  const auto d = first_difference(a, b, o.tolerance);
  if (!d) {
    std::cout << (o.json ? "{\"equal\":true}" : "equal") << '\n';
    return kExitOk;
  }
  if (o.json) {
    std::cout << write_json(json::object{{"equal", false},
                                         {"frame", d->frame},
                                         {"step", d->step},
                                         {"system", d->system},
                                         {"field", d->field},
                                         {"row", d->row},
                                         {"component", d->component},
                                         {"first", d->first},
                                         {"second", d->second}})
              << '\n';
  } else {
    std::cout << "first difference at frame " << d->frame << " (step " << d->step << "), "
              << (d->system.empty() ? "" : d->system + " ") << d->field << " row " << d->row << " component "
              << d->component << ": " << d->first << " and " << d->second << " (by " << d->second - d->first
              << ")\n";
  }
  return kExitMissed;
}

}  // namespace

void add_recording_commands(Arguments app, int& exit_code) {
  auto o = std::make_shared<RecordingOptions>();
  Arguments i = app.add_subcommand("info", "contents of a recording");
  i.add_option("file", o->file, "recording").required();
  i.add_flag("--json", o->json, "JSON on standard output");
  i.callback([o, &exit_code] { exit_code = info(*o); });

  Arguments e = app.add_subcommand("export", "exports a recording to files for other programs");
  e.add_option("file", o->file, "recording").required();
  e.add_option("-o,--output", o->output, "path of the files, without ending").required();
  e.add_option("--format", o->format, "csv, ply, npz, vtu or vti").shows_default();
  e.add_option("--system", o->systems, "systems (default: all)");
  e.add_option("--every", o->every, "every n-th frame").in_range(1, 1000000000);
  e.callback([o, &exit_code] { exit_code = export_files(*o); });

  Arguments d = app.add_subcommand("diff", "first and largest difference of two recordings");
  d.add_option("first", o->file, "recording").required();
  d.add_option("second", o->other, "recording").required();
  d.add_option("--tolerance", o->tolerance, "largest difference that is ignored").in_range(0.0, 1e300);
  d.add_flag("--json", o->json, "JSON on standard output");
  d.callback([o, &exit_code] { exit_code = diff(*o); });
}

}  // namespace truestep
