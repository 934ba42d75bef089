#include "drivers/image/mjpeg.h"

#include <algorithm>
#include <csetjmp>
#include <cstdint>
#include <cstdio>  // jpeglib.h supposes it
#include <iterator>

#include <jerror.h>
#include <jpeglib.h>

namespace roomcal::drivers {

namespace {

// The library's vector code reads whole registers: rows begin and end at multiples of this (twice its ALIGN_SIZE).
constexpr std::size_t kAlign = 64;
// What the library means to keep: four tables of quantization, eight of Huffman codes.
constexpr std::size_t kLasting = 8192;
// Measured at widths from 64 to 8192 (4:2:0): 12 kB and 24 rows. Unusual subsampling takes up to twice the rows.
constexpr std::size_t kPerImage = 32768;
constexpr std::size_t kRows = 48;

constexpr std::size_t rounded(std::size_t size) { return (size + kAlign - 1) / kAlign * kAlign; }

// Hands out the bytes of a block one after the other, and forgets them all at once.
struct Pool {
  std::span<std::byte> block;
  std::size_t used = 0;

  void* take(std::size_t size) {
    const std::size_t whole = rounded(size);
    if (whole < size || whole > block.size() - used) return nullptr;
    void* const bytes = block.data() + used;
    used += whole;
    return bytes;
  }
};

std::span<std::byte> aligned(std::span<std::byte> memory) {
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  const std::size_t skip = (kAlign - address % kAlign) % kAlign;
  return skip < memory.size() ? memory.subspan(skip) : std::span<std::byte>();
}

}  // namespace

// The library calls back with its own pointers only; `client_data` leads to this.
struct MjpegDecoder::Library {
  jpeg_decompress_struct decoder{};
  jpeg_error_mgr errors{};
  jpeg_source_mgr source{};
  jpeg_memory_mgr own_memory{};  // as the library made it, for the end
  Pool lasting, image;
  std::jmp_buf failed{};
  Status status;
  bool open = false;

  static Library& of(j_common_ptr decoder) { return *static_cast<Library*>(decoder->client_data); }

  // The library's errors do not return: they jump back to decode(), over C frames only.
  [[noreturn]] void give_up(Status why) {
    status = why;
    std::longjmp(failed, 1);
  }

  void replace_memory();
  void replace_errors();
  void replace_source();
  void forget_tables();
  void read(std::span<const std::byte> jpeg, MutableImageView out);

  void* take(int pool, std::size_t size) {
    void* const bytes = (pool == JPOOL_PERMANENT ? lasting : image).take(size);
    if (bytes == nullptr) give_up({StatusCode::kOutOfMemory, "the JPEG image wants more memory than was set aside"});
    return bytes;
  }

