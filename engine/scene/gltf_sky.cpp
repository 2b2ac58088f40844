// The sky of a scene: extras.lambent_sky of a glTF scene, which glTF has no place for. Three numbers of radiance, or
// {"image": "studio.hdr", "scale": 1, "turn": 90}: as --sky, --sky-scale and --sky-turn take them.
#include "engine/scene/gltf_import.h"
#include "engine/scene/sky_file.h"

#include <algorithm>
#include <cmath>

namespace lambent::gltf {

namespace {

/// Reads a picture that the file names; a black sky, said, where it cannot be read.
Sky pictureOf(Document& doc, const tinygltf::Value& given, const std::string& place, bool outside) {
  const std::string uri = given.Get("image").Get<std::string>();
  for (const char* key : {"scale", "turn"})
    if (given.Has(key) && !given.Get(key).IsNumber()) doc.fail(place, std::string(key) + " is no number");
  const float scale = number(given, "scale", 1), turn = number(given, "turn", 0);
  if (!(scale >= 1e-6f && scale <= 1e6f)) doc.fail(place, "scale is out of range (1e-6 to 1e6)");
  if (!(std::abs(turn) <= 360)) doc.fail(place, "turn is out of range (-360 to 360 degrees)");
  const std::filesystem::path folder = doc.file.parent_path(), picture = folder / pathOfUri(uri);
  const auto black = [&](const std::string& why) {
    doc.warn(place + ": " + uri + ": " + why + "; the scene has no sky of its own");
    return Sky();
  };
  const HeldFile held(folder, picture, outside);
  if (!held)
    return black(std::string("no such file in the scene's folder") +
                 (!outside && leadsOutside(folder, picture) ? " (--allow-outside lets it read others)" : ""));
  try {
    constexpr size_t kBytesPerTexel = 2 * sizeof(vec3); // as read, and halved
    doc.budget.read += std::filesystem::file_size(held.opened());
    std::vector<std::string> notes;
    const auto image =
        readSky(picture, notes, std::min<uint64_t>(kMostSkyTexels, doc.budget.left() / kBytesPerTexel), held.opened());
    doc.spend(image->texels.size(), kBytesPerTexel, place);
    const Sky sky = Sky::image(image, scale, glm::radians(turn));
    for (std::string& note : notes) doc.warn(std::move(note));
    doc.files.push_back(picture);
    return sky;
  } catch (const InputError& e) {
    return black(e.what());
  }
}

} // namespace

void importSky(Import& import, int scene, bool outside) {
  Document& doc = import.doc;
  const tinygltf::Scene& in = doc.model.scenes[size_t(scene)];
  if (!in.extras.IsObject() || !in.extras.Has("lambent_sky")) return;
  const std::string place = label("scene", size_t(scene), in.name) + ", extras.lambent_sky";
  const tinygltf::Value& given = in.extras.Get("lambent_sky");
  if (given.IsObject())
    for (const std::string& key : given.Keys())
      if (key != "image" && key != "scale" && key != "turn")
        doc.fail(place, "has no key '" + key + "' (image, scale, turn)");
  if (given.IsObject() && given.Has("image") && given.Get("image").IsString()) {
    import.scene.sky = pictureOf(doc, given, place, outside);
    return;
  }
  if (!given.IsArray() || given.ArrayLen() != 3) doc.fail(place, "is neither [r, g, b] nor {\"image\": FILE}");
  vec3 radiance;
  for (int c = 0; c < 3; ++c) {
    const tinygltf::Value& v = given.Get(size_t(c));
    radiance[c] = v.IsNumber() ? float(v.GetNumberAsDouble()) : -1;
    if (!(radiance[c] >= 0 && radiance[c] <= 1e30f)) doc.fail(place, "holds what is no radiance (0 to 1e30)");
  }
  import.scene.sky = Sky(radiance);
}

} // namespace lambent::gltf
