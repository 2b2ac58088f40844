// lambent soak SCENE: many frames in which anything may change, through the whole frame. After each all must be whole
// (gi/measure/runs/runs.h); memory, of the program and of OpenGL, must not grow.
#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/core/rng.h"
#include "engine/gl/objects.h"
#include "engine/platform/gl_context.h"
#include "gi/measure/runs/runs.h"
#include "tools/lambent/commands.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <unistd.h>

namespace lambent {

namespace {

struct SoakOptions {
  LaunchOptions launch;
  OutputOptions output;
  int frames = 2000;
  std::string record;
};

/// Random changes of what was opened, the same for the same seed.
class Edits {
 public:
  Edits(LaunchContext& opened, uint32_t seed) : opened_(opened), random_(seed, Stream::Test, 0) {
    Registry& registry = opened.scene.registry;
    bounds_ = worldBounds(opened.scene);
    registry.each<MeshInstance, Transform>([&](Entity e, const MeshInstance&, const Transform& t) {
      if (!t.matrix) objects_.emplace_back(e, t);
    });
    registry.each<PunctualLight>([&](Entity e, const PunctualLight& l) { lights_.emplace_back(e, l.intensity); });
    opened.cameraGiven = true;
  }

  /// Some frames change nothing, most one thing, some several.
  void next() {
    for (size_t n = below(4) == 0 ? 0 : 1 + below(3) * below(2); n > 0; --n) edit();
  }

 private:
  size_t below(size_t n) { return random_.below(uint32_t(n)); }
  float between(float lo, float hi) { return lo + (hi - lo) * random_.next(); }
  vec3 place() {
    return {between(bounds_.lo.x, bounds_.hi.x), between(bounds_.lo.y, bounds_.hi.y),
            between(bounds_.lo.z, bounds_.hi.z)};
  }

  void edit() {
    Registry& registry = opened_.scene.registry;
    CameraView& camera = opened_.camera;
    switch (below(7)) {
    case 0: // a cut
    case 1: {
      const int width = camera.width, height = camera.height;
      const vec3 from = place();
      camera = lookAt(from, place(), between(0.2f, 2));
      camera.near = 1e-3f * bounds_.diameter();
      camera.width = width, camera.height = height;
      break;
    }
    case 2:
      camera.worldFromView[3] += vec4(0.002f * (place() - bounds_.centre()), 0);
      break;
    case 3:
      camera.width = 3 + int(below(40)), camera.height = 2 + int(below(24));
      break;
    case 4:
      if (objects_.empty()) break;
      if (const auto& [e, home] = objects_[below(objects_.size())]; below(3) == 0)
        registry.get<Transform>(e) = home;
      else
        registry.get<Transform>(e).translation = home.translation + 0.1 * dvec3(place() - bounds_.centre());
      break;
    case 5:
      if (lights_.empty()) break;
      if (const auto& [e, home] = lights_[below(lights_.size())]; true)
        registry.get<PunctualLight>(e).intensity = home * std::exp2(between(-4, 4));
      break;
    default:
      if (lamps_.size() > below(8)) {
        registry.destroy(lamps_.back());
        lamps_.pop_back();
      } else {
        LightView lamp;
        lamp.position = place();
        lamp.intensity = vec3(0.01f * bounds_.diameter() * bounds_.diameter());
        lamps_.push_back(addLight(opened_.scene, lamp, "soak"));
      }
      break;
    }
  }

