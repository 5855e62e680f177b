#pragma once

#include <cstddef>

namespace knotreel {

/// Asks for memory that will be read soon, so that it need not be waited for one line after the other. For
/// places that are known long before they are read, and that no hardware could foresee.
inline void prefetch(const void* from, std::size_t bytes) {
#if defined(__GNUC__)
  constexpr std::size_t kLine = 64;
  const char* p = static_cast<const char*>(from);
  for (std::size_t i = 0; i < bytes; i += kLine) __builtin_prefetch(p + i);
  __builtin_prefetch(p + bytes - 1);
#else
  (void)from;
  (void)bytes;
#endif
}

}  // namespace knotreel
