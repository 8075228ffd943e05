// Tables: one line per frame and row, `step,time,row,<field>...` with components named field_0, field_1 ...,
// and one file with a line per frame for the observables.
#include "engine/sinks/recording/export/export_parts.h"

namespace truestep::exporting {
namespace {

std::string quoted(const std::string& s) {
  if (s.find_first_of(",\"\n\r") == std::string::npos) return s;
  std::string out = "\"";
  for (char c : s) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

void clock(const RecordedFrame& frame, std::string& line) {
  line += std::to_string(frame.step);
  line += ',';
  print(Precision::kF64, frame.time, line);
}

std::string header(const RecordedPart& system) {
  std::string line = "step,time,row";
  for (const RecordedField& f : system.fields) {
    for (uint32_t c = 0; c < f.width; ++c) {
      line += ',' + quoted(f.width == 1 ? f.name : f.name + "_" + std::to_string(c));
    }
  }
  return line + "\n";
}

void table(const RecordedPart& system, const RecordedFrame& frame, const RecordedRows& rows,
           OutputFile& out) {
  std::string text;
  for (size_t r = 0; r < rows.rows; ++r) {
    clock(frame, text);
    text += ',' + std::to_string(r);
    for (size_t f = 0; f < system.fields.size(); ++f) {
      const uint32_t width = system.fields[f].width;
      for (uint32_t c = 0; c < width; ++c) {
        text += ',';
        print(system.fields[f].precision, rows.fields[f][r * width + c], text);
      }
    }
    text += '\n';
  }
  out.text(text);
}

}  // namespace

Paths write_csv(RecordingReader& reader, const ExportOptions& options, const std::string& stem) {
  const RecordingInfo& info = reader.info();
  const std::vector<size_t> systems = chosen_systems(info, options);
  Paths paths;
  std::vector<OutputFile> tables;
  for (size_t s : systems) {
    const RecordedPart& system = info.layout.parts[s];
    paths.push_back(systems.size() == 1 ? stem + ".csv" : stem + "." + system.id + ".csv");
    tables.emplace_back(paths.back()).text(header(system));
  }
  paths.push_back(stem + ".observables.csv");
  OutputFile observables(paths.back());
  std::string line = "step,time";
  for (const RecordedObservable& o : info.layout.observables) line += ',' + quoted(o.name);
  observables.text(line + "\n");

  RecordedFrame frame;
  for (uint64_t i : chosen_frames(info, options)) {
    reader.read(i, frame);
    for (size_t k = 0; k < systems.size(); ++k) {
      table(info.layout.parts[systems[k]], frame, frame.systems[systems[k]], tables[k]);
    }
    line.clear();
    clock(frame, line);
    for (double v : frame.observables) {
      line += ',';
      print(Precision::kF64, v, line);
    }
    observables.text(line + "\n");
  }
  for (OutputFile& t : tables) t.close();
  observables.close();
  return paths;
}

}  // namespace truestep::exporting
