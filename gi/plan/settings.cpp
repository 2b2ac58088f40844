#include "gi/plan/settings.h"

#include "engine/core/error.h"
#include "engine/core/text.h"
#include "gi/plan/effects.h"
#include "gi/plan/techniques.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <type_traits>

namespace lambent {

namespace {

constexpr double kNoLimit = 1e30; // far above what anything calls for
using enum Scale;
using enum ChangeCost;

/// Range, unit and steps of a number.
struct Span {
  double low, high;
  const char* unit = "";
  Scale scale = Linear;
};

/// A row's name and where its value is. "smc.vpls" is SETTING(smc, vpls).
#define SETTING(group, value) #group "." #value, &Settings::group, &decltype(Settings::group)::value

class Table {
 public:
  Table() {
    choice(SETTING(vpl, source), namesOf(kSources), Set, "who places virtual lights; named techniques set it");
    choice(SETTING(vpl, visibility), namesOf(kVisibilities), Maps,
           "who tests VPLs against pixels: shadow maps, a ray for every pair (seconds per frame), or nobody");
    number(SETTING(vpl, mirCandidates), {1, 1024, "paths", PowersOfTwo}, Light,
           "mir: light paths per VPL slot to choose from; its time and memory grow with it");
    number(SETTING(vpl, tcasIterations), {0, 1024, "rays", PowersOfTwo}, Light,
           "tcas: Metropolis-Hastings iterations per VPL and frame, a ray each");
    number(SETTING(smc, vpls), {1, 65536, "lights", PowersOfTwo}, Maps,
           "VPL slots N; time of every stage grows with it");
    number(SETTING(smc, moves), {0, 32768, "lights", PowersOfTwo}, Light,
           "M_max, VPLs replaced per frame; each costs a shadow map");
    number(SETTING(smc, candidateRays), {1, 256, "rays", PowersOfTwo}, Light, "rays per candidate drawn");
    number(SETTING(smc, poolFrames), {1, 64, "frames", PowersOfTwo}, Light,
           "frames that a candidate is kept, so that N/poolFrames are drawn per frame, twice that in motion; 1 = all, "
           "as paper 1");
    flag(SETTING(smc, cache), Light,
         "keep light paths until something that they touch moves; same results, 0.5 kB per path");
    number(SETTING(smc, paths), {1, 4096, "paths", PowersOfTwo}, Light, "light paths per VPL and candidate");
    number(SETTING(smc, bounces), {0, 32}, Light, "indirect bounces B; 0 = direct light only");
    number(SETTING(smc, points), {1, 1 << 20, "rays", PowersOfTwo}, Light, "camera rays that find visible points");
    number(SETTING(smc, validationRays), {0, 1024, "rays", PowersOfTwo}, Light,
           "V, rays per visible point and round towards unverified VPLs");
    number(SETTING(smc, warmup), {0, 100000, "frames"}, Light, "iterations before the first frame");
    flag(SETTING(smc, shortWarmup), Light,
         "fewer iterations of smc.warmup (12 at least) where a ray looks at more than 24 triangles, as inspect says");
    number(SETTING(smc, neighbours), {0, 1024, "lights"}, Light,
           "k of knn densities for rendering; 0 = max(1, floor(sqrt(N/32)))");
    choice(SETTING(smc, density), {"knn", "knn-side", "cells"}, Light,
           "what a VPL stands for: paper 1's density, the same by neighbours on its side, or the cell around it");
    number(SETTING(shadow, resolution), {16, 2048, "texels", PowersOfTwo}, Maps,
           "texels per side of a VPL's map; N * resolution^2 * 2 bytes");
    choice(SETTING(shadow, maker), {"auto", "raster", "rays"}, Nothing,
           "who draws VPL maps; auto: rays where the CPU draws anyway, else raster; the window measures both once");
    number(SETTING(shadow, bias), {0, 100, "texels"}, Nothing, "depth bias of VPL maps, texels at the receiver");
    number(SETTING(shadow, refresh), {0, 32768, "maps", PowersOfTwo}, Nothing,
           "VPL maps' worth of texels drawn again per frame where objects moved, brightest lights first");
    choice(SETTING(shadow, firstMaps), {"auto", "whole", "half", "quarter"}, Nothing,
           "VPL maps of a first frame by rays: whole, or with half or a quarter of the rays a side, and whole as "
           "shadow.refresh allows; auto: half where a ray looks at more than 12 triangles, as inspect says, a quarter "
           "above 24");
    number(SETTING(shadow, motionRays), {0, 1024, "rays", PowersOfTwo}, Nothing,
           "rays per VPL and moved object that look whether the one sees the other; 0 = assume so");
    number(SETTING(shadow, sunResolution), {0, 16384, "texels", PowersOfTwo}, Maps,
           "texels per side of a directional light's map; 0 = 2w, w the frame's width rounded up to a power of two");
    number(SETTING(shadow, pointResolution), {0, 8192, "texels", PowersOfTwo}, Maps,
           "texels per side of a point light's cube face; 0 = w/2");
    number(SETTING(shadow, spotResolution), {0, 8192, "texels", PowersOfTwo}, Maps,
           "texels per side of a spot light's map; 0 = w");
    flag(
        SETTING(shadow, rays), Nothing,
        "a ray for each pixel and light (lamps, suns, spots, emissive samples; the sky where none of it is seen) whose "
        "map is in doubt; off, or a host's depth of less than 32 bits: maps are filtered");
    number(SETTING(shadow, emitterSamples), {1, 1024, "samples", PowersOfTwo}, Maps,
           "direct.soft maps: shadowed samples for all emissive surfaces");
    number(SETTING(shadow, emitterResolution), {16, 2048, "texels", PowersOfTwo}, Maps,
           "texels per side of their maps");
    choice(SETTING(shadow, emitters), {"samples", "patches"}, Nothing,
           "who says what of emissive surfaces is seen in direct light: as direct.soft says (maps: "
           "shadow.emitterSamples), "
           "or rays from patches of the image, split where the answers differ (paper 4)");
    flag(SETTING(direct, on), Nothing,
         "direct light; off: indirect light alone, for a host that lights its surfaces itself");
    choice(SETTING(direct, soft), {"rays", "maps"}, Maps,
           "emissive surfaces, sky and suns' disks in direct light: rays from every pixel, averaged over frames and "
           "denoised, or shadow maps of points that stand for them");
    choice(SETTING(direct, surfaces), {"image", "rays"}, Nothing,
           "direct.soft rays: where they start: at the image's surfaces, for which the CPU waits, or at what a ray "
           "through each pixel meets");
    number(SETTING(direct, samples), {1, 256, "samples", PowersOfTwo}, Nothing,
           "direct.soft rays: of every pixel in each frame, each a ray to a light, one to the sky and one anywhere");
    number(SETTING(direct, mostSamples), {1, 256, "samples", PowersOfTwo}, Nothing,
           "direct.soft rays: of a pixel whose mean over frames holds few of them, as along edges of light in motion");
    number(SETTING(direct, frames), {0, 1024, "frames", PowersOfTwo}, Nothing,
           "direct.soft rays: frames that are averaged, each with other samples; 0 = each frame by itself");
    choice(SETTING(area, refinement), {"counts", "sub-fragments", "neighbours"}, Nothing,
           "what splits these patches: how many rays their quarters and those next to them find open, which rays their "
           "quarters do (paper 4), or which rays the eight patches around do (Nichols et al. 2010)");
    number(SETTING(area, rays), {1, 64, "rays", PowersOfTwo}, Nothing,
           "from each quarter of a patch, and four times as many from a single pixel");
    number(SETTING(area, threshold), {1, 256, "rays"}, Nothing,
           "by which quarters side by side differ that a patch is split; the papers ask for 1");
    number(SETTING(area, gradient), {0, 64, "rays"}, Nothing,
           "difference between quarters side by side beyond which both are split twice at once; 0 = never");
    flag(SETTING(area, extra), Nothing,
         "three single pixels more in patches of 8x8 pixels and larger, for area.upsample=rbf and rbf-centres");
    choice(SETTING(area, upsample), {"rbf", "bilateral", "bilinear", "rbf-centres"}, Nothing,
           "between patches: radial basis functions around the three nearest samples, or level by level as "
           "multires.upsample; rbf-centres: a patch is a sample at its centre, not all that lies between its quarters");
    choice(SETTING(area, tracer), {"auto", "cpu", "gpu"}, Nothing,
           "who traces these rays; auto: the CPU where it draws anyway, else the GPU; the window measures both once");
    number(SETTING(shadow, skyMaps), {1, 512, "maps", PowersOfTwo}, Maps, "direct.soft maps: directions of the sky");
    number(SETTING(shadow, skyResolution), {16, 2048, "texels", PowersOfTwo}, Maps, "texels per side of their maps");
    choice(
        SETTING(gather, mode), namesOf(kGathers), Nothing,
        "interleaved: 4x4 subsets and filter; lists: lights chosen for each tile in motion, interleaved where a view "
        "stands; full: every VPL at every pixel (16 times the time); multires: at every patch of the image, or "
        "multires-interleaved: of each subset; splat: VPLs into patches, or splat-per-vpl: each into its own; volume: "
        "a grid that light propagates through; cube: a layered depth cube; own: the technique's");
    number(SETTING(gather, lights), {1, 512, "lights", PowersOfTwo}, Nothing,
           "gather.mode lists: that a pixel gathers in a frame in motion");
    number(SETTING(gather, tile), {2, 64, "pixels", PowersOfTwo}, Nothing,
           "gather.mode lists: along a side of a tile, which chooses lights for its pixels; more where an image would "
           "have over 1024 tiles");
    number(SETTING(gather, disk), {0, 1000}, Nothing,
           "widens r^2 by disk*a/pi: bounds a VPL near by through its own area (1 = paper 3's form factor, 0 = off)");
    number(
        SETTING(gather, nearDisk), {1, 1000}, Nothing,
        "times gather.disk where pixels and patches cast near rays, which give back what it takes; 1 = as elsewhere");
    number(SETTING(gather, clamp), {0, kNoLimit, "1/m^2"}, Nothing,
           "largest geometry term of a VPL, 1/m^2 (paper 1's clamp); 0 = none");
    number(SETTING(gather, near), {0, 256, "rays", PowersOfTwo}, Nothing,
           "rays for what gather.disk and gather.clamp take from near VPLs: per block of 4x4 subsets, else per pixel; "
           "twice as many while light changes, by lists three times, and twice while the camera moves; 0 = lost");
    number(SETTING(gather, nearLimit), {0, kNoLimit}, Nothing,
           "near light: radiance of a surface counts up to so many times its VPL's, four times that where a view "
           "stands, against bright spots; 0 = no limit");
    flag(
        SETTING(gather, checks), Nothing,
        "interleaved gathers, and lists once a view stands: a ray per pixel and 2048 VPLs checks what shadow maps say");
    flag(SETTING(gather, glossy), Nothing,
         "surfaces that the camera sees reflect by roughness and metalness, VPLs as by 0.3 at least; light paths stay "
         "Lambert");
    number(SETTING(gather, mirrors), {0, 16, "rays"}, Nothing,
           "rays per pixel for what surfaces below roughness 0.35 mirror of the scene; 0 = VPLs, as by roughness 0.3");
    number(SETTING(gather, spread), {0, 1000}, Nothing,
           "widens glossy lobes by the angle of a VPL's own area (0 = VPLs are points: sharp spots on polished metal)");
    number(SETTING(multires, coarsest), {1, 1024, "patches", PowersOfTwo}, Nothing,
           "patches along the image's longer side at the coarsest level");
    number(SETTING(multires, finest), {1, 1024, "pixels", PowersOfTwo}, Nothing,
           "side of the smallest patch, whatever it holds, a power of two (paper 2, fig. 8); 4x4 subsets: from 8 on");
    choice(SETTING(multires, criterion), {"plane", "depth"}, Nothing,
           "what splits a patch: distance of its pixels from its plane, or largest less least depth (papers 2 and 3), "
           "which fires on floors seen at a grazing angle");
    number(
        SETTING(multires, depth), {0, kNoLimit}, Nothing,
        "plane: deviation that splits a patch, share of the view distance; depth: range of view depths, share of the "
        "least; 0 = every pixel is gathered");
    number(SETTING(multires, normal), {0, kNoLimit}, Nothing,
           "range of a component of the normal, 0 to 2, that splits a patch");
    flag(SETTING(multires, balance), Nothing, "patches side by side differ by one level at most");
    flag(SETTING(multires, edges), Nothing,
         "patches next to an edge are 2x2 pixels at most; off: light that an edge bounds is spread over larger ones");
    choice(SETTING(multires, upsample), {"bilateral", "bilinear"}, Nothing,
           "between patches: by distance and by how alike their surfaces are, a split one through its parts; or by "
           "distance alone between those that hold light (papers 2 and 3), over edges too");
    number(
        SETTING(multires, detail), {0, 1}, Nothing,
        "darkens indirect light where the surface turns away from the viewer, for detail that patches lost (paper 2)");
    number(SETTING(multires, light), {0, kNoLimit}, Nothing,
           "splat-per-vpl: range of a VPL's light that splits a patch, share of what it brings to a surface facing it");
    number(SETTING(rsm, resolution), {16, 4096, "texels", PowersOfTwo}, Light,
           "texels per side of a light's reflective shadow map, of each face of a point light's");
    number(SETTING(rsm, vpls), {1, 1 << 20, "lights", PowersOfTwo}, Light,
           "rsm: VPLs on a regular grid over all maps, about so many");
    flag(SETTING(rsm, exact), Light, "every texel's own solid angle, instead of a map's mean (the papers')");
    number(SETTING(rsm, coarsest), {1, 256, "patches", PowersOfTwo}, Light,
           "isr, hisr: patches per side of a map at the coarsest level, a power of two");
    number(SETTING(rsm, finest), {1, 1024, "patches", PowersOfTwo}, Light,
           "isr, hisr: patches per side of a map at the finest level, a power of two");
    number(SETTING(rsm, depth), {0, kNoLimit}, Light,
           "isr: deviation from its plane that splits a patch of a map, share of the distance; 0 splits all");
    number(SETTING(rsm, normal), {0, kNoLimit}, Light,
           "isr: range of a component of the normal, 0 to 2, that splits a patch of a map");
    number(SETTING(rsm, tau), {0, 1}, Nothing,
           "hisr: a cluster that may bring more than this share of the brightest map's light is split; 0 splits all");
    number(SETTING(cube, resolution), {16, 2048, "texels", PowersOfTwo}, Nothing,
           "along an edge of a layered depth cube; time to build it and memory grow with the square");
    number(SETTING(cube, levels), {0, 8, "levels"}, Nothing,
           "of a tree of cubes: each halves the texels where cube.split says so; 0 = one cube over all of the scene");
    number(SETTING(cube, split), {0, 1}, Nothing,
           "share of edges among what a cube of the tree holds that makes eight of it; 0 splits all but the empty");
    choice(SETTING(cube, visibility), {"rays", "hemicubes"}, Nothing,
           "who says which entries a light sees: a ray for each, or the texels of five images around it (paper 5)");
    number(SETTING(cube, hemicube), {16, 2048, "texels", PowersOfTwo}, Nothing,
           "along an edge of these images; half of it for lights after the first bounce");
    choice("cube.maker", &Settings::hemicubes, &HemicubeSettings::maker, {"auto", "raster", "rays"}, Nothing,
           "who makes these images; auto: rays where the CPU draws anyway, else raster; the window measures both once");
    number(SETTING(lpv, cells), {4, 128, "cells", PowersOfTwo}, Nothing,
           "gather.mode volume: cells along each edge of the grid; time and memory grow with their cube");
    number(SETTING(lpv, size), {0, kNoLimit, "m"}, Nothing,
           "gather.mode volume: edge of a grid that follows the camera in steps of a cell (of 1e-5 of the scene's "
           "width, at "
           "least); 0 = all of the scene");
    number(SETTING(lpv, steps), {0, 512, "steps", PowersOfTwo}, Nothing,
           "gather.mode volume: cells that light goes from where it was reflected; what is then on its way is lost");
    flag(SETTING(lpv, occlusion), Nothing, "gather.mode volume: surfaces stop light; off: it goes through walls");
    choice(SETTING(lpv, lobes), {"way", "face"}, Nothing,
           "gather.mode volume: where light that passes a cell's face goes on, the way it came or along the face's "
           "normal (as published)");
    number(SETTING(history, frames), {0, 256, "frames", PowersOfTwo}, Nothing,
           "frames that the indirect light of a pixel is averaged over, each by other rays and another part of "
           "the VPLs; 0 = each frame by itself");
    flag(SETTING(filter, on), Nothing,
         "cross-bilateral filter over the 4x4 subsets; denoiser of soft direct light, and of lists in motion");
    choice(SETTING(filter, kernel), {"separable", "whole"}, Nothing,
           "7x7 filter along rows then columns, or all 49 taps at once; the denoiser has a kernel of its own");
    number(SETTING(filter, normalPower), {0, 1024}, Nothing, "weight max(0, n.n')^power");
    number(SETTING(filter, distance), {1e-6, 10}, Nothing,
           "deviation from the pixel's plane, share of its view distance");
    number(SETTING(image, exposure), {0, kNoLimit}, Nothing,
           "factor on radiance before tone mapping; 0 = measured at the first frame");
    number(SETTING(image, adaptation), {0, 3600, "s"}, Nothing,
           "a measured exposure follows the image: seconds of the scene's time to half of the way, up to 64 times the "
           "first frame's or a 64th; 0 = it stays; the window begins with 2");
    choice(
        SETTING(image, toneMapper), {"reinhard", "neutral", "filmic"}, Nothing,
        "reinhard: on luminance, as paper 1, bright colours are cut off; neutral: Khronos PBR Neutral, colours as they "
        "are up to 0.76, then to white; filmic: a fit of ACES");
    choice(SETTING(image, antiAliasing), {"off", "edges"}, Nothing,
           "edges: no stairs along them in what is shown of beauty, direct and indirect; each frame by itself, so "
           "nothing lags; .exr stays as it is");
    flag(SETTING(frame, overlap), Nothing,
         "update the VPLs while the GPU draws those of the frame before: indirect light is one frame late");
    for (size_t i = 0; i < kEffects; ++i) effect(EffectId(i));
    flag(SETTING(debug, nan), Nothing, "paint NaN magenta and infinity cyan");
    choice(SETTING(debug, timing), {"auto", "queries", "finish"}, Nothing,
           "GPU times by timer queries, or by finishing each pass");
  }

