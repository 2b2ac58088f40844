// Light averaged over frames. Each pixel gathers another part of the lights in every frame and casts other
// near rays, so that its mean holds them all, without the blur of a filter over its neighbours. It looks up what is
// kept where the camera before saw its place, and takes it as far as that is of the same surface.
//
// Where light changes, means over many frames lag. There, means hold few frames, and what is kept follows this frame:
// a share of the filtered difference between the two, which has less noise, is added. For indirect light that is half,
// so that half of a coarse change is shown in its first frame and nine tenths within three; or less where the lights,
// lit again by the same paths, are known to bring about what they brought (gi/lists). Tiles of the frame whose
// light changes by much more than its noise start again (history_follow.frag). Numbers: docs/measurements/light.md.
#include "gi/gather/draw_gather.h"
#include "gi/reconstruct/reconstruct.h"

#include <algorithm>
#include <cstring>

namespace lambent {

namespace {

constexpr int kFollowOn = 4;       // frames after the last change that still follow
constexpr int kFewFrames = 8;      // that means hold at most while light changes
constexpr float kKnownFrames = 16; // earlier ones in a variance

const gl::Texture* orNull(const gl::Texture& texture) { return texture ? &texture : nullptr; }

} // namespace

SurfaceLighting HistoryPass::run(const HistoryInputs& in) {
  const gl::PassScope scope = context_.scope(stage_);
  if (in.lightChanges && frames_ > 0) following_ = kFollowOn + 1;
  const bool changes = frames_ > 0 && following_ > 0;
  following_ = std::max(0, following_ - 1);
  const Kept& before = kept_[now_];
  now_ = 1 - now_;
  const Kept& now = kept_[now_];
  find(in, before, changes ? changing_ : now.framebuffer, changes);
  if (changes) follow(in, now);
  before_ = in.surfaces.block;
  ++frames_;
  return {&now.irradiance, orNull(now.glossy), false, in.gathered.subsets};
}

void HistoryPass::fit(const GBuffer& surfaces) {
  const bool glossy = surfaces.finish != nullptr;
  const auto fits = [&](const gl::Texture& texture) {
    return texture && texture.width() == surfaces.width && texture.height() == surfaces.height;
  };
  const auto make = [&](const char* label, bool wanted = true, GLenum format = GL_RGBA32F) {
    return wanted ? gl::Texture(label, {.format = format, .width = surfaces.width, .height = surfaces.height})
                  : gl::Texture();
  };
  if (bool(kept_[now_].glossy) != glossy) forget();
  Kept& next = kept_[1 - now_]; // the other is looked up, at the size that it has
  if (!fits(next.irradiance) || bool(next.glossy) != glossy) {
    next.irradiance = make("history/irradiance");
    next.seen = make("history/seen");
    next.glossy = make("history/glossy", glossy);
    next.variance = make("history/variance", true, GL_RG32F);
    next.framebuffer = gl::Framebuffer("history", {&next.irradiance, &next.seen, orNull(next.glossy), &next.variance});
  }
  if (fits(found_) && bool(foundGlossy_) == glossy) return;
  found_ = make("history/found");
  change_ = make("history/change");
  foundGlossy_ = make("history/found glossy", glossy);
  foundVariance_ = make("history/found variance", true, GL_RG32F);
  tiles_ = gl::Texture("history/tiles", {.format = GL_RGBA32F,
                                         .width = (surfaces.width + 15) / 16,
                                         .height = (surfaces.height + 15) / 16,
                                         .linear = true});
  tilesFramebuffer_ = gl::Framebuffer("history/tiles", {&tiles_});
  changing_ = gl::Framebuffer("history/changing", {&found_, &change_, orNull(foundGlossy_), &foundVariance_});
}

void HistoryPass::find(const HistoryInputs& in, const Kept& before, const gl::Framebuffer& to, bool changes) {
  std::vector<std::string> defines = bindSurfaces(in.surfaces);
  if (in.gathered.deinterleaved) defines.push_back("SUBSETS");
  if (changes) defines.push_back("CHANGES");
  before.variance.bind(9);
  const gl::Program& program = context_.programs.get({.fragment = "history.frag", .defines = std::move(defines)});
  program.use();
  program.set("tileSize", tileSize(in.surfaces));
  const int most = frames_ == 0 ? 0 : in.settings.frames - 1;
  program.set("mostFrames", float(changes ? std::min(most, kFewFrames) : most));
  program.set("mostKnown", in.otherNoise ? 0.0f : kKnownFrames);
  program.set("cycleFrames", in.cycleFrames);
  program.set("smoothed", in.smooth.irradiance != nullptr);
  program.set("stands", frames_ > 0 && std::memcmp(&before_, &in.surfaces.block, sizeof before_) == 0);
  cameras_.write(sizeof before_, frames_ == 0 ? &in.surfaces.block : &before_).bindUniform(2);
  in.gathered.irradiance->bind(2);
  before.irradiance.bind(3);
  (in.smooth.irradiance ? *in.smooth.irradiance : before.irradiance).bind(10);
  before.seen.bind(4);
  if (in.gathered.glossy) {
    in.gathered.glossy->bind(5);
    before.glossy.bind(8);
    (in.smooth.glossy ? *in.smooth.glossy : before.glossy).bind(11);
    program.set("mostGlossyFrames", float(changes || in.cameraMoved ? std::min(most, in.glossyFrames) : most));
  }
  to.bind();
  gl::PipelineState{.width = in.surfaces.width, .height = in.surfaces.height}.apply();
  gl::drawFullscreen();
}

void HistoryPass::follow(const HistoryInputs& in, const Kept& now) {
  const SurfaceLighting change{&change_, nullptr, false, in.gathered.subsets};
  const SurfaceLighting filtered = filter_.run({in.surfaces, change, in.filter});
  context_.programs.get({.fragment = "history_tiles.frag"}).use();
  found_.bind(2);
  change_.bind(3);
  tilesFramebuffer_.bind();
  gl::PipelineState{.width = tiles_.width(), .height = tiles_.height()}.apply();
  gl::drawFullscreen();
  std::vector<std::string> defines = bindSurfaces(in.surfaces);
  foundVariance_.bind(8);
  if (in.change) defines.push_back("LIGHTS"), in.change->texture->bind(9);
  if (in.gathered.deinterleaved) defines.push_back("SUBSETS");
  const gl::Program& program =
      context_.programs.get({.fragment = "history_follow.frag", .defines = std::move(defines)});
  program.use();
  if (foundGlossy_) foundGlossy_.bind(5);
  program.set("effectiveSamples", in.filter.on ? 34.0f : 1.0f); // (Σw)²/Σw² of the tent of 7×7
  program.set("follow", in.follow);
  program.set("apart", in.apart);
  if (in.change) program.set("tileSide", float(in.change->tile));
  filtered.irradiance->bind(4);
  tiles_.bind(6);
  in.gathered.irradiance->bind(10);
  program.set("tileSize", tileSize(in.surfaces));
  now.framebuffer.bind();
  gl::PipelineState{.width = in.surfaces.width, .height = in.surfaces.height}.apply();
  gl::drawFullscreen();
}

} // namespace lambent
