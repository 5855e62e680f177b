#include "imgcodecs.h"

#include <dlfcn.h>

namespace knotreel::image {
namespace {

struct Loaded {
  Imgcodecs functions;
  std::string why;  ///< empty if all is there
};

template <typename Function>
void find(void* library, const char* name, Function& function, std::string& why) {
  function = reinterpret_cast<Function>(::dlsym(library, name));
  if (function == nullptr) why = std::string("no ") + name + " in " KNOTREEL_IMGCODECS;
}

Loaded load() {
  Loaded loaded;
  void* library = ::dlopen(KNOTREEL_IMGCODECS, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* error = ::dlerror();
    loaded.why = error == nullptr ? "cannot load " KNOTREEL_IMGCODECS : error;
    return loaded;
  }
  // cv::imdecode(InputArray, int) and cv::imencode(String, InputArray, vector<uchar>&, vector<int>); the
  // library has no functions with plain names.
  find(library, "_ZN2cv8imdecodeERKNS_11_InputArrayEi", loaded.functions.decode, loaded.why);
  find(library,
       "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
       "RKNS_11_InputArrayERSt6vectorIhSaIhEERKSB_IiSaIiEE",
       loaded.functions.encode, loaded.why);
  return loaded;
}

}  // namespace

const Imgcodecs* imgcodecs(std::string& why) {
  static const Loaded loaded = load();
  why = loaded.why;
  return loaded.why.empty() ? &loaded.functions : nullptr;
}

}  // namespace knotreel::image
