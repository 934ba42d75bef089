#include "drivers/libcamera/libcamera_camera.h"

#include <algorithm>
#include <cerrno>
#include <string>
#include <utility>

#include "drivers/libcamera/camera_id.h"
#include "drivers/libcamera/capture_controls.h"
#include "drivers/libcamera/fourcc_layout.h"
#include "drivers/libcamera/request_verdict.h"
#include "drivers/libcamera/sensor_stamp.h"
#include "drivers/libcamera/shared_manager.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

constexpr int64_t kUsNs = 1'000;

ImageFault fault_of(int error) {
  switch (-error) {
    case EBUSY:
      return ImageFault::kBusy;
    case EACCES:
    case EPERM:
      return ImageFault::kDenied;
    case ENODEV:
    case ENXIO:
      return ImageFault::kGone;
    case ENOMEM:
    case ENOBUFS:
      return ImageFault::kNoMemory;
    case ENOSPC:
      return ImageFault::kNoBandwidth;
    default:
      return ImageFault::kStale;
  }
}

std::vector<std::string> ids_of(const std::vector<std::shared_ptr<libcamera::Camera>>& cameras) {
  std::vector<std::string> ids;
  for (const auto& camera : cameras) ids.push_back(camera->id());
  return ids;
}

int64_t asked_period_us(const LibcameraOptions& options) {
  return options.frame_rate_hz > 0 ? static_cast<int64_t>(1e6 / options.frame_rate_hz) : 0;
}

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all.empty() ? "none" : all;
}

}  // namespace

LibcameraCamera::LibcameraCamera(std::string_view name, const LibcameraOptions& options,
                                 const ports::SystemClocks& clocks, ports::Log& log)
    : options_(options), clocks_(clocks), log_(name, log), completions_(clocks) {}

void LibcameraCamera::note(std::string_view what, std::string_view why) {
  FixedText<200> line(what);
  line.append(": ");
  line.append(why);
  log_.note_once(line.view());
}

Status LibcameraCamera::reserve() {
  const auto none = [](const char* detail) { return Status{StatusCode::kUnsupported, detail}; };
  constexpr int kMostPixels = 16384;
  if (options_.key.empty()) return none("the profile names no id of the camera");
  if (options_.formats.empty()) return none("the profile names no pixel format for the camera");
  if (options_.buffers < 3 || options_.buffers > kMaxLibraryBuffers) return none("a camera needs 3 to 16 buffers");
  if (options_.width_px < 2 || options_.height_px < 2 || options_.width_px > kMostPixels ||
      options_.height_px > kMostPixels)
    return none("the profile's image size is none that a camera has");
  if (options_.sync != LibcameraSync::kNone && !can_synchronize())
    return none("this libcamera cannot synchronize cameras; it takes Raspberry Pi's, 0.5.2 or later");
  return ok_status();
}

LibraryResult LibcameraCamera::open(Wake& wake) {
  completions_.begin(wake);
  LibraryResult result = acquire();
  if (result.ok()) result = configure();
  if (result.ok()) result = allocate();
  if (result.ok()) result = run();
  if (!result.ok()) close();
  return result;
}

LibraryResult LibcameraCamera::acquire() {
  // Kept between attempts: it follows what is plugged in.
  if (!manager_) manager_ = shared_manager();
  if (!manager_)
    return {ImageFault::kStale, StatusCode::kUnavailable, "libcamera does not start; check rights to /dev/media*"};
  const std::vector<std::shared_ptr<libcamera::Camera>> cameras = manager_->cameras();
  const std::vector<std::string> ids = ids_of(cameras);
  const Result<std::size_t> found = find_camera_id(ids, options_.key.view());
  if (!found.ok()) {
    note("cameras there", joined(ids));
    return {ImageFault::kNotFound, found.status().code(), found.status().detail()};
  }
  const std::shared_ptr<libcamera::Camera>& camera = cameras[found.value()];
  if (const int error = camera->acquire(); error != 0) return LibraryResult(fault_of(error));
  camera_ = camera;
  camera_->requestCompleted.connect(&completions_, &Completions::request_completed);
  camera_->disconnected.connect(&completions_, &Completions::camera_disconnected);
  return {};
}

