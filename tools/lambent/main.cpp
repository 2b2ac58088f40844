#include "tools/lambent/commands.h"
#include "tools/launch/streams.h"

#include <csignal>

namespace lambent {

std::atomic<bool> interrupted{false};

} // namespace lambent

int main(int argc, char** argv) {
  using namespace lambent;
  prepareStreams();
  // The first Ctrl-C, or request to end, ends after the present frame, the second at once.
  for (int request : {SIGINT, SIGTERM})
    std::signal(request, [](int signal) {
      interrupted = true;
      std::signal(signal, SIG_DFL);
    });
  return finishStreams(runCommand(argc, argv, "lambent " LAMBENT_VERSION,
                                  {declareDoctor, declareInspect, declareRender, declareRecord, declareAccuracy,
                                   declareReference, declareCompare, declareStability, declareBench, declareSoak,
                                   declareContent, declareSettings, declareTechniques}));
}
