#include "gi/library/surface_check.h"

#include "engine/gl/objects.h"
#include "gi/vpl/smc.h"

#include <cmath>

namespace lambent::library {

namespace {
constexpr int kAcross = 24;    // pixels looked at, along the image's longer side
constexpr float kNear = 0.05f; // of the distance: coarse stand-ins pass
constexpr size_t kEnough = 20; // pixels that see something
constexpr float kAlike = 0.7f; // cosine between normals
} // namespace

std::string checkSurfaces(const GBuffer& surfaces, CameraView camera, const RayQuery& rays) {
  camera.throughBlended = true;
  const int width = camera.width, height = camera.height, step = std::max(1, std::max(width, height) / kAcross);
  std::vector<vec2> centres;
  std::vector<size_t> pixels; // rows from the bottom
  for (int y = step / 2; y < height; y += step)
    for (int x = step / 2; x < width; x += step) {
      centres.push_back((vec2(x, y) + 0.5f) / vec2(width, height));
      pixels.push_back(size_t(height - 1 - y) * size_t(width) + size_t(x));
    }
  std::vector<float> depth(size_t(width) * size_t(height));
  std::vector<vec4> normal(depth.size());
  surfaces.depth->read(std::span(depth), GL_DEPTH_COMPONENT, GL_FLOAT);
  surfaces.normal->read(std::span(normal), GL_RGBA, GL_FLOAT);
  size_t seen = 0, there = 0, facing = 0;
  const std::vector<SurfaceHit> hits = surfacesAt(rays, camera, centres);
  for (size_t i = 0; i < hits.size(); ++i) {
    const float stored = depth[pixels[i]];
    if (!hits[i].valid() && stored == 0) continue;
    ++seen;
    if (!hits[i].valid() || stored == 0) continue;
    const float distance = glm::dot(hits[i].position - camera.position(), -vec3(camera.worldFromView[2]));
    if (!(std::abs(viewDistanceFromDepth(surfaces.block, stored) - distance) <= kNear * distance)) continue;
    ++there;
    facing += glm::dot(vec3(normal[pixels[i]]), hits[i].normal) > kAlike;
  }
  const auto share = [](size_t part, size_t of) { return std::to_string(100 * part / of) + " % of the pixels"; };
  if (seen >= kEnough && 2 * there < seen)
    return "only " + share(there, seen) +
           " lie where the scene that was told has a surface (is it all told? "
           "back_hidden, world_from_view, fov_y, near_plane, far_plane, depth_type, origin_top)";
  if (there >= kEnough && 2 * facing < there)
    return "only " + share(facing, there) +
           " have normals like those of the scene that was told (normal_type, normal_space)";
  return {};
}

} // namespace lambent::library
