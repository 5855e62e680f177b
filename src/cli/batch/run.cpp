// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/batch/run.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <new>

#include "cli/interrupt.h"
#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"

namespace knotreel::cli::batch {
namespace {

/// The gravest kind of failure so far. Safe to use from several threads.
class Gravest {
 public:
  void add(ErrorKind kind) {
    const std::lock_guard lock(mutex_);
    if (!kind_ || rank(kind) > rank(*kind_)) kind_ = kind;
  }

  /// For when all has ended.
  std::optional<ErrorKind> kind() const { return kind_; }

 private:
  static int rank(ErrorKind kind) {
    return kind == ErrorKind::kInput ? 0 : kind == ErrorKind::kOutput ? 2 : 1;
  }

  std::mutex mutex_;
  std::optional<ErrorKind> kind_;
};

/// Whether an output is there, finished and, if a document, sound, as the manifest says.
bool is_whole(const std::string& path, const Figures& figures) {
  try {
    if (!path.ends_with(".tcb")) return std::filesystem::file_size(path) == figures.file_bytes;
    document::Reader reader = document::Reader::open(path);
    if (!reader.complete() || reader.file_bytes() != figures.file_bytes) return false;
    for (std::size_t frame = 0; frame < reader.frame_count(); ++frame) reader.read(frame);
    return true;
  } catch (const Error&) {
    return false;
  } catch (const std::filesystem::filesystem_error&) {
    return false;
  }
}

class Run {
 public:
  Run(const Lot& lot, const Job& job, Manifest& manifest, Progress& progress)
      : lot_(lot), job_(job), manifest_(manifest), progress_(progress) {}

  void item(const Item& item, Room& room) {
    check_interrupted();
    // Looked at before the input is read: what changes meanwhile is done again by --resume.
    const std::optional<Stamp> stamp = stamp_of(item.input);
    if (const Entry* before = up_to_date(item, stamp)) {
      Entry entry = *before;
      entry.status = "skipped";
      end(entry);
      return;
    }
    const auto start = std::chrono::steady_clock::now();
    Entry entry = make(item, room);
    entry.stamp = stamp;
    entry.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    end(entry);
  }

  std::optional<ErrorKind> gravest() const { return gravest_.kind(); }

 private:
  const Entry* up_to_date(const Item& item, const std::optional<Stamp>& stamp) const {
    const auto found = lot_.before.find(item.input);
    if (found == lot_.before.end()) return nullptr;
    const Entry& before = found->second;
    if (before.status == "failed" || before.item.output != item.output) return nullptr;
    if (!stamp || before.stamp != stamp || !before.figures) return nullptr;
    return is_whole(item.output, *before.figures) ? &before : nullptr;
  }

  Entry make(const Item& item, Room& room) {
    try {
      return {item, "done", {}, job_.run(item, room), {}, 0};
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::kInterrupted) throw;
      return failed(item, e.kind(), e.what());
    } catch (const std::bad_alloc&) {
      return failed(item, ErrorKind::kInternal, "not enough memory for '" + item.input + "'");
    } catch (const std::exception& e) {
      return failed(item, ErrorKind::kInternal,
                    "internal error at '" + item.input + "': " + std::string(e.what()));
    }
  }

  Entry failed(const Item& item, ErrorKind kind, const std::string& message) {
    gravest_.add(kind);
    return {item, "failed", message, {}, {}, 0};
  }

  void end(const Entry& entry) {
    manifest_.add(entry);
    progress_.add(entry);
  }

  const Lot& lot_;
  const Job& job_;
  Manifest& manifest_;
  Progress& progress_;
  Gravest gravest_;
};

}  // namespace

void run_lot(const Lot& lot, const Job& job, Manifest& manifest, Progress& progress) {
  Run run(lot, job, manifest, progress);
  try {
    run_jobs(
        lot.items.size(), lot.crew, [&](std::size_t i, Room& room) { run.item(lot.items[i], room); },
        [&] { progress.tick(); });
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::kInterrupted) throw;
    throw Error(ErrorKind::kInterrupted,
                fmt::format("interrupted after {} of {} items (--resume goes on from there)",
                            progress.counts().ended(), progress.counts().total));
  }
  progress.finish();
  if (const auto kind = run.gravest()) {
    throw Error(*kind, fmt::format("{} of {} items failed; the manifest tells which",
                                   progress.counts().failed, progress.counts().total));
  }
}

}  // namespace knotreel::cli::batch
