// glTF materials as Lambert surfaces, with the finish for the glossy reflection at the receiver.

#include "engine/scene/gltf_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace lambent::gltf {

namespace {

/// Extensions that are applied, as far as surfaces are drawn.
constexpr std::array<std::string_view, 4> kAppliedExtensions = {"KHR_materials_emissive_strength", "KHR_materials_ior",
                                                                "KHR_materials_specular", "KHR_materials_unlit"};

/// -1 where it is none.
int wholeNumber(const tinygltf::Value& object, const char* key, int otherwise) {
  const float value = number(object, key, float(otherwise));
  return std::abs(value) < 1e9f ? int(value) : -1;
}

vec2 pair(const tinygltf::Value& object, const char* key, vec2 otherwise) {
  if (!object.IsObject() || !object.Has(key) || object.Get(key).ArrayLen() < 2) return otherwise;
  const tinygltf::Value &x = object.Get(key).Get(0), &y = object.Get(key).Get(1);
  return x.IsNumber() && y.IsNumber() ? vec2(x.GetNumberAsDouble(), y.GetNumberAsDouble()) : otherwise;
}

Minify minifyOf(int filter) {
  switch (filter) {
  case TINYGLTF_TEXTURE_FILTER_NEAREST:
    return Minify::Nearest;
  case TINYGLTF_TEXTURE_FILTER_LINEAR:
    return Minify::Linear;
  case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST:
    return Minify::NearestMipmapNearest;
  case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST:
    return Minify::LinearMipmapNearest;
  case TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR:
    return Minify::NearestMipmapLinear;
  case TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR:
    return Minify::LinearMipmapLinear;
  default:
    return Minify::Auto;
  }
}

Wrap wrapMode(int mode) {
  return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::ClampToEdge
         : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::MirroredRepeat
                                                         : Wrap::Repeat;
}

/// What a sampler asks for that glTF does not know: taken as if it did not ask.
void warnOfUnknown(Document& doc, const tinygltf::Sampler& sampler, const std::string& place) {
  for (const int wrap : {sampler.wrapS, sampler.wrapT})
    if (wrap != TINYGLTF_TEXTURE_WRAP_REPEAT && wrap != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE &&
        wrap != TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT)
      doc.warn(place + ": wrap mode " + std::to_string(wrap) + " is none of glTF's; repeated instead");
  if (sampler.minFilter != -1 && minifyOf(sampler.minFilter) == Minify::Auto)
    doc.warn(place + ": minFilter " + std::to_string(sampler.minFilter) + " is none of glTF's; not used");
  if (sampler.magFilter != -1 && sampler.magFilter != TINYGLTF_TEXTURE_FILTER_NEAREST &&
      sampler.magFilter != TINYGLTF_TEXTURE_FILTER_LINEAR)
    doc.warn(place + ": magFilter " + std::to_string(sampler.magFilter) + " is none of glTF's; not used");
}

void warnOfUnknown(Document& doc, const tinygltf::Value& transform, const std::string& place) {
  const auto isPair = [](const tinygltf::Value& v) {
    return v.IsArray() && v.ArrayLen() == 2 && v.Get(0).IsNumber() && v.Get(1).IsNumber();
  };
  for (const char* key : {"offset", "scale", "rotation", "texCoord"})
    if (transform.IsObject() && transform.Has(key)) {
      const tinygltf::Value& value = transform.Get(key);
      const bool two = key == std::string_view("offset") || key == std::string_view("scale");
      if (two ? !isPair(value) : !value.IsNumber())
        doc.warn(place + ": KHR_texture_transform's " + key + " is no " + (two ? "pair of numbers" : "number") +
                 "; not used");
    }
}

TextureRef importTexture(Import& import, const tinygltf::TextureInfo& use, const std::string& place, bool srgb = true) {
  Document& doc = import.doc;
  TextureRef ref;
  if (use.index < 0) return ref;
  const tinygltf::Texture& texture = doc.at(doc.model.textures, use.index, "texture", place);
  const auto sourceBy = [&](const char* extension) {
    const auto found = texture.extensions.find(extension);
    return found == texture.extensions.end() ? -1 : wholeNumber(found->second, "source", -1);
  };
  const int webp = sourceBy("EXT_texture_webp"), source = webp >= 0 ? webp : texture.source;
  if (source < 0 || size_t(source) >= doc.model.images.size()) {
    const bool ktx = sourceBy("KHR_texture_basisu") >= 0;
    doc.warn(place + ": texture " + std::to_string(use.index) + " has no image that this program can use" +
             (ktx ? " (KTX2; gltf-transform ktxdecompress IN OUT converts it)" : "") + "; white instead");
    return ref;
  }
  const tinygltf::Image& image = doc.model.images[size_t(source)];
  const bool shared = image.bufferView >= 0 || !image.uri.empty();
  const int first =
      shared ? import.firstOfSource.emplace(std::pair(image.bufferView, image.uri), source).first->second : source;
  ref.image = import.images.emplace(std::pair(first, srgb), uint32_t(import.images.size())).first->second;
  if (texture.sampler >= 0) {
    const tinygltf::Sampler& sampler = doc.model.samplers[size_t(texture.sampler)];
    warnOfUnknown(doc, sampler, place);
    ref.wrapU = wrapMode(sampler.wrapS);
    ref.wrapV = wrapMode(sampler.wrapT);
    ref.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    ref.minify = minifyOf(sampler.minFilter);
  }
  int texCoord = use.texCoord;
  if (const auto found = use.extensions.find("KHR_texture_transform"); found != use.extensions.end()) {
    const tinygltf::Value& t = found->second;
    warnOfUnknown(doc, t, place);
    texCoord = wholeNumber(t, "texCoord", texCoord);
    const vec2 offset = pair(t, "offset", vec2(0)), scale = pair(t, "scale", vec2(1));
    const float angle = number(t, "rotation", 0), c = std::cos(angle), s = std::sin(angle);
    // Translation × rotation × scale as the extension writes it: positive angles turn counter-clockwise in a uv space
    // whose v points down.
    ref.uvTransform = mat3(c * scale.x, -s * scale.x, 0, s * scale.y, c * scale.y, 0, offset.x, offset.y, 1);
  }
  for (int c = 0; c < 3; ++c)
    if (!isFinite(ref.uvTransform[c])) doc.fail(place, "the texture transform holds a number beyond single precision");
  constexpr float kMostTurns = 1e6f; // of a texture: beyond, single precision knows no place in it
  for (int c = 0; c < 3; ++c)
    if (maxComponent(glm::abs(ref.uvTransform[c])) > kMostTurns) {
      doc.warn(place + ": the texture transform is beyond what finds a place in a texture (1e6); none instead");
      ref.uvTransform = mat3(1);
    }
  if (texCoord == 0 || texCoord == 1)
    ref.uvSet = uint32_t(texCoord);
  else
    doc.warn(place + ": uses texture coordinates " + std::to_string(texCoord) + " (0 or 1 expected); 0 instead");
  return ref;
}

/// KHR_materials_ior and KHR_materials_specular, as far as a G-buffer holds them: numbers, no textures, no tint.
void importDielectric(Import& import, const tinygltf::Material& in, const std::string& place, lambent::Material& out) {
  const auto ior = in.extensions.find("KHR_materials_ior"), specular = in.extensions.find("KHR_materials_specular");
  if (ior == in.extensions.end() && specular == in.extensions.end()) return;
  float index = ior == in.extensions.end() ? 1.5f : number(ior->second, "ior", 1.5f);
  if (!(index >= 1 || index == 0)) {
    import.doc.warn(place + ": the index of refraction is below 1; 1.5 instead");
    index = 1.5f;
  }
  const float root = index == 0 || !std::isfinite(index) ? 1.0f : (index - 1) / (index + 1); // 0: a mirror
  out.dielectricF0 = root * root;
  if (specular != in.extensions.end()) {
    const tinygltf::Value& value = specular->second;
    const float weight = number(value, "specularFactor", 1);
    if (!(weight >= 0 && weight <= 1)) import.doc.warn(place + ": specularFactor is out of range; clamped to 0..1");
    out.dielectricLobe = weight >= 0 ? std::min(weight, 1.0f) : 0.0f;
    vec3 tint(1);
    if (value.Has("specularColorFactor") && value.Get("specularColorFactor").ArrayLen() == 3)
      for (int c = 0; c < 3; ++c) {
        const tinygltf::Value& channel = value.Get("specularColorFactor").Get(size_t(c));
        if (channel.IsNumber()) tint[c] = std::clamp(float(channel.GetNumberAsDouble()), 0.0f, 1e6f);
      }
    out.dielectricF0 = std::min(out.dielectricF0 * luminance(tint), 1.0f);
    if (tint.x != tint.y || tint.y != tint.z)
      import.counted["material(s) whose specularColorFactor counts by its luminance"]++;
    for (const char* texture : {"specularTexture", "specularColorTexture"})
      if (value.Has(texture)) import.counted[std::string("material(s) whose ") + texture + " is not used"]++;
  }
  // Where nothing would be reflected head-on, glancing light is not either; 0 stands for the default.
  if (out.dielectricF0 < 1e-4f) out.dielectricF0 = 0, out.dielectricLobe = 0;
}

/// KHR_materials_clearcoat. There is room for one lobe: the coat of what is no metal takes the place of its own gloss.
/// Returns false where the coat stays out.
bool importCoat(Import& import, const tinygltf::Material& in, lambent::Material& out) {
  const auto coat = in.extensions.find("KHR_materials_clearcoat");
  if (coat == in.extensions.end()) return false;
  constexpr float kLeast = 0.5f; // of the coat, or the own gloss is more of what is seen
  const float factor = number(coat->second, "clearcoatFactor", 0);
  if (!(factor > 0)) return true; // none
  if (factor < kLeast || out.metalness > 0) return false;
  out.roughness = std::clamp(number(coat->second, "clearcoatRoughnessFactor", 0), 0.0f, 1.0f);
  out.roughnessMetalnessTexture.image = kNone;
  out.dielectricF0 = 0; // of an index of refraction of 1.5
  out.dielectricLobe = std::min(factor, 1.0f);
  import.counted["material(s) whose coat takes the place of their own gloss"]++;
  if (out.normalTexture.image != kNone && !coat->second.Has("clearcoatNormalTexture"))
    import.counted["material(s) whose coat is bent by their own normal map"]++;
  for (const char* texture : {"clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"})
    if (coat->second.Has(texture)) import.counted[std::string("material(s) whose ") + texture + " is not used"]++;
  return true;
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
    out.backHidden = true;
    materials.push_back(out);
    return slot;
  }

