#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/lidar/bytes.h"
#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// One column of a point cloud file.
struct CloudField {
  std::string name;
  char type = 'F';        ///< F float, I signed, U unsigned
  std::size_t bytes = 4;  ///< 1, 2, 4, 8
  std::size_t count = 1;  ///< values of one point
};

/// A point cloud as a table: `values[i]` are all of field i.
struct CloudTable {
  std::vector<CloudField> fields;
  std::vector<std::vector<double>> values;
  std::size_t points = 0;

  /// @return nullptr if there is none of that name
  const std::vector<double>* find(const std::string& name) const;
};

/// True if the bytes begin as a PCD or PLY file.
bool is_cloud(lidar::Bytes bytes);

/// PCD version 0.7 (ascii, binary, binary_compressed). @throws ToolError naming what is wrong where.
CloudTable parse_pcd(const std::string& name, lidar::Bytes bytes);

/// PLY (ascii, binary, either endianness): its `vertex` element. @throws ToolError naming what is wrong where.
CloudTable parse_ply(const std::string& name, lidar::Bytes bytes);

/// A sweep of a point cloud in the LiDAR's frame. Wants fields x, y, z (m); takes `ring`, `channel` or `beam`,
/// `intensity` or `reflectivity`, `t`, `time_stamp` or `offset_ns` (ns) and `return_index` where they are. Points that
/// are not finite or at the origin are no points.
LoadedSweep read_cloud(const std::string& name, lidar::Bytes bytes);

/// Binary PCD with x y z range azimuth beam reflectivity return_index offset_ns sweep, of all sweeps.
std::vector<std::byte> write_pcd(std::span<const LoadedSweep> sweeps);

/// LZF as PCD's binary_compressed has it. @return false if the data are damaged; `out` then is partly written.
bool lzf_decompress(lidar::Bytes in, std::span<std::byte> out);

}  // namespace roomcal::tools
