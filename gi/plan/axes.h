// The four axes of a technique: where light stands, who sees it, where it is gathered, how it is put together. What the
// rest of GI needs to know of a value stands in its row, so that nobody asks which one it is; only who makes a source
// or a gather does.
#pragma once

#include <string>

namespace lambent {

/// Who places the virtual lights.
enum class VplSource : int { Smc, Ir, Mir, Tcas, Poisson, Rsm, Isr, Hisr, None };
struct SourceRow {
  const char* name;
  const char* help;
  bool sampled;    // a list drawn on the CPU (gi/vpl/sources.h)
  bool persistent; // keeps its lights from frame to frame, and brings them up to date
  bool fixed;      // on their surfaces, for good: none is ever replaced
  bool reflective; // from reflective shadow maps, when the picture is drawn: punctual lights only, one bounce
  bool clusters;   // of the maps' texels; else a grid over them
  bool tree;       // clusters of all sizes, chosen by who gathers: no list
  bool anyView;    // its lights are the same wherever the camera is
};
inline constexpr SourceRow kSources[] = {
    {"smc", "sequential Monte Carlo set", true, true, false, false, false, false, false},
    {"ir", "photons from the lights", true, false, false, false, false, false, true},
    {"mir", "paths from the camera, by their light", true, false, false, false, false, false, false},
    {"tcas", "Markov chains over shadow maps", true, false, false, false, false, false, false},
    {"poisson", "Poisson samples over all surfaces", true, true, true, false, false, false, true},
    {"rsm", "grid over reflective shadow maps", false, false, false, true, false, false, false},
    {"isr", "smooth patches of reflective shadow maps", false, false, false, true, true, false, false},
    {"hisr", "trees over reflective shadow maps", false, false, false, true, true, true, false},
    {"none", "no virtual lights", false, false, false, false, false, false, false},
};
constexpr const SourceRow& rowOf(VplSource source) { return kSources[int(source)]; }
/// Who says which pixel a virtual light reaches.
enum class VplVisibility : int { Maps, Rays, None };
struct VisibilityRow {
  const char* name;
  const char* help;
};
inline constexpr VisibilityRow kVisibilities[] = {
    {"maps", "paraboloid shadow maps"},
    {"rays", "a ray for every pixel and light (paper 1, fig. 8)"},
    {"none", "nobody: every light reaches every pixel"},
};
constexpr const VisibilityRow& rowOf(VplVisibility visibility) { return kVisibilities[int(visibility)]; }

/// Where light is gathered. With rays, at every pixel from every light, whatever this says.
enum class GatherMode : int { Interleaved, Full, Multires, MultiresInterleaved, Splat, SplatPerVpl, Volume, Cube, Own };
struct GatherRow {
  const char* name;
  const char* help;
  bool subsets; // each pixel of 4×4 sees a sixteenth of the lights
  bool patches; // of the multiresolution buffer
  bool splats;  // light by light, into the patches
  bool volume;  // in a grid over the scene, which light propagates through
  bool stored;  // once for all views: by lights that do not depend on them
};
inline constexpr GatherRow kGathers[] = {
    {"interleaved", "pixels, each of 4x4 from a sixteenth of the lights", true, false, false, false, false},
    {"full", "every pixel from every light", false, false, false, false, false},
    {"multires", "every patch from every light", false, true, false, false, false},
    {"multires-interleaved", "patches of each of the 16 subsets", true, true, false, false, false},
    {"splat", "every light into the patches", false, true, true, false, false},
    {"splat-per-vpl", "every light into patches of its own", false, true, true, false, false},
    {"volume", "pixels, from a grid that light propagates through", false, false, false, true, false},
    {"cube", "a layered depth cube over the scene, kept from picture to picture", false, false, false, false, true},
    {"own", "a stage of the technique's own", false, false, false, false, false},
};
constexpr const GatherRow& rowOf(GatherMode mode) { return kGathers[int(mode)]; }

/// How the picture's light is put together from what was gathered.
enum class Reconstruction : int { None, Filter, Upsample, UpsampleFilter };
inline constexpr const char* kReconstructions[] = {"none", "filter", "upsample", "upsample, filter"};

struct Axes {
  VplSource source = VplSource::Smc;
  VplVisibility visibility = VplVisibility::Maps;
  GatherMode gather = GatherMode::Interleaved;
  Reconstruction reconstruction = Reconstruction::Filter;
};

/// Whether lights are sampled for the picture: all such sources go with the same visibility and gather.
constexpr bool sharesGather(const Axes& axes) {
  return rowOf(axes.source).sampled && !rowOf(axes.source).fixed && !rowOf(axes.gather).stored;
}

/// Why these do not go together, in one line that names the setting to change; empty where they do.
std::string whyNot(const Axes& axes);

} // namespace lambent