  Document& doc = import.doc;
  const tinygltf::Material& in = doc.model.materials[size_t(index)];
  const tinygltf::PbrMetallicRoughness& pbr = in.pbrMetallicRoughness;
  const auto [baseColor, emissive] = doc.materialFactors[size_t(index)];
  const std::string place = label("material", size_t(index), in.name);
  out.name = in.name.empty() ? "material " + std::to_string(index) : in.name;
  const vec4 color = glm::clamp(baseColor, vec4(0), vec4(1));
  if (color != baseColor) doc.warn(place + ": the base colour is out of range; clamped to 0..1");
  out.baseColor = vec3(color);
  out.alpha = color.w;
  out.baseColorTexture = importTexture(import, pbr.baseColorTexture, place + ", base colour");
  const auto factor = [&](float value, const char* what) {
    if (!(value >= 0 && value <= 1)) doc.warn(place + ": the " + what + " is out of range; clamped to 0..1");
    return value >= 0 ? glm::min(value, 1.0f) : 0.0f;
  };
  out.roughness = factor(float(pbr.roughnessFactor), "roughness");
  out.metalness = factor(float(pbr.metallicFactor), "metalness");
  out.roughnessMetalnessTexture =
      importTexture(import, pbr.metallicRoughnessTexture, place + ", roughness and metalness", false);
  const tinygltf::NormalTextureInfo& bumps = in.normalTexture;
  tinygltf::TextureInfo normalMap;
  normalMap.index = bumps.index, normalMap.texCoord = bumps.texCoord, normalMap.extensions = bumps.extensions;
  out.normalTexture = importTexture(import, normalMap, place + ", normal map", false);
  out.normalScale = float(bumps.scale);
  if (!std::isfinite(out.normalScale)) doc.fail(place, "the normal map's scale is beyond single precision");
  const auto strength = in.extensions.find("KHR_materials_emissive_strength");
  out.emission = glm::max(
      emissive * (strength != in.extensions.end() ? number(strength->second, "emissiveStrength", 1) : 1), vec3(0));
  if (strength != in.extensions.end() && number(strength->second, "emissiveStrength", 1) < 0)
    doc.warn(place + ": emissiveStrength is negative; taken as 0");
  if (!(maxComponent(out.emission) <= kMostLight) || !isFinite(out.emission))
    doc.fail(place, "the emission is beyond what pictures can hold (1e30)");
  if (out.emits()) out.emissiveTexture = importTexture(import, in.emissiveTexture, place + ", emission");
  if (maxComponent(emissive) > 1)
    doc.warn(place + ": emissiveFactor is above 1 (KHR_materials_emissive_strength is meant for that); used as it is");
  if (in.occlusionTexture.index >= 0)
    import.counted["material(s) whose occlusionTexture is not used: light is computed"]++;
  out.doubleSided = in.doubleSided;
  out.backHidden = !in.doubleSided;
  if (in.alphaMode == "MASK") {
    out.alphaMode = AlphaMode::Mask;
    out.alphaCutoff = float(in.alphaCutoff);
  } else if (in.alphaMode == "BLEND") {
    out.alphaMode = AlphaMode::Blend;
  } else if (!in.alphaMode.empty() && in.alphaMode != "OPAQUE") {
    doc.warn(place + ": alphaMode is none of glTF's; taken as opaque");
  }
  bool coated = false;
  if (in.extensions.contains("KHR_materials_unlit")) { // its colour, with no lobe and no bumps
    out.roughness = 1;
    out.metalness = 0;
    out.roughnessMetalnessTexture = out.normalTexture = {};
    out.dielectricLobe = 0;
    import.counted["material(s) with KHR_materials_unlit shown lit"]++;
  } else {
    importDielectric(import, in, place, out);
    coated = importCoat(import, in, out);
  }
  for (const auto& [extension, value] : in.extensions)
    if (!(coated && extension == "KHR_materials_clearcoat") &&
        std::find(kAppliedExtensions.begin(), kAppliedExtensions.end(), extension) == kAppliedExtensions.end())
      import.counted["material(s) with " + extension + " shown without it"]++;
  materials.push_back(std::move(out));
  return slot;
}

} // namespace lambent::gltf
