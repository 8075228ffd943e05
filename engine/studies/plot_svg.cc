// Line plots as SVG: axes with round ticks (powers of ten on logarithmic ones), one colour and marker per
// series, a legend beside the plot with the series in the given order. When y takes names, they label the
// side, one line each. Text is real text, so it can be searched.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "engine/base/text/xml.h"
#include "engine/studies/study_result.h"

namespace truestep {

namespace {

constexpr double kWidth = 960, kHeight = 600, kTop = 48, kBottom = 64, kLegend = 220;
constexpr double kPlotRight = kWidth - kLegend, kPlotBottom = kHeight - kBottom;
// Okabe and Ito's colours, which most colour-blind readers tell apart, then darker ones.
constexpr std::array kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c564b",
                                 "#5b3f95", "#3d6b21", "#8f1d3f", "#005f73", "#6b6b00", "#b1418f", "#404040"};

// Wider when names are shown there.
double left_of(const StudyPlot& plot) {
  return plot.y_names.empty() ? 84 : 170;
}

std::string text_of(double v, int digits = 6) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, v, std::chars_format::general, digits).ptr};
}

class Axis {
 public:
  Axis(StudyPlot::Scale scale, double from, double to)
      : log_(scale == StudyPlot::Scale::logarithmic), a_(from), b_(to) {}
  /// One position per name.
  Axis(const std::vector<std::string>& names, double from, double to)
      : a_(from), b_(to), low_(-0.5), high_(static_cast<double>(names.size()) - 0.5), names_(&names) {}

  void take(double v) {
    if (names_ || !usable(v)) return;
    low_ = std::min(low_, v), high_ = std::max(high_, v);
  }
  bool usable(double v) const { return std::isfinite(v) && (!log_ || v > 0); }
  void settle() {
    if (names_) return;
    if (!(low_ <= high_)) low_ = log_ ? 0.1 : 0, high_ = 1;
    if (log_) {
      low_ = std::floor(std::log10(low_) + 1e-9), high_ = std::ceil(std::log10(high_) - 1e-9);
      if (low_ == high_) high_ += 1;
    } else {
      const double margin = high_ > low_ ? 0.04 * (high_ - low_) : std::max(1.0, std::abs(low_)) * 0.5;
      low_ -= margin, high_ += margin;
    }
  }
  double place(double v) const {
    return a_ + (b_ - a_) * ((log_ ? std::log10(v) : v) - low_) / (high_ - low_);
  }
  struct Tick {
    double at;
    std::string label;
  };
  std::vector<Tick> ticks() const {
    std::vector<Tick> out;
    for (size_t k = 0; names_ && k < names_->size(); ++k) {
      out.push_back({place(static_cast<double>(k)), escaped_xml((*names_)[k])});
    }
    if (names_) return out;
    if (log_) {
      const int every = static_cast<int>(std::ceil((high_ - low_) / 10));
      for (int e = static_cast<int>(low_); e <= static_cast<int>(high_); e += std::max(1, every)) {
        out.push_back({a_ + (b_ - a_) * (e - low_) / (high_ - low_),
                       std::string("10<tspan dy=\"-6\" font-size=\"10\">") + (e < 0 ? "\u2212" : "") +
                           std::to_string(std::abs(e)) + "</tspan>"});
      }
      return out;
    }
    const double raw = (high_ - low_) / 6, power = std::pow(10, std::floor(std::log10(raw)));
    const double step = power * (raw / power < 1.5 ? 1 : raw / power < 3.5 ? 2 : raw / power < 7.5 ? 5 : 10);
    for (double k = std::ceil(low_ / step); k * step <= high_; ++k)
      out.push_back({place(k * step), text_of(k * step)});
    return out;
  }

 private:
  bool log_ = false;
  double a_, b_;
  double low_ = INFINITY, high_ = -INFINITY;
  const std::vector<std::string>* names_ = nullptr;
};

std::string marker(size_t shape, double x, double y, const char* colour) {
  const std::string fill = std::string("\" fill=\"") + colour + "\"/>";
  const auto at = [&](double dx, double dy) { return text_of(x + dx) + ',' + text_of(y + dy) + ' '; };
  // Their number and that of the colours have no common divisor: the first seventy series differ.
  switch (shape % 5) {
    case 0:
      return "<circle cx=\"" + text_of(x) + "\" cy=\"" + text_of(y) + "\" r=\"3.6" + fill;
    case 1:
      return "<polygon points=\"" + at(-3.3, -3.3) + at(3.3, -3.3) + at(3.3, 3.3) + at(-3.3, 3.3) + fill;
    case 2:
      return "<polygon points=\"" + at(0, -4.4) + at(4.2, 3.2) + at(-4.2, 3.2) + fill;
    case 3:
      return "<polygon points=\"" + at(0, 4.4) + at(4.2, -3.2) + at(-4.2, -3.2) + fill;
    default:
      return "<polygon points=\"" + at(0, -4.8) + at(4.8, 0) + at(0, 4.8) + at(-4.8, 0) + fill;
  }
}

