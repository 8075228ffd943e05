// What a study found: a summary, one table, and plots; as JSON, CSV and SVG.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace truestep {

struct StudyTable {
  using Cell = std::variant<std::monostate, double, std::string>;
  struct Column {
    std::string name, unit;
  };
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

struct StudyPlot {
  enum class Scale : uint8_t { linear, logarithmic };
  struct Series {
    std::string name;
    std::vector<double> x = {}, y = {};
    enum class Style : uint8_t {
      line_and_markers,
      line,
      dashed,
      dashed_and_markers,
      markers,
      rings  ///< open circles, around the markers of another series
    } style = Style::line_and_markers;
  };
  std::string title, x_label, y_label;
  Scale x_scale = Scale::logarithmic, y_scale = Scale::logarithmic;
  /// If not empty, y takes these names, from the top, as 0, 1, 2 ...
  std::vector<std::string> y_names = {};
  std::vector<Series> series = {};
};

struct StudyResult {
  boost::json::object summary;
  StudyTable table;
  StudyPlot plot;
};

/// {"summary": ..., "columns": [...], "rows": [{name: value ...}], "plot": ...}; non-finite numbers are null.
boost::json::object result_json(const StudyResult& result);
/// RFC 4180; the header line holds "name (unit)".
std::string result_csv(const StudyTable& table);
/// A stand-alone SVG picture, 960 x 600.
std::string result_svg(const StudyPlot& plot);

}  // namespace truestep
