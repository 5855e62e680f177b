// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"

namespace knotreel {
namespace {

using test::expect_success;
using test::knotreel;

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The first words of the lines of the help between "Subcommands:" and the next empty line.
std::vector<std::string> commands() {
  std::vector<std::string> names;
  bool here = false;
  for (const std::string& line : lines_of(knotreel({"--help"}).out)) {
    if (here && line.empty()) break;
    if (here) names.push_back(line.substr(2, line.find(' ', 2) - 2));
    here = here || line == "Subcommands:";
  }
  return names;
}

/// The long names of the options that the help of a command tells of.
std::vector<std::string> options_in_help(const std::string& command) {
  std::vector<std::string> names;
  for (const std::string& line : lines_of(knotreel({command, "--help"}).out)) {
    const std::size_t start = line.find("--");
    if (line.rfind("  -", 0) != 0 || start == std::string::npos) continue;
    names.push_back(line.substr(start, line.find_first_of(" ={,", start) - start));
  }
  return names;
}

std::string without_backslashes(std::string text) {
  std::erase(text, '\\');
  return text;
}

TEST(Manual, TellsOfAllCommandsAndOptions) {
  const auto result = knotreel({"manual"});
  expect_success(result);
  const std::string page = without_backslashes(result.out);
  ASSERT_GE(commands().size(), 10u);
  for (const std::string& command : commands()) {
    EXPECT_NE(page.find(".SH \"knotreel " + command + " [OPTIONS]"), std::string::npos) << command;
    ASSERT_GE(options_in_help(command).size(), 1u) << command;
    for (const std::string& option : options_in_help(command)) {
      const bool told =
          page.find(option + " ") != std::string::npos || page.find(option + "\n") != std::string::npos;
      EXPECT_TRUE(told) << command << " " << option;
    }
  }
}

TEST(Manual, HasOnlyRequestsThatTroffKnows) {
  const std::set<std::string> known{".TH", ".SH", ".SS", ".TP", ".PP", ".B", ".I", ".BI", ".nf", ".fi"};
  for (const std::string& line : lines_of(knotreel({"manual"}).out)) {
    if (line.empty()) continue;
    EXPECT_NE(line[0], '\'') << line;
    const bool is_fine = line[0] != '.' || known.count(line.substr(0, line.find(' '))) > 0;
    EXPECT_TRUE(is_fine) << line;
  }
}

/// What bash offers for the last of some words.
std::string offered(const std::string& words) {
  const test::TempDir dir;
  test::write_text(dir / "completion", knotreel({"completion"}).out);
  const std::string script = "source '" + (dir / "completion").string() + "'; COMP_WORDS=(" + words +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _knotreel; echo \"${COMPREPLY[*]}\"";
  return test::run({"/bin/bash", "-c", script}).out;
}

TEST(Completion, OffersCommandsAndOptions) {
  EXPECT_EQ(offered("knotreel tr"), "transcode\n");
  EXPECT_EQ(offered("knotreel transcode --side"), "--side-by-side\n");
  EXPECT_EQ(offered("knotreel info --side"), "\n");
  EXPECT_EQ(offered("knotreel info clip"), "\n");
  const std::string all = " " + offered("knotreel batch --");
  for (const std::string& option : options_in_help("batch"))
    EXPECT_NE(all.find(" " + option), std::string::npos) << option;
}

}  // namespace
}  // namespace knotreel
