// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "knotreel/base/output_file.h"

namespace knotreel::exporting {

/// A PDF file of numbered objects, written front to back without seeking.
class PdfFile {
 public:
  /// @param version  such as "1.4".
  PdfFile(OutputFile& file, const std::string& version);
  ~PdfFile();

  /// A number for an object that is written, once, before finish().
  int reserve();

  void write_object(int number, const std::string& body);

  /// A Flate-compressed stream in parts. Between begin and end no other object may be written. `entries` are
  /// those of its dictionary apart from Length and Filter.
  void begin_stream(int number, const std::string& entries);
  void add_to_stream(std::span<const std::byte> bytes);
  void add_to_stream(const std::string& text) { add_to_stream(std::as_bytes(std::span(text))); }
  void end_stream();

  /// Cross-reference table and trailer.
  void finish(int catalog, int info);

 private:
  void start(int number);
  void deflate_into_file(std::span<const std::byte> bytes, bool last);

  struct Deflate;
  OutputFile& file_;
  std::vector<std::uint64_t> offsets_;  ///< by object number; [0] is not used
  std::unique_ptr<Deflate> deflate_;    ///< of the stream that is open
  int length_object_ = 0;
  std::uint64_t stream_begin_ = 0;
};

/// "12 0 R".
std::string reference(int number);

}  // namespace knotreel::exporting
