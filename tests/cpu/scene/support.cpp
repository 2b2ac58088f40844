#include "tests/cpu/scene/support.h"

#include <stb/stb_image_write.h>

namespace lambent::test {

std::vector<uint8_t> png(u8vec4 color) {
  std::vector<uint8_t> out;
  const std::vector<u8vec4> texels(4, color);
  stbi_write_png_to_func(
      [](void* to, void* data, int size) {
        const auto* p = static_cast<uint8_t*>(data);
        static_cast<std::vector<uint8_t>*>(to)->insert(static_cast<std::vector<uint8_t>*>(to)->end(), p, p + size);
      },
      &out, 2, 2, 4, texels.data(), 8);
  return out;
}

namespace {

std::string base64(const std::vector<uint8_t>& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t n = std::min<size_t>(3, bytes.size() - i);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0);
    for (size_t k = 0; k < 4; ++k) out += k <= n ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void append32(std::string& out, uint32_t v) {
  for (int i = 0; i < 4; ++i) out += char(v >> (8 * i) & 255);
}

} // namespace

void GltfBuilder::animate(int node, const char* path, int times, int values, const char* interpolation) {
  nlohmann::json sampler = {{"input", times}, {"output", values}};
  if (interpolation) sampler["interpolation"] = interpolation;
  push("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}},
                      {"samplers", nlohmann::json::array({sampler})}});
}

std::string GltfBuilder::text() const {
  nlohmann::json out = json;
  if (!bytes.empty())
    out["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
  return out.dump();
}

void GltfBuilder::writeGltf(const fs::path& file) const { writeBytes(file, text()); }

void GltfBuilder::writeGlb(const fs::path& file) const {
  nlohmann::json doc = json;
  doc["buffers"] = {{{"byteLength", bytes.size()}}};
  std::string text = doc.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string binary(bytes.begin(), bytes.end());
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  append32(out, 2);
  append32(out, uint32_t(12 + 8 + text.size() + 8 + binary.size()));
  append32(out, uint32_t(text.size()));
  out += "JSON" + text;
  append32(out, uint32_t(binary.size()));
  out += std::string("BIN\0", 4) + binary;
  writeBytes(file, out);
}

Scene GltfBuilder::load(const TemporaryFolder& folder, FileTrust trust) const {
  const fs::path file = folder / "scene.gltf";
  writeGltf(file);
  return loadScene(file, {}, {}, trust);
}

GltfBuilder oneTriangle() {
  GltfBuilder b;
  b.addMeshNode({{"attributes", {{"POSITION", b.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})}}}});
  return b;
}

bool hasWarning(const Scene& scene, const std::string& text) {
  return std::ranges::any_of(scene.warnings, [&](const std::string& w) { return w.find(text) != w.npos; });
}

void expectNear(const vec3& a, const vec3& b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "component " << c;
}

} // namespace lambent::test
