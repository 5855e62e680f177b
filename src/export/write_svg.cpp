// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>

#include "export/divide_for_paints.h"
#include "export/number_text.h"
#include "export/outlines.h"
#include "export/regions.h"
#include "export/svg_text.h"
#include "export/triangulation.h"
#include "knotreel/export/svg.h"

namespace knotreel::exporting {

namespace {

// Under the regions each one's outline is drawn as a line of its paint, so that no paper shines through where
// antialiased edges meet. Half of its width covers what a pixel that the edge crosses has beyond it.
constexpr double kLineWidth = 1.2;
// Two approximations share the error that is allowed: triangles with linear colours, and one paint for many
// of them. Paints get more, since they are what takes room.
constexpr double kTriangleShare = 0.3;
// Levels times pixels. Finer tolerances do not make thinner strips visible, while slivers that share pixels
// cost more than what they are off by.
constexpr double kLeastHidden = 2;

class SvgWriter {
 public:
  SvgWriter(const document::FrameModel& model, const ExportOptions& options, OutputFile& file)
      : options_(options),
        model_(model),
        tessellator_(model, finer(options.tessellation)),
        triangles_(triangulate(tessellator_, options.max_triangles, options.checkpoint)),
        file_(file) {}

  ExportReport run() {
    const bool has_alpha = model_.channels == 2 || model_.channels == 4;
    const auto colours = static_cast<std::size_t>(model_.channels - (has_alpha ? 1 : 0));
    const auto& mesh = model_.space->mesh();
    const Turn& turn = options_.turn;
    const double width = turn.swaps_sides() ? mesh.height : mesh.width;
    const double height = turn.swaps_sides() ? mesh.width : mesh.height;
    // Strokes are none in any case, but ImageMagick draws black ones unless that is told.
    file_.write(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"" +
        number_text(width * options_.scale, 3) + "\" height=\"" + number_text(height * options_.scale, 3) +
        "\" viewBox=\"0 0 " + number_text(width, 3) + ' ' + number_text(height, 3) + "\" stroke=\"none\">\n");
    if (!turn.is_none()) file_.write(turned_group(turn, turn.origin(width, height)));
    divide_for_paints(triangles_, colours, paint_tolerance(), options_.max_triangles, options_.checkpoint);
    if (has_alpha) {
      file_.write(mask_start("alpha"));
      paint(colours, 1, "a");
      file_.write("</mask>\n<g mask=\"url(#alpha)\">\n");
    }
    paint(0, colours, "r");
    if (has_alpha) file_.write("</g>\n");
    if (!turn.is_none()) file_.write("</g>\n");
    file_.write("</svg>\n");
    return {paths_, triangles_.triangles.size()};
  }

 private:
  static std::string turned_group(const Turn& turn, Vec2 origin) {
    std::string text = "<g transform=\"matrix(";
    for (const int v : {turn.right_x, turn.right_y, turn.down_x, turn.down_y})
      text += std::to_string(v) + ' ';
    return text + number_text(origin.x, 3) + ' ' + number_text(origin.y, 3) + ")\">\n";
  }

  static TessellationOptions finer(TessellationOptions options) {
    options.colour_tolerance = std::max(0.01, kTriangleShare * options.colour_tolerance);
    options.geometry_tolerance = std::max(0.001, 0.5 * options.geometry_tolerance);
    return options;
  }

  double paint_tolerance() const { return (1 - kTriangleShare) * options_.tessellation.colour_tolerance; }

  std::string mask_start(const std::string& name) const {
    const auto& mesh = model_.space->mesh();
    return "<mask id=\"" + name + "\" maskUnits=\"userSpaceOnUse\" x=\"0\" y=\"0\" width=\"" +
           number_text(mesh.width, 3) + "\" height=\"" + number_text(mesh.height, 3) + "\">\n";
  }

  /// The picture of some channels. @param prefix  of the ids.
  void paint(std::size_t first, std::size_t count, const std::string& prefix) {
    RegionOptions wanted;
    wanted.first = first;
    wanted.count = count;
    wanted.colour_tolerance = paint_tolerance();
    wanted.hidden = std::max(kLeastHidden, options_.tessellation.colour_tolerance);
    wanted.checkpoint = options_.checkpoint;
    const Partition partition = merge_triangles(triangles_, wanted);
    if (partition.regions.empty()) return;
    const auto loops = outlines(
        tessellator_, triangles_, partition,
        {0.5 * options_.tessellation.geometry_tolerance, options_.tessellation.colour_tolerance, count});
    const std::vector<Shape> shapes = define_shapes(partition, loops, count, prefix);
    if (shapes.empty()) return;
    write_ground(colour_text(partition.regions[shapes.front().region].paint.colour, count));
    write_lines(shapes);
    for (const Shape& shape : shapes) {
      file_.write("<path id=\"" + shape.id + "\" fill=\"" + shape.fill + "\" d=\"" + shape.data + "\"/>\n");
    }
    paths_ += shapes.size();
  }

  struct Shape {
    std::uint32_t region;
    std::string id;
    std::string fill;
    std::string data;
  };

  /// Largest first. Writes the gradients.
  std::vector<Shape> define_shapes(const Partition& partition, const std::vector<std::vector<Loop>>& loops,
                                   std::size_t count, const std::string& prefix) {
    std::vector<std::uint32_t> order(partition.regions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return partition.regions[a].area > partition.regions[b].area;
    });
    std::vector<Shape> shapes;
    std::string gradients;
    for (const std::uint32_t r : order) {
      const Region& region = partition.regions[r];
      std::string data = path_data(loops[r]);
      if (data.empty()) continue;
      const std::string id = prefix + std::to_string(shapes.size());
      if (!region.flat) gradients += gradient_text(id + "g", region, count);
      shapes.push_back({r, id, region.flat ? colour_text(region.paint.colour, count) : "url(#" + id + "g)",
                        std::move(data)});
    }
    if (gradients.empty()) return shapes;
    file_.write("<defs>\n");
    if (!has_gradient_base_) file_.write(gradient_base());
    has_gradient_base_ = true;
    file_.write(gradients + "</defs>\n");
    return shapes;
  }

  /// Where a picture is shown so small that lines do not cover what shines through.
  void write_ground(const std::string& colour) {
    const auto& mesh = model_.space->mesh();
    file_.write("<rect width=\"" + number_text(mesh.width, 3) + "\" height=\"" + number_text(mesh.height, 3) +
                "\" fill=\"" + colour + "\"/>\n");
  }

  /// Where two regions meet, the line of the one that is filled first is to be on top: a pixel is then of
  /// that colour before the other one's share of it is painted.
  void write_lines(const std::vector<Shape>& shapes) {
    file_.write("<g stroke-width=\"" + number_text(kLineWidth, 2) + "\" stroke-linejoin=\"round\">\n");
    for (auto shape = shapes.rbegin(); shape != shapes.rend(); ++shape) {
      file_.write("<use xlink:href=\"#" + shape->id + "\" stroke=\"" + shape->fill + "\"/>\n");
    }
    file_.write("</g>\n");
  }

  const ExportOptions& options_;
  const document::FrameModel& model_;
  Tessellator tessellator_;
  Triangulation triangles_;
  OutputFile& file_;
  std::size_t paths_ = 0;
  bool has_gradient_base_ = false;
};

}  // namespace

ExportReport write_svg(const document::FrameModel& model, const ExportOptions& options, OutputFile& file) {
  check_options(options);
  return SvgWriter(model, options, file).run();
}

}  // namespace knotreel::exporting
