// What the panel and the window show of the truth.
#include "game/hud.h"
#include "shaders/shared/error_color.h"

#include <imgui/imgui.h>

#include <cmath>

namespace lambent {

namespace {

/// Three digits at least, whatever the size.
std::string number(double value, const char* unit = "") {
  if (!std::isfinite(value)) return "?";
  char text[32];
  std::snprintf(text, sizeof text, value >= 100 ? "%.0f%s" : "%.3g%s", value, unit);
  return text;
}

std::string percent(double share, const char* format = "%.2f %%") {
  if (!std::isfinite(share)) return "?";
  char text[32];
  std::snprintf(text, sizeof text, format, 100 * share);
  return text;
}

void row(const char* name, const std::string& own, const std::string& truth, const char* help) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(name);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", help);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(own.c_str());
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(truth.c_str());
}

std::string plural(int count, const char* noun) { return std::to_string(count) + " " + noun + (count == 1 ? "" : "s"); }

const std::string& nameOf(ReferenceBuffer buffer) { return bufferNames()[size_t(buffer)]; }

/// What may be said of the image's error for the present.
std::string verdict(const AgainstTruth& against) {
  if (const std::optional<double> own = against.imageRmse())
    return "GI's own RMSE: " + percent(*own / against.error.meanTruth) + " of the mean";
  return "mostly the truth's own noise so far";
}

/// From -1 to 1.
void drawColorBar(float width, float height) {
  constexpr int kSteps = 64;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (int i = 0; i < kSteps; ++i) {
    const vec3 c = errorColor((float(i) + 0.5f) * 2 / kSteps - 1);
    list->AddRectFilled({at.x + width * float(i) / kSteps, at.y}, {at.x + width * float(i + 1) / kSteps, at.y + height},
                        ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, 1}));
  }
  ImGui::Dummy({width, height});
}

/// Texts of one line, each of which ends at the right, stands in the middle or begins at the left: at 1, 0.5 or 0.
void textsAlong(float width, const std::vector<std::pair<float, std::string>>& texts) {
  const float left = ImGui::GetStyle().WindowPadding.x, line = ImGui::GetCursorPosY();
  for (const auto& [at, text] : texts) {
    ImGui::SetCursorPos({left + at * (width - ImGui::CalcTextSize(text.c_str()).x), line});
    ImGui::TextUnformatted(text.c_str());
  }
}

} // namespace

void drawTruthFigures(TruthView& view) {
  const LiveTruth* truth = view.truth();
  if (!truth) {
    ImGui::TextWrapped("the truth starts again once all stands still: %s", view.reason().c_str());
    return;
  }
  const AgainstTruth& a = view.against();
  const FramesSpent& spent = view.spent();
  const bool single = truth->samples < 2;
  ImGui::Text("%s, path traced with %s", nameOf(truth->buffer).c_str(), plural(truth->bounces, "bounce").c_str());
  if (ImGui::BeginTable("truth", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV)) {
    ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, 75);
    ImGui::TableSetupColumn("GI's error");
    ImGui::TableSetupColumn("the truth's own");
    ImGui::TableHeadersRow();
    const auto own = [&](const std::string& text) { return single ? "?" : text; };
    row("RMSE", number(a.error.rmse), own(number(a.truthRmse)),
        "root of the mean squared difference, over all pixels and channels; next to it what to expect of\n"
        "the truth by its standard error. GI's figure holds both.");
    const double mean = a.error.meanTruth;
    row("of the mean", percent(a.error.rmseShare()), own(percent(a.truthRmse / mean)), "RMSE over the truth's mean");
    row("relMSE", number(a.error.relMse), own(number(a.truthRelMse)), "mean of (a - b)^2 / (b^2 + 0.01)");
    row("bias", percent(a.error.bias, "%+.2f %%"), own(percent(a.truthBias, "\u00b1%.2f %%")),
        "mean of the difference over the truth's mean");
    row("ms", spent.drawn ? number(spent.typicalMs(), " a frame") : "no frame drawn",
        number(truth->ms / truth->samples, " a sample"),
        "median of the frames that were drawn since anything changed; a settled one stays. Paths that are\n"
        "traced meanwhile take their share of the machine: lambent bench measures times alone.");
    row("s in all", number(1e-3 * spent.ms), number(1e-3 * truth->ms), "spent on this view so far");
    row("in", plural(spent.drawn, "frame"), plural(int(truth->samples), "sample"), "what that was spent for");
    ImGui::EndTable();
  }
  ImGui::TextUnformatted(verdict(a).c_str());
  if (const std::optional<double> ms = pathTracingMs(a.error.relMse, a.truthRelMse, truth->ms))
    ImGui::Text("path tracing comes as near in %s s", number(1e-3 * *ms).c_str());
  ImGui::TextDisabled("each takes time from the other while both run");
  if (view.mode() == TruthMode::Heat) {
    float full = 100 * view.fullError;
    const char* format = full > 0 ? "%.0f" : "2 x RMSE";
    if (ImGui::SliderFloat("full colour, %", &full, 0, 1000, format, ImGuiSliderFlags_Logarithmic))
      view.fullError = full < 1 ? 0 : full / 100;
  } else {
    ImGui::SliderFloat("divider", &view.divider, 0, 1, "%.2f");
  }
}

void drawTruthLegend(const TruthView& view, Buffer shown) {
  if (view.mode() == TruthMode::Off) return;
  const bool heat = view.mode() == TruthMode::Heat;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  // A window of its own for each: one that grows would be cut off for a frame.
  const LiveTruth* truth = view.truth();
  const char* id = !referenceOf(shown) ? "no truth" : !truth ? "truth again" : heat ? "truth heat" : "truth split";
  const Overlay window(id, {size.x - 8, size.y - 8}, {1, 1});
  constexpr float kWidth = 260;
  if (!referenceOf(shown)) {
    ImGui::Text("no truth of %s:", bufferNames()[size_t(shown)].c_str());
    ImGui::TextUnformatted("show beauty, direct, indirect or irradiance");
  } else if (!truth) {
    ImGui::Text("the truth starts again\nonce all stands still:\n%s", view.reason().c_str());
  } else {
    const AgainstTruth& a = view.against();
    if (!heat) {
      ImGui::Text("left GI, right path traced, %s", plural(int(truth->samples), "sample").c_str());
    } else {
      const std::string full = percent(view.fullErrorNow(), "%.3g %%");
      drawColorBar(kWidth, 10);
      textsAlong(kWidth, {{0.0f, "-" + full}, {0.5f, "0"}, {1.0f, "+" + full}});
      textsAlong(kWidth, {{0.0f, "GI too dark"}, {1.0f, "GI too bright"}});
      ImGui::Text("of the truth's mean, %s", plural(int(truth->samples), "sample").c_str());
    }
    ImGui::Text("%s RMSE %s, bias %s", nameOf(truth->buffer).c_str(), percent(a.error.rmseShare()).c_str(),
                percent(a.error.bias, "%+.2f %%").c_str());
    const FramesSpent& spent = view.spent();
    ImGui::Text("%s, %s", spent.drawn ? number(spent.typicalMs(), " ms a frame").c_str() : "no frame drawn",
                number(truth->ms / truth->samples, " ms a sample").c_str());
    ImGui::TextUnformatted(verdict(a).c_str());
  }
}

} // namespace lambent
