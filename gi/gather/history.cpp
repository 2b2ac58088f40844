// Light averaged over pictures. Each pixel looks where the place that it shows was seen in the picture before; what
// lies there counts as far as it is of the same surface.
#include "gi/gather/draw_gather.h"
#include "gi/gather/stages.h"

#include <algorithm>

namespace lambent {

void HistoryPass::fit(const GBuffer& surfaces) {
  const bool glossy = surfaces.finish != nullptr;
  const gl::Texture& present = kept_[0].irradiance;
  if (present && present.width() == surfaces.width && present.height() == surfaces.height &&
      bool(kept_[0].glossy) == glossy)
    return;
  forget();
  for (Kept& k : kept_) {
    const auto make = [&](const char* label) {
      return gl::Texture(label, {.format = GL_RGBA32F, .width = surfaces.width, .height = surfaces.height});
    };
    k.irradiance = make("history/irradiance");
    k.seen = make("history/seen");
    k.glossy = glossy ? make("history/glossy") : gl::Texture();
    k.framebuffer = glossy ? gl::Framebuffer("history", {&k.irradiance, &k.seen, &k.glossy})
                           : gl::Framebuffer("history", {&k.irradiance, &k.seen});
  }
}

LightOnSurfaces HistoryPass::run(const HistoryInputs& in) {
  const gl::PassScope scope = context_.scope(StageId::History);
  fit(in.surfaces);
  const Kept& before = kept_[now_];
  now_ = 1 - now_;
  const Kept& now = kept_[now_];
  std::vector<std::string> defines = bindSurfaces(in.surfaces);
  if (in.gathered.deinterleaved) defines.push_back("SUBSETS");
  if (in.fresh) defines.push_back("CHANGES");
  const gl::Program& program = context_.programs.get({.fragment = "history.frag", .defines = std::move(defines)});
  program.use();
  program.set("tileSize", tileSize(in.surfaces));
  const float most = pictures_ == 0 ? 0.0f : float(in.settings.frames - 1);
  program.set("pictures", most);
  cameras_.write(sizeof before_, pictures_ == 0 ? &in.surfaces.block : &before_).bindUniform(2);
  in.gathered.irradiance->bind(2);
  before.irradiance.bind(3);
  before.seen.bind(4);
  if (in.gathered.glossy) {
    in.gathered.glossy->bind(5);
    before.glossy.bind(8);
    program.set("glossyPictures", in.camera || in.fresh ? 0.0f : most);
  }
  if (in.fresh) in.fresh->irradiance->bind(9);
  now.framebuffer.bind();
  gl::PipelineState{.width = in.surfaces.width, .height = in.surfaces.height}.apply();
  gl::drawFullscreen();
  before_ = in.surfaces.block;
  ++pictures_;
  return {&now.irradiance, now.glossy ? &now.glossy : nullptr, false, in.gathered.deinterleaved};
}

} // namespace lambent
