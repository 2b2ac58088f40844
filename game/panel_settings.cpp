// Every setting, in groups with plain names, each with what it means, its range, and what changing it costs.
#include "game/hud.h"

#include "engine/core/error.h"

#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace lambent {

namespace {

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
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), same) != text.end();
}

} // namespace

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