  std::vector<SettingRow> rows;

 private:
  template <class Row, size_t N> static std::vector<std::string> namesOf(const Row (&table)[N]) {
    std::vector<std::string> names;
    for (const Row& row : table) names.push_back(row.name);
    return names;
  }

  template <class Group, class Value>
  void add(SettingRow row, Group Settings::*group, Value Group::*value, ChangeCost change, const char* help) {
    row.get = [=](const Settings& s) { return double(s.*group.*value); };
    row.set = [=](Settings& s, double v) { s.*group.*value = Value(v); };
    row.standard = row.get(Settings{});
    row.change = change;
    row.help = help;
    rows.push_back(std::move(row));
  }

  template <class Group, class Value>
  void number(const char* name, Group Settings::*group, Value Group::*value, Span span, ChangeCost change,
              const char* help) {
    add({.name = name,
         .kind = std::is_integral_v<Value> ? SettingKind::Whole : SettingKind::Real,
         .low = double(Value(span.low)),
         .high = span.high,
         .unit = span.unit,
         .scale = span.scale},
        group, value, change, help);
  }

  template <class Group>
  void flag(const char* name, Group Settings::*group, bool Group::*value, ChangeCost change, const char* help) {
    add({.name = name, .kind = SettingKind::Flag, .high = 1, .choices = {"off", "on"}}, group, value, change, help);
  }

