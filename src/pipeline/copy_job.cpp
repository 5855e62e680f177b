// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/copy_job.h"

#include <chrono>
#include <optional>

#include "knotreel/base/error.h"
#include "knotreel/document/copier.h"
#include "knotreel/pipeline/sequence.h"
#include "pipeline/document_stream.h"
#include "pipeline/split_folder.h"

namespace knotreel::pipeline {
namespace {

/// A document that is written by copying.
class CopiedDocument {
 public:
  CopiedDocument(const std::string& path, const CopyPlan& plan)
      : stream_(path), copier_(stream_.out(), plan.info, plan.steps) {}

  std::size_t append(document::Reader& from, std::size_t frame, const document::Copier::Place& place) {
    return copier_.append(from, frame, place);
  }
  void finish(std::int64_t last_duration = 0) {
    copier_.finish(last_duration);
    stream_.commit();
  }
  std::uint64_t bytes() const { return stream_.bytes(); }

 private:
  DocumentStream stream_;
  document::Copier copier_;
};

class Copying {
 public:
  explicit Copying(const CopyJob& job) : job_(job) {
    if (!job.document.empty()) document_.emplace(job.document, job.plan);
    make_split_folder(job.split_folder);
  }

  CopySummary run() {
    for (const CopiedFrame& frame : job_.plan.frames) {
      summary_.stopped = job_.stop && job_.stop();
      if (summary_.stopped) break;
      copy(frame);
    }
    // A document without a frame is none.
    if (document_ && summary_.frames > 0) {
      document_->finish(duration_to_tell(job_.plan.info, last_frame()));
      summary_.document_bytes = document_->bytes();
    }
    return summary_;
  }

 private:
  LastFrame last_frame() const {
    const std::vector<CopiedFrame>& all = job_.plan.frames;
    const std::size_t count = summary_.frames;
    const std::int64_t pts = all[count - 1].pts;
    const std::int64_t end = count < all.size() ? all[count].pts : job_.plan.end;
    return {pts, count > 1 ? pts - all[count - 2].pts : 0, end - pts};
  }

  void copy(const CopiedFrame& frame) {
    document::Reader& from = reader_of(frame);
    const bool follows = last_ && last_->document == frame.document && last_->frame + 1 == frame.frame;
    FrameRow row;
    row.index = summary_.frames;
    row.pts = frame.pts;
    if (document_) {
      const std::uint64_t before = document_->bytes();
      row.knots = document_->append(from, frame.frame, {row.index, frame.pts, follows});
      row.bytes = document_->bytes() - before;
    }
    if (!job_.split_folder.empty()) row.knots = write_single(from, frame, row.index);
    last_ = frame;
    ++summary_.frames;
    row.finished_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (job_.on_frame) job_.on_frame(row);
  }

  /// @return the number of knots.
  std::size_t write_single(document::Reader& from, const CopiedFrame& frame, std::uint64_t index) const {
    CopiedDocument single(single_path(job_.split_folder, index), job_.plan);
    const std::size_t knots =
        single.append(from, frame.frame, {index, frame.pts, /*follows=*/false, /*rename_knots=*/true});
    single.finish();
    return knots;
  }

  document::Reader& reader_of(const CopiedFrame& frame) {
    if (!reader_ || last_->document != frame.document) reader_.emplace(job_.open(frame.document));
    if (frame.frame >= reader_->frame_count()) {
      throw Error(ErrorKind::kInput, "a document has become shorter while it was copied");
    }
    return *reader_;
  }

  const CopyJob& job_;
  std::optional<CopiedDocument> document_;
  std::optional<document::Reader> reader_;
  std::optional<CopiedFrame> last_;
  CopySummary summary_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

CopySummary run_copy(const CopyJob& job) {
  return Copying(job).run();
}

}  // namespace knotreel::pipeline
