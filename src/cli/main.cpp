#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <new>
#include <string>

#include "cli/command.h"
#include "cli/completion.h"
#include "cli/heap.h"
#include "cli/interrupt.h"
#include "cli/manual.h"
#include "cli/standard_error.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/output_file.h"

namespace {

using namespace knotreel;

constexpr const char* kFooter = R"(
Examples:
  knotreel transcode clip.mp4 -o large.mp4 --scale 2 video to vectors and back, twice as large
  knotreel vectorize clip.mp4 -o clip.tcb            video to a document with all frames
  knotreel render clip.tcb -o clip.mkv               and back
  knotreel vectorize photo.png -o photo.tcb          picture to vector document
  knotreel render photo.tcb -o large.png --scale 4   and back, four times as large
  knotreel export photo.tcb -o photo.pdf             for other programs
  knotreel copy clip.tcb -o part.tcb --frames 0-99   a part, as it is
  knotreel compare photo.png photo.tcb               how close is it?
  knotreel info photo.tcb                            what is in it?
'knotreel COMMAND --help' tells more about a command.

Videos: all that libav reads and writes. Pictures: PNG, JPEG, TIFF, WebP, BMP, PBM/PGM/PPM, PAM, PFM.
'-' is standard input or output.
Exit codes: 0 done, 2 wrong usage, 3 input unreadable or corrupt, 4 output cannot be written,
130 interrupted, 1 anything else. An error is one line on standard error.)";

void run(int argc, char** argv) {
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
  const auto named = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  const bool has_command = argc > 1 && argv[1][0] != '-';
  if (has_command && std::none_of(commands.begin(), commands.end(), named)) {
    throw Error(ErrorKind::kInvalidArgument,
                "there is no command '" + std::string(argv[1]) + "' (see knotreel --help)");
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForVersion&) {
    cli::write_text("-", cli::version_text());
  } catch (const CLI::CallForHelp&) {
    cli::write_text("-", program.help());  // of the subcommand, if one was named
  } catch (const CLI::ParseError& e) {
    const std::string message = e.what();
    const std::string command = has_command ? argv[1] + std::string(" ") : "";
    throw Error(ErrorKind::kInvalidArgument,
                message.substr(0, message.find('\n')) + " (see knotreel " + command + "--help)");
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
