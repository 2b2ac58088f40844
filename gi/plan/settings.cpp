#include "gi/plan/settings.h"

#include "engine/core/error.h"
#include "engine/core/text.h"
#include "gi/plan/effects.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <functional>

namespace lambent {

namespace {

struct Entry {
  SettingRow row;
  std::function<bool(Settings&, std::string_view)> set; // false: not a value of the range
  std::function<std::string(const Settings&)> get;
};

std::string numberText(float v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", double(v));
  return text;
}

class Table {
 public:
  Table() {
    constexpr float big = 1e30f;
    choice("vpl.source", &Settings::vpl, &VplSettings::source, {"smc", "ir", "mir", "tcas", "rsm", "isr", "hisr"},
           "who places virtual lights; named techniques set it");
    choice("vpl.visibility", &Settings::vpl, &VplSettings::visibility, {"maps", "rays", "none"},
           "who tests VPLs against pixels: shadow maps, a ray for every pair (seconds per frame), or nobody");
    whole("vpl.mirCandidates", &Settings::vpl, &VplSettings::mirCandidates, 1, 1024,
          "mir: light paths per VPL slot to choose from; its time and memory grow with it");
    whole("vpl.tcasIterations", &Settings::vpl, &VplSettings::tcasIterations, 0, 1024,
          "tcas: Metropolis-Hastings iterations per VPL and frame, a ray each");
    whole("smc.vpls", &Settings::smc, &SmcSettings::vpls, 1, 65536, "VPL slots N; time of every stage grows with it");
    whole("smc.moves", &Settings::smc, &SmcSettings::moves, 0, 32768,
          "M_max, VPLs replaced per frame; each costs a shadow map");
    whole("smc.candidateRays", &Settings::smc, &SmcSettings::candidateRays, 1, 256, "rays per candidate drawn");
    whole("smc.poolFrames", &Settings::smc, &SmcSettings::poolFrames, 1, 64,
          "frames that a candidate is kept, so that N/poolFrames are drawn per frame, twice that in motion; 1 = all, "
          "as paper 1");
    flag("smc.cache", &Settings::smc, &SmcSettings::cache,
         "keep light paths until something that they touch moves; same results, 0.5 kB per path");
    whole("smc.paths", &Settings::smc, &SmcSettings::paths, 1, 4096, "light paths per VPL and candidate");
    whole("smc.bounces", &Settings::smc, &SmcSettings::bounces, 0, 32, "indirect bounces B; 0 = direct light only");
    whole("smc.points", &Settings::smc, &SmcSettings::points, 1, 1 << 20, "camera rays that find visible points");
    whole("smc.validationRays", &Settings::smc, &SmcSettings::validationRays, 0, 1024,
          "V, rays per visible point and round towards unverified VPLs");
    whole("smc.warmup", &Settings::smc, &SmcSettings::warmup, 0, 100000, "iterations before the first picture");
    whole("smc.neighbours", &Settings::smc, &SmcSettings::neighbours, 0, 1024,
          "k of knn densities for rendering; 0 = max(1, floor(sqrt(N/32)))");
    choice("smc.density", &Settings::smc, &SmcSettings::density, {"knn", "knn-side", "cells"},
           "what a VPL stands for: paper 1's density, the same by neighbours on its side, or the cell around it");
    whole("shadow.resolution", &Settings::shadow, &ShadowSettings::resolution, 16, 2048,
          "texels per side of a VPL's map; N * resolution^2 * 2 bytes");
    choice("shadow.maker", &Settings::shadow, &ShadowSettings::maker, {"auto", "raster", "rays"},
           "who draws VPL maps; auto measures both once and keeps the faster");
    real("shadow.bias", &Settings::shadow, &ShadowSettings::bias, 0, 100,
         "depth bias of VPL maps, texels at the receiver");
    whole("shadow.refresh", &Settings::shadow, &ShadowSettings::refresh, 0, 32768,
          "VPL maps' worth of texels drawn again per frame where objects moved, brightest lights first");
    whole("shadow.motionRays", &Settings::shadow, &ShadowSettings::motionRays, 0, 1024,
          "rays per VPL and moved object that look whether the one sees the other; 0 = assume so");
    whole("shadow.sunResolution", &Settings::shadow, &ShadowSettings::sunResolution, 0, 16384,
          "texels per side of a directional light's map; 0 = 2w, w the picture's width rounded up to a power of two");
    whole("shadow.pointResolution", &Settings::shadow, &ShadowSettings::pointResolution, 0, 8192,
          "texels per side of a point light's cube face; 0 = w/2");
    whole("shadow.spotResolution", &Settings::shadow, &ShadowSettings::spotResolution, 0, 8192,
          "texels per side of a spot light's map; 0 = w");
    whole("shadow.emitterSamples", &Settings::shadow, &ShadowSettings::emitterSamples, 1, 1024,
          "shadowed samples for all emissive surfaces in direct light");
    whole("shadow.emitterResolution", &Settings::shadow, &ShadowSettings::emitterResolution, 16, 2048,
          "texels per side of their maps");
    whole("shadow.skyMaps", &Settings::shadow, &ShadowSettings::skyMaps, 1, 512,
          "directions of the sky in direct light");
    whole("shadow.skyResolution", &Settings::shadow, &ShadowSettings::skyResolution, 16, 2048,
          "texels per side of their maps");
    choice("gather.mode", &Settings::gather, &GatherSettings::mode,
           {"interleaved", "full", "multires", "multires-interleaved", "splat", "splat-per-vpl"},
           "4x4 subsets and filter; every VPL at every pixel (16 times the time), or at every patch of the picture; "
           "patches of each subset; VPLs splatted into patches, or each into patches of its own");
    real("gather.disk", &Settings::gather, &GatherSettings::disk, 0, 1000,
         "widens r^2 by disk*a/pi: bounds a VPL near by through its own area (1 = paper 3's form factor, 0 = off)");
    real("gather.clamp", &Settings::gather, &GatherSettings::clamp, 0, big,
         "largest geometry term of a VPL, 1/m^2 (paper 1's clamp); 0 = none");
    flag("gather.glossy", &Settings::gather, &GatherSettings::glossy,
         "surfaces that the camera sees reflect by roughness (at least 0.3) and metalness; light paths stay Lambert");
    real("gather.spread", &Settings::gather, &GatherSettings::spread, 0, 1000,
         "widens glossy lobes by the angle of a VPL's own area (0 = VPLs are points: sharp spots on polished metal)");
    whole("multires.coarsest", &Settings::multires, &MultiresSettings::coarsest, 1, 1024,
          "patches along the picture's longer side at the coarsest level");
    real("multires.depth", &Settings::multires, &MultiresSettings::depth, 0, big,
         "deviation from its plane that splits a patch, share of the view distance; 0 = every pixel is gathered");
    real("multires.normal", &Settings::multires, &MultiresSettings::normal, 0, big,
         "range of a component of the normal, 0 to 2, that splits a patch");
    flag("multires.balance", &Settings::multires, &MultiresSettings::balance,
         "patches side by side differ by one level at most");
    flag("multires.edges", &Settings::multires, &MultiresSettings::edges,
         "patches beside an edge are 2x2 pixels at most; off: light that an edge bounds is spread over larger ones");
    real("multires.detail", &Settings::multires, &MultiresSettings::detail, 0, 1,
         "darkens indirect light where the surface turns away from the viewer, for detail that patches lost (paper 2)");
    real("multires.light", &Settings::multires, &MultiresSettings::light, 0, big,
         "splat-per-vpl: range of a VPL's light that splits a patch, share of what it brings to a surface facing it");
    whole("rsm.resolution", &Settings::rsm, &RsmSettings::resolution, 16, 4096,
          "texels per side of a light's reflective shadow map, of each face of a point light's");
    whole("rsm.vpls", &Settings::rsm, &RsmSettings::vpls, 1, 1 << 20,
          "rsm: VPLs on a regular grid over all maps, about so many");
    flag("rsm.exact", &Settings::rsm, &RsmSettings::exact,
         "every texel's own solid angle, instead of a map's mean (the papers')");
    whole("rsm.coarsest", &Settings::rsm, &RsmSettings::coarsest, 1, 256,
          "isr, hisr: patches per side of a map at the coarsest level, a power of two");
    whole("rsm.finest", &Settings::rsm, &RsmSettings::finest, 1, 1024,
          "isr, hisr: patches per side of a map at the finest level, a power of two");
    real("rsm.depth", &Settings::rsm, &RsmSettings::depth, 0, big,
         "isr: deviation from its plane that splits a patch of a map, share of the distance; 0 splits all");
    real("rsm.normal", &Settings::rsm, &RsmSettings::normal, 0, big,
         "isr: range of a component of the normal, 0 to 2, that splits a patch of a map");
    real("rsm.tau", &Settings::rsm, &RsmSettings::tau, 0, 1,
         "hisr: a cluster that may bring more than this share of the brightest map's light is split; 0 splits all");
    flag("filter.on", &Settings::filter, &FilterSettings::on, "cross-bilateral filter over the 4x4 subsets");
    choice("filter.kernel", &Settings::filter, &FilterSettings::kernel, {"separable", "whole"},
           "7x7 filter along rows then columns, or all 49 taps at once");
    real("filter.normalPower", &Settings::filter, &FilterSettings::normalPower, 0, 1024, "weight max(0, n.n')^power");
    real("filter.distance", &Settings::filter, &FilterSettings::distance, 1e-6f, 10,
         "deviation from the pixel's plane, share of its view distance");
    real("image.exposure", &Settings::image, &ImageSettings::exposure, 0, big,
         "factor on radiance before Reinhard; 0 = measured at the first picture");
    flag("frame.overlap", &Settings::frame, &FrameSettings::overlap,
         "update the VPLs while the GPU draws those of the frame before: indirect light is one frame late");
    for (size_t i = 0; i < kEffects; ++i) effect(EffectId(i));
    flag("debug.nan", &Settings::debug, &DebugSettings::nan, "paint NaN magenta and infinity cyan");
    choice("debug.timing", &Settings::debug, &DebugSettings::timing, {"auto", "queries", "finish"},
           "GPU times by timer queries, or by finishing each pass");
  }

