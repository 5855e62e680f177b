// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/distinct_paths.h"
#include "cli/document_part.h"
#include "cli/file_names.h"
#include "cli/interrupt.h"
#include "cli/part_options.h"
#include "cli/pictures.h"
#include "cli/printable.h"
#include "cli/video_report.h"
#include "cli/video_run.h"
#include "knotreel/base/error.h"
#include "knotreel/pipeline/copy_job.h"
#include "knotreel/video/picture_list.h"

namespace knotreel::cli {
namespace {

namespace fs = std::filesystem;

struct CopyArguments {
  std::vector<std::string> inputs;
  std::string output;
  std::string split_folder;
  PartOptions part;  ///< of all of them in a row
  std::string rate = "25";
};

/// Folders and patterns as the documents that they mean.
std::vector<std::string> documents_of(const std::vector<std::string>& inputs) {
  std::vector<std::string> documents;
  for (const std::string& input : inputs) {
    if (!video::means_pictures(input)) {
      documents.push_back(input);
      continue;
    }
    for (std::string& name : video::list_documents(input)) documents.push_back(std::move(name));
  }
  return documents;
}

/// Pipes can be read once only, so their documents stay open; of files there may be thousands.
class Documents {
 public:
  explicit Documents(std::vector<std::string> names) : names_(std::move(names)), open_(names_.size()) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      check_interrupted();
      document::Reader reader = open_document(names_[i]);
      contents_.push_back(pipeline::contents_of(reader, names_[i]));
      std::error_code ignored;
      if (!fs::is_regular_file(names_[i], ignored)) open_[i] = std::move(reader);
    }
  }

  const std::vector<pipeline::Contents>& contents() const { return contents_; }

  document::Reader reader(std::size_t document) {
    return open_[document] ? std::move(*open_[document]) : open_document_silently(names_[document]);
  }

 private:
  std::vector<std::string> names_;
  std::vector<std::optional<document::Reader>> open_;
  std::vector<pipeline::Contents> contents_;
};

pipeline::CopyPlan plan_of(const CopyArguments& arguments, const Documents& documents) {
  pipeline::CopyPlan plan =
      pipeline::plan_copy(documents.contents(), parse_rate("--image-rate", arguments.rate));
  std::vector<std::int64_t> times;
  for (const pipeline::CopiedFrame& frame : plan.frames) times.push_back(frame.pts);
  const double tick = double(plan.info.time_base_num) / double(plan.info.time_base_den);
  const FrameRange range = frames_of(times, tick, part_of(arguments.part));
  const std::size_t count = frames_in(range, times.size());
  return pipeline::part_of(std::move(plan), range.first, range.first + count - 1);
}

std::string copy_text(const CopyArguments& arguments, std::size_t documents,
                      const pipeline::CopySummary& summary) {
  const std::string from = documents > 1 ? fmt::format(" of {} documents", documents) : "";
  if (arguments.output.empty())
    return fmt::format("{}: {}{}\n", printable(arguments.split_folder), counted(summary.frames, "frame"),
                       from);
  return fmt::format("{}: {}{}, {} bytes\n", printable(arguments.output), counted(summary.frames, "frame"),
                     from, summary.document_bytes);
}

void run_copy(const CopyArguments& arguments) {
  if (arguments.output.empty() && arguments.split_folder.empty()) {
    throw Error(ErrorKind::kInvalidArgument, "give --output or --split");
  }
  check_document_name(arguments.output);
  if (arguments.split_folder.empty()) warn_of_numbered_document(arguments.output);
  const std::vector<std::string> names = documents_of(arguments.inputs);
  const std::vector<Output> outputs{{arguments.output}, split_output(arguments.split_folder)};
  check_paths(names, outputs);
  Documents documents(names);
  pipeline::CopyJob job;
  job.plan = plan_of(arguments, documents);
  warn_all(job.plan.warnings);
  job.open = [&](std::size_t document) { return documents.reader(document); };
  job.document = arguments.output;
  job.split_folder = arguments.split_folder;
  job.stop = [] { return interrupted(); };
  pipeline::CopySummary summary;
  {
    VideoLine line(job.plan.frames.size());
    job.on_frame = [&](const pipeline::FrameRow& row) { line.show(row); };
    summary = pipeline::run_copy(job);
  }
  if (!uses_standard_output(outputs)) {
    tell_result(copy_text(arguments, names.size(), summary));
  }
  if (summary.stopped) throw_stopped(summary.frames);
}

constexpr const char* kCopyFooter = R"(
Nothing is computed again: frames keep all their numbers, and are stored as changes to the frame before where
they were and it still is before them. A document that was cut short becomes a whole one.
Each document begins where the one before ends; those that a video was split into keep their times.
Examples:
  knotreel copy clip.tcb -o part.tcb --start 1:05 --end 1:07.5
  knotreel copy opening.tcb clip.tcb -o both.tcb
  knotreel copy clip.tcb --split frames
  knotreel copy frames -o clip.tcb
  knotreel copy 'shot_*.tcb' -o - | knotreel render - -o film.mp4)";

}  // namespace

void add_copy_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("copy", "Copy frames of vector documents: a part of one, or several in a row");
  const auto arguments = std::make_shared<CopyArguments>();
  command
      ->add_option(
          "DOCUMENTS", arguments->inputs,
          "Vector documents (.tcb), folders of them, or patterns such as\nframe_%06d.tcb; '-': standard "
          "input")
      ->type_name("")
      ->required();
  command
      ->add_option("-o,--output", arguments->output, "Vector document to write (.tcb); '-': standard output")
      ->type_name("FILE");
  add_split_option(*command, arguments->split_folder);
  add_part_options(*command, arguments->part,
                   "Only these frames, counted from 0 over all documents; A- is up to the\nend");
  command
      ->add_option(
          "--image-rate", arguments->rate,
          "Frames per second of documents that do not say how long they last, such\nas those of pictures")
      ->type_name("R")
      ->capture_default_str();
  add_no_overwrite_option(*command);
  add_quiet_option(*command);
  command->footer(kCopyFooter);
  command->callback([arguments] { run_copy(*arguments); });
}

}  // namespace knotreel::cli
