#include "game/input.h"

#include "engine/core/error.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <sstream>
#include <utility>

namespace lambent {

namespace {
constexpr float kRadiansPerPixel = 0.004f;

/// -1: there is none of the name.
int keyOf(const std::string& name) {
  if (name.size() == 1)
    return std::isupper(name[0]) || std::isdigit(name[0]) ? name[0] : -1; // GLFW's are those of ASCII
  constexpr std::pair<const char*, int> kNames[] = {
      {"Space", GLFW_KEY_SPACE}, {"Tab", GLFW_KEY_TAB}, {"F1", GLFW_KEY_F1}, {"F2", GLFW_KEY_F2}};
  for (const auto& [known, key] : kNames)
    if (name == known) return key;
  return -1;
}
} // namespace

std::vector<std::pair<const char*, const char*>> keyHelp() {
  return {{"Moving", ""},
          {"W A S D", "walk"},
          {"Space", "jump; up, when flying"},
          {"C", "down, when flying"},
          {"Shift", "faster"},
          {"mouse", "look around: click into the image, Esc lets go; or hold the right button"},
          {"G", "walk, fly, fly through walls"},
          {"H", "home: back to where you began"},
          {"F", "follow the camera of the shot, or of your recording"},
          {"Hands", ""},
          {"E", "use a door, a lift or a button; take, put down"},
          {"B", "a white board; again: boxes, white, red, green, blue, none"},
          {"L", "a lamp; again: put it away"},
          {"click", "throw what you carry (once the mouse looks around)"},
          {"Q", "flashlight"},
          {"T", "let the day go by, or stop it"},
          {"[ ]", "darker, brighter image"},
          {"Seeing", ""},
          {"1 ... 9, 0", "what the image shows (the panel names them)"},
          {"V", "path-traced truth next to the image, then its error, then off"},
          {"Left, Right / mouse", "move the divider"},
          {"Tab", "panel"},
          {"Program", ""},
          {"P", "stop and start time"},
          {"R", "record your walk as a shot; again: stop, and see it"},
          {"F2", "start again"},
          {"F5", "reload shaders"},
          {"F12", "screenshot (PNG of the image, EXR of the light)"},
          {"F1", "these keys"},
          {"Esc", "menu: go on, other scenes, quit"}};
}

Input::Input(GLFWwindow* window) : window_(window) {
  // A key or button tapped between two slow frames still reads as pressed once.
  glfwSetInputMode(window_, GLFW_STICKY_KEYS, GLFW_TRUE);
  glfwSetInputMode(window_, GLFW_STICKY_MOUSE_BUTTONS, GLFW_TRUE);
}

void Input::script(const std::string& presses) {
  std::istringstream in(presses);
  for (std::string word; in >> word;) {
    const size_t at = word.find('@');
    const std::string name = word.substr(0, at);
    Press press{keyOf(name), 0, 0};
    char end = 0;
    const int numbers = at == word.npos ? 0 : std::sscanf(word.c_str() + at, "@%d-%d%c", &press.from, &press.to, &end);
    if (press.key < 0 || numbers < 1 || numbers > 2) throw InputError("--press " + word, "KEY@FRAME or KEY@FROM-TO");
    if (numbers == 1) press.to = press.from;
    presses_.push_back(press);
  }
}

bool Input::down(int key) const {
  return glfwGetKey(window_, key) == GLFW_PRESS || std::ranges::any_of(presses_, [&](const Press& p) {
           return p.key == key && p.from <= frame_ && frame_ <= p.to;
         });
}

bool Input::tapped(int key) {
  const bool now = down(key);
  return !std::exchange(down_[key], now) && now;
}

bool Input::clicked(int button) {
  const bool now = glfwGetMouseButton(window_, button) == GLFW_PRESS;
  return !std::exchange(buttons_[button], now) && now;
}

bool Input::escape() { return tapped(GLFW_KEY_ESCAPE); }

void Input::capture() {
  captured_ = true;
  glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_DISABLED);
  glfwGetCursorPos(window_, &cursorX_, &cursorY_);
}

void Input::release() {
  if (captured_) glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_NORMAL);
  captured_ = looking_ = false;
}

Wishes Input::read(bool keysTaken, bool mouseTaken, bool mayCapture, float seconds) {
  Wishes w;
  ++frame_;
  w.help = tapped(GLFW_KEY_F1);
  w.restart = tapped(GLFW_KEY_F2);
  w.reloadShaders = tapped(GLFW_KEY_F5);
  w.screenshot = tapped(GLFW_KEY_F12);
  if (!keysTaken) readKeys(w);
  readMouse(w, mouseTaken, mayCapture);
  readPad(w, seconds);
  if (escape()) {
    if (captured_)
      release();
    else
      w.menu = true;
  }
  return w;
}

