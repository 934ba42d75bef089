#include "drivers/aravis/aravis_camera.h"

#include <algorithm>
#include <string>
#include <utility>

#include <pthread.h>
#include <sched.h>

#include "drivers/aravis/buffer_image.h"
#include "drivers/aravis/settings.h"
#include "drivers/aravis/stream_socket.h"
#include "drivers/gige/control_probe.h"
#include "drivers/gige/gvcp.h"
#include "drivers/gige/ipv4.h"
#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

constexpr int64_t kPtpEveryNs = 2'000'000'000;
constexpr int64_t kBurialWaitNs = 10'000'000'000;
constexpr std::size_t kPage = 4096;
constexpr int kStreamPriority = 10;

// Packets wait in a socket for this thread only. Without the right to it, it stays an ordinary one.
void raise_priority() {
  sched_param parameters{};
  parameters.sched_priority = kStreamPriority;
  ::pthread_setschedparam(::pthread_self(), SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters);
}

// In Aravis' stream thread.
void on_stream(void* shared, ArvStreamCallbackType type, ArvBuffer*) {
  auto& ours = *static_cast<AravisShared*>(shared);
  if (type == ARV_STREAM_CALLBACK_TYPE_INIT) {
    ours.stream_runs(true);
    raise_priority();
  }
  if (type == ARV_STREAM_CALLBACK_TYPE_EXIT) ours.stream_runs(false);
  if (type == ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE) ours.wake();
}

// In Aravis' heartbeat thread, or libusb's.
void on_control_lost(ArvDevice*, void* shared) { static_cast<AravisShared*>(shared)->lose_control(); }

// Aravis has no code for what libusb says.
ImageFault fault_of_opening(std::string_view message) {
  const auto says = [&](const char* word) { return message.find(word) != std::string_view::npos; };
  if (says("LIBUSB_ERROR_ACCESS")) return ImageFault::kDenied;
  if (says("LIBUSB_ERROR_BUSY")) return ImageFault::kBusy;
  if (says("LIBUSB_ERROR_NO_MEM")) return ImageFault::kNoMemory;
  if (says("LIBUSB_ERROR_NO_DEVICE") || says("not found") || says("timeout")) return ImageFault::kGone;
  return ImageFault::kStale;
}

}  // namespace

AravisCamera::AravisCamera(std::string_view name, const AravisOptions& options, const ports::SystemClocks& clocks,
                           ports::Log& log, std::shared_ptr<std::atomic<PtpState>> ptp)
    : options_(options),
      clocks_(clocks),
      log_(name, log),
      ptp_(std::move(ptp)),
      format_(pfnc_format(options.pixel_format.view())) {}

AravisCamera::~AravisCamera() {
  close();
  // A program that ends while Aravis still talks would take its static memory from under it.
  static_cast<void>(burial_.wait(kBurialWaitNs));
}

void AravisCamera::note(std::string_view what, std::string_view why) {
  FixedText<200> line(what);
  line.append(": ");
  line.append(why);
  log_.note_once(line.view());
}

std::size_t AravisCamera::buffer_bytes(const AravisOptions& options) {
  const PfncFormat* format = pfnc_format(options.pixel_format.view());
  if (format == nullptr || options.width_px <= 0 || options.height_px <= 0) return 0;
  const std::size_t image = static_cast<std::size_t>(options.width_px) * static_cast<std::size_t>(options.height_px) *
                            static_cast<std::size_t>(format->bytes_per_px);
  return (image + kPage - 1) / kPage * kPage * static_cast<std::size_t>(std::max(options.buffers, 0));
}

std::size_t AravisCamera::slot_bytes() const {
  return buffer_bytes(options_) / static_cast<std::size_t>(options_.buffers);
}

Status AravisCamera::reserve() {
  const auto none = [](const char* detail) { return Status{StatusCode::kUnsupported, detail}; };
  constexpr int kMostPixels = 16384;
  if (options_.key.empty()) return none("the profile names no serial number or id of the camera");
  if (format_ == nullptr) return none("no such pixel format; use Mono8, Mono10, Mono12, Mono16, Bayer..8, YUV422_8");
  if (options_.buffers < 3 || options_.buffers > kMaxLibraryBuffers) return none("a camera needs 3 to 16 buffers");
  if (options_.width_px < 2 || options_.height_px < 2 || options_.width_px > kMostPixels ||
      options_.height_px > kMostPixels)
    return none("the profile's image size is none that a camera has");
  memory_ = std::make_shared<LockedMemory>();
  return memory_->reserve(buffer_bytes(options_));
}

Result<FoundCamera> AravisCamera::find() {
  FixedText<200> seen;
  Result<FoundCamera> found = find_camera(options_.key.view(), seen);
  if (found.ok()) return found;
  FixedText<120> line("looking for ");
  line.append(options_.key.view());
  line.append("; cameras there");
  note(line.view(), seen.view());
  return found;
}

