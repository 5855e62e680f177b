// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/pictures.h"
#include "knotreel/document/json.h"

namespace knotreel::cli {

void add_dump_command(CLI::App& program) {
  struct Arguments {
    std::string input;
    std::string output = "-";
    std::uint64_t frame = 0;
  };
  CLI::App* command =
      program.add_subcommand("dump", "Print one frame of a vector document as JSON, with all its numbers");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("FILE", arguments->input, "Vector document (.tcb); '-': standard input")
      ->type_name("")
      ->required();
  add_frame_option(*command, arguments->frame, "Frame, counted from 0");
  command->add_option("-o,--output", arguments->output, "File to write; '-': standard output")
      ->capture_default_str();
  command->footer(
      "\nThe fields are described in docs/format.md: knots, basis functions with their control points and\n"
      "t-configs, features.\nExample:\n  knotreel dump photo.tcb | jq '.knots | length'");
  command->callback([arguments] {
    check_paths({arguments->input}, {{arguments->output}});
    document::Reader reader = open_document(arguments->input);
    const document::FrameModel model = read_frame(reader, arguments->frame);
    write_text(arguments->output, document::frame_to_json(model, reader.info()) + "\n");
  });
}

}  // namespace knotreel::cli
