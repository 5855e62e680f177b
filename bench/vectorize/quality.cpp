// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <functional>
#include <map>

#include "knotreel/base/error.h"
#include "knotreel/image/read_image.h"
#include "vectorize/tables.h"

/// vectorize_quality TABLE PICTURE...: prints one of the tables of docs/benchmarks.md.
int main(int argc, char** argv) {
  using namespace knotreel;
  const std::map<std::string, std::function<void(const std::vector<bench::Picture>&)>> tables{
      {"curves", bench::print_curves},
      {"presets", bench::print_presets},
      {"ablation", bench::print_ablation},
      {"stages", bench::print_stages},
      {"scaling", bench::print_scaling}};
  const auto table = tables.find(argc > 1 ? argv[1] : "");
  if (table == tables.end() || argc < 3) {
    fmt::print(stderr, "usage: vectorize_quality curves|presets|ablation|stages|scaling PICTURE...\n");
    return 2;
  }
  try {
    std::vector<bench::Picture> pictures;
    for (int i = 2; i < argc; ++i) {
      pictures.push_back({std::filesystem::path(argv[i]).stem().string(), image::read_image(argv[i])});
    }
    table->second(pictures);
  } catch (const Error& e) {
    fmt::print(stderr, "vectorize_quality: {}\n", e.what());
    return 1;
  }
  return 0;
}
