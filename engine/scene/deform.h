// Skinning and morphing on the CPU: the one place that knows how joints and weights shape a mesh. Rays, raster and
// emitters all read its result, so that they see the same surface.
#pragma once

#include "engine/scene/components.h"

#include <functional>
#include <optional>
#include <vector>

namespace lambent {

struct Scene;

/// What the shape of one instance depends on.
struct Pose {
  std::vector<mat4> objectFromBind; // per joint; empty: not skinned
  std::vector<float> morphWeights;  // per target; empty: not morphed
  bool operator==(const Pose&) const = default;
};

/// Where the entity's mesh stands and how it is posed. Object space is the node's own, as for rigid instances, although
/// joints place a skinned mesh without regard to that node: front sides then turn with a mirrored node as everywhere
/// else, and whoever multiplies by worldFromObject need not know of skins. Only where the node's matrix is no good for
/// that (not invertible) a skinned mesh is posed in world space.
struct PlacedPose {
  mat4 worldFromObject{1};
  Pose pose;
};
/// Nothing when the instance cannot be shown: a rigid one scaled to a point, or not finite.
std::optional<PlacedPose> poseOf(const Scene& scene, Entity entity, const MeshInstance& instance,
                                 const WorldTransform& world);

/// Whether a pose can make the mesh differ from its own vertices.
inline bool deforms(const Mesh& mesh, const Pose& pose) {
  return (!pose.objectFromBind.empty() && !mesh.jointSets.empty()) ||
         (!pose.morphWeights.empty() && !mesh.morphTargets.empty());
}

/// Vertices of `mesh` in `pose` (all of `out` but its revision): first morphed, then blended linearly between joints
/// (glTF 2.0, 3.7.2.2 and 3.7.3). Large meshes are worked on in parallel.
void deform(const Mesh& mesh, const Pose& pose, DeformedMesh& out);

/// Visits every instance as it stands now; `deformed` is null where it is rigid. For questions asked outside a frame.
void forEachPosed(
    const Scene& scene,
    const std::function<void(const Mesh&, const DeformedMesh* deformed, const mat4& worldFromObject)>& visit);

} // namespace lambent