  std::vector<Entry> entries;

 private:
  template <class Group, class Value> auto member(Group Settings::*group, Value Group::*value) {
    return [=](auto& s) -> auto& { return s.*group.*value; };
  }

  template <class Group>
  void whole(const char* name, Group Settings::*group, int Group::*value, int lo, int hi, const char* help) {
    const auto at = member(group, value);
    add(
        name, help, std::to_string(lo) + ".." + std::to_string(hi),
        [=](Settings& s, std::string_view text) {
          int v = 0;
          const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
          if (error != std::errc() || end != text.data() + text.size() || v < lo || v > hi) return false;
          at(s) = v;
          return true;
        },
        [=](const Settings& s) { return std::to_string(at(s)); });
  }

  template <class Group>
  void real(const char* name, Group Settings::*group, float Group::*value, float lo, float hi, const char* help) {
    const auto at = member(group, value);
    add(
        name, help, hi >= 1e30f ? "at least " + numberText(lo) : numberText(lo) + ".." + numberText(hi),
        [=](Settings& s, std::string_view text) {
          float v = 0;
          const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
          if (error != std::errc() || end != text.data() + text.size() || !(v >= lo && v <= hi)) return false;
          at(s) = v;
          return true;
        },
        [=](const Settings& s) { return numberText(at(s)); });
  }

