#include "tools/simulate/shot_command.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "tools/common/files.h"
#include "tools/common/option_check.h"
#include "tools/common/progress.h"
#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/record_lidar.h"
#include "tools/simulate/room_files.h"
#include "tools/simulate/shot_files.h"

namespace roomcal::tools {

namespace {

struct Arguments {
  ShotOptions options;
  PictureFormat format;
  std::string room;
  std::string device;
  std::string lidar;
  std::filesystem::path folder;
  double scale = 1;
  double tls_step_deg = 0.5;
  int shots = 0;  ///< 0: one, right in the folder
};

/// Shots of one stand: the same poses and lenses, other noise.
class ShotMaker {
 public:
  explicit ShotMaker(const Arguments& arguments)
      : arguments_(arguments),
        device_(scaled(with_lidars(device_named(arguments.device), arguments.lidar), arguments.scale)),
        scene_(read_room(arguments.room)),
        stand_(place_device(scene_, device_, arguments.options)) {
    facts_.resize(static_cast<std::size_t>(std::max(1, arguments.shots)));
  }

  void make() {
    Progress progress("simulating " + device_.name, stand_.cameras.size() + stand_.lidars.size());
    const LitScene lit(scene_);
    for (std::size_t i = 0; i < stand_.cameras.size(); ++i, progress.step()) take_pictures(lit, i);
    const EchoCaster caster(scene_);
    for (std::size_t i = 0; i < stand_.lidars.size(); ++i, progress.step()) take_sweeps(caster, i);
    for (std::size_t shot = 0; shot < facts_.size(); ++shot) {
      write_shot_facts(scene_, stand_, facts_[shot], arguments_.options, folder(shot));
      if (stand_.imu) write_atomic(folder(shot) / (stand_.imu->name + ".csv"), imu_csv(*stand_.imu, seed(shot, kImu)));
    }
  }

  void print() const {
    for (std::size_t i = 0; i < stand_.cameras.size(); ++i)
      fmt::print("{}/{}: {} markers\n", folder(0).string(), stand_.cameras[i].name,
                 facts_[0].pictures[i].markers.size());
    for (const LidarRecording& recording : facts_[0].recordings)
      fmt::print("{}/{}: {} returns of {} firings\n", folder(0).string(), recording.files[0].name, recording.returns,
                 recording.firings);
    if (facts_.size() > 1) fmt::print("and {} more shots like that\n", facts_.size() - 1);
  }

 private:
  static constexpr std::size_t kImu = 90;  // as a sensor's number: beyond all others

  std::filesystem::path folder(std::size_t shot) const {
    return arguments_.shots == 0 ? arguments_.folder : arguments_.folder / fmt::format("shot{:03}", shot);
  }
  uint64_t seed(std::size_t shot, std::size_t sensor) const {
    return arguments_.options.seed * 100 + sensor + (static_cast<uint64_t>(shot) << 32);
  }

  void take_pictures(const LitScene& lit, std::size_t camera) {
    const Exposed exposed = expose_camera(lit, stand_.cameras[camera], arguments_.options);
    for (std::size_t shot = 0; shot < facts_.size(); ++shot) {
      Picture picture = develop(exposed, seed(shot, camera));
      write_picture(picture, stand_.cameras[camera].name, arguments_.format, folder(shot));
      picture.image.release();  // a scanner's pictures take 16 MB each
      facts_[shot].pictures.push_back(std::move(picture));
    }
  }

  void take_sweeps(const EchoCaster& caster, std::size_t lidar) {
    for (std::size_t shot = 0; shot < facts_.size(); ++shot) {
      LidarRecording recording = record_lidar(caster, stand_.lidars[lidar], arguments_.options.lidar,
                                              seed(shot, stand_.cameras.size() + lidar));
      make_folder(folder(shot));
      for (ShotFile& file : recording.files) {
        write_atomic(folder(shot) / file.name, file.bytes);
        file.bytes = {};
      }
      facts_[shot].recordings.push_back(std::move(recording));
    }
  }

