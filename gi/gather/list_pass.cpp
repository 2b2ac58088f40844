#include "gi/gather/list_pass.h"

namespace lambent {

const LightLists& ListPass::run(const ListInputs& in, uint64_t& rays) {
  chooseLights(in, table_, rays);
  const int width = int(table_.row()), height = table_.tiles.x * table_.tiles.y;
  if (!texture_ || texture_.width() != width || texture_.height() != height)
    texture_ = gl::Texture("light lists", {.format = GL_R32UI, .width = width, .height = height});
  glTextureSubImage2D(texture_.name(), 0, 0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, table_.texels.data());
  lists_ = {&texture_, table_.tile, table_.tiles, table_.chunks};
  return lists_;
}

} // namespace lambent
