// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/document_stream.h"

#include <optional>
#include <span>
#include <streambuf>

#include "knotreel/base/output_file.h"

namespace knotreel::pipeline {

class DocumentStream::FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(const std::string& path) {
    if (!path.empty()) file_.emplace(path);
  }

  std::uint64_t bytes() const { return bytes_; }
  void commit() {
    if (file_) file_->commit();
  }

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    const auto size = static_cast<std::size_t>(count);
    if (file_) file_->write(std::as_bytes(std::span(text, size)));
    bytes_ += size;
    return count;
  }
  int sync() override {
    if (file_) file_->flush();
    return 0;
  }
  int_type overflow(int_type c) override {
    const char text = traits_type::to_char_type(c);
    xsputn(&text, 1);
    return c;
  }

 private:
  std::optional<OutputFile> file_;
  std::uint64_t bytes_ = 0;
};

DocumentStream::DocumentStream(const std::string& path)
    : buffer_(std::make_unique<FileBuffer>(path)), out_(buffer_.get()) {
  out_.exceptions(std::ios::badbit);
}

DocumentStream::~DocumentStream() = default;

std::uint64_t DocumentStream::bytes() const {
  return buffer_->bytes();
}

void DocumentStream::commit() {
  buffer_->commit();
}

}  // namespace knotreel::pipeline
