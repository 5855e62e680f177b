#include "pipeline/document_sink.h"

#include <optional>
#include <ostream>
#include <span>
#include <streambuf>

#include "knotreel/base/output_file.h"

namespace knotreel::pipeline {

class FileBuffer : public std::streambuf {
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

struct DocumentSink::Stream {
  explicit Stream(const std::string& path) : buffer(path), out(&buffer) {
    // Errors of the file reach the caller as they are, with the system's reason.
    out.exceptions(std::ios::badbit);
  }
  FileBuffer buffer;
  std::ostream out;
};

DocumentSink::DocumentSink(const std::string& path, const document::SequenceInfo& info,
                           const document::EncodeOptions& options)
    : stream_(std::make_unique<Stream>(path)), writer_(stream_->out, info, options) {}

DocumentSink::~DocumentSink() = default;

document::FrameModel DocumentSink::append(const document::FrameModel& model) {
  document::FrameModel stored = writer_.append(model);
  stream_->out.flush();
  return stored;
}

std::uint64_t DocumentSink::bytes() const {
  return stream_->buffer.bytes();
}

void DocumentSink::finish() {
  writer_.finish();
  stream_->buffer.commit();
}

}  // namespace knotreel::pipeline
