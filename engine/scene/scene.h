// The scene: an ECS registry that owns everything that lives, and the assets it refers to. This header is the contents
// page of engine/scene, in data-flow order: load → animate → pose (deform.h) → extract.
#pragma once

#include "engine/ecs/registry.h"
#include "engine/scene/components.h"
#include "engine/scene/deform.h"
#include "engine/scene/file_access.h"
#include "engine/view/assets.h"
#include "engine/view/view_changes.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace lambent {

struct Scene {
  Registry registry;
  SceneAssets assets;
  std::vector<AnimationClip> animations; // from the file; all play, looped
  Sky sky;
  /// Origin of a scene that lies farther from its file's origin than 4 times its size: where its middle is, roughly;
  /// else zero. Transforms and what a person types are in the file's coordinates and double precision; cameras, views,
  /// boxes and all that follows count from here, so that single precision is as good there as at home. Whole steps of 8
  /// m, of less in scenes below half a metre, of 1000 m above 60 m.
  dvec3 origin{0};
  float rayWork = 0; // as in SceneView
  std::filesystem::path file;
  std::vector<std::filesystem::path> files; // all that were read: the one above, and those it names

  vec3 fromOrigin(const dvec3& position) const { return vec3(position - origin); }
  mat4 fromOrigin(const dmat4& worldFromNode) const {
    mat4 m(worldFromNode);
    m[3] = vec4(fromOrigin(dvec3(worldFromNode[3])), float(worldFromNode[3].w));
    return m;
  }
  std::vector<std::string> warnings; // one line each: what the file holds that is shown differently or left out
};

/// Called with what loading is at, and the share of it that is done, from any thread. May throw, which ends the
/// loading.
using LoadStep = std::function<void(const char* at, float share)>;

/// Reads .gltf/.glb. `sceneName` picks one of several scenes by name or index (empty: the file's default).
/// Throws InputError naming file, place and reason.
Scene loadScene(const std::filesystem::path& file, const std::string& sceneName = {}, const LoadStep& step = {},
                FileTrust trust = {});

/// Poses every animated node at `time` (seconds, clips loop) and updates world transforms down the hierarchy.
void animate(Scene& scene, double time);
/// Updates world transforms only: for callers that changed Transform components themselves.
void updateWorldTransforms(Scene& scene);

/// Adds a light that is not in the file; its position counts from the scene's origin, as those of views.
Entity addLight(Scene& scene, const LightView& light, const std::string& name);

/// Finds the node called `name`; nothing if there is none.
std::optional<Entity> findByName(const Scene& scene, const std::string& name);

/// The light of an entity as it stands at the present transforms; nothing where it has none, or is not near (isNear).
std::optional<LightView> lightOf(const Scene& scene, Entity entity);

/// Box around all mesh instances at their present transforms, from the scene's origin.
Aabb worldBounds(const Scene& scene);

/// Cameras of the file, by name, posed at the present transforms. `near` follows the file.
struct NamedCamera {
  std::string name;
  CameraView view;
};
std::vector<NamedCamera> sceneCameras(const Scene& scene);

/// View for a file without camera, in an image of that aspect: the whole scene from the front, a little to the right
/// and above, 50° vertical; inside and level when the scene encloses its middle, through the open side when it has just
/// one (see default_view.cpp for the rule). Looks at every triangle: up to about a second per million of them.
CameraView defaultView(const Scene& scene, float aspect = 16.0f / 9);

/// Finds Scene::origin for the present transforms.
void findOrigin(Scene& scene);

/// Height of the room that the scene encloses, metres: the middle one of those over the places inside that defaultView
/// tries and that have something above; nothing where there are none.
std::optional<float> roomHeight(const Scene& scene);

/// Makes the scene `factor` times as large, as if its file were told in another unit: places, lights' ranges, cameras.
/// Radiance stays, and so do lights' intensities. Poses it at time 0.
void rescale(Scene& scene, float factor);

/// Turns the registry into a SceneView; keeps what it needs to find what moved since its last call.
/// Spans stay valid until the next call.
class SceneExtractor {
 public:
  SceneView extract(const Scene& scene, const CameraView& camera, double time);

 private:
  struct Shape {
    uint32_t mesh = kNone;
    Pose pose;
    std::shared_ptr<DeformedMesh> deformed;
  };
  std::vector<InstanceView> placeInstances(const Scene& scene);

  std::unordered_map<uint32_t, Shape> shapes_; // by entity
  ViewChanges changes_;
};

} // namespace lambent