// Takes the output if it delivers that format.
bool LibcameraCamera::offers(libcamera::StreamRole role, PixelFormat wanted, std::string& seen) {
  configuration_ = camera_->generateConfiguration({role});
  if (!configuration_ || configuration_->empty()) return false;
  libcamera::StreamConfiguration& stream = configuration_->at(0);
  std::vector<libcamera::PixelFormat> formats = stream.formats().pixelformats();
  if (formats.empty()) formats.push_back(stream.pixelFormat);  // some pipelines name the one they would take only
  for (const libcamera::PixelFormat& format : formats) {
    if (layout_of(format.fourcc(), format.modifier()) == wanted) {
      stream.pixelFormat = format;
      layout_ = wanted;
      return true;
    }
    const std::string name = format.toString();
    if (seen.find(name) == std::string::npos) seen += (seen.empty() ? "" : ", ") + name;
  }
  return false;
}

bool LibcameraCamera::choose_output() {
  using Role = libcamera::StreamRole;
  std::string seen;
  for (const PixelFormat wanted : options_.formats) {
    const bool processed =
        wanted == PixelFormat::kPlanarLuma || wanted == PixelFormat::kYuyv || wanted == PixelFormat::kUyvy;
    for (const Role role : {processed ? Role::Viewfinder : Role::Raw, processed ? Role::Raw : Role::Viewfinder})
      if (offers(role, wanted, seen)) return true;
  }
  note("formats offered", seen.empty() ? "none" : seen);
  return false;
}

LibraryResult LibcameraCamera::configure() {
  if (!choose_output()) return LibraryResult(ImageFault::kFormat);
  libcamera::StreamConfiguration& stream = configuration_->at(0);
  const libcamera::PixelFormat format = stream.pixelFormat;
  const libcamera::Size size(static_cast<unsigned int>(options_.width_px),
                             static_cast<unsigned int>(options_.height_px));
  stream.size = size;
  stream.bufferCount = static_cast<unsigned int>(options_.buffers);
  const bool valid = configuration_->validate() != libcamera::CameraConfiguration::Invalid;
  if (!valid || stream.size != size || stream.pixelFormat != format) {
    note("the camera would rather deliver", stream.toString());
    return LibraryResult(ImageFault::kFormat);
  }
  const int error = camera_->configure(configuration_.get());
  return error == 0 ? LibraryResult() : LibraryResult(fault_of(error));
}

LibraryResult LibcameraCamera::allocate() {
  libcamera::Stream* stream = configuration_->at(0).stream();
  allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
  if (allocator_->allocate(stream) < 0) return LibraryResult(ImageFault::kNoMemory);
  const auto& buffers = allocator_->buffers(stream);
  for (std::size_t slot = 0; slot < std::min<std::size_t>(buffers.size(), kMaxLibraryBuffers); ++slot) {
    std::unique_ptr<libcamera::Request> request = camera_->createRequest(slot);
    if (!request || request->addBuffer(stream, buffers[slot].get()) != 0) return LibraryResult(ImageFault::kStale);
    if (!maps_[slot].map(*buffers[slot])) return LibraryResult(ImageFault::kNoMemory);
    requests_.push_back(std::move(request));
  }
  controls_ = capture_controls(options_, camera_->controls(), log_);
  return {};
}

// Some pipelines heed controls at the start, others (UVC) only those of requests: both get them.
LibraryResult LibcameraCamera::run() {
  if (const int error = camera_->start(&controls_); error != 0) return LibraryResult(fault_of(error));
  running_ = true;
  cancel_told_ = false;
  for (std::size_t slot = 0; slot < requests_.size(); ++slot) queue(slot, slot == 0 ? &controls_ : nullptr);
  return {};
}

