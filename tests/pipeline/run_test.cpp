// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/run.h"

#include <gtest/gtest.h>

#include <functional>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/document/reader.h"
#include "knotreel/pipeline/render_job.h"
#include "knotreel/pipeline/sequence.h"
#include "pipeline/document_sink.h"
#include "pipeline/schedule.h"
#include "support/clips.h"
#include "support/drawn_scene.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::pipeline {
namespace {

constexpr int kFrames = 8;

/// A clip, and jobs that work on it.
class PipelineRun : public ::testing::Test {
 protected:
  PipelineRun() : times_(test::write_clip(clip_, kFrames)) {}

  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  Job job_of(video::VideoReader& reader) const {
    Job job;
    job.reader = &reader;
    job.source = "clip.mkv";
    job.cold = vectorize::video_options(vectorize::preset_options(vectorize::Preset::kFast));
    job.cold.feature_share = 0.6;  // the pictures are small
    job.cold.max_control_points = 120;
    return job;
  }

  /// The document that a run makes.
  std::string document_of(const std::function<Summary(const Job&)>& run, const std::string& name) const {
    video::VideoReader reader = video::VideoReader::open(clip_);
    Job job = job_of(reader);
    job.document = path(name);
    EXPECT_EQ(run(job).frames, std::uint64_t{kFrames});
    return test::read_text(job.document);
  }

  test::TempDir dir_;
  std::string clip_ = (dir_ / "clip.mkv").string();
  std::vector<std::int64_t> times_;
};

std::vector<image::Image> pictures(const std::string& path) {
  video::VideoReader reader = video::VideoReader::open(path);
  std::vector<image::Image> all;
  video::Frame frame;
  while (reader.next(frame)) all.push_back(std::move(frame.image));
  return all;
}

double mean_distance(const image::Image& a, const image::Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i)
    sum += std::abs(double(a.samples[i]) - double(b.samples[i]));
  return sum / double(a.samples.size());
}

TEST_F(PipelineRun, TheGraphMakesTheSameDocumentAsTheReference) {
  const std::string reference = document_of(run_sequential, "reference.tcb");
  ASSERT_FALSE(reference.empty());
  for (const int threads : {1, 2, 5}) {
    const ThreadCap cap(threads);
    EXPECT_TRUE(document_of(run_graph, "graph.tcb") == reference) << threads;
  }
}

TEST_F(PipelineRun, TheGraphMakesTheSameDocumentHoweverGroupsStart) {
  for (const track::TrackOptions& tracking :
       {track::TrackOptions{.warm_start = false}, track::TrackOptions{.keyframe_interval = 3},
        track::TrackOptions{.scene_threshold = 0}, track::TrackOptions{.drift = -100}}) {
    const auto with = [&](Summary (*run)(const Job&)) {
      return [&tracking, run](Job job) {
        job.cold.mec = 0;  // so that frames may drift
        job.tracking = tracking;
        return run(job);
      };
    };
    const std::string reference = document_of(with(run_sequential), "reference.tcb");
    EXPECT_TRUE(document_of(with(run_graph), "graph.tcb") == reference);
  }
}

TEST_F(PipelineRun, FramesThatStartAGroupAndNoOthersAreMadeAhead) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  Job job = job_of(reader);
  job.tracking.keyframe_interval = 3;
  std::vector<bool> ahead;
  job.on_frame = [&](const FrameRow& row) {
    bool cold = false;
    for (const auto& [stage, ms] : row.milliseconds) cold = cold || stage == "cold";
    EXPECT_EQ(cold, row.start != "warm") << row.index;
    ahead.push_back(cold);
  };
  run_graph(job);
  EXPECT_EQ(ahead, (std::vector{true, false, false, true, false, false, true, false}));
}

std::string write_lossless(const std::string& path, const std::vector<image::Image>& pictures) {
  video::StreamInfo info;
  info.width = pictures.front().width;
  info.height = pictures.front().height;
  info.time_base = {1, 25};
  info.frame_rate = {25, 1};
  video::WriteOptions lossless;
  lossless.codec = "ffv1";
  video::VideoWriter writer = video::VideoWriter::create(path, info, lossless);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    writer.write(pictures[i], static_cast<std::int64_t>(i), 1);
  writer.finish();
  return path;
}

