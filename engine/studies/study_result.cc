#include "engine/studies/study_result.h"

#include <charconv>
#include <cmath>

namespace truestep {

namespace json = boost::json;

namespace {

json::value number(double v) {
  return std::isfinite(v) ? json::value(v) : json::value(nullptr);
}

json::array numbers(const std::vector<double>& values) {
  json::array a;
  for (const double v : values) a.push_back(number(v));
  return a;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace

json::object result_json(const StudyResult& result) {
  json::array columns, rows;
  for (const auto& c : result.table.columns)
    columns.push_back(json::object{{"name", c.name}, {"unit", c.unit}});
  for (const auto& row : result.table.rows) {
    json::object o;
    for (size_t i = 0; i < row.size(); ++i) {
      json::value& v = o[result.table.columns[i].name];
      if (const auto* d = std::get_if<double>(&row[i])) v = number(*d);
      if (const auto* s = std::get_if<std::string>(&row[i])) v = *s;
    }
    rows.push_back(std::move(o));
  }
  const auto scale = [](StudyPlot::Scale s) { return s == StudyPlot::Scale::linear ? "linear" : "log"; };
  json::array series;
  for (const auto& s : result.plot.series) {
    series.push_back(json::object{{"name", s.name}, {"x", numbers(s.x)}, {"y", numbers(s.y)}});
  }
  json::array names;
  for (const std::string& n : result.plot.y_names) names.emplace_back(n);
  return {{"summary", result.summary},
          {"columns", std::move(columns)},
          {"rows", std::move(rows)},
          {"plot", json::object{{"title", result.plot.title},
                                {"x_label", result.plot.x_label},
                                {"y_label", result.plot.y_label},
                                {"x_scale", scale(result.plot.x_scale)},
                                {"y_scale", scale(result.plot.y_scale)},
                                {"y_names", std::move(names)},
                                {"series", std::move(series)}}}};
}

std::string result_csv(const StudyTable& table) {
  std::string out;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    const auto& c = table.columns[i];
    if (i) out += ',';
    out += quoted(c.unit.empty() ? c.name : c.name + " (" + c.unit + ")");
  }
  out += "\r\n";
  for (const auto& row : table.rows) {
    for (size_t i = 0; i < row.size(); ++i) {
      if (i) out += ',';
      if (const auto* d = std::get_if<double>(&row[i])) {
        char buffer[32];
        const auto end = std::to_chars(buffer, buffer + sizeof buffer, *d).ptr;
        out.append(buffer, end);
      } else if (const auto* s = std::get_if<std::string>(&row[i])) {
        out += quoted(*s);
      }
    }
    out += "\r\n";
  }
  return out;
}

}  // namespace truestep
