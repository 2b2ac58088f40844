// Light of pixels from the layered depth cube.
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/memory.h"
#include "engine/gl/ring.h"
#include "gi/cube/cube_file.h"
#include "gi/cube/draw/hemicube_pass.h"
#include "gi/gather/draw_gather.h"
#include "gi/gather/gathers.h"
#include "gi/near/near_light.h"
#include "shaders/shared/layered_cube.h"
#include "shaders/shared/octahedral.h"

#include <glm/gtc/packing.hpp>

#include <chrono>
#include <utility>

namespace lambent {

namespace {

class CubeGather : public Gather {
  using Clock = std::chrono::steady_clock;

 public:
  explicit CubeGather(PassContext context) : context_(context) {}

  SurfaceLighting run(const GatherInputs& in, FrameStats& stats) override {
    if (in.stores) {
      const bool was = std::exchange(uploaded_, false); // also where the update is refused
      uploaded_ = !update(in, stats) && was;
    }
    if (in.stores && !uploaded_) {
      traceNear(in, stats);
      upload();
    }
    if (!uploaded_) return {};
    stats.cubeEntries = entries_.buffer.bytes() / sizeof(CubeTexel);
    stats.cubes = cube_.surfaces().cubes().size();
    stats.cubeBytes = entries_.buffer.bytes() + firsts_.buffer.bytes() + nodes_.buffer.bytes();
    stats.cubeKeptBytes = cube_.bytesKept() + near_.size() * sizeof(vec3);
    held_.now(stats.cubeKeptBytes);
    const gl::PassScope scope = context_.scope(StageId::Gather);
    target_.fit(in.frame.surfaces);
    const gl::Program& program =
        context_.programs.get({.fragment = "cube_gather.frag", .defines = bindSurfaces(in.frame.surfaces)});
    program.use();
    program.set("resolution", cube_.surfaces().cubes().front().resolution);
    program.set("brightest", brightest_);
    firsts_.texels.bind(10);
    entries_.texels.bind(11);
    nodes_.texels.bind(12);
    target_.bind();
    gl::PipelineState{.width = target_.size().x, .height = target_.size().y}.apply();
    gl::drawFullscreen();
    return target_.light();
  }

 private:
  bool update(const GatherInputs& in, FrameStats& stats) {
    constexpr uint32_t kAtOnce = 64; // lights, between two reports
    const CpuScope scope(stats.stages, key(StageId::Cube));
    const VirtualLights& lights = in.lights.list;
    bool changed = false, first = true;
    // This build goes to the file, now and then while it lasts.
    const bool stored = in.frame.world.view.changes.first && !in.frame.settings.cubeFile.empty() && open(in, stats);
    Clock::time_point saved = Clock::now();
    Clock::duration saveAfter = std::chrono::seconds(5);
    hemicubes_.prepare(in.frame.world, in.frame.settings.hemicubes.maker);
    for (uint32_t total = 0;; first = false) {
      const CubeWork work = cube_.update({in.frame.world.view.boundsWorld, in.frame.world.rays,
                                          first && !opened_ ? in.frame.world.moved : kNothingMoved,
                                          first && in.frame.world.view.changes.first && !opened_, lights.slots,
                                          lights.direct, in.frame.settings.cube, in.frame.settings.gather, &hemicubes_},
                                         kAtOnce);
      stats.raysCube += work.rays;
      hemicubes_.tell(stats);
      if (const uint32_t cut = cube_.surfaces().columnsCut(); first && cut > 0 && stats.warning.empty())
        stats.warning = "the layered depth cube lacks surfaces in " + std::to_string(cut) +
                        " of its columns, where more than 256 lie behind one another (raise cube.levels)";
      changed |= work.changed;
      if (first) total = work.lightsIn + cube_.pending();
      try {
        if (in.frame.progress && total > kAtOnce) in.frame.progress(int(total - cube_.pending()), int(total));
      } catch (...) { // somebody stops it: another run goes on from here
        if (stored) saveCube(in.frame.settings.cubeFile, cube_, keyOf(in));
        throw;
      }
      const bool done = cube_.pending() == 0;
      if (stored && changed && (done || Clock::now() - saved > saveAfter)) {
        const Clock::time_point begin = Clock::now();
        saveCube(in.frame.settings.cubeFile, cube_, keyOf(in));
        saved = Clock::now();
        saveAfter = std::max(saveAfter, 20 * (saved - begin));
      }
      if (done) return std::exchange(opened_, false) || changed;
    }
  }