LibraryResult AravisCamera::open(Wake& wake) {
  // Aravis 0.8.26 may hang in a dead USB camera's stream, which then may still write into the buffers.
  if (last_ && last_->stream_runs())
    return {ImageFault::kGone, StatusCode::kUnavailable, "Aravis still holds the camera that was lost"};
  const Result<FoundCamera> found = find();
  if (!found.ok()) return {ImageFault::kNotFound, found.status().code(), found.status().detail()};
  LibraryResult result = connect(found.value());
  if (result.ok()) result = configure();
  if (result.ok()) result = stream(wake);
  if (!result.ok()) give_up(answers_);
  return result;
}

LibraryResult AravisCamera::connect(const FoundCamera& found) {
  answers_ = false;
  address_ = ipv4_endpoint(found.address.view(), gvcp::kPort);
  if (!found.listed && probe_control(*address_, clocks_) == ControlState::kAbsent)
    return LibraryResult(ImageFault::kNotFound);
  connection_.shared = last_ = std::make_shared<AravisShared>(memory_);
  GErrorSlot error;
  GObjectPtr<ArvDevice> device(arv_open_device(std::string(found.id.view()).c_str(), error.out()));
  if (!device) {
    note("cannot be opened", error.message());
    return LibraryResult(fault_of_opening(error.message()));
  }
  const bool gige = ARV_IS_GV_DEVICE(device.get());
  if (!gige) address_.reset();
  if (gige && arv_gv_device_is_controller(ARV_GV_DEVICE(device.get())) == FALSE) {
    connection_.camera.reset(arv_camera_new_with_device(device.get(), nullptr));
    return LibraryResult(ImageFault::kBusy);
  }
  connection_.camera.reset(arv_camera_new_with_device(device.get(), error.out()));
  if (!connection_.camera) {
    note("cannot be read", error.message());
    return LibraryResult(ImageFault::kStale);
  }
  answers_ = true;
  g_signal_connect(device.get(), "control-lost", G_CALLBACK(on_control_lost), connection_.shared.get());
  features_.attach(arv_camera_get_device(connection_.camera.get()));
  return {};
}

LibraryResult AravisCamera::configure() {
  ArvCamera* camera = connection_.camera.get();
  // Whoever had it before may have died with the stream running.
  arv_camera_stop_acquisition(camera, nullptr);
  const LibraryResult set = apply_settings(options_, features_, log_);
  if (!set.ok()) return set;
  if (arv_camera_is_gv_device(camera) != FALSE) network_options();
  const guint payload = arv_camera_get_payload(camera, nullptr);
  if (payload == 0 || payload > slot_bytes())
    return {ImageFault::kFormat, StatusCode::kUnsupported,
            "the camera's images are larger than size and format say; switch its extra data off"};
  read_clock();
  return {};
}

void AravisCamera::network_options() {
  ArvCamera* camera = connection_.camera.get();
  GErrorSlot error;
  // On loopback the packet socket sees nothing (Aravis 0.8.26, as root).
  const bool loopback = address_ && (ntohl(address_->sin_addr.s_addr) >> 24U) == 127;
  if (loopback || options_.no_packet_socket)
    arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  if (options_.packet_size_bytes > 0) {
    arv_camera_gv_set_packet_size(camera, options_.packet_size_bytes, error.out());
    if (error.failed()) note("packet size refused", error.message());
  }
  if (options_.packet_delay_ns >= 0) {
    arv_camera_gv_set_packet_delay(camera, options_.packet_delay_ns, error.out());
    if (error.failed()) note("packet delay refused", error.message());
  }
}

void AravisCamera::read_clock() {
  ArvDevice* device = arv_camera_get_device(connection_.camera.get());
  stamping_.ticks_known =
      !ARV_IS_GV_DEVICE(device) || arv_gv_device_get_timestamp_tick_frequency(ARV_GV_DEVICE(device), nullptr) != 0;
  stamping_.point = options_.stamp_point;
  stamping_.exposure_ns = exposure_ns(features_, 20'000'000);
  stamping_.ptp = read_ptp(features_);
  *ptp_ = stamping_.ptp;
  ptp_read_ns_ = clocks_.now_ns();
}

LibraryResult AravisCamera::stream(Wake& wake) {
  GErrorSlot error;
  AravisShared* shared = connection_.shared.get();
  ArvCamera* camera = connection_.camera.get();
  connection_.stream.reset(arv_camera_create_stream(camera, on_stream, shared, error.out()));
  if (!connection_.stream) {
    note("cannot stream", error.message());
    return LibraryResult(ImageFault::kStale);
  }
  if (ARV_IS_GV_STREAM(connection_.stream.get())) widen_socket();
  for (int i = 0; i < options_.buffers; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    buffers_[slot] =
        arv_buffer_new_full(slot_bytes(), shared->buffers().data() + slot * slot_bytes(), GINT_TO_POINTER(i), nullptr);
    arv_stream_push_buffer(connection_.stream.get(), buffers_[slot]);
  }
  numbers_.restart();
  torn_ = torn_told_ = false;
  shared->listen(&wake);
  arv_camera_start_acquisition(camera, error.out());
  if (!error.failed()) return {};
  note("cannot start", error.message());
  return LibraryResult(ImageFault::kStale);
}