  template <class Group, class Enum>
  void choice(const char* name, Group Settings::*group, Enum Group::*value, std::vector<std::string> names,
              ChangeCost change, const char* help) {
    const double last = double(names.size() - 1);
    add({.name = name, .kind = SettingKind::Choice, .high = last, .choices = std::move(names)}, group, value, change,
        help);
  }

  void effect(EffectId id) {
    rows.push_back({.name = "effects." + std::string(effectRow(id).name),
                    .help = effectRow(id).help,
                    .kind = SettingKind::Choice,
                    .high = 2,
                    .change = Maps,
                    .choices = {"auto", "on", "off"},
                    .get = [id](const Settings& s) { return double(s.effects[id]); },
                    .set = [id](Settings& s, double v) { s.effects[id] = EffectMode(int(v)); }});
  }
};

#undef SETTING

/// A number that is all of `text`; nothing otherwise.
template <class Value> std::optional<double> numberOf(std::string_view text) {
  Value v{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return double(v);
}

/// The value that a text stands for; nothing where it is none of the row's range.
std::optional<double> valueOf(const SettingRow& row, std::string_view text) {
  if (!row.choices.empty()) {
    const auto found = std::find(row.choices.begin(), row.choices.end(), text);
    if (found == row.choices.end()) return std::nullopt;
    return double(found - row.choices.begin());
  }
  const std::optional<double> v = row.kind == SettingKind::Whole ? numberOf<int>(text) : numberOf<float>(text);
  const double last = row.kind == SettingKind::Whole ? row.high : double(float(row.high)); // numbers are floats
  if (!v || !(*v >= row.low && *v <= last)) return std::nullopt;
  return v;
}

std::string shortest(float v) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, v).ptr};
}

} // namespace

