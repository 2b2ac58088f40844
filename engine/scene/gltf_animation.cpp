// glTF animations to clips.

#include "engine/scene/gltf_import.h"

#include <cmath>

namespace lambent::gltf {

namespace {

std::vector<vec4> readValues(const Document& doc, int accessor, ChannelPath path, const std::string& place) {
  if (path == ChannelPath::Rotation) return readAccessor<vec4>(doc, accessor, place);
  std::vector<vec4> values;
  for (const vec3& v : readAccessor<vec3>(doc, accessor, place)) values.emplace_back(v, 0);
  return values;
}

Interpolation interpolationMode(Document& doc, const std::string& name, const std::string& place) {
  if (name == "STEP") return Interpolation::Step;
  if (name == "CUBICSPLINE") return Interpolation::CubicSpline;
  if (name != "LINEAR" && !name.empty())
    doc.warn(place + ": interpolation '" + name + "' is not one of glTF's; LINEAR instead");
  return Interpolation::Linear;
}

/// Checks what sampleChannel relies on.
void checkKeys(const Document& doc, const AnimationChannel& channel, const std::string& place) {
  if (channel.times.empty()) doc.fail(place, "has no keys");
  for (size_t i = 0; i < channel.times.size(); ++i)
    if (!std::isfinite(channel.times[i]) || (i > 0 && channel.times[i] < channel.times[i - 1]))
      doc.fail(place, "the time of key " + std::to_string(i) + " is not a number, or earlier than the one before it");
  const size_t perKey = channel.interpolation == Interpolation::CubicSpline ? 3 : 1;
  if (channel.values.size() != perKey * channel.times.size())
    doc.fail(place, "has " + std::to_string(channel.values.size()) + " values for " +
                        std::to_string(channel.times.size()) + " keys (" +
                        std::to_string(perKey * channel.times.size()) + " expected)");
  for (const vec4& v : channel.values)
    if (!isFinite(vec3(v)) || !std::isfinite(v.w)) doc.fail(place, "holds a value that is not a finite number");
}

} // namespace

void importAnimations(Import& import) {
  Document& doc = import.doc;
  Registry& registry = import.scene.registry;
  for (size_t a = 0; a < doc.animations.size(); ++a) {
    const Animation& in = doc.animations[a];
    AnimationClip clip;
    clip.name = in.name.empty() ? "animation " + std::to_string(a) : in.name;
    for (size_t c = 0; c < in.channels.size(); ++c) {
      const Channel& channel = in.channels[c];
      const std::string place = label("animation", a, in.name) + ", channel " + std::to_string(c);
      if (channel.node < 0) continue; // glTF: to be ignored
      doc.checkIndex(channel.node, doc.nodes.size(), "node", place);
      if (!import.reached(channel.node)) continue; // of another scene

      AnimationChannel out;
      if (channel.path == "translation") {
        out.path = ChannelPath::Translation;
      } else if (channel.path == "rotation") {
        out.path = ChannelPath::Rotation;
      } else if (channel.path == "scale") {
        out.path = ChannelPath::Scale;
      } else {
        import.counted["animation channel(s) of '" + channel.path + "' left out"]++;
        continue;
      }
      const Sampler& sampler = doc.at(in.samplers, channel.sampler, "sampler", place);
      out.target = import.entities[size_t(channel.node)];
      out.interpolation = interpolationMode(doc, sampler.interpolation, place);
      out.times = readAccessor<float>(doc, sampler.input, place + ", input");
      out.values = readValues(doc, sampler.output, out.path, place + ", output");
      checkKeys(doc, out, place);
      if (registry.get<Transform>(out.target).matrix) {
        import.counted["animation channel(s) of nodes with a sheared matrix left out"]++;
        continue;
      }
      if (!registry.has<Animated>(out.target))
        registry.emplace<Animated>(out.target, registry.get<Transform>(out.target));
      clip.duration = std::max(clip.duration, double(out.times.back()));
      clip.channels.push_back(std::move(out));
    }
    if (!clip.channels.empty()) import.scene.animations.push_back(std::move(clip));
  }
}

} // namespace lambent::gltf
