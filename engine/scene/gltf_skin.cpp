// Skins, frozen: the mesh is posed once, with the joints as the file places them. Posing it in the space of its own
// node (glTF poses in world space and ignores that node) lets the figure be moved as one rigid object.

#include "engine/scene/gltf_import.h"

#include <cmath>

namespace lambent::gltf {

std::vector<mat4> restSkinMatrices(Import& import, int node) {
  Document& doc = import.doc;
  const std::string nodePlace = label("node", size_t(node), doc.nodes[size_t(node)].name);
  const int skinIndex = doc.nodes[size_t(node)].skin;
  const Skin& skin = doc.at(doc.skins, skinIndex, "skin", nodePlace);
  const std::string place = label("skin", size_t(skinIndex), skin.name);

  std::vector<mat4> inverseBind(skin.joints.size(), mat4(1));
  if (skin.inverseBindMatrices >= 0) {
    inverseBind = readAccessor<mat4>(doc, skin.inverseBindMatrices, place + ", inverse bind matrices");
    if (inverseBind.size() < skin.joints.size()) doc.fail(place, "has fewer inverse bind matrices than joints");
  }
  const mat4 worldFromNode = import.worldFromNode[size_t(node)];
  if (!(std::abs(glm::determinant(mat3(worldFromNode))) > 0)) {
    doc.warn(nodePlace + ": is scaled to nothing; its skin is not applied");
    return {};
  }
  const mat4 nodeFromWorld = glm::inverse(worldFromNode);
  std::vector<mat4> matrices;
  for (size_t i = 0; i < skin.joints.size(); ++i) {
    doc.checkIndex(skin.joints[i], doc.nodes.size(), "node", place);
    if (!import.reached(skin.joints[i]))
      doc.fail(place, "joint node " + std::to_string(skin.joints[i]) + " is not part of the scene");
    matrices.push_back(nodeFromWorld * import.worldFromNode[size_t(skin.joints[i])] * inverseBind[i]);
  }
  import.counted["skinned mesh(es) frozen in the rest pose"]++;
  return matrices;
}

} // namespace lambent::gltf
