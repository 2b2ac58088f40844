// Techniques: a row each. Whoever offers techniques (command line, panel, measurements) reads the table, which stands
// with those who make them (gi/frame/technique_table.cpp).
#pragma once

#include "gi/plan/needs.h"
#include "gi/plan/settings.h"

#include <memory>
#include <span>

namespace lambent {

class LightProvider; // gi/contract/light_provider.h
struct PassContext;

struct Technique {
  const char* name;
  const char* help;                                  // one line
  Axes axes;                                         // of one that is composed of them
  EmitterShadows emitters = EmitterShadows::Samples; // direct light of emissive surfaces, which goes with any axes
  const char* waits = nullptr;                       // what a frame waits for or reads back from the GPU; null: nothing
  /// Makes a provider of its own, in place of the axes (VplSource::None, GatherMode::Own): it takes a frame and gives
  /// light on its surfaces.
  std::unique_ptr<LightProvider> (*make)(PassContext) = nullptr;
  Needs needs = {};                          // of its own provider
  std::span<const OwnSetting> settings = {}; // that its own provider reads
};
std::span<const Technique> techniqueTable();
Needs needsOf(const Technique& technique);
/// Makes the row's own provider, or one that is composed of the axes and serves all settings without a row of its own.
std::unique_ptr<LightProvider> makeTechnique(const Settings& settings, PassContext context);
/// Finds a technique. Throws InputError that gives the nearest name, or all of them.
const Technique& techniqueByName(const std::string& name);
std::vector<std::string> techniqueNames();

/// Sets the axes. Techniques that sample lights for the frame share visibility and gather: between two of these, both
/// stay as they are (a preset or a person chose them).
void applyTechnique(Settings& settings, const Technique& technique);
void applyTechnique(Settings& settings, const std::string& name);
/// Returns the row that the settings amount to, or the nearest: the first of the same source.
const Technique& techniqueOf(const Settings& settings);

} // namespace lambent