TEST_F(PipelineRun, CurvesOfDrawnFramesAreFoundAhead) {
  clip_ = write_lossless(path("drawn.mkv"), test::drawn_clip(kFrames));
  std::size_t ahead = 0;
  const auto with = [&](Summary (*run)(const Job&)) {
    return [&ahead, run](Job job) {
      vectorize::Options options = vectorize::group_preset_options(vectorize::Preset::kBalanced);
      options.max_control_points = 1000;
      job.cold = vectorize::video_options(options);
      job.tracking.drawn =
          std::make_shared<const vectorize::Options>(vectorize::drawn_video_options(options));
      ahead = 0;
      job.on_frame = [&ahead](const FrameRow& row) {
        for (const auto& [stage, ms] : row.milliseconds) ahead += stage == "curves" ? 1 : 0;
      };
      return run(job);
    };
  };
  const std::string reference = document_of(with(run_sequential), "reference.tcb");
  EXPECT_EQ(ahead, kFrames - 1U) << "the first is a cold frame";
  EXPECT_TRUE(document_of(with(run_graph), "graph.tcb") == reference);
}

TEST_F(PipelineRun, OneFrameInFlightIsEnough) {
  const std::string reference = document_of(run_sequential, "reference.tcb");
  const auto narrow = [](Job job) {
    job.frames_in_flight = 1;
    return run_graph(job);
  };
  EXPECT_TRUE(document_of(narrow, "narrow.tcb") == reference);
}

TEST_F(PipelineRun, FramesKeepTheirNumberTimesAndOrder) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  Job job = job_of(reader);
  job.document = path("out.tcb");
  job.video.path = path("out.mkv");
  job.video.options.codec = "ffv1";
  job.video.width = 128;
  job.video.height = 96;
  std::vector<FrameRow> rows;
  job.on_frame = [&](const FrameRow& row) { rows.push_back(row); };
  const Summary summary = run_graph(job);
  EXPECT_EQ(summary.keyframes, 1u);
  EXPECT_GT(summary.psnr, 20);
  EXPECT_EQ(summary.document_bytes, test::read_text(job.document).size());
  ASSERT_EQ(rows.size(), times_.size());
  document::Reader document = document::Reader::open(job.document);
  ASSERT_EQ(document.frame_count(), times_.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].index, i);
    EXPECT_EQ(rows[i].pts, times_[i]);
    EXPECT_EQ(rows[i].start, i == 0 ? "first" : "warm");
    EXPECT_EQ(document.record(i).frame, i);
    EXPECT_EQ(document.record(i).pts, times_[i]);
    EXPECT_EQ(document.record(i).bytes, rows[i].bytes);
  }
  EXPECT_EQ(test::frame_times(job.video.path), times_);
}

TEST_F(PipelineRun, RepeatedFramesCostNextToNothing) {
  std::vector<image::Image> moving;
  for (int i = 0; i < 12; ++i) moving.push_back(test::moving_picture(64, 48, 3, i / 4));
  const std::string clip = write_lossless(path("repeats.mkv"), moving);
  video::WriteOptions lossless;
  lossless.codec = "ffv1";
  video::VideoReader reader = video::VideoReader::open(clip);
  Job job = job_of(reader);
  std::vector<FrameRow> rows;
  job.document = path("repeats.tcb");
  job.video.path = path("repeated.mkv");
  job.video.options = lossless;
  job.on_frame = [&](const FrameRow& row) { rows.push_back(row); };
  int composed = 0;
  job.beside = path("beside.mkv");
  job.compose = [&](const image::Image& picture, const document::FrameModel&) {
    ++composed;
    return picture;
  };
  run_sequential(job);
  ASSERT_EQ(rows.size(), 12U);
  EXPECT_EQ(composed, 3);
  const std::vector<image::Image> written = pictures(job.video.path);
  ASSERT_EQ(written.size(), rows.size());
  EXPECT_EQ(pictures(job.beside).size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i % 4 == 0) continue;
    EXPECT_EQ(rows[i].start, "warm");
    EXPECT_TRUE(rows[i].model_milliseconds.empty()) << "stages were run for frame " << i;
    EXPECT_EQ(rows[i].psnr, rows[i - 1].psnr) << i;
    EXPECT_EQ(rows[i].ssim, rows[i - 1].ssim) << i;
    EXPECT_EQ(rows[i].mec, rows[i - 1].mec) << i;
    EXPECT_EQ(rows[i].meg, rows[i - 1].meg) << i;
    EXPECT_LT(rows[i].bytes, rows[4].bytes / 2) << i;
    EXPECT_EQ(written[i].samples, written[i - 1].samples) << i;
  }

  // What was not drawn again is what its frame of the document looks like.
  document::Reader document = document::Reader::open(job.document);
  RenderJob back;
  back.reader = &document;
  back.video.path = path("back.mkv");
  back.video.options = lossless;
  run_render(back);
  const std::vector<image::Image> drawn = pictures(back.video.path);
  ASSERT_EQ(drawn.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_LT(mean_distance(drawn[i], written[i]), 0.01) << i;
    EXPECT_EQ(drawn[i].samples, drawn[i - i % 4].samples) << i;
  }
}

