// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "export/gouraud.h"
#include "export/number_text.h"
#include "export/patch_stream.h"
#include "export/pdf_file.h"
#include "knotreel/export/pdf.h"

namespace knotreel::exporting {

namespace {

/// Units on a side of a page, which programs need not go beyond.
constexpr double kMostUnits = 14'400;

/// Points per unit of the page. A power of two, by which numbers stay as short as they are.
int unit_of(const document::FrameModel& model, const ExportOptions& options) {
  const auto& mesh = model.space->mesh();
  const double longest = std::max(mesh.width, mesh.height) * options.scale;
  int unit = 1;
  while (longest > kMostUnits * unit) unit *= 2;
  return unit;
}

class PdfWriter {
 public:
  PdfWriter(const document::FrameModel& model, const ExportOptions& options, OutputFile& file)
      : options_(options),
        model_(model),
        tessellator_(model, options.tessellation),
        layers_(make_layers(tessellator_.sheets())),
        box_(image_box(model)),
        unit_(unit_of(model, options)),
        pdf_(file, unit_ > 1 ? "1.6" : "1.4"),
        budget_(options.max_triangles) {}

  ExportReport run() {
    const bool has_alpha = model_.channels == 2 || model_.channels == 4;
    const auto colours = static_cast<std::size_t>(model_.channels - (has_alpha ? 1 : 0));
    const int catalog = pdf_.reserve();
    const int pages = pdf_.reserve();
    const int page = pdf_.reserve();
    const int content = pdf_.reserve();
    const int info = pdf_.reserve();
    write_masks();

    Painting painting = paint(0, colours);
    if (has_alpha) painting = masked(painting, paint(colours, 1));
    const auto& mesh = model_.space->mesh();
    const Turn& turn = options_.turn;
    const double width = turn.swaps_sides() ? mesh.height : mesh.width;
    const double height = turn.swaps_sides() ? mesh.width : mesh.height;
    const double s = options_.scale / unit_;
    pdf_.write_object(catalog, "<</Type/Catalog/Pages " + reference(pages) + ">>");
    pdf_.write_object(pages, "<</Type/Pages/Count 1/Kids[" + reference(page) + "]>>");
    pdf_.write_object(page, "<</Type/Page/Parent " + reference(pages) + "/MediaBox[0 0 " +
                                number_text(width * s, 4) + ' ' + number_text(height * s, 4) + "]" +
                                user_unit() + "/Contents " + reference(content) + "/Resources<<" +
                                painting.resources + ">>/Group<</S/Transparency/CS/" + colour_space(colours) +
                                ">>>>");
    // From here on in pixels of the picture, y down.
    pdf_.begin_stream(content, "");
    pdf_.add_to_stream(number_text(s, 9) + " 0 0 " + number_text(-s, 9) + " 0 " + number_text(height * s, 4) +
                       " cm\n" + turn_operator(turn, turn.origin(width, height)) + painting.content);
    pdf_.end_stream();
    pdf_.write_object(info, "<</Producer(knotreel)>>");
    pdf_.finish(catalog, info);
    return {layers_.size(), budget_.spent()};
  }

 private:
  /// Operators, and the resources that they name.
  struct Painting {
    std::string content;
    std::string resources;
  };

  std::string user_unit() const { return unit_ > 1 ? "/UserUnit " + std::to_string(unit_) : ""; }

  static std::string turn_operator(const Turn& turn, Vec2 origin) {
    if (turn.is_none()) return {};
    std::string text;
    for (const int v : {turn.right_x, turn.right_y, turn.down_x, turn.down_y})
      text += std::to_string(v) + ' ';
    return text + number_text(origin.x, 4) + ' ' + number_text(origin.y, 4) + " cm\n";
  }

  static std::string colour_space(std::size_t channels) { return channels == 3 ? "DeviceRGB" : "DeviceGray"; }

  /// Entries of a form that is a transparency group.
  std::string group_entries(std::size_t channels, const std::string& resources) const {
    std::string text = "/Type/XObject/Subtype/Form/BBox[";
    for (const double v : {box_.low.x, box_.low.y, box_.high.x, box_.high.y}) {
      append_number(text, v, 6);
      text += ' ';
    }
    text.back() = ']';
    return text + "/Group<</S/Transparency/I true/CS/" + colour_space(channels) + ">>/Resources<<" +
           resources + ">>";
  }

