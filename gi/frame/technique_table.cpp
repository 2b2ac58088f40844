#include "gi/plan/techniques.h"

#include "gi/frame/composed_technique.h"

#include "engine/core/error.h"
#include "engine/core/text.h"

namespace lambent {

namespace {

using enum VplSource;
using enum GatherMode;
using V = VplVisibility;
using R = Reconstruction;

constexpr Technique kTechniques[] = {
    {"smc", "sequential Monte Carlo instant radiosity (paper 1), the default", {Smc, V::Maps, Lists, R::Filter}},
    {"ir", "instant radiosity: photons from the lights", {Ir, V::Maps, Lists, R::Filter}},
    {"mir", "Metropolis instant radiosity: paths from the camera", {Mir, V::Maps, Lists, R::Filter}},
    {"tcas", "temporally coherent sampling of reflective maps", {Tcas, V::Maps, Lists, R::Filter}},
    {"rsm", "reflective shadow maps, every light at every pixel", {Rsm, V::None, Full, R::None}},
    {"multires-splat", "the same lights splatted into patches (paper 2)", {Rsm, V::None, Splat, R::Upsample}},
    {"multires-gather", "the same lights gathered at patches (paper 3)", {Rsm, V::None, Multires, R::Upsample}},
    {"isr",
     "image-space radiosity: clusters of reflective maps (paper 3)",
     {Isr, V::None, Multires, R::Upsample},
     EmitterShadows::Samples,
     "the number of its lights, where a map changed"},
    {"hisr",
     "hierarchical image-space radiosity: a cut of the trees per patch (paper 3)",
     {Hisr, V::None, Multires, R::Upsample}},
    {"area-multires",
     "smc, with direct light of emissive surfaces at patches (paper 4)",
     {Smc, V::Maps, Lists, R::Filter},
     EmitterShadows::Patches,
     "the visible surfaces, where anything glows"},
    {"lpv",
     "light propagation volume lit by Poisson samples over all surfaces (paper 4)",
     {Poisson, V::None, Volume, R::None}},
    {"ibrr",
     "instant radiosity kept in a layered depth cube, looked up by every view (paper 5)",
     {Ir, V::None, Cube, R::None}},
};

} // namespace

std::span<const Technique> techniqueTable() { return kTechniques; }

Needs needsOf(const Technique& technique) { return technique.make ? technique.needs : needsOf(technique.axes); }

std::vector<std::string> techniqueNames() {
  std::vector<std::string> names;
  for (const Technique& t : kTechniques) names.push_back(t.name);
  return names;
}

const Technique& techniqueByName(const std::string& name) {
  for (const Technique& t : kTechniques)
    if (t.name == name) return t;
  const std::vector<std::string> names = techniqueNames();
  throw InputError("--technique " + name, "no such technique (" + guessText(name, names, joined(names)) + ")");
}

std::unique_ptr<LightProvider> makeTechnique(const Settings& settings, PassContext context) {
  if (settings.own) return settings.own->make(context);
  return std::make_unique<ComposedTechnique>(context);
}

void applyTechnique(Settings& settings, const Technique& technique) {
  if (!needsOf(settings).freeGather || !needsOf(technique).freeGather) {
    settings.vpl.visibility = technique.axes.visibility;
    settings.gather.mode = technique.axes.gather;
  }
  settings.vpl.source = technique.axes.source;
  settings.shadow.emitters = technique.emitters;
  settings.own = technique.make ? &technique : nullptr;
}

void applyTechnique(Settings& settings, const std::string& name) { applyTechnique(settings, techniqueByName(name)); }

const Technique& techniqueOf(const Settings& settings) {
  if (settings.own) return *settings.own;
  const Technique* nearest = nullptr;
  for (const Technique& t : kTechniques) {
    if (t.axes.source != settings.vpl.source) continue;
    const bool gathers = t.axes.gather == settings.gather.mode, emitters = t.emitters == settings.shadow.emitters;
    if (gathers && emitters) return t;
    if (!nearest || (gathers && nearest->axes.gather != settings.gather.mode)) nearest = &t;
  }
  CHECK(nearest != nullptr);
  return *nearest;
}

} // namespace lambent
