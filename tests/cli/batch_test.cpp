// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "cli/batch/manifest.h"
#include "knotreel/base/error.h"
#include "program.h"
#include "support/clips.h"

namespace knotreel {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::TempDir;
using test::write_text;

/// A folder `in` of small pictures, and a place for the documents.
struct Lot {
  TempDir dir;
  std::string in = (dir / "in").string();
  std::string out = (dir / "out").string();

  explicit Lot(const std::vector<std::string>& names) {
    for (const std::string& name : names) add(name, 24 + int(3 * name.size()));
  }

  void add(const std::string& name, int width) const {
    fs::create_directories(fs::path(in_file(name)).parent_path());
    image::write_image(in_file(name), test::sharp_picture(width, 20, 3));
  }
  std::string in_file(const std::string& name) const { return in + "/" + name; }
  std::string out_file(const std::string& name) const { return out + "/" + name; }

  test::ProcessResult run(std::vector<std::string> more = {},
                          const test::ProcessOptions& options = {}) const {
    more.insert(more.begin(), {"batch", in, "-o", out, "--preset", "fast"});
    return test::knotreel(more, options);
  }

  std::vector<json> lines() const {
    std::vector<json> all;
    std::istringstream text(read_text(out_file("manifest.jsonl")));
    for (std::string line; std::getline(text, line);) all.push_back(json::parse(line));
    return all;
  }

  /// Status by name of the output, of the last `count` lines.
  std::map<std::string, std::string> last(std::size_t count) const {
    std::map<std::string, std::string> result;
    const auto all = lines();
    for (std::size_t i = all.size() - count; i < all.size(); ++i) {
      result[fs::path(all[i]["output"].get<std::string>()).filename()] = all[i]["status"];
    }
    return result;
  }
};

using Status = std::map<std::string, std::string>;

TEST(CliBatch, AFolderInNaturalOrder) {
  const Lot lot({"p10.png", "p9.png", "p1.png", ".hidden.png", "sub/q.png"});
  write_text(lot.in_file("notes.txt"), "no picture");
  const auto result = lot.run({"--jobs", "1", "-v"});
  expect_success(result);
  EXPECT_NE(result.out.find("3 items: 3 done, 0 failed, 0 skipped"), std::string::npos) << result.out;
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 4);
  const auto lines = lot.lines();
  ASSERT_EQ(lines.size(), 3u);
  const std::vector<std::string> order{"p1", "p9", "p10"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(lines[i]["input"], lot.in_file(order[i] + ".png"));
    EXPECT_EQ(lines[i]["output"], lot.out_file(order[i] + ".tcb"));
    EXPECT_EQ(lines[i]["status"], "done");
    EXPECT_TRUE(lines[i]["error"].is_null());
    EXPECT_GT(lines[i]["knots"], 3);
    EXPECT_GT(lines[i]["control_points"], 3);
    EXPECT_GT(lines[i]["psnr"], 20);
    EXPECT_EQ(lines[i]["file_bytes"], fs::file_size(lot.out_file(order[i] + ".tcb")));
    EXPECT_EQ(lines[i]["input_size"], fs::file_size(lot.in_file(order[i] + ".png")));
    EXPECT_GT(lines[i]["input_mtime"], 0);
  }
}

TEST(CliBatch, OptionsOfEncodersAreForTranscode) {
  const Lot lot({"a.png"});
  const std::vector<std::vector<std::string>> cases{
      {"--codec", "h264"},          {"--crf", "20"},
      {"--encoder-preset", "slow"}, {"--pixel-format", "yuv420p"},
      {"--encoder-option", "g=50"}, {"--container-option", "movflags=faststart"}};
  for (const std::vector<std::string>& options : cases) {
    const auto result = lot.run(options);
    expect_failure(result, 2);
    EXPECT_NE(result.err.find(options[0] + " is for --transcode"), std::string::npos) << result.err;
  }
  EXPECT_FALSE(fs::exists(lot.out));
}