  /// Masks that are not cut out make other surfaces.
  static uint64_t keyOf(const GatherInputs& in) {
    return cubeKey(in.frame.world.view) + (in.frame.settings.effects[EffectId::Alpha] == EffectMode::Off ? 1 : 0);
  }

  /// Takes over what is in the file of the settings. A cube that does not fit is rebuilt; what is no cube at all
  /// stays as it is. Whether the file is to be written.
  bool open(const GatherInputs& in, FrameStats& stats) {
    const std::filesystem::path file = in.frame.settings.cubeFile;
    removeLeftovers(file);
    std::error_code none;
    if (!std::filesystem::exists(file, none)) {
      checkWritable(file);
      return true;
    }
    try {
      cube_ = loadCube(file, keyOf(in));
      opened_ = cube_.isOf(in.frame.settings.cube, in.frame.settings.gather, in.lights.list.slots.size());
      if (!opened_)
        stats.warning = file.string() +
                        ": is a layered depth cube of other settings (cube.*, gather.*, smc.vpls); it is "
                        "rebuilt and replaced";
      return true;
    } catch (const InputError& e) {
      const bool replaced = isCube(file);
      stats.warning = std::string(e.what()) +
                      (replaced ? "; it is rebuilt and replaced" : "; it stays as it is, and this one is not kept");
      return replaced;
    }
  }

  /// What bounds take from near lights, at entries that light reaches.
  void traceNear(const GatherInputs& in, FrameStats& stats) {
    const size_t entries = cube_.surfaces().entries().size();
    const GatherSettings& gather = in.frame.settings.gather;
    near_.assign(entries, vec3(0));
    if (gather.near == 0 || (gather.disk == 0 && gather.clamp == 0)) return;
    const CpuScope scope(stats.stages, key(StageId::NearLight));
    std::vector<SurfaceHit> places;
    std::vector<uint32_t> of;
    for (size_t e = 0; e < entries; ++e) {
      if (cube_.irradiance(e) == vec3(0)) continue;
      const CubeEntry& entry = cube_.surfaces().entries()[e];
      SurfaceHit& place = places.emplace_back();
      place.position = entry.position;
      place.geometricNormal = entry.normal;
      place.normal = entry.shading;
      of.push_back(uint32_t(e));
    }
    constexpr int kRays = 4; // times gather.near: nothing is mixed between entries
    const std::vector<vec3> light = traceNearLightAt(places,
                                                     {.view = in.frame.world.view,
                                                      .rays = in.frame.world.rays,
                                                      .lights = in.frame.world.lights,
                                                      .virtuals = in.lights.list.slots,
                                                      .gather = gather,
                                                      .casts = kRays * gather.near,
                                                      .bounces = in.frame.bounces,
                                                      .seed = in.frame.seed},
                                                     stats.raysNear);
    for (size_t i = 0; i < of.size(); ++i) near_[of[i]] = light[i];
  }

  vec3 irradiance(size_t entry) const { return cube_.irradiance(entry) + near_[entry]; }

  bool lit(size_t entry) const {
    constexpr float kDark = 1e-12f; // what rounding leaves of lights that were taken out
    return maxComponent(cube_.irradiance(entry)) > kDark * brightest_;
  }

  /// Whether a lit surface that faces as a dark one does lies behind it, near enough for pixels to take it for theirs:
  /// a thin floor over a lit room.
  bool overLight(const CubeGrid& grid, const CubeGrid::Place& at, size_t firstColumn, const CubeEntry& dark) const {
    constexpr float kNear = 1.3f, kCoplanar = 0.02f; // texels; kOwn of cube_gather.frag is 1
    const CubeSurfaces& surfaces = cube_.surfaces();
    for (int v = std::max(at.v - 1, 0); v <= std::min(at.v + 1, grid.resolution - 1); ++v)
      for (int u = std::max(at.u - 1, 0); u <= std::min(at.u + 1, grid.resolution - 1); ++u) {
        const size_t c = firstColumn + grid.column(at.axis, u, v);
        for (uint32_t e = surfaces.firsts()[c]; e < surfaces.firsts()[c + 1]; ++e) {
          const CubeEntry& other = surfaces.entries()[e];
          const float behind = glm::dot(dark.position - other.position, dark.normal) / grid.texel;
          if (behind > kCoplanar && behind < kNear && glm::dot(other.normal, dark.normal) > 0.5f && lit(e)) return true;
        }
      }
    return false;
  }

