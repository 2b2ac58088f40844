// Every buffer as a display shows it, and the views that exist only for looking.
#include "gi/gather/draw_gather.h"
#include "gi/viewer/viewer.h"
#include "gi/viewer/viewer_stages.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lambent {

namespace {

/// How a buffer is drawn: shader variant and source texture.
struct View {
  std::vector<std::string> defines;
  const gl::Texture* source;
  float factor;
  const gl::Texture* glossy = nullptr; // goes with the source
};

View viewOf(Buffer buffer, const FrameResults& frame, float exposure) {
  switch (buffer) {
  case Buffer::Direct:
    return {{"MODE 0", "REFLECTED", "EMITTED"}, frame.direct.irradiance, exposure, frame.direct.glossy};
  case Buffer::Indirect:
    return {{"MODE 0", "REFLECTED"}, frame.indirect.irradiance, exposure, frame.indirect.glossy};
  case Buffer::Irradiance:
    return {{"MODE 0"}, frame.indirect.irradiance, exposure / kPi};
  case Buffer::Unfiltered:
    if (frame.inside.gathered.deinterleaved && frame.inside.gathered.irradiance)
      return {{"MODE 0", "DEINTERLEAVED"}, frame.inside.gathered.irradiance, exposure / kPi};
    return {{"MODE 0"},
            frame.inside.gathered.irradiance ? frame.inside.gathered.irradiance : frame.indirect.irradiance,
            exposure / kPi};
  case Buffer::Albedo:
    return {{"MODE 1"}, frame.surfaces.albedo, 1};
  case Buffer::Normal:
    return {{"MODE 2"}, frame.surfaces.normal, 1};
  case Buffer::Depth:
    return {{"MODE 3"}, frame.surfaces.depth, 0.5f * frame.farDistance};
  case Buffer::Emission:
    return {{"MODE 0"}, frame.surfaces.emission, exposure};
  case Buffer::Patches:
    if (!frame.patches || !frame.patches->normalLo) return {{"MODE 0"}, frame.indirect.irradiance, exposure / kPi};
    return {{"MODE 0", "PATCHES"}, frame.indirect.irradiance, exposure / kPi};
  case Buffer::Fragments:
    if (!frame.direct.fragments) return {{"MODE 0"}, frame.direct.irradiance, exposure / kPi};
    return {{"MODE 0", "FRAGMENTS"}, frame.direct.irradiance, exposure / kPi};
  case Buffer::Nan:
    return {{"MODE 0", "GREY"}, frame.radiance, exposure};
  case Buffer::Beauty:
  case Buffer::Vpls:
  case Buffer::ShadowMaps:
    break;
  }
  return {{"MODE 0"}, frame.radiance, exposure};
}

/// Images of light have edges to smooth; figures shown as colours must stay what they are.
bool hasEdgesToSmooth(Buffer buffer) {
  return buffer == Buffer::Beauty || buffer == Buffer::Direct || buffer == Buffer::Indirect;
}

struct Sprite {
  vec3 position;
  float heat; // rank of the intensity, 0..1
  float age;  // 0 new, 1 old
};

std::vector<Sprite> spritesOf(const VplSet& set) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < set.slots.size(); ++i)
    if (set.slots[i].alive) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const float ia = set.slots[a].intensity(), ib = set.slots[b].intensity();
    return ia != ib ? ia < ib : a < b;
  });
  std::vector<Sprite> sprites;
  for (size_t rank = 0; rank < order.size(); ++rank) {
    const Vpl& vpl = set.slots[order[rank]];
    const float frames = float(set.frame - std::min(vpl.bornFrame, set.frame));
    // Half way to old after a second at 60 frames per second.
    sprites.push_back(
        {vpl.position, float(rank) / float(std::max<size_t>(1, order.size() - 1)), 1 - std::exp2(-frames / 60.0f)});
  }
  return sprites;
}

} // namespace

const gl::Texture& DisplayPass::run(Buffer buffer, const FrameResults& frame, const Look& look,
                                    const ErrorView& error) {
  const bool smooth = look.antiAliasing == AntiAliasing::Edges && hasEdgesToSmooth(buffer) && !error.truth;
  draw(buffer, frame, look, error, smooth);
  if (smooth) antiAlias();
  return display_;
}

