#include "vectorize/check_picture.h"

#include <algorithm>
#include <cmath>

#include "knotreel/base/error.h"

namespace knotreel::vectorize {

void check_picture(const image::Image& picture) {
  const auto refuse = [](const char* what) { throw Error(ErrorKind::kInvalidArgument, what); };
  if (picture.width < 1 || picture.height < 1) refuse("cannot vectorize a picture without pixels");
  const auto is_number = [](float sample) { return std::isfinite(sample); };
  if (!std::all_of(picture.samples.begin(), picture.samples.end(), is_number))
    refuse("cannot vectorize a picture with samples that are not finite");
}

}  // namespace knotreel::vectorize
