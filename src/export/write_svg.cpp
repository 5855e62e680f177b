#include "export/number_text.h"
#include "export/patch_stream.h"
#include "export/svg_paint.h"
#include "knotreel/export/svg.h"

namespace knotreel::exporting {

namespace {

class SvgWriter {
 public:
  SvgWriter(const document::FrameModel& model, const ExportOptions& options, OutputFile& file)
      : options_(options),
        model_(model),
        tessellator_(model, half(options.tessellation)),
        layers_(make_layers(tessellator_.sheets())),
        file_(file),
        budget_(options.max_triangles) {}

  ExportReport run() {
    const bool has_alpha = model_.channels == 2 || model_.channels == 4;
    const auto colours = static_cast<std::size_t>(model_.channels - (has_alpha ? 1 : 0));
    const auto& mesh = model_.space->mesh();
    const Turn& turn = options_.turn;
    const double width = turn.swaps_sides() ? mesh.height : mesh.width;
    const double height = turn.swaps_sides() ? mesh.width : mesh.height;
    // Strokes are none in any case, but ImageMagick draws black ones unless that is told.
    file_.write(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
        number_text(width * options_.scale, 3) + "\" height=\"" + number_text(height * options_.scale, 3) +
        "\" viewBox=\"0 0 " + number_text(width, 3) + ' ' + number_text(height, 3) + "\" stroke=\"none\">\n");
    if (!turn.is_none()) file_.write(turned_group(turn, turn.origin(width, height)));
    write_outlines();
    if (has_alpha) {
      file_.write(mask_start("alpha"));
      paint(colours, 1);
      file_.write("</mask>\n<g mask=\"url(#alpha)\">\n");
    }
    paint(0, colours);
    if (has_alpha) file_.write("</g>\n");
    if (!turn.is_none()) file_.write("</g>\n");
    file_.write("</svg>\n");
    return {layers_.size(), budget_.spent()};
  }

 private:
  static std::string turned_group(const Turn& turn, Vec2 origin) {
    std::string text = "<g transform=\"matrix(";
    for (const int v : {turn.right_x, turn.right_y, turn.down_x, turn.down_y})
      text += std::to_string(v) + ' ';
    return text + number_text(origin.x, 3) + ' ' + number_text(origin.y, 3) + ")\">\n";
  }

  /// Two approximations share the error: triangles with linear colours, and one direction for all channels.
  static TessellationOptions half(TessellationOptions options) {
    // What is out of range stays so, for Tessellator to refuse.
    if (options.colour_tolerance >= 0.02) options.colour_tolerance *= 0.5;
    return options;
  }

  /// The layers' outlines. As masks and not as clip paths: renderers apply a clip to each triangle, and where
  /// those overlap the edge of the clip would be painted twice and become jagged.
  void write_outlines() {
    for (std::size_t l = 1; l < layers_.size(); ++l) {
      if (options_.checkpoint) options_.checkpoint();
      std::string text = mask_start("l" + std::to_string(l)) + "<path fill=\"#fff\" d=\"";
      for (const Loop& loop : layer_outline(tessellator_, layers_[l])) append_loop(loop, text);
      file_.write(text + "\"/></mask>\n");
    }
  }

  std::string mask_start(const std::string& name) const {
    const auto& mesh = model_.space->mesh();
    return "<mask id=\"" + name + "\" maskUnits=\"userSpaceOnUse\" x=\"0\" y=\"0\" width=\"" +
           number_text(mesh.width, 3) + "\" height=\"" + number_text(mesh.height, 3) + "\">\n";
  }

  static void append_loop(const Loop& loop, std::string& text) {
    const auto append = [&](char command, std::initializer_list<Vec2> points) {
      text += command;
      for (const Vec2 p : points) {
        if (text.back() != command) text += ' ';
        append_number(text, p.x, 3);
        text += ' ';
        append_number(text, p.y, 3);
      }
    };
    append('M', {loop.front()[0]});
    for (const Curve& curve : loop) {
      if (curve[0] == curve[1] && curve[2] == curve[3]) {
        append('L', {curve[3]});
      } else {
        append('C', {curve[1], curve[2], curve[3]});
      }
    }
    text += 'z';
  }

  void paint(std::size_t first, std::size_t count) {
    SvgPainter painter(first, count, 0.5 * options_.tessellation.colour_tolerance, gradients_);
    std::string text;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      file_.write(l == 0 ? "<g>\n" : "<g mask=\"url(#l" + std::to_string(l) + ")\">\n");
      for_each_patch(tessellator_, layers_[l], options_, [&](const Patch& patch) {
        text.clear();
        budget_.spend(painter.paint(patch, text));
        file_.write(text);
      });
      file_.write("</g>\n");
    }
    gradients_ = painter.gradients();
  }

  const ExportOptions& options_;
  const document::FrameModel& model_;
  Tessellator tessellator_;
  std::vector<Layer> layers_;
  OutputFile& file_;
  TriangleBudget budget_;
  std::uint64_t gradients_ = 0;
};

}  // namespace

ExportReport write_svg(const document::FrameModel& model, const ExportOptions& options, OutputFile& file) {
  check_options(options);
  return SvgWriter(model, options, file).run();
}

}  // namespace knotreel::exporting
