#include "tests/fuzz/targets.h"

#include "engine/image/image.h"
#include "engine/scene/scene.h"
#include "engine/scene/sky_file.h"
#include "gi/plan/presets.h"
#include "tests/fuzz/compressed.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/own_files.h"

#include <sstream>

namespace lambent::fuzz {

namespace {

// glTF ----------------------------------------------------------------------------------------------------------------

bool gltf(std::string_view bytes) {
  return reading(bytes, bytes.starts_with("glTF") ? ".glb" : ".gltf", [](const fs::path& file) {
    Scene scene = loadScene(file);
    SceneExtractor extractor;
    for (const double t : {0.0, 0.7}) {
      animate(scene, t);
      const SceneView view = extractor.extract(scene, defaultView(scene), t);
      CHECK(view.boundsWorld.empty() || (isFinite(view.boundsWorld.lo) && isFinite(view.boundsWorld.hi)));
      for (const InstanceView& i : view.instances) {
        CHECK(finite(i.worldFromObject));
        const Mesh& mesh = scene.assets.meshes.at(i.mesh);
        for (const vec3& n : mesh.normals) CHECK(std::abs(glm::length(n) - 1) < 1e-3f);
        for (const vec3& p : i.deformed ? i.deformed->positions : mesh.positions) CHECK(isFinite(p));
      }
      for (const LightView& l : view.lights)
        CHECK(isFinite(l.position) && isFinite(l.intensity) && isFinite(l.direction));
    }
    for (const NamedCamera& c : sceneCameras(scene)) CHECK(finite(c.view.worldFromView) && c.view.near > 0);
    for (const Material& m : scene.assets.materials) {
      CHECK(isFinite(m.baseColor) && isFinite(m.emission));
      CHECK(isFinite(vec3(sampleTexture(scene.assets, m.baseColorTexture, vec2(0.3f, 1.7f)))));
    }
  });
}

/// A quad with all that the importer reads: texture, second primitive, skin, morph target, animation, light, camera.
constexpr const char* kScene = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,2,3]}],
"extensionsUsed":["KHR_lights_punctual","KHR_materials_emissive_strength"],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":3,"color":[1,0.5,1],"range":9,
"spot":{"innerConeAngle":0.1,"outerConeAngle":0.4}},{"type":"point","intensity":2},{"type":"directional"}]}},
"nodes":[{"mesh":0,"skin":0,"children":[1],"rotation":[0,0,0.7071,0.7071],"scale":[1,2,1]},
{"translation":[0,1,0],"name":"joint"},{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,2,0,0,1],"weights":[0.5]},
{"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1,"aspectRatio":1.5}}],
"skins":[{"joints":[0,1],"inverseBindMatrices":7}],
"meshes":[{"weights":[0.25],"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"JOINTS_0":3,"WEIGHTS_0":4},
"indices":5,"material":0,"targets":[{"POSITION":0}]},{"attributes":{"POSITION":0},"mode":5,"targets":[{"POSITION":0}]}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,1],"baseColorTexture":{"index":0},"roughnessFactor":0.4},
"emissiveFactor":[1,0,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}},"alphaMode":"MASK"}],
"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071,"magFilter":9728}],
"images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"}],
"animations":[{"samplers":[{"input":6,"output":0,"interpolation":"LINEAR"}],
"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}]}],
"buffers":[{"byteLength":320,"uri":"data:application/octet-stream;base64,BYTES"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48},
{"buffer":0,"byteOffset":96,"byteLength":32},{"buffer":0,"byteOffset":128,"byteLength":16},{"buffer":0,"byteOffset":144,"byteLength":16},
{"buffer":0,"byteOffset":160,"byteLength":12},{"buffer":0,"byteOffset":172,"byteLength":16},{"buffer":0,"byteOffset":192,"byteLength":128}],
"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},{"bufferView":1,"componentType":5126,"type":"VEC3","count":4},
{"bufferView":2,"componentType":5126,"type":"VEC2","count":4},{"bufferView":3,"componentType":5121,"type":"VEC4","count":4},
{"bufferView":4,"componentType":5121,"type":"VEC4","count":4,"normalized":true},{"bufferView":5,"componentType":5123,"type":"SCALAR","count":6},
{"bufferView":6,"componentType":5126,"type":"SCALAR","count":4},{"bufferView":7,"componentType":5126,"type":"MAT4","count":2},
{"componentType":5126,"type":"VEC3","count":9,"sparse":{"count":1,"indices":{"bufferView":5,"componentType":5123},"values":{"bufferView":0}}}]})";