LibraryResult AravisCamera::restart() {
  GErrorSlot error;
  arv_camera_stop_acquisition(connection_.camera.get(), nullptr);
  arv_camera_start_acquisition(connection_.camera.get(), error.out());
  numbers_.restart();
  if (!error.failed()) return {};
  return LibraryResult(ImageFault::kStale);
}

void AravisCamera::close() { give_up(answers_); }

// Of a camera that does not answer nothing is wanted any more, not even what it was set to before.
void AravisCamera::give_up(bool answers) {
  if (!connection_.camera) return;
  connection_.shared->listen(nullptr);
  if (answers) {
    GErrorSlot error;
    arv_camera_stop_acquisition(connection_.camera.get(), error.out());
    answers = !error.failed();
  }
  if (answers) {
    const std::size_t changes = features_.changes();
    if (features_.restore() < changes) log_.note_once("not all of its old settings could be restored");
  }
  features_.let_go();
  buffers_.fill(nullptr);
  answers_ = false;
  if (!answers) return burial_.bury(std::exchange(connection_, {}));
  // In this order; stopping the stream's thread first by hand makes 0.8.26 complain when it is dropped.
  connection_.stream.reset();
  connection_.camera.reset();
  connection_.shared.reset();
}

void AravisCamera::give_back(int slot) {
  arv_stream_push_buffer(connection_.stream.get(), buffers_[static_cast<std::size_t>(slot)]);
}

bool AravisCamera::poll(LibraryImage& image) {
  ArvStream* stream = connection_.stream.get();
  ArvBuffer* buffer = arv_stream_try_pop_buffer(stream);
  for (; buffer != nullptr && is_unused(arv_buffer_get_status(buffer)); buffer = arv_stream_try_pop_buffer(stream))
    arv_stream_push_buffer(stream, buffer);
  if (buffer == nullptr) return false;
  image = image_of(buffer, *format_, options_.width_px, options_.height_px);
  torn_ = torn_ || image.fault == ImageFault::kShort;
  if (image.fault != ImageFault::kCount) return true;
  image.number = numbers_.next(arv_buffer_get_frame_id(buffer));
  const AravisStamps stamps{static_cast<int64_t>(arv_buffer_get_timestamp(buffer)),
                            static_cast<int64_t>(arv_buffer_get_system_timestamp(buffer))};
  const ImageStamp stamp = stamp_of(stamps, stamping_, clocks_);
  image.exposed = stamp.exposed;
  image.uncertainty_ns = stamp.uncertainty_ns;
  image.arrived_ns = stamp.arrived_ns;
  image.latency_ns = stamping_.exposure_ns + kReadoutNs;
  return true;
}

ImageFault AravisCamera::diagnose() {
  ControlState state = ControlState::kControlled;
  if (address_)
    state = probe_control(*address_, clocks_);
  else if (connection_.shared->control_lost())
    state = ControlState::kAbsent;
  answers_ = state == ControlState::kControlled;
  if (state == ControlState::kAbsent) return ImageFault::kGone;
  return state == ControlState::kFree ? ImageFault::kStale : ImageFault::kStall;
}

ImageFault AravisCamera::look_after(int64_t now_ns) {
  // Images that come tell more than the heartbeat, which is late and may be disturbed by others (Aravis #871).
  if (connection_.shared->control_lost() || !free_running())
    if (const ImageFault fault = diagnose(); fault != ImageFault::kStall) return fault;
  if (torn_ && !std::exchange(torn_told_, true)) note_small_socket();
  if (now_ns - ptp_read_ns_ >= kPtpEveryNs && stamping_.ptp != PtpState::kNone) {
    ptp_read_ns_ = now_ns;
    *ptp_ = stamping_.ptp = read_ptp(features_);
  }
  return ImageFault::kCount;
}

// A packet of 1.4 kB takes 2.3 kB of the buffer; one image is to wait while another is read.
void AravisCamera::widen_socket() {
  ArvGvStream* stream = ARV_GV_STREAM(connection_.stream.get());
  g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", 0, nullptr);
  socket_bytes_ = widen_receive_buffer(arv_gv_stream_get_port(stream), 2 * slot_bytes());
  if (socket_bytes_ == 0)  // a later Aravis: let it do as it can
    g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_AUTO, nullptr);
}

void AravisCamera::note_small_socket() {
  if (socket_bytes_ == 0 || socket_bytes_ >= 2 * slot_bytes()) return;
  std::array<char, 160> line;
  TextWriter out(line);
  out.text("torn images: raise net.core.rmem_max from ").unsigned_integer(socket_bytes_);
  out.text(" to ").unsigned_integer(2 * slot_bytes()).text(", or grant CAP_NET_ADMIN");
  log_.note_once(out.view());
}

bool AravisCamera::fire() {
  if (options_.trigger != AravisTrigger::kSoftware) return false;
  GErrorSlot error;
  arv_camera_software_trigger(connection_.camera.get(), error.out());
  return !error.failed();
}

}  // namespace roomcal::drivers
