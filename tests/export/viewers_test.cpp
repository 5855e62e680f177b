#include <cstdlib>
#include "knotreel/image/write_image.h"
#include "support/models.h"
#include "viewer.h"

namespace knotreel::exporting {
namespace {
using namespace knotreel::testing;

TEST(Viewers, Table) {
  const char* dump = std::getenv("DUMP");
  for (const MeshCase& c : corpus_cases()) {
    if (c.name.ends_with("-mirrored") || c.name.ends_with("-turned")) continue;
    document::FrameModel model = blank_model(c.mesh, 2, 3);
    displace_randomly(model, c.name == "knots-squeezed-on-feature" ? 0 : 2, 7);
    colour_randomly(model, 7);
    for (const int scale : {1, 4}) {
      const image::Image ours = drawn_by_us(model, scale);
      if (dump)
        image::write_image(std::string(dump) + "/" + c.name + "-" + std::to_string(scale) + "-ours.png",
                           ours);
      for (const Viewer v : {Viewer::kPoppler, Viewer::kMupdf}) {
        const image::Image theirs = drawn_by(v, model, scale);
        if (dump)
          image::write_image(
              std::string(dump) + "/" + c.name + "-" + std::to_string(scale) + "-" + viewer_name(v) + ".png",
              theirs);
        const Differences d = compare(model, scale, theirs, ours);
        std::printf("%-30s %d %-8s off %.2f max %.0f  at %.2f max %.0f >32 %.4f\n", c.name.c_str(), scale,
                    viewer_name(v).c_str(), d.mean_off, d.max_off, d.mean_at, d.max_at, d.share_above_32);
      }
    }
  }
}
}  // namespace
}  // namespace knotreel::exporting
