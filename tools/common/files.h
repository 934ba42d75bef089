#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace roomcal::tools {

/// Whole file as text. @throws ToolError naming the path and what to check.
std::string read_text(const std::filesystem::path& path);

/// Bytes aligned to 8, as the map's view wants them.
class AlignedBytes {
 public:
  explicit AlignedBytes(std::size_t size) : words_((size + 7) / 8), size_(size) {}
  std::span<std::byte> span() { return {reinterpret_cast<std::byte*>(words_.data()), size_}; }
  std::span<const std::byte> span() const { return {reinterpret_cast<const std::byte*>(words_.data()), size_}; }

 private:
  std::vector<uint64_t> words_;
  std::size_t size_;
};

/// Whole file, aligned. @throws ToolError naming the path and what to check.
AlignedBytes read_bytes(const std::filesystem::path& path);

/// Replaces the file in one step: writes beside it, syncs, renames. A failure leaves the old file whole. What is no
/// file but a device or a pipe (/dev/stdout) is written into, not replaced; a link stays, and what it names is
/// replaced.
/// @throws ToolError naming the path, the system's reason and what to check.
void write_atomic(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_atomic(const std::filesystem::path& path, const std::string& text);

/// Makes the folder and those above it where they are missing.
/// @throws ToolError naming the path, the system's reason and what to check.
void make_folder(const std::filesystem::path& folder);

}  // namespace roomcal::tools
