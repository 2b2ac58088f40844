// glTF nodes to entities, and the importer's entry point.

#include "engine/scene/gltf_import.h"
#include "engine/scene/ray_work.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <set>

namespace lambent {

namespace gltf {

namespace {

/// Replaces a matrix by translation, rotation and scale where these say the same; a sheared one stays.
void decompose(Transform& t) {
  if (!t.matrix) return;
  const mat4 m(*t.matrix);
  Transform parts;
  parts.translation = dvec3((*t.matrix)[3]);
  for (int c = 0; c < 3; ++c) parts.scale[c] = glm::length(vec3(m[c]));
  if (!(glm::min(parts.scale.x, glm::min(parts.scale.y, parts.scale.z)) > 0)) return;
  if (glm::determinant(mat3(m)) < 0) parts.scale.x = -parts.scale.x;
  parts.rotation = glm::normalize(
      glm::quat_cast(mat3(vec3(m[0]) / parts.scale.x, vec3(m[1]) / parts.scale.y, vec3(m[2]) / parts.scale.z)));
  const mat4 again(parts.local());
  for (int c = 0; c < 3; ++c)
    if (glm::length(again[c] - m[c]) > 1e-5f * glm::length(m[c])) return;
  t = parts;
}

std::vector<int> rootsOf(const Document& doc, int scene) {
  if (scene >= 0) return doc.model.scenes[size_t(scene)].nodes;
  // A file without scenes is a library of nodes; those without a parent are shown.
  std::vector<bool> isChild(doc.model.nodes.size(), false);
  for (const tinygltf::Node& n : doc.model.nodes)
    for (const int c : n.children)
      if (c >= 0 && size_t(c) < isChild.size()) isChild[size_t(c)] = true;
  std::vector<int> roots;
  for (size_t i = 0; i < doc.model.nodes.size(); ++i)
    if (!isChild[i]) roots.push_back(int(i));
  return roots;
}

/// Nodes without a name have that of what they hold.
void nameAfter(Import& import, Entity e, const tinygltf::Node& node, const std::string& name) {
  if (node.name.empty() && !name.empty()) import.scene.registry.emplace<Name>(e, name);
}

void addCamera(Import& import, Entity e, const tinygltf::Node& node, const std::string& place) {
  import.scene.registry.emplace<CameraLens>(e, import.doc.at(import.doc.lenses, node.camera, "camera", place));
  nameAfter(import, e, node, import.doc.model.cameras[size_t(node.camera)].name);
}

void addPunctual(Import& import, Entity e, const tinygltf::Node& node, const std::string& place) {
  const auto extension = node.extensions.find("KHR_lights_punctual");
  const int index = extension == node.extensions.end() ? -1 : int(number(extension->second, "light", -1));
  if (index < 0) return;
  PunctualLight light = import.doc.at(import.doc.lights, index, "light", place);
  const tinygltf::Light& in = import.doc.model.lights[size_t(index)];
  if (in.type == "point") {
    light.type = LightType::Point;
  } else if (in.type == "spot") {
    light.type = LightType::Spot;
  } else if (in.type == "directional") {
    light.type = LightType::Directional;
  } else {
    import.doc.warn(place + ": light type '" + in.type + "' is not one of glTF's; left out");
    return;
  }
  import.scene.registry.emplace<PunctualLight>(e, light);
  nameAfter(import, e, node, in.name);
}

/// What light paths keep of a triangle that shines, for each instance of its mesh.
constexpr size_t kBytesPerEmitter = 96;

size_t emittingTriangles(const SceneAssets& assets, uint32_t mesh) {
  size_t count = 0;
  for (const Primitive& p : assets.meshes[mesh].primitives)
    if (assets.materials[p.material].emits()) count += p.triangleCount;
  return count;
}

/// What an instance takes in the registry, in the view and in what follows both: 680 000 took 1.4 GB.
constexpr size_t kBytesPerInstance = 2048;

/// Transforms of the instances that a node has of its mesh, in its space; none where the node itself is the only one.
/// EXT_mesh_gpu_instancing.
std::optional<std::vector<Transform>> instancesOf(const Document& doc, const tinygltf::Node& node,
                                                  const std::string& outerPlace) {
  const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
  if (extension == node.extensions.end() || !extension->second.IsObject() || !extension->second.Has("attributes"))
    return {};
  const std::string place = outerPlace + ", EXT_mesh_gpu_instancing";
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  std::optional<size_t> count;
  const auto accessorOf = [&](const char* name) {
    const int accessor = int(number(attributes, name, -1));
    if (accessor < 0) return -1;
    const size_t elements = doc.at(doc.model.accessors, accessor, "accessor", place).count;
    if (count && *count != elements)
      doc.fail(place, std::string(name) + " has " + std::to_string(elements) + " elements, the attribute before it " +
                          std::to_string(*count));
    count = elements;
    return accessor;
  };
  const int translations = accessorOf("TRANSLATION"), rotations = accessorOf("ROTATION"), scales = accessorOf("SCALE");
  if (!count) return {};
  doc.spend(*count, kBytesPerInstance, place);
  std::vector<Transform> instances(*count);
  const auto check = [&](bool finite, const char* what) {
    if (!finite) doc.fail(place, std::string(what) + " holds a number that is not finite");
  };
  if (translations >= 0) {
    const std::vector<vec3> values = readAccessor<vec3>(doc, translations, place + ", TRANSLATION");
    for (size_t i = 0; i < *count; ++i) check(isFinite(values[i]), "TRANSLATION"), instances[i].translation = values[i];
  }
  if (rotations >= 0) {
    const std::vector<vec4> values = readAccessor<vec4>(doc, rotations, place + ", ROTATION");
    for (size_t i = 0; i < *count; ++i) {
      const float length = glm::length(values[i]);
      check(std::isfinite(length) && length > 1e-12f, "ROTATION");
      instances[i].rotation = quat(values[i].w, values[i].x, values[i].y, values[i].z) / length;
    }
  }
  if (scales >= 0) {
    const std::vector<vec3> values = readAccessor<vec3>(doc, scales, place + ", SCALE");
    for (size_t i = 0; i < *count; ++i) check(isFinite(values[i]), "SCALE"), instances[i].scale = values[i];
  }
  return instances;
}

} // namespace

int sceneOf(const Document& doc, const std::string& name) {
  const std::vector<tinygltf::Scene>& scenes = doc.model.scenes;
  if (!name.empty()) {
    std::string known;
    for (size_t i = 0; i < scenes.size(); ++i) {
      if (scenes[i].name == name || std::to_string(i) == name) return int(i);
      known += (i == 0 ? "" : ", ") + (scenes[i].name.empty() ? std::to_string(i) : scenes[i].name);
    }
    throw InputError(doc.file.string(),
                     "has no scene '" + name + "' (it has: " + (known.empty() ? "none" : known) + ")");
  }
  if (doc.model.defaultScene >= 0) {
    doc.checkIndex(doc.model.defaultScene, scenes.size(), "scene", "default scene");
    return doc.model.defaultScene;
  }
  return scenes.empty() ? -1 : 0;
}

void importNodes(Import& import, int scene) {
  Document& doc = import.doc;
  Registry& registry = import.scene.registry;
  import.entities.assign(doc.model.nodes.size(), Entity());

  // Depth first, children in file order, on a stack of our own: files may nest nodes deeper than ours is.
  struct Visit {
    int node, parent;
  };
  std::vector<Visit> stack;
  std::vector<int> order;
  const auto push = [&](const std::vector<int>& nodes, int parent) {
    for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) stack.push_back({*it, parent});
  };
  push(rootsOf(doc, scene), -1);
  while (!stack.empty()) {
    const auto [index, parent] = stack.back();
    stack.pop_back();
    const std::string parentPlace =
        parent < 0 ? "scene" : label("node", size_t(parent), doc.model.nodes[size_t(parent)].name);
    const tinygltf::Node& node =
        doc.model.nodes[(doc.checkIndex(index, doc.model.nodes.size(), "node", parentPlace), size_t(index))];
    if (import.reached(index))
      doc.fail(label("node", size_t(index), node.name),
               "is reached twice: it has two parents, or the nodes form a cycle (a tree expected)");
    order.push_back(index);
    decompose(doc.transforms[size_t(index)]);
    const Entity e = registry.create();
    import.entities[size_t(index)] = e;
    if (!node.name.empty()) registry.emplace<Name>(e, node.name);
    registry.emplace<Transform>(e, doc.transforms[size_t(index)]);
    registry.emplace<WorldTransform>(e);
    if (parent >= 0) registry.emplace<Parent>(e, import.entities[size_t(parent)]);
    push(node.children, index);
  }

