// lambent doctor: what this machine offers, and whether the whole pipeline runs on it.
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/platform/gl_context.h"
#include "engine/trace/embree_query.h"
#include "tools/lambent/commands.h"

#include <cmath>
#include <cstdio>
#include <thread>

namespace lambent {

namespace {

void doctor(const OutputOptions& output) {
  GlContext context = GlContext::headless();
  Value j;
  std::vector<std::pair<std::string, std::string>> rows = context.info();
  const std::vector<DeviceDescription> devices = GlContext::devices();
  for (size_t i = 0; i < devices.size(); ++i) rows.emplace_back("device " + std::to_string(i), devices[i].name);
  rows.emplace_back("embree", EmbreeQuery::version());
  rows.emplace_back("cores", std::to_string(std::thread::hardware_concurrency()) + " (" +
                                 std::to_string(threadCount()) + " used)");
  rows.emplace_back("bundled scenes", findContentFolder().string());

  LaunchOptions launch;
  launch.scene = (findContentFolder() / "cornell/cornell.gltf").string();
  launch.size = "64x64";
  launch.set = {"smc.vpls=256", "smc.warmup=10"};
  const auto opened = openLaunch(launch);
  GiFrame gi(opened->settings);
  gi.run(opened->at(0));
  const FrameStats stats = gi.run(opened->at(0));
  double indirect = 0;
  bool finite = true;
  const Image image = gi.read(Buffer::Indirect);
  for (const vec3& p : image.pixels) {
    indirect += luminance(p) / double(image.pixels.size());
    finite = finite && isFinite(p);
  }
  rows.emplace_back("shadow maps by", stats.shadowMaker);
  rows.emplace_back("GPU times by", stats.timing == "finish"
                                        ? "finishing each pass (timer queries lie here, or were not chosen)"
                                        : "timer queries");
  for (const auto& [name, value] : rows) j[name] = value;
  const bool healthy = finite && indirect > 0 && glDebugErrors() == 0;
  j["pipeline"] = healthy;
  writeJson(output.json, j);
  if (!output.quiet) {
    for (const auto& [name, value] : rows) std::printf("%-18s %s\n", name.c_str(), value.c_str());
    std::printf("%-18s %s (mean indirect radiance of a small Cornell box %.4f W/(m2 sr), frame %.0f ms)\n", "pipeline",
                healthy ? "runs" : "FAILS", indirect, stats.wallMs);
  }
  if (!healthy)
    throw RunError("the pipeline gave " + std::string(finite ? "no indirect light" : "values that are not finite") +
                   ", " + std::to_string(glDebugErrors()) + " OpenGL errors");
}

} // namespace

void declareDoctor(CLI::App& app) {
  auto output = std::make_shared<OutputOptions>();
  Command command(app, "doctor", "what this machine offers, and whether the pipeline runs on it");
  command.output(*output, "");
  command.run([output] { doctor(*output); });
}

} // namespace lambent