  static std::string luminosity_of(int form) {
    return "<</Type/ExtGState/SMask<</S/Luminosity/G " + reference(form) + ">>>>";
  }

  /// Forms with the outlines of all layers but the first, in white.
  void write_masks() {
    for (std::size_t l = 1; l < layers_.size(); ++l) {
      if (options_.checkpoint) options_.checkpoint();
      masks_.push_back(pdf_.reserve());
      pdf_.begin_stream(masks_.back(), group_entries(1, ""));
      std::string text = "1 g\n";
      for (const Loop& loop : layer_outline(tessellator_, layers_[l])) append_loop(loop, text);
      pdf_.add_to_stream(text + "f\n");
      pdf_.end_stream();
    }
  }

  static void append_loop(const Loop& loop, std::string& text) {
    const auto append = [&](Vec2 p) {
      append_number(text, p.x, 4);
      text += ' ';
      append_number(text, p.y, 4);
      text += ' ';
    };
    append(loop.front()[0]);
    text += "m\n";
    for (const Curve& curve : loop) {
      const bool straight = curve[0] == curve[1] && curve[2] == curve[3];
      if (!straight) {
        append(curve[1]);
        append(curve[2]);
      }
      append(curve[3]);
      text += straight ? "l\n" : "c\n";
    }
    text += "h\n";
  }

  int write_shading(const Layer& layer, std::size_t first, std::size_t count) {
    const GouraudEncoder encoder(box_, first, count);
    const int number = pdf_.reserve();
    pdf_.begin_stream(number, encoder.entries());
    std::vector<std::byte> bytes;
    for_each_patch(tessellator_, layer, options_.checkpoint, budget_, [&](const Patch& patch) {
      bytes.clear();
      encoder.encode(patch, bytes);
      pdf_.add_to_stream(bytes);
    });
    pdf_.end_stream();
    return number;
  }

  /// All layers with some of the channels as colours: the first as it is, the others through their masks.
  Painting paint(std::size_t first, std::size_t count) {
    Painting painting;
    std::string forms;
    std::string states;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      const std::string name = std::to_string(l);
      const std::string shading = "/Shading<</S " + reference(write_shading(layers_[l], first, count)) + ">>";
      if (l == 0) {
        painting.content = "/S sh\n";
        painting.resources = shading;
        continue;
      }
      // In a group, so that the mask counts once; poppler would apply it to each triangle, and where those
      // overlap the edge would be jagged again.
      forms += "/P" + name + ' ' + reference(write_form({"/S sh\n", shading}, count));
      states += "/G" + name + luminosity_of(masks_[l - 1]);
      painting.content += "q /G" + name + " gs /P" + name + " Do Q\n";
    }
    painting.resources += "/XObject<<" + forms + ">>/ExtGState<<" + states + ">>";
    return painting;
  }

  /// `picture` with the grey painting `alpha` as its opacity.
  Painting masked(const Painting& picture, const Painting& alpha) {
    const int picture_form = write_form(picture, static_cast<std::size_t>(model_.channels) - 1);
    const int alpha_form = write_form(alpha, 1);
    return {"/A gs /P Do\n", "/ExtGState<</A" + luminosity_of(alpha_form) + ">>/XObject<</P " +
                                 reference(picture_form) + ">>"};
  }

  int write_form(const Painting& painting, std::size_t channels) {
    const int number = pdf_.reserve();
    pdf_.begin_stream(number, group_entries(channels, painting.resources));
    pdf_.add_to_stream(painting.content);
    pdf_.end_stream();
    return number;
  }

  const ExportOptions& options_;
  const document::FrameModel& model_;
  Tessellator tessellator_;
  std::vector<Layer> layers_;
  Box box_;
  int unit_;
  PdfFile pdf_;
  TriangleBudget budget_;
  std::vector<int> masks_;
};

}  // namespace

ExportReport write_pdf(const document::FrameModel& model, const ExportOptions& options, OutputFile& file) {
  check_options(options);
  return PdfWriter(model, options, file).run();
}

}  // namespace knotreel::exporting