std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t three = 0;
    for (size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::vector<std::string> gltfSeeds() {
  std::string bytes;
  append<float>(bytes, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});                         // positions
  append<float>(bytes, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});                         // normals
  append<float>(bytes, {0, 0, 1, 0, 1, 1, 0, 1});                                     // texture coordinates
  append<uint8_t>(bytes, {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});           // joints
  append<uint8_t>(bytes, {255, 0, 0, 0, 128, 127, 0, 0, 0, 255, 0, 0, 255, 0, 0, 0}); // weights
  append<uint16_t>(bytes, {0, 1, 2, 0, 2, 3});
  append<float>(bytes, {0, 0.5f, 1, 2}); // times
  append<float>(bytes, {0});             // to 192
  for (int m = 0; m < 2; ++m) append<float>(bytes, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
  std::string text = kScene;
  text.replace(text.find("BYTES"), 5, base64(bytes));
  std::string json = text;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  append<uint32_t>(glb, {2u, uint32_t(20 + json.size()), uint32_t(json.size())});
  glb += "JSON" + json;
  return {text, glb, R"({"asset":{"version":"2.0"}})"};
}

// Settings, pictures --------------------------------------------------------------------------------------------------

/// Lines of name=value, or names of presets.
bool settings(std::string_view bytes) {
  std::istringstream lines{std::string(bytes)};
  Settings settings;
  bool taken = true;
  for (std::string line; std::getline(lines, line);) try {
      const size_t equals = line.find('=');
      equals == std::string::npos ? applyPreset(settings, line)
                                  : applySetting(settings, line.substr(0, equals), line.substr(equals + 1));
    } catch (const InputError&) {
      taken = false;
    }
  for (const SettingRow& row : settingsTable()) { // what was taken can be said and taken again
    Settings again = settings;
    applySetting(again, row.name, settingText(settings, row.name));
    CHECK(again == settings);
  }
  (void)whyNot(settings);
  return taken;
}

std::vector<std::string> settingsSeeds() {
  std::string all;
  for (const SettingRow& row : settingsTable())
    all += row.name + std::string("=") + settingText(Settings{}, row.name) + "\n";
  return {all, "low\nsmc.vpls=1\ngather.clamp=0.5\nshadow.bias=1e1\n"};
}

bool picture(std::string_view bytes) {
  if (bytes.starts_with("P"))
    return reading(bytes, ".pfm", [&](const fs::path& file) {
      const Image image = readPfm(file);
      CHECK_EQ(image.pixels.size(), size_t(image.width) * size_t(image.height));
    });
  return reading(bytes, bytes.starts_with("#?") ? ".hdr" : ".exr", [&](const fs::path& file) {
    std::vector<std::string> notes;
    const auto sky = readSky(file, notes);
    CHECK_EQ(sky->texels.size(), size_t(sky->width) * size_t(sky->height));
    for (const vec3& texel : sky->texels) CHECK(isFinite(texel) && texel.x >= 0 && texel.y >= 0 && texel.z >= 0);
  });
}

std::vector<std::string> pictureSeeds() {
  std::string pfm = "PF\n2 2\n-1.0\n";
  append<float>(pfm, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12});
  std::string grey = "Pf 3 1 1\n";
  append<float>(grey, {1, 2, 3});
  const std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X ";
  const std::string flat = hdr + "2\n" + std::string("\x80\x40\x20\x81\x80\x80\x80\x80", 8),
                    runs = hdr + "8\n" + std::string("\x02\x02\x00\x08\x88\x80\x88\x80\x88\x80\x88\x81", 12);
  return {pfm, grey, flat, runs,
          written(".exr", [](const fs::path& file) { writeExr(file, Image(5, 4, vec3(0.5f))); })};
}

} // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all = [] {
    std::vector<Target> all{
        {"gltf",
         gltf,
         gltfSeeds,
         {"\"count\":", "\"byteOffset\":", "\"byteStride\":", "\"componentType\":5125", "\"mode\":6",
          "\"uri\":", "null", "[]", "{}", "-1", "4294967296", "1e39", "1e-39", "0.5", "\"MAT4\"", "\"CUBICSPLINE\"",
          "\"path\":\"weights\"", "\"sparse\":"},
         {}},
        {"compressed",
         gltf,
         compressedSeeds,
         {"DRACO", "RIFF", "WEBP", "VP8L", "\"count\":", "\"byteStride\":", "\"mode\":", "\"filter\":",
          "\"QUATERNION\"", "\"INDICES\"", "\"fallback\":", "\xff\xff\xff\xff", "\xff\xff\xff\x0f", "-1", "4294967296"},
         {}},
        {"settings",
         settings,
         settingsSeeds,
         {"=on", "=off", "=-1", "=nan", "=inf", "=1e39", "=auto", "\n", "vpl.source=hisr"},
         {}},
        {"picture",
         picture,
         pictureSeeds,
         {"PF", "Pf", " 32768 ", " 1 ", "-1", "nan", "channels", "compression", "dataWindow", "#?RADIANCE", "-Y ",
          "+X "},
         {}},
    };
    const std::vector<Target> own = ownFiles();
    all.insert(all.end(), own.begin(), own.end());
    return all;
  }();
  return all;
}

} // namespace lambent::fuzz

#ifdef FUZZ_TARGET // of libFuzzer: a name
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lambent::fuzz;
  static const auto named = [](const Target& target) { return std::string_view(target.name) == FUZZ_TARGET; };
  static const Target& target = *std::ranges::find_if(targets(), named);
  target.run({reinterpret_cast<const char*>(data), size});
  return 0;
}
#endif
