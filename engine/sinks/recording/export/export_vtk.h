// What VTK's XML formats share: a document with raw appended arrays, and a .pvd that gives the files' times.
// Source: VTK file formats, XML section.
#pragma once
#include <functional>

#include "engine/sinks/recording/export/export_parts.h"

namespace truestep::exporting {

// The XML text and the block of arrays behind it grow together.
struct Document {
  std::string xml;
  std::vector<char> data;

  void array(const std::string& type, const std::string& name, size_t width, const std::vector<char>& bytes);
  template <typename T>
  void array(const std::string& type, const std::string& name, const std::vector<T>& values) {
    const char* from = reinterpret_cast<const char*>(values.data());
    array(type, name, 1, std::vector<char>(from, from + values.size() * sizeof(T)));
  }
};

void append_field(Document& d, const RecordedField& f, const std::vector<double>& values);

/// The document, whose XML lacks the closing tags, to a file.
void write(const std::string& path, Document& d);

/// Writes a part's rows to a file; false: this part does not suit the format.
using WritePart =
    std::function<bool(const std::string& path, const RecordedPart& part, const RecordedRows& rows)>;
/// One file per chosen frame and part, and the .pvd.
Paths write_times(RecordingReader& reader, const ExportOptions& options, const std::string& stem,
                  const std::string& ending, const WritePart& write_part);

}  // namespace truestep::exporting