  const Arguments& arguments_;
  PaperDevice device_;
  Scene scene_;
  Stand stand_;
  std::vector<ShotFacts> facts_;
};

void simulate_shot(Arguments& arguments) {
  arguments.options.lidar.tls_step_rad = deg_to_rad(arguments.tls_step_deg);
  ShotMaker maker(arguments);
  maker.make();
  maker.print();
}

void add_camera_options(CLI::App& shot, Arguments& arguments) {
  ShotOptions& options = arguments.options;
  shot.add_option("--scale", arguments.scale, "cameras of so many times their resolution, same field of view")
      ->check(number_between(0.02, 2))
      ->capture_default_str();
  shot.add_option("--blur", options.blur_px, "sigma of the point spread, px")
      ->check(number_between(0.0, 10.0, "px"))
      ->capture_default_str();
  shot.add_option("--motion", options.motion_px, "motion during the exposure, px")
      ->check(number_between(0.0, 50.0, "px"))
      ->capture_default_str();
  shot.add_option("--defocus", options.defocus_px, "diameter of the disc that a point becomes, px")
      ->check(number_between(0.0, 30.0, "px"))
      ->capture_default_str();
  shot.add_option("--vignetting", options.vignetting, "loss of light at the corner of the picture, as a share")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  shot.add_option("--noise", options.noise_sigma, "sigma at mid grey, grey levels")
      ->check(number_between(0.0, 50.0))
      ->capture_default_str();
  shot.add_option("--exposure", options.exposure, "1: a tenth of the paper saturates")
      ->check(number_between(0.01, 20.0))
      ->capture_default_str();
  const auto formats = CLI::CheckedTransformer(
      std::map<std::string, ImageFile>{{"png", ImageFile::kPng}, {"jpg", ImageFile::kJpeg}, {"pgm", ImageFile::kPgm}});
  shot.add_option("--format", arguments.format.file, "png, jpg or pgm")->transform(formats)->default_str("png");
  shot.add_option("--jpeg", arguments.format.jpeg_quality, "quality of --format jpg")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
}

void add_lidar_options(CLI::App& shot, Arguments& arguments) {
  LidarOptions& options = arguments.options.lidar;
  shot.add_option("--lidar", arguments.lidar, "all spinning LiDARs are one of " + lidar_unit_names());
  shot.add_option("--sweeps", options.sweeps, "whole turns of every LiDAR")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  shot.add_option("--lidar-noise", options.sigma_m, "sigma of a range, m; default: typical of the LiDAR")
      ->check(number_between(0.0, 1.0, "m"));
  shot.add_option("--lidar-bias", options.bias_sigma_m, "sigma of what each laser is off by, m; default: typical")
      ->check(number_between(0.0, 1.0, "m"));
  shot.add_option("--dropout", options.dropout, "share of firings without a return")
      ->check(number_between(0.0, 1.0))
      ->capture_default_str();
  shot.add_flag("--mixed-pixels", options.mixed_pixels, "beams cut by an edge return something between");
  shot.add_option("--tls-step", arguments.tls_step_deg, "of the terrestrial scanner, degrees; the paper's: 0.13")
      ->check(number_between(0.02, 5.0, "degrees"))
      ->capture_default_str();
  shot.add_flag("--tls-profiles", options.tls_profiles, "also its profiler's packets (R2000) and its servo's angles");
}

}  // namespace

void add_shot_command(CLI::App& simulate) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* shot = simulate.add_subcommand(
      "shot", "what a device sees in a room: pictures, sweeps, camchain.yaml, nominal.json, truth.json");
  shot->add_option("--room", arguments->room, "folder of `simulate room`")->required();
  shot->add_option("--device", arguments->device, device_names())->required();
  shot->add_option("-o,--output", arguments->folder, "folder to write")->required();
  shot->add_option("--seed", arguments->options.seed, "same seed, same shot")->capture_default_str();
  shot->add_option("--shots", arguments->shots, "so many of the same stand with other noise: shot000/, shot001/, ...")
      ->check(CLI::Range(1, 1000));
  shot->add_flag("--imu", arguments->options.imu, "also an IMU at rest: imu0.csv");
  add_camera_options(*shot, *arguments);
  add_lidar_options(*shot, *arguments);
  shot->callback([arguments] { simulate_shot(*arguments); });
}

}  // namespace roomcal::tools