TEST(CliBatch, LinksThatLeadNowhereAreTold) {
  const Lot lot({"a.png", "sub/b.png"});
  fs::create_symlink("gone.png", lot.in_file("dangling.png"));
  fs::create_symlink("loop.png", lot.in_file("loop.png"));
  fs::create_symlink("gone.txt", lot.in_file("notes.txt"));
  fs::create_symlink("sub", lot.in_file("folder.png"));
  fs::create_symlink("a.png", lot.in_file("link.png"));
  const auto result = lot.run();
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_NE(result.err.find("dangling.png"), std::string::npos) << result.err;
  EXPECT_EQ(lot.lines().size(), 4u);
  EXPECT_EQ(
      lot.last(4),
      (Status{{"a.tcb", "done"}, {"dangling.tcb", "failed"}, {"link.tcb", "done"}, {"loop.tcb", "failed"}}));
}

/// A manifest whose last line a kill has cut is completed first, which a limit on the size of files hinders.
TEST(Manifest, ThatCannotGoOnIsClosed) {
  const TempDir dir;
  write_text(dir / "m.jsonl", "{\"input\": ");
  const auto open_files = [] {
    return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
  };
  const auto before = open_files();
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{fs::file_size(dir / "m.jsonl"), limit.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(cli::batch::Manifest((dir / "m.jsonl").string(), true), Error);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(open_files(), before);
}

TEST(CliBatch, TheBytesOfVectorizeForAnyNumberOfJobs) {
  const Lot lot({"a.png", "bb.png", "ccc.png", "sub/a.png"});
  std::map<std::string, std::string> expected;
  for (const std::string name : {"a", "bb", "ccc", "sub/a"}) {
    const std::string alone = (lot.dir / "alone.tcb").string();
    expect_success(
        test::knotreel({"vectorize", lot.in_file(name + ".png"), "-o", alone, "--preset", "fast"}));
    expected[name] = read_text(alone);
  }
  const std::vector<std::vector<std::string>> ways{{"--jobs", "1", "--threads", "1"},
                                                   {"--jobs", "4", "--threads", "4"},
                                                   {"--jobs", "3", "--threads", "7"},
                                                   {"--jobs", "3", "--alone-above", "0"}};
  for (auto way : ways) {
    SCOPED_TRACE(testing::PrintToString(way));
    fs::remove_all(lot.out);
    way.emplace_back("--recursive");
    expect_success(lot.run(way));
    for (const auto& [name, bytes] : expected) EXPECT_TRUE(read_text(lot.out_file(name + ".tcb")) == bytes);
  }
}

TEST(CliBatch, AListFromAFileOrStandardInput) {
  const Lot lot({"b.png", "a.png", "c.png"});
  const std::string list = lot.in_file("b.png") + "\n\n" + lot.in_file("a.png") + "\r\n" +
                           lot.in_file("b.png") + "\n" + lot.in_file("./a.png");
  write_text(lot.dir / "list.txt", list);
  const std::vector<std::string> options{"-o", lot.out, "--preset", "fast", "--jobs", "1"};
  for (const std::string& from : {(lot.dir / "list.txt").string(), std::string("-")}) {
    std::vector<std::string> command{"batch", from};
    command.insert(command.end(), options.begin(), options.end());
    expect_success(test::knotreel(command, {.input = from == "-" ? list : ""}));
    const auto lines = lot.lines();
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(lines[0]["input"], lot.in_file("b.png"));
    EXPECT_EQ(lines[1]["input"], lot.in_file("a.png"));
  }
}

TEST(CliBatch, AListOfAnEditorThatMarksTheOrderOfBytes) {
  const Lot lot({"a.png"});
  write_text(lot.dir / "list.txt", "\xef\xbb\xbf" + lot.in_file("a.png") + "\n");
  expect_success(test::knotreel({"batch", (lot.dir / "list.txt").string(), "-o", lot.out}));
}

TEST(CliBatch, TheManifestMayGoToStandardOutput) {
  const Lot lot({"a.png", "b.png"});
  const auto result = lot.run({"--manifest", "-", "-v"});
  expect_success(result);
  std::istringstream text(result.out);
  std::size_t lines = 0;
  for (std::string line; std::getline(text, line); ++lines) EXPECT_EQ(json::parse(line)["status"], "done");
  EXPECT_EQ(lines, 2u);
  EXPECT_FALSE(fs::exists(lot.out_file("manifest.jsonl")));
  expect_failure(lot.run({"--manifest", "-", "--resume"}), 2);
}

TEST(CliBatch, InputsOfOneNameKeepTheirExtensions) {
  const Lot lot({"a.png", "b.png"});
  image::write_image(lot.in_file("a.ppm"), test::smooth_picture(20, 20, 3));
  expect_success(lot.run());
  EXPECT_EQ(lot.last(3), (Status{{"a.png.tcb", "done"}, {"a.ppm.tcb", "done"}, {"b.tcb", "done"}}));
}

TEST(CliBatch, ABadInputDoesNotStopTheOthers) {
  const Lot lot({"a.png", "c.png"});
  write_text(lot.in_file("b.png"), read_text(lot.in_file("a.png")).substr(0, 60));
  const auto result = lot.run();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
  EXPECT_NE(result.err.find("knotreel: cannot read image"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("3 items: 2 done, 1 failed"), std::string::npos) << result.out;
  EXPECT_EQ(lot.last(3), (Status{{"a.tcb", "done"}, {"b.tcb", "failed"}, {"c.tcb", "done"}}));
  EXPECT_FALSE(fs::exists(lot.out_file("b.tcb")));
  // Once it is mended, only it is done.
  lot.add("b.png", 30);
  expect_success(lot.run({"--resume"}));
  EXPECT_EQ(lot.last(3), (Status{{"a.tcb", "skipped"}, {"b.tcb", "done"}, {"c.tcb", "skipped"}}));
}

TEST(CliBatch, ResumeDoesWhatIsMissingChangedOrDamaged) {
  const Lot lot({"a.png", "b.png", "c.png", "d.png"});
  expect_success(lot.run());
  const auto times = [&] {
    std::vector<fs::file_time_type> all;
    for (const std::string name : {"a", "b", "c", "d"})
      all.push_back(fs::last_write_time(lot.out_file(name + ".tcb")));
    return all;
  };
  const auto before = times();
  expect_success(lot.run({"--resume"}));
  EXPECT_EQ(times(), before);
  EXPECT_EQ(lot.lines().size(), 8u);

  lot.add("b.png", 40);
  std::string bytes = read_text(lot.out_file("c.tcb"));
  bytes[bytes.size() / 2] = char(bytes[bytes.size() / 2] ^ 4);
  write_text(lot.out_file("c.tcb"), bytes);
  fs::remove(lot.out_file("d.tcb"));
  // As a kill may leave it.
  std::ofstream(lot.out_file("manifest.jsonl"), std::ios::app) << R"({"input": "half)";
  expect_success(lot.run({"--resume"}));
  const std::string manifest = read_text(lot.out_file("manifest.jsonl"));
  EXPECT_EQ(std::count(manifest.begin(), manifest.end(), '\n'), 13);
  EXPECT_EQ(times()[0], before[0]);
  for (const std::string name : {"b", "c", "d"}) {
    const std::string from = "\"output\":\"" + lot.out_file(name + ".tcb") + "\",\"status\":\"done\"";
    EXPECT_NE(manifest.find(from, manifest.find("half")), std::string::npos) << name;
  }
}

TEST(CliBatch, UnwritableFoldersAndOutputsAreExit4) {
  const Lot lot({"a.png", "b.png"});
  write_text(lot.dir / "file", "");
  for (const std::string& out : {std::string("/proc/out"), (lot.dir / "file").string()}) {
    expect_failure(test::knotreel({"batch", lot.in, "-o", out}), 4);
  }
  fs::create_directories(lot.out_file("a.tcb"));
  EXPECT_EQ(lot.run().exit_code, 4);
  EXPECT_EQ(lot.last(2), (Status{{"a.tcb", "failed"}, {"b.tcb", "done"}}));
  EXPECT_EQ(lot.run({"--manifest", lot.out}).exit_code, 4);
}

TEST(CliBatch, NothingToDoIsExit3AndWrongOptionsExit2) {
  const Lot lot({"a.png"});
  const TempDir empty;
  expect_failure(test::knotreel({"batch", empty.path().string(), "-o", lot.out}), 3);
  expect_failure(test::knotreel({"batch", (empty / "missing").string(), "-o", lot.out}), 3);
  for (const std::string name : {"a.png", "a.mp4", "a.txt"}) {
    if (name != "a.png") write_text(lot.in_file(name), std::string("\0\0", 2) + name);
    expect_failure(test::knotreel({"batch", lot.in_file(name), "-o", lot.out}), 3);
  }
  expect_failure(lot.run({"--max-control-points", "x"}), 2);
  EXPECT_FALSE(fs::exists(lot.out));
}

TEST(CliBatch, AnInterruptionLeavesWholeFilesOnly) {
  const Lot lot({"a.png"});
  fs::create_directories(lot.out);
  image::write_image(lot.in_file("b.png"), test::sharp_picture(900, 700, 3));
  image::write_image(lot.in_file("c.png"), test::sharp_picture(900, 700, 3));
  const auto result = lot.run({"--jobs", "1"}, {.signal_once = lot.out_file("b.tcb"), .signal = SIGINT});
  expect_failure(result, 130);
  EXPECT_EQ(lot.last(1), (Status{{"a.tcb", "done"}}));
  EXPECT_EQ(lot.lines().size(), 1u);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(lot.out)) ++files;
  EXPECT_EQ(files, 2u) << "the document of a.png and the manifest";
}

