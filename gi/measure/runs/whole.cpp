#include "gi/measure/runs/runs.h"

#include <cmath>

namespace lambent {

namespace {

std::string textOf(const vec3& v) {
  return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

bool isLight(const vec3& v) { return isFinite(v) && v.x >= 0 && v.y >= 0 && v.z >= 0; }
bool isShare(const vec3& v) { return isLight(v) && v.x <= 1 && v.y <= 1 && v.z <= 1; }

} // namespace

std::string defectOf(const Viewer& gi, const Settings& settings) {
  constexpr Buffer kLight[] = {Buffer::Beauty, Buffer::Direct, Buffer::Emission};
  const auto look = [&](Buffer buffer, bool (*holds)(const vec3&)) -> std::string {
    const Image image = gi.read(buffer);
    for (size_t i = 0; i < image.pixels.size(); ++i)
      if (!holds(image.pixels[i]))
        return bufferNames()[size_t(buffer)] + ", pixel " + std::to_string(i % size_t(image.width)) + " " +
               std::to_string(i / size_t(image.width)) + ": " + textOf(image.pixels[i]);
    return {};
  };
  for (const Buffer buffer : kLight)
    if (const std::string defect = look(buffer, isLight); !defect.empty()) return defect;
  if (const std::string defect = look(Buffer::Albedo, isShare); !defect.empty()) return defect;
  for (const Buffer buffer : {Buffer::Indirect, Buffer::Irradiance, Buffer::Unfiltered, Buffer::Normal, Buffer::Depth})
    if (const std::string defect = look(buffer, isFinite); !defect.empty()) return defect;
  const VplSet& set = gi.vpls();
  if (set.slots.size() > size_t(settings.smc.vpls))
    return std::to_string(set.slots.size()) + " virtual lights of " + std::to_string(settings.smc.vpls);
  for (const Vpl& v : set.slots) {
    if (!v.alive) continue;
    if (!isFinite(v.position) || !isLight(v.radiance) || !(v.area >= 0) || !std::isfinite(v.area) ||
        !(std::abs(glm::length(v.normal) - 1) < 1e-3f))
      return "virtual light " + std::to_string(v.id) + " at " + textOf(v.position) + ": radiance " +
             textOf(v.radiance) + ", area " + std::to_string(v.area) + ", normal " + textOf(v.normal);
  }
  return {};
}

} // namespace lambent
