// SPDX-License-Identifier: GPL-3.0-or-later
// Whole files, with all checksums ignored.

#include <cstddef>
#include <cstdint>
#include <span>

#include "document/document_file.h"
#include "knotreel/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace knotreel;
  const auto bytes = std::as_bytes(std::span(data, size));
  try {
    document::DocumentFile file(document::open_memory({bytes.begin(), bytes.end()}, "fuzz"), false);
    for (std::size_t f = 0; f < file.records().size(); ++f) {
      document::to_model(file.read(f), file.format());
    }
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::kInput) throw;
  }
  return 0;
}
