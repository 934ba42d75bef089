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
  throw ToolError(path.string() + ": " + step + ": " + std::strerror(errno) +
                  "; does its folder exist, may you write there, is the disk full?");
}

int open_for_writing(const fs::path& file, int flags, const fs::path& path) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CLOEXEC | flags, 0644);
  if (fd < 0) fail(path, "cannot be opened for writing");
  return fd;
}

void write_all(int fd, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0) fail(path, "cannot be written");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

void write_into(const fs::path& path, std::span<const std::byte> bytes) {
  const int fd = open_for_writing(path, 0, path);
  try {
    write_all(fd, bytes, path);
  } catch (...) {
    ::close(fd);
    throw;
  }
  ::close(fd);
}

}  // namespace

std::string read_text(const fs::path& path) {
  std::ostringstream text;
  text << open_file(path).rdbuf();
  return text.str();
}

AlignedBytes read_bytes(const fs::path& path) {
  std::ifstream in = open_file(path);
  if (!fs::is_regular_file(path))
    throw ToolError(path.string() + ": is not a file but a device or a pipe; name a file");
  AlignedBytes bytes(fs::file_size(path));
  in.read(reinterpret_cast<char*>(bytes.span().data()), static_cast<std::streamsize>(bytes.span().size()));
  if (!in) throw ToolError(path.string() + ": ended while being read; is it still being written?");
  return bytes;
}

void write_atomic(const fs::path& path, std::span<const std::byte> bytes) {
  std::error_code ignored;  // what does not exist, or may not be looked at, open() names below
  if (fs::is_directory(path, ignored)) throw ToolError(path.string() + ": is a folder; name a file in it");
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) return write_into(path, bytes);
  const fs::path target = fs::is_symlink(path, ignored) ? fs::weakly_canonical(path, ignored) : path;
  const fs::path beside = target.string() + ".new";
  const int fd = open_for_writing(beside, O_CREAT | O_TRUNC, path);
  try {
    write_all(fd, bytes, path);
    if (::fsync(fd) != 0) fail(path, "cannot be synced");
    ::close(fd);
  } catch (...) {
    ::close(fd);
    ::unlink(beside.c_str());
    throw;
  }
  if (::rename(beside.c_str(), target.c_str()) == 0) return;
  const int reason = errno;
  ::unlink(beside.c_str());
  errno = reason;
  fail(path, "cannot be replaced");
}

void write_atomic(const fs::path& path, const std::string& text) {
  write_atomic(path, std::as_bytes(std::span<const char>(text)));
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error && !fs::is_directory(folder, error)) error = std::make_error_code(std::errc::not_a_directory);
  if (error)
    throw ToolError(folder.string() + ": cannot be made a folder: " + error.message() +
                    "; is it a file, may you write there?");
}

}  // namespace roomcal::tools
