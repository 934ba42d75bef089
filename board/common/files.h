#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/base/status.h"
#include "runtime/map/room_map.h"
#include "runtime/profile/profile.h"
#include "runtime/store/record.h"

namespace roomcal::board {

/// Where the device's files are. Paths of the profile that do not begin with a slash are below `folder`.
struct Folder {
  std::string path = "/etc/roomcal";
  std::string below(std::string_view name) const;
};

/// What is read before anything is reserved; on the heap, which is allowed until the device is armed.
struct LoadedFiles {
  std::unique_ptr<profile::Profile> profile;
  std::vector<uint64_t> map_words;  ///< the file's bytes, aligned
  std::size_t map_bytes = 0;
  map::RoomMap map;
  std::unique_ptr<store::Record> factory;  ///< null: there is no factory.record
};

/// `device.profile`, `room.room` and, where there is one, `factory.record`.
/// @param[out] why  names the file and the remedy; for anything but kOk.
Status load_files(const Folder& folder, LoadedFiles& files, Reason& why);

}  // namespace roomcal::board
