// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/known_fans.h"

#include <span>

namespace knotreel::features {
namespace {

constexpr std::uint64_t kPictures = 4;  // that may be worked on at once, about
constexpr std::size_t kMany = 20'000;   // of a kilobyte each: more are kept for one picture only

template <class Number>
void append(std::string& bytes, std::span<const Number> numbers) {
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
}

/// All that the fit hangs on, bit for bit.
std::string key_of(const image::Image& image, FanWindow window, const Fan& start,
                   const std::vector<Vec2>& through) {
  const int counts[] = {image.channels, int(start.rays.size())};
  std::string key;
  append<int>(key, counts);
  append<Vec2>(key, {&start.tip, 1});
  append<Vec2>(key, start.rays);
  append<Vec2>(key, through);
  const std::size_t row = std::size_t(FanWindow::kSize) * std::size_t(image.channels);
  for (int y = window.y; y < window.y + FanWindow::kSize; ++y)
    append<float>(key, image.row(y).subspan(std::size_t(window.x) * std::size_t(image.channels), row));
  return key;
}

}  // namespace

void KnownCorners::Fans::begin_picture() {
  const std::lock_guard lock(mutex_);
  ++picture_;
  const std::uint64_t pictures = known_.size() > kMany ? 1 : kPictures;
  std::erase_if(known_, [&](const auto& known) { return known.second.last + pictures < picture_; });
}

std::optional<FanFit> KnownCorners::Fans::fit(const image::Image& image, const Fan& start,
                                              const std::vector<Vec2>& through) {
  const std::optional<FanWindow> window = fan_window(image, start.tip);
  if (!window) return std::nullopt;
  std::string key = key_of(image, *window, start, through);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = known_.find(key); found != known_.end()) {
      found->second.last = picture_;
      return found->second.fit;
    }
  }
  std::optional<FanFit> fit = fit_fan(image, start, through);
  const std::lock_guard lock(mutex_);
  known_.insert_or_assign(std::move(key), Known{fit, picture_});
  return fit;
}

std::size_t KnownCorners::Fans::size() const {
  const std::lock_guard lock(mutex_);
  return known_.size();
}

KnownCorners::KnownCorners() : fans_(std::make_unique<Fans>()) {}
KnownCorners::~KnownCorners() = default;

std::size_t KnownCorners::size() const {
  return fans_->size();
}

}  // namespace knotreel::features
