// Skins and morph weights of nodes: what a mesh is posed by. The vertices' side of it is read with the mesh.

#include "engine/scene/gltf_import.h"

namespace lambent::gltf {

namespace {

/// As measured, hierarchy and copies included: 1050 nodes of 7200 triangles took 4.5 GB.
constexpr size_t kBytesPerPosedTriangle = 600;
constexpr size_t kBytesPerPosedVertex = 216; // 26 nodes of 600 000 that no triangle uses took 3.3 GB

lambent::Skin readSkin(const Import& import, const tinygltf::Skin& in, const std::string& place) {
  const Document& doc = import.doc;
  lambent::Skin skin;
  if (in.joints.empty()) doc.fail(place, "has no joints");
  doc.spend(in.joints.size(), sizeof(Entity) + sizeof(mat4), place);
  for (const int node : in.joints) {
    doc.checkIndex(node, doc.model.nodes.size(), "node", place);
    if (!import.reached(node)) doc.fail(place, "joint node " + std::to_string(node) + " is not part of the scene");
    skin.joints.push_back(import.entities[size_t(node)]);
  }
  skin.jointFromBind.assign(in.joints.size(), mat4(1));
  if (in.inverseBindMatrices < 0) return skin;
  skin.jointFromBind = readAccessor<mat4>(doc, in.inverseBindMatrices, place + ", inverse bind matrices");
  if (skin.jointFromBind.size() < in.joints.size()) doc.fail(place, "has fewer inverse bind matrices than joints");
  skin.jointFromBind.resize(in.joints.size());
  for (size_t j = 0; j < skin.jointFromBind.size(); ++j) {
    mat4& m = skin.jointFromBind[j];
    if (!isAffine(m))
      doc.fail(place, "inverse bind matrix " + std::to_string(j) + " is not affine (its last row is 0, 0, 0, 1)");
    for (int c = 0; c < 4; ++c)
      if (!isFinite(vec3(m[c])))
        doc.fail(place, "inverse bind matrix " + std::to_string(j) + " holds a number that is not finite");
    m[0][3] = m[1][3] = m[2][3] = 0, m[3][3] = 1;
  }
  return skin;
}

void addSkin(Import& import, int node, uint32_t slot) {
  Document& doc = import.doc;
  const tinygltf::Node& in = doc.model.nodes[size_t(node)];
  const std::string nodePlace = label("node", size_t(node), in.name);
  const tinygltf::Skin& skin = doc.at(doc.model.skins, in.skin, "skin", nodePlace);
  const std::string place = label("skin", size_t(in.skin), skin.name);
  const HighestJoint& highest = import.highestJoints.at(slot);
  if (highest.place.empty()) {
    doc.warn(nodePlace + ": has a skin, but no vertex of its mesh follows a joint; shown rigid");
    return;
  }
  if (highest.joint >= skin.joints.size())
    doc.fail(highest.place, "follows joint " + std::to_string(highest.joint) + ", but " + place + " of " + nodePlace +
                                " has " + std::to_string(skin.joints.size()));
  import.scene.registry.emplace<lambent::Skin>(import.entities[size_t(node)], readSkin(import, skin, place));
}

void addMorphWeights(Import& import, int node, uint32_t slot) {
  Document& doc = import.doc;
  const tinygltf::Node& in = doc.model.nodes[size_t(node)];
  const tinygltf::Mesh& mesh = doc.model.meshes[size_t(in.mesh)];
  const size_t targets = import.scene.assets.meshes[slot].morphTargets.size();
  const bool own = !in.weights.empty();
  const std::vector<double>& given = own ? in.weights : mesh.weights;
  std::vector<float> weights(given.begin(), given.end());
  if (!weights.empty() && weights.size() != targets)
    doc.fail(own ? label("node", size_t(node), in.name) : label("mesh", size_t(in.mesh), mesh.name),
             "has " + std::to_string(weights.size()) + " weights for " + std::to_string(targets) + " morph targets");
  if (targets == 0) return;
  doc.spend(targets, 2 * sizeof(float), label("node", size_t(node), in.name)); // with those of its own pose
  weights.resize(targets, 0.0f);
  import.scene.registry.emplace<MorphWeights>(import.entities[size_t(node)], std::move(weights));
}

} // namespace

void importDeformation(Import& import, int node, uint32_t slot) {
  const tinygltf::Node& in = import.doc.model.nodes[size_t(node)];
  const lambent::Mesh& mesh = import.scene.assets.meshes[slot];
  if (in.skin >= 0 || !mesh.morphTargets.empty()) { // a shape of its own, also for rays and OpenGL
    const std::string place = label("node", size_t(node), in.name);
    import.doc.spend(mesh.positions.size(), kBytesPerPosedVertex, place);
    import.doc.spend(mesh.triangles.size(), kBytesPerPosedTriangle, place);
  }
  if (in.skin >= 0) addSkin(import, node, slot);
  addMorphWeights(import, node, slot);
}

} // namespace lambent::gltf
