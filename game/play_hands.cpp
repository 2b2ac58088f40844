// What the player's hands do: use, take, carry, throw, put down.
#include "game/play.h"

namespace lambent {

namespace {
constexpr float kArm = 1.5f; // heights from the eye within which things are used
}

/// The instance before the eyes, within reach.
std::optional<uint32_t> Play::lookedAt() const {
  const float reach = kArm * player_.body().size().height;
  const SurfaceHit hit = solids_->rays().seen(Ray{player_.position(), player_.forward(), reach});
  return hit.valid() ? std::optional(solids_->view().instances[hit.instance].id) : std::nullopt;
}

/// What E would do now, in words; empty: nothing.
std::string Play::offer() const {
  if (const std::optional<ThingKind> carried = props_.things.carried())
    return std::string("E: put the ") + thingName(*carried) + " down, click: throw it" +
           (*carried == ThingKind::Lamp ? "" : ", B: another");
  const std::optional<uint32_t> seen = lookedAt();
  if (!seen) return {};
  if (const std::optional<ThingKind> kind = props_.things.kindOf(*seen))
    return std::string("E: take the ") + thingName(*kind);
  const std::string offer = props_.movers.offer(*seen);
  return offer.empty() ? offer : "E: " + offer;
}

void Play::use() {
  if (props_.things.carries()) {
    props_.things.putDown();
    return;
  }
  const std::optional<uint32_t> seen = lookedAt();
  if (!seen || !(props_.movers.use(*seen) || props_.things.pick(*seen, player_)))
    hud_.say("nothing to use within reach: doors, lifts and their red buttons; B and L give you boxes and lamps");
}

void Play::handle(const Wishes& wishes) {
  if (wishes.use) use();
  if (wishes.hurl) props_.things.hurl(player_);
  const auto take = [&](ThingKind kind) {
    if (!props_.things.take(kind, player_)) hud_.say("there are enough things about (F2 clears them away)");
  };
  if (wishes.box) {
    if (props_.things.carries() && props_.things.carried() != ThingKind::Lamp)
      props_.things.exchangeCarried(player_);
    else
      take(ThingKind::WhiteBoard);
  }
  if (wishes.lamp) {
    if (props_.things.carried() == ThingKind::Lamp)
      props_.things.removeCarried();
    else
      take(ThingKind::Lamp);
  }
}

} // namespace lambent
