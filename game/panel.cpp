// The panel: sections that fold, for whoever plays first and for whoever measures further down.
#include "game/hud.h"

#include "engine/core/error.h"
#include "gi/plan/presets.h"

#include <imgui/imgui.h>

#include <algorithm>
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
  if (section("Image", true)) drawImageSection(model, gi);
  if (section("You", true)) drawPlayer(model);
  if (section("Time", false)) drawTime(model);
  if (section("Time of day", true)) drawDay(model);
  if (section("Lights", false)) drawLights(scene);
  if (section("Speed and quality", true)) drawQuality(model, gi);
  if (truth.mode() != TruthMode::Off && section("Truth", true)) drawTruthFigures(truth);
  if (section("Where the time goes", false)) drawStages(stats);
  if (section("What the scene calls for", false)) drawEffects(gi.settings(), stats);
  if (section("Figures", false)) drawFigures(stats);
  if (section("All settings", false)) drawSettings(gi.settings());
  ImGui::PopAllowKeyboardFocus();
  ImGui::PopItemWidth();
  ImGui::End();
}

void Hud::drawImageSection(HudModel& model, Viewer& gi) {
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

void Hud::drawPlayer(HudModel& model) {
  ImGui::Text("%s (G changes it, H: home)", model.gait == Gait::Walk  ? "walking"
                                            : model.gait == Gait::Fly ? "flying"
                                                                      : "flying through walls");
  ImGui::SliderFloat("speed, times", &model.speed, 0.1f, 10, "%.2f", ImGuiSliderFlags_Logarithmic);
  ImGui::Checkbox("flashlight (Q)", &model.torch);
  ImGui::ColorEdit3("lamps (L), W/sr", &model.lampIntensity.x, ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_Float);
}

void Hud::drawTime(HudModel& model) {
  ImGui::Checkbox("time stands still (P)", &model.paused);
  float time = float(model.time);
  if (ImGui::SliderFloat("time, s", &time, 0, float(model.duration), "%.2f") && !model.recordedSeconds)
    model.time = time; // a recording's time only goes on
  if (model.hasPath) ImGui::Checkbox("follow the camera path (F)", &model.followPath);
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

/// The governor with its target, or the image's scale by hand.
void Hud::drawPace(Pacer& pacer) {
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

} // namespace lambent