const char* costText(ChangeCost cost) {
  constexpr const char* texts[] = {"nothing", "light paths again", "maps again", "another set of lights"};
  return texts[int(cost)];
}

std::string SettingRow::text(double value) const {
  if (!choices.empty()) return choices[size_t(value)];
  return kind == SettingKind::Whole ? std::to_string(int(value)) : shortest(float(value));
}

std::string SettingRow::range() const {
  if (kind == SettingKind::Flag) return "on|off";
  std::string range;
  for (const std::string& c : choices) range += (range.empty() ? "" : "|") + c;
  if (!range.empty()) return range;
  return text(low) + ".." + text(high);
}

const std::vector<SettingRow>& settingsTable() {
  static const Table table;
  return table.rows;
}

double OwnSetting::operator()(const Settings& settings) const {
  const auto found = settings.ownValues.find(name);
  return found == settings.ownValues.end() ? standard : found->second;
}

SettingRow rowOf(const OwnSetting& setting) {
  const OwnSetting own = setting;
  return {.name = own.name,
          .help = own.help,
          .kind = own.whole ? SettingKind::Whole : SettingKind::Real,
          .low = own.low,
          .high = own.high,
          .standard = own.standard,
          .unit = own.unit,
          .change = Light,
          .get = own,
          .set = [own](Settings& s, double v) {
            if (v == own.standard)
              s.ownValues.erase(own.name);
            else
              s.ownValues[own.name] = v;
          }};
}

