#pragma once

#include <algorithm>
#include <cstdint>

#include "document/frame_models.h"

/// Differences from predictions (docs/format.md, "Coded differences").
namespace knotreel::document {

/// Towards minus infinity.
constexpr std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a / b - ((a % b != 0 && a < 0) ? 1 : 0);
}

/// The differences coded so far near the next one: what size and sign to expect.
struct Around {
  std::int64_t sum = 0;   ///< of differences
  std::int64_t size = 0;  ///< of their magnitudes
  std::int64_t count = 0;

  void add(std::int64_t difference) {
    sum += difference;
    size += difference < 0 ? -difference : difference;
    ++count;
  }
  void add(const Around& other) {
    sum += other.sum;
    size += other.size;
    count += other.count;
  }
};

/// Sets `value` to prediction + the difference read, or writes the difference. @return the difference.
template <class Coder>
std::int64_t code_residual(Coder& coder, ResidualModels& models, const Around& around, std::int64_t& value,
                           std::int64_t prediction) {
  constexpr std::size_t kUnknown = ResidualModels::kSizes - 1;
  const std::size_t size =
      around.count == 0
          ? kUnknown
          : std::min(kUnknown - 1, number_class(static_cast<std::uint64_t>(2 * around.size / around.count)));
  const std::size_t sign = around.sum == 0 ? 0 : around.sum > 0 ? 1 : 2;
  const std::int64_t difference = code_signed(coder, models.magnitude[size], models.negative[sign],
                                              Coder::kWriting ? value - prediction : 0);
  // Values stay below 2^40 or are refused before they predict another, differences are below 2^61.
  constexpr std::int64_t kBound = std::int64_t{1} << 40;
  const std::int64_t result = prediction + difference;
  if (result < -kBound || result > kBound) malformed("a number is out of range");
  if constexpr (!Coder::kWriting) value = result;
  return difference;
}

}  // namespace knotreel::document
