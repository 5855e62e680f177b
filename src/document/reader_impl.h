// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "document/document_file.h"
#include "knotreel/base/error.h"
#include "knotreel/document/reader.h"

namespace knotreel::document {

class Reader::Impl {
 public:
  explicit Impl(std::unique_ptr<ByteSource> source) : file(std::move(source), true) {}

  void require_frame(std::size_t frame) const {
    if (frame < file.records().size()) return;
    throw Error(ErrorKind::kInvalidArgument, "there is no frame " + std::to_string(frame) +
                                                 ": the document has " +
                                                 std::to_string(file.records().size()) + ", counted from 0");
  }

  DocumentFile file;
};

}  // namespace knotreel::document
