// Light of pixels from the layered depth cube.
#include "engine/core/image.h"
#include "engine/gl/ring.h"
#include "gi/cube/cube_file.h"
#include "gi/gather/draw_gather.h"
#include "gi/gather/hemicube_pass.h"
#include "gi/gather/stages.h"
#include "gi/vpl/near_light.h"
#include "shaders/shared/layered_cube.h"
#include "shaders/shared/octahedral.h"

#include <glm/gtc/packing.hpp>

#include <chrono>
#include <utility>

namespace lambent {

namespace {

class CubeGather : public IndirectStage {
 public:
  explicit CubeGather(PassContext context) : context_(context) {}

  LightOnSurfaces run(const IndirectInputs& in, FrameStats& stats) override {
    if (update(in, stats)) {
      traceNear(in, stats);
      upload();
    }
    stats.cubeEntries = entries_.bytes() / sizeof(CubeTexel);
    stats.cubeBytes = entries_.bytes() + firsts_.bytes();
    stats.cubeKeptBytes = cube_.bytesKept() + near_.size() * sizeof(vec3);
    const gl::PassScope scope = context_.scope(StageId::Gather);
    target_.fit(in.surfaces);
    const gl::Program& program =
        context_.programs.get({.fragment = "cube_gather.frag", .defines = bindSurfaces(in.surfaces)});
    program.use();
    program.set("corner", cube_.surfaces().corner());
    program.set("texel", cube_.surfaces().texel());
    program.set("resolution", cube_.surfaces().resolution());
    program.set("brightest", brightest_);
    firsts_.bindStorage(2);
    entries_.bindStorage(5);
    target_.bind();
    gl::PipelineState{.width = target_.size().x, .height = target_.size().y}.apply();
    gl::drawFullscreen();
    return target_.light();
  }

 private:
  bool update(const IndirectInputs& in, FrameStats& stats) {
    constexpr uint32_t kAtOnce = 64; // lights, between two reports
    constexpr std::chrono::seconds kSaveAfter{5};
    const CpuScope scope(stats.stages, key(StageId::Cube));
    const VirtualLights& lights = in.seen.lights;
    bool changed = false, first = true;
    auto saved = std::chrono::steady_clock::now();
    const bool stored = in.world.view.changes.first && !in.settings.cubeFile.empty(); // this build goes to the file
    if (stored) open(in);
    hemicubes_.prepare(in.world, in.settings.hemicubes.maker);
    for (uint32_t total = 0;; first = false) {
      const CubeWork work =
          cube_.update({in.world.view.boundsWorld, in.world.rays, first && !opened_ ? in.world.moved : kNothingMoved,
                        first && in.world.view.changes.first && !opened_, lights.slots, lights.direct, in.settings.cube,
                        in.settings.gather, &hemicubes_},
                       kAtOnce);
      stats.raysCube += work.rays;
      hemicubes_.tell(stats);
      changed |= work.changed;
      if (first) total = work.lightsIn + cube_.pending();
      if (in.progress && total > kAtOnce) in.progress(int(total - cube_.pending()), int(total));
      const bool done = cube_.pending() == 0;
      if (stored && changed && (done || std::chrono::steady_clock::now() - saved > kSaveAfter)) {
        saveCube(in.settings.cubeFile, cube_, cubeKey(in.world.view));
        saved = std::chrono::steady_clock::now();
      }
      if (done) return std::exchange(opened_, false) || changed;
    }
  }

  /// Takes over what is in the file of the settings. One that does not fit is left as it is: InputError.
  void open(const IndirectInputs& in) {
    const std::filesystem::path file = in.settings.cubeFile;
    removeLeftovers(file);
    if (!std::filesystem::exists(file)) return;
    cube_ = loadCube(file, cubeKey(in.world.view));
    opened_ = true;
  }

