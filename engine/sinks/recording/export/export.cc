#include "engine/sinks/recording/export/export.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include "engine/base/errors.h"
#include "engine/sinks/recording/export/export_parts.h"

namespace truestep {
namespace exporting {

OutputFile::OutputFile(const std::string& path)
    : path_(path), file_(path, std::ios::binary | std::ios::trunc) {
  if (!file_) fail();
}

void OutputFile::fail() const {
  const int code = errno;
  if (code == ENOSPC || code == EDQUOT || code == EFBIG) {
    throw Error("disk_full", "the disk is full: could not write " + path_);
  }
  throw Error("export_io", "could not write " + path_ + ": " + std::strerror(code));
}

void OutputFile::bytes(const void* data, size_t size) {
  if (!file_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size))) fail();
  position_ += size;
}

void OutputFile::rewrite(uint64_t at, const void* data, size_t size) {
  file_.seekp(static_cast<std::streamoff>(at));
  file_.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  file_.seekp(0, std::ios::end);
  if (!file_) fail();
}

void OutputFile::close() {
  file_.close();
  if (!file_) fail();
}

template <typename T>
static void pack_as(const std::vector<double>& values, std::vector<char>& out) {
  const size_t at = out.size();
  out.resize(at + values.size() * sizeof(T));
  for (size_t i = 0; i < values.size(); ++i) {
    const T v = static_cast<T>(values[i]);
    std::memcpy(out.data() + at + i * sizeof(T), &v, sizeof(T));
  }
}

void pack(Precision precision, const std::vector<double>& values, std::vector<char>& out) {
  switch (precision) {
    case Precision::kF32:
      return pack_as<float>(values, out);
    case Precision::kF64:
      return pack_as<double>(values, out);
    case Precision::kU32:
      return pack_as<uint32_t>(values, out);
  }
}

void print(Precision precision, double value, std::string& out) {
  char text[32];
  const auto end = precision == Precision::kF32
                       ? std::to_chars(text, text + sizeof text, static_cast<float>(value))
                       : std::to_chars(text, text + sizeof text, value);
  out.append(text, end.ptr);
}

int position_field(const RecordedPart& system) {
  for (size_t f = 0; f < system.fields.size(); ++f) {
    const RecordedField& field = system.fields[f];
    if (field.meaning == Meaning::position && field.precision != Precision::kU32) return static_cast<int>(f);
  }
  return -1;
}

std::vector<uint64_t> chosen_frames(const RecordingInfo& info, const ExportOptions& options) {
  std::vector<uint64_t> frames;
  const uint64_t every = std::max<uint64_t>(options.every, 1);
  for (uint64_t i = options.first; i < info.frames && i <= options.last; i += every) frames.push_back(i);
  return frames;
}

std::vector<size_t> chosen_systems(const RecordingInfo& info, const ExportOptions& options) {
  std::vector<size_t> chosen;
  std::string known;
  for (size_t s = 0; s < info.layout.parts.size(); ++s) {
    known += (s == 0 ? "" : ", ") + info.layout.parts[s].id;
    if (options.systems.empty()) chosen.push_back(s);
  }
  for (const std::string& id : options.systems) {
    const auto& all = info.layout.parts;
    const auto it = std::find_if(all.begin(), all.end(), [&](const RecordedPart& s) { return s.id == id; });
    if (it == all.end())
      throw Error("unknown_system", "no system '" + id + "' in this recording; it has: " + known);
    chosen.push_back(static_cast<size_t>(it - all.begin()));
  }
  return chosen;
}

std::string digits(uint64_t frame) {
  const std::string s = std::to_string(frame);
  return s.size() < 6 ? std::string(6 - s.size(), '0') + s : s;
}

}  // namespace exporting

ExportFormat export_format(const std::string& name) {
  if (name == "csv") return ExportFormat::kCsv;
  if (name == "ply") return ExportFormat::kPly;
  if (name == "npz") return ExportFormat::kNpz;
  if (name == "vtu") return ExportFormat::kVtu;
  if (name == "vti") return ExportFormat::kVti;
  throw Error("unknown_format", "no export format '" + name + "'; formats are csv, ply, npz, vtu, vti");
}

std::vector<std::string> export_recording(RecordingReader& reader, const ExportOptions& options) {
  std::filesystem::path stem = options.output;
  for (const char* ending : {".csv", ".ply", ".npz", ".vtu", ".vti", ".pvd"}) {
    if (stem.extension() == ending) stem.replace_extension();
  }
  if (const auto folder = stem.parent_path(); !folder.empty()) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed)
      throw Error("export_io", "could not make the folder " + folder.string() + ": " + failed.message());
  }
  switch (options.format) {
    case ExportFormat::kCsv:
      return exporting::write_csv(reader, options, stem);
    case ExportFormat::kPly:
      return exporting::write_ply(reader, options, stem);
    case ExportFormat::kNpz:
      return exporting::write_npz(reader, options, stem);
    case ExportFormat::kVtu:
      return exporting::write_vtu(reader, options, stem);
    case ExportFormat::kVti:
      return exporting::write_vti(reader, options, stem);
  }
  return {};
}

}  // namespace truestep
