#include "gi/gather/list_pass.h"

#include <algorithm>

namespace lambent {

const LightLists& ListPass::run(ListInputs in, std::span<const uint32_t> moved, bool followed, uint64_t& rays) {
  for (uint32_t slot : moved)
    if (slot < before_.size()) before_[slot] = -1;
  if (followed) in.before = before_;
  chooseLights(in, table_, rays);
  const int width = int(table_.row()), height = table_.tiles.x * table_.tiles.y;
  if (!texture_ || texture_.width() != width || texture_.height() != height)
    texture_ = gl::Texture("light lists", {.format = GL_R32UI, .width = width, .height = height});
  glTextureSubImage2D(texture_.name(), 0, 0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, table_.texels.data());
  lists_ = {&texture_, table_.tile, table_.tiles, table_.length};
  keepChanges();
  before_.clear();
  for (const VirtualLight& l : in.lights) before_.push_back(l.intensity());
  return lists_;
}

/// A change is followed by half in each frame, so half of it is left to the next.
void ListPass::keepChanges() {
  if (table_.changed.empty()) return changed_.clear();
  changed_.resize(table_.changed.size(), vec2(0));
  for (size_t t = 0; t < changed_.size(); ++t)
    changed_[t] = {std::max(changed_[t].x / 2, std::abs(table_.changed[t])), table_.changed[t]};
  const auto [width, height] = std::pair(table_.tiles.x, table_.tiles.y);
  if (!changes_ || changes_.width() != width || changes_.height() != height)
    changes_ =
        gl::Texture("light lists/changes", {.format = GL_RG32F, .width = width, .height = height, .linear = true});
  glTextureSubImage2D(changes_.name(), 0, 0, 0, width, height, GL_RG, GL_FLOAT, changed_.data());
  lists_.changed = &changes_;
}

} // namespace lambent
