#include "gi/lighting/receivers.h"

#include "engine/core/sampling.h"
#include "engine/view/surface_point.h"
#include "shaders/shared/paraboloid.h"

#include <cmath>

namespace lambent {

namespace {

vec3 towardsViewerAt(const CameraView& camera, const vec3& position) {
  return camera.orthoHalfHeight > 0 ? vec3(camera.worldFromView[2]) : glm::normalize(camera.position() - position);
}

} // namespace

void applyNormalMap(const SceneView& view, SurfaceHit& hit) {
  hit.normal = mappedNormalAt(view, hit.instance, hit.primitive, hit.triangle, hit.barycentric, hit.normal,
                              towardsViewerAt(view.camera, hit.position));
}

Receiver receiverOf(const SceneView& view, const SurfaceHit& hit, const vec4& finish) {
  return makeReceiver(hit.normal, towardsViewerAt(view.camera, hit.position), hit.albedo, finish);
}

Receiver receiverOf(const SceneView& view, const SurfaceHit& hit) {
  return receiverOf(view, hit, finishAt(view, hit.instance, hit.primitive, hit.triangle, hit.barycentric));
}

vec3 reflectanceOf(const Receiver& receiver, const vec3& direction) {
  if (!(glm::dot(direction, receiver.normal) > 0)) return vec3(0);
  return receiver.diffuse / kPi + glossyReflectance(receiver, direction, 0);
}

vec3 sampleReflection(const Receiver& receiver, float uChoice, vec2 u) {
  if (uChoice < 0.5f) return sampleCosineHemisphere(receiver.normal, u);
  const float wide = receiver.alpha2 * u.x, all = 1 - u.x + wide; // tan² of the normal: wide / (1 − u.x)
  const float sine = std::sqrt(wide / all), phi = 2 * kPi * u.y;
  vec3 tangent, bitangent;
  basisAround(receiver.normal, tangent, bitangent);
  const vec3 half =
      (tangent * std::cos(phi) + bitangent * std::sin(phi)) * sine + receiver.normal * std::sqrt((1 - u.x) / all);
  return glm::normalize(2 * glm::dot(half, receiver.towardsViewer) * half - receiver.towardsViewer);
}

float pdfReflection(const Receiver& receiver, const vec3& direction) {
  const vec3 sum = direction + receiver.towardsViewer;
  const float length = glm::length(sum);
  float lobe = 0;
  if (length > 1e-6f) {
    // Of the two normals that mirror the one direction into the other, that on the surface's side is drawn. Its cosine
    // with either is half the length of their sum; dω_half/dω = 1/(4 cosine).
    const float cosHalf = std::min(std::abs(glm::dot(sum, receiver.normal)) / length, 1.0f);
    const vec3 across = glm::cross(receiver.normal, sum) / length;
    lobe = ggxDensity(receiver.alpha2, glm::dot(across, across), cosHalf * cosHalf) * cosHalf / (2 * length);
  }
  return 0.5f * (pdfCosineHemisphere(glm::dot(direction, receiver.normal)) + lobe);
}

vec3 sampleLobe(const Receiver& receiver, vec2 u) {
  vec3 tangent, bitangent;
  basisAround(receiver.normal, tangent, bitangent);
  const float alpha = std::sqrt(receiver.alpha2);
  const vec3 viewer(glm::dot(tangent, receiver.towardsViewer), glm::dot(bitangent, receiver.towardsViewer),
                    receiver.cosViewer);
  const vec3 stretched = glm::normalize(vec3(alpha * viewer.x, alpha * viewer.y, viewer.z));
  const float z = (1 - u.x) * (1 + stretched.z) - stretched.z, phi = 2 * kPi * u.y;
  const float sine = std::sqrt(std::max(0.0f, 1 - z * z));
  const vec3 cap = vec3(sine * std::cos(phi), sine * std::sin(phi), z) + stretched;
  const vec3 h = glm::normalize(vec3(alpha * cap.x, alpha * cap.y, std::max(cap.z, 0.0f)));
  const vec3 half = tangent * h.x + bitangent * h.y + receiver.normal * h.z;
  return glm::normalize(2 * glm::dot(half, receiver.towardsViewer) * half - receiver.towardsViewer);
}

float pdfLobe(const Receiver& receiver, const vec3& direction) {
  const vec3 sum = direction + receiver.towardsViewer;
  const float length2 = glm::dot(sum, sum), along = glm::dot(sum, receiver.normal);
  if (!(length2 > 1e-12f && along > 0)) return 0;
  const vec3 across = glm::cross(receiver.normal, sum);
  const float density = ggxDensity(receiver.alpha2, glm::dot(across, across) / length2, along * along / length2);
  const float c = receiver.cosViewer, a = receiver.alpha2;
  return density / (2 * (c + std::sqrt(c * c * (1 - a) + a)));
}

} // namespace lambent
