#include "tools/common/files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace fs = std::filesystem;

namespace {

std::ifstream open_file(const fs::path& path) {
  if (!fs::exists(path)) throw ToolError(path.string() + ": no such file; check the path");
  if (fs::is_directory(path)) throw ToolError(path.string() + ": is a folder; name the file in it");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw ToolError(path.string() + ": cannot be read; check its permissions");
  return in;
}

[[noreturn]] void fail(const fs::path& path, const char* step) {
  throw ToolError(path.string() + ": " + step + ": " + std::strerror(errno));
}

void write_all(int fd, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0) fail(path, "cannot be written");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  if (::fsync(fd) != 0) fail(path, "cannot be synced");
}

}  // namespace

std::string read_text(const fs::path& path) {
  std::ostringstream text;
  text << open_file(path).rdbuf();
  return text.str();
}

AlignedBytes read_bytes(const fs::path& path) {
  std::ifstream in = open_file(path);
  AlignedBytes bytes(fs::file_size(path));
  in.read(reinterpret_cast<char*>(bytes.span().data()), static_cast<std::streamsize>(bytes.span().size()));
  if (!in) throw ToolError(path.string() + ": ended while being read; is it still being written?");
  return bytes;
}

void write_atomic(const fs::path& path, std::span<const std::byte> bytes) {
  const fs::path beside = path.string() + ".new";
  const int fd = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) fail(path, "cannot be created");
  try {
    write_all(fd, bytes, path);
    ::close(fd);
    if (::rename(beside.c_str(), path.c_str()) != 0) fail(path, "cannot be replaced");
  } catch (...) {
    ::close(fd);
    ::unlink(beside.c_str());
    throw;
  }
}

void write_atomic(const fs::path& path, const std::string& text) {
  write_atomic(path, std::as_bytes(std::span<const char>(text)));
}

}  // namespace roomcal::tools
