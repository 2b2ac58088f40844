#include "tools/lambent/video.h"

#include "engine/core/error.h"
#include "tools/lambent/text.h"

#include <sys/wait.h>
#include <unistd.h>

namespace lambent {

namespace fs = std::filesystem;

namespace {

constexpr int kNotInstalled = 127; // as a shell says it

/// A path as ffmpeg's image readers take it: neither an option nor a pattern of its own.
std::string forFfmpeg(const fs::path& path) {
  std::string out;
  for (char c : fs::absolute(path).string()) out += c == '%' ? std::string("%%") : std::string(1, c);
  return out;
}

} // namespace

bool encodeVideo(const fs::path& folder, int frames, double fps, const fs::path& video) {
  const fs::path temporary = fs::absolute(folder) / ".video.mp4";
  const pid_t child = fork();
  if (child == 0) {
    const std::string rate = format("%g", fps), pictures = forFfmpeg(folder) + "/%06d.png";
    execlp("ffmpeg", "ffmpeg", "-nostdin", "-y", "-loglevel", "error", "-framerate", rate.c_str(), "-i",
           pictures.c_str(), "-frames:v", std::to_string(frames).c_str(), "-pix_fmt", "yuv420p", "-vf",
           "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-crf", "18", temporary.c_str(), static_cast<char*>(nullptr));
    _exit(kNotInstalled);
  }
  int status = 0;
  const bool ended = child >= 0 && waitpid(child, &status, 0) == child && WIFEXITED(status);
  if (ended && WEXITSTATUS(status) == 0) {
    fs::rename(temporary, video);
    return true;
  }
  std::error_code ignored;
  fs::remove(temporary, ignored);
  if (ended && WEXITSTATUS(status) == kNotInstalled) return false;
  throw RunError(video.string() + ": ffmpeg failed (the frames are written)");
}

std::string videoCommand(const fs::path& folder, double fps) {
  return format("ffmpeg -framerate %g -i ", fps) + (folder / "%06d.png").string() + " -pix_fmt yuv420p " +
         (folder / "video.mp4").string();
}

} // namespace lambent