  LaunchContext& opened_;
  Rng random_;
  Aabb bounds_;
  std::vector<std::pair<Entity, Transform>> objects_;
  std::vector<std::pair<Entity, vec3>> lights_;
  std::vector<Entity> lamps_;
};

double residentMiB() {
  size_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return double(resident) * double(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

double openGlMiB() {
  uint64_t bytes = 0;
  for (const auto& [owner, of] : gl::memoryByOwner()) bytes += of;
  return double(bytes) / (1 << 20);
}

/// Each technique is at work eight times, twice in each quarter of the frames.
const Technique& techniqueAt(int frame, int frames) {
  const int64_t count = int64_t(techniqueTable().size());
  return techniqueTable()[size_t(8 * count * frame / frames % count)];
}

/// Largest over the second and over the last quarter of the frames.
struct Growth {
  double early = 0, late = 0;
  void add(double value, int frame, int frames) {
    if (4 * frame >= frames && 2 * frame < frames) early = std::max(early, value);
    if (4 * frame >= 3 * frames) late = std::max(late, value);
  }
  /// To so many MiB, and that share.
  bool flat(double slack, double share) const { return late <= (1 + share) * early + slack; }
};

/// The camera's way as a shot that grows by every frame, as a recorded walk does.
class Recorded {
 public:
  Recorded(const Scene& scene, const std::string& file) {
    if (file.empty()) return;
    Shot shot;
    shot.scene = std::filesystem::absolute(scene.file);
    writer_.emplace(shot, file);
  }
  void add(const CameraKey& key) {
    if (writer_) writer_->add(key, {});
  }
  void end(double seconds) {
    if (writer_) writer_->end(seconds);
  }

 private:
  std::optional<ShotWriter> writer_;
};

void soak(const SoakOptions& options) {
  const auto opened = openAndSay(options.launch, options.output.quiet, WatchUntil::FirstPicture);
  needPunctualLight(*opened);
  GlContext context = GlContext::headless();
  Viewer gi(opened->settings, opened->seed);
  Edits edits(*opened, opened->seed);
  Recorded recorded(opened->scene, options.record);
  Growth program, openGl;
  int frame = 0;
  {
    Progress progress("soaking", options.output.quiet);
    for (; frame < options.frames && !interrupted; ++frame) {
      if (frame > 0) edits.next();
      applyTechnique(gi.settings(), techniqueAt(frame, options.frames));
      const std::string at = "frame " + std::to_string(frame) + ", " + techniqueOf(gi.settings()).name + ": ";
      gi.run(opened->at(frame / 30.0));
      if (const std::string defect = defectOf(gi, gi.settings()); !defect.empty()) throw RunError(at + defect);
      if (glDebugErrors() > 0) throw RunError(at + "OpenGL reported errors (logged above)");
      recorded.add(keyOf(opened->camera, opened->scene.origin, frame / 30.0));
      program.add(residentMiB(), frame, options.frames);
      openGl.add(openGlMiB(), frame, options.frames);
      progress.update(frame + 1, options.frames);
    }
  }
  recorded.end(frame / 30.0);
  writeJson(options.output.json, Value::of("frames", frame, "program_mib", std::vector{program.early, program.late},
                                           "opengl_mib", std::vector{openGl.early, openGl.late}));
  if (!options.output.quiet)
    std::printf(
        "%d frames whole; largest in the second and in the last quarter: program %.0f and %.0f MiB, OpenGL %.1f "
        "and %.1f MiB\n",
        frame, program.early, program.late, openGl.early, openGl.late);
  if (interrupted) throw RunError("interrupted: " + std::to_string(frame) + " frames were whole");
  constexpr int kFewest = 400; // of fewer, each technique's first frame, which allocates, falls into the last quarter
  if (frame < kFewest) {
    if (!options.output.quiet) std::printf("memory is judged from %d frames on\n", kFewest);
    return;
  }
  // What a process holds wavers; what OpenGL was asked for is counted.
  if (!program.flat(16, 0.1) || !openGl.flat(0.25, 0.1)) throw RunError("memory grows (figures above)");
}

} // namespace

void declareSoak(CLI::App& app) {
  auto options = std::make_shared<SoakOptions>();
  Command command(app, "soak", "many frames in which anything changes: each is checked, memory must not grow");
  command.reads("SCENE", options->launch.scene, "glTF or shot file", true);
  command.launch(options->launch);
  command.output(options->output, "");
  command.number("--frames", &options->frames, 1, 100000000, "so many (2000)");
  command.writes("--record", options->record, "keep the camera of every frame in this new shot, as it goes");
  command.run([options] { soak(*options); });
}

} // namespace lambent
