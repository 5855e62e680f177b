// SPDX-License-Identifier: GPL-3.0-or-later
#include "imgcodecs.h"

#include "base/loaded_library.h"

namespace knotreel::image {
namespace {

struct Loaded {
  Imgcodecs functions;
  std::string why;  ///< empty if all is there
};

Loaded load() {
  Loaded loaded;
  LoadedLibrary library(KNOTREEL_IMGCODECS);
  // cv::imdecode(InputArray, int) and cv::imencode(String, InputArray, vector<uchar>&, vector<int>); the
  // library has no functions with plain names.
  library.find("_ZN2cv8imdecodeERKNS_11_InputArrayEi", loaded.functions.decode);
  library.find(
      "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
      "RKNS_11_InputArrayERSt6vectorIhSaIhEERKSB_IiSaIiEE",
      loaded.functions.encode);
  loaded.why = library.why();
  return loaded;
}

}  // namespace

const Imgcodecs* imgcodecs(std::string& why) {
  static const Loaded loaded = load();
  why = loaded.why;
  return loaded.why.empty() ? &loaded.functions : nullptr;
}

}  // namespace knotreel::image
