// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/document_sink.h"

namespace knotreel::pipeline {

DocumentSink::DocumentSink(const std::string& path, const document::SequenceInfo& info,
                           const document::EncodeOptions& options)
    : stream_(path), writer_(stream_.out(), info, options) {}

document::FrameModel DocumentSink::append(const document::FrameModel& model) {
  document::FrameModel stored = writer_.append(model);
  stream_.out().flush();
  return stored;
}

std::uint64_t DocumentSink::bytes() const {
  return stream_.bytes();
}

void DocumentSink::finish(std::int64_t last_duration) {
  writer_.finish(last_duration);
  stream_.commit();
}

}  // namespace knotreel::pipeline
