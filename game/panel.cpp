// The panel: sections that fold, for whoever plays first and for whoever measures further down.
#include "game/hud.h"

#include "engine/core/error.h"
#include "engine/core/free_memory.h"
#include "engine/core/memory.h"
#include "gi/plan/presets.h"

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace lambent {

namespace {

constexpr double kSmoothing = 0.1; // share of the newest frame in a shown time
constexpr float kLow = 520;        // height of a window in which sections begin folded

/// A list to choose from; true when another one was chosen.
bool choose(const char* label, const std::vector<std::string>& names, std::string& chosen) {
  bool changed = false;
  if (!ImGui::BeginCombo(label, chosen.c_str())) return false;
  for (const std::string& name : names)
    if (ImGui::Selectable(name.c_str(), name == chosen) && name != chosen) {
      chosen = name;
      changed = true;
    }
  ImGui::EndCombo();
  return changed;
}

/// How bright, apart from the colour: the largest channel.
void editIntensity(PunctualLight& light) {
  const float strength = std::max(maxComponent(light.intensity), 1e-6f);
  vec3 color = light.intensity / strength;
  float wanted = strength;
  const char* unit = light.type == LightType::Directional ? "W/m2" : "W/sr";
  const bool brighter = ImGui::SliderFloat(unit, &wanted, 1e-3f, 1e4f, "%.4g", ImGuiSliderFlags_Logarithmic);
  const bool other = ImGui::ColorEdit3("colour", &color.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs);
  if (brighter || other) light.intensity = std::max(wanted, 0.0f) * glm::max(color, vec3(0));
}

/// The way the light travels, as where it comes from: around from south to east, and above the horizon. Of a light that
/// hangs on something else, that moves it.
void editDirection(Scene& scene, Entity e) {
  WorldTransform& world = scene.registry.get<WorldTransform>(e);
  Transform& place = scene.registry.get<Transform>(e);
  if (scene.registry.has<Parent>(e) || place.matrix) return;
  const vec3 from = glm::normalize(vec3(world.worldFromNode[2])); // lights shine along -Z
  float around = glm::degrees(std::atan2(from.x, from.z));
  float above = glm::degrees(std::asin(glm::clamp(from.y, -1.0f, 1.0f)));
  bool turned = ImGui::SliderFloat("from, degrees (0 is +Z, 90 is +X)", &around, -180, 180, "%.0f");
  turned |= ImGui::SliderFloat("above, degrees", &above, -89, 89, "%.0f");
  if (!turned) return;
  const float a = glm::radians(around), h = glm::radians(above);
  place.rotation = rotationTowards(-vec3(std::sin(a) * std::cos(h), std::sin(h), std::cos(a) * std::cos(h)));
  world.worldFromNode = place.local();
}

void drawImage(HudModel& model, Viewer& gi) {
  std::string view = bufferNames()[size_t(model.buffer)];
  if (choose("show (1 ... 0)", bufferNames(), view)) model.buffer = bufferByName(view);
  float ev = std::log2(std::max(gi.exposure(), 1e-6f));
  if (ImGui::SliderFloat("exposure, EV", &ev, -12, 12, "%+.1f")) gi.settings().image.exposure = std::exp2(ev);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("+1 is twice as bright ([ and ] change a third). The first frame measures it.");
  if (model.buffer != Buffer::Vpls && !model.lightsStay) return;
  ImGui::Checkbox("virtual lights stay where they are", &model.lightsStay);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("fly off and look at them from elsewhere");
}

void drawPlayer(HudModel& model) {
  constexpr const char* kGaits[] = {"walking", "flying", "flying through walls"};
  ImGui::Text("%s (G changes it, H: home)", kGaits[int(model.gait)]);
  ImGui::SliderFloat("speed, times", &model.speed, 0.1f, 10, "%.2f", ImGuiSliderFlags_Logarithmic);
  ImGui::Checkbox("flashlight (Q)", &model.torch);
  ImGui::ColorEdit3("lamps (L), W/sr", &model.lampIntensity.x, ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_Float);
}

void drawTime(HudModel& model) {
  ImGui::Checkbox("time stands still (P)", &model.paused);
  float time = float(model.time);
  if (ImGui::SliderFloat("time, s", &time, 0, float(model.duration), "%.2f") && !model.recordedSeconds)
    model.time = time; // a recording's time only goes on
  if (model.hasPath) ImGui::Checkbox("follow the camera path (F)", &model.followPath);
}

void drawDay(HudModel& model) {
  bool on = model.hour.has_value();
  if (ImGui::Checkbox("a clear sky and its sun", &on)) model.hour = on ? std::optional(12.0) : std::nullopt;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("in place of the scene's own sky and suns; lamps stay");
  if (!model.hour) {
    ImGui::TextDisabled("T lets a day go by");
    return;
  }
  float hour = float(*model.hour);
  if (ImGui::SliderFloat("hour", &hour, 0, 23.99f, "%.2f")) model.hour = double(hour);
  ImGui::Checkbox("goes by: a day in 96 s (T)", &model.dayRuns);
}

void drawLights(Scene& scene) {
  bool any = false;
  scene.registry.each<PunctualLight>([&](Entity e, PunctualLight& light) {
    const Name* name = scene.registry.tryGet<Name>(e);
    const char* kind = light.type == LightType::Directional ? "sun"
                       : light.type == LightType::Spot      ? "spotlight"
                                                            : "lamp";
    ImGui::PushID(int(e.id()));
    if (ImGui::TreeNode("light", "%s (%s)", name ? name->value.c_str() : "unnamed", kind)) {
      editIntensity(light);
      if (light.type != LightType::Point) editDirection(scene, e);
      ImGui::TreePop();
    }
    ImGui::PopID();
    any = true;
  });
  int glowing = 0;
  for (const Material& material : scene.assets.materials) glowing += material.emits();
  if (!any) ImGui::TextDisabled("no lamps (L gives you one)");
  if (glowing > 0) ImGui::TextDisabled("and %d glowing material%s", glowing, glowing == 1 ? "" : "s");
}

/// The governor with its target, or the image's scale by hand.
void drawPace(Pacer& pacer) {
  bool governs = pacer.governs();
  if (ImGui::Checkbox("hold the time of a frame", &governs)) {
    if (governs)
      pacer.govern(pacer.targetMs());
    else
      pacer.hold(pacer.scale());
  }
  float value = governs ? float(pacer.targetMs()) : pacer.scale();
  if (governs && ImGui::SliderFloat("target, ms", &value, 4, 500, "%.0f", ImGuiSliderFlags_Logarithmic))
    pacer.govern(double(value));
  if (!governs && ImGui::SliderFloat("image scale", &value, 0.1f, 1, "%.2f")) pacer.hold(value);
  ImGui::TextDisabled("%s", pacer.text().c_str());
}

/// What settings whose names begin so are about.
struct Group {
  const char *prefix, *title;
};
constexpr std::array kGroups = {
    Group{"vpl", "Virtual lights: where from"},
    Group{"smc", "Virtual lights: how many, how good"},
    Group{"shadow", "Shadows"},
    Group{"area", "Soft shadows of glowing surfaces"},
    Group{"gather", "Light at each pixel"},
    Group{"multires", "Patches of the image"},
    Group{"rsm", "Lights from reflective maps"},
    Group{"lpv", "Light in a grid"},
    Group{"cube", "Layered depth cube"},
    Group{"history", "Averaging over time"},
    Group{"filter", "Smoothing"},
    Group{"image", "Image"},
    Group{"frame", "Frame"},
    Group{"effects", "Effects: as needed, always, never"},
    Group{"debug", "For developers"},
};

std::string titleOf(const std::string& prefix) {
  const auto group = std::ranges::find(kGroups, prefix, &Group::prefix);
  return group != kGroups.end() ? group->title : prefix;
}

bool holds(const std::string& text, const std::string& part) {
  const auto lower = [](unsigned char c) { return std::tolower(c); };
  return !std::ranges::search(text, part, {}, lower, lower).empty();
}

} // namespace

void Hud::drawPanel(HudModel& model, Scene& scene, Viewer& gi, TruthView& truth, const FrameStats& stats) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float width = std::min(std::clamp(0.3f * size.x, 300 * scale_, 400 * scale_), size.x - 16);
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({width, std::min(560 * scale_, size.y - 16)}, ImGuiCond_FirstUseEver);
  const bool small = size.x < 800 * scale_; // the panel would hide half of it
  ImGui::SetNextWindowCollapsed(model.folded.value_or(small), ImGuiCond_FirstUseEver);
  // Whatever becomes of the window, the panel stays inside it.
  ImGui::SetNextWindowSizeConstraints({std::min(220 * scale_, size.x - 16), 40}, {size.x - 16, size.y - 16});
  const bool shown = ImGui::Begin("Lambent (Tab hides this, F1: keys)");
  const bool folded = ImGui::IsWindowCollapsed();
  if (wasFolded_.value_or(folded) != folded) model.folded = folded;
  wasFolded_ = folded;
  if (!shown) {
    ImGui::End();
    return;
  }
  const ImVec2 at = ImGui::GetWindowPos(), own = ImGui::GetWindowSize();
  const ImVec2 inside{std::max(std::min(at.x, size.x - own.x), 0.0f), std::max(std::min(at.y, size.y - own.y), 0.0f)};
  if (inside.x != at.x || inside.y != at.y) ImGui::SetWindowPos(inside);

  ImGui::PushItemWidth(-0.36f * own.x);
  ImGui::PushAllowKeyboardFocus(false); // Tab shows this panel, and would begin to type into it
  const auto section = [&](const char* name, bool open) {
    return ImGui::CollapsingHeader(name, open && size.y >= kLow * scale_ ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  };
  if (section("Image", true)) drawImage(model, gi);
  if (section("You", true)) drawPlayer(model);
  if (section("Time", false)) drawTime(model);
  if (section("Time of day", true)) drawDay(model);
  if (section("Lights", false)) drawLights(scene);
  if (section("Speed and quality", true)) drawQuality(model, gi);
  if (truth.mode() != TruthMode::Off && section("Truth", true)) drawTruthFigures(truth);
  if (section("Where the time goes", false)) drawStages(stats);
  if (section("Who holds memory", false)) drawMemory();
  if (section("What the scene calls for", false)) drawEffects(gi.settings(), stats);
  if (section("Figures", false)) drawFigures(stats);
  if (section("All settings", false)) drawSettings(gi.settings());
  ImGui::PopAllowKeyboardFocus();
  ImGui::PopItemWidth();
  ImGui::End();
}

void Hud::drawQuality(HudModel& model, Viewer& gi) {
  std::string technique = techniqueOf(gi.settings()).name;
  if (choose("technique", techniqueNames(), technique))
    change(gi.settings(), [&](Settings& s) { applyTechnique(s, technique); });
  if (choose("quality preset", presetNames(), model.preset))
    change(gi.settings(), [&](Settings& s) { applyPreset(s, model.preset); });
  const auto preset = std::ranges::find(presetTable(), model.preset, &Preset::name);
  if (preset != presetTable().end() && ImGui::IsItemHovered())
    ImGui::SetTooltip("measured: %.2f of the default's time, %.2f of its error", preset->time, preset->error);
  if (!settingError_.empty()) ImGui::TextWrapped("%s", settingError_.c_str());
  drawPace(model.pacer);
  model.backToDefaults = ImGui::Button("back to defaults");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("all settings, exposure and speed; those of the command line stay");
}

/// Each effect with whether it runs and why; a click goes from auto to forced on to forced off.
void Hud::drawEffects(Settings& settings, const FrameStats& stats) {
  for (size_t i = 0; i < kEffects; ++i) {
    const EffectId id = EffectId(i);
    const EffectRow& row = effectRow(id);
    const Effect& effect = stats.plan[id];
    EffectMode& mode = settings.effects[id];
    bool on = effect.on;
    ImGui::PushID(int(i));
    if (ImGui::Checkbox(row.name, &on)) mode = EffectMode((int(mode) + 1) % 3);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s\n%llu %s\nclick: auto, on, off", row.help, (unsigned long long)stats.work[i], row.work);
    ImGui::PopID();
    ImGui::SameLine(130 * scale_);
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled("%s", effect.reason.c_str());
    ImGui::PopTextWrapPos();
  }
}

void Hud::drawFigures(const FrameStats& stats) {
  for (const FigureRow& row : figureTable()) {
    const Figure figure = row.value(stats);
    if (std::holds_alternative<double>(figure) || std::string_view(row.name) == "plan") continue; // stand elsewhere
    ImGui::TextUnformatted(row.name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.help);
    ImGui::SameLine(130 * scale_);
    ImGui::TextUnformatted(figureText(figure).c_str());
  }
  if (!stats.makerTimes.empty()) ImGui::TextWrapped("%s", stats.makerTimes.c_str());
  if (!stats.cubeMakerTimes.empty()) ImGui::TextWrapped("hemicubes: %s", stats.cubeMakerTimes.c_str());
  if (!stats.areaTracer.empty()) ImGui::TextWrapped("area rays: %s", stats.areaTracer.c_str());
}

/// Who holds memory, of the program and of OpenGL, and what is left.
void Hud::drawMemory() {
  const auto mebibytes = [](uint64_t bytes) { return double(bytes) / (1 << 20); };
  ImGui::Text("%.0f MiB left", mebibytes(freeMemory()));
  if (!ImGui::BeginTable("memory", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV)) return;
  ImGui::TableSetupColumn("held by", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("of", ImGuiTableColumnFlags_WidthFixed, 60 * scale_);
  ImGui::TableSetupColumn("MiB", ImGuiTableColumnFlags_WidthFixed, 60 * scale_);
  ImGui::TableHeadersRow();
  for (const MemoryAccount::Row& row : MemoryAccount::current().rows()) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(row.owner.c_str());
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(row.gpu ? "OpenGL" : "program");
    ImGui::TableNextColumn();
    ImGui::Text("%6.1f", mebibytes(row.bytes));
  }
  ImGui::EndTable();
}

void Hud::drawStages(const FrameStats& stats) {
  // The first frame prepares everything: it would stand in the averages for a minute.
  const bool settled = stats.frame > 2;
  const auto smooth = [&](double& shown, double now) {
    shown = settled && shown > 0 ? shown + kSmoothing * (now - shown) : now;
  };
  ImGui::Text("frame %u: %.1f ms, GPU timed by %s", stats.frame, stats.wallMs, stats.timing.c_str());
  if (!ImGui::BeginTable("stages", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV)) return;
  ImGui::TableSetupColumn("stage", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("CPU ms", ImGuiTableColumnFlags_WidthFixed, 60 * scale_);
  ImGui::TableSetupColumn("GPU ms", ImGuiTableColumnFlags_WidthFixed, 60 * scale_);
  ImGui::TableHeadersRow();
  for (const StageTime& stage : stats.stages) {
    auto& [cpu, gpu] = smoothedMs_[stage.stage.id];
    smooth(cpu, stage.cpuMs);
    smooth(gpu, stage.gpuMs);
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(stage.stage.name);
    ImGui::TableNextColumn();
    ImGui::Text("%6.2f", cpu);
    ImGui::TableNextColumn();
    if (stage.gpuMs > 0) ImGui::Text("%6.2f", gpu);
  }
  ImGui::EndTable();
}

/// Settings change together or not at all: what contradicts itself is not taken, and the panel says why.
void Hud::change(Settings& settings, const std::function<void(Settings&)>& edit) {
  Settings wanted = settings;
  try {
    edit(wanted);
    settingError_ = whyNot(wanted);
  } catch (const InputError& e) {
    settingError_ = e.what();
  }
  if (settingError_.empty()) settings = wanted;
}

void Hud::drawSettings(Settings& settings) {
  ImGui::InputTextWithHint("find", "shadow, bounces, ...", &filter_);
  if (!settingError_.empty()) ImGui::TextWrapped("%s", settingError_.c_str());
  std::string group;
  bool open = false;
  for (const SettingRow& row : settingRows(settings)) {
    const std::string prefix = row.name.substr(0, row.name.find('.'));
    if (!filter_.empty()) {
      if (holds(row.name, filter_) || holds(row.help, filter_) || holds(titleOf(prefix), filter_))
        drawSetting(settings, row);
      continue;
    }
    if (prefix != group) {
      if (open) ImGui::TreePop();
      group = prefix;
      open = ImGui::TreeNode(group.c_str(), "%s", titleOf(group).c_str());
    }
    if (open) drawSetting(settings, row);
  }
  if (open) ImGui::TreePop();
}

void Hud::drawSetting(Settings& settings, const SettingRow& row) {
  const auto apply = [&](double value) {
    change(settings, [&](Settings& s) { applySetting(s, row.name, row.text(value)); });
  };
  ImGui::PushID(row.name.c_str());
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("%s", row.help.c_str());
  ImGui::PopTextWrapPos();
  const double now = row.get(settings);
  const char* label = row.name.c_str();
  bool hovered = false;
  if (row.kind == SettingKind::Flag) {
    bool on = now != 0;
    if (ImGui::Checkbox(label, &on)) apply(on);
    hovered = ImGui::IsItemHovered();
  } else if (!row.choices.empty()) {
    const bool shown = ImGui::BeginCombo(label, row.choices[size_t(now)].c_str());
    hovered = ImGui::IsItemHovered();
    for (size_t i = 0; shown && i < row.choices.size(); ++i)
      if (ImGui::Selectable(row.choices[i].c_str(), double(i) == now)) apply(double(i));
    if (shown) ImGui::EndCombo();
  } else {
    // A value counts when Enter is pressed or the field is left, not while it is being typed.
    const auto typed = edited_.find(row.name);
    std::string value = typed != edited_.end() ? typed->second : settingText(settings, row.name);
    if (ImGui::InputText(label, &value)) edited_[row.name] = value;
    hovered = ImGui::IsItemHovered();
    if (ImGui::IsItemDeactivatedAfterEdit()) change(settings, [&](Settings& s) { applySetting(s, row.name, value); });
    if (!ImGui::IsItemActive()) edited_.erase(row.name);
    if (row.scale == Scale::PowersOfTwo) {
      if (ImGui::SmallButton("half")) apply(std::max(row.low, std::floor(now / 2)));
      ImGui::SameLine();
      if (ImGui::SmallButton("twice")) apply(std::min(row.high, std::max(1.0, 2 * now)));
      ImGui::SameLine();
    }
    ImGui::TextDisabled("%s %s, usually %s", row.range().c_str(), row.unit, row.text(row.standard).c_str());
  }
  if (hovered)
    ImGui::SetTooltip("usually %s; changing it costs: %s", row.text(row.standard).c_str(), costText(row.change));
  ImGui::PopID();
}

} // namespace lambent
