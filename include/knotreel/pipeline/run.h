// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/pipeline/job.h"

namespace knotreel::pipeline {

/// Runs a job with as many frames at once as threads and Job::frames_in_flight allow. Files appear when they
/// are whole; after an error nothing is left of them, but for those that were whole before another one failed
/// at the very end (a full disk).
/// @throws Error{the kind of its cause} with frame and stage in front of the message ("frame 12, encode: ").
/// The documents and the frames do not depend on the number of threads.
Summary run_graph(const Job& job);

/// The same, one frame and one stage after the other: the reference for tests.
Summary run_sequential(const Job& job);

}  // namespace knotreel::pipeline
