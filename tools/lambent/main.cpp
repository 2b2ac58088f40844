#include "engine/core/error.h"
#include "tools/lambent/commands.h"

#include <csignal>
#include <cstdio>

namespace lambent {

std::atomic<bool> interrupted{false};

namespace {

int runProgram(int argc, char** argv) {
  CLI::App app{"Lambent: global illumination for moving worlds", "lambent"};
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
  declareContent(app);
  declareSettings(app);
  declareTechniques(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    std::string text = e.what();
    for (char& c : text)
      if (c == '\n') c = ' ';
    std::fprintf(stderr, "error: command line: %s (see lambent --help)\n", text.c_str());
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
  // The first Ctrl-C ends after the present frame, the second at once.
  std::signal(SIGINT, [](int) {
    lambent::interrupted = true;
    std::signal(SIGINT, SIG_DFL);
  });
  return lambent::runProgram(argc, argv);
}
