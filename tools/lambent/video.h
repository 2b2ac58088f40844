// Numbered pictures made into a film by ffmpeg, which need not be there.
#pragma once

#include <filesystem>
#include <string>

namespace lambent {

/// Writes `video` from the first `frames` pictures (000000.png, …) of the folder: an earlier, longer recording may have
/// left more. False where ffmpeg is not installed. Runs it without a shell. Throws RunError where it fails.
bool encodeVideo(const std::filesystem::path& folder, int frames, double fps, const std::filesystem::path& video);

/// What a person does about it who has ffmpeg, in one line.
std::string videoCommand(const std::filesystem::path& folder, double fps);

} // namespace lambent
