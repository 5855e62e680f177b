// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/manual.h"

#include <sstream>
#include <vector>

#include "cli/command.h"

namespace knotreel::cli {
namespace {

/// Text as troff prints it, on one line.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c == '\n' ? ' ' : c;
    }
  }
  const bool is_request = !result.empty() && (result[0] == '.' || result[0] == '\'');
  return is_request ? "\\&" + result : result;
}

/// Lines that stay as they are.
std::string verbatim(const std::string& text) {
  std::istringstream lines(text);
  std::string result = ".nf\n";
  for (std::string line; std::getline(lines, line);) result += escaped(line) + "\n";
  return result + ".fi\n";
}

std::vector<const CLI::Option*> options_of(const CLI::App& command, const std::string& group) {
  return command.get_options(
      [&](const CLI::Option* option) { return option->get_group() == group && option->nonpositional(); });
}

/// "-o, --output FILE" and what it does.
std::string option_entry(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  std::string entry = ".TP\n.B " + escaped(names) + "\n";
  if (!option.get_type_name().empty() && option.get_items_expected_max() > 0)
    entry = ".TP\n.BI \"" + escaped(names) + " \" \"" + escaped(option.get_type_name()) + "\"\n";
  entry += escaped(option.get_description());
  if (!option.get_default_str().empty()) entry += " (default " + escaped(option.get_default_str()) + ")";
  return entry + "\n";
}

std::string positional_entry(const CLI::Option& option) {
  return ".TP\n.I " + escaped(option.get_name(true, false)) + "\n" + escaped(option.get_description()) + "\n";
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::string command_section(const CLI::App& command) {
  std::string usage = "knotreel " + command.get_name() + " [OPTIONS]";
  for (const CLI::Option* option : positionals_of(command)) {
    const std::string name = option->get_name(true, false);
    usage += option->get_required() ? " " + name : " [" + name + "]";
    if (option->get_items_expected_max() > 1) usage += "...";
  }
  std::string section = ".SH \"" + escaped(usage) + "\"\n" + escaped(command.get_description()) + ".\n";
  for (const CLI::Option* option : positionals_of(command)) section += positional_entry(*option);
  for (const std::string& group : command.get_groups()) {
    const auto options = options_of(command, group);
    if (options.empty() || group.empty()) continue;
    section += ".SS \"" + escaped(group) + "\"\n";
    for (const CLI::Option* option : options) section += option_entry(*option);
  }
  if (!command.get_footer().empty()) section += ".PP\n" + verbatim(command.get_footer());
  return section;
}

}  // namespace

std::string manual_page(const CLI::App& program) {
  std::string page = ".TH KNOTREEL 1 \"\" \"knotreel " KNOTREEL_VERSION "\" \"User Commands\"\n";
  page += ".SH NAME\nknotreel \\- video and pictures to vector graphics, and back\n";
  page += ".SH SYNOPSIS\n.B knotreel\n.I COMMAND\n[OPTIONS] ...\n";
  page +=
      ".SH DESCRIPTION\n" + escaped(program.get_description()) + "\n.PP\n" + verbatim(program.get_footer());
  for (const CLI::App* command : shown_commands(program)) page += command_section(*command);
  return page;
}

void add_manual_command(CLI::App& program) {
  program.add_subcommand("manual", "Print the manual page")->group("")->callback([&program] {
    write_text("-", manual_page(program));
  });
}

}  // namespace knotreel::cli
