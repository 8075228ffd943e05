#include "server/cli/completion.h"

#include <iostream>

#include "engine/scene/catalogue.h"
#include "engine/scene/gallery.h"
#include "server/cli/exit_codes.h"

namespace truestep {

namespace {

/// What a command takes: its options, and the words allowed as its first argument.
struct Completed {
  std::string name, sentence, options, words;
};

// Words that a command accepts besides a file.
std::string words_of(const std::string& command) {
  std::string out;
  const auto add = [&](std::string_view word) { out += (out.empty() ? "" : " ") + std::string(word); };
  if (command == "run" || command == "validate" || command == "gallery" || command == "render") {
    for (const GalleryScene& g : gallery()) add(g.name);
  }
  if (command == "systems") {
    for (const CatalogueRow& row : catalogue()) add(row.type);
  }
  if (command == "study") out = "work-precision convergence stability cross-check sweep";
  if (command == "completion") out = "bash zsh fish";
  return out;
}

std::vector<Completed> commands(const Arguments& app) {
  std::vector<Completed> out;
  for (const Arguments::Known& c : app.subcommands()) {
    Completed& one = out.emplace_back(Completed{c.name, c.sentence, "", words_of(c.name)});
    for (const std::string& name : c.options) one.options += (one.options.empty() ? "--" : " --") + name;
  }
  return out;
}

std::string names(const std::vector<Completed>& all) {
  std::string out;
  for (const Completed& c : all) out += (out.empty() ? "" : " ") + c.name;
  return out;
}

// zsh reads the same function through its bashcompinit.
void print_bash(const std::vector<Completed>& all) {
  std::cout << "_truestep() {\n"
               "  local word=${COMP_WORDS[COMP_CWORD]} options='' words=''\n"
               "  COMPREPLY=()\n"
               "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
               "    COMPREPLY=($(compgen -W '"
            << names(all)
            << " --help --version' -- \"$word\"))\n"
               "    return\n"
               "  fi\n"
               "  case ${COMP_WORDS[1]} in\n";
  for (const Completed& c : all)
    std::cout << "    " << c.name << ") options='" << c.options << "' words='" << c.words << "' ;;\n";
  std::cout << "  esac\n"
               "  case $word in\n"
               "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n"
               "    *)\n"
               "      [ \"$COMP_CWORD\" -eq 2 ] && COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
               "      COMPREPLY+=($(compgen -f -- \"$word\")) ;;\n"
               "  esac\n"
               "}\n"
               "complete -o filenames -F _truestep truestep ./truestep\n";
}

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "\\'" : std::string(1, c);
  return out + "'";
}

void print_fish(const std::vector<Completed>& all) {
  for (const Completed& c : all) {
    std::cout << "complete -c truestep -n __fish_use_subcommand -f -a " << c.name << " -d "
              << quoted(c.sentence) << '\n';
    const std::string when = " -n '__fish_seen_subcommand_from " + c.name + "'";
    if (!c.words.empty()) std::cout << "complete -c truestep" << when << " -a " << quoted(c.words) << '\n';
    std::string rest = c.options;
    for (size_t at = rest.find("--"); at != std::string::npos; at = rest.find("--", at + 2)) {
      const size_t end = std::min(rest.find(' ', at), rest.size());
      std::cout << "complete -c truestep" << when << " -l " << rest.substr(at + 2, end - at - 2) << '\n';
    }
  }
}

}  // namespace

void add_completion_command(Arguments app, int& exit_code) {
  auto shell = std::make_shared<std::string>();
  Arguments c =
      app.add_subcommand("completion", "a script that completes this program's commands in a shell");
  c.add_option("shell", *shell, "bash, zsh or fish").required().one_of({"bash", "zsh", "fish"});
  c.callback([shell, app, &exit_code] {
    const auto all = commands(app);
    if (*shell == "zsh") std::cout << "autoload -Uz bashcompinit && bashcompinit\n";
    if (*shell == "fish")
      print_fish(all);
    else
      print_bash(all);
    exit_code = kExitOk;
  });
}

}  // namespace truestep
