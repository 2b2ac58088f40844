#include "tests/hard/hard_case.h"

#include "tests/hard/hard_worlds.h"

namespace lambent::test {

namespace {

std::vector<HardCase> listed(const std::vector<void (*)(const Add&, const Add&)>& lists) {
  std::vector<HardCase> cases;
  const auto adding = [&](ShownBy shownBy) -> Add {
    return [&cases, shownBy](const char* name, const char* reason, const HardBounds& bounds,
                             std::function<void(HardWorld&)> make) -> HardCase& {
      return cases.emplace_back(
          HardCase{.name = name, .reason = reason, .bounds = bounds, .make = std::move(make), .shownBy = shownBy});
    };
  };
  for (const auto& list : lists) list(adding(ShownBy::All), adding(ShownBy::OneOfEachKind));
  return cases;
}

void addLongCases(const Add& add, const Add&) {
  add("TenThousandLamps", "more lamps than virtual lights", {0.65, 1.05}, [](HardWorld& w) {
    w.room();
    lamps(w, 10000);
    w.frames = 2;
  });
  add("ManyVpls", "N = 65536: more layers than an array of textures holds", kRoom, [](HardWorld& w) {
    roomOf(w, 1);
    w.settings.smc.vpls = w.settings.smc.points = 65536;
    w.settings.shadow.resolution = 16;
  });
  add("ALongStand", "10⁵ frames in which nothing changes: counts of pictures saturate", {0.65, 1.05, 0.01},
      [](HardWorld& w) {
        roomOf(w, 1);
        w.scene.camera.width = 8, w.scene.camera.height = 5;
        w.frames = 100000;
      });
}

} // namespace

const std::vector<HardCase>& longCases() {
  static const std::vector<HardCase> cases = listed({addLongCases});
  return cases;
}

const std::vector<HardCase>& hardCases() {
  static const std::vector<HardCase> cases =
      listed({addLightCases, addPlaceCases, addSurfaceCases, addMovingCases, addSettingCases});
  return cases;
}

} // namespace lambent::test
