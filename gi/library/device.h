// What a lambent_device holds. Everything that lambent.h names by number is found here.
#pragma once

#include "engine/core/memory.h"
#include "engine/core/parallel.h"
#include "engine/gl/objects.h"
#include "gi/frame/gi_frame.h"
#include "gi/host/host_scene.h"
#include "gi/lambent.h"
#include "gi/library/deliver.h"

#include <atomic>
#include <map>
#include <optional>

namespace lambent::library {

/// A camera's image of a scene, with all that its light needs.
struct View {
  lambent_scene scene;
  int width, height;
  ViewChanges changes;
  GiFrame gi;
  Delivery delivery;
  gl::Texture points[2];                  // irradiance at points: indirect, direct
  std::optional<HostConventions> checked; // those of the last surfaces that were compared with the scene
  uint64_t rendered = 0;                  // HostScene::assetsVersion of the last frame; 0: none yet

  /// Soft direct light begins at the image's surfaces, which are the host's, not at those that rays find in the scene.
  static Settings settings() {
    Settings s;
    s.direct.surfaces = SoftSurfaces::Image;
    return s;
  }
  View(lambent_scene of, const lambent_view_desc& desc, uint32_t seed, const std::filesystem::path& shaders)
      : scene(of), width(desc.width), height(desc.height), gi(settings(), seed, Makers::ByRule, shaders),
        delivery(gi.context()) {}
};

struct Scene {
  HostScene host;
  std::vector<TextureRef> textures; // by number, as materials use them
};

} // namespace lambent::library

struct lambent_device {
  lambent_device_desc desc;
  std::string shaders; // folder; empty: built in
  lambent::Workers workers;
  lambent::MemoryAccount account; // below all that is entered in it
  lambent::gl::VertexArray mark;  // by its label a context is known again: contexts do not share these
  std::string markLabel;
  std::map<uint64_t, lambent::library::Scene> scenes;
  std::map<uint64_t, std::unique_ptr<lambent::library::View>> views;
  std::string message; // of the last failed call
  bool dead = false;
  std::atomic<bool> busy = false; // a call is on its way

  explicit lambent_device(const lambent_device_desc& from);

  void log(lambent_level level, const std::string& line) const {
    if (desc.log) desc.log(desc.user, level, line.c_str());
  }
};
