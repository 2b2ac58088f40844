// Camera maths: rays, projection, placement.

#include "engine/view/scene_view.h"

#include <algorithm>
#include <cmath>

namespace lambent {

CameraRay cameraRay(const CameraView& camera, float u, float v) {
  const float x = (2 * u - 1) * camera.aspect(), y = 1 - 2 * v;
  const mat3 rotation(camera.worldFromView);
  if (camera.orthoHalfHeight > 0)
    return {camera.position() + rotation * (camera.orthoHalfHeight * vec3(x, y, 0)), rotation * vec3(0, 0, -1)};
  const float halfHeight = std::tan(0.5f * camera.fovY);
  return {camera.position(), glm::normalize(rotation * vec3(x * halfHeight, y * halfHeight, -1))};
}

CameraView CameraView::scaled(float side) const {
  CameraView camera = *this;
  camera.width = std::max(1, int(std::lround(float(width) * side)));
  camera.height = std::max(1, int(std::lround(float(height) * side)));
  return camera;
}

mat4 clipFromView(const CameraView& camera, float orthoFar) {
  mat4 m(0);
  if (camera.orthoHalfHeight > 0) {
    const float span = orthoFar - camera.near;
    m[0][0] = 1 / (camera.orthoHalfHeight * camera.aspect());
    m[1][1] = 1 / camera.orthoHalfHeight;
    m[2][2] = 1 / span;
    m[3][2] = orthoFar / span;
    m[3][3] = 1;
  } else {
    const float focal = 1 / std::tan(0.5f * camera.fovY);
    m[0][0] = focal / camera.aspect();
    m[1][1] = focal;
    m[3][2] = camera.near;
    m[2][3] = -1;
  }
  return m;
}

quat rotationTowards(const vec3& direction) {
  const float length = glm::length(direction);
  if (!(length > 0) || !std::isfinite(length)) return {1, 0, 0, 0};
  const vec3 back = -direction / length;
  // Straight up or down +Y says nothing about the roll; world -Z is then taken as up (+Z when looking up), so that
  // tilting a level camera by 90° ends there.
  const vec3 up = std::abs(back.y) < 0.99999f ? vec3(0, 1, 0) : vec3(0, 0, back.y > 0 ? -1 : 1);
  const vec3 right = glm::normalize(glm::cross(up, back));
  return glm::normalize(glm::quat_cast(mat3(right, glm::cross(back, right), back)));
}

CameraView lookAt(const vec3& eye, const vec3& target, float fovY) {
  CameraView camera;
  camera.worldFromView = glm::mat4_cast(rotationTowards(target - eye));
  camera.worldFromView[3] = vec4(eye, 1);
  camera.fovY = fovY;
  return camera;
}

} // namespace lambent