std::vector<SettingRow> settingRows(const Settings& settings) {
  std::vector<SettingRow> rows = settingsTable();
  if (settings.own)
    for (const OwnSetting& setting : settings.own->settings) rows.push_back(rowOf(setting));
  return rows;
}

std::string_view presentName(std::string_view name) {
  if (name == "gather") return "gather.mode"; // the short form that the papers' variants are named by: gather=full
  if (name == "cube.sights") return "cube.visibility"; // renamed in 0.1
  return name;
}

SettingRow settingRow(std::string_view name, const Settings& settings) {
  name = presentName(name);
  for (const SettingRow& row : settingsTable())
    if (row.name == name) return row;
  std::vector<std::string> names;
  for (const SettingRow& row : settingRows(settings)) {
    if (row.name == name) return row;
    names.push_back(row.name);
  }
  throw InputError("setting " + std::string(name),
                   "no such setting (" + guessText(name, names, "see `lambent settings`") + ")");
}

void applySetting(Settings& settings, std::string_view name, std::string_view value) {
  const SettingRow row = settingRow(name, settings);
  const std::optional<double> v = valueOf(row, value);
  if (!v) throw InputError("setting " + row.name, "cannot be '" + std::string(value) + "' (" + row.range() + ")");
  row.set(settings, *v);
}

