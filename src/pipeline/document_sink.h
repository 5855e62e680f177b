// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "knotreel/document/writer.h"
#include "pipeline/document_stream.h"

namespace knotreel::pipeline {

/// A document that is written as OutputFile writes, or only counted. One thread at a time.
class DocumentSink {
 public:
  /// @param path  `-`: standard output; empty: nothing is kept. @throws as OutputFile and document::Writer.
  DocumentSink(const std::string& path, const document::SequenceInfo& info,
               const document::EncodeOptions& options = {});

  /// As document::Writer::append(); the frame is in the file then, whatever becomes of the program.
  document::FrameModel append(const document::FrameModel& model);

  /// Bytes so far.
  std::uint64_t bytes() const;

  /// Completes the document and gives it its name. @param last_duration  as document::Writer::finish().
  void finish(std::int64_t last_duration = 0);

 private:
  DocumentStream stream_;
  document::Writer writer_;
};

}  // namespace knotreel::pipeline
