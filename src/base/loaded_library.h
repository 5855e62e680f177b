// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace knotreel {

/// A shared library that is loaded when it is needed, and stays until the process ends. What went wrong is
/// kept, not thrown. One thread at a time.
class LoadedLibrary {
 public:
  /// @param name  as the dynamic linker knows it, such as "libavfilter.so.8".
  explicit LoadedLibrary(const char* name);

  /// Looks up a function, whose type nobody checks; null if there is none.
  template <typename Function>
  void find(const char* symbol, Function*& function) {
    function = reinterpret_cast<Function*>(address_of(symbol));
  }

  /// What is missing, the library or one of its functions; empty if all was found.
  const std::string& why() const { return why_; }

 private:
  void* address_of(const char* symbol);

  std::string name_, why_;
  void* handle_;
};

}  // namespace knotreel
