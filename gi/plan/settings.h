// Every knob of the GI module: default, unit, range and what it costs. The same names are used by `--set group.name`,
// by shot files and by the walkthrough's panel. `settingsTable()` lists them; nothing else holds a tunable number.
#pragma once

#include "engine/core/math.h"
#include "gi/plan/axes.h"

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lambent {

enum class ShadowMaker : int { Auto, Raster, Rays }; // who draws paraboloid maps
// What a VPL stands for: π r_k²/k (paper 1) | the same over neighbours on its side | its cell of the surface, sampled.
enum class DensityEstimator : int { Knn, KnnSide, Cells };
// What splits a patch: distance from its plane | largest less least depth (papers 2 and 3).
enum class PatchCriterion : int { Plane, Depth };
// Between patches: bilinear weights times how alike their surfaces are | bilinear alone (papers 2 and 3).
enum class PatchUpsample : int { Bilateral, Bilinear };
// Who tests emissive surfaces against pixels in direct light: samples with shadow maps | patches with rays (paper 4).
enum class EmitterShadows : int { Samples, Patches };
enum class FirstMaps : int { Auto, Whole, Half, Quarter };
enum class AreaTracer : int { Auto, Cpu, Gpu }; // who traces rays of these patches
// What splits them: how many rays their quarters and those next to them find open | which rays their quarters do (paper
// 4) | which the eight patches around do (Nichols et al. 2010).
enum class AreaRefinement : int { Counts, SubFragments, Neighbours };
// Between them: three radial basis functions, of which a patch's is as wide as what lies between its quarters | level
// by level, as PatchUpsample | around patches' centres, as paper 4 writes it.
enum class AreaUpsample : int { Rbf, Bilateral, Bilinear, RbfCentres };
constexpr bool fitsBasisFunctions(AreaUpsample upsample) {
  return upsample == AreaUpsample::Rbf || upsample == AreaUpsample::RbfCentres;
}
// Who says which entries of the layered depth cube a light sees: a ray each | the texels of hemicubes (paper 5).
enum class CubeVisibility : int { Rays, Hemicubes };
// Where the lobes of light volumes look that go on through a face: the way that the light came | along the face's
// normal.
enum class VolumeLobes : int { Way, Face };
enum class CubeMaker : int { Auto, Raster, Rays }; // who makes hemicubes
// Who brings direct light of what has a size (emissive surfaces, the sky, suns' disks): few rays from every pixel,
// averaged over frames and denoised | shadow maps of points that stand for it.
enum class SoftLightBy : int { Rays, Maps };
enum class SoftSurfaces { Image, Rays };
enum class FilterKernel : int { Separable, Whole };        // rows then columns | all 49 taps at once
enum class ToneMapper : int { Reinhard, Neutral, Filmic }; // shaders/shared/tone_map.h
enum class AntiAliasing : int { Off, Edges };              // shaders/antialias.frag
enum class EffectMode : int { Auto, On, Off };         // as the plan says (gi/plan/effects.h) | forced, for comparison
enum class TimingMode : int { Auto, Queries, Finish }; // GPU timer queries | glFinish around each pass

/// Parts of the work that a scene or a frame may do without: see gi/plan/effects.h.
enum class EffectId : int {
  Indirect,
  Bounces,
  Emissive,
  Sky,
  Alpha,
  Textures,
  Motion,
  MapRefresh,
  Relight,
  Replace,
  Filter,
  History,
  Glossy,
  Mirrors,
  NormalMaps,
  SoftShadows,
  Gather,
  Redraw,
};
inline constexpr size_t kEffects = size_t(EffectId::Redraw) + 1;

struct EffectSettings {
  EffectMode modes[kEffects] = {};
  EffectMode& operator[](EffectId id) { return modes[size_t(id)]; }
  EffectMode operator[](EffectId id) const { return modes[size_t(id)]; }
  bool operator==(const EffectSettings&) const = default;
};

struct VplSettings {
  VplSource source = VplSource::Smc;
  VplVisibility visibility = VplVisibility::Maps;
  int mirCandidates = 256; // mir: paths per VPL slot to choose from (paper 1, 5.1: 256:1)
  int tcasIterations = 16; // tcas: Metropolis–Hastings iterations per VPL and frame (paper 1, 5.1)
  bool operator==(const VplSettings&) const = default;
};

struct SmcSettings {
  int vpls = 2048;         // slots N
  int moves = 16;          // M_max, replacements per frame
  int candidateRays = 16;  // candidate rays per candidate drawn (16:1 resampling)
  int poolFrames = 16;     // frames that a candidate is kept at most; 1 = all redrawn in every frame (paper 1)
  int paths = 16;          // light paths per VPL radiosity estimate
  int bounces = 3;         // B: B=1 is light → VPL → pixel
  int points = 2048;       // directly visible points X
  int validationRays = 16; // V, rays per point and round towards unverified VPLs
  int warmup = 100;        // iterations before the first frame
  bool shortWarmup = true; // fewer where the scene's rays are slow
  int neighbours = 0;      // k of the density for rendering; 0 = max(1, ⌊√(N/32)⌋), see gi/README
  bool cache = true;       // keep light paths until geometry that they touch moves; same results
  DensityEstimator density = DensityEstimator::Cells;
  bool operator==(const SmcSettings&) const = default;
};

struct ShadowSettings {
  int resolution = 128; // texels per side of a VPL's paraboloid map
  ShadowMaker maker = ShadowMaker::Auto;
  float bias = 0.4f; // depth left for round-off and curved receivers, texels of the map at the receiver
  int refresh = 48;  // VPL maps' worth of texels drawn again per frame where objects moved, brightest lights first
  FirstMaps firstMaps = FirstMaps::Auto; // how the first VPL maps of a scene are drawn
  int motionRays = 16;                   // rays that look whether a light sees a moved object; 0 = assume that it does
  // Texels per side of a punctual light's map; 0 follows the frame, with w its width rounded up to a power of two.
  int sunResolution = 0;   // 2w
  int pointResolution = 0; // w/2 per cube face
  int spotResolution = 0;  // w
  int emitterSamples = 16; // shadowed samples that stand for all emissive surfaces in direct light
  int emitterResolution = 256;
  EmitterShadows emitters = EmitterShadows::Samples; // who says what of emissive surfaces is seen
  bool rays = true;                                  // ask rays where maps of direct light are in doubt
  int skyMaps = 32;                                  // directions that stand for the sky in direct light
  int skyResolution = 256;
  bool operator==(const ShadowSettings&) const = default;
};

/// Light that comes straight from lamps, suns, emissive surfaces and the sky.
struct DirectSettings {
  bool on = true;
  SoftLightBy soft = SoftLightBy::Rays;
  SoftSurfaces surfaces = SoftSurfaces::Rays; // rays: where samples start
  int samples = 2;                            // rays: of a pixel in each frame
  int mostSamples = 16;                       // rays: of a pixel whose mean over frames holds few of them
  int frames = 64;                            // rays: that are averaged
  bool operator==(const DirectSettings&) const = default;
};

/// Direct light of emissive surfaces by patches of the image (paper 4).
struct AreaSettings {
  AreaRefinement refinement = AreaRefinement::Counts;
  int rays = 16;     // per sub-fragment: a quarter of a patch, or of a pixel's rays
  int threshold = 3; // how far sub-fragments (of neighbours: all their rays) differ that a patch is split
  int gradient = 4;  // bits between neighbouring sub-fragments beyond which both are split twice; 0 = never twice
  bool extra = true; // three more single pixels in patches of 8×8 pixels and larger
  AreaUpsample upsample = AreaUpsample::Rbf;
  AreaTracer tracer = AreaTracer::Auto;
  bool operator==(const AreaSettings&) const = default;
};

struct GatherSettings {
  GatherMode mode = GatherMode::Lists;
  int lights = 48;    // lists: of each pixel
  int tile = 4;       // lists: pixels along a side of a tile
  float disk = 1;     // r² + disk·a/π instead of r²: bounds every VPL by its own area a (1: paper 3's disk; 0: off)
  float nearDisk = 4; // times disk where pixels cast near rays: a place on a cell's rim is as near as its VPL
  float clamp = 0;    // largest geometry term G, 1/m² (paper 1's hand-set clamp); 0 = none
  int near = 8; // rays per 4×4 pixels of subsets (else per pixel) for what disk and clamp take from near VPLs; 0: lost
  float nearLimit = 8; // radiance of a near surface counts up to so many times its VPL's; 0 = whatever it is
  bool checks = true;  // subsets, still: rays check what maps say (gi/gather/map_checks.h)
  bool glossy = true;  // visible surfaces reflect by their roughness and metalness too (shaders/shared/ggx.h)
  float spread = 0.5f; // glossy: α² + spread·a·cosθ/(π r²) for a VPL of area a; 0 = a point
  int mirrors = 1;     // rays per pixel for what smooth surfaces mirror (gi/near/mirror_rays.h); 0: as by 0.3
  bool operator==(const GatherSettings&) const = default;
};

/// Patches of the image that gather as one (papers 2 and 3).
struct MultiresSettings {
  int coarsest = 16; // patches along the image's longer side at the coarsest level
  int finest = 1;    // side of the smallest patch, pixels
  PatchCriterion criterion = PatchCriterion::Plane;
  float depth = 0.02f; // what the criterion allows at most, share of the view distance; 0 splits all
  float normal = 0.2f; // range of a component of the normal that splits it
  bool balance = true; // neighbours differ by one level at most
  bool edges = true;   // patches next to an edge are 2×2 pixels at most
  PatchUpsample upsample = PatchUpsample::Bilateral;
  float detail = 0;    // α of paper 2's surface detail
  float light = 0.05f; // splat-per-vpl: range of a VPL's light that splits a patch, share of its light on what faces it
  bool operator==(const MultiresSettings&) const = default;
};

/// Lights from reflective shadow maps (papers 2 and 3).
struct RsmSettings {
  int resolution = 256; // texels per side of a light's map, of each face of a point light's
  int vpls = 256;       // rsm: about as many on a regular grid over all maps
  bool exact = true;    // solid angle of every texel; off: all of a map the same, as the papers
  int coarsest = 32;    // isr, hisr: patches per side of a map at the coarsest level
  int finest = 256;     // and at the finest
  float depth = 0.05f;  // isr: as MultiresSettings::depth, seen from the light
  float normal = 0.2f;  // isr: as MultiresSettings::normal
  float tau = 0.004f;   // hisr: bound of a cluster's contribution that splits it, share of the brightest map's light
  bool operator==(const RsmSettings&) const = default;
};

/// A grid that light propagates through (Kaplanyan and Dachsbacher 2010; paper 4).
struct VolumeSettings {
  int cells = 16;        // along each edge
  float size = 0;        // edge, metres, of a grid that follows the camera; 0 = all of the scene
  int steps = 32;        // of propagation, a cell each
  bool occlusion = true; // surfaces stop light; off: it goes through walls
  VolumeLobes lobes = VolumeLobes::Way;
  bool operator==(const VolumeSettings&) const = default;
};

/// The layered depth cube: irradiance of all surfaces, whatever the view (paper 5).
struct CubeSettings {
  int resolution = 128; // texels along an edge of a cube
  int levels = 0;       // of a tree of cubes below the one over all of the scene
  float split = 0.15f;  // share of edges among a cube's entries that makes eight of it
  CubeVisibility visibility = CubeVisibility::Rays;
  int hemicube = 128; // texels along an edge of a light's hemicube; half of it after the first bounce
  bool operator==(const CubeSettings&) const = default;
};

/// How hemicubes are made. Not what is in the cube: it stays as it is when this changes.
struct HemicubeSettings {
  CubeMaker maker = CubeMaker::Auto;
  bool operator==(const HemicubeSettings&) const = default;
};

struct FilterSettings {
  bool on = true;
  FilterKernel kernel = FilterKernel::Separable; // separable: a third of the time, more error at edges
  float normalPower = 16;                        // weight = max(0, n·n')^power
  float distance = 0.01f; // standard deviation of the plane distance, share of the pixel's view distance
  bool operator==(const FilterSettings&) const = default;
};

/// Indirect light of a pixel, averaged over frames.
struct HistorySettings {
  int frames = 64; // that count; 0 = each frame by itself
  bool operator==(const HistorySettings&) const = default;
};

struct ImageSettings {
  float exposure = 0;   // factor on radiance before tone mapping; 0 = what the first frame asks for
  float adaptation = 0; // seconds until a measured exposure is half of the way to what later frames ask for; 0: never
  ToneMapper toneMapper = ToneMapper::Reinhard;
  AntiAliasing antiAliasing = AntiAliasing::Edges;
  bool operator==(const ImageSettings&) const = default;
};

struct FrameSettings {
  bool overlap = false; // VPLs of this frame are updated while the GPU draws the last ones: their light is a frame late
  bool operator==(const FrameSettings&) const = default;
};

struct DebugSettings {
  bool nan = true; // paint NaN magenta and infinity cyan
  TimingMode timing = TimingMode::Auto;
  bool operator==(const DebugSettings&) const = default;
};

struct Settings;
struct Technique; // gi/plan/techniques.h

/// A number that a technique with a provider of its own reads: declared next to the provider, listed by its row, set
/// like every other setting.
struct OwnSetting {
  const char* name; // "group.name", the group being the technique's
  const char* help; // meaning and cost, one line
  double standard, low, high;
  bool whole = true;
  const char* unit = "";

  double operator()(const Settings& settings) const;
};

struct Settings {
  const Technique* own = nullptr; // a technique with a provider of its own; null: the axes below say everything
  std::map<std::string, double, std::less<>> ownValues; // of OwnSettings that differ from their standard, by name
  VplSettings vpl;
  SmcSettings smc;
  ShadowSettings shadow;
  DirectSettings direct;
  AreaSettings area;
  GatherSettings gather;
  MultiresSettings multires;
  RsmSettings rsm;
  VolumeSettings lpv;
  CubeSettings cube;
  HemicubeSettings hemicubes;
  std::string cubeFile; // that keeps the layered depth cube between runs; empty: none (--cube-file)
  HistorySettings history;
  FilterSettings filter;
  ImageSettings image;
  FrameSettings frame;
  EffectSettings effects;
  DebugSettings debug;
  bool operator==(const Settings&) const = default;
};

/// Returns the axes that the settings amount to.
Axes axesOf(const Settings& settings);
/// Says why the settings contradict each other; empty where they do not.
std::string whyNot(const Settings& settings);

/// Texels between the rays of a scene's first VPL maps: 1, 2 or 4. Those between are traced as `shadow.refresh` comes
/// to them. `rayWork` as in SceneView.
int firstMapStep(FirstMaps setting, float rayWork);

/// Iterations of smc before the first frame: fewer than asked for where rays are slow, but never below 12 for that.
int warmupOf(const SmcSettings& settings, float rayWork);

enum class SettingKind { Flag, Whole, Real, Choice };
enum class Scale { Linear, PowersOfTwo }; // steps that make sense: of a slider, of a sweep
/// What changing a setting costs while frames run, beyond drawing the frame again.
enum class ChangeCost { Nothing, Light, Maps, Set }; // light paths again | maps again too | another set of lights
const char* costText(ChangeCost cost);

/// One setting. Values are numbers: 0 and 1 of a flag, the index of a choice.
struct SettingRow {
  std::string name;      // "smc.vpls"
  std::string help = {}; // meaning and cost, one line
  SettingKind kind = SettingKind::Real;
  double low = 0, high = 0, standard = 0;
  const char* unit = "";
  Scale scale = Scale::Linear;
  ChangeCost change = ChangeCost::Nothing;
  std::vector<std::string> choices = {}; // also of a flag
  std::function<double(const Settings&)> get = {};
  std::function<void(Settings&, double)> set = {}; // a value of the range

  std::string text(double value) const; // as applySetting reads it
  std::string range() const;            // "1..65536", "maps|rays|none"
};
const std::vector<SettingRow>& settingsTable();
/// The row of a setting that one technique owns.
SettingRow rowOf(const OwnSetting& setting);
/// Returns the table and the rows that the chosen technique owns.
std::vector<SettingRow> settingRows(const Settings& settings);
/// Returns the name that a setting has now. The old name of a renamed one is accepted for one version.
std::string_view presentName(std::string_view name);
/// Finds a row of the table or of those that the chosen technique owns. Throws InputError with the nearest name.
SettingRow settingRow(std::string_view name, const Settings& settings = {});

/// Sets `name` from text. Throws InputError that names the setting, what is wrong and the range or the nearest name.
void applySetting(Settings& settings, std::string_view name, std::string_view value);
/// Returns the present value as text.
std::string settingText(const Settings& settings, std::string_view name);

} // namespace lambent
