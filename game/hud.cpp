#include "game/hud.h"

#include "engine/core/error.h"
#include "game/interaction.h"
#include "gi/plan/presets.h"

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include <algorithm>
#include <cmath>

namespace lambent {

namespace {

constexpr double kMessageSeconds = 8;
constexpr double kSmoothing = 0.1; // share of the newest frame in a shown time

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

Hud::Hud(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr; // leave no file behind
  ImGui::StyleColorsDark();
  ImGui::GetStyle().WindowRounding = 4;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 450");
}

Hud::~Hud() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

bool Hud::keysTaken() const { return ImGui::GetIO().WantTextInput; }
bool Hud::mouseTaken() const { return ImGui::GetIO().WantCaptureMouse; }

void Hud::say(std::string message) {
  constexpr size_t kMost = 5;
  messages_.push_back({std::move(message), ImGui::GetTime() + kMessageSeconds});
  if (messages_.size() > kMost) messages_.pop_front();
}

void Hud::draw(HudModel& model, GiFrame& gi, TruthView& truth, const FrameStats& stats) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  if (model.panel) drawPanel(model, gi, truth, stats);
  drawTruthLegend(truth, model.buffer);
  if (model.help) drawHelp();
  drawMessages();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Hud::drawPanel(HudModel& model, GiFrame& gi, TruthView& truth, const FrameStats& stats) {
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  const float height = ImGui::GetIO().DisplaySize.y - 16;
  ImGui::SetNextWindowSize({340, std::min(620.0f, height)}, ImGuiCond_FirstUseEver);
  if (!ImGui::Begin("Lambent")) {
    ImGui::End();
    return;
  }
  ImGui::PushItemWidth(-110);
  ImGui::PushAllowKeyboardFocus(false); // Tab shows this panel, and would begin to type into it
  std::string view = bufferNames()[size_t(model.buffer)];
  if (choose("show", bufferNames(), view)) model.buffer = bufferByName(view);
  std::string technique = techniqueOf(gi.settings()).name;
  if (choose("technique", techniqueNames(), technique))
    change(gi.settings(), [&](Settings& s) { applyTechnique(s, technique); });
  if (choose("preset", presetNames(), model.preset))
    change(gi.settings(), [&](Settings& s) { applyPreset(s, model.preset); });
  const auto preset = std::ranges::find(presetTable(), model.preset, &Preset::name);
  if (preset != presetTable().end() && ImGui::IsItemHovered())
    ImGui::SetTooltip("measured: %.2f of the default's time, %.2f of its error", preset->time, preset->error);
  if (!settingError_.empty()) ImGui::TextWrapped("%s", settingError_.c_str());

  if (truth.mode() != TruthMode::Off && ImGui::CollapsingHeader("Truth", ImGuiTreeNodeFlags_DefaultOpen))
    drawTruthFigures(truth);

  ImGui::Separator();
  ImGui::Checkbox("paused", &model.paused);
  if (model.hasPath) {
    ImGui::SameLine();
    ImGui::Checkbox("follow the shot's camera", &model.followPath);
  }
  float time = float(model.time);
  if (ImGui::SliderFloat("time, s", &time, 0, float(model.duration), "%.2f")) model.time = time;
  ImGui::SliderFloat("speed, m/s", &model.speed, 0.01f, 100, "%.2f", ImGuiSliderFlags_Logarithmic);
  drawPace(model.pacer);
  ImGui::Checkbox("carry a lamp", &model.lamp);
  if (model.lamp)
    ImGui::ColorEdit3("W/sr", &model.lampIntensity.x, ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_Float);

  float exposure = gi.exposure();
  if (ImGui::SliderFloat("exposure", &exposure, 1e-3f, 1e3f, "%.4g", ImGuiSliderFlags_Logarithmic))
    gi.settings().image.exposure = exposure;

  if (ImGui::CollapsingHeader("Time", ImGuiTreeNodeFlags_DefaultOpen)) drawStages(stats);
  if (ImGui::CollapsingHeader("Effects", ImGuiTreeNodeFlags_DefaultOpen)) drawEffects(gi.settings(), stats);
  if (ImGui::CollapsingHeader("Figures", ImGuiTreeNodeFlags_DefaultOpen)) {
    for (const FigureRow& row : figureTable()) {
      const Figure figure = row.value(stats);
      if (std::holds_alternative<double>(figure) || std::string_view(row.name) == "plan") continue; // stand elsewhere
      ImGui::TextUnformatted(row.name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.help);
      ImGui::SameLine(130);
      ImGui::TextUnformatted(figureText(figure).c_str());
    }
    if (!stats.makerTimes.empty()) ImGui::TextWrapped("%s", stats.makerTimes.c_str());
    if (!stats.cubeMakerTimes.empty()) ImGui::TextWrapped("hemicubes: %s", stats.cubeMakerTimes.c_str());
    if (!stats.areaTracer.empty()) ImGui::TextWrapped("area rays: %s", stats.areaTracer.c_str());
  }
  if (ImGui::CollapsingHeader("Settings")) drawSettings(gi.settings());
  ImGui::TextDisabled("F1: keys   Tab: hide this panel");
  ImGui::PopAllowKeyboardFocus();
  ImGui::PopItemWidth();
  ImGui::End();
}

/// The governor with its target, or the picture's scale by hand.
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
  if (!governs && ImGui::SliderFloat("picture scale", &value, 0.1f, 1, "%.2f")) pacer.hold(value);
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
    ImGui::SameLine(130);
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled("%s", effect.reason.c_str());
    ImGui::PopTextWrapPos();
  }
}

