// OpenEXR in and out: 32-bit float RGB, scan lines, ZIP.

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/image/image.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>

#include <fstream>

namespace lambent {

namespace {

constexpr const char* kChannels[3] = {"R", "G", "B"};

/// Slice of one component of the tightly packed vec3 pixels. `origin` is where pixel (0, 0) of the data window's
/// coordinate system would be, which may lie outside the array.
Imf::Slice slice(const vec3* origin, int component, int width) {
  char* base = reinterpret_cast<char*>(const_cast<vec3*>(origin)) + component * sizeof(float);
  return {Imf::FLOAT, base, sizeof(vec3), sizeof(vec3) * size_t(width)};
}

std::string channelNames(const Imf::ChannelList& channels) {
  constexpr int kMostNamed = 16;
  std::string names;
  int count = 0;
  for (auto c = channels.begin(); c != channels.end(); ++c)
    if (count++ < kMostNamed) names += (names.empty() ? "" : ", ") + std::string(c.name());
  if (count > kMostNamed) names += " and " + std::to_string(count - kMostNamed) + " more";
  return names.empty() ? "none" : names;
}

} // namespace

void writeExr(const std::filesystem::path& file, const Image& image) {
  CHECK_EQ(image.pixels.size(), size_t(image.width) * image.height);
  if (image.pixels.empty()) throw RunError(file.string() + ": cannot be written: the image has no pixels");
  writeAtomically(file, [&](const std::filesystem::path& temporary) {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frame;
    for (int c = 0; c < 3; ++c) {
      header.channels().insert(kChannels[c], Imf::Channel(Imf::FLOAT));
      frame.insert(kChannels[c], slice(image.pixels.data(), c, image.width));
    }
    std::ofstream stream(temporary, std::ios::binary);
    try {
      {
        Imf::StdOFStream to(stream, temporary.c_str());
        Imf::OutputFile out(to, header);
        out.setFrameBuffer(frame);
        out.writePixels(image.height);
      } // its destructor writes the table of lines, and reports nothing when it cannot
      stream.close();
    } catch (const std::exception& e) {
      if (stream) throw RunError(file.string() + ": cannot be written: " + e.what()); // else it names the temporary
    }
    if (!stream) throw RunError(file.string() + ": cannot be written (is the folder writable, the disk full?)");
  });
}

Image readExr(const std::filesystem::path& file, const std::string& layer, uint64_t mostTexels) {
  if (!std::filesystem::is_regular_file(file)) throw InputError(file.string(), "no such file");
  try {
    Imf::InputFile in(file.c_str());
    const Imf::ChannelList& channels = in.header().channels();
    const auto window = in.header().dataWindow();
    const int64_t width = int64_t(window.max.x) - window.min.x + 1, height = int64_t(window.max.y) - window.min.y + 1;
    checkImageSize(file, width, height, mostTexels);
    // The library unpacks all channels, also those that nobody asks for.
    constexpr uint64_t kMostValues = uint64_t(4) * 8192 * 4096; // 0.5 GB, 3 s
    uint64_t count = 0;
    for (auto c = channels.begin(); c != channels.end(); ++c) ++count;
    if (count > 4 && count > kMostValues / (uint64_t(width) * uint64_t(height)))
      throw InputError(file.string(), "has " + std::to_string(count) + " channels of " + std::to_string(width) + "x" +
                                          std::to_string(height) + " values, which are too many to unpack");
    // More than the file can hold, compressed as far as DEFLATE goes, is not there; of that there is no need to ask for
    // memory.
    constexpr uint64_t kAlways = 64 << 20, kDeflate = 1032;
    uint64_t ofTexel = 0; // bytes
    for (auto c = channels.begin(); c != channels.end(); ++c) ofTexel += c.channel().type == Imf::HALF ? 2 : 4;
    if (uint64_t(width) * uint64_t(height) * ofTexel > kAlways + kDeflate * std::filesystem::file_size(file))
      throw InputError(file.string(), "ends before the last of its " + std::to_string(height) + " rows");
    Image image{int(width), int(height)};
    // Arithmetic on addresses as integers: the origin of a shifted data window is not inside the array.
    const auto origin =
        reinterpret_cast<const vec3*>(reinterpret_cast<intptr_t>(image.pixels.data()) -
                                      (window.min.y * intptr_t(width) + window.min.x) * intptr_t(sizeof(vec3)));
    Imf::FrameBuffer frame;
    for (int c = 0; c < 3; ++c) {
      const std::string name = layer.empty() ? kChannels[c] : layer + "." + kChannels[c];
      const Imf::Channel* channel = channels.findChannel(name);
      if (!channel)
        throw InputError(file.string(), "has no channel " + name + " (it has: " + channelNames(channels) + ")");
      if (channel->xSampling != 1 || channel->ySampling != 1)
        throw InputError(file.string(), "channel " + name + " is stored at reduced resolution (full expected)");
      frame.insert(name, slice(origin, c, image.width));
    }
    in.setFrameBuffer(frame);
    in.readPixels(window.min.y, window.max.y);
    return image;
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(file.string(), std::string("cannot be read as OpenEXR: ") + e.what());
  }
}

} // namespace lambent