  template <typename Item>
  Item** take_rows(int pool, std::size_t row_bytes, JDIMENSION rows) {
    auto** const pointers = static_cast<Item**>(take(pool, rows * sizeof(Item*)));
    for (JDIMENSION i = 0; i < rows; ++i) pointers[i] = static_cast<Item*>(take(pool, row_bytes));
    return pointers;
  }
};

void MjpegDecoder::Library::replace_memory() {
  jpeg_memory_mgr& memory = *decoder.mem;
  own_memory = memory;
  const auto take_bytes = [](j_common_ptr c, int pool, std::size_t size) { return of(c).take(pool, size); };
  memory.alloc_small = memory.alloc_large = take_bytes;
  memory.alloc_sarray = [](j_common_ptr c, int pool, JDIMENSION samples, JDIMENSION rows) -> JSAMPARRAY {
    return of(c).take_rows<JSAMPLE>(pool, samples * sizeof(JSAMPLE), rows);
  };
  memory.alloc_barray = [](j_common_ptr c, int pool, JDIMENSION blocks, JDIMENSION rows) -> JBLOCKARRAY {
    return of(c).take_rows<JBLOCK>(pool, blocks * sizeof(JBLOCK), rows);
  };
  // Whole images of coefficients are of progressive JPEG only.
  memory.request_virt_barray = [](j_common_ptr c, int, boolean, JDIMENSION, JDIMENSION,
                                  JDIMENSION) -> jvirt_barray_ptr {
    of(c).give_up({StatusCode::kUnsupported, "a progressive JPEG image; set the camera to sequential JPEG"});
  };
  memory.request_virt_sarray = [](j_common_ptr c, int, boolean, JDIMENSION, JDIMENSION,
                                  JDIMENSION) -> jvirt_sarray_ptr {
    of(c).give_up({StatusCode::kUnsupported, "a JPEG image of a kind that cameras do not send"});
  };
  memory.realize_virt_arrays = [](j_common_ptr) {};
  memory.free_pool = [](j_common_ptr c, int pool) {
    if (pool == JPOOL_IMAGE) of(c).image.used = 0;
  };
}

void MjpegDecoder::Library::replace_errors() {
  decoder.err = jpeg_std_error(&errors);
  errors.error_exit = [](j_common_ptr c) {
    of(c).give_up({StatusCode::kCorrupt, "not a JPEG image, or a damaged one"});
  };
  // Warnings are how the library says that it made something up. Only bytes between segments are harmless.
  errors.emit_message = [](j_common_ptr c, int level) {
    if (level < 0 && c->err->msg_code != JWRN_EXTRANEOUS_DATA)
      of(c).give_up({StatusCode::kCorrupt, "the JPEG image is damaged"});
  };
  errors.output_message = [](j_common_ptr) {};
}

void MjpegDecoder::Library::replace_source() {
  source.init_source = source.term_source = [](j_decompress_ptr) {};
  source.fill_input_buffer = [](j_decompress_ptr c) -> boolean {
    of(reinterpret_cast<j_common_ptr>(c)).give_up({StatusCode::kCorrupt, "the JPEG image ends early"});
  };
  source.skip_input_data = [](j_decompress_ptr c, long bytes) {
    if (bytes <= 0) return;
    if (static_cast<std::size_t>(bytes) > c->src->bytes_in_buffer) c->src->fill_input_buffer(c);
    c->src->next_input_byte += bytes;
    c->src->bytes_in_buffer -= static_cast<std::size_t>(bytes);
  };
  source.resync_to_restart = jpeg_resync_to_restart;
  decoder.src = &source;
}

// An image without tables of its own means the standard's, not those of an image before, which may have been damaged.
void MjpegDecoder::Library::forget_tables() {
  std::fill(std::begin(decoder.quant_tbl_ptrs), std::end(decoder.quant_tbl_ptrs), nullptr);
  std::fill(std::begin(decoder.dc_huff_tbl_ptrs), std::end(decoder.dc_huff_tbl_ptrs), nullptr);
  std::fill(std::begin(decoder.ac_huff_tbl_ptrs), std::end(decoder.ac_huff_tbl_ptrs), nullptr);
  lasting.used = 0;
}

void MjpegDecoder::Library::read(std::span<const std::byte> jpeg, MutableImageView out) {
  forget_tables();
  source.next_input_byte = reinterpret_cast<const JOCTET*>(jpeg.data());
  source.bytes_in_buffer = jpeg.size();
  jpeg_read_header(&decoder, TRUE);
  if (decoder.image_width != static_cast<JDIMENSION>(out.width()) ||
      decoder.image_height != static_cast<JDIMENSION>(out.height()))
    give_up({StatusCode::kInvalidArgument, "the JPEG image is of another size than the profile says"});
  decoder.out_color_space = JCS_GRAYSCALE;
  decoder.dct_method = JDCT_ISLOW;  // the same pixels on every processor
  jpeg_start_decompress(&decoder);
  while (decoder.output_scanline < decoder.output_height) {
    JSAMPROW row = out.row(static_cast<int>(decoder.output_scanline));
    jpeg_read_scanlines(&decoder, &row, 1);
  }
  jpeg_finish_decompress(&decoder);
}

const bool MjpegDecoder::kBuiltIn = true;

MjpegDecoder::MjpegDecoder() = default;

MjpegDecoder::~MjpegDecoder() {
  if (library_ == nullptr || !library_->open) return;
  *library_->decoder.mem = library_->own_memory;
  jpeg_destroy_decompress(&library_->decoder);
}

std::size_t MjpegDecoder::memory_bytes(int width_px) {
  return kAlign + kLasting + kPerImage +
         kRows * rounded(static_cast<std::size_t>(width_px < 0 ? 0 : width_px) + kAlign);
}

Status MjpegDecoder::open(std::span<std::byte> memory) {
  const std::span<std::byte> block = aligned(memory);
  if (block.size() < kLasting + kPerImage) return {StatusCode::kOutOfMemory, "too little memory for JPEG images"};
  if (library_ != nullptr) return {StatusCode::kInvalidArgument, "the JPEG decoder is open already"};
  library_ = std::make_unique<Library>();
  Library& library = *library_;
  library.lasting.block = block.first(kLasting);
  library.image.block = block.subspan(kLasting);
  library.replace_errors();
  library.decoder.client_data = &library;
  if (setjmp(library.failed) != 0) return library.status;
  jpeg_create_decompress(&library.decoder);  // keeps err and client_data
  library.replace_memory();
  library.replace_source();
  library.open = true;
  return ok_status();
}

Status MjpegDecoder::decode(std::span<const std::byte> jpeg, MutableImageView out) {
  if (library_ == nullptr || !library_->open) return {StatusCode::kUnavailable, "the JPEG decoder is not open"};
  Library& library = *library_;
  library.status = ok_status();
  if (setjmp(library.failed) == 0) library.read(jpeg, out);
  if (!library.status.ok()) jpeg_abort_decompress(&library.decoder);
  return library.status;
}

}  // namespace roomcal::drivers
