// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the seeds in tests/fuzz/corpus: make_fuzz_corpus DIRECTORY (scripts/fuzz --make-corpus calls it).

#include <filesystem>
#include <fstream>
#include <iostream>

#include "document/document_file.h"
#include "document/sample_models.h"
#include "support/mesh_cases.h"

namespace {

using namespace knotreel;
using document::FrameModel;

void save(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

mesh::KnotMesh tiny_mesh(int segments, std::uint64_t seed) {
  return testing::random_mesh(64, 48, 10, segments, seed);
}

std::vector<FrameModel> frames(int degree, int channels, int segments, std::uint64_t seed) {
  std::vector<FrameModel> result{testing::random_model(tiny_mesh(segments, seed), degree, channels, seed)};
  result.push_back(testing::successor(result.back(), 2, seed));
  result.push_back(testing::successor(result.back(), 0, seed));
  return result;
}

/// The input of fuzz_frame for frames `at` and `at` + 1 of a document.
std::vector<std::byte> frame_pair(const std::vector<std::byte>& bytes, std::size_t at, int degree,
                                  int channels) {
  document::DocumentFile file(document::open_memory(bytes, "seed"), true);
  const auto payload = [&](std::size_t f) {
    const auto& r = file.records()[f];
    const std::size_t head = document::kChunkHeaderBytes;
    return std::span(bytes).subspan(r.offset + head, r.bytes - head);
  };
  const auto first = payload(at);
  const auto second = payload(at + 1);
  std::vector<std::byte> out{static_cast<std::byte>(degree - 1 + 3 * (channels - 1)),
                             static_cast<std::byte>(first.size()), static_cast<std::byte>(first.size() >> 8)};
  out.insert(out.end(), first.begin(), first.end());
  out.insert(out.end(), second.begin(), second.end());
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_fuzz_corpus DIRECTORY\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  for (int degree = 1; degree <= 3; ++degree) {
    for (int segments = 0; segments <= 2; ++segments) {
      const int channels = 1 + (degree + segments) % 4;
      const auto seed = static_cast<std::uint64_t>(10 * degree + segments);
      const auto bytes = testing::write_document(frames(degree, channels, segments, seed));
      const std::string name = "degree" + std::to_string(degree) + "-segments" + std::to_string(segments);
      save(folder / "fuzz_document" / name, bytes);
      save(folder / "fuzz_frame" / name, frame_pair(bytes, 0, degree, channels));
    }
  }
  return 0;
}
