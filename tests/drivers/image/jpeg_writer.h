#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <jpeglib.h>

#include "runtime/base/span2d.h"

namespace roomcal::drivers::test {

struct JpegOptions {
  int quality = 90;
  bool colour = true;              ///< YCbCr with a tint, else grey
  int chroma_x = 2, chroma_y = 2;  ///< luminance samples a chrominance sample; 2 x 2 is 4:2:0
  bool progressive = false;
  int restart_rows = 0;
};

/// What a camera would send of an image, by libjpeg's own compressor.
inline std::vector<std::byte> write_jpeg(ImageView grey, const JpegOptions& options = {}) {
  jpeg_compress_struct encoder{};
  jpeg_error_mgr errors{};
  encoder.err = jpeg_std_error(&errors);
  jpeg_create_compress(&encoder);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&encoder, &bytes, &size);
  encoder.image_width = static_cast<JDIMENSION>(grey.width());
  encoder.image_height = static_cast<JDIMENSION>(grey.height());
  encoder.input_components = options.colour ? 3 : 1;
  encoder.in_color_space = options.colour ? JCS_YCbCr : JCS_GRAYSCALE;
  jpeg_set_defaults(&encoder);
  encoder.comp_info[0].h_samp_factor = options.colour ? options.chroma_x : 1;
  encoder.comp_info[0].v_samp_factor = options.colour ? options.chroma_y : 1;
  jpeg_set_quality(&encoder, options.quality, TRUE);
  encoder.restart_in_rows = options.restart_rows;
  if (options.progressive) jpeg_simple_progression(&encoder);
  jpeg_start_compress(&encoder, TRUE);
  std::vector<JSAMPLE> row(static_cast<std::size_t>(grey.width() * encoder.input_components), 140);
  for (int y = 0; y < grey.height(); ++y) {
    for (int x = 0; x < grey.width(); ++x) row[static_cast<std::size_t>(x * encoder.input_components)] = grey(x, y);
    JSAMPROW line = row.data();
    jpeg_write_scanlines(&encoder, &line, 1);
  }
  jpeg_finish_compress(&encoder);
  jpeg_destroy_compress(&encoder);
  std::vector<std::byte> jpeg(size);
  std::memcpy(jpeg.data(), bytes, size);
  std::free(bytes);
  return jpeg;
}

/// The same image without its DHT segments.
inline std::vector<std::byte> without_huffman_tables(const std::vector<std::byte>& jpeg) {
  std::vector<std::byte> out(jpeg.begin(), jpeg.begin() + 2);
  for (std::size_t at = 2; at + 4 <= jpeg.size();) {
    const auto marker = std::to_integer<int>(jpeg[at + 1]);
    const std::size_t length =
        2 + (std::to_integer<std::size_t>(jpeg[at + 2]) << 8 | std::to_integer<std::size_t>(jpeg[at + 3]));
    constexpr int kHuffman = 0xC4, kScan = 0xDA;
    const std::size_t end = marker == kScan ? jpeg.size() : at + length;
    if (marker != kHuffman)
      out.insert(out.end(), jpeg.begin() + static_cast<std::ptrdiff_t>(at),
                 jpeg.begin() + static_cast<std::ptrdiff_t>(end));
    at = end;
  }
  return out;
}

}  // namespace roomcal::drivers::test
