// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/loaded_library.h"

#include <dlfcn.h>

namespace knotreel {

LoadedLibrary::LoadedLibrary(const char* name) : name_(name), handle_(::dlopen(name, RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ != nullptr) return;
  const char* error = ::dlerror();
  why_ = error == nullptr ? "cannot load " + name_ : error;
}

void* LoadedLibrary::address_of(const char* symbol) {
  if (handle_ == nullptr) return nullptr;
  void* address = ::dlsym(handle_, symbol);
  if (address == nullptr) why_ = std::string("no ") + symbol + " in " + name_;
  return address;
}

}  // namespace knotreel
