#include "engine/sinks/picture/draw/plot_ticks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace truestep {

namespace {

std::string printed(const char* format, int digits, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, digits, value);
  return text.data();
}

// An axis whose values crowd at one end, like those of log(x + 1), labels only decades whose spacing is close
// to the widest one.
std::vector<Tick> decade_ticks(const PlotAxis& axis, double low, double high, int wanted) {
  std::vector<std::array<double, 2>> inside;
  for (const auto& d : axis.decades) {
    if (d[1] >= low && d[1] <= high) inside.push_back(d);
  }
  double widest = 0;
  for (size_t k = 1; k < inside.size(); ++k) widest = std::max(widest, inside[k][1] - inside[k - 1][1]);
  const double least = 0.7 * (high - low) / (1.8 * wanted);
  std::vector<Tick> out;
  for (size_t k = 0; k < inside.size(); ++k) {
    if (k + 1 < inside.size() && inside[k + 1][1] - inside[k][1] <= 0.4 * widest) continue;
    if (out.empty() || inside[k][1] - out.back().at > least)
      out.push_back({inside[k][1], tick_text(inside[k][0])});
  }
  return out;
}

}  // namespace

std::string tick_text(double value) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size < 1e5 && size >= 1e-3) return printed("%.*g", 6, value);
  std::string text = printed("%.*e", 5, value);
  const size_t e = text.find('e');
  std::string digits = text.substr(0, e);
  digits.erase(digits.find_last_not_of('0') + 1);
  if (digits.back() == '.') digits.pop_back();
  return digits + "e" + std::to_string(std::stoi(text.substr(e + 1)));
}

std::vector<double> round_values(double low, double high, int wanted) {
  std::vector<double> out;
  if (!(high > low) || !std::isfinite(high - low)) return out;
  const double rough = (high - low) / wanted, base = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * base;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * base >= 0.999 * rough) step = factor * base;
  }
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    out.push_back(std::abs(k) < 0.5 ? 0 : k * step);
  return out;
}

double place_of(const PlotAxis& axis, double value) {
  if (axis.decades.size() < 2) return axis.offset + axis.slope * value;
  const auto& d = axis.decades;
  if (!(value > d.front()[0])) return d.front()[1];
  const auto next = std::find_if(d.begin() + 1, d.end() - 1, [&](const auto& e) { return e[0] >= value; });
  const auto& [v0, p0] = *(next - 1);
  const auto& [v1, p1] = *next;
  return p0 + (p1 - p0) * std::log(value / v0) / std::log(v1 / v0);
}

std::vector<Tick> ticks_of(const PlotAxis& axis, double low, double high, int wanted) {
  std::vector<Tick> out;
  if (axis.decades.size() >= 2) out = decade_ticks(axis, low, high, wanted);
  if (out.size() >= 2) return out;
  out.clear();
  const double slope = axis.decades.empty() ? axis.slope : 1, offset = axis.decades.empty() ? axis.offset : 0;
  const double a = (low - offset) / slope, b = (high - offset) / slope;
  for (const double v : round_values(std::min(a, b), std::max(a, b), wanted))
    out.push_back({offset + slope * v, tick_text(v)});
  return out;
}

}  // namespace truestep
