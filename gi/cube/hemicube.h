// Five images around a virtual light (Cohen and Greenberg 1985; paper 5, section 4.1), and which entries of the layered
// depth cube they see. World space, metres.
#pragma once

#include "gi/contract/virtual_lights.h"
#include "gi/cube/cube_surfaces.h"

namespace lambent {

/// What a texel of a hemicube sees.
struct HemicubeTexel {
  float distance = kInfinity; // metres; kInfinity: nothing
  vec3 normal{0};             // geometric, unit, towards the light
};

/// One of a hemicube's five images, in the light's frame: the directions of its middle, of its columns and of its rows.
struct HemicubeFace {
  vec3 forward, right, up;
};
inline constexpr HemicubeFace kHemicubeFaces[5] = {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                                   {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                                   {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
                                                   {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
                                                   {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};

/// One image of resolution × resolution texels along the normal, then four of resolution × resolution/2 to its sides:
/// the halves in front of the light. Rows from the horizon up.
struct Hemicube {
  vec3 origin{0};
  mat3 frame{1}; // columns: tangent, bitangent, normal
  int resolution = 0;
  std::vector<HemicubeTexel> texels; // 3 resolution²

  size_t size() const { return 3 * size_t(resolution) * resolution; }
  int rows(int face) const { return face == 0 ? resolution : resolution / 2; }
  /// First row of a face, among the rows of all faces one after the other.
  int firstRow(int face) const { return face == 0 ? 0 : resolution + (face - 1) * (resolution / 2); }
  HemicubeTexel& at(int face, int x, int y) { return texels[index(face, x, y)]; }
  const HemicubeTexel& at(int face, int x, int y) const { return texels[index(face, x, y)]; }
  /// Unit direction through texel coordinates of a face (0, 0 is the corner of the first texel).
  vec3 direction(int face, vec2 at) const;
  /// Finds face and texel coordinates of a direction; false below the horizon.
  bool find(const vec3& direction, int& face, vec2& at) const;

 private:
  size_t index(int face, int x, int y) const { return size_t(firstRow(face) + y) * size_t(resolution) + size_t(x); }
};

/// Sets up an empty hemicube of `light`, from just off its surface.
Hemicube hemicubeAt(const VirtualLight& light, int resolution, float rayEpsilon);
/// Fills a hemicube with rays. Thread-safe.
void castHemicube(Hemicube& hemicube, const RayQuery& rays, RayCounts& counts);

/// Makes hemicubes in another way than with rays on the CPU.
class HemicubeMaker {
 public:
  virtual ~HemicubeMaker() = default;
  /// Fills the hemicubes. Called from the main thread.
  virtual void make(std::span<Hemicube> hemicubes) = 0;
};

/// Marks the entries that a hemicube sees: each texel marks those of its surface that lie in it, as the light sees
/// them, and half a texel around (the splats of paper 5, section 4.3; texels that the same hemicube wrote already are
/// marked already).
void splat(const Hemicube& hemicube, const CubeSurfaces& surfaces, std::vector<uint8_t>& seen);

} // namespace lambent