  template <class Group> void flag(const char* name, Group Settings::*group, bool Group::*value, const char* help) {
    const auto at = member(group, value);
    add(
        name, help, "on|off",
        [=](Settings& s, std::string_view text) {
          if (text != "on" && text != "off") return false;
          at(s) = text == "on";
          return true;
        },
        [=](const Settings& s) { return std::string(at(s) ? "on" : "off"); });
  }

  template <class Group, class Enum>
  void choice(const char* name, Group Settings::*group, Enum Group::*value, std::vector<std::string> names,
              const char* help) {
    const auto at = member(group, value);
    named(
        name, help, std::move(names), [=](Settings& s, size_t i) { at(s) = Enum(i); },
        [=](const Settings& s) { return size_t(at(s)); });
  }

  void effect(EffectId id) {
    const EffectRow& row = effectRow(id);
    named(
        "effects." + std::string(row.name), row.help, {"auto", "on", "off"},
        [id](Settings& s, size_t i) { s.effects[id] = EffectMode(i); },
        [id](const Settings& s) { return size_t(s.effects[id]); });
  }

  void named(const std::string& name, const char* help, std::vector<std::string> names,
             std::function<void(Settings&, size_t)> set, std::function<size_t(const Settings&)> get) {
    std::string range;
    for (const std::string& n : names) range += (range.empty() ? "" : "|") + n;
    add(
        name, help, range,
        [names, set](Settings& s, std::string_view text) {
          const auto found = std::find(names.begin(), names.end(), text);
          if (found != names.end()) set(s, size_t(found - names.begin()));
          return found != names.end();
        },
        [names, get](const Settings& s) { return names[get(s)]; });
  }