TEST(CliBatch, ClipsBecomeDocumentsBesidePictures) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "in");
  test::write_clip((dir / "in/clip.mkv").string(), 4);
  image::write_image(dir / "in/photo.png", test::sharp_picture(48, 32, 3));
  test::write_text(dir / "in/notes.txt", "not for us");
  const std::string in = (dir / "in").string();
  const std::string out = (dir / "out").string();
  expect_success(test::knotreel({"batch", in, "-o", out, "--preset", "fast", "--jobs", "2"}));
  const std::string alone = (dir / "alone.tcb").string();
  for (const std::string name : {"clip.mkv", "photo.png"}) {
    expect_success(test::knotreel({"vectorize", in + "/" + name, "-o", alone, "--preset", "fast"}));
    EXPECT_TRUE(read_text(out + "/" + name.substr(0, name.find('.')) + ".tcb") == read_text(alone)) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(out + "/notes.tcb"));
  EXPECT_NE(read_text(out + "/manifest.jsonl").find("\"frames\":4"), std::string::npos);
}

TEST(CliBatch, ClipsBecomeVideosAndResumeSkipsThem) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "in");
  const std::vector<std::int64_t> times = test::write_clip((dir / "in/clip.mkv").string(), 4);
  test::write_text(dir / "in/bad.mp4", "no video");
  image::write_image(dir / "in/photo.png", test::sharp_picture(48, 32, 3));
  const std::string out = (dir / "out").string();
  const std::vector<std::string> command{"batch", (dir / "in").string(), "-o", out, "--preset",
                                         "fast",  "--transcode"};
  EXPECT_EQ(test::knotreel(command).exit_code, 3) << "one of two cannot be read";
  EXPECT_EQ(test::frame_times(out + "/clip.mp4"), times);
  EXPECT_FALSE(std::filesystem::exists(out + "/bad.mp4"));
  EXPECT_FALSE(std::filesystem::exists(out + "/photo.mp4"));
  std::vector<std::string> again = command;
  again.push_back("--resume");
  EXPECT_EQ(test::knotreel(again).exit_code, 3);
  EXPECT_NE(read_text(out + "/manifest.jsonl").find("skipped"), std::string::npos);
}