  size_t done = 0;
  std::map<uint32_t, size_t> emitting; // triangles, by mesh
  for (const int index : order) {      // after all nodes are placed, because skins refer to joints anywhere
    import.tell("meshes", Import::kRead, Import::kMeshes, done++, order.size());
    const tinygltf::Node& node = doc.model.nodes[size_t(index)];
    const std::string place = label("node", size_t(index), node.name);
    const Entity e = import.entities[size_t(index)];
    if (node.camera >= 0) addCamera(import, e, node, place);
    addPunctual(import, e, node, place);
    if (node.mesh < 0) continue;
    doc.checkIndex(node.mesh, doc.model.meshes.size(), "mesh", place);
    const uint32_t mesh = importMesh(import, node.mesh, node.skin >= 0);
    if (mesh == kNone) continue;
    const std::optional<std::vector<Transform>> instances = instancesOf(doc, node, place);
    const size_t count = instances ? instances->size() : 1;
    for (size_t i = 0; i < count; ++i) doc.show(import.scene.assets.meshes[mesh].triangles.size(), place);
    const auto [shining, first] = emitting.try_emplace(mesh, 0);
    if (first) shining->second = emittingTriangles(import.scene.assets, mesh);
    doc.spend(count, shining->second * kBytesPerEmitter, place);
    if (!instances) {
      doc.spend(1, kBytesPerInstance, place);
      registry.emplace<MeshInstance>(e, mesh);
      importDeformation(import, index, mesh);
      continue;
    }
    if (node.skin >= 0) import.counted["instanced node(s) with a skin, which poses none of the instances"]++;
    if (!import.scene.assets.meshes[mesh].morphTargets.empty())
      import.counted["instanced node(s) with morph targets, whose instances have the mesh's own shape"]++;
    for (const Transform& transform : *instances) {
      const Entity instance = registry.create();
      registry.emplace<Transform>(instance, transform);
      registry.emplace<WorldTransform>(instance);
      registry.emplace<Parent>(instance, e);
      registry.emplace<MeshInstance>(instance, mesh);
    }
  }
}

} // namespace gltf

