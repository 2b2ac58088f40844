// By libjpeg-turbo, and not by stb_image, which decodes by tables that a file never gave: memory of whatever was there
// before.
#include "engine/scene/jpeg.h"

#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>

#include <jerror.h>

namespace lambent {

namespace {

/// What the library's callbacks find: its first member, as they know it.
struct Reading {
  jpeg_error_mgr manager;
  std::jmp_buf out;
  char defect[JMSG_LENGTH_MAX] = "";
};

[[noreturn]] void fail(j_common_ptr info) {
  Reading& reading = *reinterpret_cast<Reading*>(info->err);
  info->err->format_message(info, reading.defect);
  std::longjmp(reading.out, 1); // NOLINT: its only way
}

/// `level` −1: the library goes on with something of its own.
void onMessage(j_common_ptr info, int level) {
  switch (info->err->msg_code) {
  case JWRN_ADOBE_XFORM:
  case JWRN_JFIF_MAJOR:
  case JWRN_EXTRANEOUS_DATA:
  case JWRN_TOO_MUCH_DATA:
    return; // the picture is whole
  default:
    if (level < 0) fail(info);
  }
}

/// Inks as Adobe's programs write them, inverted.
void rgbFromCmyk(uint8_t* cmyk, int count) {
  for (uint8_t* t = cmyk; t < cmyk + 4 * ptrdiff_t(count); t += 4) {
    for (int c = 0; c < 3; ++c) t[c] = uint8_t((t[c] * t[3] + 127) / 255);
    t[3] = 255;
  }
}

/// Up to the header where `texels` is null. Objects with destructors have no place here: the library leaves by longjmp.
bool read(const uint8_t* bytes, size_t size, int& width, int& height, uint8_t* texels, Reading& reading) {
  jpeg_decompress_struct info{};
  info.err = jpeg_std_error(&reading.manager);
  reading.manager.error_exit = fail;
  reading.manager.emit_message = onMessage;
  if (setjmp(reading.out)) { // NOLINT
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes, static_cast<unsigned long>(size));
  jpeg_read_header(&info, TRUE);
  if (!texels) {
    width = int(info.image_width), height = int(info.image_height);
  } else {
    if (int(info.image_width) != width || int(info.image_height) != height) ERREXIT(&info, JERR_WIDTH_OVERFLOW);
    const bool cmyk = info.jpeg_color_space == JCS_CMYK || info.jpeg_color_space == JCS_YCCK;
    info.out_color_space = cmyk ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg_start_decompress(&info);
    while (info.output_scanline < info.output_height) {
      JSAMPROW row = texels + 4 * size_t(width) * info.output_scanline;
      jpeg_read_scanlines(&info, &row, 1);
      if (cmyk) rgbFromCmyk(row, width);
    }
  }
  jpeg_destroy_decompress(&info);
  return true;
}

} // namespace

bool sizeOfJpeg(const uint8_t* bytes, size_t size, int& width, int& height, std::string& defect) {
  Reading reading;
  const bool whole = read(bytes, size, width, height, nullptr, reading);
  defect = reading.defect;
  return whole;
}

bool readJpeg(const uint8_t* bytes, size_t size, int width, int height, uint8_t* texels, std::string& defect) {
  Reading reading;
  const bool whole = read(bytes, size, width, height, texels, reading);
  defect = reading.defect;
  return whole;
}

} // namespace lambent
