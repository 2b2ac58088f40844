#include "engine/core/error.h"
#include "tools/lambent/command_line.h"
#include "tools/lambent/commands.h"
#include "tools/launch/streams.h"

#include <csignal>
#include <cstdio>

namespace lambent {

std::atomic<bool> interrupted{false};

namespace {

int runProgram(int argc, char** argv) {
  CLI::App app{"Lambent: global illumination for moving worlds", "lambent"};
  app.formatter(helpFormatter());
  app.set_version_flag("--version", "lambent " LAMBENT_VERSION, "name and version, and nothing else");
  app.require_subcommand(1);
  declareDoctor(app);
  declareInspect(app);
  declareRender(app);
  declareRecord(app);
  declareAccuracy(app);
  declareReference(app);
  declareCompare(app);
  declareStability(app);
  declareBench(app);
  declareSoak(app);
  declareContent(app);
  declareSettings(app);
  declareTechniques(app);
  for (CLI::App* command : app.get_subcommands({})) refuseNotANumber(*command);
  try {
    checkCommand(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::Success& e) { // help, version
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    std::fprintf(stderr, "error: %s\n", textOf(e, app).c_str());
    return 2;
  } catch (const InputError& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "error: %s\n", e.what());
    return 1;
  }
  return 0;
}

} // namespace
} // namespace lambent

int main(int argc, char** argv) {
  lambent::prepareStreams();
  // The first Ctrl-C, or request to end, ends after the present frame, the second at once.
  for (int request : {SIGINT, SIGTERM})
    std::signal(request, [](int signal) {
      lambent::interrupted = true;
      std::signal(signal, SIG_DFL);
    });
  return lambent::finishStreams(lambent::runProgram(argc, argv));
}