void Hud::drawStages(const FrameStats& stats) {
  // The first frame prepares everything: it would stand in the averages for a minute.
  const bool settled = stats.frame > 1;
  const auto smooth = [&](double& shown, double now) {
    shown = settled && shown > 0 ? shown + kSmoothing * (now - shown) : now;
  };
  smooth(smoothedFrameMs_, stats.wallMs);
  ImGui::Text("frame %u: %.1f ms, GPU timed by %s", stats.frame, smoothedFrameMs_, stats.timing.c_str());
  if (!ImGui::BeginTable("stages", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV)) return;
  ImGui::TableSetupColumn("stage", ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableSetupColumn("CPU ms", ImGuiTableColumnFlags_WidthFixed, 60);
  ImGui::TableSetupColumn("GPU ms", ImGuiTableColumnFlags_WidthFixed, 60);
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
  const auto apply = [&](const std::string& name, const std::string& value) {
    change(settings, [&](Settings& s) { applySetting(s, name, value); });
  };
  std::string group;
  bool open = false;
  for (const SettingRow& row : settingsTable()) {
    const size_t dot = row.name.find('.');
    if (row.name.substr(0, dot) != group) {
      if (open) ImGui::TreePop();
      group = row.name.substr(0, dot);
      open = ImGui::TreeNode(group.c_str());
    }
    if (!open) continue;
    const std::string label = row.name.substr(dot + 1) + "##" + group;
    std::string value = settingText(settings, row.name);
    if (row.kind == SettingKind::Flag) {
      bool on = row.get(settings) != 0;
      if (ImGui::Checkbox(label.c_str(), &on)) apply(row.name, row.text(on));
    } else if (!row.choices.empty()) {
      if (choose(label.c_str(), row.choices, value)) apply(row.name, value);
    } else {
      // A value counts when Enter is pressed or the field is left, not while it is being typed.
      const auto typed = edited_.find(row.name);
      if (typed != edited_.end()) value = typed->second;
      if (ImGui::InputText(label.c_str(), &value)) edited_[row.name] = value;
      if (ImGui::IsItemDeactivatedAfterEdit()) apply(row.name, value);
      if (!ImGui::IsItemActive()) edited_.erase(row.name);
      if (row.scale == Scale::PowersOfTwo) {
        const double now = row.get(settings);
        const std::string half = "/2##" + row.name, twice = "x2##" + row.name;
        ImGui::SameLine();
        if (ImGui::SmallButton(half.c_str())) apply(row.name, row.text(std::max(row.low, std::floor(now / 2))));
        ImGui::SameLine();
        if (ImGui::SmallButton(twice.c_str())) apply(row.name, row.text(std::min(row.high, std::max(1.0, 2 * now))));
      }
    }
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s\n%s\nrange %s %s, default %s\nchanging it costs: %s", row.name.c_str(), row.help.c_str(),
                        row.range().c_str(), row.unit, row.text(row.standard).c_str(), costText(row.change));
  }
  if (open) ImGui::TreePop();
}

void Hud::drawHelp() const {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * size.x, 0.5f * size.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::Begin("Keys", nullptr,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove);
  if (ImGui::BeginTable("keys", 2)) {
    for (const auto& [key, meaning] : keyHelp()) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(key);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(meaning);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

void Hud::drawMessages() {
  std::erase_if(messages_, [](const Message& m) { return m.until < ImGui::GetTime(); });
  if (messages_.empty()) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x - 8, size.y - 8}, ImGuiCond_Always, {1, 1});
  ImGui::SetNextWindowBgAlpha(0.6f);
  ImGui::Begin("messages", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
  for (const Message& m : messages_) ImGui::TextUnformatted(m.text.c_str());
  ImGui::End();
}

} // namespace lambent
