// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/run.h"
#include "pipeline/stages.h"

namespace knotreel::pipeline {

Summary run_sequential(const Job& job) {
  Stages stages(job);
  while (const MessagePtr message = stages.decode()) {
    stages.analyse(*message);
    stages.plan(*message);
    stages.ahead(*message);
    stages.model(*message);
    stages.documents(*message);
    stages.rasterize(*message);
    stages.encode(*message);
  }
  return stages.finish();
}

}  // namespace knotreel::pipeline
