#include "tests/hard/hard_worlds.h"

namespace lambent::test {

namespace {

/// The room with settings of its own.
std::function<void(HardWorld&)> roomWith(std::map<std::string, std::string> set) {
  return [set](HardWorld& w) {
    roomOf(w, 1);
    for (const auto& [name, value] : set) applySetting(w.settings, name, value);
  };
}

} // namespace

void addSettingCases(const Add& add, const Add& some) {
  add("OneVpl", "N = 1", {0, 3}, roomWith({{"smc.vpls", "1"}}));
  add("ThreeVpls", "N = 3: fewer lights than neighbours and subsets", {0.2, 2}, roomWith({{"smc.vpls", "3"}}));
  add("MoreNeighboursThanLights", "k = 1024 of 16", {0.5, 1.1},
      roomWith({{"smc.vpls", "16"}, {"smc.density", "knn"}, {"smc.neighbours", "1024"}}));
  add("NoMoves", "M_max = 0", kRoom, roomWith({{"smc.moves", "0"}}));
  add("AllMove", "M_max = N", {0.65, 1.05, 0.8}, roomWith({{"smc.moves", "64"}}));
  add("NoBounce", "B = 0: direct light alone", {0, 0}, roomWith({{"smc.bounces", "0"}}));
  add("ManyBounces", "B = 32", {0.9, 1.6}, roomWith({{"smc.bounces", "32"}}));
  add("NoBoundOfEnergy", "1/r² as it is: no disk, no rays for what it takes", {0.5, 1.5},
      roomWith({{"gather.disk", "0"}, {"gather.near", "0"}}));
  add("NoHistory", "every picture by itself", {0.5, 1.1}, roomWith({{"history.frames", "0"}}));
  some("OneVisiblePoint", "X = 1: one point stands for all that is seen", {0.4, 1.6}, roomWith({{"smc.points", "1"}}));
  some("NoWarmup", "the first frame's set is the last one's", {0.5, 1.1}, roomWith({{"smc.warmup", "0"}}));
  some("OnePathEach", "a light's radiance is that of one path", {0.5, 1.1},
       roomWith({{"smc.paths", "1"}, {"smc.candidateRays", "1"}}));
  some("OneLightEach", "a pixel gathers one light of 64", {0.5, 1.1}, roomWith({{"gather.lights", "1"}}));
}

} // namespace lambent::test
