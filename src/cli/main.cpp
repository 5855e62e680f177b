// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/completion.h"
#include "cli/heap.h"
#include "cli/interrupt.h"
#include "cli/manual.h"
#include "cli/standard_error.h"
#include "cli/suggestion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/output_file.h"

namespace {

using namespace knotreel;

constexpr const char* kFooter = R"(
Examples:
  knotreel transcode clip.mp4 -o large.mp4 --scale 2  video to vectors and back, twice as large
  knotreel vectorize clip.mp4 -o clip.tcb             video to a document with all frames
  knotreel render clip.tcb -o clip.mkv                and back
  knotreel vectorize photo.png -o photo.tcb           picture to vector document
  knotreel render photo.tcb -o large.png --scale 4    and back, four times as large
  knotreel export photo.tcb -o photo.pdf              for other programs
  knotreel copy clip.tcb -o part.tcb --frames 0-99    a part, as it is
  knotreel compare photo.png photo.tcb                how close is it?
  knotreel info photo.tcb                             what is in it?
'knotreel help COMMAND' tells more about a command.

Videos: all that libav reads and writes. Pictures: PNG, JPEG, TIFF, WebP, BMP, PBM/PGM/PPM, PAM, PFM.
'-' is standard input or output.
Exit codes: 0 done, 2 wrong usage, 3 input unreadable or corrupt, 4 output cannot be written,
130 interrupted, 1 anything else. An error is one line on standard error.)";

/// What is wrong with the first argument that a command could not use.
std::string unused_argument(const CLI::App& command) {
  const std::vector<std::string> left = command.remaining();
  const auto is_option = [](const std::string& argument) {
    return argument.size() > 1 && argument[0] == '-';
  };
  const auto option = std::find_if(left.begin(), left.end(), is_option);
  if (option == left.end()) {
    const CLI::Option* const output = command.get_option_no_throw("--output");
    return "'" + left.front() + "' is one argument too many" +
           (output && output->count() == 0 ? "; -o names the output" : "");
  }
  const std::string name = option->substr(0, option->find('='));
  return "there is no option '" + name + "'" + cli::suggestion(name, cli::long_names(command));
}

/// "help" and "help COMMAND" mean "--help" and "COMMAND --help".
std::vector<std::string> arguments_of(int argc, char** argv) {
  std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  if (!arguments.empty() && arguments.front() == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
  return arguments;
}

void run(int argc, char** argv) {
  std::vector<std::string> arguments = arguments_of(argc, argv);
  CLI::App program(
      "Turns videos and pictures into smooth vector graphics (TCB-spline surfaces), and those into\n"
      "videos and pictures of any size.",
      "knotreel");
  program.footer(kFooter);
  program.set_version_flag("--version", [] { return cli::version_text(); });
  program.require_subcommand(1);
  cli::add_vectorize_command(program);
  cli::add_transcode_command(program);
  cli::add_batch_command(program);
  cli::add_render_command(program);
  cli::add_export_command(program);
  cli::add_copy_command(program);
  cli::add_info_command(program);
  cli::add_dump_command(program);
  cli::add_compare_command(program);
  cli::add_bench_command(program);
  cli::add_manual_command(program);
  cli::add_completion_command(program);
  // CLI11 would only say that a command is missing.
  const auto commands = program.get_subcommands([](const CLI::App*) { return true; });
  const std::string name = arguments.empty() ? "" : arguments.front();
  const auto named = [&](const CLI::App* command) { return command->get_name() == name; };
  const bool has_command = !arguments.empty() && !name.starts_with('-');
  if (has_command && std::none_of(commands.begin(), commands.end(), named)) {
    std::vector<std::string> names;
    for (const CLI::App* command : cli::shown_commands(program)) names.push_back(command->get_name());
    names.emplace_back("help");
    throw Error(ErrorKind::kInvalidArgument, "there is no command '" + name + "'" +
                                                 cli::suggestion(name, names) + " (see knotreel --help)");
  }
  try {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
    program.parse(std::move(arguments));
  } catch (const CLI::CallForVersion&) {
    cli::write_text("-", cli::version_text());
  } catch (const CLI::CallForHelp&) {
    cli::write_text("-", program.help());  // of the subcommand, if one was named
  } catch (const CLI::ParseError& e) {
    const CLI::App* const command = has_command ? program.get_subcommand(name) : nullptr;
    const bool has_extras = command && dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr;
    const std::string message = e.what();
    throw Error(ErrorKind::kInvalidArgument,
                (has_extras ? unused_argument(*command) : message.substr(0, message.find('\n'))) +
                    " (see knotreel " + (command ? command->get_name() + " " : "") + "--help)");
  }
}

}  // namespace

/// A file that is opened would get the number of a standard stream that is closed, and what is meant for that
/// one would end up in the file. In its place comes one that cannot be written to, respectively read.
static void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

int main(int argc, char** argv) {
  open_standard_streams();
  knotreel::cli::keep_standard_error();
  knotreel::cli::set_up_heap();
  knotreel::cli::install_signal_handlers();
  knotreel::set_check_while_waiting(knotreel::cli::check_interrupted);
  try {
    run(argc, argv);
    return 0;
  } catch (const BrokenPipe& e) {
    return exit_code(e.kind());  // the reader knows, and a message would only clutter the pipeline
  } catch (const Error& e) {
    cli::put_error_line(e.what());
    return exit_code(e.kind());
  } catch (const std::bad_alloc&) {
    cli::put_error_line("not enough memory");
  } catch (const std::exception& e) {
    cli::put_error_line(std::string("internal error: ") + e.what());
  }
  return exit_code(ErrorKind::kInternal);
}
