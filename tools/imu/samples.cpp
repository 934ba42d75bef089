#include "tools/imu/samples.h"

#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/files.h"

namespace roomcal::tools {

namespace {

constexpr std::string_view kHeader = "stamp_ns,ax_mps2,ay_mps2,az_mps2";
constexpr std::size_t kMinSamples = 10;
constexpr double kDrift_mps2 = 0.02, kDriftSigmas = 5;

/// The number between two commas; NaN if it is none.
double number(std::string_view& line) {
  const std::size_t end = std::min(line.find(','), line.size());
  double value = std::nan("");
  const auto [last, error] = std::from_chars(line.data(), line.data() + end, value);
  if (error != std::errc() || last != line.data() + end) value = std::nan("");
  line.remove_prefix(std::min(end + 1, line.size()));
  return value;
}

struct Mean {
  Vec3 mean = Vec3::Zero(), sigma = Vec3::Zero();
};

Mean mean_of(const std::vector<Vec3>& samples, std::size_t first, std::size_t count) {
  Mean out;
  const auto n = static_cast<double>(count);
  for (std::size_t i = first; i < first + count; ++i) out.mean += samples[i] / n;
  Vec3 variance = Vec3::Zero();
  for (std::size_t i = first; i < first + count; ++i) variance += (samples[i] - out.mean).cwiseAbs2() / (n - 1);
  out.sigma = (variance / n).cwiseSqrt();
  return out;
}

std::vector<Vec3> read_samples(const std::filesystem::path& file) {
  std::istringstream text(read_text(file));
  std::string line;
  if (!std::getline(text, line) || !line.starts_with(kHeader))
    throw ToolError(fmt::format("{}: does not begin with `{}`", file.string(), kHeader));
  std::vector<Vec3> samples;
  for (int row = 2; std::getline(text, line); ++row) {
    std::string_view rest = line;
    if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
    if (rest.empty()) continue;
    const double stamp = number(rest);
    Vec3 a;
    for (double& axis : a) axis = number(rest);
    if (!std::isfinite(stamp) || !a.allFinite())
      throw ToolError(fmt::format("{}: line {} is not a stamp and three accelerations", file.string(), row));
    samples.push_back(a);
  }
  return samples;
}

}  // namespace

RestingImu read_resting_imu(const std::filesystem::path& file) {
  const std::vector<Vec3> samples = read_samples(file);
  if (samples.size() < kMinSamples)
    throw ToolError(
        fmt::format("{}: {} samples are too few, {} is the least", file.string(), samples.size(), kMinSamples));
  const std::size_t half = samples.size() / 2;
  const Mean whole = mean_of(samples, 0, samples.size()), early = mean_of(samples, 0, half),
             late = mean_of(samples, half, samples.size() - half);
  for (int i = 0; i < 3; ++i) {
    const double drift = std::abs(late.mean[i] - early.mean[i]);
    if (drift > kDrift_mps2 && drift > kDriftSigmas * std::hypot(early.sigma[i], late.sigma[i]))
      throw ToolError(fmt::format("{}: did not rest, its mean went by {:.3f} m/s^2: take it again, standing still",
                                  file.string(), drift));
  }
  return {whole.mean, whole.sigma, samples.size()};
}

}  // namespace roomcal::tools
