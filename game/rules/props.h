// All that a person who plays may change in a scene: doors and lifts, things that are carried, the time of day, the
// flashlight. As a moment of a shot (engine/scene/shot.h) it can be written down and shown again.
#pragma once

#include "engine/scene/shot.h"
#include "game/rules/day.h"
#include "game/rules/movers.h"
#include "game/rules/things.h"

namespace lambent {

class Props {
 public:
  /// Adds meshes and buttons: before anything is built from the scene's assets.
  explicit Props(Scene& scene);
  Props(const Props&) = delete;

  Movers movers;
  Things things;
  Day day;

  /// Where the flashlight shines from and to; none: it is off.
  void setTorch(const std::optional<PlayedMoment::Torch>& torch);

  /// Returns the moment as it is now.
  PlayedMoment moment(double t) const;
  /// Throws InputError where the shot has what this scene or this program has not, or too much: before it is shown.
  void check(const Shot& shot) const;
  /// Makes it so, after the scene was animated. Throws InputError where the scene or this program has nothing of a
  /// name, with `file` as where it stands.
  void show(const PlayedMoment& moment, const std::string& file);

 private:
  Props(Scene& scene, float personHeight);

  Scene& scene_;
  std::optional<PlayedMoment::Torch> torch_;
  std::optional<Entity> torchLight_;
};

} // namespace lambent
