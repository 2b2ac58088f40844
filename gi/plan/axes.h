// The four axes of a technique of virtual lights: where the lights stand, who sees them, where their light is gathered,
// how it is put together. Only who composes a technique branches on them (gi/frame/compose.cpp); everybody else asks
// what the technique needs (gi/plan/needs.h).
#pragma once

#include <string>

namespace lambent {

/// Who places the virtual lights.
enum class VplSource : int { Smc, Ir, Mir, Tcas, Poisson, Rsm, Isr, Hisr, None };
/// Who says which pixel a virtual light reaches.
enum class VplVisibility : int { Maps, Rays, None };
/// Where light is gathered. With rays, at every pixel from every light, whatever this says.
enum class GatherMode : int {
  Interleaved,
  Lists,
  Full,
  Multires,
  MultiresInterleaved,
  Splat,
  SplatPerVpl,
  Volume,
  Cube,
  Own
};
/// How the frame's light is put together from what was gathered.
enum class Reconstruction : int { None, Filter, Upsample, UpsampleFilter };

/// How a technique's virtual lights come to be.
enum class LightSupply {
  None,       // it has none
  Kept,       // sampled on the CPU, kept from frame to frame and brought up to date
  Fixed,      // samples of all surfaces, which stay where they are
  PerFrame,   // sampled on the CPU, all placed again in every frame
  Reflective, // drawn on the GPU into reflective shadow maps: light of punctual lights, reflected once
};

// The values of the axes: for people, and what each brings along.
struct SourceRow {
  const char* name;
  const char* help;
  LightSupply lights = LightSupply::None;
  bool tree = false, anyView = false; // as in Needs
};
inline constexpr SourceRow kSources[] = {
    {.name = "smc", .help = "sequential Monte Carlo set", .lights = LightSupply::Kept},
    {.name = "ir", .help = "photons from the lights", .lights = LightSupply::PerFrame, .anyView = true},
    {.name = "mir", .help = "paths from the camera, by their light", .lights = LightSupply::PerFrame},
    {.name = "tcas", .help = "Markov chains over shadow maps", .lights = LightSupply::PerFrame},
    {.name = "poisson", .help = "Poisson samples over all surfaces", .lights = LightSupply::Fixed, .anyView = true},
    {.name = "rsm", .help = "grid over reflective shadow maps", .lights = LightSupply::Reflective},
    {.name = "isr", .help = "smooth patches of reflective shadow maps", .lights = LightSupply::Reflective},
    {.name = "hisr", .help = "trees over reflective shadow maps", .lights = LightSupply::Reflective, .tree = true},
    {.name = "none", .help = "no virtual lights"},
};
struct VisibilityRow {
  const char* name;
  const char* help;
};
inline constexpr VisibilityRow kVisibilities[] = {
    {"maps", "paraboloid shadow maps"},
    {"rays", "a ray for every pixel and light (paper 1, fig. 8)"},
    {"none", "nobody: every light reaches every pixel"},
};
struct GatherRow {
  const char* name;
  const char* help;
  bool subsets = false, lists = false, patches = false, splats = false, volume = false, stored = false;
};
inline constexpr GatherRow kGathers[] = {
    {.name = "interleaved", .help = "pixels, each of 4x4 from a sixteenth of the lights", .subsets = true},
    {.name = "lists",
     .help = "pixels, from lights chosen for each tile by what they bring",
     .subsets = true,
     .lists = true},
    {.name = "full", .help = "every pixel from every light"},
    {.name = "multires", .help = "every patch from every light", .patches = true},
    {.name = "multires-interleaved", .help = "patches of each of the 16 subsets", .subsets = true, .patches = true},
    {.name = "splat", .help = "every light into the patches", .patches = true, .splats = true},
    {.name = "splat-per-vpl", .help = "every light into patches of its own", .patches = true, .splats = true},
    {.name = "volume", .help = "pixels, from a grid that light propagates through", .volume = true},
    {.name = "cube", .help = "a layered depth cube over the scene, kept from frame to frame", .stored = true},
    {.name = "own", .help = "a provider of the technique's own"},
};
inline constexpr const char* kReconstructions[] = {"none", "filter", "upsample", "upsample, filter"};

constexpr const SourceRow& rowOf(VplSource source) { return kSources[int(source)]; }
constexpr const VisibilityRow& rowOf(VplVisibility visibility) { return kVisibilities[int(visibility)]; }
constexpr const GatherRow& rowOf(GatherMode mode) { return kGathers[int(mode)]; }

struct Axes {
  VplSource source = VplSource::Smc;
  VplVisibility visibility = VplVisibility::Maps;
  GatherMode gather = GatherMode::Lists;
  Reconstruction reconstruction = Reconstruction::Filter;
};

/// Says why these do not go together, in one line that names the setting to change; empty where they do.
std::string whyNot(const Axes& axes);

/// Returns what puts gathered light together, for a gather mode and a filter that is on or off.
Reconstruction reconstructionOf(GatherMode gather, bool filter);

} // namespace lambent
