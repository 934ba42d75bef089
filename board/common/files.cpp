#include "board/common/files.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/os/unique_fd.h"
#include "runtime/base/reason.h"
#include "runtime/store/record_codec.h"

namespace roomcal::board {

namespace {

constexpr std::size_t kMaxFile = 16 * 1024 * 1024;

struct FileBytes {
  std::vector<uint64_t> words;
  std::size_t size = 0;
  std::span<const std::byte> bytes() const { return std::as_bytes(std::span(words)).first(size); }
};

Status fail(StatusCode code, const Reason& reason, Reason& why) {
  why = reason;
  return {code, "a file of the device cannot be used"};
}

Status read_file(const std::string& path, FileBytes& file, Reason& why) {
  const drivers::UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd.valid()) return fail(StatusCode::kNotFound, make_reason("%s: %s", path.c_str(), std::strerror(errno)), why);
  struct stat info {};
  if (::fstat(fd.get(), &info) != 0 || !S_ISREG(info.st_mode) || static_cast<std::size_t>(info.st_size) > kMaxFile)
    return fail(StatusCode::kInvalidArgument, make_reason("%s: not a file of ours: copy it again", path.c_str()), why);
  file.size = static_cast<std::size_t>(info.st_size);
  file.words.assign(file.size / sizeof(uint64_t) + 1, 0);
  for (std::size_t done = 0; done < file.size;) {
    const ssize_t got = ::read(fd.get(), reinterpret_cast<std::byte*>(file.words.data()) + done, file.size - done);
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else if (got == 0 || errno != EINTR) {
      return fail(StatusCode::kUnavailable, make_reason("%s: cannot be read", path.c_str()), why);
    }
  }
  return ok_status();
}

Status load_profile(const std::string& path, LoadedFiles& files, Reason& why) {
  FileBytes file;
  ROOMCAL_TRY(read_file(path, file, why));
  files.profile = std::make_unique<profile::Profile>();
  Reason what;
  if (const Status read = decode_profile(file.bytes(), *files.profile, what); !read.ok())
    return fail(read.code(),
                make_reason("%s: %.*s", path.c_str(), static_cast<int>(what.view().size()), what.view().data()), why);
  return ok_status();
}

Status load_map(const std::string& path, LoadedFiles& files, Reason& why) {
  FileBytes file;
  ROOMCAL_TRY(read_file(path, file, why));
  files.map_words = std::move(file.words);
  files.map_bytes = file.size;
  Result<map::RoomMap> opened = map::RoomMap::open(std::as_bytes(std::span(files.map_words)).first(files.map_bytes));
  if (!opened.ok())
    return fail(opened.status().code(), make_reason("%s: %s", path.c_str(), opened.status().detail()), why);
  files.map = opened.value();
  return ok_status();
}

/// A device that was provisioned before may do without.
Status load_factory(const std::string& path, LoadedFiles& files, Reason& why) {
  if (::access(path.c_str(), F_OK) != 0) return ok_status();
  FileBytes file;
  ROOMCAL_TRY(read_file(path, file, why));
  files.factory = std::make_unique<store::Record>();
  if (const Status read = store::decode_record(file.bytes(), *files.factory); !read.ok())
    return fail(read.code(), make_reason("%s: %s", path.c_str(), read.detail()), why);
  return ok_status();
}

}  // namespace

std::string Folder::below(std::string_view name) const {
  return !name.empty() && (name.front() == '/' || name == "-") ? std::string(name) : path + "/" + std::string(name);
}

Status load_files(const Folder& folder, LoadedFiles& files, Reason& why) {
  ROOMCAL_TRY(load_profile(folder.below("device.profile"), files, why));
  ROOMCAL_TRY(load_map(folder.below("room.room"), files, why));
  return load_factory(folder.below("factory.record"), files, why);
}

}  // namespace roomcal::board
