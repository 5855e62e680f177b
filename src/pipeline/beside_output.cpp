// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/beside_output.h"

#include "knotreel/video/turn.h"

namespace knotreel::pipeline {

void BesideOutput::compose(Message& message) const {
  if (job_.compose) message.beside = job_.compose(*message.picture, message.model);
}

void BesideOutput::write(Message& message) {
  if (!job_.compose) return;
  if (!message.repeats) written_ = std::move(message.beside);
  if (!writer_) {
    video::StreamInfo info = video::turned(job_.reader->info(), video::turn_of(job_.reader->info()));
    info.width = written_.width;
    info.height = written_.height;
    info.channels = written_.channels;
    info.depth = 8;
    info.pixel_format = "yuv420p";
    writer_.emplace(video::VideoWriter::create(job_.beside, info));
  }
  writer_->write(written_, message.frame.pts, message.frame.duration);
}

void BesideOutput::finish() {
  if (writer_) writer_->finish();
}

}  // namespace knotreel::pipeline