void LibcameraCamera::queue(std::size_t slot, const libcamera::ControlList* controls) {
  libcamera::Request& request = *requests_[slot];
  if (request.status() != libcamera::Request::RequestPending) request.reuse(libcamera::Request::ReuseBuffers);
  if (controls != nullptr) request.controls().merge(*controls);
  // What cannot be queued is missed as an image: the watchdog's business.
  static_cast<void>(camera_->queueRequest(&request));
}

void LibcameraCamera::stop() {
  if (!std::exchange(running_, false)) return;
  camera_->stop();  // hands all requests back as cancelled
  completions_.clear();
}

LibraryResult LibcameraCamera::restart() {
  stop();
  return run();
}

void LibcameraCamera::close() {
  if (camera_) {
    stop();
    camera_->requestCompleted.disconnect(&completions_);
    camera_->disconnected.disconnect(&completions_);
  }
  completions_.end();
  requests_.clear();
  for (MappedLuma& map : maps_) map.unmap();
  allocator_.reset();
  configuration_.reset();
  if (camera_) camera_->release();
  camera_.reset();
}

void LibcameraCamera::give_back(int slot) {
  const auto index = static_cast<std::size_t>(slot);
  maps_[index].end_read();
  queue(index, nullptr);
}

bool LibcameraCamera::poll(LibraryImage& image) {
  for (Completion completion; completions_.take(completion);) {
    const libcamera::Request& request = *completion.request;
    const auto slot = static_cast<std::size_t>(request.cookie());
    const libcamera::FrameBuffer& buffer = *request.buffers().begin()->second;
    image = {};
    image.slot = static_cast<int>(slot);
    switch (verdict_of(request.status(), buffer.metadata().status)) {
      case RequestVerdict::kWhole:
        fill(completion, image);
        return true;
      case RequestVerdict::kDamaged:
        image.fault = ImageFault::kMarkedDamaged;
        return true;
      case RequestVerdict::kSkip:
        queue(slot, nullptr);
        break;
      case RequestVerdict::kCancelled:
        // All requests come back like that at once, and stay here for the restart; one is enough to ask for it.
        if (std::exchange(cancel_told_, true)) break;
        image.fault = ImageFault::kEndOfStream;
        return true;
    }
  }
  return false;
}

void LibcameraCamera::fill(const Completion& completion, LibraryImage& image) {
  namespace controls = libcamera::controls;
  const libcamera::Request& request = *completion.request;
  const libcamera::FrameMetadata& frame = request.buffers().begin()->second->metadata();
  const libcamera::ControlList& metadata = completion.request->metadata();
  MappedLuma& map = maps_[static_cast<std::size_t>(image.slot)];
  map.begin_read();
  const std::size_t filled = frame.planes().empty() ? 0 : frame.planes()[0].bytesused;
  image.raw = {layout_, options_.width_px, options_.height_px, configuration_->at(0).stride,
               map.bytes().first(std::min(filled, map.bytes().size()))};
  image.number = frame.sequence;
  image.arrived_ns = completion.arrived_ns;
  const SensorTimes times{
      metadata.get(controls::SensorTimestamp).value_or(static_cast<int64_t>(frame.timestamp)),
      metadata.get(controls::ExposureTime).value_or(options_.exposure_us) * kUsNs,
      metadata.get(controls::FrameDuration).value_or(asked_period_us(options_)) * kUsNs,
  };
  const SensorStamp stamp = sensor_stamp(times, clocks_);
  image.exposed = stamp.exposed;
  image.uncertainty_ns = stamp.uncertainty_ns;
  if (options_.sync != LibcameraSync::kNone && in_step(metadata)) log_.note_once("in step with the other cameras");
}

ImageFault LibcameraCamera::diagnose() { return completions_.disconnected() ? ImageFault::kGone : ImageFault::kStall; }

ImageFault LibcameraCamera::look_after(int64_t) {
  return completions_.disconnected() ? ImageFault::kGone : ImageFault::kCount;
}

}  // namespace roomcal::drivers