/// A picture that changes does not change its folder, and a pattern is no file.
TEST(CliBatch, ResumeLooksAtThePicturesOfFoldersAndPatterns) {
  const TempDir dir;
  const auto write = [&](const std::string& name, int frame) {
    image::write_image(dir / name, test::moving_picture(48, 32, 3, frame));
  };
  std::filesystem::create_directory(dir / "shot");
  for (int i = 0; i < 2; ++i) {
    write("shot/p" + std::to_string(i) + ".png", i);
    write("other_" + std::to_string(i) + ".png", i);
  }
  const std::string shot = (dir / "shot").string(), other = (dir / "other_%d.png").string();
  test::write_text(dir / "list", shot + "\n" + other + "\n");
  const auto statuses = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command{
        "batch", (dir / "list").string(), "-o", (dir / "out").string(), "--preset", "fast", "-q"};
    command.insert(command.end(), more.begin(), more.end());
    expect_success(test::knotreel(command));
    std::istringstream lines(read_text(dir / "out/manifest.jsonl"));
    std::map<std::string, std::string> last;
    for (std::string line; std::getline(lines, line);) {
      const json entry = json::parse(line);
      EXPECT_EQ(entry.value("input_files", 0), entry["frames"]);
      last[entry["input"]] = entry["status"];
    }
    return last;
  };
  using Statuses = std::map<std::string, std::string>;
  EXPECT_EQ(statuses({}), (Statuses{{shot, "done"}, {other, "done"}}));
  EXPECT_EQ(statuses({"--resume"}), (Statuses{{shot, "skipped"}, {other, "skipped"}}));
  write("shot/p1.png", 5);
  EXPECT_EQ(statuses({"--resume"}), (Statuses{{shot, "done"}, {other, "skipped"}}));
  write("other_2.png", 2);
  EXPECT_EQ(statuses({"--resume"}), (Statuses{{shot, "skipped"}, {other, "done"}}));
}

