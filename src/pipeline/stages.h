// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "knotreel/pipeline/sequence.h"
#include "knotreel/track/group_rule.h"
#include "pipeline/beside_output.h"
#include "pipeline/document_sink.h"
#include "pipeline/failure.h"
#include "pipeline/message.h"
#include "pipeline/picture_output.h"
#include "pipeline/stretch.h"

namespace knotreel::pipeline {

/// The stages of a Job. analyse(), ahead() and rasterize() may work on several messages at once, model() on
/// one of each stretch at a time and in order, each of the others on one at a time and in order. No stage but
/// finish() throws: see FirstFailure.
class Stages {
 public:
  /// Opens the outputs. @throws as they do.
  explicit Stages(const Job& job);

  /// The next frame, with the picture before it; null at the end, after a stop, or after a failure.
  MessagePtr decode();
  void analyse(Message& message);
  /// Foresees which frames start a group, and tells those apart that depend on each other.
  void plan(Message& message);
  /// Makes those from their pictures, and of others what hangs on their picture alone.
  void ahead(Message& message);
  void model(Message& message);
  void documents(Message& message);
  void rasterize(Message& message);
  void encode(Message& message);

  /// Completes the files. @throws the first failure of any stage.
  Summary finish();

 private:
  void cold(Message& message);
  void write_single(const Message& message);
  void draw(Message& message) const;

  const Job& job_;
  document::SequenceInfo info_;
  PictureOutput output_;
  BesideOutput beside_;
  DocumentSink document_;
  document::FrameModel stored_;  ///< the last frame
  bool is_known_ = false;        ///< and its surface
  LastFrame last_;               ///< likewise
  track::GroupRule groups_;
  bool groups_at_once_;               ///< frames that start one are made ahead
  std::shared_ptr<Stretch> stretch_;  ///< of the frame that was planned last
  FirstFailure failure_;
  std::shared_ptr<const image::Image> before_;
  std::uint64_t decoded_ = 0;
  bool stopped_ = false;
};

}  // namespace knotreel::pipeline
