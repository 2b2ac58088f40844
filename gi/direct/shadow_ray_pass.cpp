#include "gi/direct/shadow_ray_pass.h"

#include "engine/core/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lambent {

void ShadowRayPass::begin() {
  const Header header{.room = room_};
  if (const uint64_t bytes = sizeof(Header) + room_ * sizeof(ShadowDoubt); !list_ || list_.bytes() != bytes)
    list_ = gl::Buffer("direct/doubts", bytes, nullptr);
  uploads_.upload(list_, 0, sizeof header, &header);
  list_.bindStorage(0);
}

bool ShadowRayPass::collect() {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  Header header;
  list_.read(0, std::span(&header, 1));
  if (header.count > room_) {
    room_ = std::max(room_, std::min(header.count, most_ / 2) * 2);
    return false;
  }
  doubts_.resize(header.count);
  if (!doubts_.empty()) list_.read(sizeof header, std::span(doubts_));
  return true;
}

void ShadowRayPass::trace(const RayQuery& rays, const std::function<Ray(const ShadowDoubt&)>& towards,
                          RayCounts& counts) {
  // In the order of lights and pixels, not that in which the GPU came by them: rays side by side are faster, and sums
  // the same every time.
  std::sort(doubts_.begin(), doubts_.end(), [](const ShadowDoubt& a, const ShadowDoubt& b) {
    return a.light != b.light ? a.light < b.light : a.pixel < b.pixel;
  });
  std::vector<Ray> segments(doubts_.size());
  std::vector<float> open(doubts_.size());
  parallelFor(doubts_.size(), 512, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) segments[i] = towards(doubts_[i]);
    const size_t n = end - begin;
    rays.transmittance(std::span(segments).subspan(begin, n), std::span(open).subspan(begin, n));
  });
  counts.occlusion += doubts_.size();
  lit_.clear();
  for (size_t i = 0; i < doubts_.size(); ++i)
    if (const auto share = uint32_t(std::lround(255 * open[i])); share > 0)
      lit_.push_back({doubts_[i].pixel, doubts_[i].light | share << 24});
}

void ShadowRayPass::bindLit(int unit) {
  const uint64_t bytes = std::bit_ceil(std::max<uint64_t>(lit_.size(), 1024)) * sizeof(uvec2);
  if (!litBuffer_ || litBuffer_.bytes() < bytes) {
    litBuffer_ = gl::Buffer("direct/lit pairs", bytes, nullptr);
    litView_ = gl::Texture::ofBuffer("direct/lit pairs", GL_RG32UI, litBuffer_);
    uploads_.reserve(bytes);
  }
  uploads_.upload(litBuffer_, 0, lit_.size() * sizeof(uvec2), lit_.data());
  litView_.bind(unit);
}

} // namespace lambent
