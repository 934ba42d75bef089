#include "tools/imu/imu_command.h"

#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/json_file.h"
#include "tools/common/matrix_json.h"
#include "tools/imu/gravity.h"
#include "tools/imu/samples.h"

namespace roomcal::tools {

using nlohmann::json, nlohmann::ordered_json;

namespace {

struct Options {
  std::vector<std::string> result_files, sample_files;
  std::vector<double> drawing_deg;
  double drawing_sigma_deg = 1;
  std::string imu = "imu0", truth_file, json_file;
  GravityPrior prior;
};

Mat33 rotation_of(const json& rows) {
  Mat33 R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      R(r, c) = rows.at(static_cast<std::size_t>(r)).at(static_cast<std::size_t>(c)).get<double>();
  if (!((R * R.transpose() - Mat33::Identity()).norm() < 1e-6)) throw ToolError("a pose is no pose");
  return R;
}

Mat33 R_room_rig_of(const std::string& file) {
  const json result = read_json(file);
  try {
    const json& rig = result.at("sensors").at(result.at("rig_frame").get<std::string>());
    if (!rig.at("located").get<bool>()) throw ToolError("its reference is not located, calibrate again");
    return rotation_of(rig.at("T_room_sensor"));
  } catch (const json::exception& error) {
    throw ToolError(fmt::format("{}: is no result of `roomcal calibrate --json`: {}", file, error.what()));
  } catch (const ToolError& error) {
    throw ToolError(fmt::format("{}: {}", file, error.what()));
  }
}

std::vector<Stance> read_stances(const Options& options) {
  if (options.result_files.size() != options.sample_files.size())
    throw ToolError(fmt::format("{} results and {} recordings: give one of each for every stance",
                                options.result_files.size(), options.sample_files.size()));
  std::vector<Stance> stances;
  for (std::size_t i = 0; i < options.result_files.size(); ++i) {
    const RestingImu imu = read_resting_imu(options.sample_files[i]);
    stances.push_back({R_room_rig_of(options.result_files[i]), imu.held_up_mps2, imu.sigma_mps2});
  }
  return stances;
}

void print(const ImuRotation& found, const Options& options, std::size_t stances) {
  fmt::print("{}: gravity in {} stance{} tells {} of 3 degrees of freedom of its rotation\n", options.imu, stances,
             stances == 1 ? "" : "s", found.seen);
  const Vec3 sigma = found.cov.diagonal().cwiseSqrt();
  fmt::print("  R_rig_imu, 1-sigma about its axes {:.3f} {:.3f} {:.3f} deg\n", rad_to_deg(sigma.x()),
             rad_to_deg(sigma.y()), rad_to_deg(sigma.z()));
  for (int r = 0; r < 3; ++r)
    fmt::print("    {:9.6f} {:9.6f} {:9.6f}\n", found.R_rig_imu(r, 0), found.R_rig_imu(r, 1), found.R_rig_imu(r, 2));
  if (found.seen == 2)
    fmt::print(
        "  not seen: turning about ({:.3f} {:.3f} {:.3f}) of the rig; {}: lean the device, another way each time\n",
        found.unseen_rig.x(), found.unseen_rig.y(), found.unseen_rig.z(),
        options.prior.mounted ? "the drawing carries it" : "no drawing carries it");
}

Mat33 true_R_rig_imu(const Options& options) {
  const json truth = read_json(options.truth_file);
  const json result = read_json(options.result_files[0]);
  try {
    const Mat33 R_room_rig =
        rotation_of(truth.at("T_room_sensor").at(result.at("rig_frame").get<std::string>()).at("T"));
    return R_room_rig.transpose() * rotation_of(truth.at("imus").at(options.imu).at("T_room_imu").at("T"));
  } catch (const json::exception& error) {
    throw ToolError(fmt::format("{}: is not the truth of this shot: {}", options.truth_file, error.what()));
  }
}

void print_against_truth(const ImuRotation& found, const Options& options) {
  Vec3 error = so3_log(found.R_rig_imu.transpose() * true_R_rig_imu(options));
  const double whole = error.norm();
  const Vec3 axis_imu = found.R_rig_imu.transpose() * found.unseen_rig;
  error -= error.dot(axis_imu) * axis_imu;
  fmt::print("  error to truth {:.4f} deg, where seen {:.4f} deg\n", rad_to_deg(whole), rad_to_deg(error.norm()));
}

json to_json(const ImuRotation& found, const Options& options) {
  json out = {{"imu", options.imu},
              {"R_rig_imu", rows_of(found.R_rig_imu)},
              {"covariance", rows_of(found.cov)},
              {"degrees_of_freedom_seen", found.seen},
              {"drawing_took_part", options.prior.mounted},
              {"accel_bias_mps2", {found.bias_mps2.x(), found.bias_mps2.y(), found.bias_mps2.z()}},
              {"chi2", found.chi2}};
  if (found.seen == 2)
    out["unseen"] = {{"axis_rig", {found.unseen_rig.x(), found.unseen_rig.y(), found.unseen_rig.z()}},
                     {"sigma_rad", found.unseen_sigma_rad}};
  return out;
}

int run(Options& options) {
  options.prior.mounted = !options.drawing_deg.empty();
  if (options.prior.mounted) {
    const Vec3 rpy = deg_to_rad(1) * Vec3(options.drawing_deg[0], options.drawing_deg[1], options.drawing_deg[2]);
    options.prior.R_rig_imu =
        so3_exp(rpy.z() * Vec3::UnitZ()) * so3_exp(rpy.y() * Vec3::UnitY()) * so3_exp(rpy.x() * Vec3::UnitX());
    options.prior.mount_sigma_rad = deg_to_rad(options.drawing_sigma_deg);
  }
  const std::vector<Stance> stances = read_stances(options);
  const ImuRotation found = find_imu_rotation(stances, options.prior);
  print(found, options, stances.size());
  if (!options.truth_file.empty()) print_against_truth(found, options);
  if (!options.json_file.empty()) write_atomic(options.json_file, to_json(found, options).dump(1) + "\n");
  return found.seen == 3 || options.prior.mounted ? 0 : 2;
}

}  // namespace

void add_imu_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("imu", "how an IMU is turned on the rig, from gravity in one stance or several");
  command->add_option("--result", options->result_files, "result of `roomcal calibrate --json` in each stance")
      ->required();
  command->add_option("--samples", options->sample_files, "CSV of the IMU at rest in each stance, in the same order")
      ->required();
  command->add_option("--imu", options->imu, "its name")->capture_default_str();
  command->add_option("--drawing", options->drawing_deg, "roll, pitch, yaw of R_rig_imu by its drawing, deg")
      ->expected(3)
      ->check(CLI::Range(-360.0, 360.0));
  command->add_option("--drawing-sigma", options->drawing_sigma_deg, "by which the drawing may be off, per axis, deg")
      ->check(CLI::Range(0.001, 45.0))
      ->capture_default_str();
  command->add_option("--bias-sigma", options->prior.bias_sigma_mps2, "of the accelerometer, per axis, m/s^2")
      ->check(CLI::Range(1e-5, 1.0))
      ->capture_default_str();
  command->add_option("--level-sigma", options->prior.level_sigma_rad, "by which the room's z may be off plumb, rad")
      ->check(CLI::Range(1e-6, 0.1))
      ->capture_default_str();
  command->add_option("--truth", options->truth_file, "truth.json of the first stance's simulated shot");
  command->add_option("--json", options->json_file, "write the figures to this file");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace roomcal::tools