TEST_F(PipelineRun, ADocumentGivesTheVideoBack) {
  document_of(run_graph, "clip.tcb");
  document::Reader document = document::Reader::open(path("clip.tcb"));
  RenderJob job;
  job.reader = &document;
  job.video.path = path("back.mkv");
  EXPECT_EQ(run_render(job).frames, std::uint64_t{kFrames});
  EXPECT_EQ(test::frame_times(job.video.path), times_);

  job.video.path = path("part.mkv");
  job.first = 2;
  job.last = 4;
  EXPECT_EQ(run_render(job).frames, 3u);
  const std::int64_t begin = times_[2];
  EXPECT_EQ(test::frame_times(job.video.path),
            (std::vector{times_[2] - begin, times_[3] - begin, times_[4] - begin}));
}

/// Of the last frame, in seconds.
double last_duration_of(const std::string& video) {
  video::VideoReader reader = video::VideoReader::open(video);
  video::Frame frame;
  while (reader.next(frame)) continue;
  return double(frame.duration) * reader.info().time_base.value();
}

/// A video of frames that last so many milliseconds.
void write_lasting(const std::string& path, const std::vector<std::int64_t>& durations) {
  video::StreamInfo info;
  info.width = 64;
  info.height = 48;
  info.time_base = {1, 1000};
  info.frame_rate = {25, 1};
  video::VideoWriter writer = video::VideoWriter::create(path, info);
  std::int64_t time = 0;
  for (std::size_t i = 0; i < durations.size(); ++i) {
    writer.write(test::moving_picture(64, 48, 3, int(i)), time, durations[i]);
    time += durations[i];
  }
  writer.finish();
}

TEST_F(PipelineRun, TheLastFrameLastsAsLongAsInTheSource) {
  const std::string clip = path("odd.mkv");
  for (const std::int64_t last : {80, 3000, 40}) {
    write_lasting(clip, {40, 40, last});
    ASSERT_NEAR(last_duration_of(clip), double(last) / 1000, 1e-9);
    video::VideoReader reader = video::VideoReader::open(clip);
    Job job = job_of(reader);
    job.document = path("odd.tcb");
    run_graph(job);
    document::Reader document = document::Reader::open(job.document);
    RenderJob render;
    render.reader = &document;
    render.video.path = path("back.mkv");
    run_render(render);
    EXPECT_NEAR(last_duration_of(render.video.path), double(last) / 1000, 1e-9);
  }
}

/// The end of the source is not that of what has been made until then.
TEST_F(PipelineRun, TheLastFrameOfAnInterruptedRunLastsUntilTheNextOneOfTheSource) {
  const std::string clip = path("long.mkv");
  write_lasting(clip, {40, 40, 700, 40, 3000});
  video::VideoReader reader = video::VideoReader::open(clip);
  Job job = job_of(reader);
  job.document = path("part.tcb");
  int asked = 0;
  job.stop = [&] { return ++asked > 3; };
  EXPECT_EQ(run_sequential(job).frames, 3u);
  EXPECT_EQ(last_duration(document::Reader::open(job.document)), 700);
}

TEST_F(PipelineRun, AnotherRateMakesFramesInBetween) {
  document_of(run_graph, "clip.tcb");
  document::Reader document = document::Reader::open(path("clip.tcb"));
  RenderJob job;
  job.reader = &document;
  job.rate = {50, 1};
  job.video.path = path("fast.mkv");
  job.video.options.codec = "ffv1";
  // Eight frames last 10 x 40 ms.
  EXPECT_EQ(run_render(job).frames, 20u);
  const std::vector<image::Image> fast = pictures(job.video.path);
  job.rate = {};
  job.video.path = path("stored.mkv");
  run_render(job);
  const std::vector<image::Image> stored = pictures(job.video.path);
  const auto is_as_stored = [&](std::size_t i, std::size_t frame) {
    return test::largest_difference(fast[i], stored[frame]) <= 1;  // rounding looks at the frame before
  };
  EXPECT_TRUE(is_as_stored(0, 0));
  EXPECT_TRUE(is_as_stored(2, 1));
  EXPECT_TRUE(is_as_stored(8, 3)) << "the third frame lasts twice as long";
  // The disc moves by two pixels a frame. In between is where it would be, not a blend of both.
  const image::Image middle = test::moving_picture_at(64, 48, 3, 0.5);
  EXPECT_LT(mean_distance(fast[1], middle), 0.6 * mean_distance(stored[0], middle));
  EXPECT_LT(mean_distance(fast[1], middle), 0.6 * mean_distance(stored[1], middle));
  EXPECT_TRUE(is_as_stored(18, 7));
  EXPECT_TRUE(is_as_stored(19, 7)) << "nothing follows the last frame";
}

