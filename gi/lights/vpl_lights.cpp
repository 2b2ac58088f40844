// VPLs as the gather reads them: uniform-block chunks ordered by interleaving class.
#include "engine/core/error.h"
#include "gi/contract/passes.h"
#include "shaders/shared/paraboloid.h"

#include <cstring>

namespace lambent {

namespace {

const VplLight kNoLight{vec4(0), vec4(0), vec4(0), vec4(0)};
constexpr uint32_t kChunk = kLightClasses * kLightsPerClass;

VplLight packLight(const vec3& position, const vec3& normal, const vec3& radiance, float area) {
  const vec3 power = radiance * area;
  // A light that is empty, black or not a number must not reach the loop: one NaN there blackens a whole subset.
  if (!(area > 0) || !(maxComponent(power) > 0) || !isFinite(power) || !isFinite(position) || !isFinite(normal))
    return kNoLight;
  vec3 tangent, bitangent;
  basisAround(normal, tangent, bitangent);
  return {vec4(position, area), vec4(power, normal.x), vec4(tangent, normal.y), vec4(bitangent, normal.z)};
}

} // namespace

uint32_t lightOrder(uint32_t slot) {
  return slot / kChunk * kChunk + slot % kLightClasses * kLightsPerClass + slot % kChunk / kLightClasses;
}

VplLight vplLight(const Vpl& vpl) {
  return packLight(vpl.position, vpl.normal, vpl.radiance, vpl.alive ? vpl.area : 0.0f);
}

Vpl vplOf(const VplLight& light) {
  Vpl vpl;
  if (!(light.positionArea.w > 0)) return vpl;
  vpl.position = vec3(light.positionArea);
  vpl.normal = vpl.geometricNormal = vec3(light.powerNormalX.w, light.tangentNormalY.w, light.bitangentNormalZ.w);
  vpl.area = light.positionArea.w;
  vpl.radiance = vec3(light.powerNormalX) / vpl.area;
  vpl.alive = vpl.valid = true;
  return vpl;
}

VplLight emitterLight(const EmitterPatch& patch) {
  return packLight(patch.position, patch.normal, patch.radiance, patch.area);
}

MapPose emitterPose(const EmitterPatch& patch) { return {patch.position, patch.normal, patch.normal}; }

VplLights VplLightBuffer::run(std::span<const VplLight> slots) {
  const gl::PassScope scope = context_.scope(stage_);
  const size_t chunks = std::max<size_t>(1, (slots.size() + kChunk - 1) / kChunk);
  const bool fresh = mirror_.size() != chunks * kChunk;
  if (fresh) mirror_.assign(chunks * kChunk, kNoLight);
  uploaded_ = 0;
  std::vector<bool> dirtyChunks(chunks, fresh);
  const auto put = [&](uint32_t slot, const VplLight& light) {
    VplLight& held = mirror_[lightOrder(slot)];
    if (std::memcmp(&held, &light, sizeof light) == 0) return;
    held = light;
    dirtyChunks[slot / kChunk] = true;
    ++uploaded_;
  };
  for (uint32_t i = 0; i < slots.size(); ++i) put(i, slots[i]);
  for (uint32_t i = uint32_t(slots.size()); i < count_ && i < mirror_.size(); ++i) put(i, kNoLight);
  count_ = uint32_t(slots.size());

  if (fresh)
    buffer_ = gl::Buffer(std::string(key(stage_).name) + "/lights", mirror_.size() * sizeof(VplLight), nullptr);
  // Whole chunks of 128 KiB: one transfer costs less than many small ones.
  for (size_t chunk = 0; chunk < chunks; ++chunk)
    if (dirtyChunks[chunk])
      buffer_.write(chunk * kChunk * sizeof(VplLight), kChunk * sizeof(VplLight), &mirror_[chunk * kChunk]);
  return {&buffer_, count_};
}

} // namespace lambent
