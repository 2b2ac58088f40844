// glTF animations to clips.

#include "engine/scene/gltf_import.h"

#include <cmath>
#include <optional>

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

/// Where a channel of the file and its sampler are.
struct Source {
  Import& import;
  const tinygltf::AnimationSampler& sampler;
  Entity target;
  std::string place;
};

/// Fills in what both kinds of channel have, and checks what sampleChannel relies on; `perValue` numbers make one
/// value.
template <class Channel, class Read> void readKeys(Channel& out, const Source& from, size_t perValue, Read&& read) {
  Document& doc = from.import.doc;
  const std::string& place = from.place;
  const std::vector<float>& times = out.times;
  out.target = from.target;
  out.interpolation = interpolationMode(doc, from.sampler.interpolation, place);
  out.times = readAccessor<float>(doc, from.sampler.input, place + ", input");
  out.values = read(doc, from.sampler.output, place + ", output");
  if (times.empty()) doc.fail(place, "has no keys");
  for (size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i]) || (i > 0 && times[i] < times[i - 1]))
      doc.fail(place, "the time of key " + std::to_string(i) + " is not a number, or earlier than the one before it");
  const size_t expected = (out.interpolation == Interpolation::CubicSpline ? 3 : 1) * perValue * times.size();
  if (out.values.size() != expected)
    doc.fail(place, "has " + std::to_string(out.values.size()) + " values for " + std::to_string(times.size()) +
                        " keys (" + std::to_string(expected) + " expected)");
  for (const auto& v : out.values)
    if (!isFinite(vec4(v))) doc.fail(place, "holds a value that is not a finite number");
}

/// The node's property that the channel drives; nothing when it is not one we know.
std::optional<ChannelPath> channelPath(const std::string& name) {
  if (name == "translation") return ChannelPath::Translation;
  if (name == "rotation") return ChannelPath::Rotation;
  if (name == "scale") return ChannelPath::Scale;
  return {};
}

void addTransformChannel(const Source& from, ChannelPath path, AnimationClip& clip) {
  Registry& registry = from.import.scene.registry;
  AnimationChannel out;
  out.path = path;
  readKeys(out, from, 1, [&](const Document& doc, int accessor, const std::string& place) {
    return readValues(doc, accessor, path, place);
  });
  if (registry.get<Transform>(out.target).matrix) {
    from.import.counted["animation channel(s) of nodes with a sheared matrix left out"]++;
    return;
  }
  if (!registry.has<Animated>(out.target)) registry.emplace<Animated>(out.target, registry.get<Transform>(out.target));
  clip.duration = std::max(clip.duration, double(out.times.back()));
  clip.channels.push_back(std::move(out));
}

void addWeightsChannel(const Source& from, AnimationClip& clip) {
  Registry& registry = from.import.scene.registry;
  const auto* morph = registry.tryGet<MorphWeights>(from.target);
  if (!morph) {
    from.import.counted["animation channel(s) of weights of nodes without morph targets left out"]++;
    return;
  }
  WeightsChannel out;
  out.count = morph->weights.size();
  readKeys(out, from, out.count, readAccessor<float>);
  if (!registry.has<AnimatedWeights>(out.target)) registry.emplace<AnimatedWeights>(out.target, morph->weights);
  clip.duration = std::max(clip.duration, double(out.times.back()));
  clip.weightsChannels.push_back(std::move(out));
}

} // namespace

void importAnimations(Import& import) {
  Document& doc = import.doc;
  for (size_t a = 0; a < doc.model.animations.size(); ++a) {
    const tinygltf::Animation& in = doc.model.animations[a];
    AnimationClip clip;
    clip.name = in.name.empty() ? "animation " + std::to_string(a) : in.name;
    for (size_t c = 0; c < in.channels.size(); ++c) {
      const tinygltf::AnimationChannel& channel = in.channels[c];
      const std::string place = label("animation", a, in.name) + ", channel " + std::to_string(c);
      if (channel.target_node < 0) continue; // glTF: to be ignored
      doc.checkIndex(channel.target_node, doc.model.nodes.size(), "node", place);
      if (!import.reached(channel.target_node)) continue; // of another scene

      const std::optional<ChannelPath> path = channelPath(channel.target_path);
      if (!path && channel.target_path != "weights") {
        import.counted["animation channel(s) of '" + channel.target_path + "' left out"]++;
        continue;
      }
      const Source from{import, doc.at(in.samplers, channel.sampler, "sampler", place),
                        import.entities[size_t(channel.target_node)], place};
      path ? addTransformChannel(from, *path, clip) : addWeightsChannel(from, clip);
    }
    if (!clip.channels.empty() || !clip.weightsChannels.empty()) import.scene.animations.push_back(std::move(clip));
  }
}

} // namespace lambent::gltf
