#include "motion/one_opencv_thread.h"

#include <mutex>
#include <opencv2/core/utility.hpp>

namespace knotreel::motion {
namespace {
std::mutex mutex;
int depth = 0;
int saved = 0;  // number of threads before
}  // namespace

OneOpenCvThread::OneOpenCvThread() {
  const std::lock_guard lock(mutex);
  if (depth++ > 0) return;
  saved = cv::getNumThreads();
  cv::setNumThreads(1);
}

OneOpenCvThread::~OneOpenCvThread() {
  const std::lock_guard lock(mutex);
  if (--depth == 0) cv::setNumThreads(saved);
}

}  // namespace knotreel::motion