void Input::readKeys(Wishes& w) {
  w.panel = tapped(GLFW_KEY_TAB);
  w.pause = tapped(GLFW_KEY_P);
  w.lamp = tapped(GLFW_KEY_L);
  w.box = tapped(GLFW_KEY_B);
  w.use = tapped(GLFW_KEY_E);
  w.dayRuns = tapped(GLFW_KEY_T);
  w.torch = tapped(GLFW_KEY_Q);
  w.record = tapped(GLFW_KEY_R);
  w.followPath = tapped(GLFW_KEY_F);
  w.truth = tapped(GLFW_KEY_V);
  w.gait = tapped(GLFW_KEY_G);
  w.home = tapped(GLFW_KEY_H) || tapped(GLFW_KEY_HOME);
  w.exposure = int(tapped(GLFW_KEY_RIGHT_BRACKET)) - int(tapped(GLFW_KEY_LEFT_BRACKET));
  for (int digit = 0; digit < 10; ++digit)
    if (tapped(GLFW_KEY_0 + digit)) w.buffer = (digit + 9) % 10;
  const auto held = [&](int key) { return down(key) ? 1.0f : 0.0f; };
  const float up = held(GLFW_KEY_SPACE), down = glm::max(held(GLFW_KEY_C), held(GLFW_KEY_LEFT_CONTROL));
  w.move.direction = {held(GLFW_KEY_D) - held(GLFW_KEY_A), up - down, held(GLFW_KEY_S) - held(GLFW_KEY_W)};
  w.move.jump = up > 0;
  w.move.fast = held(GLFW_KEY_LEFT_SHIFT) > 0 || held(GLFW_KEY_RIGHT_SHIFT) > 0;
  w.divider = held(GLFW_KEY_RIGHT) - held(GLFW_KEY_LEFT);
}

void Input::readMouse(Wishes& w, bool mouseTaken, bool mayCapture) {
  double x = 0, y = 0;
  glfwGetCursorPos(window_, &x, &y);
  const bool click = clicked(GLFW_MOUSE_BUTTON_LEFT);
  if (click && captured_) w.hurl = true;
  const bool button = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
  const bool looking = captured_ || (button && (looking_ || !mouseTaken)); // once begun it goes on over the panel
  if (looking && looking_) w.move.look = kRadiansPerPixel * vec2(float(x - cursorX_), float(cursorY_ - y));
  looking_ = looking;
  cursorX_ = x;
  cursorY_ = y;
  if (click && !captured_ && !mouseTaken && mayCapture) capture();
  if (!mouseTaken && !captured_ && buttons_[GLFW_MOUSE_BUTTON_LEFT]) {
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    w.dividerAt = float(x) / float(std::max(width, 1));
  }
}

void Input::readPad(Wishes& w, float seconds) {
  GLFWgamepadstate state;
  int joystick = GLFW_JOYSTICK_1; // one that was unplugged may come back as another
  while (joystick <= GLFW_JOYSTICK_LAST && !glfwGetGamepadState(joystick, &state)) ++joystick;
  if (joystick > GLFW_JOYSTICK_LAST) {
    padBefore_ = {}; // its buttons are up
    return;
  }
  const auto axis = [&](int i) { return state.axes[i]; };
  const PadState pad{{axis(GLFW_GAMEPAD_AXIS_LEFT_X), axis(GLFW_GAMEPAD_AXIS_LEFT_Y)},
                     {axis(GLFW_GAMEPAD_AXIS_RIGHT_X), axis(GLFW_GAMEPAD_AXIS_RIGHT_Y)},
                     0.5f * (axis(GLFW_GAMEPAD_AXIS_LEFT_TRIGGER) + 1),
                     0.5f * (axis(GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER) + 1)};
  constexpr std::array<int, kPadButtons> kButtons = {GLFW_GAMEPAD_BUTTON_A,           GLFW_GAMEPAD_BUTTON_B,
                                                     GLFW_GAMEPAD_BUTTON_X,           GLFW_GAMEPAD_BUTTON_Y,
                                                     GLFW_GAMEPAD_BUTTON_LEFT_BUMPER, GLFW_GAMEPAD_BUTTON_RIGHT_BUMPER,
                                                     GLFW_GAMEPAD_BUTTON_BACK,        GLFW_GAMEPAD_BUTTON_START,
                                                     GLFW_GAMEPAD_BUTTON_DPAD_UP,     GLFW_GAMEPAD_BUTTON_DPAD_DOWN};
  PadButtons down{};
  for (size_t i = 0; i < kPadButtons; ++i) down[i] = state.buttons[kButtons[i]] == GLFW_PRESS;
  const auto pressed = [&](PadButton b) { return down[size_t(b)] && !padBefore_[size_t(b)]; };
  addPad(w.move, pad, down, seconds);
  w.gait |= pressed(PadButton::Gait);
  w.use |= pressed(PadButton::Use);
  w.torch |= pressed(PadButton::Torch);
  w.hurl |= pressed(PadButton::Hurl);
  w.home |= pressed(PadButton::Home);
  w.menu |= pressed(PadButton::Menu);
  w.lamp |= pressed(PadButton::Lamp);
  w.box |= pressed(PadButton::Box);
  padBefore_ = down;
}

} // namespace lambent