std::string ring(double x, double y, const char* colour) {
  return "<circle cx=\"" + text_of(x) + "\" cy=\"" + text_of(y) +
         "\" r=\"6.5\" fill=\"none\" stroke-width=\"1.8\" stroke=\"" + colour + "\"/>";
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return "<line x1=\"" + text_of(x1) + "\" y1=\"" + text_of(y1) + "\" x2=\"" + text_of(x2) + "\" y2=\"" +
         text_of(y2) + "\" " + style + "/>\n";
}

std::string label(double x, double y, const char* style, const std::string& text) {
  return "<text x=\"" + text_of(x) + "\" y=\"" + text_of(y) + "\" " + style + '>' + text + "</text>\n";
}

std::string frame(const StudyPlot& plot, const Axis& x, const Axis& y) {
  std::string out;
  const double left = left_of(plot);
  for (const auto& t : x.ticks()) {
    out += line(t.at, kTop, t.at, kPlotBottom, "stroke=\"#e3e3e3\"");
    out += label(t.at, kPlotBottom + 20, "text-anchor=\"middle\"", t.label);
  }
  for (const auto& t : y.ticks()) {
    out += line(left, t.at, kPlotRight, t.at, "stroke=\"#e3e3e3\"");
    out += label(left - 8, t.at + 4, "text-anchor=\"end\"", t.label);
  }
  out += "<rect x=\"" + text_of(left) + "\" y=\"48\" width=\"" + text_of(kPlotRight - left) + "\" height=\"" +
         text_of(kPlotBottom - kTop) + "\" fill=\"none\" stroke=\"#404040\"/>\n";
  const double middle = 0.5 * (kTop + kPlotBottom);
  out += label(0.5 * (left + kPlotRight), 30, "text-anchor=\"middle\" font-size=\"17\"",
               escaped_xml(plot.title));
  out += label(0.5 * (left + kPlotRight), kHeight - 16, "text-anchor=\"middle\"", escaped_xml(plot.x_label));
  out += label(22, middle,
               ("text-anchor=\"middle\" transform=\"rotate(-90 22 " + text_of(middle) + ")\"").c_str(),
               escaped_xml(plot.y_label));
  return out;
}

}  // namespace

std::string result_svg(const StudyPlot& plot) {
  Axis x(plot.x_scale, left_of(plot), kPlotRight), y = plot.y_names.empty()
                                                           ? Axis(plot.y_scale, kPlotBottom, kTop)
                                                           : Axis(plot.y_names, kTop, kPlotBottom);
  for (const auto& s : plot.series) {
    for (size_t i = 0; i < s.x.size(); ++i) {
      if (x.usable(s.x[i]) && y.usable(s.y[i])) x.take(s.x[i]), y.take(s.y[i]);
    }
  }
  x.settle(), y.settle();
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 960 600\" width=\"960\" height=\"600\" "
      "font-family=\"system-ui, sans-serif\" font-size=\"13\" fill=\"#202020\">\n"
      "<rect width=\"960\" height=\"600\" fill=\"#ffffff\"/>\n";
  out += frame(plot, x, y);
  using Style = StudyPlot::Series::Style;
  const double row_height =
      std::min(20.0, (kPlotBottom - kTop) / static_cast<double>(std::max<size_t>(1, plot.series.size())));
  for (size_t n = 0; n < plot.series.size(); ++n) {
    const auto& s = plot.series[n];
    const char* colour = kColours[n % kColours.size()];
    const bool dashed = s.style == Style::dashed || s.style == Style::dashed_and_markers;
    const bool joined = s.style != Style::markers && s.style != Style::rings;
    const bool marked = s.style != Style::line && s.style != Style::dashed;
    const std::string stroke = std::string("fill=\"none\" stroke-width=\"1.8\" stroke=\"") + colour + '"' +
                               (dashed ? " stroke-dasharray=\"6 5\"" : "");
    std::string path, marks;
    for (size_t i = 0; i < s.x.size(); ++i) {
      if (!x.usable(s.x[i]) || !y.usable(s.y[i])) continue;
      const double px = x.place(s.x[i]), py = y.place(s.y[i]);
      path += (path.empty() ? "M" : "L") + text_of(px) + ' ' + text_of(py);
      if (s.style == Style::rings)
        marks += ring(px, py, colour);
      else if (marked)
        marks += marker(n, px, py, colour);
    }
    if (joined) out += "<path d=\"" + path + "\" " + stroke + "/>\n";
    out += marks + '\n';
    const double ly = kTop + 10 + row_height * static_cast<double>(n);
    if (joined) out += line(kPlotRight + 14, ly, kPlotRight + 40, ly, stroke.c_str());
    if (s.style == Style::rings)
      out += ring(kPlotRight + 27, ly, colour);
    else if (marked)
      out += marker(n, kPlotRight + 27, ly, colour);
    out += label(kPlotRight + 48, ly + 4, "", escaped_xml(s.name));
  }
  return out + "</svg>\n";
}

}  // namespace truestep
