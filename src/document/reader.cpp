// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/reader.h"

#include <utility>

#include "document/reader_impl.h"
#include "knotreel/base/error.h"

namespace knotreel::document {

Reader::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

Reader Reader::open(const std::filesystem::path& path) {
  return Reader(std::make_unique<Impl>(open_file(path)));
}

Reader Reader::open(std::vector<std::byte> bytes, std::string name) {
  return Reader(std::make_unique<Impl>(open_memory(std::move(bytes), std::move(name))));
}

const SequenceInfo& Reader::info() const {
  return impl_->file.format().info;
}
std::size_t Reader::frame_count() const {
  return impl_->file.records().size();
}
bool Reader::complete() const {
  return impl_->file.complete();
}
double Reader::colour_tolerance() const {
  return impl_->file.format().colour_scale();  // keyframes have twice the step of the file
}
Steps Reader::steps() const {
  const Format& format = impl_->file.format();
  return {format.colour_step, format.displacement_step};
}
std::int64_t Reader::last_duration() const {
  return impl_->file.last_duration();
}
std::uint64_t Reader::file_bytes() const {
  return impl_->file.bytes();
}

const FrameRecord& Reader::record(std::size_t frame) const {
  impl_->require_frame(frame);
  return impl_->file.records()[frame];
}

FrameModel Reader::read(std::size_t frame) {
  impl_->require_frame(frame);
  return to_model(impl_->file.read(frame), impl_->file.format());
}

}  // namespace knotreel::document
