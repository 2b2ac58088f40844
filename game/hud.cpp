#include "game/hud.h"

#include "engine/gl/objects.h"
#include "game/input.h"

#include <GLFW/glfw3.h>

#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace lambent {

namespace {

constexpr double kMessageSeconds = 8;

constexpr ImGuiWindowFlags kDialog = ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                     ImGuiWindowFlags_AlwaysAutoResize;

/// What each buffer shows, in words; in the order of bufferNames().
constexpr std::array<const char*, 13> kViews = {
    "the image",
    "light that comes straight from lamps, sun and sky",
    "light that has bounced, as surfaces send it on",
    "light that has bounced, as it arrives",
    "colours of surfaces",
    "where surfaces face: red east, green up, blue south",
    "distance: near dark, far bright",
    "light that surfaces emit",
    "light that has bounced, before it is smoothed: each pixel of 4 x 4 has lights of its own",
    "virtual lights: colour is their light, rings grow with age",
    "what the first virtual lights see: near dark, far bright",
    "patches that gather as one: blue large, red small",
    "faults: magenta not a number, cyan infinite",
};

void centre(float width) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * size.x, 0.5f * size.y}, ImGuiCond_Always, {0.5f, 0.5f});
  if (width > 0) ImGui::SetNextWindowSize({std::min(width, size.x - 16), 0});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {size.x - 16, size.y - 16});
}

/// Says what the window shows, where it is not the image.
void drawViewLegend(const HudModel& model) {
  if (model.buffer == Buffer::Beauty) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const Overlay window("view", {0.5f * size.x, size.y - 8}, {0.5f, 1});
  ImGui::Text("%s: %s (1: the image)", bufferNames()[size_t(model.buffer)].c_str(), kViews[size_t(model.buffer)]);
}

} // namespace

void FrameTimes::add(double seconds, const FrameStats& stats) {
  Frame frame{1000 * seconds, 0, 0};
  for (const StageTime& s : stats.stages) {
    frame.gpuMs += s.gpuMs;
    if (s.gpuMs <= 0) frame.cpuMs += s.cpuMs; // of the others it is the time to ask the GPU, or to wait for it
  }
  frames_.push_back(frame);
  if (frames_.size() > kMost) frames_.pop_front();
}

double FrameTimes::meanMs() const {
  double ms = 0;
  size_t first = frames_.size();
  while (first > 0 && ms < 1000) ms += frames_[--first].wholeMs;
  return first < frames_.size() ? ms / double(frames_.size() - first) : 0;
}

Overlay::Overlay(const char* id, const ImVec2& at, const ImVec2& pivot) {
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
  ImGui::SetNextWindowBgAlpha(0.6f);
  ImGui::Begin(id, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
}
Overlay::~Overlay() { ImGui::End(); }

Hud::Hud(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr; // leave no file behind
  ImGui::StyleColorsDark();
  ImGui::GetStyle().WindowRounding = 4;
  float sideways = 1;
  glfwGetWindowContentScale(window, &scale_, &sideways);
  scale_ = std::clamp(scale_, 1.0f, 4.0f);
  ImGui::GetStyle().ScaleAllSizes(scale_);
  ImGui::GetIO().FontGlobalScale = scale_;
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
  lastSaid_ = message;
  messages_.push_back({std::move(message), ImGui::GetTime() + kMessageSeconds});
  if (messages_.size() > kMost) messages_.pop_front();
}

void Hud::begin() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Hud::end() {
  drawMessages();
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Hud::draw(HudModel& model, Scene& scene, Viewer& gi, TruthView& truth, const FrameStats& stats,
               const FrameTimes& times) {
  if (model.panel) drawPanel(model, scene, gi, truth, stats);
  drawSpeed(model, times);
  if (truth.mode() == TruthMode::Off)
    drawViewLegend(model);
  else
    drawTruthLegend(truth, model.buffer);
  drawOffer(model);
  if (model.help) drawHelp();
}

void Hud::drawProgress(const std::string& scene, const std::string& at, float share) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  if (keptFrame_) {
    const auto texture = reinterpret_cast<ImTextureID>(uintptr_t(keptFrame_->name()));
    ImGui::GetBackgroundDrawList()->AddImage(texture, {0, 0}, size, {0, 1}, {1, 0}); // GL's first row is the lowest
  }
  centre(360 * scale_);
  ImGui::Begin("opening", nullptr, kDialog | ImGuiWindowFlags_NoTitleBar);
  ImGui::Text("opening %s", scene.c_str());
  ImGui::ProgressBar(share);
  ImGui::TextDisabled("%s   (Esc: cancel)", at.c_str());
  ImGui::End();
}

MenuChoice Hud::drawMenu(const std::vector<std::string>& scenes, bool playing) {
  MenuChoice choice;
  centre(0);
  ImGui::Begin("Lambent", nullptr, kDialog);
  const float width = 300 * scale_;
  const auto button = [&](const char* label) { return ImGui::Button(label, {width, 0}); };
  if (playing) {
    choice.resume = button("go on (Esc)");
    choice.home = button("back to where you began (H)");
    choice.restart = button("start again (F2)");
    ImGui::Separator();
  }
  ImGui::TextDisabled("open a scene, or drop a .gltf, .glb or shot here");
  const float row = ImGui::GetTextLineHeightWithSpacing();
  const float most = std::max(3 * row, ImGui::GetIO().DisplaySize.y - 14 * row);
  if (!scenes.empty() && ImGui::BeginChild("scenes", {width, std::min(most, row * float(scenes.size()) + 8)}, true)) {
    for (const std::string& scene : scenes)
      if (ImGui::Selectable(std::filesystem::path(scene).stem().string().c_str())) choice.scene = scene;
  }
  if (!scenes.empty()) ImGui::EndChild();
  ImGui::Separator();
  choice.quit = button(playing ? "quit" : "quit (Esc)");
  ImGui::End();
  return choice;
}

void Hud::keepFrame() {
  const ImVec2 size = ImGui::GetIO().DisplaySize, pixels = ImGui::GetIO().DisplayFramebufferScale;
  const int width = int(size.x * pixels.x), height = int(size.y * pixels.y);
  keptFrame_ = std::make_unique<gl::Texture>(
      "hud/kept frame", gl::TextureDesc{.format = GL_RGBA8, .width = width, .height = height, .linear = true});
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glCopyTextureSubImage2D(keptFrame_->name(), 0, 0, 0, 0, 0, width, height);
}

void Hud::forgetFrame() { keptFrame_.reset(); }

/// Frames per second, and what the last ones spent their time on.
void Hud::drawSpeed(const HudModel& model, const FrameTimes& times) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const Overlay window("speed", {size.x - 8, 8}, {1, 0});
  const double ms = times.meanMs();
  ImGui::Text("%4.0f fps %6.1f ms", ms > 0 ? 1000 / ms : 0, ms);
  if (model.recordedSeconds) ImGui::TextColored({1, 0.35f, 0.3f, 1}, "recording %.1f s", *model.recordedSeconds);
  const auto& frames = times.frames();
  if (size.x >= 480 * scale_ && frames.size() > 1) {
    constexpr ImU32 kCpu = IM_COL32(90, 160, 255, 255), kGpu = IM_COL32(255, 170, 60, 255),
                    kRest = IM_COL32(110, 110, 110, 255);
    const float width = 170 * scale_, height = 40 * scale_;
    double most = 1000.0 / 60;
    for (const FrameTimes::Frame& f : frames) most = std::max(most, f.wholeMs);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float each = std::max(1.0f, width / float(frames.size()));
    const size_t shown = std::min(frames.size(), size_t(width / each));
    for (size_t i = 0; i < shown; ++i) {
      const FrameTimes::Frame& f = frames[frames.size() - shown + i];
      const float x = at.x + each * float(i);
      const auto bar = [&](double from, double to, ImU32 color) {
        const float scale = height / float(most);
        list->AddRectFilled({x, at.y + height - scale * float(to)}, {x + each, at.y + height - scale * float(from)},
                            color);
      };
      bar(0, f.wholeMs, kRest);
      bar(0, std::min(f.cpuMs + f.gpuMs, f.wholeMs), kGpu);
      bar(0, std::min(f.cpuMs, f.wholeMs), kCpu);
    }
    ImGui::Dummy({width, height});
    ImGui::TextColored(ImColor(kCpu), "CPU %.0f", frames.back().cpuMs);
    ImGui::SameLine();
    ImGui::TextColored(ImColor(kGpu), "GPU %.0f", frames.back().gpuMs);
    ImGui::SameLine();
    ImGui::TextDisabled("of %.0f ms", most);
  }
  if (model.pacer.scale() < 1) ImGui::TextDisabled("image at %.0f %%", 100 * double(model.pacer.scale()));
  if (model.goal) drawGoal(*model.goal);
}

