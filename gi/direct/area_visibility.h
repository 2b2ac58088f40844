// What a fragment of an image sees of the area lights: rays towards them from its parts, and which share of their
// light these find open.
#pragma once

#include "engine/trace/ray_query.h"
#include "gi/direct/frame_surfaces.h"
#include "gi/lighting/area_lights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

namespace lambent {

inline constexpr int kMostAreaRays = 64; // from a quarter: bits of a word

/// What a fragment saw.
struct AreaSeen {
  std::array<uint64_t, 4> bits{}; // by sub-fragment; of a single pixel by quarter of its rays
  vec3 visible{0};                // share of the unshadowed light
  std::array<uint8_t, 4> asked{}; // rays that have an answer, by sub-fragment
  uint64_t rays = 0;              // that were traced

  /// Share of a sub-fragment's rays that are open; −1 where no light could reach it.
  float open(size_t s) const { return asked[s] > 0 ? float(std::popcount(bits[s])) / float(asked[s]) : -1; }

  bool lit() const {
    return std::any_of(bits.begin(), bits.end(), [](uint64_t b) { return b != 0; });
  }
};

/// Where the four sub-fragments of a patch send their rays: each to samples of its own, so that together they know most
/// of the lights; or all to the same, so that answers can be compared one by one (paper 4, 3.1.2).
enum class AreaAims { Own, Same };

/// Asks the rays of many fragments: from all threads, or where the query belongs to one, in long lists.
class AreaVisibility {
 public:
  AreaVisibility(const RayQuery& rays, const AreaLights& lights, const FrameSurfaces& surfaces, int raysPerPart,
                 AreaAims aims = AreaAims::Own)
      : rays_(rays), lights_(lights), surfaces_(surfaces), count_(raysPerPart), aims_(aims) {}

  /// Asks for patches of 2^level pixels, level ≥ 1, of which `texels` are the numbers.
  std::vector<AreaSeen> ofPatches(std::span<const glm::ivec2> texels, int level) const;
  /// Asks for pixels. Unless `askAll`: where a quarter of a pixel's rays is open, the others are not traced.
  std::vector<AreaSeen> ofPixels(std::span<const glm::ivec2> pixels, bool askAll) const;
  /// Asks all rays of pixels, each to the same sample from all of them, so that answers can be compared (as Nichols et
  /// al. 2010 do).
  std::vector<AreaSeen> ofPixelsAlike(std::span<const glm::ivec2> pixels) const;
  /// Asks for the four pixels of each of some patches of level 1 that have been asked: all their rays, of which the
  /// patches' are a quarter.
  std::vector<AreaSeen> ofQuads(std::span<const glm::ivec2> texels, std::span<const AreaSeen> patches) const;
  /// Says whether two adjacent pixels show one smooth surface.
  bool oneSurface(const glm::ivec2& a, const glm::ivec2& b) const;
  /// Looks from a pixel: adds to `brought` what each light brings where nothing is between, as a luminance, and to
  /// `asked` a ray to each that brings any.
  void askEach(const glm::ivec2& pixel, std::span<double> brought, std::vector<std::pair<uint32_t, Ray>>& asked) const;
  /// Pixel in the middle of a patch.
  glm::ivec2 middleOf(const glm::ivec2& texel, int level) const {
    return clamped(texel * (1 << level) + (1 << level) / 2);
  }

 private:
  struct Question;
  struct Place {
    vec3 position, normal;
  };
  /// What the lights bring where nothing is between.
  struct Unshadowed {
    std::vector<vec3> light;
    float total = 0; // luminance
  };
  Unshadowed unshadowedAt(const Place& place) const;
  /// At the middle of a patch, or where that gets none, at the first of its parts that gets any.
  Unshadowed unshadowedAround(const Place& middle, const std::array<Place, 4>& parts) const;
  Ray rayTo(const AreaSample& sample, const Place& from) const;
  std::array<Place, 4> partsOf(const glm::ivec2& texel, int level) const;
  Place placeAt(const glm::ivec2& pixel) const;
  glm::ivec2 clamped(const glm::ivec2& p) const {
    return glm::min(p, glm::ivec2(surfaces_.width - 1, surfaces_.height - 1));
  }
  /// Draws the samples that rays go to, in proportion to what the lights bring to the receiver. `alike`: ray k goes
  /// where the others of k / 4 go.
  void choose(Question& q, bool alike = false) const;
  /// The same in proportion to what the lights bring to the image.
  void chooseForAll(Question& q) const;
  void draw(Question& q, bool alike) const;
  void aim(Question& q, int k, const Place& place) const;
  void addUp(const Question& q, AreaSeen& to) const;
  /// `begin(i, q)` aims the rays of question i; `asked(i, q)` takes the answers and says whether there is more to
  /// trace.
  template <class Begin, class Asked> void ask(size_t count, const Begin& begin, const Asked& asked) const;
  template <class Choose>
  std::vector<AreaSeen> askPixels(std::span<const glm::ivec2> pixels, bool askAll, const Choose& choose) const;

  int all() const { return 4 * count_; }

  const RayQuery& rays_;
  const AreaLights& lights_;
  const FrameSurfaces& surfaces_;
  int count_; // of a quarter
  AreaAims aims_;
};

} // namespace lambent
