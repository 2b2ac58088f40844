#include "game/rules/props.h"

namespace lambent {

Props::Props(Scene& scene) : Props(scene, bodySizeFor(worldBounds(scene)).height) {}

Props::Props(Scene& scene, float personHeight)
    : movers(scene), things(scene, personHeight), day(scene), scene_(scene) {}

void Props::setTorch(const std::optional<PlayedMoment::Torch>& torch) {
  torch_ = torch;
  if (!torch) {
    if (torchLight_) scene_.registry.destroy(*torchLight_);
    torchLight_.reset();
    return;
  }
  LightView light;
  light.type = LightType::Spot;
  light.position = torch->position;
  light.direction = torch->direction;
  light.intensity = torch->intensity;
  light.innerConeCos = 0.985f; // 10 degrees
  light.outerConeCos = 0.927f; // 22
  if (!torchLight_) torchLight_ = addLight(scene_, light, "torch");
  Transform& place = scene_.registry.get<Transform>(*torchLight_);
  place.translation = scene_.origin + dvec3(light.position);
  place.rotation = rotationTowards(light.direction);
  scene_.registry.get<WorldTransform>(*torchLight_).worldFromNode = place.local();
  scene_.registry.get<PunctualLight>(*torchLight_).intensity = light.intensity;
}

PlayedMoment Props::moment(double t) const {
  return {.t = t,
          .movers = movers.used(),
          .things = things.list(),
          .lampIntensity = things.count() > 0 ? things.lampIntensity : vec3(0),
          .hour = day.hour(),
          .torch = torch_};
}

void Props::check(const Shot& shot) const {
  for (const PlayedMoment& moment : shot.played) {
    movers.check(moment.movers, shot.file.string());
    things.check(moment.things, shot.file.string());
  }
}

void Props::show(const PlayedMoment& moment, const std::string& file) {
  if (day.hour() != moment.hour) day.set(moment.hour);
  day.apply();
  movers.show(moment.movers, file);
  things.lampIntensity = moment.lampIntensity;
  things.show(moment.things, file);
  setTorch(moment.torch);
}

} // namespace lambent