/// What the goal has of what it wants.
void Hud::drawGoal(const GoalShown& goal) const {
  const bool small = goal.wanted < 0.1f;
  const double unit = small ? 1e3 : 1;
  const ImVec4 color = goal.reached ? ImVec4(0.35f, 0.8f, 0.4f, 1) : ImVec4(0.95f, 0.75f, 0.3f, 1);
  ImGui::Separator();
  ImGui::Text("%s %.2f of %.2f %sW/m\u00b2", goal.what.c_str(), unit * double(goal.irradiance),
              unit * double(goal.wanted), small ? "m" : "");
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, color);
  ImGui::ProgressBar(goal.irradiance / goal.wanted, {ImGui::GetContentRegionAvail().x, 8 * scale_}, "");
  ImGui::PopStyleColor();
  ImGui::TextColored(color, goal.reached ? "done" : "bring daylight here");
}

/// A point where one looks, and what could be done there.
void Hud::drawOffer(const HudModel& model) const {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImDrawList* list = ImGui::GetBackgroundDrawList();
  const ImVec2 middle{0.5f * size.x, 0.5f * size.y};
  list->AddCircleFilled(middle, 2.5f * scale_, IM_COL32(0, 0, 0, 120));
  list->AddCircleFilled(middle, 1.5f * scale_, IM_COL32(255, 255, 255, 200));
  if (model.offer.empty()) return;
  const Overlay window("offer", {middle.x, middle.y + 24 * scale_}, {0.5f, 0});
  ImGui::TextUnformatted(model.offer.c_str());
}

void Hud::drawHelp() const {
  centre(520 * scale_);
  ImGui::Begin("Keys", nullptr, kDialog);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("meaning", ImGuiTableColumnFlags_WidthStretch);
    for (const auto& [key, meaning] : keyHelp()) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      if (*meaning)
        ImGui::TextUnformatted(key);
      else
        ImGui::TextDisabled("%s", key);
      ImGui::TableNextColumn();
      ImGui::TextWrapped("%s", meaning);
    }
    ImGui::EndTable();
  }
  ImGui::End();
}

void Hud::drawMessages() {
  std::erase_if(messages_, [](const Message& m) { return m.until < ImGui::GetTime(); });
  if (messages_.empty()) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowSizeConstraints({0, 0}, {size.x - 16, size.y});
  const Overlay window("messages", {8, size.y - 8}, {0, 1});
  ImGui::PushTextWrapPos(size.x - 40 * scale_);
  for (const Message& m : messages_) ImGui::TextUnformatted(m.text.c_str());
  ImGui::PopTextWrapPos();
}

} // namespace lambent