/// The name of a clip is no pattern, though that of its video would be one.
TEST(CliBatch, ClipsMayHaveNumberPatternsAsNames) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "in");
  const auto times = test::write_clip((dir / "in/clip.mkv").string(), 3);
  std::filesystem::copy_file(dir / "in/clip.mkv", dir / "in/a%03d.mkv");
  std::filesystem::rename(dir / "in/clip.mkv", dir / "in/100%done_%d.mkv");
  expect_success(test::knotreel({"batch", (dir / "in").string(), "-o", (dir / "out").string(), "--preset",
                                 "fast", "--transcode", "-q", "--pixel-format", "yuv420p"}));
  EXPECT_EQ(test::frame_times((dir / "out/a%03d.mp4").string()), times);
  EXPECT_EQ(test::frame_times((dir / "out/100%done_%d.mp4").string()), times);
}

TEST(CliBatch, APartBehindTheEndOfAClipIsToldOf) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "in");
  test::write_clip((dir / "in/clip.mkv").string(), 4);
  const auto made = test::knotreel(
      {"batch", (dir / "in").string(), "-o", (dir / "out").string(), "--preset", "fast", "--frames", "2-9"});
  EXPECT_EQ(made.exit_code, 0);
  EXPECT_NE(made.err.find("clip.mkv': --frames 2-9: the video ends after 2 of these 8 frames"),
            std::string::npos)
      << made.err;
}

/// The first file that is opened would get the number of standard output.
TEST(Batch, AClosedStandardOutputIsNotTheManifest) {
  const test::TempDir dir;
  std::filesystem::create_directory(dir / "in");
  image::write_image(dir / "in/a.png", test::smooth_picture(32, 20, 3));
  const std::string command =
      "cd '" + dir.path().string() + "' && exec '" + KNOTREEL_PROGRAM + "' batch in -o out >&-";
  EXPECT_NE(test::run({"/bin/sh", "-c", command}).exit_code, 0);
  std::istringstream manifest(test::read_text(dir / "out" / "manifest.jsonl"));
  int lines = 0;
  for (std::string line; std::getline(manifest, line); ++lines)
    EXPECT_TRUE(nlohmann::json::accept(line)) << line;
  EXPECT_EQ(lines, 1);
}

}  // namespace
}  // namespace knotreel
