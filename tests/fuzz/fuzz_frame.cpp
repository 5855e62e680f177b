// SPDX-License-Identifier: GPL-3.0-or-later
// Frame payloads. The first byte chooses degree and channels, the next two the length of a first frame; what
// is left is a second frame that may depend on it. A frame that decodes must also be one that the writer can
// store.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>

#include "document/bytes.h"
#include "document/frame_codec.h"
#include "knotreel/base/error.h"

namespace {

using namespace knotreel;
using namespace knotreel::document;

std::optional<FrameState> decode(std::span<const std::byte> payload, const FrameState* before,
                                 const Format& format) {
  try {
    return decode_frame(payload, before, format);
  } catch (const Malformed&) {
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::kInput) throw;
  }
  return std::nullopt;
}

void require_storable(FrameState state, const FrameState* before, const Format& format) {
  const std::vector<std::byte> payload = encode_frame(state, state.keyframe ? nullptr : before, format);
  const auto again = decode(payload, before, format);
  if (!again || again->colour != state.colour || again->displacement != state.displacement ||
      again->grid.points != state.grid.points || again->function_ids != state.function_ids) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 3) return 0;
  Format format;
  format.info.width = 64;
  format.info.height = 48;
  format.info.degree = 1 + data[0] % 3;
  format.info.channels = 1 + data[0] / 3 % 4;
  format.colour_step = 256;
  format.displacement_step = 256;
  const auto payloads = std::as_bytes(std::span(data, size)).subspan(3);
  const std::size_t first_size = std::min<std::size_t>(payloads.size(), data[1] + 256u * data[2]);
  const auto first = decode(payloads.first(first_size), nullptr, format);
  if (!first) return 0;
  require_storable(*first, nullptr, format);
  const auto second = decode(payloads.subspan(first_size), &*first, format);
  if (second) require_storable(*second, &*first, format);
  return 0;
}
