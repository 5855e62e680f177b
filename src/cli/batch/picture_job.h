// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/batch/inputs.h"
#include "cli/batch/manifest.h"
#include "cli/batch/pool.h"
#include "cli/vectorize_options.h"

namespace knotreel::cli::batch {

/// A way from an input to an output. Objects are used from several threads at once.
class Job {
 public:
  Job() = default;
  virtual ~Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// Makes the output, which appears when it is whole. The memory that it takes beyond that of the decoded
  /// input is taken inside the room.
  /// @throws Error; kInterrupted after a signal.
  virtual Figures run(const Item& item, Room& room) const = 0;
};

/// Makes the folder that a file is to lie in. @throws Error{kOutput}
void make_folder_of(const std::string& path);

/// A picture to a document of one frame, byte for byte that of `knotreel vectorize`.
class PictureJob : public Job {
 public:
  /// @param alone_above  pictures of more pixels are in the room alone.
  PictureJob(VectorizeOptions options, double alone_above)
      : options_(std::move(options)), alone_above_(alone_above) {}
  Figures run(const Item& item, Room& room) const override;

 private:
  VectorizeOptions options_;
  double alone_above_;
};

}  // namespace knotreel::cli::batch
