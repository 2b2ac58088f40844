// What `lambent accuracy --report` measures: every setting that trades accuracy for time, alone; a joint sweep, among
// whose points presets are chosen; every technique.
#pragma once

#include "gi/plan/presets.h"

namespace lambent {

/// What a knob's error shows in: indirect light, or direct light by itself.
enum class KnobLight { Indirect, Direct };

/// A setting and its values, those that should cost least first; the default is among them.
struct Knob {
  const char* setting;
  std::vector<const char*> values;
  KnobLight light = KnobLight::Indirect;
  Assignments with = {}; // without which it does nothing
};
const std::vector<Knob>& knobTable();

/// Settings that are no such knob, and why. With the knobs, all of them.
struct NoKnob {
  std::vector<const char*> settings;
  const char* reason;
};
const std::vector<NoKnob>& noKnobTable();

/// A way to set the program.
struct SweepPoint {
  enum class Kind { Default, Alone, Joint, Named }; // a knob alone | of the joint sweep | a technique
  std::string name;                                 // "smc.vpls=512"; no two have the same
  Kind kind = Kind::Default;
  Assignments set = {};
  std::string technique = {}; // empty: as set
  KnobLight light = KnobLight::Indirect;
  bool slow = false; // seconds a frame: measured over a few frames in motion, and not standing still
};
/// Of the joint sweep and the default alone presets are chosen; quick are the ends of two knobs, a joint point and one
/// technique, to try whether it runs.
enum class SweepPart { All, Joint, Quick };
/// The default first. A knob's default value is no point of its own; find it by knobPoint.
std::vector<SweepPoint> sweepPoints(SweepPart part);
/// Name of the point of a knob's value.
std::string knobPoint(const Knob& knob, const std::string& value);
/// Name of the point that a preset is.
std::string presetPoint(const Preset& preset);

} // namespace lambent
