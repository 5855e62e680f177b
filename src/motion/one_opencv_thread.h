#pragma once

namespace knotreel::motion {

/// Keeps OpenCV to one thread in the whole process while any such object lives, and puts its number of
/// threads back with the last one. Flow depends on that number: patches learn from neighbours in their own
/// stripe only, and there is a stripe per thread. May be made and destroyed on several threads at once.
class OneOpenCvThread {
 public:
  OneOpenCvThread();
  ~OneOpenCvThread();
  OneOpenCvThread(const OneOpenCvThread&) = delete;
  OneOpenCvThread& operator=(const OneOpenCvThread&) = delete;
};

}  // namespace knotreel::motion
