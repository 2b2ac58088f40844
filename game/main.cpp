// The walkthrough: its options, and what it does about errors.
#include "engine/core/error.h"
#include "engine/core/interrupt.h"
#include "game/app.h"
#include "tools/launch/streams.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>

namespace lambent {
namespace {

/// Returns nothing when --help was all that was asked for.
std::optional<GameOptions> readOptions(int argc, char** argv) {
  GameOptions options;
  CLI::App app{"Walk through a scene under global illumination that follows its moving lights and objects.\n"
               "W A S D walk, a click into the image lets the mouse look around; F1 shows all keys.",
               "walkthrough"};
  app.add_option("SCENE", options.launch.scene, "glTF or shot file (default: the bundled hall)");
  addLaunchOptions(app, options.launch);
  app.add_option("--buffer", options.buffer, "what to show first: beauty, indirect, vpls, ...");
  app.add_option("--target-ms", options.targetMs,
                 "choose the preset (where none is given) that fits this time of a frame, and hold it by the image's "
                 "scale; without, only where frames take longer than 90 ms")
      ->check(CLI::Range(1.0, 10000.0));
  app.add_option("--fps", options.fps,
                 "let scene time go by in steps of 1/FPS, however long frames take: what R records is then drawn by "
                 "lambent record with the same frame log, at the size of the window")
      ->check(CLI::Range(1.0, 1000.0));
  app.add_flag("--fresh", options.fresh,
               "without the settings that were changed in the window before, which stay kept");
  app.add_option("--frames", options.frames)->check(CLI::Range(0, 1000000))->group("");
  app.add_option("--screenshot", options.screenshot)->group("");
  app.add_option("--truth", options.truth)->check(CLI::IsMember({"split", "heat"}))->group("");
  app.add_option("--press", options.press)->group("");
  app.add_option("--state", options.state)->group("");
  refuseUnusable(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    app.exit(e);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    std::string text = e.what();
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw InputError("command line", text + " (see walkthrough --help)");
  }
  bufferByName(options.buffer);                 // before a window opens
  chosenSettings(options.launch, std::nullopt); // likewise
  if (options.launch.scene.empty()) options.launch.scene = (findContentFolder() / "hall/hall.gltf").string();
  return options;
}

} // namespace
} // namespace lambent

int main(int argc, char** argv) {
  lambent::prepareStreams();
  lambent::endOnRequest();
  try {
    lambent::chooseShaders();
    if (const auto options = lambent::readOptions(argc, argv)) lambent::App(*options).run();
    return 0;
  } catch (const lambent::InputError& e) {
    std::cerr << "error: " << e.what() << "\n";
    return 2;
  } catch (const lambent::CheckFailure&) {
    throw; // ends the program, which says what
  } catch (const std::exception& e) {
    std::cerr << "error: " << e.what() << "\n";
    return 1;
  }
}
