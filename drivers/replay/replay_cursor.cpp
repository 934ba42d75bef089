#include "drivers/replay/replay_cursor.h"

#include <sys/stat.h>

#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

bool is_folder(const FilePath& path) {
  struct stat info {};
  return ::stat(path.data(), &info) == 0 && S_ISDIR(info.st_mode);
}

}  // namespace

FilePath ReplayCursor::folder_of(int shot) const {
  FilePath path{};
  TextWriter out({path.data(), path.size() - 1});
  out.text(folder_.view());
  if (!numbered_) return path;
  out.text(shot < 10 ? "/shot00" : shot < 100 ? "/shot0" : "/shot").integer(shot);
  return path;
}

FilePath ReplayCursor::path(int shot, std::string_view sensor, std::string_view extension) const {
  FilePath path = folder_of(shot);
  const std::size_t length = std::string_view(path.data()).size();
  TextWriter({path.data() + length, path.size() - 1 - length}).text("/").text(sensor).text(extension);
  return path;
}

Status ReplayCursor::open(const FolderPath& folder, int64_t now_ns) {
  if (folder.view().size() == FolderPath::capacity())
    return {StatusCode::kInvalidArgument, "the replay folder's path is too long; at most 199 characters"};
  folder_ = folder;
  numbered_ = false;
  shots_ = 0;
  if (!is_folder(folder_of(0))) return {StatusCode::kNotFound, "there is no such replay folder; name one with shots"};
  numbered_ = true;
  while (shots_ < kMaxShots && is_folder(folder_of(shots_))) ++shots_;
  numbered_ = shots_ > 0;
  if (!numbered_) shots_ = 1;
  epoch_ns_ = now_ns;
  const std::lock_guard lock(mutex_);
  now_ = before_ = {0, now_ns};
  return ok_status();
}

void ReplayCursor::advance(int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  before_ = now_;
  now_ = {(now_.shot + 1) % (shots_ > 0 ? shots_ : 1), now_ns};
}

ReplayCursor::Place ReplayCursor::at(int64_t at_ns) const {
  const std::lock_guard lock(mutex_);
  return at_ns >= now_.since_ns ? now_ : before_;
}

}  // namespace roomcal::drivers