  /// Without most entries that no light sees, which lie in solids and behind walls: pixels next to one would take it
  /// for theirs. (Left in: black specks where boxes stand on a floor, and twice the memory.)
  void upload() {
    const CubeSurfaces& surfaces = cube_.surfaces();
    brightest_ = 1e-30f;
    for (size_t i = 0; i < surfaces.entries().size(); ++i)
      brightest_ = std::max(brightest_, maxComponent(irradiance(i)));
    std::vector<CubeTexel> texels;
    std::vector<uint32_t> firsts{0};
    firsts.reserve(2 * surfaces.firsts().size());
    for (size_t c = 0; c + 1 < surfaces.firsts().size(); ++c) {
      const CubeGrid& grid = surfaces.cubes()[c / surfaces.columns()];
      const CubeGrid::Place at = grid.placeOf(c % surfaces.columns());
      for (const bool side : {false, true}) {
        for (uint32_t e = surfaces.firsts()[c]; e < surfaces.firsts()[c + 1]; ++e) {
          const CubeEntry& entry = surfaces.entries()[e];
          if ((entry.normal[at.axis] > 0) != side) continue;
          if (!lit(e) && !overLight(grid, at, c - c % surfaces.columns(), entry)) continue;
          const vec3 x = entry.position - grid.corner;
          const vec2 within = vec2(x[(at.axis + 1) % 3], x[(at.axis + 2) % 3]) / grid.texel - vec2(at.u, at.v);
          const uvec2 place = uvec2(glm::clamp(within, 0.0f, 0.999f) * 256.0f);
          const vec3 light = glm::max(irradiance(e), vec3(0)) / (brightest_ * kCubeRange);
          texels.push_back({glm::packSnorm2x16(octahedralFromUnit(entry.normal)), glm::dot(x, entry.normal),
                            glm::packF3x9_E1x5(light), entry.neighbours | place.x << 8 | place.y << 16});
        }
        firsts.push_back(uint32_t(texels.size()));
      }
    }
    copy(entries_, "cube/entries", GL_RGBA32UI, std::span<const CubeTexel>(texels));
    copy(firsts_, "cube/firsts", GL_R32UI, std::span<const uint32_t>(firsts));
    copy(nodes_, "cube/nodes", GL_RGBA32UI, surfaces.nodes());
    uploaded_ = true;
  }

  /// What a shader fetches by number.
  struct Texels {
    gl::Buffer buffer;
    gl::Texture texels;
  };

  template <class T> void copy(Texels& to, const char* label, GLenum format, std::span<const T> data) {
    const uint64_t bytes = std::max<uint64_t>(data.size_bytes(), sizeof(T));
    if (bytes / (format == GL_R32UI ? 4 : 16) > gl::mostBufferTexels())
      throw RunError("the layered depth cube is larger than this GPU's buffers (lower cube.resolution or cube.levels)");
    if (!to.buffer || to.buffer.bytes() != bytes) {
      to.texels = {};
      to.buffer = gl::Buffer(label, bytes, nullptr);
      to.texels = gl::Texture::ofBuffer(label, format, to.buffer);
    }
    if (data.empty()) return;
    changes_.reserve(bytes);
    changes_.upload(to.buffer, 0, data.size_bytes(), data.data());
  }

  PassContext context_;
  HemicubePass hemicubes_{context_};
  LayeredCube cube_;
  std::vector<vec3> near_; // by entry
  HeldMemory held_{"cube"};
  bool uploaded_ = false; // as the cube is now
  bool opened_ = false;   // from a file, and not uploaded yet
  float brightest_ = 1;   // W/m²
  Texels firsts_, entries_, nodes_;
  gl::Ring changes_{"cube/changes"};
  LightTarget target_{"cube gather"};
};

} // namespace

std::unique_ptr<Gather> makeCubeGather(PassContext context) { return std::make_unique<CubeGather>(context); }

} // namespace lambent
