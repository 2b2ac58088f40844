#include "gi/sources/packed_lights.h"

#include "shaders/shared/paraboloid.h"

#include <cstring>

namespace lambent {

namespace {

const VplLight kNoLight{vec4(0), vec4(0), vec4(0), vec4(0)};

} // namespace

uint32_t lightOrder(uint32_t slot) {
  return slot / kLightsPerChunk * kLightsPerChunk + slot % kLightClasses * kLightsPerClass +
         slot % kLightsPerChunk / kLightClasses;
}

VplLight pack(const VirtualLight& light) {
  const vec3 power = light.radiance * light.area;
  // A light that is empty, black or not a number must not reach the loop: one NaN there blackens a whole subset.
  if (!light.alive || !(light.area > 0) || !(maxComponent(power) > 0) || !isFinite(power) ||
      !isFinite(light.position) || !isFinite(light.normal))
    return kNoLight;
  vec3 tangent, bitangent;
  basisAround(light.normal, tangent, bitangent);
  return {vec4(light.position, light.area), vec4(power, light.normal.x), vec4(tangent, light.normal.y),
          vec4(bitangent, light.normal.z)};
}

VirtualLight unpack(const VplLight& packed) {
  VirtualLight light;
  if (!(packed.positionArea.w > 0)) return light;
  light.position = vec3(packed.positionArea);
  light.normal = light.geometricNormal =
      vec3(packed.powerNormalX.w, packed.tangentNormalY.w, packed.bitangentNormalZ.w);
  light.area = packed.positionArea.w;
  light.radiance = vec3(packed.powerNormalX) / light.area;
  light.alive = true;
  return light;
}

PackedLights PackedLightBuffer::run(std::span<const VirtualLight> slots) {
  const gl::PassScope scope = context_.scope(stage_);
  const size_t chunks = std::max<size_t>(1, (slots.size() + kLightsPerChunk - 1) / kLightsPerChunk);
  const bool fresh = mirror_.size() != chunks * kLightsPerChunk;
  if (fresh) mirror_.assign(chunks * kLightsPerChunk, kNoLight);
  uploaded_ = 0;
  std::vector<bool> dirtyChunks(chunks);
  const auto put = [&](uint32_t slot, const VplLight& light) {
    VplLight& held = mirror_[lightOrder(slot)];
    if (std::memcmp(&held, &light, sizeof light) == 0) return;
    held = light;
    dirtyChunks[slot / kLightsPerChunk] = true;
    ++uploaded_;
  };
  for (uint32_t i = 0; i < slots.size(); ++i) put(i, pack(slots[i]));
  for (uint32_t i = uint32_t(slots.size()); i < count_ && i < mirror_.size(); ++i) put(i, kNoLight);
  count_ = uint32_t(slots.size());

  constexpr uint64_t kBytes = kLightsPerChunk * sizeof(VplLight);
  if (fresh) {
    buffer_ = gl::Buffer::of<VplLight>(std::string(key(stage_).name) + "/lights", mirror_);
    return {&buffer_, count_};
  }
  // Copied into a buffer that stays: most chunks do not change, and every fragment of the gather reads them all, so
  // they belong in the GPU's own memory. Whole chunks of 128 KiB: one transfer costs less than many small ones.
  changes_.reserve(chunks * kBytes);
  for (size_t chunk = 0; chunk < chunks; ++chunk)
    if (dirtyChunks[chunk]) changes_.upload(buffer_, chunk * kBytes, kBytes, &mirror_[chunk * kLightsPerChunk]);
  return {&buffer_, count_};
}

} // namespace lambent
