#include "tools/launch/streams.h"

#include <csignal>
#include <cstdio>
#include <iostream>

#include <fcntl.h>
#include <poll.h>

namespace lambent {

void prepareStreams() {
  for (int stream : {0, 1, 2})
    if (fcntl(stream, F_GETFD) == -1) // takes the lowest number that is free; what is written there fails
      if (open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY) == -1) return;
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int finishStreams(int status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return status;
  pollfd out{1, 0, 0};
  if (poll(&out, 1, 0) >= 0 && (out.revents & POLLERR)) return status; // a pipe that nobody reads any more
  std::fprintf(stderr, "error: standard output: cannot be written (is it closed, the disk full?)\n");
  return status == 0 ? 1 : status;
}

} // namespace lambent