/// The middle is where half of the instances lie on either side, so that a few far off do not matter. Scenes that lie
/// whole kilometres apart in their files get origins that lie as far apart, and are then the same to the bit.
void findOrigin(Scene& scene) {
  std::vector<double> places[3];
  scene.registry.each<MeshInstance, WorldTransform>([&](Entity e, const MeshInstance& m, const WorldTransform& w) {
    const Skin* skin = scene.registry.tryGet<Skin>(e);
    const auto* joint =
        skin && !skin->joints.empty() ? scene.registry.tryGet<WorldTransform>(skin->joints[0]) : nullptr;
    const Mesh& mesh = scene.assets.meshes[m.mesh];
    const dvec3 centre = mesh.centre + dvec3(mesh.boundsObject.centre());
    const dvec3 place = joint ? dvec3(joint->worldFromNode[3]) : dvec3(w.worldFromNode * glm::dvec4(centre, 1));
    if (!(glm::length(place) < 1e12)) return; // not finite, or left out
    for (int axis = 0; axis < 3; ++axis) places[axis].push_back(place[axis]);
  });
  if (places[0].empty()) return;
  dvec3 middle;
  for (int axis = 0; axis < 3; ++axis) {
    const auto half = places[axis].begin() + std::ptrdiff_t(places[axis].size() / 2);
    std::nth_element(places[axis].begin(), half, places[axis].end());
    middle[axis] = *half;
  }
  scene.origin = middle; // the scene's size is right from here
  const double diameter = worldBounds(scene).diameter();
  scene.origin = dvec3(0);
  const double near = 4 * diameter; // as far off, single precision does, and places stay what the file says
  if (!(diameter > 0) || !(maxComponent(vec3(glm::abs(middle))) > near)) return;
  const double step = near >= 1000 ? 1000 : std::min(8.0, std::exp2(std::ceil(std::log2(near))));
  scene.origin = step * glm::floor(middle / step + 0.29); // not a half: middles of scenes often are whole numbers
}

