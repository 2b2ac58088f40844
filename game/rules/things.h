// Boards, boxes and lamps that a person takes, carries, throws and puts down. They fall, slide and come to rest on what
// is there, upright; nobody needs them to tumble for light to fall on them.
#pragma once

#include "engine/scene/shot.h"
#include "game/rules/player.h"
#include "game/rules/solids.h"

#include <array>
#include <optional>
#include <vector>

namespace lambent {

enum class ThingKind { WhiteBoard, WhiteBox, RedBox, GreenBox, BlueBox, Lamp };
inline constexpr size_t kThingKinds = size_t(ThingKind::Lamp) + 1;
const char* thingName(ThingKind kind);

class Things {
 public:
  /// Adds their meshes to the scene's assets: before anything is built from these. Sizes suit a person so high.
  Things(Scene& scene, float personHeight);

  /// Takes a new one into the hand; what was in it is put down. False where there are as many as may be.
  bool take(ThingKind kind, const Player& player);
  /// Takes up the thing that the instance is; false where it is none.
  bool pick(uint32_t instance, const Player& player);
  bool carries() const { return hand_.has_value(); }
  std::optional<ThingKind> carried() const;
  std::optional<ThingKind> kindOf(uint32_t instance) const;
  /// The next kind of box in the hand, for the one that is in it; after the last, nothing.
  void exchangeCarried(const Player& player);
  void putDown();
  void hurl(const Player& player);
  void removeCarried();
  void clear();

  /// Moves them for so many seconds. What is carried follows the player's eyes and no longer counts as solid.
  void update(Solids& solids, const Player& player, float seconds);

  /// All of them, as a shot has them.
  std::vector<PlayedMoment::Thing> list() const;
  /// Throws InputError, with `file`, for an unknown kind, for too many, and for two of a number.
  static void check(const std::vector<PlayedMoment::Thing>& list, const std::string& file);
  /// Makes it so: those that are not in the list go, new ones come, none is carried. Throws as check.
  void show(const std::vector<PlayedMoment::Thing>& list, const std::string& file);

  size_t count() const { return things_.size(); }
  /// Where the i-th is, from the scene's origin: its middle.
  vec3 position(size_t i) const { return things_[i].centre; }
  bool resting(size_t i) const { return things_[i].resting; }

  vec3 lampIntensity{1}; // W/sr, of all lamps

  static constexpr size_t kMost = 48;

 private:
  struct Thing {
    ThingKind kind;
    uint32_t number;      // of all that were made
    Entity entity, light; // light: only of a lamp
    vec3 centre{0}, velocity{0};
    float yaw = 0;
    bool resting = false;
    uint32_t ground = kNone; // id of the instance that it rests on
  };

  vec3 halfSize(ThingKind kind) const;
  void hold(const Solids& solids, Thing& thing, const Player& player);
  void ride(const Solids& solids, Thing& thing);
  void fly(const Solids& solids, Thing& thing, float seconds);
  std::vector<vec3> lattice(const Thing& thing) const;
  Thing& make(ThingKind kind, uint32_t number, const vec3& centre);
  void show(const Thing& thing);
  void destroy(size_t index);

  Scene& scene_;
  const float size_; // height of a person, metres
  std::array<uint32_t, kThingKinds> meshes_{};
  std::vector<Thing> things_;
  uint32_t made_ = 0;
  std::optional<size_t> hand_;
};

} // namespace lambent
