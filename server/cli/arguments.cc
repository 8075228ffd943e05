#include "server/cli/arguments.h"

#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "engine/base/text/nearest_name.h"
#include "server/cli/duration.h"

namespace truestep {

Argument Argument::required() {
  option_->required();
  return *this;
}

Argument Argument::shows_default() {
  option_->capture_default_str();
  return *this;
}

template <class T>
Argument Argument::in_range(T least, T most) {
  option_->check(CLI::Range(least, most));
  return *this;
}
template Argument Argument::in_range(int, int);
template Argument Argument::in_range(int64_t, int64_t);
template Argument Argument::in_range(uint64_t, uint64_t);
template Argument Argument::in_range(double, double);

Argument Argument::one_of(std::vector<std::string> words, std::string as) {
  CLI::Validator check = CLI::IsMember(std::move(words));
  if (!as.empty()) check.description(std::move(as));
  option_->check(check);
  return *this;
}

Argument Argument::of_time() {
  // Before the checks of its range, which are those of a number.
  option_->transform(CLI::Validator(
      [](std::string& text) {
        const auto seconds = read_time(text);
        if (!seconds)
          return text + " is no time: it is a number of seconds, or has a unit as 250ms, 90s, 5m, 2h, 7d, 3y";
        text = (std::ostringstream() << std::setprecision(17) << *seconds).str();
        return std::string();
      },
      "or 250ms, 5m, 2h, 7d, 3y"));
  return *this;
}

Argument Argument::separated_by(char separator) {
  option_->delimiter(separator);
  return *this;
}

Argument Argument::excludes(Argument other) {
  option_->excludes(other.option_);
  return *this;
}

Argument Argument::needs(Argument other) {
  option_->needs(other.option_);
  return *this;
}

Arguments Arguments::add_subcommand(std::string name, std::string sentence) {
  return Arguments(app_->add_subcommand(std::move(name), std::move(sentence)));
}

template <class T>
Argument Arguments::add_option(std::string names, T& value, std::string sentence) {
  return Argument(app_->add_option(std::move(names), value, std::move(sentence)));
}
template Argument Arguments::add_option(std::string, std::string&, std::string);
template Argument Arguments::add_option(std::string, std::vector<std::string>&, std::string);
template Argument Arguments::add_option(std::string, double&, std::string);
template Argument Arguments::add_option(std::string, int&, std::string);
template Argument Arguments::add_option(std::string, int64_t&, std::string);
template Argument Arguments::add_option(std::string, uint64_t&, std::string);
template Argument Arguments::add_option(std::string, uint16_t&, std::string);
template Argument Arguments::add_option(std::string, std::optional<double>&, std::string);

void Arguments::add_flag(std::string names, bool& value, std::string sentence) {
  app_->add_flag(std::move(names), value, std::move(sentence));
}

void Arguments::callback(std::function<void()> f) {
  app_->callback(std::move(f));
}

std::vector<Arguments::Known> Arguments::subcommands() const {
  std::vector<Known> out;
  for (const CLI::App* c : std::as_const(*app_).get_subcommands([](const CLI::App*) { return true; })) {
    Known& one = out.emplace_back(Known{c->get_name(), c->get_description(), {}});
    for (const CLI::Option* option : c->get_options()) {
      for (const std::string& name : option->get_lnames()) one.options.push_back(name);
    }
  }
  return out;
}

namespace {

// For options that the given command does not have, those that it has and that are named nearly so.
std::string meant_options(const CLI::App& app) {
  std::string out;
  for (const CLI::App* command : app.get_subcommands()) {
    std::vector<std::string> known;
    for (const CLI::Option* option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
    for (const std::string& word : command->remaining()) {
      const std::string near = nearest_name(word.substr(0, word.find('=')), known);
      if (word.starts_with("--") && !near.empty()) out += (out.empty() ? "did you mean " : " and ") + near;
    }
  }
  return out.empty() ? out : out + '?';
}

}  // namespace

CommandLine::CommandLine(std::string sentence, std::string name, const std::string& version)
    : app_(std::make_unique<CLI::App>(std::move(sentence), std::move(name))) {
  app_->require_subcommand(1);
  app_->set_version_flag("--version", version);
}
CommandLine::~CommandLine() = default;

std::string CommandLine::help() const {
  return app_->help();
}

bool CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ExtrasError& e) {
    app_->exit(e, std::cout, std::cerr);
    const std::string hint = meant_options(*app_);
    if (!hint.empty()) std::cerr << hint << '\n';
    return false;
  } catch (const CLI::ParseError& e) {
    return app_->exit(e) == 0;
  }
  return true;
}

}  // namespace truestep
