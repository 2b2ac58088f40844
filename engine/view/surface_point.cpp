#include "engine/view/surface_point.h"

#include "engine/core/error.h"
#include "shaders/shared/coverage.h"
#include "shaders/shared/normal_map.h"

namespace lambent {

vec4 baseColourAt(const SceneAssets& assets, const Mesh& mesh, const Material& material, const TrianglePlace& place,
                  const vec4* mean) {
  vec4 colour(material.baseColor, material.alpha);
  if (mean)
    colour *= *mean;
  else if (material.baseColorTexture.image != kNone)
    colour *= sampleTexture(assets, material.baseColorTexture, uvAt(mesh, place, material.baseColorTexture));
  if (!mesh.colors.empty()) colour *= place.interpolate(mesh.colors);
  return colour;
}

float alphaAt(const SceneAssets& assets, const Mesh& mesh, const Material& material, const TrianglePlace& place) {
  float alpha = material.alpha;
  if (material.baseColorTexture.image != kNone)
    alpha *= sampleAlpha(assets, material.baseColorTexture, uvAt(mesh, place, material.baseColorTexture));
  if (!mesh.colors.empty()) alpha *= place.interpolate(mesh.colors).w;
  return alpha;
}

bool isThere(const Material& material, float alpha, uint32_t key, uint32_t instance, uint32_t triangle) {
  if (material.alphaMode == AlphaMode::Mask) return alpha >= material.alphaCutoff;
  return material.alphaMode == AlphaMode::Opaque || isCovered(alpha, key, instance, triangle);
}

float shareThere(const Material& material, float alpha) {
  if (material.alphaMode == AlphaMode::Mask) return alpha >= material.alphaCutoff ? 1.0f : 0.0f;
  return material.alphaMode == AlphaMode::Opaque ? 1.0f : shareCovered(alpha);
}

SurfacePoint surfacePoint(const SceneView& view, uint32_t instanceIndex, uint32_t primitiveIndex, uint32_t triangle,
                          vec2 barycentric) {
  CHECK_LT(instanceIndex, view.instances.size());
  const InstanceView& instance = view.instances[instanceIndex];
  const Mesh& mesh = view.assets->meshes[instance.mesh];
  CHECK_LT(primitiveIndex, mesh.primitives.size());
  CHECK_LT(triangle, mesh.primitives[primitiveIndex].triangleCount);
  const TrianglePlace place = trianglePlace(mesh, mesh.primitives[primitiveIndex], triangle, barycentric);
  const uvec3& corners = place.vertices;
  const std::vector<vec3>& positions = instance.deformed ? instance.deformed->positions : mesh.positions;
  const std::vector<vec3>& normals = instance.deformed ? instance.deformed->normals : mesh.normals;
  const mat3 normalFromObject = glm::transpose(glm::inverse(mat3(instance.worldFromObject)));
  const auto unit = [](const vec3& v, const vec3& otherwise) {
    const float length = glm::length(v);
    return length > 0 ? v / length : otherwise;
  };
  const vec3 p0 = positions[corners.x];
  SurfacePoint point;
  point.position = vec3(instance.worldFromObject * vec4(place.interpolate(positions), 1));
  point.geometricNormal =
      unit(normalFromObject * glm::cross(positions[corners.y] - p0, positions[corners.z] - p0), vec3(0));
  point.normal = unit(normalFromObject * place.interpolate(normals), point.geometricNormal);
  return point;
}

vec3 mappedNormalAt(const SceneView& view, uint32_t instanceIndex, uint32_t primitiveIndex, uint32_t triangle,
                    vec2 barycentric, const vec3& normal, const vec3& towardsViewer) {
  CHECK_LT(instanceIndex, view.instances.size());
  const InstanceView& instance = view.instances[instanceIndex];
  const Mesh& mesh = view.assets->meshes[instance.mesh];
  CHECK_LT(primitiveIndex, mesh.primitives.size());
  const Primitive& primitive = mesh.primitives[primitiveIndex];
  const Material& material = view.assets->materials[primitive.material];
  if (material.normalTexture.image == kNone || mesh.tangents.empty()) return normal;
  CHECK_LT(triangle, primitive.triangleCount);
  const TrianglePlace place = trianglePlace(mesh, primitive, triangle, barycentric);
  const DeformedMesh* shape = instance.deformed.get();
  const bool shaped = shape && shape->tangents.size() == mesh.tangents.size();
  const vec4 tangent = place.interpolate(shaped ? shape->tangents : mesh.tangents);
  if (vec3(tangent) == vec3(0)) return normal;
  const std::vector<vec3>& positions = shape ? shape->positions : mesh.positions;
  const vec3 p0 = positions[place.vertices.x];
  const mat3 worldFromObject(instance.worldFromObject);
  const mat3 normalFromObject = glm::transpose(glm::inverse(worldFromObject));
  const vec3 front = normalFromObject * glm::cross(positions[place.vertices.y] - p0, positions[place.vertices.z] - p0);
  const vec3 smooth = normalFromObject * place.interpolate(shape ? shape->normals : mesh.normals);
  const float side = (tangent.w < 0) == (glm::determinant(worldFromObject) < 0) ? 1.0f : -1.0f;
  const vec3 texel(sampleTexture(*view.assets, material.normalTexture, uvAt(mesh, place, material.normalTexture)));
  const vec3 mapped = mappedNormal(smooth, worldFromObject * vec3(tangent), side, texel, material.normalScale);
  // Normals may oppose the triangle's winding: theirs is the side that is shown.
  const bool behind = glm::dot(front, towardsViewer) < 0, turned = behind != (glm::dot(front, smooth) < 0);
  const vec3 facing = facingViewer(turned ? -mapped : mapped, towardsViewer);
  if (!(material.metalness > 0)) return facing;
  const vec3 geometric = glm::normalize(behind ? -front : front);
  const float metalness = finishAt(view, instanceIndex, primitiveIndex, triangle, barycentric).y;
  return mirroringOutwards(facing, geometric, towardsViewer, metalness);
}

vec4 finishAt(const SceneView& view, uint32_t instance, uint32_t primitiveIndex, uint32_t triangle, vec2 barycentric) {
  CHECK_LT(instance, view.instances.size());
  const Mesh& mesh = view.assets->meshes[view.instances[instance].mesh];
  CHECK_LT(primitiveIndex, mesh.primitives.size());
  const Primitive& primitive = mesh.primitives[primitiveIndex];
  const Material& material = view.assets->materials[primitive.material];
  vec4 finish(material.roughness, material.metalness, material.dielectricF0, material.dielectricLobe);
  if (material.roughnessMetalnessTexture.image == kNone) return finish;
  CHECK_LT(triangle, primitive.triangleCount);
  const vec2 uv = uvAt(mesh, trianglePlace(mesh, primitive, triangle, barycentric), material.roughnessMetalnessTexture);
  const vec4 texel = sampleTexture(*view.assets, material.roughnessMetalnessTexture, uv);
  finish.x *= texel.y;
  finish.y *= texel.z;
  return finish;
}

} // namespace lambent
