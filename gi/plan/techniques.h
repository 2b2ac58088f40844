// Techniques: a row each, with a value on all four axes. Whoever offers techniques (command line, panel,
// measurements) reads the table, gi/frame/technique_table.cpp, which names the stages that rows make; the frame reads
// the axes, and the stage of a row that has its own.
#pragma once

#include "gi/plan/settings.h"

#include <memory>
#include <span>

namespace lambent {

class IndirectStage; // gi/contract/indirect_stage.h
struct PassContext;

struct Technique {
  const char* name;
  const char* help; // one line
  Axes axes;
  EmitterShadows emitters = EmitterShadows::Samples; // direct light of emissive surfaces, which goes with any axes
  const char* waits = nullptr;                       // what a frame waits for or reads back from the GPU; null: nothing
  /// Of a technique without virtual lights (GatherMode::Own): its stage, which takes surfaces and gives light on them.
  std::unique_ptr<IndirectStage> (*make)(PassContext) = nullptr;
};
std::span<const Technique> techniqueTable();
/// Throws InputError that gives the nearest name, or all of them.
const Technique& techniqueByName(const std::string& name);
std::vector<std::string> techniqueNames();

/// Sets the axes. Techniques that sample lights for the picture share visibility and gather: between two of these, both
/// stay as they are (a preset or a person chose them).
void applyTechnique(Settings& settings, const Technique& technique);
void applyTechnique(Settings& settings, const std::string& name);
/// The row that the settings amount to, or the nearest: the first of the same source.
const Technique& techniqueOf(const Settings& settings);

} // namespace lambent
