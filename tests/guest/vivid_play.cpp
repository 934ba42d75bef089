// vivid_play CAPTURE OUTPUT WxH FILE...   plays grey images through vivid's output-to-capture loop: what CAPTURE's
// driver
//                                         then brings are their bytes, one after the other, for ever
// vivid_play --set DEVICE NAME=VALUE...   sets controls by their names ("disconnect", "percentage_of_dropped_buffers")
//
// FILEs hold WxH bytes each. Both nodes get the DV timings of that size; the loop's switch is on the capture node. Exit
// 1 with the call and its errno if vivid does not take part.

#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <fcntl.h>
#include <linux/v4l2-dv-timings.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace {

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "vivid_play: %s: %s\n", what.c_str(), std::strerror(errno));
  std::exit(1);
}

int open_node(const char* path) {
  const int fd = ::open(path, O_RDWR | O_CLOEXEC);
  if (fd < 0) fail(path);
  return fd;
}

template <typename Argument>
void call(int fd, unsigned long request, Argument& argument, const char* what) {
  if (::ioctl(fd, request, &argument) < 0) fail(what);
}

/// "Percentage of Dropped Buffers" -> "percentage_of_dropped_buffers", as v4l2-ctl names controls.
std::string control_name(const char* title) {
  std::string name;
  for (const char* c = title; *c != '\0'; ++c) {
    const auto letter = static_cast<unsigned char>(*c);
    if (std::isalnum(letter) != 0) {
      name += static_cast<char>(std::tolower(letter));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

void set_control(int fd, const std::string& wanted, int value) {
  v4l2_queryctrl query{};
  for (query.id = V4L2_CTRL_FLAG_NEXT_CTRL; ::ioctl(fd, VIDIOC_QUERYCTRL, &query) == 0;
       query.id |= V4L2_CTRL_FLAG_NEXT_CTRL) {
    if (control_name(reinterpret_cast<const char*>(query.name)) != wanted) continue;
    v4l2_control control{query.id, value};
    return call(fd, VIDIOC_S_CTRL, control, wanted.c_str());
  }
  errno = ENOENT;
  fail("control " + wanted);
}

int set_controls(int argc, char** argv) {
  const int fd = open_node(argv[2]);
  for (int i = 3; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) fail(word + " is not NAME=VALUE");
    set_control(fd, word.substr(0, equals), std::atoi(word.c_str() + equals + 1));
  }
  return 0;
}

struct Size {
  unsigned width = 0, height = 0;
};

void set_timings(int fd, Size size) {
  v4l2_enum_dv_timings candidate{};
  for (; ::ioctl(fd, VIDIOC_ENUM_DV_TIMINGS, &candidate) == 0; ++candidate.index) {
    const v4l2_bt_timings& bt = candidate.timings.bt;
    if (bt.width != size.width || bt.height != size.height || bt.interlaced != 0) continue;
    return call(fd, VIDIOC_S_DV_TIMINGS, candidate.timings, "VIDIOC_S_DV_TIMINGS");
  }
  errno = EINVAL;
  fail("no DV timings of this size");
}

void set_format(int fd, v4l2_buf_type type, Size size) {
  v4l2_format format{};
  format.type = type;
  format.fmt.pix.width = size.width;
  format.fmt.pix.height = size.height;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  call(fd, VIDIOC_S_FMT, format, "VIDIOC_S_FMT");
  if (format.fmt.pix.width == size.width && format.fmt.pix.height == size.height &&
      format.fmt.pix.bytesperline == size.width)
    return;
  errno = EINVAL;
  fail("another size or stride than asked for");
}

std::vector<char> read_image(const char* path, Size size) {
  std::vector<char> bytes(std::size_t{size.width} * size.height);
  std::FILE* file = std::fopen(path, "rb");
  if (file == nullptr || std::fread(bytes.data(), 1, bytes.size(), file) != bytes.size()) fail(path);
  std::fclose(file);
  return bytes;
}

constexpr unsigned kBuffers = 3;

void queue(int fd, unsigned index, std::size_t bytes) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  buffer.bytesused = static_cast<unsigned>(bytes);
  buffer.field = V4L2_FIELD_NONE;
  call(fd, VIDIOC_QBUF, buffer, "VIDIOC_QBUF");
}

[[noreturn]] void stream(int fd, const std::vector<std::vector<char>>& images) {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  request.memory = V4L2_MEMORY_MMAP;
  call(fd, VIDIOC_REQBUFS, request, "VIDIOC_REQBUFS");
  std::array<void*, kBuffers> mapped{};
  std::size_t next = 0;
  const auto fill = [&](unsigned index) {
    const std::vector<char>& image = images[next++ % images.size()];
    std::memcpy(mapped[index], image.data(), image.size());
    queue(fd, index, image.size());
  };
  for (unsigned i = 0; i < kBuffers; ++i) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = i;
    call(fd, VIDIOC_QUERYBUF, buffer, "VIDIOC_QUERYBUF");
    mapped[i] = ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, buffer.m.offset);
    if (mapped[i] == MAP_FAILED) fail("mmap");
    fill(i);
  }
  int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  call(fd, VIDIOC_STREAMON, type, "VIDIOC_STREAMON");
  for (;;) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    call(fd, VIDIOC_DQBUF, buffer, "VIDIOC_DQBUF");
    fill(buffer.index);
  }
}

int play(int argc, char** argv) {
  Size size;
  if (std::sscanf(argv[3], "%ux%u", &size.width, &size.height) != 2) fail("size");
  std::vector<std::vector<char>> images;
  for (int i = 4; i < argc; ++i) images.push_back(read_image(argv[i], size));
  const int capture = open_node(argv[1]);
  const int output = open_node(argv[2]);
  set_timings(capture, size);
  set_timings(output, size);
  set_format(output, V4L2_BUF_TYPE_VIDEO_OUTPUT, size);
  set_control(capture, "loop_video", 1);
  set_control(capture, "osd_text_mode", 2);
  set_control(capture, "timestamp_source", 1);  // the other one lies in the future
  ::close(capture);
  stream(output, images);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc >= 4 && std::strcmp(argv[1], "--set") == 0) return set_controls(argc, argv);
  if (argc >= 5) return play(argc, argv);
  std::fprintf(stderr, "see the top of tests/guest/vivid_play.cpp\n");
  return 100;
}
