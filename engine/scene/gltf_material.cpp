// glTF materials as Lambert surfaces, with roughness and metalness for the glossy reflection at the receiver.

#include "engine/scene/gltf_import.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace lambent::gltf {

namespace {

/// Extensions that change nothing a Lambert surface shows, or that are applied.
constexpr std::array<std::string_view, 8> kSilentExtensions = {
    "KHR_materials_emissive_strength", "KHR_materials_ior",   "KHR_materials_specular",
    "KHR_materials_clearcoat",         "KHR_materials_sheen", "KHR_materials_iridescence",
    "KHR_materials_anisotropy",        "KHR_materials_unlit"};

TextureRef importTexture(Import& import, const TextureUse& use, const std::string& place, bool srgb = true) {
  Document& doc = import.doc;
  TextureRef ref;
  if (use.texture < 0) return ref;
  const Texture& texture = doc.at(doc.textures, use.texture, "texture", place);
  if (texture.image < 0 || size_t(texture.image) >= doc.images.size()) {
    doc.warn(place + ": texture " + std::to_string(use.texture) +
             " has no image that this program can use; white instead");
    return ref;
  }
  ref.image = import.images.emplace(std::pair(texture.image, srgb), uint32_t(import.images.size())).first->second;
  ref.wrapU = texture.wrapU;
  ref.wrapV = texture.wrapV;
  ref.nearest = texture.nearest;
  ref.uvTransform = use.uvTransform;
  for (int c = 0; c < 3; ++c)
    if (!isFinite(ref.uvTransform[c])) doc.fail(place, "the texture transform holds a number beyond single precision");
  if (use.texCoord == 0 || use.texCoord == 1)
    ref.uvSet = uint32_t(use.texCoord);
  else
    doc.warn(place + ": uses texture coordinates " + std::to_string(use.texCoord) + " (0 or 1 expected); 0 instead");
  return ref;
}

} // namespace

uint32_t importMaterial(Import& import, int index) {
  auto& materials = import.scene.assets.materials;
  if (const auto known = import.materials.find(index); known != import.materials.end()) return known->second;
  const auto slot = uint32_t(materials.size());
  import.materials.emplace(index, slot);
  lambent::Material out;
  if (index < 0) {
    out.name = "default";
    materials.push_back(out);
    return slot;
  }

  Document& doc = import.doc;
  const Material& in = doc.materials[size_t(index)];
  const std::string place = label("material", size_t(index), in.name);
  out.name = in.name.empty() ? "material " + std::to_string(index) : in.name;
  const vec4 color = glm::clamp(in.baseColor, vec4(0), vec4(1));
  if (color != in.baseColor) doc.warn(place + ": the base colour is out of range; clamped to 0..1");
  out.baseColor = vec3(color);
  out.alpha = color.w;
  out.baseColorTexture = importTexture(import, in.baseColorTexture, place + ", base colour");
  const auto factor = [&](float value, const char* what) {
    if (!(value >= 0 && value <= 1)) doc.warn(place + ": the " + what + " is out of range; clamped to 0..1");
    return value >= 0 ? glm::min(value, 1.0f) : 0.0f;
  };
  out.roughness = factor(in.roughness, "roughness");
  out.metalness = factor(in.metalness, "metalness");
  out.roughnessMetalnessTexture =
      importTexture(import, in.roughnessMetalnessTexture, place + ", roughness and metalness", false);
  out.emission = glm::max(in.emissive * in.emissiveStrength, vec3(0));
  if (!(maxComponent(out.emission) <= kMostLight) || !isFinite(out.emission))
    doc.fail(place, "the emission is beyond what pictures can hold (1e30)");
  if (out.emits()) out.emissiveTexture = importTexture(import, in.emissiveTexture, place + ", emission");
  if (maxComponent(in.emissive) > 1)
    doc.warn(place + ": emissiveFactor is above 1 (KHR_materials_emissive_strength is meant for that); used as it is");
  out.doubleSided = in.doubleSided;
  if (in.alphaMode == "MASK") {
    out.alphaMode = AlphaMode::Mask;
    out.alphaCutoff = in.alphaCutoff;
  } else if (in.alphaMode == "BLEND") {
    out.alphaMode = AlphaMode::Mask;
    out.alphaCutoff = 0.5f;
    import.counted["material(s) with alpha blending shown with a mask, solid where alpha is at least 0.5"]++;
  }
  for (const std::string& extension : in.extensions)
    if (std::find(kSilentExtensions.begin(), kSilentExtensions.end(), extension) == kSilentExtensions.end())
      import.counted["material(s) with " + extension + " shown as opaque Lambert surfaces"]++;
  materials.push_back(std::move(out));
  return slot;
}

} // namespace lambent::gltf
