// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/completion.h"

#include <fmt/format.h>

#include "cli/command.h"

namespace knotreel::cli {
namespace {

std::string names_of_options(const CLI::App& command) {
  return fmt::format("{}", fmt::join(long_names(command), " "));
}

std::string names_of_commands(const CLI::App& program) {
  std::string names = "help";
  for (const CLI::App* command : shown_commands(program)) names += " " + command->get_name();
  return names;
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
  std::string cases;
  for (const CLI::App* command : shown_commands(program))
    cases += "      " + command->get_name() + ") words='" + names_of_options(*command) + "' ;;\n";
  return "_knotreel() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} words=\n"
         "  if ((COMP_CWORD == 1)); then\n"
         "    words='" +
         names_of_commands(program) + " " + names_of_options(program) +
         "'\n"
         "  elif [[ $word == -* ]]; then\n"
         "    case ${COMP_WORDS[1]} in\n" +
         cases +
         "    esac\n"
         "  fi\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "}\n"
         "complete -o default -F _knotreel knotreel\n";
}

void add_completion_command(CLI::App& program) {
  program.add_subcommand("completion", "Print a script that completes commands and options in bash")
      ->group("")
      ->callback([&program] { write_text("-", bash_completion(program)); });
}

}  // namespace knotreel::cli
