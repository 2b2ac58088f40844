#include "engine/trace/surface_hit.h"

#include "engine/view/surface_point.h"

namespace lambent {

SurfaceHit surfaceAt(const SceneAssets& assets, const TracedInstance& instance, const TriangleMet& met, const Ray& ray,
                     bool textures, uint64_t& lookups) {
  const Mesh& mesh = instance.mesh;
  const Primitive& primitive = mesh.primitives[met.primitive];
  const Material& material = assets.materials[primitive.material];
  const TrianglePlace c = trianglePlace(mesh, primitive, met.triangle, met.barycentric);
  const vec3 p0 = instance.positions[c.vertices.x];
  const vec3 front = instance.normalFromObject *
                     glm::cross(instance.positions[c.vertices.y] - p0, instance.positions[c.vertices.z] - p0);
  const float length = glm::length(front);
  SurfaceHit hit;
  if (!(length > 0)) return hit;
  const bool fromFront = glm::dot(front, ray.direction) < 0;
  hit.t = met.t;
  hit.position = ray.origin + ray.direction * hit.t;
  hit.geometricNormal = front * ((fromFront ? 1.0f : -1.0f) / length);
  const vec3 shading = instance.normalFromObject * c.interpolate(instance.normals) * (fromFront ? 1.0f : -1.0f);
  const float shadingLength = glm::length(shading);
  // A shading normal that looks away from the ray would light the surface from behind.
  hit.normal =
      shadingLength > 0 && glm::dot(shading, ray.direction) < 0 ? shading / shadingLength : hit.geometricNormal;
  const bool textured = material.baseColorTexture.image != kNone;
  const vec4* mean = textured && !textures ? &assets.images[material.baseColorTexture.image].averageLinear : nullptr;
  lookups += textured && !mean;
  const vec4 baseColour = baseColourAt(assets, mesh, material, c, mean);
  hit.albedo = glm::clamp(vec3(baseColour), 0.0f, 1.0f);
  if (material.blends()) hit.share = shareThere(material, baseColour.w);
  if (material.emits() && (fromFront || material.doubleSided))
    hit.emission = material.emission *
                   vec3(sampleTexture(assets, material.emissiveTexture, uvAt(mesh, c, material.emissiveTexture)));
  hit.instance = met.instance;
  hit.primitive = met.primitive;
  hit.triangle = met.triangle;
  hit.barycentric = met.barycentric;
  return hit;
}

} // namespace lambent
