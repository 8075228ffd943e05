// The words of a command line: subcommands and their options. CLI11 reads them; its templates take seconds of
// compiler time wherever they are included, so only arguments.cc does.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace truestep {

/// One option or word of a command, for further settings.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}
  Argument required();
  /// Its help tells the default.
  Argument shows_default();
  /// From `least` to `most`; the type is what the help and the refusal name.
  template <class T>
  Argument in_range(T least, T most);
  /// `as`: how the help lists the words, "{a | b}"; by default in CLI11's way.
  Argument one_of(std::vector<std::string> words, std::string as = {});
  /// A time in seconds, as a number or with a unit: 250ms, 90s, 5m, 2h, 7d, 3y (of 365.25 days).
  Argument of_time();
  Argument separated_by(char separator);
  Argument excludes(Argument other);
  Argument needs(Argument other);

 private:
  CLI::Option* option_;
};

/// A command and what it takes. A copy is the same command.
class Arguments {
 public:
  explicit Arguments(CLI::App* app) : app_(app) {}
  Arguments add_subcommand(std::string name, std::string sentence);
  /// `names` as "-o,--output", or a plain word for one that is recognised by its place. T: std::string, a
  /// list of them, double, int, int64_t, uint64_t, uint16_t or an optional double.
  template <class T>
  Argument add_option(std::string names, T& value, std::string sentence);
  void add_flag(std::string names, bool& value, std::string sentence);
  /// Called when the command was given.
  void callback(std::function<void()> f);

  struct Known {
    std::string name, sentence;
    std::vector<std::string> options;  ///< long names, without dashes
  };
  std::vector<Known> subcommands() const;

 private:
  CLI::App* app_;
};

/// A program's whole command line.
class CommandLine {
 public:
  CommandLine(std::string sentence, std::string name, const std::string& version);
  ~CommandLine();
  Arguments arguments() const { return Arguments(app_.get()); }
  /// Calls the command that was given. Otherwise prints what was asked for (help, version) or what is wrong,
  /// and returns false for the latter.
  bool parse(int argc, char** argv);
  /// What --help prints.
  std::string help() const;

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace truestep