  void add(const std::string& name, const char* help, std::string range,
           std::function<bool(Settings&, std::string_view)> set, std::function<std::string(const Settings&)> get) {
    const std::string defaultText = get(Settings{});
    entries.push_back({{name, help, defaultText, std::move(range)}, std::move(set), std::move(get)});
  }
};

const std::vector<Entry>& entries() {
  static const Table table;
  return table.entries;
}

const Entry& entryOf(std::string_view name) {
  if (name == "gather") name = "gather.mode"; // the short form that the papers' variants are named by: gather=full
  for (const Entry& e : entries())
    if (e.row.name == name) return e;
  std::vector<std::string> names;
  for (const Entry& e : entries()) names.push_back(e.row.name);
  const std::string near = nearestName(name, names);
  throw InputError("setting " + std::string(name),
                   "no such setting (" + (near.empty() ? "see `lambent settings`" : "did you mean " + near + "?") +
                       ")");
}

} // namespace

const std::vector<SettingRow>& settingsTable() {
  static const std::vector<SettingRow> rows = [] {
    std::vector<SettingRow> r;
    for (const Entry& e : entries()) r.push_back(e.row);
    return r;
  }();
  return rows;
}

void applySetting(Settings& settings, std::string_view name, std::string_view value) {
  const Entry& e = entryOf(name);
  if (!e.set(settings, value))
    throw InputError("setting " + e.row.name, "cannot be '" + std::string(value) + "' (" + e.row.range + ")");
}

std::string settingText(const Settings& settings, std::string_view name) { return entryOf(name).get(settings); }

const std::vector<std::string>& presetNames() {
  static const std::vector<std::string> names{"low", "medium", "high", "ultra"};
  return names;
}

void applyPreset(Settings& settings, const std::string& name) {
  struct Preset {
    int vpls, points, paths, resolution;
    GatherMode mode;
  };
  static constexpr Preset presets[]{{512, 1024, 8, 64, GatherMode::Interleaved},
                                    {2048, 2048, 16, 128, GatherMode::Interleaved},
                                    {8192, 4096, 16, 128, GatherMode::Interleaved},
                                    {2048, 4096, 16, 128, GatherMode::Multires}};
  for (size_t i = 0; i < presetNames().size(); ++i) {
    if (presetNames()[i] != name) continue;
    settings.smc.vpls = presets[i].vpls;
    settings.smc.points = presets[i].points;
    settings.smc.paths = presets[i].paths;
    settings.shadow.resolution = presets[i].resolution;
    settings.gather.mode = presets[i].mode;
    return;
  }
  throw InputError("preset " + name, "no such preset (low, medium, high or ultra)");
}

namespace {

/// Choices that belong together: a row of the table of techniques.
struct Technique {
  VplSource source;
  GatherMode mode;
};
constexpr Technique kTechniques[] = {
    {VplSource::Smc, GatherMode::Interleaved}, {VplSource::Ir, GatherMode::Interleaved},
    {VplSource::Mir, GatherMode::Interleaved}, {VplSource::Tcas, GatherMode::Interleaved},
    {VplSource::Rsm, GatherMode::Full},        {VplSource::Rsm, GatherMode::Splat},
    {VplSource::Rsm, GatherMode::Multires},    {VplSource::Isr, GatherMode::Multires},
    {VplSource::Hisr, GatherMode::Multires},
};

} // namespace

const std::vector<std::string>& techniqueNames() {
  static const std::vector<std::string> names{"smc", "ir",  "mir", "tcas", "rsm", "multires-splat", "multires-gather",
                                              "isr", "hisr"}; // as kTechniques
  return names;
}

void applyTechnique(Settings& settings, const std::string& name) {
  for (size_t i = 0; i < techniqueNames().size(); ++i) {
    if (techniqueNames()[i] != name) continue;
    const Technique& t = kTechniques[i];
    // The first four share visibility and gather, whatever these are; those from reflective maps have their own.
    const bool own = fromReflectiveMaps(t.source);
    if (own || fromReflectiveMaps(settings.vpl.source)) {
      settings.vpl.visibility = own ? VplVisibility::None : VplVisibility::Maps;
      settings.gather.mode = t.mode;
    }
    settings.vpl.source = t.source;
    return;
  }
  const std::string near = nearestName(name, techniqueNames());
  std::string all;
  for (const std::string& n : techniqueNames()) all += (all.empty() ? "" : ", ") + n;
  throw InputError("--technique " + name,
                   "no such technique (" + (near.empty() ? all : "did you mean " + near + "?") + ")");
}

const std::string& techniqueOf(const Settings& settings) {
  size_t first = std::size(kTechniques); // row of this source
  for (size_t i = std::size(kTechniques); i-- > 0;) {
    if (kTechniques[i].source != settings.vpl.source) continue;
    first = i;
    if (kTechniques[i].mode == settings.gather.mode) break;
  }
  return techniqueNames()[first];
}

void checkSettings(const Settings& settings) {
  if (settings.vpl.source != VplSource::Hisr) return;
  if (settings.vpl.visibility != VplVisibility::None)
    throw InputError("vpl.visibility " + settingText(settings, "vpl.visibility"),
                     "hisr has clusters of all sizes, and no shadow maps of them (none)");
  if (settings.gather.mode == GatherMode::Splat || settings.gather.mode == GatherMode::SplatPerVpl)
    throw InputError("gather.mode " + settingText(settings, "gather.mode"),
                     "hisr's clusters are chosen by who gathers (multires, multires-interleaved, interleaved or full)");
}

} // namespace lambent