void DisplayPass::draw(Buffer buffer, const FrameResults& frame, const Look& look, const ErrorView& error,
                       bool smooth) {
  const gl::PassScope scope = context_.scope(StageId::Display);
  const int width = frame.surfaces.width, height = frame.surfaces.height;
  if (!black_) {
    black_ = gl::Texture("display/black", {.format = GL_RGBA32F});
    black_.clear();
  }
  if (!display_ || display_.width() != width || display_.height() != height) {
    display_ = gl::Texture("display/image", {.format = GL_RGBA8, .width = width, .height = height, .linear = true});
    framebuffer_ = gl::Framebuffer("display", {&display_});
  }
  framebuffer_.bind();
  gl::PipelineState{.width = width, .height = height}.apply();
  frame.surfaces.depth->bind(0);

  if (buffer == Buffer::ShadowMaps && !frame.inside.maps.arrays.empty()) {
    const int rows = 8, columns = std::max(1, rows * width / height); // square cells
    const gl::Program& program = context_.programs.get({.fragment = "map_sheet.frag"});
    program.use();
    program.set("grid", glm::ivec2(columns, rows));
    program.set("cellPixels", float(height) / float(rows));
    program.set("count", std::min(columns * rows, frame.inside.maps.arrays[0].desc().layers));
    frame.inside.maps.arrays[0].bind(0);
    gl::drawFullscreen();
    return;
  }

  View view = viewOf(buffer, frame, look.exposure);
  const bool reflected = buffer == Buffer::Direct || buffer == Buffer::Indirect;
  if (reflected) {
    const std::vector<std::string> glossy = bindSurfaces(frame.surfaces);
    view.defines.insert(view.defines.end(), glossy.begin(), glossy.end());
    (view.glossy ? view.glossy : &black_)->bind(8);
    for (const std::string& variant : background_.variants(frame.sky)) view.defines.push_back(variant);
  }
  if (smooth) view.defines.push_back("LUMA");
  if (error.truth) view.defines.push_back("ERROR");
  const gl::Program& program = context_.programs.get({.fragment = "display.frag", .defines = view.defines});
  program.use();
  program.set("factor", view.factor);
  program.set("lens", vec2(frame.surfaces.block.lens.z, frame.surfaces.block.lens.w));
  background_.set(program, reflected ? frame.sky : Sky(), frame.surfaces);
  program.set("tileSize", tileSize(frame.surfaces));
  program.set("toneMapper", int(look.toneMapper));
  program.set("markNan", look.markNan || buffer == Buffer::Nan ? 1 : 0);
  if (frame.patches && frame.patches->normalLo) {
    program.set("patchLevels", frame.patches->levels);
    program.set("finestPatch", frame.inside.gathered.deinterleaved ? 2 : 0);
    frame.patches->normalLo->bind(5);
  }
  if (buffer == Buffer::Fragments && frame.direct.fragments) {
    program.set("patchLevels", 5);
    program.set("finestPatch", 0);
    frame.direct.fragments->bind(5);
  }
  if (error.truth) {
    program.set("fullError", error.full);
    error.truth->bind(12);
  }
  (view.source ? view.source : &black_)->bind(2);
  frame.surfaces.albedo->bind(3);
  frame.surfaces.emission->bind(4);
  gl::drawFullscreen();
  if (buffer == Buffer::Vpls && frame.inside.vpls) drawVpls(frame);
}

void DisplayPass::antiAlias() {
  const gl::PassScope scope = context_.scope(StageId::AntiAliasing);
  const int width = display_.width(), height = display_.height();
  if (!aliased_ || aliased_.width() != width || aliased_.height() != height)
    aliased_ = gl::Texture("display/aliased", {.format = GL_RGBA8, .width = width, .height = height});
  glCopyImageSubData(display_.name(), GL_TEXTURE_2D, 0, 0, 0, 0, aliased_.name(), GL_TEXTURE_2D, 0, 0, 0, 0, width,
                     height, 1);
  const gl::Program& program = context_.programs.get({.fragment = "antialias.frag"});
  program.use();
  aliased_.bind(0);
  framebuffer_.bind();
  gl::PipelineState{.width = width, .height = height}.apply();
  gl::drawFullscreen();
}

void DisplayPass::drawVpls(const FrameResults& frame) {
  const std::vector<Sprite> sprites = spritesOf(*frame.inside.vpls);
  if (sprites.empty()) return;
  if (!spriteArray_) {
    spriteArray_ = gl::VertexArray("display/vpls");
    const GLuint array = spriteArray_.name();
    glEnableVertexArrayAttrib(array, 0);
    glVertexArrayAttribFormat(array, 0, 4, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, 0, 0);
    glEnableVertexArrayAttrib(array, 1);
    glVertexArrayAttribFormat(array, 1, 1, GL_FLOAT, GL_FALSE, offsetof(Sprite, age));
    glVertexArrayAttribBinding(array, 1, 0);
  }
  const gl::BufferSlice slice = sprites_.write(sprites.size() * sizeof(Sprite), sprites.data());
  glVertexArrayVertexBuffer(spriteArray_.name(), 0, slice.buffer->name(), GLintptr(slice.offset), sizeof(Sprite));
  const gl::Program& program = context_.programs.get({.vertex = "vpl_sprite.vert", .fragment = "vpl_sprite.frag"});
  program.use();
  program.set("diameterPixels", std::max(5.0f, float(frame.surfaces.height) / 72));
  frame.surfaces.camera->bindUniform(0);
  frame.surfaces.depth->bind(0);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glBindVertexArray(spriteArray_.name());
  gl::drawArrays(GL_POINTS, int(sprites.size()));
  glBindVertexArray(0);
  glDisable(GL_PROGRAM_POINT_SIZE);
}

void DisplayPass::present(uint32_t framebuffer, int width, int height, const gl::Texture* right, float divider) {
  const gl::PassScope scope = context_.scope(StageId::Present);
  std::vector<std::string> defines;
  if (right) defines.push_back("SPLIT");
  const gl::Program& program = context_.programs.get({.fragment = "present.frag", .defines = std::move(defines)});
  program.use();
  program.set("targetSize", vec2(width, height));
  display_.bind(0);
  if (right) {
    program.set("divider", divider * float(width));
    right->bind(1);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl::PipelineState{.width = width, .height = height}.apply();
  gl::drawFullscreen();
}

Image8 DisplayPass::read() const {
  const int width = display_.width(), height = display_.height();
  std::vector<uint8_t> bottomUp(size_t(width) * height * 3);
  display_.read(std::span(bottomUp), GL_RGB, GL_UNSIGNED_BYTE);
  Image8 image{width, height, std::vector<uint8_t>(bottomUp.size())};
  const size_t row = size_t(width) * 3;
  for (int y = 0; y < height; ++y)
    std::copy_n(&bottomUp[size_t(height - 1 - y) * row], row, &image.rgb[size_t(y) * row]);
  return image;
}

} // namespace lambent
