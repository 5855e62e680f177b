// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>

namespace knotreel::features {

/// What sharpen_corners() has found out about pictures, so that it need not find it again where they stay as
/// they are, bit for bit: it takes most of its time. Results are the same with it and without. What was not
/// asked for in the last few calls is forgotten. Safe to use from several threads.
class KnownCorners {
 public:
  KnownCorners();
  ~KnownCorners();
  KnownCorners(const KnownCorners&) = delete;
  KnownCorners& operator=(const KnownCorners&) = delete;

  /// Places that it knows, whether they are corners or not.
  std::size_t size() const;

  class Fans;
  /// For the module itself.
  Fans& fans() { return *fans_; }

 private:
  std::unique_ptr<Fans> fans_;
};

}  // namespace knotreel::features
