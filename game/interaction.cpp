#include "game/interaction.h"

#include "engine/core/error.h"

#include <GLFW/glfw3.h>

namespace lambent {

namespace fs = std::filesystem;

std::vector<std::pair<const char*, const char*>> keyHelp() {
  return {{"W A S D", "walk"},
          {"E / Space, Q / Ctrl", "up, down"},
          {"right mouse button", "look around"},
          {"Shift", "four times faster"},
          {"L", "carry a lamp"},
          {"P", "stop and start time"},
          {"F", "follow the shot's camera path"},
          {"V", "path-traced truth: split view, error heat map, off"},
          {"Left, Right / mouse", "move the split's divider"},
          {"R", "record a camera key into a shot"},
          {"Tab", "panel"},
          {"F1", "these keys"},
          {"F5", "reload shaders"},
          {"F12", "screenshot"},
          {"Esc", "quit"}};
}

Interaction::Interaction(GLFWwindow* window) : window_(window) {
  // A key tapped between two slow frames still reads as pressed once.
  glfwSetInputMode(window_, GLFW_STICKY_KEYS, GLFW_TRUE);
}

bool Interaction::tapped(int key) {
  const bool now = glfwGetKey(window_, key) == GLFW_PRESS;
  const bool before = std::exchange(down_[key], now);
  return now && !before;
}

Wishes Interaction::read(bool keysTaken, bool mouseTaken) {
  Wishes w;
  w.quit = tapped(GLFW_KEY_ESCAPE);
  w.help = tapped(GLFW_KEY_F1);
  w.reloadShaders = tapped(GLFW_KEY_F5);
  w.screenshot = tapped(GLFW_KEY_F12);
  if (!keysTaken) {
    w.panel = tapped(GLFW_KEY_TAB);
    w.pause = tapped(GLFW_KEY_P);
    w.lamp = tapped(GLFW_KEY_L);
    w.recordKey = tapped(GLFW_KEY_R);
    w.followPath = tapped(GLFW_KEY_F);
    w.truth = tapped(GLFW_KEY_V);
    const auto held = [&](int key) { return glfwGetKey(window_, key) == GLFW_PRESS ? 1.0f : 0.0f; };
    const float up = glm::max(held(GLFW_KEY_E), held(GLFW_KEY_SPACE));
    const float down = glm::max(held(GLFW_KEY_Q), held(GLFW_KEY_LEFT_CONTROL));
    w.move.direction = {held(GLFW_KEY_D) - held(GLFW_KEY_A), up - down, held(GLFW_KEY_S) - held(GLFW_KEY_W)};
    w.divider = held(GLFW_KEY_RIGHT) - held(GLFW_KEY_LEFT);
    w.move.fast = held(GLFW_KEY_LEFT_SHIFT) > 0 || held(GLFW_KEY_RIGHT_SHIFT) > 0;
  }

  double x = 0, y = 0;
  glfwGetCursorPos(window_, &x, &y);
  const bool button = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
  const bool looking = button && (looking_ || !mouseTaken); // once begun, looking goes on over the panel
  if (looking && looking_) {
    constexpr float kRadiansPerPixel = 0.004f;
    w.move.look = kRadiansPerPixel * vec2(float(x - cursorX_), float(cursorY_ - y));
  }
  looking_ = looking;
  if (!mouseTaken && glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS) {
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    w.dividerAt = float(x) / float(std::max(width, 1));
  }
  cursorX_ = x;
  cursorY_ = y;
  return w;
}

std::string ShotRecorder::addKey(const Player& player, const dvec3& origin) {
  if (shot_.file.empty()) {
    std::error_code failure;
    const fs::path folder = fs::absolute("out");
    fs::create_directories(folder, failure);
    if (failure) throw RunError(folder.string() + ": cannot make this folder (" + failure.message() + ")");
    int number = 1;
    const auto name = [&] { return folder / ("walk-" + std::to_string(number) + ".json"); };
    while (fs::exists(name())) ++number;
    shot_.file = name();
    shot_.scene = fs::absolute(scene_);
  }
  constexpr double kSecondsBetweenKeys = 2;
  const double t = shot_.camera.empty() ? 0 : shot_.camera.back().t + kSecondsBetweenKeys;
  const dvec3 eye = origin + dvec3(player.position());
  shot_.camera.push_back({t, eye, eye + dvec3(player.forward()), player.fovY()});
  shot_.seconds = glm::max(t, 1 / shot_.fps);
  saveShot(shot_, shot_.file);
  return "camera key " + std::to_string(shot_.camera.size()) + " at " + std::to_string(int(t)) + " s in " +
         shot_.file.string();
}

} // namespace lambent
