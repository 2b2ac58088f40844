#include "engine/core/interrupt.h"
#include "tools/lambent/commands.h"
#include "tools/launch/streams.h"

int main(int argc, char** argv) {
  using namespace lambent;
  prepareStreams();
  endOnRequest();
  const int status = runCommand(argc, argv, "lambent " LAMBENT_VERSION,
                                  {declareDoctor, declareInspect, declareRender, declareRecord, declareAccuracy,
                                   declareReference, declareCompare, declareStability, declareBench, declareSoak,
                                   declareContent, declareSettings, declareTechniques});
  endedInOrder();
  return finishStreams(status);
}