/// Two frames, a day and more apart for all that a document says.
TEST_F(PipelineRun, FramesOfAnotherRateAreNotKeptInMemory) {
  document_of(run_graph, "clip.tcb");
  document::Reader clip = document::Reader::open(path("clip.tcb"));
  document::SequenceInfo info = clip.info();
  info.time_base_num = 1;
  info.time_base_den = 1000;
  document::FrameModel frame = clip.read(0);
  {
    DocumentSink sink(path("far.tcb"), info);
    sink.append(frame);
    frame.pts = 4'000'000'000'000'000;
    sink.append(frame);
    sink.finish();
  }
  document::Reader far = document::Reader::open(path("far.tcb"));
  RenderJob job;
  job.reader = &far;
  job.rate = {60, 1};
  Schedule schedule(job);
  EXPECT_GE(schedule.end(), 240'000'000'000'000);
  for (std::int64_t k = 0; k < 3; ++k) {
    const std::optional<Showing> showing = schedule.next();
    ASSERT_TRUE(showing);
    EXPECT_EQ(showing->frame, 0u);
    EXPECT_EQ(showing->pts, k);
  }
  job.rate = {1000000, 1};
  EXPECT_THROW(Schedule{job}, Error);

  int frames = 0;
  job.rate = {60, 1};
  job.stop = [&] { return ++frames > 3; };
  job.video.path = path("far.mkv");
  job.video.options.codec = "ffv1";
  EXPECT_TRUE(run_render(job).stopped);
}

TEST_F(PipelineRun, NothingIsInBetweenAcrossTheStartOfAGroup) {
  const auto in_groups_of_two = [](Job job) {
    job.tracking.keyframe_interval = 2;
    return run_graph(job);
  };
  document_of(in_groups_of_two, "clip.tcb");
  document::Reader document = document::Reader::open(path("clip.tcb"));
  RenderJob job;
  job.reader = &document;
  job.rate = {100, 1};
  job.video.path = path("fast.mkv");
  job.video.options.codec = "ffv1";
  run_render(job);
  const std::vector<image::Image> fast = pictures(job.video.path);
  for (const std::size_t k : {5U, 6U, 7U}) EXPECT_EQ(fast[k].samples, fast[4].samples) << k;
  EXPECT_NE(fast[1].samples, fast[0].samples);
  EXPECT_NE(fast[8].samples, fast[4].samples);
}

TEST_F(PipelineRun, AFullDiskIsToldWithFrameAndStage) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  Job job = job_of(reader);
  job.video.path = "/dev/full";
  job.video.options.container = "rawvideo";
  job.video.options.codec = "rawvideo";
  try {
    run_graph(job);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kOutput);
    EXPECT_NE(std::string(e.what()).find("/dev/full"), std::string::npos) << e.what();
  }
}

TEST_F(PipelineRun, AnErrorOfTheCallerEndsTheRunAndLeavesNoFile) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  Job job = job_of(reader);
  job.document = path("out.tcb");
  job.video.path = path("out.mkv");
  job.on_frame = [](const FrameRow& row) {
    if (row.index == 3) throw Error(ErrorKind::kOutput, "no more");
  };
  try {
    run_graph(job);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kOutput);
    EXPECT_EQ(e.what(), std::string("frame 3, report: no more"));
  }
  EXPECT_EQ(dir_.entries(), 1u);
}

TEST_F(PipelineRun, AfterAStopTheFilesHoldTheFramesDone) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  Job job = job_of(reader);
  job.document = path("out.tcb");
  job.video.path = path("out.mkv");
  int asked = 0;
  job.stop = [&] { return ++asked > 3; };
  const Summary summary = run_graph(job);
  EXPECT_TRUE(summary.stopped);
  EXPECT_EQ(summary.frames, 3u);
  EXPECT_EQ(test::frame_times(job.video.path).size(), 3u);
  const document::Reader document = document::Reader::open(job.document);
  EXPECT_TRUE(document.complete());
  EXPECT_EQ(document.frame_count(), 3u);
}

TEST_F(PipelineRun, SplitDocumentsStandAlone) {
  video::VideoReader reader = video::VideoReader::open(clip_);
  Job job = job_of(reader);
  job.split_folder = path("split");
  run_graph(job);
  for (int i = 1; i <= kFrames; ++i) {
    document::Reader document =
        document::Reader::open(path("split/frame_00000" + std::to_string(i) + ".tcb"));
    EXPECT_EQ(document.frame_count(), 1u);
    EXPECT_EQ(document.read(0).pts, times_[std::size_t(i) - 1]);
  }
}

TEST_F(PipelineRun, JobsWithoutAReaderAreRefused) {
  EXPECT_THROW(run_graph({}), Error);
  EXPECT_THROW(run_sequential({}), Error);
  EXPECT_THROW(run_render({}), Error);
  EXPECT_THROW(frame_count({}), Error);
}

}  // namespace
}  // namespace knotreel::pipeline
