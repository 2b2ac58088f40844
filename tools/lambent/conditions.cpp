#include "tools/lambent/conditions.h"

#include "engine/core/rng.h"
#include "engine/gl/program.h"
#include "tools/lambent/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace lambent {

namespace {

namespace fs = std::filesystem;

uint64_t hashOf(const std::string& text, uint64_t hash = 0) {
  for (char c : text) hash = mix64(hash ^ uint8_t(c));
  return hash;
}

std::string textOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Buffers and images that a glTF file names: what it holds itself is of its own text.
uint64_t hashOfNamedFiles(const fs::path& scene, uint64_t hash) {
  const nlohmann::json document = nlohmann::json::parse(textOf(scene), nullptr, false);
  if (!document.is_object()) return hash; // .glb
  for (const char* list : {"buffers", "images"})
    for (const nlohmann::json& entry : document.value(list, nlohmann::json::array()))
      if (const std::string uri = entry.value("uri", ""); !uri.empty() && !uri.starts_with("data:"))
        hash = hashOf(textOf(scene.parent_path() / uri), hash);
  return hash;
}

/// The program with its shaders: what another one made is not ours.
uint64_t hashOfProgram() {
  uint64_t hash = hashOf(textOf("/proc/self/exe"));
  std::vector<fs::path> files;
  for (const fs::directory_entry& e : fs::recursive_directory_iterator(gl::findShaderFolder()))
    if (e.is_regular_file()) files.push_back(e.path());
  std::ranges::sort(files);
  for (const fs::path& file : files) hash = hashOf(textOf(file), hash);
  return hash;
}

} // namespace

std::string conditionsOf(const LaunchContext& stage, const LaunchOptions& o, const std::string& more) {
  std::string text = more + '\n' + o.scene + '\n' + textOf(o.scene) + textOf(stage.scene.file);
  for (const std::string& option : {o.camera, o.eye, o.target, o.size, o.sky, o.daylight, o.sceneName,
                                    std::to_string(o.fovDegrees.value_or(0)), std::to_string(o.seed)})
    text += '\n' + option;
  for (const SettingRow& row : settingRows(stage.settings)) text += '\n' + settingText(stage.settings, row.name);
  for (const auto* list : {&o.suns, &o.points})
    for (const std::string& light : *list) text += '\n' + light;
  return format("%016llx",
                static_cast<unsigned long long>(hashOf(text, hashOfNamedFiles(stage.scene.file, hashOfProgram()))));
}

} // namespace lambent