namespace {

/// Meshes whose vertices are farther from zero than four times what they reach in the world: baked into a place far
/// off, or moved back from there by a node. Skinned ones go where their joints are.
void bringMeshesHome(Scene& scene) {
  std::vector<bool> far(scene.assets.meshes.size());
  scene.registry.each<MeshInstance, WorldTransform>([&](Entity e, const MeshInstance& m, const WorldTransform& w) {
    const Mesh& mesh = scene.assets.meshes[m.mesh];
    if (!mesh.jointSets.empty() || mesh.boundsObject.empty()) return;
    const std::optional<PlacedPose> placed = poseOf(scene, e, m, w);
    if (!placed) return;
    const auto reach = [](const Aabb& box) {
      return std::max(maxComponent(glm::abs(box.lo)), maxComponent(glm::abs(box.hi)));
    };
    const mat4 turned(mat3(placed->worldFromObject)); // and scaled, but not moved
    if (reach(transformed(mesh.boundsObject, turned)) >
        4 * reach(transformed(mesh.boundsObject, placed->worldFromObject)))
      far[m.mesh] = true;
  });
  for (size_t i = 0; i < far.size(); ++i)
    if (far[i]) countFromMiddle(scene.assets.meshes[i]);
}

/// A driver that draws on the CPU compiles programs anew for each way in which their textures are sampled: 0.15 s.
void refuseManySamplings(const Scene& scene) {
  constexpr size_t kMost = 64;
  const auto sampled = [&](const TextureRef& ref) -> std::array<int, 6> {
    if (ref.image == kNone) return {};
    const TextureImage& image = scene.assets.images[ref.image];
    return {1 + int(ref.wrapU),
            int(ref.wrapV),
            int(ref.nearest),
            int(ref.minify),
            int(std::has_single_bit(unsigned(image.width))),
            int(std::has_single_bit(unsigned(image.height)))};
  };
  std::set<std::array<std::array<int, 6>, 4>> ways;
  for (const Material& m : scene.assets.materials)
    ways.insert({sampled(m.baseColorTexture), sampled(m.emissiveTexture), sampled(m.roughnessMetalnessTexture),
                 sampled(m.normalTexture)});
  if (ways.size() <= kMost) return;
  throw InputError(scene.file.string(), "its materials sample their textures in " + std::to_string(ways.size()) +
                                            " different ways (" + std::to_string(kMost) +
                                            " at most): a first picture would take very long; let more of them share "
                                            "samplers, or --allow-large");
}

/// A first frame draws a shadow map of each, with all triangles in it. `read`: bytes of the file and what it names.
void refuseManyLights(const Scene& scene, size_t triangles, size_t read) {
  constexpr size_t kOfItself = 7000; // what a map takes beside its triangles, in triangles
  constexpr double kMost = 1.41e7;   // 17 s of CPU; see decisions.md
  const size_t lights = scene.registry.count<PunctualLight>();
  const double most = kMost * std::max(1.0, double(read) / double(gltf::Budget::kSmall));
  if (double(lights) * double(kOfItself + triangles) <= most) return;
  const auto fit = size_t(most / double(kOfItself + triangles)); // lights
  throw InputError(scene.file.string(),
                   std::to_string(lights) + " lights, of which each has a shadow map of " + std::to_string(triangles) +
                       " triangles: a first picture would take very long; " +
                       (fit > 0 ? "let there be " + std::to_string(fit) + " at most" : "let them be fewer") +
                       ", or --allow-large");
}

} // namespace

Scene loadScene(const std::filesystem::path& file, const std::string& sceneName, const LoadStep& step,
                FileTrust trust) {
  gltf::Import import;
  import.step = step;
  try {
    import.tell("file", 0, gltf::Import::kRead, 0, 1);
    import.doc = gltf::readDocument(file, trust);
    const int shown = gltf::sceneOf(import.doc, sceneName);
    gltf::importNodes(import, shown);
    if (shown >= 0) gltf::importSky(import, shown, trust.outside);
    gltf::importAnimations(import);
    gltf::decodeImages(import);
  } catch (const std::bad_alloc&) {
    throw InputError(file.string(), "needs more memory than this machine gives");
  }
  Scene scene = std::move(import.scene);
  scene.file = file;
  scene.files = std::move(import.doc.files);
  if (scene.assets.materials.empty()) scene.assets.materials.emplace_back().name = "default";
  scene.warnings = std::move(import.doc.warnings);
  for (const auto& [text, count] : import.counted) scene.warnings.push_back(std::to_string(count) + " " + text);
  if (scene.registry.count<MeshInstance>() == 0) scene.warnings.push_back("the scene holds no triangles");
  animate(scene, 0);
  findOrigin(scene);
  bringMeshesHome(scene);
  if (!trust.large) refuseManySamplings(scene);
  if (!trust.large) refuseManyLights(scene, import.doc.budget.shown, import.doc.budget.read);
  requireQuickRays(scene, trust);
  size_t far = 0;
  scene.registry.each<MeshInstance, WorldTransform>(
      [&](Entity e, const MeshInstance& m, const WorldTransform& w) { far += poseOf(scene, e, m, w).has_value(); });
  forEachPosed(scene, [&](const Mesh&, const DeformedMesh*, const mat4&) { --far; });
  if (far > 0) scene.warnings.push_back(std::to_string(far) + " object(s) that reach beyond 1e12 m left out");
  if (worldBounds(scene).empty() && scene.registry.count<MeshInstance>() > 0)
    scene.warnings.push_back("nothing of the scene has a size, or lies within 1e12 m: the picture is empty");
  return scene;
}

} // namespace lambent
