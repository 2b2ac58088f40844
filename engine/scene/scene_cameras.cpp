// The cameras of a file.

#include "engine/scene/scene.h"

#include <cmath>

namespace lambent {

std::vector<NamedCamera> sceneCameras(const Scene& scene) {
  std::vector<NamedCamera> cameras;
  scene.registry.each<CameraLens, WorldTransform>([&](Entity e, const CameraLens& lens, const WorldTransform& w) {
    NamedCamera named;
    const Name* name = scene.registry.tryGet<Name>(e);
    named.name = name && !name->value.empty() ? name->value : "camera " + std::to_string(cameras.size());
    // A node's scale and mirroring do not apply to its camera: keep -Z and the side of +Y, drop the rest.
    const auto unit = [](const dvec3& v) { // in doubles: nodes may be as large as single precision goes
      const double length = glm::length(v);
      return length > 0 && std::isfinite(length) ? vec3(v / length) : vec3(0);
    };
    vec3 back = unit(dvec3(w.worldFromNode[2])), up = unit(dvec3(w.worldFromNode[1]));
    if (back == vec3(0)) back = vec3(0, 0, 1);
    up -= back * glm::dot(back, up);
    const mat3 rotation = glm::length(up) > 1e-6f ? mat3(glm::cross(glm::normalize(up), back), glm::normalize(up), back)
                                                  : glm::mat3_cast(rotationTowards(-back));
    named.view.worldFromView = mat4(rotation);
    named.view.worldFromView[3] = vec4(scene.fromOrigin(dvec3(w.worldFromNode[3])), 1);
    named.view.fovY = lens.fovY;
    named.view.orthoHalfHeight = lens.orthoHalfHeight;
    named.view.near = lens.near;
    cameras.push_back(named);
  });
  return cameras;
}

} // namespace lambent
