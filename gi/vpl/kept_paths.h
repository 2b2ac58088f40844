// The path cache: light paths of one radiance estimate with all that their light depends on. A VPL's random numbers
// follow its id, so its paths stay the same until geometry that they touch moves; when only lights change, connections
// to lights are made again and no vertex is (gi/vpl/radiosity.cpp).
#pragma once

#include "gi/lighting/light_paths.h"

#include <cstdint>
#include <vector>

namespace lambent {

/// The last segment that was tested for something in between.
struct KeptConnection {
  vec3 direction{0}; // as of LightConnection::segment
  float reach = 0;   // its tMax; 0: none was tested
  float passes = 1;  // part of its light
};

struct KeptVertex {
  PathVertex at;
  vec3 weight{0}; // turns irradiance/π here into radiance leaving the VPL
  // The ray that looked for the next vertex.
  vec3 direction{0};  // unit
  float distance = 0; // to what it met, m; kInfinity: nothing; 0: no ray
  KeptConnection light = {}, sky = {};
  bool metEmitter = false; // the ray did; see KeptPaths::emitters
};

struct KeptPaths {
  struct EmitterHit {
    uint32_t vertex; // index of the vertex that the ray left
    SurfaceHit hit;
  };
  // What the paths were traced for; another id or number starts from scratch.
  uint64_t id = 0;
  int paths = 0, bounces = 0;
  bool overCell = false;            // started all over a cell, not at the VPL
  bool lastRays = false;            // the last vertices sent rays too, towards emitters and sky
  std::vector<KeptVertex> vertices; // bounces × paths, depth by depth
  std::vector<uint8_t> lengths;     // vertices of each path
  std::vector<EmitterHit> emitters; // by vertex

  void clear() { id = 0; }
};

} // namespace lambent
