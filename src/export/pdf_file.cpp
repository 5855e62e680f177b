// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/pdf_file.h"

#include <zlib.h>

#include <array>
#include <new>

#include "knotreel/base/error.h"

namespace knotreel::exporting {

struct PdfFile::Deflate {
  z_stream stream{};

  Deflate() {
    if (deflateInit(&stream, 7) != Z_OK) throw std::bad_alloc();
  }
  ~Deflate() { deflateEnd(&stream); }
  Deflate(const Deflate&) = delete;
  Deflate& operator=(const Deflate&) = delete;
};

PdfFile::PdfFile(OutputFile& file, const std::string& version) : file_(file), offsets_(1) {
  // The bytes above 127 tell transfer programs that the file is binary.
  file_.write("%PDF-" + version + "\n%\xe2\xe3\xcf\xd3\n");
}

PdfFile::~PdfFile() = default;

int PdfFile::reserve() {
  offsets_.push_back(0);
  return static_cast<int>(offsets_.size() - 1);
}

void PdfFile::start(int number) {
  offsets_[static_cast<std::size_t>(number)] = file_.size();
  file_.write(std::to_string(number) + " 0 obj\n");
}

void PdfFile::write_object(int number, const std::string& body) {
  start(number);
  file_.write(body + "\nendobj\n");
}

void PdfFile::begin_stream(int number, const std::string& entries) {
  // The length is known at the end only, and a pipe cannot be rewound: it becomes an object of its own.
  length_object_ = reserve();
  start(number);
  file_.write("<<" + entries + "/Filter/FlateDecode/Length " + reference(length_object_) + ">>\nstream\n");
  stream_begin_ = file_.size();
  deflate_ = std::make_unique<Deflate>();
}

void PdfFile::deflate_into_file(std::span<const std::byte> bytes, bool last) {
  z_stream& z = deflate_->stream;
  std::array<std::byte, 16384> out;
  // zlib takes its input through a pointer to non-const, and leaves it alone.
  z.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  do {
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    deflate(&z, last ? Z_FINISH : Z_NO_FLUSH);
    file_.write(std::span(out).first(out.size() - z.avail_out));
  } while (z.avail_out == 0);
}

void PdfFile::add_to_stream(std::span<const std::byte> bytes) {
  constexpr std::size_t kPart = std::size_t{1} << 30;  // zlib counts in 32 bits
  for (; bytes.size() > kPart; bytes = bytes.subspan(kPart)) deflate_into_file(bytes.first(kPart), false);
  if (!bytes.empty()) deflate_into_file(bytes, false);
}

void PdfFile::end_stream() {
  deflate_into_file({}, true);
  deflate_.reset();
  const std::uint64_t length = file_.size() - stream_begin_;
  file_.write("\nendstream\nendobj\n");
  write_object(length_object_, std::to_string(length));
}

void PdfFile::finish(int catalog, int info) {
  const std::uint64_t table = file_.size();
  // Offsets have ten digits; no export comes near.
  std::string text = "xref\n0 " + std::to_string(offsets_.size()) + "\n0000000000 65535 f \n";
  for (std::size_t i = 1; i < offsets_.size(); ++i) {
    const std::string offset = std::to_string(offsets_[i]);
    text += std::string(10 - offset.size(), '0') + offset + " 00000 n \n";
  }
  text += "trailer\n<</Size " + std::to_string(offsets_.size()) + "/Root " + reference(catalog) + "/Info " +
          reference(info) + ">>\nstartxref\n" + std::to_string(table) + "\n%%EOF\n";
  file_.write(text);
}

std::string reference(int number) {
  return std::to_string(number) + " 0 R";
}

}  // namespace knotreel::exporting
