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
enum class GatherMode : int { Interleaved, Full, Multires, MultiresInterleaved, Splat, SplatPerVpl, Volume, Cube, Own };
/// How the frame's light is put together from what was gathered.
enum class Reconstruction : int { None, Filter, Upsample, UpsampleFilter };

/// A value of an axis, for people.
struct AxisRow {
  const char* name;
  const char* help;
};
inline constexpr AxisRow kSources[] = {
    {"smc", "sequential Monte Carlo set"},
    {"ir", "photons from the lights"},
    {"mir", "paths from the camera, by their light"},
    {"tcas", "Markov chains over shadow maps"},
    {"poisson", "Poisson samples over all surfaces"},
    {"rsm", "grid over reflective shadow maps"},
    {"isr", "smooth patches of reflective shadow maps"},
    {"hisr", "trees over reflective shadow maps"},
    {"none", "no virtual lights"},
};
inline constexpr AxisRow kVisibilities[] = {
    {"maps", "paraboloid shadow maps"},
    {"rays", "a ray for every pixel and light (paper 1, fig. 8)"},
    {"none", "nobody: every light reaches every pixel"},
};
inline constexpr AxisRow kGathers[] = {
    {"interleaved", "pixels, each of 4x4 from a sixteenth of the lights"},
    {"full", "every pixel from every light"},
    {"multires", "every patch from every light"},
    {"multires-interleaved", "patches of each of the 16 subsets"},
    {"splat", "every light into the patches"},
    {"splat-per-vpl", "every light into patches of its own"},
    {"volume", "pixels, from a grid that light propagates through"},
    {"cube", "a layered depth cube over the scene, kept from frame to frame"},
    {"own", "a provider of the technique's own"},
};
inline constexpr const char* kReconstructions[] = {"none", "filter", "upsample", "upsample, filter"};

constexpr const AxisRow& rowOf(VplSource source) { return kSources[int(source)]; }
constexpr const AxisRow& rowOf(VplVisibility visibility) { return kVisibilities[int(visibility)]; }
constexpr const AxisRow& rowOf(GatherMode mode) { return kGathers[int(mode)]; }

struct Axes {
  VplSource source = VplSource::Smc;
  VplVisibility visibility = VplVisibility::Maps;
  GatherMode gather = GatherMode::Interleaved;
  Reconstruction reconstruction = Reconstruction::Filter;
};

/// Says why these do not go together, in one line that names the setting to change; empty where they do.
std::string whyNot(const Axes& axes);

/// Returns what puts gathered light together, for a gather mode and a filter that is on or off.
Reconstruction reconstructionOf(GatherMode gather, bool filter);

} // namespace lambent
