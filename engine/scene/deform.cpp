#include "engine/scene/deform.h"

#include "engine/core/parallel.h"
#include "engine/scene/scene.h"

#include <cmath>
#include <span>

namespace lambent {

namespace {

/// Vertices per block of parallel work: about 0.1 ms with four joints each.
constexpr size_t kGrain = 4096;

/// A matrix that flattens its object onto a plane or line cannot be inverted, and so gives no normals. Its lost axes
/// get back this share of the largest one: invisible, and well inside float precision.
constexpr float kFlattenedScale = 1e-5f;

/// Gives a flattened matrix its lost axes back. False when it still cannot be inverted: all axes lost, not finite, or
/// sheared flat; such instances are left out.
bool makeInvertible(mat4& m) {
  if (!isFinite(m)) return false;
  const float largest = glm::max(glm::length(vec3(m[0])), glm::max(glm::length(vec3(m[1])), glm::length(vec3(m[2]))));
  if (!(largest > 1e-12f)) return false;
  const float least = kFlattenedScale * largest;
  for (int c = 0; c < 3; ++c) { // axes of no length: along what the other two leave free
    if (glm::length(vec3(m[c])) >= least) continue;
    const vec3 a = vec3(m[(c + 1) % 3]), b = vec3(m[(c + 2) % 3]);
    vec3 free = glm::cross(a, b);
    if (!(glm::length(free) > least * least)) {
      const vec3 longer = glm::length(a) > glm::length(b) ? a : b;
      free = glm::cross(longer, std::abs(longer.x) < 0.5f * glm::length(longer) ? vec3(1, 0, 0) : vec3(0, 1, 0));
    }
    m[c] = vec4(least * glm::normalize(free), 0);
  }
  const float box = glm::length(vec3(m[0])) * glm::length(vec3(m[1])) * glm::length(vec3(m[2]));
  return std::abs(glm::determinant(mat3(m))) > 1e-6f * box; // else three axes in one plane: shear has flattened it
}

/// Inverse transpose up to a positive factor; defined also where there is no inverse.
mat3 normalMatrix(const mat3& m) {
  const mat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], cofactor[0]) < 0 ? -cofactor : cofactor;
}

/// Unit in the plane that the normal is now of; 0 stays 0, and has none.
vec4 tangentTo(const vec3& normal, const vec4& tangent) {
  const vec3 t(tangent);
  return vec4(unitOr(t - normal * glm::dot(normal, t), vec3(0)), tangent.w);
}

/// -1 where it turns left hands into right ones: a bitangent then is on the other side.
float sideOf(const mat3& m) { return glm::determinant(m) < 0 ? -1.0f : 1.0f; }

void morph(const Mesh& mesh, std::span<const float> weights, size_t begin, size_t end, DeformedMesh& out) {
  std::copy(mesh.positions.begin() + long(begin), mesh.positions.begin() + long(end),
            out.positions.begin() + long(begin));
  std::copy(mesh.normals.begin() + long(begin), mesh.normals.begin() + long(end), out.normals.begin() + long(begin));
  for (size_t t = 0; t < std::min(weights.size(), mesh.morphTargets.size()); ++t) {
    if (weights[t] == 0) continue;
    const MorphTarget& target = mesh.morphTargets[t];
    for (size_t i = begin; i < end && !target.positions.empty(); ++i)
      out.positions[i] += weights[t] * target.positions[i];
    for (size_t i = begin; i < end && !target.normals.empty(); ++i) out.normals[i] += weights[t] * target.normals[i];
  }
}

void skin(const Mesh& mesh, std::span<const mat4> objectFromBind, size_t begin, size_t end, DeformedMesh& out) {
  for (size_t i = begin; i < end; ++i) {
    mat4 blended(0);
    float total = 0;
    for (const JointSet& set : mesh.jointSets)
      for (int c = 0; c < 4; ++c) {
        const float weight = set.weights[i][c];
        if (!(weight > 0) || set.joints[i][c] >= objectFromBind.size()) continue;
        blended += weight * objectFromBind[set.joints[i][c]];
        total += weight;
      }
    if (!(total > 0)) continue;
    out.positions[i] = vec3(blended * vec4(out.positions[i], 1));
    if (!out.tangents.empty())
      out.tangents[i] = vec4(mat3(blended) * vec3(out.tangents[i]), out.tangents[i].w * sideOf(mat3(blended)));
    out.normals[i] = normalMatrix(mat3(blended)) * out.normals[i];
  }
}

} // namespace

