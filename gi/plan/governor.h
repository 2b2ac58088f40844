// Holds the time of a frame at a target while frames run. A pure function: what is governed, what the last frame cost,
// and the target go in; what is governed, with what the governor remembers, comes out.
//
// Two things are governed. The image's scale costs nothing to change and follows the load. The preset is another set
// of virtual lights with all its maps, which takes a while to draw and is a little brighter or darker (1 to 5 % of
// indirect light): it is chosen once, after a short calibration, and kept while frames run.
#pragma once

#include "engine/view/scene_view.h"
#include "gi/plan/presets.h"

namespace lambent {

struct GovernorGains {
  int warmup = 6;                  // first frames, which prepare shaders, lights and maps: not looked at
  int calibration = 4;             // frames after these whose least time says how fast the machine is
  int after = 1;                   // frames after a change that make the new textures: not looked at
  double window = 0.3;             // seconds of frames whose median is the cost; 3 to 24 frames
  double above = 0.1, below = 0.2; // shares of the target, over and under it, within which nothing changes
  double aim = 0.95;               // of the target: where a change goes
  double urgent = 0.4;             // share over the target at which two frames are enough
  float least = 0.25f;             // scale of width and height
  float easy = 0.7f;               // least scale that a preset is chosen for: below it a cheaper one looks better
  float step = 0.03f;              // least change of the scale that is worth its new textures, a share
};

/// The state that the governor reports.
enum class Pace {
  Calibrating,
  Holding,
  TooSlow,
  Idle
}; // TooSlow: at the least scale; Idle: faster than the target at full scale
const char* paceText(Pace pace);

struct Governed {
  Settings settings;
  float scale = 1;           // of width and height of the image
  bool choosesPreset = true; // else, and where they are no preset's, the settings stay as they are
  std::string preset = {};   // the one chosen; empty before the calibration, or where none is

  // What it remembers.
  std::vector<double> ms = {}; // frames since the last change that count, milliseconds
  int frames = 0;              // since the last change
  float otherScale = 0;        // the one before, with its cost, until frames hold the target; 0: there is none
  double otherMs = 0;
  bool calibrated = false;
  Pace pace = Pace::Calibrating;
};

/// Adjusts what is governed after a frame that took `ms`. Frames in which nothing was drawn (a still view) must be left
/// out: they say nothing of what the next one costs. Cost is taken to be in proportion to the number of pixels; as a
/// part of it is not, a change falls short of the target and never overshoots, and the next one closes in: nothing
/// oscillates. Where it fell far short, the two scales show how large that part is (a load that doubles just then is
/// taken for it: one change more).
Governed governed(Governed now, double ms, double targetMs, const GovernorGains& gains = {});

/// Chooses preset and scale before the first frame, where one at full scale and with these settings is expected to take
/// `ms`. The preset is then chosen; the calibration only finds the scale.
Governed begun(Governed now, double ms, double targetMs, const GovernorGains& gains = {});

} // namespace lambent