  /// What bounds take from near lights, at every entry that light reaches.
  void traceNear(const IndirectInputs& in, FrameStats& stats) {
    near_.assign(cube_.surfaces().entries().size(), vec3(0));
    const GatherSettings& gather = in.settings.gather;
    if (gather.near == 0 || (gather.disk == 0 && gather.clamp == 0)) return;
    const CpuScope scope(stats.stages, key(StageId::NearLight));
    std::vector<SurfaceHit> places;
    std::vector<uint32_t> of;
    for (uint32_t e = 0; e < near_.size(); ++e) {
      if (cube_.irradiance(e) == vec3(0)) continue;
      const CubeEntry& entry = cube_.surfaces().entries()[e];
      SurfaceHit& place = places.emplace_back();
      place.position = entry.position;
      place.geometricNormal = entry.normal;
      place.normal = entry.shading;
      of.push_back(e);
    }
    constexpr int kRays = 4; // times gather.near: nothing is mixed between entries
    const std::vector<vec3> light = traceNearLightAt(places,
                                                     {.view = in.world.view,
                                                      .rays = in.world.rays,
                                                      .lights = in.world.lights,
                                                      .virtuals = in.seen.lights.slots,
                                                      .gather = gather,
                                                      .casts = kRays * gather.near,
                                                      .bounces = in.bounces,
                                                      .seed = in.seed},
                                                     stats.raysNear);
    for (size_t i = 0; i < of.size(); ++i) near_[of[i]] = light[i];
  }

  vec3 irradiance(size_t entry) const { return cube_.irradiance(entry) + near_[entry]; }

  /// Without entries that no light sees, which lie in solids and behind walls: pixels beside one would take it for
  /// theirs. (Left in: black specks where boxes stand on a floor, and twice the memory.)
  void upload() {
    const CubeSurfaces& surfaces = cube_.surfaces();
    constexpr float kDark = 1e-12f; // what rounding leaves of lights that were taken out
    brightest_ = 1e-30f;
    for (size_t i = 0; i < surfaces.entries().size(); ++i)
      brightest_ = std::max(brightest_, maxComponent(irradiance(i)));
    std::vector<CubeTexel> texels;
    std::vector<uint32_t> firsts{0};
    firsts.reserve(surfaces.columns() + 1);
    for (size_t c = 0; c < surfaces.columns(); ++c) {
      const CubeSurfaces::Place at = surfaces.placeOf(c);
      for (uint32_t e = surfaces.firsts()[c]; e < surfaces.firsts()[c + 1]; ++e) {
        const CubeEntry& entry = surfaces.entries()[e];
        if (!(maxComponent(cube_.irradiance(e)) > kDark * brightest_)) continue;
        const vec3 x = entry.position - surfaces.corner();
        const vec2 within = vec2(x[(at.axis + 1) % 3], x[(at.axis + 2) % 3]) / surfaces.texel() - vec2(at.u, at.v);
        const uvec2 place = uvec2(glm::clamp(within, 0.0f, 0.999f) * 256.0f);
        const vec3 light = glm::max(irradiance(e), vec3(0)) / (brightest_ * kCubeRange);
        texels.push_back({glm::packSnorm2x16(octahedralFromUnit(entry.normal)), glm::dot(x, entry.normal),
                          glm::packF3x9_E1x5(light), entry.neighbours | place.x << 8 | place.y << 16});
      }
      firsts.push_back(uint32_t(texels.size()));
    }
    copy(entries_, "cube/entries", std::span<const CubeTexel>(texels));
    copy(firsts_, "cube/firsts", std::span<const uint32_t>(firsts));
  }

  template <class T> void copy(gl::Buffer& buffer, const char* label, std::span<const T> data) {
    const uint64_t bytes = std::max<uint64_t>(data.size_bytes(), sizeof(T));
    if (!buffer || buffer.bytes() != bytes) buffer = gl::Buffer(label, bytes, nullptr);
    if (data.empty()) return;
    changes_.reserve(bytes);
    changes_.upload(buffer, 0, data.size_bytes(), data.data());
  }

  PassContext context_;
  HemicubePass hemicubes_{context_};
  LayeredCube cube_;
  std::vector<vec3> near_; // by entry
  bool opened_ = false;    // from a file, and not uploaded yet
  float brightest_ = 1;    // W/m²
  gl::Buffer firsts_, entries_;
  gl::Ring changes_{"cube/changes"};
  LightTarget target_{"cube gather"};
};

} // namespace

std::unique_ptr<IndirectStage> makeCubeGather(PassContext context) { return std::make_unique<CubeGather>(context); }

} // namespace lambent