std::optional<PlacedPose> poseOf(const Scene& scene, Entity entity, const MeshInstance& instance,
                                 const WorldTransform& world) {
  const Mesh& mesh = scene.assets.meshes[instance.mesh];
  PlacedPose out;
  const mat4 worldFromNode = scene.fromOrigin(placeFor(mesh, world.worldFromNode));
  out.worldFromObject = worldFromNode;
  const bool shown = makeInvertible(out.worldFromObject);
  const Skin* skin = mesh.jointSets.empty() ? nullptr : scene.registry.tryGet<Skin>(entity);
  if (!shown && !skin) return {};
  if (skin) {
    if (!shown || out.worldFromObject != worldFromNode) out.worldFromObject = mat4(1);
    const mat4 objectFromWorld = glm::inverse(out.worldFromObject);
    for (size_t j = 0; j < skin->joints.size(); ++j) {
      const auto* joint = scene.registry.tryGet<WorldTransform>(skin->joints[j]);
      mat4 matrix = joint ? objectFromWorld * scene.fromOrigin(joint->worldFromNode) * skin->jointFromBind[j] : mat4(1);
      // A joint that was destroyed, or flung beyond single precision, leaves its part where the node is.
      if (!isFinite(matrix)) matrix = mat4(1);
      out.pose.objectFromBind.push_back(matrix);
    }
  }
  if (const auto* morph = scene.registry.tryGet<MorphWeights>(entity); morph && !mesh.morphTargets.empty())
    for (const float weight : morph->weights) out.pose.morphWeights.push_back(std::isfinite(weight) ? weight : 0);
  return out;
}

void deform(const Mesh& mesh, const Pose& pose, DeformedMesh& out) {
  const size_t count = mesh.positions.size();
  out.positions.resize(count);
  out.normals.resize(count);
  out.tangents = mesh.tangents; // morph targets' own are left out
  parallelFor(count, kGrain, [&](size_t begin, size_t end) {
    morph(mesh, pose.morphWeights, begin, end, out);
    if (!pose.objectFromBind.empty()) skin(mesh, pose.objectFromBind, begin, end, out);
    for (size_t i = begin; i < end; ++i) {
      if (!isFinite(out.positions[i])) out.positions[i] = mesh.positions[i]; // keys beyond single precision
      out.normals[i] = unitOr(out.normals[i], mesh.normals[i]);
      if (!out.tangents.empty()) out.tangents[i] = tangentTo(out.normals[i], out.tangents[i]);
    }
  });
  out.boundsObject = {};
  out.primitiveBoundsObject.clear();
  for (const Primitive& primitive : mesh.primitives) {
    Aabb box;
    for (uint32_t t = 0; t < primitive.triangleCount; ++t) {
      const uvec3 v = mesh.triangles[primitive.firstTriangle + t];
      const vec3 p0 = out.positions[v.x], p1 = out.positions[v.y], p2 = out.positions[v.z];
      box.add(p0), box.add(p1), box.add(p2);
      if (!primitive.flat) continue;
      const vec3 face = unitOr(glm::cross(p1 - p0, p2 - p0), out.normals[v.x]);
      out.normals[v.x] = out.normals[v.y] = out.normals[v.z] = face;
    }
    out.primitiveBoundsObject.push_back(box);
    out.boundsObject.add(box);
  }
}

void forEachPosed(const Scene& scene, const std::function<void(const Mesh&, const DeformedMesh*, const mat4&)>& visit) {
  DeformedMesh deformed;
  scene.registry.each<MeshInstance, WorldTransform>([&](Entity e, const MeshInstance& m, const WorldTransform& w) {
    const Mesh& mesh = scene.assets.meshes[m.mesh];
    const std::optional<PlacedPose> placed = poseOf(scene, e, m, w);
    if (!placed) return;
    const bool posed = deforms(mesh, placed->pose);
    if (posed) deform(mesh, placed->pose, deformed);
    if (!isNear(transformed(posed ? deformed.boundsObject : mesh.boundsObject, placed->worldFromObject))) return;
    visit(mesh, posed ? &deformed : nullptr, placed->worldFromObject);
  });
}

} // namespace lambent