std::string settingText(const Settings& settings, std::string_view name) {
  const SettingRow row = settingRow(name, settings);
  return row.text(row.get(settings));
}

Axes axesOf(const Settings& s) {
  return {s.vpl.source, s.vpl.visibility, s.gather.mode, reconstructionOf(s.gather.mode, s.filter.on)};
}

Needs needsOf(const Settings& settings) { return settings.own ? settings.own->needs : needsOf(axesOf(settings)); }

Settings asGathered(Settings settings) {
  if (settings.gather.near > 0 && needsOf(settings).nearRays) settings.gather.disk *= settings.gather.nearDisk;
  return settings;
}

std::string whyNot(const Settings& settings) {
  if (!settings.own && settings.gather.mode == GatherMode::Own)
    return "gather.mode own: no technique with a provider of its own is chosen (--technique)";
  if (settings.own && settings.gather.mode != GatherMode::Own)
    return "gather.mode " + settingText(settings, "gather.mode") + ": technique " + settings.own->name +
           " has a provider of its own (own)";
  if (settings.own && settings.vpl.source != settings.own->axes.source)
    return "vpl.source " + settingText(settings, "vpl.source") + ": technique " + settings.own->name + " takes " +
           rowOf(settings.own->axes.source).name;
  return whyNot(axesOf(settings));
}

namespace {

// What a ray looks at, above which a first frame does less; see decisions.md.
constexpr float kSlow = 12, kSlower = 24;

} // namespace

int firstMapStep(FirstMaps setting, float rayWork) {
  if (setting == FirstMaps::Auto) return rayWork > kSlower ? 4 : rayWork > kSlow ? 2 : 1;
  return setting == FirstMaps::Quarter ? 4 : setting == FirstMaps::Half ? 2 : 1;
}

int warmupOf(const SmcSettings& settings, float rayWork) {
  if (!settings.shortWarmup || rayWork <= kSlower) return settings.warmup;
  constexpr int kLeast = 12; // what the window warms up by while it loads
  return std::max(std::min(settings.warmup, kLeast), int(float(settings.warmup) * kSlower / rayWork));
}

} // namespace lambent
