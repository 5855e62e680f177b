// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/command.h"

#include <fmt/format.h>

#include "cli/standard_error.h"
#include "knotreel/base/output_file.h"

namespace knotreel::cli {
namespace {

bool quiet = false;  // set before commands run, and not changed any more

}  // namespace

std::vector<const CLI::App*> shown_commands(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

CLI::Validator within(double low, double high) {
  const auto check = [low, high](const std::string& text) {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
    return fmt::format("takes a number from {:g} to {:g}, not '{}'", low, high, text);
  };
  return {check, ""};
}

void add_threads_option(CLI::App& command, int& threads) {
  command
      .add_option(
          "--threads", threads,
          "Most threads to use, up to 1024; 0: one per core. Pictures and documents\ndo not depend on it")
      ->check(CLI::Range(0, 1024).description(""))
      ->type_name("N")
      ->capture_default_str();
}

void add_quiet_option(CLI::App& command) {
  command.add_flag_callback(
      "-q,--quiet", [] { quiet = true; }, "Tell nothing but warnings and errors");
}

bool is_quiet() {
  return quiet;
}

bool shows_live_line() {
  return !quiet && standard_error_is_terminal();
}

void tell_result(const std::string& text) {
  if (!quiet) write_text("-", text);
}

void add_background_option(CLI::App& command, std::string& colour) {
  command
      .add_option(
          "--background", colour,
          "Put pictures with alpha on this colour: black, white, #rrggbb\nor R,G,B. Without it, alpha "
          "is kept;\ncodecs that have none get black")
      ->type_name("COLOUR");
}

void add_frame_option(CLI::App& command, std::uint64_t& frame, const std::string& description) {
  command.add_option("--frame", frame, description)
      ->check(CLI::Range(0, 0x7fffffff).description(""))  // CLI11 would let -1 wrap around
      ->type_name("N")
      ->capture_default_str();
}

void warn(const std::string& message) {
  put_error_line("warning: " + message);
}

void warn_all(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) warn(message);
}

void warn_of(const std::string& path, const std::vector<std::string>& messages) {
  for (const std::string& message : messages) warn("'" + path + "': " + message);
}

std::vector<std::string> options_given(const CLI::App& command, const std::string& group) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group() == group && option->count() > 0) names.push_back(option->get_name());
  }
  return names;
}

std::vector<std::string> long_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

void write_text(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace knotreel::cli
