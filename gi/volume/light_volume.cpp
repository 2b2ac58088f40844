#include "gi/volume/light_volume.h"

#include "engine/core/parallel.h"
#include "shaders/shared/light_volume.h"

#include <cstring>

namespace lambent {

void LightVolume::update(const VolumeInputs& in, FrameStats& stats) {
  bool changed = steps_ != in.settings.steps || lobes_ != in.settings.lobes;
  steps_ = in.settings.steps;
  lobes_ = in.settings.lobes;
  {
    const CpuScope scope(stats.stages, key(StageId::VolumeVisibility));
    const VolumeGrid grid = volumeGrid(in.settings, in.world.view, sights_.grid());
    if (sights_.update(grid, in.world, in.settings.occlusion, stats.raysVolume) || !open_) {
      changed = true;
      upload(open_, "volume/open", sights_.open());
      upload(seen_, "volume/sights", sights_.sights());
      injections_.clear();
    }
  }
  {
    const CpuScope scope(stats.stages, key(StageId::Inject));
    changed |= deposit(in, stats.raysVolume);
  }
  if (changed) propagate();
}

void LightVolume::bind(const gl::Program& program) const {
  const VolumeGrid& grid = sights_.grid();
  program.set("corner", grid.corner());
  program.set("cell", grid.cell);
  program.set("cells", grid.cells);
  passed_.bindStorage(2);
  seen_.bindStorage(5);
}

template <class T> void LightVolume::upload(gl::Buffer& buffer, const char* label, std::span<const T> data) {
  if (!buffer || buffer.bytes() != data.size_bytes()) buffer = gl::Buffer(label, data.size_bytes(), nullptr);
  changes_.reserve(data.size_bytes());
  changes_.upload(buffer, 0, data.size_bytes(), data.data());
}

/// Looks which cells around them the lights see that stand elsewhere than before; all of them where a cell's sights
/// changed.
void LightVolume::findCells(const VolumeInputs& in, RayCounts& counts) {
  const VolumeGrid& grid = sights_.grid();
  const std::span<const VirtualLight> lights = in.lights;
  injections_.resize(lights.size());
  std::vector<uint32_t> moved;
  for (uint32_t i = 0; i < lights.size(); ++i) {
    const VirtualLight& light = lights[i];
    if (!light.alive) continue;
    if (injections_[i].position != light.position || injections_[i].normal != light.geometricNormal) moved.push_back(i);
  }
  std::vector<Ray> rays;
  std::vector<std::pair<uint32_t, int>> asked;
  for (uint32_t i : moved) {
    const VirtualLight& light = lights[i];
    Injection& injection = injections_[i];
    injection = {light.position, light.geometricNormal};
    const vec3 x = (light.position - grid.corner()) / grid.cell + kVolumeShift * light.geometricNormal;
    if (!isFinite(x) || maxComponent(glm::abs(x)) > 1e6f) continue;
    injection.base = ivec3(glm::floor(x - 0.5f));
    for (int k = 0; k < 8; ++k) {
      const ivec3 at = injection.base + ivec3(k & 1, k >> 1 & 1, k >> 2);
      if (!grid.holds(at)) continue;
      injection.weights[k] = volumeWeight(x, vec3(at) + 0.5f, light.geometricNormal);
      if (injection.weights[k] == 0 || !in.settings.occlusion) continue;
      rays.push_back(
          segment(offsetPoint(light.position, light.geometricNormal, in.world.rays.rayEpsilon()), grid.centre(at)));
      asked.emplace_back(i, k);
    }
  }
  std::vector<uint8_t> blocked(rays.size());
  parallelFor(rays.size(), 4096, [&](size_t begin, size_t end) {
    in.world.rays.occluded(std::span(rays).subspan(begin, end - begin), std::span(blocked).subspan(begin, end - begin));
  });
  counts.occlusion += rays.size();
  for (size_t n = 0; n < asked.size(); ++n)
    if (blocked[n]) injections_[asked[n].first].weights[asked[n].second] = 0;
  for (uint32_t i : moved) {
    float sum = 0;
    for (float w : injections_[i].weights) sum += w;
    for (float& w : injections_[i].weights) w = sum > 0 ? w / sum : 0;
  }
}

/// What the lights reflect, as cosine lobes in the cells around them: all of it, where anything is open to them.
/// Returns whether it is other than before.
bool LightVolume::deposit(const VolumeInputs& in, RayCounts& counts) {
  findCells(in, counts);
  const VolumeGrid& grid = sights_.grid();
  std::vector<vec4> cells(3 * grid.size(), vec4(0));
  const std::span<const VirtualLight> lights = in.lights;
  for (size_t i = 0; i < lights.size(); ++i) {
    const VirtualLight& light = lights[i];
    if (!light.alive) continue;
    const vec3 flux = kPi * light.radiance * light.area;
    const Injection& injection = injections_[i];
    const vec4 lobe(kLobe0, kLobe1 * light.normal);
    for (int k = 0; k < 8; ++k) {
      if (injection.weights[k] == 0) continue;
      const size_t cell = 3 * grid.index(injection.base + ivec3(k & 1, k >> 1 & 1, k >> 2));
      for (int colour = 0; colour < 3; ++colour) cells[cell + colour] += lobe * (injection.weights[k] * flux[colour]);
    }
  }
  if (cells.size() == deposited_.size() &&
      std::memcmp(cells.data(), deposited_.data(), cells.size() * sizeof(vec4)) == 0)
    return false;
  deposited_ = std::move(cells);
  upload(deposits_, "volume/deposits", std::span<const vec4>(deposited_));
  return true;
}

void LightVolume::propagate() {
  const gl::PassScope scope = context_.scope(StageId::Propagate);
  const VolumeGrid& grid = sights_.grid();
  const uint64_t cells = grid.size();
  if (!passed_ || passed_.bytes() != cells * 6 * sizeof(vec4)) {
    passed_ = gl::Buffer("volume/passed", cells * 6 * sizeof(vec4), nullptr);
    for (gl::Buffer& light : light_) light = gl::Buffer("volume/light", cells * 4 * sizeof(vec4), nullptr);
  }
  passed_.bindStorage(2);
  open_.bindStorage(3);
  deposits_.bindStorage(4);
  const int groups = (grid.cells + 3) / 4;
  for (int step = 0; step <= steps_; ++step) {
    std::vector<std::string> defines;
    if (step == 0) defines.push_back("INJECT");
    if (step > 0 && lobes_ == VolumeLobes::Face) defines.push_back("FACES");
    const gl::Program& program = context_.programs.get({.defines = std::move(defines), .compute = "volume_step.comp"});
    program.use();
    program.set("cells", grid.cells);
    light_[(step + 1) % 2].bindStorage(0);
    light_[step % 2].bindStorage(1);
    gl::dispatch(groups, groups, groups);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT); // the next step, and reading back
  }
}

vec3 LightVolume::fluxOnItsWay() const {
  std::vector<vec4> cells(sights_.grid().size() * 4);
  light_[steps_ % 2].read(0, std::span(cells));
  dvec3 sum(0);
  for (size_t i = 0; i < cells.size(); i += 4) sum += dvec3(cells[i].x, cells[i + 1].x, cells[i + 2].x);
  return vec3(sum * double(kFluxOfBand0));
}

vec3 LightVolume::fluxDeposited() const {
  dvec3 sum(0);
  for (size_t i = 0; i < deposited_.size(); i += 3)
    sum += dvec3(deposited_[i].x, deposited_[i + 1].x, deposited_[i + 2].x);
  return vec3(sum * double(kFluxOfBand0));
}

} // namespace lambent
