#include "tools/content/scene_builder.h"

#include "engine/core/rng.h"

#include <glm/gtc/quaternion.hpp>

namespace lambent::content {

Index SceneBuilder::place(const std::string& name, Index mesh, const dvec3& at, double turn) {
  const glm::dquat rotation = turn == 0 ? glm::dquat(1, 0, 0, 0) : glm::angleAxis(glm::radians(turn), dvec3(0, 1, 0));
  return gltf.addNode({.name = name, .translation = at, .rotation = rotation, .mesh = mesh});
}

Index SceneBuilder::place(const std::string& name, const Geometry& geometry, Index material, const dvec3& at) {
  return place(name, gltf.addMesh(name, geometry, material), at);
}

Index SceneBuilder::lamp(const std::string& name, const dvec3& color, double intensity, const dvec3& at) {
  return gltf.addNode({.name = name, .translation = at, .light = gltf.addPointLight(name, color, intensity)});
}

Index SceneBuilder::spot(const std::string& name, const dvec3& color, double intensity, const dvec3& at,
                         const dvec3& direction) {
  return gltf.addNode({.name = name,
                       .translation = at,
                       .rotation = facing(direction),
                       .light = gltf.addSpotLight(name, color, intensity, 40, 45)});
}

void SceneBuilder::sun(const dvec3& direction, const dvec3& color, double irradiance) {
  gltf.addNode({.name = "sun",
                .translation = {0, 20, 0},
                .rotation = facing(direction),
                .light = gltf.addDirectionalLight("sun", color, irradiance)});
}

void SceneBuilder::camera(const std::string& name, const dvec3& eye, const dvec3& target, double fovYDegrees) {
  gltf.addNode({.name = name,
                .translation = eye,
                .rotation = facing(target - eye),
                .camera = gltf.addPerspectiveCamera(name, fovYDegrees)});
}

double hashed(uint32_t a, uint32_t b) { return double(mix64((uint64_t(b) << 32 | a) + 1) >> 11) * 0x1p-53; }

} // namespace lambent::content
